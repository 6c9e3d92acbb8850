"""Hold the graphs of CAD models against what OpenCascade says of the same STEP files.

    python benchmarks/score_cad.py run FOLDER RESULTS [--every 1] [--largest MB] [--shards 16] [--until STAGE]
    python benchmarks/score_cad.py table RESULTS...

`run` takes the STEP files of a folder, searched recursively: every so many-th by sorted path, from the first
on, without those larger than so many MB. The i-th of them is of shard i modulo the number of shards; of each
shard it writes to RESULTS/SHARD links to the files and the results of the workflow, with the default configuration
on one core. `--until certify` leaves out what comes beside the certificate. A shard that is complete is passed
over, so a run that was stopped goes on.

`table` prints what came of all complete shards: models by outcome and reason, how many have the genus and the
number of shells and of bodies that the vertices, edges and faces of the file tell (cad_topology.py, which needs
the package cadquery-ocp; kept as topology.parquet), the others by kind, seconds and memory, and clean certificates
whose numbers no peculiarity of the file explains.

FOLDER may be MFCAD (15,488 parts, https://github.com/hducg/MFCAD, `dataset/step`) or the models of Debian's
package kicad-packages3d. Nothing is fetched. For an environment that holds the project and, for `table`,
cadquery-ocp.
"""

import argparse
import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from corpus.layout import STAGES
from corpus.model_table import make_model_table

ENDINGS = (".step", ".stp")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    run = commands.add_parser("run")
    run.add_argument("folder", type=Path)
    run.add_argument("results", type=Path)
    run.add_argument("--every", type=int, default=1)
    run.add_argument("--largest", type=float, default=float("inf"))
    run.add_argument("--shards", type=int, default=16)
    run.add_argument("--until", default="all")
    run.set_defaults(do=run_shards)
    table = commands.add_parser("table")
    table.add_argument("results", type=Path, nargs="+")
    table.set_defaults(do=print_tables)
    asked = parser.parse_args()
    asked.do(asked)


def run_shards(asked):
    """Run all shards that are not complete."""
    paths = pick_files(asked.folder, asked.every, asked.largest)
    for shard in range(asked.shards):
        folder = asked.results / f"{shard:02d}"
        if not (folder / "done").exists():
            link_files(asked.folder, paths[shard :: asked.shards], folder / "meshes")
            run_workflow(folder, asked.until)
            (folder / "done").touch()
            print(folder, flush=True)


def pick_files(folder, every, largest):
    """Return the paths of STEP files below a folder: every so many-th of the sorted ones, but those of more MB."""
    paths = sorted(path for path in folder.absolute().rglob("*") if path.suffix.lower() in ENDINGS)
    return [path for path in paths[::every] if path.stat().st_size <= 1e6 * largest]


def link_files(folder, paths, target):
    """Make a folder of links to these files of another."""
    for path in paths:
        link = target / path.relative_to(folder.absolute())
        link.parent.mkdir(parents=True, exist_ok=True)
        if not link.is_symlink():
            link.symlink_to(path)


