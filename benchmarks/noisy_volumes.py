"""Noisy solids of known or unknown genus: scans with any number of critical points, made here.

    python benchmarks/noisy_volumes.py FOLDER
    PYTHONPATH=workflow/scripts python benchmarks/noisy_volumes.py --graphs [NAME ...]

Writes `SOLIDS` as PLY; the same name and seed give the same bytes. Or measures the exact graphs of these and of
`SHEETS`: processor seconds of the surface's graph, of the solid's by merge trees and of the solid's by slices, in turn,
medians of three on compiled kernels (of what slices refuse, the seconds until then); and the most memory that the
first two and the mesh in order of height take.
"""

import itertools
import multiprocessing
import resource
import statistics
import sys
import time
from pathlib import Path

import numpy as np

SLOW = 20.0  # seconds: what slices take longer for is measured once
CORNERS = np.array(list(itertools.product((0, 1), repeat=3)))


def main(folder):
    """Write every solid of `SOLIDS` into the folder, made if it is not there."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for name, (make, arguments) in SOLIDS.items():
        points, faces = make(**arguments)
        write_ply(folder / f"{name}.ply", points, faces)
        print(f"{name}: {len(points):,} vertices, {len(faces):,} faces")


def measure_graphs(names):
    """Print a row for each solid, measured in a process of its own."""
    print("| solid | faces | critical points | surface, s | solid by trees, s | by slices, s | bytes a face |")
    print("| --- |" + " ---: |" * 6)
    for name in names or [*SOLIDS, *SHEETS]:
        child = multiprocessing.Process(target=_measure, args=(name,))
        child.start()
        child.join()


def _measure(name):
    """Print the row of one solid."""
    from reebslice.errors import TooManyCrossingsError
    from reebslice.graphs.exact import merged_solid_graph, sliced_solid_graph
    from reebslice.morse.height_mesh import height_mesh
    from reebslice.morse.reeb_graph import surface_reeb_graph

    def timed(make, *arguments):
        begin = time.process_time()
        try:
            return make(*arguments), time.process_time() - begin
        except TooManyCrossingsError:
            return None, time.process_time() - begin

    for arguments in (bumpy_torus(60, 30, 0.4, 1), SOLIDS[name] if name in SOLIDS else SHEETS[name]):
        arrays, before = arguments[0](**arguments[1]) if callable(arguments[0]) else arguments, _peak()
        mesh = height_mesh(*arrays)
        body, seconds, grown = np.zeros(len(mesh.points), np.int32), ([], [], []), 0
        while len(seconds[2]) < 3 and sum(seconds[2]) < SLOW:
            graph, taken = timed(surface_reeb_graph, mesh)
            seconds[0].append(taken)
            (nodes, arcs), taken = timed(merged_solid_graph, mesh, graph, body)
            seconds[1].append(taken)
            grown = grown or _peak() - before
            found, taken = timed(sliced_solid_graph, mesh, graph, body)
            seconds[2].append(taken)
        if found and not (len(found[0]) == len(nodes) and (found[0] == nodes).all() and (found[1] == arcs).all()):
            print(f"{name}: slices keep pairs of one height, or give another graph")
    cells = [f"{len(mesh.faces):,}", f"{len(graph.nodes):,}", *(f"{statistics.median(taken):.3f}" for taken in seconds)]
    print(f"| {name} | " + " | ".join([*cells, f"{grown / len(mesh.faces):.0f}"]) + " |", flush=True)


def _peak():
    """Most memory that this process has held, bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def white_sheet(size, seed):
    """A square sheet whose two sides have random heights, white noise on a lattice; points (n, 3), faces (m, 3).

    A critical point at every second vertex or so. It does not cross itself.
    """
    k = np.arange(size)
    x, y = np.meshgrid(k, k, indexing="ij")
    heights = 1 + np.random.default_rng(seed).random((2, size, size))
    points = np.concatenate([np.stack([x, y, z], axis=-1).reshape(-1, 3) for z in (heights[0], -heights[1])])
    a = (np.arange(size - 1)[:, None] * size + np.arange(size - 1)).ravel()
    upper = np.concatenate([np.stack([a, a + size, a + size + 1], axis=1), np.stack([a, a + size + 1, a + 1], axis=1)])
    rim = np.concatenate([k[:-1] * size, (size - 1) * size + k[:-1], k[:0:-1] * size + size - 1, k[:0:-1]])
    ahead, down = np.roll(rim, -1), size * size
    side = np.concatenate([np.stack([rim + down, ahead + down, ahead], 1), np.stack([rim + down, ahead, rim], 1)])
    return points, np.concatenate([upper, upper[:, ::-1] + down, side])


