"""Measure one entrant on one mesh, in a process of its own, and print what was found.

    python benchmarks/measure.py PROGRAM TASK FOLDER LIMIT

FOLDER holds points.npy, faces.npy and heights.npy. Prints one line of JSON
after the raw run and one after the warm run. Either is stopped when it has
used LIMIT seconds of processor time; what was printed is then not lost.
Imports and compilation come before, on a mesh of a few faces.
"""

import json
import os
import sys
import time
from pathlib import Path

import numpy as np

from bumpy_meshes import bumpy_torus, level_heights
from clocks import limit_processor_seconds, processor_seconds
from entrants import ENTRANTS

SCRIPTS = Path(__file__).parents[1] / "workflow" / "scripts"
STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def main(program, task, folder, limit):
    entrant = next(one for one in ENTRANTS if (one.program, one.task) == (program, task))
    points, faces, heights = (np.load(Path(folder) / f"{name}.npy") for name in ("points", "faces", "heights"))
    small, few = bumpy_torus(600)
    entrant.check(entrant.run(entrant.prepare(small, few), level_heights(small, 5)))
    before, begin = reset_peak(), start_clocks(limit)
    prepared = entrant.prepare(points, faces)
    ready = clocks()
    answer = entrant.run(prepared, heights)
    raw, raw_wall = clocks() - begin
    peak = read_status("VmHWM") - before
    tell(raw=raw, raw_wall=raw_wall, prepare=(ready - begin)[0], peak=peak, **entrant.check(answer))
    del answer
    begin = start_clocks(limit)
    answer = entrant.run(prepared, heights)  # noqa: F841, kept so that freeing it is not measured
    warm, warm_wall = clocks() - begin
    tell(warm=warm, warm_wall=warm_wall)


def start_clocks(limit):
    limit_processor_seconds(float(limit))
    return clocks()


def clocks():
    """Seconds of processor time and of wall clock."""
    return np.array([processor_seconds(), time.perf_counter()])


def tell(**figures):
    print(json.dumps(figures), flush=True)


def reset_peak():
    """Bytes in use now, from which on the peak is counted; NaN where the system does not tell."""
    if CLEAR.exists():
        CLEAR.write_text("5")
    return read_status("VmRSS")


def read_status(field):
    if not STATUS.exists():
        return float("nan")
    line = next(line for line in STATUS.read_text().splitlines() if line.startswith(field + ":"))
    return 1024 * int(line.split()[1])


if __name__ == "__main__":
    sys.path.insert(0, str(SCRIPTS))
    from corpus.code_digest import compiled_code_folder

    os.environ.setdefault("NUMBA_CACHE_DIR", str(compiled_code_folder(SCRIPTS / "reebslice")))
    main(*sys.argv[1:])