def run_workflow(folder, until):
    """Run the workflow over the meshes in a folder."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", ROOT / "Snakefile", "--cores", "1"]
    command += ["--directory", folder, "--until", until, "--config", "meshes=meshes"]
    with open(folder / "run.log", "a") as log:
        done = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, check=False)  # noqa: S603, the project's own
    if done.returncode < 0:  # not one that ends with failed models, which are rows of the tables
        sys.exit(f"{folder}: the run was killed")


# --------------------------------------------------------------------------
# What came of it


def print_tables(asked):
    """Print the tables over all complete shards of each folder of results."""
    for results in asked.results:
        shards = sorted(path.parent for path in results.glob("*/done"))
        models = pd.concat([compare_shard(shard) for shard in shards], ignore_index=True)
        print(f"\n{results}: {len(models)} models of {len(shards)} shards\n")
        print(tabulate_outcomes(models).to_string(index=False))
        others = models[models["kind"] != "agrees"]
        print("\nwhat does not agree, by kind and outcome\n")
        print(others.groupby(["kind", "outcome"]).size().to_string())
        print("\nrejected, failed and uncertified, by reason\n")
        print(shorten(models[~models["clean"]]["reason"]).value_counts().to_string())
        wrong = models[models["clean"] & models["kind"].str.endswith("unexplained")]
        print(f"\nclean certificates that nothing explains: {len(wrong)}")
        print(wrong[["path", *COMPARED]].to_string() if len(wrong) else "")


def compare_shard(shard):
    """Return the table of models of a shard, with what OpenCascade says and how that compares."""
    models, topology = read_models(shard), read_topology(shard)
    models["file"] = [os.path.relpath(shard / path, shard / "meshes") for path in models["path"]]
    models = models.merge(topology, on="file", suffixes=("", "_told"), how="left", validate="one_to_one")
    models["bodies"] = models["shells"] - models["voids"]
    models["outcome"] = models["verdict"].fillna("failed")
    interpreted = models["solid_interpretation"].fillna("") != ""
    models.loc[interpreted & models["outcome"].str.startswith("exact"), "outcome"] += ", with an interpretation"
    models["clean"] = models["outcome"].isin(["exact", "exact_at_feature_size"])
    models["kind"] = [tell_kind(row) for row in models.to_dict("records")]
    return models


def read_models(shard):
    """Return the table of models of the stages that were run."""
    here = Path.cwd()
    os.chdir(shard)
    try:
        tables = {stage: sorted(map(str, Path("results/status", stage).glob("*.parquet"))) for stage in STAGES}
        return make_model_table({stage: paths for stage, paths in tables.items() if paths}).to_pandas()
    finally:
        os.chdir(here)


# Ours, and what the file's vertices, edges and faces say.
COMPARED = {"genus": "genus_told", "shells": "shells_told", "bodies": "solids"}


def tell_kind(row):
    """Return whether a model agrees with its file in `COMPARED`, or a word for why not."""
    if row["outcome"] in ("failed", "rejected"):
        return f"no graph; the file: {tell_file(row) or 'sound'}"
    differing = [name for name, told in COMPARED.items() if row[name] != row[told]]
    if not differing:
        return "agrees"
    repairs = [name for name in ("duplicate_faces_removed", "pinch_vertices_split") if row.get(name, 0) > 0]
    return f"{', '.join(differing)}: {tell_file(row) or ', '.join(repairs) or 'unexplained'}"


def tell_file(row):
    """Return what is peculiar to a file's topology, or ''."""
    if not row["solids"] >= 0:
        return "OpenCascade's bindings cannot read it"
    found = {
        "no solid": row["solids"] == 0,
        "faces outside of solids": row["loose"] > 0,
        "edges of one, three or more faces": row["irregular"] > 0,
        "an odd Euler characteristic": row["odd"] > 0,
        "vertices where sheets touch": row["pinched"] > 0,
        "faces without edges": row["untrimmed"] > 0,
    }
    return ", ".join(name for name, there in found.items() if there)


def tabulate_outcomes(models):
    """Return a table by outcome: models, how many agree, seconds and memory."""
    stages = [name for name in models if name.startswith("seconds_")]
    peaks = [name for name in models if name.startswith("peak_memory_mb_")]
    seconds, memory = models[stages].sum(axis=1), models[peaks].max(axis=1)
    rows = []
    for outcome, group in [*models.groupby("outcome"), ("all", models)]:
        graphs = group[~group["outcome"].isin(["rejected", "failed"])]
        rows.append(
            {"outcome": outcome, "models": len(group)}
            | {name: (graphs[name] == graphs[told]).sum() for name, told in COMPARED.items()}
            | {"agree": (graphs["kind"] == "agrees").sum(), "of": len(graphs)}
            | {"seconds, median": seconds[group.index].median(), "most": seconds[group.index].max()}
            | {"MB, median": memory[group.index].median(), "most MB": memory[group.index].max()}
        )
    return pd.DataFrame(rows).round(2)


def shorten(reasons):
    """Return reasons without what differs from model to model: numbers and places."""
    return reasons.fillna("").str.replace(r"\([^)]*\)|-?\d[\d.e+-]*", "#", regex=True).str.slice(0, 150)


# --------------------------------------------------------------------------
# What the files say


def read_topology(shard):
    """Return the figures of the files of a shard, by `file`; they are measured once and kept."""
    kept = shard / "topology.parquet"
    if not kept.exists():
        from cad_topology import FIGURES, check_known_shapes

        check_known_shapes()
        paths = sorted(path for path in (shard / "meshes").rglob("*") if path.is_symlink())
        table = pd.DataFrame(list(measure_files(paths))).reindex(columns=[*FIGURES, "fault"])
        table["file"] = [str(path.relative_to(shard / "meshes")) for path in paths]
        table.to_parquet(kept)
    return pd.read_parquet(kept)


def measure_files(paths):
    """Yield the figures of STEP files, read in a process of its own; none of one that ends it."""
    pool = None
    for path in paths:
        pool = pool or ProcessPoolExecutor(1, get_context("spawn"))
        try:
            yield pool.submit(measure_file, path).result()
        except BrokenProcessPool:
            pool = None
            yield {}


def measure_file(path):
    """Return the figures of one STEP file, none where it cannot be read."""
    from cad_topology import measure_shape, read_shape

    try:
        return measure_shape(read_shape(path))
    except Exception as fault:  # of OpenCascade's, which has no common base
        return {"fault": str(fault)}


if __name__ == "__main__":
    main()
