"""Measure centrelines against known ones and against other programs: the table of docs/centrelines.md.

    python -m venv .venv-benchmarks
    .venv-benchmarks/bin/pip install -r benchmarks/requirements.txt
    .venv-benchmarks/bin/python benchmarks/measure_centrelines.py [--vessel SURFACE.stl CENTRELINE.vtp]

The vessel and VMTK's centreline of it: aorta-surface.stl and aorta-centerline.vtp, in the folder `input` of VMTK's
repository of test data, vmtk-test-data. VMTK itself (`pip install vmtk`) has wheels for Python 3.12 alone. A program
that is not installed says so in its row; one that does not come to an end in `--limit` seconds is stopped.
"""

import argparse
import multiprocessing
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from tubes import Tube, make_knot, make_tree

HEAD = (
    "| model | faces | program | centres off, mean / 95 % | missed, 95 % | radius off, mean |"
    " loops | parts | seconds |\n"
    "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |"
)


# Programs: points, steps between them, and radii or None


def trace(points, faces):
    from reebslice.graphs.centrelines import find_centrelines

    lines = find_centrelines(points, faces)
    member, start = lines.branches.member, lines.branches.start
    steps = np.column_stack([member[:-1], member[1:]])
    return lines.points, np.delete(steps, start[1:-1] - 1, axis=0), lines.radius


def run_skeletor(way, points, faces):
    import skeletor
    import trimesh

    mesh = trimesh.Trimesh(points, faces, process=False)
    size = float(np.ptp(points, axis=0).max())
    if way == "vertex clusters":
        contracted = skeletor.pre.contract(mesh, epsilon=0.1, progress=False)
        found = skeletor.skeletonize.by_vertex_clusters(contracted, sampling_dist=size / 50, progress=False)
        found.mesh = mesh
        found = skeletor.post.clean_up(found)
        skeletor.post.radii(found, method="knn")
    elif way == "wavefront":
        found = skeletor.skeletonize.by_wavefront(mesh, waves=1, step_size=1, progress=False)
    elif way == "wavefront, exact":
        found = skeletor.skeletonize.by_wavefront_exact(mesh, step_size=size / 200, progress=False)
    elif way == "TEASAR":
        found = skeletor.skeletonize.by_teasar(mesh, inv_dist=size / 20, progress=False)
    else:
        found = skeletor.skeletonize.by_tangent_ball(mesh)
    radius = found.radius
    radius = radius[0] if isinstance(radius, tuple) else radius
    return np.array(found.vertices), np.array(found.edges), None if radius is None else np.array(radius, float)


def run_vmtk(points, faces, ends):
    """VMTK's centrelines from the first of the ends, which are its to be told, to the others."""
    from vmtk import vmtkscripts
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    places, cells, program = vtkPoints(), vtkCellArray(), vmtkscripts.vmtkCenterlines()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(faces, dtype=np.int64).ravel(), deep=True))
    program.Surface = vtkPolyData()
    program.Surface.SetPoints(places)
    program.Surface.SetPolys(cells)
    program.SeedSelectorName = "pointlist"
    program.SourcePoints, program.TargetPoints = ends[0].tolist(), ends[1:].ravel().tolist()
    program.AppendEndPoints = 1
    program.InputInfo = program.PrintLog = lambda *_: None
    program.Execute()
    places, steps, radii = read_lines(program.Centerlines)
    places, first, same = np.unique(places, axis=0, return_index=True, return_inverse=True)
    steps = same[steps]
    if (steps[:, 0] == steps[:, 1]).all():
        raise ValueError("it reaches no end")
    return places, steps, radii[first]


WAYS = ("wavefront", "wavefront, exact", "vertex clusters", "TEASAR", "tangent ball")
PROGRAMS = {"reebslice": lambda tube: trace(tube.points, tube.faces)}
PROGRAMS |= {f"skeletor, {way}": lambda tube, way=way: run_skeletor(way, tube.points, tube.faces) for way in WAYS}
PROGRAMS["VMTK, told the ends"] = lambda tube: run_vmtk(tube.points, tube.faces, find_ends(tube))


def call(program, tube, pipe):
    """Run a program twice, as the first run compiles; send what it finds and the seconds of the second run."""
    try:
        PROGRAMS[program](tube)
        start = time.perf_counter()
        found = PROGRAMS[program](tube)
        pipe.send((found, time.perf_counter() - start))
    except Exception as fault:
        pipe.send((f"{type(fault).__name__}: {fault}".splitlines()[0][:90], None))


def run(program, tube, limit):
    """What a program finds, and its seconds; a sentence and None where it fails or takes too long."""
    near, far = multiprocessing.Pipe()
    child = multiprocessing.Process(target=call, args=(program, tube, far))
    child.start()
    far.close()
    try:
        answer = near.recv() if near.poll(2 * limit) else (f"more than {limit:.0f} s", None)
    except EOFError:
        answer = ("it ended its process", None)
    child.kill()
    child.join()
    return answer


