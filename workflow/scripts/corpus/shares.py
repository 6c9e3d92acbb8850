"""Work that is shared out over processes, where it is much: for it Python's threads take turns."""

import os
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

MOST = 8  # processes; a disk or a file server hardly answers more at once
START = "import sys; sys.path.insert(0, sys.argv[1]); from corpus.shares import answer; answer()"


def map_shared(function, items, processes=None):
    """Return what a function gives for each item, in their order; processes that begin anew do their shares.

    They are not forks: of a process with threads these may wait forever for a lock. One that comes to no good end is
    made up for here.

    Parameters
    ----------
    function : picklable function of an item
        It may not rely on what this process has loaded or changed.
    items : sequence
    processes : int, optional
        How many, this one included; as many as there are cores, up to :data:`MOST`.
    """
    processes = min(processes or os.cpu_count() or 1, MOST, len(items) or 1)
    first, *others = (items[start::processes] for start in range(processes))
    started = [(_start(function, share), share) for share in others]
    try:
        found = [list(map(function, first))]
        found += [_receive(process) or list(map(function, share)) for process, share in started]
    finally:
        for process, _ in started:
            process.kill()
            process.wait()
            process.stdout.close()
    return [found[place % processes][place // processes] for place in range(len(items))]


def _start(function, share):
    """Start a process that applies the function to its share."""
    command = [sys.executable, "-P", "-c", START, str(Path(__file__).parents[1])]
    with tempfile.TemporaryFile() as told:  # a pipe would be full before the process reads
        pickle.dump((function, share), told)
        told.seek(0)
        return subprocess.Popen(command, stdin=told, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)  # noqa: S603, this Python


def _receive(process):
    """Return what a process found, or None where it came to no good end."""
    answer, _ = process.communicate()
    return pickle.loads(answer) if process.returncode == 0 else None  # noqa: S301, of a process of ours


def answer():
    """Be such a process."""
    function, share = pickle.load(sys.stdin.buffer)  # noqa: S301, of the process that started this one
    pickle.dump(list(map(function, share)), sys.stdout.buffer)
