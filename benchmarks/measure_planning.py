"""Measure what a run costs that has nothing to compute, over a corpus of any size, without computing one.

    python benchmarks/measure_planning.py FOLDER [COUNT] [ROUNDS]

Runs the workflow on one box, gives COUNT models (10,000) copies of its mesh and
of what came of it, each with receipts of its own, and then runs the workflow
over all of them: first without status tables, when every job digests all files
of its models and takes them over; then ROUNDS times (5) with nothing to do; as
often with one mesh changed; and once with `verify`. Prints wall clock and
processor time of each, in s, and the number of jobs.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from corpus.layout import STAGES
from corpus.receipts import read_receipt, write_receipt

# Sheared, so that no two vertices are at one height.
POINTS = [(x + 0.1 * y, y, z + 0.1 * x + 0.03 * y) for x in (0, 2) for y in (0, 3) for z in (0, 5)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def main(folder, count="10000", rounds="5"):
    folder = Path(folder)
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "00000.off").write_text(box())
    print("one model", run(folder))
    for number in range(1, int(count)):
        copy_model(folder, f"{number:05d}")
    for table in (folder / "results" / "status").rglob("*.parquet"):
        table.unlink()
    print("taken over", run(folder))
    for _ in range(int(rounds)):
        print("nothing to do", run(folder), flush=True)
    for number in range(int(rounds)):
        change_mesh(folder / "meshes" / "00001.off", 1.01 + 0.01 * number)
        print("one mesh changed", run(folder), flush=True)
    print("verify", run(folder, "verify=true"))


def box(stretch=1.0):
    """The text of an OFF file."""
    points = [(stretch * x, y, z) for x, y, z in POINTS]
    faces = [corners for a, b, c, d in QUADS for corners in ((a, b, c), (a, c, d))]
    lines = ["OFF", f"{len(POINTS)} {len(faces)} 0", *(" ".join(map(str, point)) for point in points)]
    return "\n".join(lines + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n"


def change_mesh(path, stretch):
    """Put another box in the place of a mesh, whose bytes others may share."""
    path.unlink()
    path.write_text(box(stretch))


def copy_model(folder, model):
    """Give a model the mesh and the results of the first, by links, and receipts of its own."""
    os.link(folder / "meshes" / "00000.off", folder / "meshes" / f"{model}.off")
    first, target = (folder / "results" / "models" / name for name in ("00000", model))
    target.mkdir()
    for name in (name for name in os.listdir(first) if not name.startswith(".")):
        os.link(first / name, target / name)
    for stage in STAGES:
        if receipt := read_receipt(first, stage):  # one that the configuration wants
            write_receipt(target, stage, receipt)


def run(folder, *config):
    """Run the workflow; return, as text, wall clock and processor time in s, and the number of jobs."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", ROOT / "Snakefile", "--cores", "2"]
    command += ["--directory", folder, "--config", "meshes=meshes", *config]
    before, start = os.times(), time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603, the project's own programs
    wall, after = time.perf_counter() - start, os.times()
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    used = after.children_user + after.children_system - before.children_user - before.children_system
    jobs = max((folder / ".snakemake" / "log").iterdir()).read_text().count("Finished jobid")  # the last by its name
    return json.dumps({"wall": round(wall, 2), "processor": round(used, 2), "jobs": jobs})


if __name__ == "__main__":
    main(*sys.argv[1:])
