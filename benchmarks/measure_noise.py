"""Measure noise on meshes: critical points, what an exact graph would take, what the default configuration shows.

    python benchmarks/measure_noise.py MESH... [--page docs/noise.md] [--results FOLDER] [--keep]

Runs all stages with config/config.yaml and puts the table of the page in place,
a row for every accepted mesh. With --keep, results that are there are taken.
"""

import argparse
from pathlib import Path

from corpus.stages import Rejected
from model_runs import ROOT, read_figures, run_model
from pages import put_table

HEAD = (
    "| model | faces | critical points | fewest levels | exact distance | levels | events | genus | shown "
    "| suppressed | hidden |",
    "| --- |" + " ---: |" * 10,
)


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("meshes", nargs="+", type=Path)
    parser.add_argument("--page", type=Path, default=ROOT / "docs" / "noise.md")
    parser.add_argument("--results", type=Path, default=Path("results/benchmarks/noise"))
    parser.add_argument("--keep", action="store_true")
    options = parser.parse_args(arguments)
    found = {}
    for mesh in options.meshes:
        try:
            found[mesh.stem] = read_figures(run_model(mesh, options.results, options.keep))
            print(write_row(mesh.stem, found[mesh.stem]), found[mesh.stem]["verdict"], flush=True)
        except Rejected as reason:
            print(f"{mesh.stem}: {reason}", flush=True)
    order = sorted(found, key=lambda name: (-found[name]["critical"], name))
    lines = [*HEAD, *(write_row(name, found[name]) for name in order)]
    put_table(options.page, "models", lines)


def write_row(name, figures):
    """One line of the table. An exact distance is a part of the height."""
    distance = figures["exact_distance"]
    cells = [f"{figures[key]:,}" for key in ("faces", "critical", "fewest_levels")]
    cells += ["< 1e-6" if distance is None else f"{distance:.2g}"]
    cells += [f"{figures[key]:,}" for key in ("levels", "events", "genus", "loops", "suppressed", "hidden")]
    return f"| {name} | " + " | ".join(cells) + " |"


if __name__ == "__main__":
    main()
