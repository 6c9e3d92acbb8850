"""Compare reebslice with every peer that is installed, on the same arrays.

    python -m venv .venv-benchmarks
    .venv-benchmarks/bin/pip install -r benchmarks/requirements.txt
    .venv-benchmarks/bin/python benchmarks/compare_peers.py [--rounds N] [--limit SECONDS] [--only PROGRAM ...]

Measures slicing, Reeb graphs and skeletons, each run in a process of its own
and the programs in turn, writes one row per run to a Parquet table, and puts
the tables of docs/benchmarks.md in place and its figure beside it. A peer that
is not installed is skipped, and the page says so. With --page-only the page is
made anew from the table.
"""

import argparse
import json
import signal
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from benchmark_page import draw_growth, write_page
from bumpy_meshes import bumpy_torus, level_heights, white_noise
from entrants import ENTRANTS

ROOT = Path(__file__).parents[1]
MEASURE = Path(__file__).with_name("measure.py")
SLOW = 10.0  # seconds: what takes longer is run once


class Cell(NamedTuple):
    """One mesh, asked for some tasks: `shape` is "lying", "upright" or "noise", `levels` is 0 where no task slices."""

    tasks: tuple
    shape: str
    faces: int
    levels: int = 0
    bumps: int = 12


GRAPHS, SLICES = ("surface graph", "solid graph"), ("contours", "regions")
CELLS = [
    *(Cell(SLICES, "lying", faces, levels) for faces in (100_000, 1_000_000) for levels in (100, 1000, 4000)),
    *(Cell(GRAPHS, "upright", faces) for faces in (10_000, 30_000, 100_000, 300_000, 1_000_000, 4_000_000)),
    *(Cell(GRAPHS[:1], "upright", 1_000_000, bumps=bumps) for bumps in (24, 48, 96, 192)),
    Cell(GRAPHS[:1], "noise", 1_000_000),
    Cell(GRAPHS, "lying", 10_000),
    Cell(("skeleton",), "upright", 10_000),
]
# Beyond this the time limit would not be the first limit reached: VTK takes 17 kB per face at 100,000
# faces and more with each, and was killed at 24 GB on a million.
LARGEST = {("VTK", "surface graph"): 100_000}


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--rounds", type=int, default=3, help=f"runs of each, unless one takes {SLOW:g} s (default 3)")
    parser.add_argument("--limit", type=float, default=30.0, help="processor seconds that a run may take (default 30)")
    parser.add_argument("--only", nargs="+", default=None, metavar="PROGRAM")
    parser.add_argument("--table", type=Path, default=Path("results/benchmarks/peers.parquet"))
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "benchmarks.md")
    parser.add_argument("--figure", type=Path, default=ROOT / "docs" / "benchmarks.svg")
    parser.add_argument("--page-only", action="store_true", help="make the page from the table of an earlier run")
    options = parser.parse_args(arguments)
    if not options.page_only:
        table = measure_cells(CELLS, options.rounds, options.limit, options.only)
        options.table.parent.mkdir(parents=True, exist_ok=True)
        table.to_parquet(options.table, index=False)
    table = pd.read_parquet(options.table)
    write_page(options.page, table)
    draw_growth(options.figure, table)


def measure_cells(cells, rounds, limit, only=None):
    """One row per run, as a data frame; a program that fails or is skipped has a row that says why."""
    rows = []
    for cell in cells:
        entrants = [one for one in ENTRANTS if one.task in cell.tasks and (only is None or one.program in only)]
        with tempfile.TemporaryDirectory() as folder:
            faces = write_mesh(cell, Path(folder))
            facts = {"shape": cell.shape, "nominal": cell.faces, "faces": faces}
            facts |= {"levels": cell.levels, "bumps": cell.bumps}
            for turn in range(rounds):
                for one in entrants:
                    status = "ok" if turn else skip_reason(one, cell, rows)
                    if turn and is_settled(one, facts, rows):
                        continue
                    figures = run_entrant(one, folder, limit) if status == "ok" else {"status": status}
                    named = {"program": one.program, "version": find_version(one), "task": one.task, "round": turn}
                    rows.append(named | facts | figures)
                    print(json.dumps(rows[-1]), flush=True)
    return pd.DataFrame(rows)


def write_mesh(cell, folder):
    """Write the arrays of a cell, return the number of faces."""
    shape = white_noise(cell.faces) if cell.shape == "noise" else bumpy_torus(cell.faces, cell.bumps, cell.shape)
    for name, array in zip(("points", "faces", "heights"), (*shape, level_heights(shape[0], cell.levels))):
        np.save(folder / f"{name}.npy", array)
    return len(shape[1])


def skip_reason(one, cell, rows):
    """Why an entrant is not to run on a cell, or "ok"."""
    if one.package and find_version(one) is None:
        return "not installed"
    if cell.faces > LARGEST.get((one.program, one.task), np.inf):
        return "too large"
    for row in rows:
        same = (row["program"], row["task"]) == (one.program, one.task)
        larger = row["faces"] > cell.faces * 1.01 or row["levels"] > cell.levels
        if same and row["status"] == "over the limit" and not larger:
            return "over the limit"
    return "ok"


def is_settled(one, facts, rows):
    """Whether an entrant needs no further run on a mesh: it did not answer, or takes long."""
    first = next(
        row for row in rows
        if (row["program"], row["task"]) == (one.program, one.task) and all(row[key] == facts[key] for key in facts)
    )  # fmt: skip
    return first["status"] != "ok" or first["raw_wall"] > SLOW


def run_entrant(one, folder, limit):
    """The figures that a run printed, and its status: "ok", "over the limit", or what went wrong."""
    command = [sys.executable, str(MEASURE), one.program, one.task, folder, str(limit)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603, the project's own programs
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    figures = {key: value for line in lines for key, value in json.loads(line).items()}
    if done.returncode == 0 or (done.returncode == -signal.SIGXCPU and "raw" in figures):
        return figures | {"status": "ok"}  # the warm run may be missing
    stopped = done.returncode == -signal.SIGXCPU
    reason = done.stderr.strip().splitlines()[-1:] or [f"signal {-done.returncode}"]
    return {"status": "over the limit" if stopped else f"failed: {reason[0]}"}


def find_version(one):
    """Version of an entrant's package, None if it is not installed, "" for what needs none."""
    try:
        return metadata.version(one.package) if one.package else ""
    except metadata.PackageNotFoundError:
        return None


if __name__ == "__main__":
    main()
