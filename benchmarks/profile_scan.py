"""Where the time goes on one large mesh: seconds and memory of every stage, beside those of reading and slicing alone.

    python benchmarks/profile_scan.py [FACES] [LEVELS] [ROUNDS]

The mesh is the bumpy torus as a binary STL file; the configuration is that of
config/config.yaml but for the number of levels. Every stage runs in a process
of its own, after a small mesh that loads and compiles what it needs. Rounds of
all of them follow one another, and medians are printed.
"""

import importlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import numpy as np

from bumpy_meshes import bumpy_torus, level_heights
from corpus.process import trim_startup
from make_corpus import write_stl
from model_runs import stage_options

STAGES = tuple(stage_options())


def main(faces="1000000", levels="1000", rounds="3"):
    with tempfile.TemporaryDirectory() as folder:
        # in a process of its own: one that is started by a large one counts that one's peak as its own
        subprocess.run([sys.executable, __file__, "--meshes", folder, faces], check=True)  # noqa: S603, the project's own programs
        tasks = "read", "slice", *STAGES
        runs = [{task: run(task, folder, levels) for task in tasks} for _ in range(int(rounds))]
    seconds = {task: [one[task]["seconds"] for one in runs] for task in tasks}
    limit = np.sum([seconds["read"], seconds["slice"]], axis=0)
    total = np.sum([seconds[stage] for stage in STAGES], axis=0)
    for task in tasks:
        share = f"{median(seconds[task]) / median(total):5.0%}" if task in STAGES else ""
        peak = max(one[task]["peak_mb"] for one in runs)
        print(f"{task:18} {spread(seconds[task])} s {peak:7.0f} MB {share}")
    print(f"{'all stages':18} {spread(total)} s = {median(total) / median(limit):.1f} x (read + slice)")


def write_meshes(folder, faces):
    """Write the small mesh and the large one, as files and as arrays."""
    for name, count in (("small", 20_000), ("large", int(faces))):
        arrays = bumpy_torus(count)
        write_stl(Path(folder) / f"{name}.stl", *arrays)
        np.savez(Path(folder) / f"{name}.npz", *arrays)


def spread(values):
    """Median and range as text."""
    return f"{median(values):7.2f} ({min(values):.2f} to {max(values):.2f})"


def run(*arguments):
    """What a process of its own measures."""
    command = [sys.executable, __file__, "--task", *arguments]
    alone = os.environ | {"OPENBLAS_NUM_THREADS": "1"}  # as Snakemake has it for a job of one core
    done = subprocess.run(command, check=True, env=alone, stdout=subprocess.PIPE)  # noqa: S603, the project's own programs
    return json.loads(done.stdout.splitlines()[-1])


def measure(task, folder, levels):
    """Run one task on the small mesh and then on the large one; print processor seconds and peak of the latter."""
    work = {"read": read, "slice": cut}.get(task)
    if work is None:  # all that a job does to its process beforehand
        work = run_stage
        importlib.import_module(task)
        trim_startup()
    for name in ("small", "large"):
        start = time.process_time()
        work(task, Path(folder), name, int(levels))
        seconds = time.process_time() - start
    print(json.dumps({"seconds": seconds, "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))


def read(_, folder, name, __):
    """From the file to merged arrays."""
    from reebslice.formats.meshes import read_mesh
    from reebslice.mesh.merging import merge_exactly

    merge_exactly(*read_mesh(folder / f"{name}.stl")[:2])


def cut(_, folder, name, levels):
    """From arrays to nested contours."""
    from reebslice.morse.ordered_mesh import order_by_height
    from reebslice.slicing.slices import nested_contours

    points, faces = np.load(folder / f"{name}.npz").values()
    nested_contours(order_by_height(points, faces, np.eye(3)), level_heights(points, levels))


def run_stage(stage, folder, name, levels):
    """One stage, as the workflow runs it."""
    target = folder / name
    target.mkdir(exist_ok=True)
    source = folder / f"{name}.stl" if stage == STAGES[0] else target
    importlib.import_module(stage).main(source, target, stage_options(distance=1 / levels)[stage])


if __name__ == "__main__":
    if sys.argv[1:2] == ["--task"]:
        measure(*sys.argv[2:])
    elif sys.argv[1:2] == ["--meshes"]:
        write_meshes(*sys.argv[2:])
    else:
        main(*sys.argv[1:])
