"""Measure what a small corpus costs, with one or more checkouts in turn.

    python benchmarks/measure_small_corpus.py FOLDER CHECKOUT... [--rounds 3] [--first]

Runs the workflow of every checkout over the nine examples on two cores: anew, with another distance between levels, and
with nothing to do. Prints wall clock and processor time in s, medians of the rounds, in which the checkouts take turns.
What the first run of a new checkout compiles is left out; with --first it is measured, once, and nothing else is.
A checkout has its own environment in `.venv`, as `make` leaves it.
"""

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import time
from pathlib import Path

ANOTHER = ("--config", "levels={distance: 0.03}")
RUNS = {"anew": (), "another distance": ANOTHER, "nothing to do": ANOTHER}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("checkouts", type=Path, nargs="+")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--first", action="store_true")
    asked = parser.parse_args()
    checkouts = [path.resolve() for path in asked.checkouts]
    make_meshes(asked.folder, checkouts[0])
    if asked.first:
        for checkout in checkouts:
            for compiled in (checkout / "workflow/scripts/reebslice/__pycache__").glob("numba-*"):
                shutil.rmtree(compiled)
            print(checkout, "first run: {:.1f} s, processor {:.1f} s".format(*run(asked.folder, checkout)), flush=True)
        return
    taken = {(checkout, name): [] for checkout in checkouts for name in RUNS}
    for number in range(asked.rounds + 1):  # in the first of them it is seen to that all is compiled
        for checkout in checkouts:
            shutil.rmtree(asked.folder / "results", ignore_errors=True)
            for name, arguments in RUNS.items():
                seconds = run(asked.folder, checkout, *arguments)
                if number:
                    taken[checkout, name].append(seconds)
    for (checkout, name), seconds in taken.items():
        wall, processor = map(statistics.median, zip(*seconds))
        print(f"{checkout} {name}: {wall:.1f} s, processor {processor:.1f} s")


def make_meshes(folder, checkout):
    """Write the nine examples."""
    folder.mkdir(parents=True, exist_ok=True)
    if not (folder / "data/meshes").is_dir():
        script = checkout / "workflow/scripts/make_examples.py"
        subprocess.run([checkout / ".venv/bin/python", script, folder / "data/meshes"], check=True)  # noqa: S603, ours


def run(folder, checkout, *arguments):
    """Run the workflow of a checkout; return wall clock and processor time."""
    command = [checkout / ".venv/bin/python", "-m", "snakemake", "--snakefile", checkout / "Snakefile", "--cores", "2"]
    before, begun = spent(), time.perf_counter()
    environment = {name: value for name, value in os.environ.items() if name not in ("NUMBA_CACHE_DIR", "PYTHONPATH")}
    command += ["--directory", folder, *arguments]
    subprocess.run(command, check=True, capture_output=True, env=environment)  # noqa: S603, ours
    return time.perf_counter() - begun, spent() - before


def spent():
    """Processor time of all children that have ended, in s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
