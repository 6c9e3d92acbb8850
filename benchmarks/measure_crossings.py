"""Measure the search for faces that cross, as a ratio to slicing the same mesh at 1000 levels, and beside peers.

    python benchmarks/measure_crossings.py [MESH...] [--page docs/benchmarks.md]

On the bumpy torus of 100,000 and of a million faces and on mesh files, of which
those that are accepted count. Processor time, the least of three rounds, from
arrays of the surface that inspect_mesh leaves: slicing is the order of heights
and nested contours. Puts the table of the page in place. Peers that are not
installed are left out: libigl, by CGAL's exact kernel, and meshlib.
"""

import argparse
import sys
from functools import partial
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from bumpy_meshes import bumpy_torus, level_heights
from clocks import processor_seconds
from pages import put_table
from reebslice import height_mesh, inspect_surface, nested_contours, read_mesh
from reebslice.errors import MeshFormatError
from reebslice.mesh.self_crossings import find_crossings

LEVELS, ROUNDS = 1000, 3
TORUSES = 100_000, 1_000_000
HEAD = (
    "| mesh | faces | pairs | seconds | slicing | ratio | libigl | pairs | meshlib | pairs |",
    "| --- |" + " ---: |" * 9,
)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("meshes", nargs="*", type=Path)
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "benchmarks.md")
    options = parser.parse_args(arguments)
    measure("", *bumpy_torus(600))  # compiles
    lines = list(HEAD)
    for name, points, faces in list_surfaces(options.meshes):
        lines.append(measure(name, points, faces))
        print(lines[-1], flush=True)
    put_table(options.page, "crossings", lines)


def list_surfaces(paths):
    """Yield name, points and faces of the toruses and of the accepted meshes."""
    for faces in TORUSES:
        yield "bumpy torus", *bumpy_torus(faces)
    for path in paths:
        try:
            file = read_mesh(path)
        except MeshFormatError:
            continue
        tables, _ = inspect_surface(file.points, file.faces)
        if tables is not None:
            columns = [tables["vertices"][c] for c in "xyz"], [tables["faces"][c] for c in "abc"]
            yield path.name, *map(np.column_stack, columns)


def measure(name, points, faces):
    """One line of the table."""
    seconds, found = clock(partial(find_crossings, points, faces))
    slicing, _ = clock(partial(slice_mesh, points, faces, level_heights(points, LEVELS)))
    cells = [f"{len(faces):,}".replace(",", " "), f"{len(found.pairs)}", f"{seconds:.2g}", f"{slicing:.2g}"]
    cells.append(f"{seconds / slicing:.1f}")
    for peer in (ask_libigl, ask_meshlib):
        try:
            taken, pairs = clock(peer(points, faces), 1)
        except ImportError:
            cells += ["", ""]
        else:
            cells += [f"{taken:.2g} ({taken / seconds:.1f}x)", f"{pairs}"]
    return f"| {name} | " + " | ".join(cells) + " |"


def clock(task, rounds=ROUNDS):
    """The least seconds of a task, and its answer."""
    taken = []
    for _ in range(rounds):
        begin = processor_seconds()
        answer = task()
        taken.append(processor_seconds() - begin)
    return max(min(taken), 1e-4), answer


def slice_mesh(points, faces, heights):
    nested_contours(height_mesh(points, faces), heights)


def ask_libigl(points, faces):
    """The task for libigl: how many pairs meet in more than common vertices, touching included."""
    from igl.copyleft import cgal

    faces = faces.astype(np.int64)
    return lambda: len(cgal.remesh_self_intersections(points, faces, detect_only=True)[2])


def ask_meshlib(points, faces):
    """The task for meshlib: how many faces it reports to collide with another of the mesh."""
    from meshlib import mrmeshnumpy, mrmeshpy

    faces = faces.astype(np.int32)
    return lambda: len(mrmeshpy.findSelfCollidingTriangles(mrmeshnumpy.meshFromFacesVerts(faces, points)))


if __name__ == "__main__":
    main()
