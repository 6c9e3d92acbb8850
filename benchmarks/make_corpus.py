"""Write a corpus to measure on: thousands of closed meshes of 1,000 to 50,000 faces each.

    python benchmarks/make_corpus.py FOLDER COUNT [REAL]

Small ones are more frequent: half have up to 3,100 faces, and the mean is 7,100.
Half of them are varied copies of the meshes in the folder REAL, where it is
given: those that are closed and have no more than 50,000 faces, refined,
turned, stretched and twisted. The others are bumpy tori and machined blocks
with holes and cavities. The same COUNT and REAL give the same files.
"""

import sys
from functools import cache
from pathlib import Path

import manifold3d
import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from bumpy_meshes import bumpy_torus
from noisy_volumes import write_ply

FEWEST, MOST = 1_000, 50_000  # faces


def main(folder, count, real=None):
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = find_closed(real) if real else []
    for number in range(int(count)):
        random = np.random.default_rng([7, number])
        target = random.uniform(MOST**-0.5, FEWEST**-0.5) ** -2  # density falls as faces ** -1.5
        if paths and number % 2:
            name, (points, faces) = choose_refined(paths, target, random)
        elif number % 4:
            name, (points, faces) = "block", machine_block(target, random)
        else:
            name, (points, faces) = "torus", bumpy_torus(target, bumps=3 * random.integers(1, 6))
        write = write_stl if random.random() < 0.5 else write_ply
        ending = write.__name__[-3:]
        write(folder / f"{number:05d}_{name}.{ending}", vary(points, random), faces)


def find_closed(folder):
    """Paths of the closed meshes of `folder` that have not too many faces."""
    paths = sorted(path for path in Path(folder).iterdir() if path.suffix.lower() in (".stl", ".obj", ".ply", ".off"))
    return [path for path in paths if (mesh := load(path)) and mesh.is_watertight and len(mesh.faces) <= MOST]


@cache
def load(path):
    """The mesh in a file, or None where it cannot be read or is empty."""
    try:
        mesh = trimesh.load_mesh(path)
    except Exception:  # whatever a reader says of a bad file
        return None
    return mesh if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces) else None


def choose_refined(paths, target, random):
    """Name, and points and faces, of a mesh drawn from those that have not more faces than wanted."""
    path = random.choice([path for path in paths if len(load(path).faces) <= target])
    doublings = int(np.log2(target / len(load(path).faces)))
    return path.stem, refined(path, doublings)


@cache
def refined(path, doublings):
    """Points and faces of a mesh with about 2 ** `doublings` times as many faces."""
    if doublings == 0:
        return np.array(load(path).vertices), np.array(load(path).faces)
    points, faces = refined(path, doublings - 1)
    wanted = 2 * len(faces)
    while len(faces) < 0.9 * wanted:
        points, faces = split_longest(points, faces)
    return points, faces


def split_longest(points, faces):
    """Split every edge in two that is the longest of all its faces: what longest-edge bisection does first."""
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
    edges, edge_of = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    edge_of = edge_of.reshape(-1, 3)
    rank = np.argsort(np.argsort(-np.linalg.norm(np.diff(points[edges], axis=1)[:, 0], axis=1), kind="stable"))
    longest = np.argmin(rank[edge_of], axis=1)
    of_face = edge_of[np.arange(len(faces)), longest]
    split = np.bincount(of_face, minlength=len(edges)) == np.bincount(edge_of.ravel(), minlength=len(edges))
    middle = np.full(len(edges), -1)
    middle[split] = len(points) + np.arange(split.sum())
    halved = np.flatnonzero(split[of_face])
    a, b, c = (faces[halved, (longest[halved] + step) % 3] for step in range(3))
    m = middle[of_face[halved]]
    halves = np.concatenate([np.column_stack([a, m, c]), np.column_stack([m, b, c])])
    points = np.concatenate([points, points[edges[split]].mean(axis=1)])
    return points, np.concatenate([np.delete(faces, halved, axis=0), halves])


def machine_block(target, random):
    """A block with round and square holes, cavities and lugs, refined to about `target` faces."""
    solid = manifold3d.Manifold.cube((6.0, 5.0, 4.0))
    for _ in range(random.integers(2, 9)):
        place, kind = random.uniform(0.5, 4.5, 3), random.integers(3)
        if kind == 0:
            part = manifold3d.Manifold.cylinder(12.0, random.uniform(0.2, 0.6), circular_segments=24, center=True)
            part = part.rotate([(0, 0, 0), (90, 0, 0), (0, 90, 0)][random.integers(3)])
        elif kind == 1:
            part = manifold3d.Manifold.sphere(random.uniform(0.3, 0.8), 24)
        else:
            part = manifold3d.Manifold.cube(tuple(random.uniform(0.5, 3.0, 3)), True)
        part = part.translate(tuple(place))
        solid = solid + part if random.random() < 0.25 else solid - part
    mesh = solid.refine(max(1, round(np.sqrt(target / solid.num_tri())))).to_mesh64()
    return np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, dtype=np.int64)


def vary(points, random):
    """Turn, stretch and twist points by maps of space that are one to one, so that sheets stay apart."""
    points = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    points = points @ Rotation.random(random_state=random).as_matrix().T * random.uniform(0.6, 1.6, 3)
    angle = random.uniform(-1.0, 1.0) * points[:, 2]
    twisted = (points[:, 0] + 1j * points[:, 1]) * np.exp(1j * angle)
    return 100.0 * np.column_stack([twisted.real, twisted.imag, points[:, 2]])


def write_stl(path, points, faces):
    """Write a binary STL file, normals left zero."""
    records = np.zeros(len(faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    records["corners"] = points[faces]
    path.write_bytes(bytes(80) + np.uint32(len(faces)).tobytes() + records.tobytes())


if __name__ == "__main__":
    main(*sys.argv[1:])
