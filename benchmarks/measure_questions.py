"""Measure what people ask of a surface beside slicing it: void, pockets, islands, loops, faces.

    python benchmarks/measure_questions.py [--page docs/benchmarks.md]

On the bumpy torus of 100,000 and of a million faces, ordered by height once. Processor time, medians of interleaved
rounds. Puts the table of the page in place.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from bumpy_meshes import bumpy_torus, level_heights
from clocks import processor_seconds
from pages import put_table
from reebslice import find_islands, find_loops, find_pockets, height_mesh, nested_contours, void_reeb_graph
from reebslice.morse.face_arcs import arcs_of_faces
from reebslice.morse.reeb_graph import surface_reeb_graph

LEVELS, ROUNDS = 1000, 7
TORUSES = 100_000, 1_000_000
HEAD = (
    "| faces | slicing | order | void's graph | pockets | islands | loops | sum | half slicing + 1 | arcs of faces |",
    "| ---: |" + " ---: |" * 9,
)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "benchmarks.md")
    options = parser.parse_args(arguments)
    measure(600)  # compiles
    lines = [*HEAD, *map(measure, TORUSES)]
    print("\n".join(lines))
    put_table(options.page, "questions", lines)


def measure(count):
    """One line of the table."""
    points, faces = bumpy_torus(count, tilt="upright")
    mesh, heights = height_mesh(points, faces), level_heights(points, LEVELS)
    tasks = [
        lambda: nested_contours(mesh, heights),
        lambda: height_mesh(points, faces),
        lambda: void_reeb_graph(mesh),
        lambda: find_pockets(mesh),
        lambda: find_islands(mesh),
        lambda: find_loops(mesh),
        lambda: arcs_of_faces(mesh, surface_reeb_graph(mesh), faces),
    ]
    slicing, *questions, arcs = np.median([[clock(task) for task in tasks] for _ in range(ROUNDS)], axis=0)
    seconds = [slicing, *questions, sum(questions), slicing / 2 + 1, arcs]
    return f"| {len(faces):,} | ".replace(",", " ") + " | ".join(f"{value:.2f}" for value in seconds) + " |"


def clock(task):
    """The seconds of a task."""
    begin = processor_seconds()
    task()
    return processor_seconds() - begin


if __name__ == "__main__":
    main()