# Figures


def resample(points, steps, radii, spacing):
    """Points along segments, no farther apart than this, and the radii there."""
    places, sizes = [], []
    for k, (a, b) in enumerate(points[steps]):
        t = np.linspace(0, 1, 2 + int(np.linalg.norm(b - a) / spacing))[:, None]
        places.append(a + t * (b - a))
        sizes.append(radii[steps[k, 0]] + t[:, 0] * (radii[steps[k, 1]] - radii[steps[k, 0]]))
    return np.concatenate(places), np.concatenate(sizes)


def measure(tube, points, steps, radius):
    """Distances in shares of the true radius, both ways; radii; loops and parts."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    spacing = tube.radii.min() / 20
    ends = np.arange(2 * len(tube.segments)).reshape(-1, 2)
    truth, size = resample(tube.segments.reshape(-1, 3), ends, tube.radii.ravel(), spacing)
    steps = steps[steps[:, 0] != steps[:, 1]]
    told = np.full(len(points), np.nan) if radius is None else radius
    found, told = resample(points, steps, told, spacing)
    off, at = cKDTree(truth).query(found)
    missed = cKDTree(found).query(truth)[0] / size
    steps = np.unique(np.sort(steps, axis=1), axis=0)
    links = coo_array((np.ones(len(steps)), steps.T), shape=(len(points),) * 2)
    label = connected_components(links, directed=False)[1][np.unique(steps)]
    parts = len(np.unique(label))
    loops = len(steps) - len(label) + parts
    return off / size[at], missed, np.abs(told - size[at]) / size[at], loops, parts


def describe(name, tube, program, limit):
    """One row of the table."""
    found, seconds = run(program, tube, limit)
    head = f"| {name} | {len(tube.faces):,} | {program} |"
    if seconds is None:
        return f"{head} {found} | | | | | |"
    off, missed, radius, loops, parts = measure(tube, *found)
    wide = "" if np.isnan(radius).all() else f"{np.nanmean(radius):.0%}"
    return (
        f"{head} {off.mean():.0%} / {np.percentile(off, 95):.0%} | {np.percentile(missed, 95):.0%} | {wide} |"
        f" {loops} of {tube.loops} | {parts} | {seconds:.2f} |"
    )


def find_ends(tube):
    """Ends of the known centreline; of one without, its first point and those beside the opposite one."""
    ends, corner = np.unique(tube.segments.reshape(-1, 3), axis=0, return_inverse=True)
    steps = np.sort(corner.reshape(-1, 2), axis=1)
    steps = np.unique(steps[steps[:, 0] < steps[:, 1]], axis=0)
    loose = ends[np.bincount(steps.ravel()) == 1]
    half = len(tube.segments) // 2
    return loose if len(loose) else tube.segments[[0, half - half // 50, half + half // 50], 0]


def read_lines(data):
    """Points of a vtkPolyData, steps along its lines, and VMTK's radii."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    cells = data.GetLines()
    lines = np.split(vtk_to_numpy(cells.GetConnectivityArray()), vtk_to_numpy(cells.GetOffsetsArray())[1:-1])
    steps = np.concatenate([np.column_stack([line[:-1], line[1:]]) for line in lines])
    return points, steps, vtk_to_numpy(data.GetPointData().GetArray("MaximumInscribedSphereRadius"))


def read_vessel(surface, line):
    """A vessel, with VMTK's centreline of it as what is true."""
    import trimesh
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    mesh = trimesh.load_mesh(surface)
    mesh.merge_vertices()
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(line))
    reader.Update()
    points, steps, radius = read_lines(reader.GetOutput())
    faces = np.array(mesh.faces) if mesh.volume > 0 else np.array(mesh.faces)[:, ::-1]
    return Tube(np.array(mesh.vertices), faces, points[steps], radius[steps], 0)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--vessel", nargs=2, metavar=("SURFACE", "CENTRELINE"))
    parser.add_argument("--limit", type=float, default=120.0)
    parser.add_argument("--only", nargs="*")
    asked = parser.parse_args()
    tree = make_tree()
    shaken = np.random.default_rng(0).normal(scale=1e-3, size=tree.points.shape)
    models = {"knot": make_knot(), "tree with a loop": tree, "tree, shaken": tree._replace(points=tree.points + shaken)}
    if asked.vessel:
        models["vessel"] = read_vessel(*asked.vessel)
    print(HEAD)
    for name, tube in models.items():
        for program in PROGRAMS:
            if not asked.only or any(word in program for word in asked.only):
                print(describe(name, tube, program, asked.limit), flush=True)
