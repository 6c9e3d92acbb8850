"""Compilation of the library ahead of the first models: a rehearsal of the stages, on a small solid of its own.

What a rehearsal compiles is kept (:mod:`reebslice.kernels`), so models find it compiled, and their seconds are
their own. Several processes rehearse at once, each the next stage whose files are there, and a process whose
kernel another one compiles waits for that. What the solid does not call for is compiled when a model first does.
"""

import fcntl
import itertools
import os
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path

from .jobs import Job, JobError
from .layout import BEFORE, line_to
from .process import log_line

REHEARSED = "rehearsed-{}"  # an empty file beside what was compiled, for every stage and every format
SIDE = 5  # cells of the solid along each axis
# Of these it has none: a hole through it, a void, and a pit that is open above.
EMPTY = {*((1, y, 1) for y in range(SIDE)), (3, 2, 3), (1, 3, 3), (1, 3, 4)}
MOST_COMPILERS = 2  # more would wait for each other's kernels
PAUSE = 0.02  # seconds between looks for a stage whose files are there


def find_unrehearsed(compiled, stages, meshes):
    """Tell what of a run is not rehearsed yet.

    Parameters
    ----------
    compiled : path
        The folder of what is compiled; made if it is not there.
    stages : iterable of str
        Those of the run.
    meshes : dict of str to str
        By format a mesh file, a small one.

    Returns
    -------
    dict of str to str or None
        Stages, and formats with their files, if any is not. None where some are not, and the folder cannot be
        written to: what is compiled would not be kept, and every run would rehearse.
    """
    names = dict.fromkeys(stages) | (meshes if "inspect_mesh" in stages else {})
    tasks = {name: path for name, path in names.items() if not os.path.exists(f"{compiled}/{REHEARSED.format(name)}")}
    try:
        Path(compiled).mkdir(parents=True, exist_ok=True)
    except OSError:
        return None if tasks else {}
    return tasks if os.access(compiled, os.W_OK) or not tasks else None


def rehearse(server, compiled, tasks, options, processes):
    """Compile what stages and formats call for, in several processes; what goes wrong is left to the models to tell.

    Parameters
    ----------
    server : ForkServer
    compiled : path
        The folder of what is compiled.
    tasks : dict of str to str or None
        As of :func:`find_unrehearsed`.
    options : dict of str to dict
        Of every stage.
    processes : int
    """
    behind = {stage: BEFORE[stage] for name in tasks if name in BEFORE for stage in line_to(name)}
    behind |= {name: None for name in tasks if name not in BEFORE}
    with suppress(OSError), tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        write_solid(Path(folder, "solid.off"))
        params = {"folder": folder, "behind": behind, "meshes": tasks, "options": options}

        def work(number):
            job = Job.describe({}, {}, params, f"results/logs/rehearsal-{number}.log", {})
            with suppress(JobError):
                server.run(__name__, job)

        threads = [threading.Thread(target=work, args=(number,)) for number in range(processes)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for name in tasks:
            if Path(folder, f"{name}.done").exists():
                Path(compiled, REHEARSED.format(name)).touch()


def gather(job):
    """Rehearse, beside other processes that do, until all that is to be rehearsed is done; a job's work."""
    folder, behind = Path(job.params.folder), job.params.behind
    while left := [name for name in behind if not (folder / f"{name}.done").exists()]:
        for name in left:
            if behind[name] is None or (folder / f"{behind[name]}.done").exists():
                with _take(folder / f"{name}.taken") as taken:
                    if taken and not (folder / f"{name}.done").exists():
                        _rehearse_one(name, job.params, folder)
                        break
        else:
            time.sleep(PAUSE)


@contextmanager
def _take(path):
    """Whether a file could be locked, which it stays until the block ends, or the process."""
    with open(path, "wb") as file:
        taken = False
        with suppress(OSError):
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            taken = True
        yield taken


def _rehearse_one(name, params, folder):
    """Do one stage, or read one format; leave a note that it is done, however it ended."""
    begun = time.perf_counter()
    stage, source, target = name, folder, folder
    if name not in BEFORE:
        stage, source, target = "inspect_mesh", Path(params.meshes[name]), folder / f"read-{name.strip('.')}"
        target.mkdir()
    elif BEFORE[name] is None:
        source = folder / "solid.off"
    try:
        import_module(stage).main(source, target, params.options[stage])
        log_line(f"{name}: {time.perf_counter() - begun:.1f} s")
    except Exception as fault:
        log_line(f"{name}: {time.perf_counter() - begun:.1f} s, up to {type(fault).__name__}.")
    (folder / f"{name}.done").touch()


def write_solid(path):
    """Write a solid of two bodies with a hole, a void and a pit each, one of them askew, as an OFF file."""
    points, faces = _surround([cell for cell in itertools.product(range(SIDE), repeat=3) if cell not in EMPTY])
    askew = [
        (x - 0.1 * y + 0.15 * z + 2 * SIDE, 0.1 * x + 1.1 * y - 0.2 * z, x / 5 + 0.3 * y + 0.9 * z)
        for x, y, z in points
    ]
    faces += [[corner + len(points) for corner in face] for face in faces]
    rows = [*points, *askew, *([3, *face] for face in faces)]
    lines = ["OFF", f"{2 * len(points)} {len(faces)} 0", *(" ".join(map(str, row)) for row in rows)]
    Path(path).write_text("\n".join(lines) + "\n")


def _surround(cells):
    """Corners of unit cells, and the triangles of these around them, counter-clockwise seen from outside."""
    number, faces = {}, []
    for cell, axis, side in itertools.product(cells, range(3), (0, 1)):
        beside = list(cell)
        beside[axis] += 2 * side - 1
        if tuple(beside) in cells:
            continue
        square = []
        for along, up in [(0, 0), (1, 0), (1, 1), (0, 1)] if side else [(0, 1), (1, 1), (1, 0), (0, 0)]:
            corner = list(cell)
            for step, more in enumerate((side, along, up)):
                corner[(axis + step) % 3] += more
            square.append(number.setdefault(tuple(corner), len(number)))
        faces += [square[:3], [square[0], *square[2:]]]
    return list(number), faces