def bumpy_torus(around, across, amplitude, seed):
    """A standing ring with four low waves, and white noise along its normals; genus 1.

    `amplitude` : standard deviation of the noise, as a part of an edge's
    length along the tube; noise beyond 3 standard deviations is cut off, so
    that the surface does not cross itself. Returns points (n, 3), faces (m, 3).
    """
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    noise = np.random.default_rng(seed).standard_normal(u.shape).clip(-3, 3)
    tube = 0.35 + 0.04 * np.cos(4 * u) + amplitude * noise * 2 * np.pi * 0.35 / across
    out = 1 + tube * np.cos(v)
    points = np.stack([tube * np.sin(v), out * np.cos(u), out * np.sin(u)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    corner = [((i + a) % around * across + (j + b) % across).ravel() for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = np.concatenate([np.stack([corner[k] for k in face], axis=1) for face in ((0, 1, 2), (0, 2, 3))])
    return points, faces


def noisy_plate(size, white, waves, seed):
    """A leaning plate with five holes of unlike sizes, its volume noisy; genus 5 and what the noise adds.

    size : voxels along the longest side; white, waves : standard deviations,
    in voxels, of the noise of each voxel and of that with a wave length from
    8 voxels. A white noise above about 1 leaves islands, voids and tiny
    tunnels. Returns points (n, 3), mesh units of a voxel, faces (m, 3).
    """
    shape = np.array([size, size // 2, size])
    x, y, z = (np.arange(n, dtype=float) - (n - 1) / 2 for n in shape)
    x, y, z = np.meshgrid(x / size, y / size, z / size, indexing="ij", sparse=True)
    y = y + 0.2 * z + 0.1 * x
    plate = 0.11 - np.abs(y) + 0 * x
    disk = 0.43 - np.sqrt(x**2 + z**2) + 0 * y
    body = -_soft_least(-plate, -disk)
    for angle, far, radius in (
        (0.3, 0.24, 0.1),
        (1.6, 0.25, 0.085),
        (2.9, 0.26, 0.07),
        (4.1, 0.24, 0.09),
        (5.2, 0.27, 0.055),
    ):
        hole = np.sqrt((x - far * np.cos(angle)) ** 2 + (z - far * np.sin(angle)) ** 2) - radius + 0 * y
        body = np.minimum(body, hole)
    random = np.random.default_rng(seed)
    rough = random.standard_normal(body.shape)
    wavy = _long_waves(random.standard_normal(body.shape), 8.0)
    return isosurface(body * size + white * rough + waves * wavy)


def _soft_least(a, b):
    """A maximum with a rounded edge."""
    return np.maximum(a, b) + 0.02 * np.exp(-np.abs(a - b) / 0.02)


def _long_waves(noise, shortest):
    """What of the noise has a wave length from `shortest` voxels, with standard deviation 1."""
    frequency = np.sqrt(sum(f**2 for f in np.meshgrid(*map(np.fft.fftfreq, noise.shape), indexing="ij", sparse=True)))
    smooth = np.fft.ifftn(np.fft.fftn(noise) * np.exp(-((frequency * shortest) ** 2))).real
    return smooth / smooth.std()


def isosurface(values):
    """Where values (a, b, c) turn positive inward, as a closed surface: points (n, 3), faces (m, 3).

    Every cube is cut along its diagonal into six tetrahedra, which fit those
    of its neighbours, so the surface is a manifold that does not cross itself,
    whatever the values. Its faces are counter-clockwise seen from where values
    are negative; outside the array they are. Unit: one step of the array.
    """
    values = np.pad(values, 1, constant_values=min(-1.0, float(values.min())))
    inside, flat = values > 0, values.ravel()
    steps = np.array([inside.shape[1] * inside.shape[2], inside.shape[2], 1])
    cell = [slice(None, -1), slice(1, None)]
    count = sum(inside[tuple(cell[k] for k in corner)].astype(np.int8) for corner in CORNERS)
    first = np.stack(np.nonzero((count > 0) & (count < 8)), axis=1) @ steps
    faces = []
    for axes in itertools.permutations(range(3)):
        tetrahedron = first[:, None] + np.concatenate([[0], np.cumsum(steps[list(axes)])])
        even = np.linalg.det(np.eye(3)[list(axes)]) > 0
        faces.append(_cut_tetrahedra(tetrahedron if even else tetrahedron[:, [0, 1, 3, 2]], flat > 0))
    ends, faces = np.unique(np.concatenate(faces).reshape(-1, 2), axis=0, return_inverse=True)
    low, high = ends.T
    share = (flat[low] / (flat[low] - flat[high])).clip(0.05, 0.95)
    places = [np.stack(np.unravel_index(end, values.shape), axis=1) for end in (low, high)]
    return places[0] + share[:, None] * (places[1] - places[0]) - 1, faces.reshape(-1, 3)


def _cut_tetrahedra(corners, positive):
    """Faces (m, 3, 2) of the surface in tetrahedra (k, 4): each corner is a grid edge (lower end, higher end)."""
    code = positive[corners] @ [1, 2, 4, 8]
    faces = []
    for pattern in range(1, 15):
        within = [k for k in range(4) if pattern >> k & 1]
        without = [k for k in range(4) if not pattern >> k & 1]
        if len(within) == 2:
            (a, b), (c, d) = within, without
            ring = [(a, c), (a, d), (b, d), (b, c)]
        else:
            (a,), others = (within, without) if len(within) == 1 else (without, within)
            ring = [(a, k) for k in others]
        triangles = [[ring[0], ring[k], ring[k + 1]] for k in range(1, len(ring) - 1)]
        found = corners[code == pattern]
        for triangle in triangles:
            triangle = triangle if _faces_outward(triangle, within) else triangle[::-1]
            faces.append(np.sort(found[:, triangle], axis=2))
    return np.concatenate(faces)


def _faces_outward(triangle, within):
    """Whether a cut is counter-clockwise seen from the corners outside, in the tetrahedron 0, x, xy, xyz."""
    place = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]], float)
    p, q, r = (place[list(edge)].mean(axis=0) for edge in triangle)
    return np.cross(q - p, r - p) @ (place[within].mean(axis=0) - p) < 0


def write_ply(path, points, faces):
    """Binary PLY with coordinates in double precision."""
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property double {axis}" for axis in "xyz"]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    rows = np.empty(len(faces), [("n", "u1"), ("corners", "<i4", 3)])
    rows["n"], rows["corners"] = 3, faces
    Path(path).write_bytes("\n".join([*head, ""]).encode() + points.astype("<f8").tobytes() + rows.tobytes())


SOLIDS = {
    "torus_rough": (bumpy_torus, {"around": 600, "across": 300, "amplitude": 0.4, "seed": 1}),
    "torus_wild": (bumpy_torus, {"around": 800, "across": 400, "amplitude": 4.0, "seed": 2}),
    "plate_rough": (noisy_plate, {"size": 125, "white": 0.3, "waves": 1.0, "seed": 3}),
    "plate_pitted": (noisy_plate, {"size": 105, "white": 0.8, "waves": 1.0, "seed": 4}),
    "plate_porous": (noisy_plate, {"size": 80, "white": 1.6, "waves": 1.0, "seed": 5}),
}

SHEETS = {f"sheet_{2 * size**2:,}": (white_sheet, {"size": size, "seed": 0}) for size in (100, 200, 350, 500)}

if __name__ == "__main__":
    measure_graphs(sys.argv[2:]) if sys.argv[1] == "--graphs" else main(sys.argv[1])
