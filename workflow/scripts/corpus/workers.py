"""A child process that works on one model after the other, so that what ends it ends one model alone.

A mesh that takes more memory than there is, or a fault in compiled code, ends
the process that it happens in. So the process of a job only waits, and a fork
of it, in which everything is loaded already, does the work and tells of each
model. Where it ends, the model that it was at is lost, and another fork goes on
with the next.
"""

import faulthandler
import multiprocessing
import os
import signal
import time
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from .process import die_with


class Limits(NamedTuple):
    """What one model may take in one stage: `memory` in MB beside that of libraries, `minutes`; None for no limit."""

    memory: float | None = None
    minutes: float | None = None


class Lost(NamedTuple):
    """What is left to say of an item whose process ended: why, in a sentence, and the seconds that it had."""

    reason: str
    seconds: float


def map_apart(work, items, limits):
    """Call a function on items, one after the other, in a child process.

    Parameters
    ----------
    work : function of an item
        Returns a result, and whether its process is fit for the next item. A
        process in which memory ran out, or a package broke down, is not.
    items : list
    limits : Limits

    Yields
    ------
    object or Lost
        The result of every item, in order.
    """
    worker = None
    try:
        for place in range(len(items)):
            worker = worker or _Worker(work, items[place:], limits)
            result, fit = worker.receive()
            if not fit:
                worker.end()
                worker = None
            yield result
    finally:
        if worker:
            worker.end()


class _Worker:
    """A child process at work on items, with the pipe through which it tells of each."""

    def __init__(self, work, items, limits):
        context = multiprocessing.get_context("fork")
        self._limits, self._since = limits, time.perf_counter()
        self._pipe, far_end = context.Pipe(duplex=False)
        arguments = (far_end, work, items, limits.memory, os.getpid())
        self._process = context.Process(target=_serve, args=arguments, daemon=True)
        self._process.start()
        far_end.close()  # so that the child's end of it is the last, and its death is noticed

    def receive(self):
        """Return the next item's result, and whether this process can go on with the one after it."""
        minutes = self._limits.minutes
        try:
            if self._pipe.poll(None if minutes is None else 60 * minutes):
                result = self._pipe.recv()
                self._since = time.perf_counter()
                return result
            reason = f"it took longer than limits.minutes allows, which is {minutes:g}; raise that, or make it null"
        except (EOFError, OSError):  # also in the middle of a message
            self._process.join()
            reason = _say_end(self._process.exitcode, self._limits.memory)
        return Lost(reason, time.perf_counter() - self._since), False

    def end(self):
        """End the process, at work or not."""
        self._process.kill()
        self._process.join()
        self._pipe.close()


def _serve(pipe, work, items, memory, parent):
    """Work on the items until one leaves this process unfit; tell of each through the pipe."""
    die_with(parent)
    _limit_memory(memory)
    faulthandler.enable()  # so that the log tells where compiled code went wrong
    for item in items:
        result, fit = work(item)
        pipe.send((result, fit))
        if not fit:
            return


def _limit_memory(megabytes):
    """Have requests for so much more memory refused (Linux); be the first to be killed where the machine runs out."""
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("500")
    if megabytes is not None:
        import resource

        with suppress(OSError):  # what libraries and their threads have set aside differs from machine to machine
            lines = Path("/proc/self/status").read_text().splitlines()
            held = next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmData"))
            most = held + int(megabytes * 2**20)
            resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def _say_end(exitcode, memory):
    """Say why a process ended."""
    if exitcode >= 0:
        return f"its process ended with exit code {exitcode}, which is a fault of the program or of a package"
    name = signal.Signals(-exitcode).name
    if -exitcode == signal.SIGKILL:
        cure = "most likely because the machine ran out of memory: use fewer cores, or a machine with more"
    elif memory is not None:
        cure = f"most likely because limits.memory is {memory:g}: raise it, or make it null"
    else:
        cure = "which is a fault of the program or of a package, or memory that ran out"
    return f"its process was ended by the signal {name}, {cure}"
