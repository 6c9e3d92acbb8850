"""Run the workflow over a corpus four times and tell what each run took.

    python benchmarks/measure_corpus.py MESHES RESULTS [CORES]

MESHES is a folder as of make_corpus.py; RESULTS, a new folder. The runs:
everything; nothing changed; one mesh changed (it is restored afterwards); and
another method of edges. Prints a row for each as it ends, and writes them to
RESULTS/runs.parquet. The seconds of the stages are those that the run itself
spent on models, as models.parquet has them; the rest is planning, starting
processes and reading what still holds.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pyarrow.compute as pc
import pyarrow.parquet as pq
import trimesh

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from corpus.layout import STAGES

# What each run is called, the stages that compute all models anew in it, and what differs from the configuration.
RUNS = (
    ("everything", STAGES, ()),
    ("nothing changed", (), ()),
    ("one mesh changed", (), ()),
    ("edges by similarity", STAGES[STAGES.index("synthesize_edges") :], ("edges={method: similarity}",)),
)


def main(meshes, results, cores="2"):
    meshes, results, runs = Path(meshes).absolute(), Path(results), []
    first, *others = sorted(meshes.iterdir())
    run(link([first, *others[:20]], results / "first"), results / "compiling", cores)  # else it would be measured, too
    for name, stages, options in RUNS:
        original = change(first) if name == "one mesh changed" else None
        figures = run(meshes, results, cores, options)
        runs.append({"run": name} | figures | {"stage_seconds": seconds_of(results, stages), "cores": int(cores)})
        print(runs[-1], flush=True)
        pd.DataFrame(runs).to_parquet(results / "runs.parquet")
        if original:
            first.write_bytes(original)
            run(meshes, results, cores)


def link(paths, folder):
    """A new folder with these files alone, by links."""
    folder.mkdir(parents=True)
    for path in paths:
        (folder / path.name).symlink_to(path)
    return folder.absolute()


def change(path):
    """Stretch a mesh by a hundredth in place; return the bytes that the file held."""
    original = path.read_bytes()
    mesh = trimesh.load_mesh(path, process=False)
    mesh.vertices[:, 0] *= 1.01
    mesh.export(path)
    return original


def run(meshes, results, cores, options=()):
    """Run the workflow; return wall clock and processor time in s, jobs, and the peak of the main process in MB."""
    results.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "snakemake", "--snakefile", ROOT / "Snakefile", "--cores", cores]
    command += ["--directory", results, "--config", f"meshes={meshes}", *options]
    before, start, peak = os.times(), time.perf_counter(), 0.0
    with open(results / "run.log", "w") as log:
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)  # noqa: S603, the project's own programs
        while process.poll() is None:
            peak = max(peak, peak_memory(process.pid))
            time.sleep(0.2)
    wall, after = time.perf_counter() - start, os.times()
    if process.returncode:
        sys.exit(f"the workflow failed, see {results / 'run.log'}")
    used = after.children_user + after.children_system - before.children_user - before.children_system
    jobs = max(results.glob(".snakemake/log/*.log")).read_text().count("Finished jobid")  # the last by its name
    return {"wall": wall, "processor": used, "jobs": jobs, "main_peak_mb": peak}


def peak_memory(pid):
    """Peak resident memory of a process in MB; 0 when it has ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM")), 0.0)


def seconds_of(results, stages):
    """Seconds that these stages spent on all models."""
    table = pq.read_table(results / "results" / "corpus" / "models.parquet")
    return sum(pc.sum(table[f"seconds_{stage}"]).as_py() for stage in stages)


if __name__ == "__main__":
    main(*sys.argv[1:])
