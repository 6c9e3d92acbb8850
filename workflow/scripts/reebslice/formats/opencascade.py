"""Processes in which OpenCascade turns STEP into binary glTF.

It needs one of its own for every file: it prints, damaged files can end its
process, and what it keeps of one file must not reach the next. Loading it takes
ten times as long as most files, so one process loads it and waits, and every
file is read by a fork of it (without forks, as on Windows, by itself).
"""

import atexit
import json
import os
import subprocess
import sys
from contextlib import suppress

TOLERANCES = {"tol_linear": 0.001, "tol_angular": 0.25, "tol_relative": True}
# cascadio imports trimesh if it is there, to extend it, which takes longer than most files and is of no use here.
_PROGRAM = """import json, os, sys
sys.modules["trimesh"] = None
import cascadio
for line in sys.stdin:
    source, target, told = json.loads(line)
    child = os.fork() if hasattr(os, "fork") else 0
    if child == 0:
        os.dup2(os.open(told, os.O_WRONLY | os.O_CREAT), 1)
        sys.exit(cascadio.step_to_glb(source, target, **{}))
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
_WAITING: list[tuple[int, subprocess.Popen]] = []  # processes that wait for a file, with the process that started them


def convert_step(source, target, told):
    """Have OpenCascade make binary glTF of a STEP file.

    Parameters
    ----------
    source, target : path
        The STEP file, and the file to be made.
    told : path
        The file in which to put what it prints.

    Returns
    -------
    int
        How its process ended: 0; another exit code; or a signal's number, negative.
    """
    process = _take_waiting() or _start()
    with suppress(BrokenPipeError):
        process.stdin.write(json.dumps([str(source), str(target), str(told)]) + "\n")
        process.stdin.flush()
    if answer := process.stdout.readline():
        _WAITING.append((os.getpid(), process))
        return int(answer)
    with process:  # it has ended, and is asked how
        return process.wait()


def _take_waiting():
    """Return a process that this one has started and that waits for a file, or None."""
    with suppress(IndexError):  # threads may take at the same time; those of a process that this one is a fork of stay
        while True:
            owner, process = _WAITING.pop()
            if owner == os.getpid() and process.poll() is None:
                return process
            process.stdin.close()
            process.stdout.close()
    return None


def _start():
    """Start a process that loads OpenCascade and waits for files."""
    program = [sys.executable, "-c", _PROGRAM.format(TOLERANCES)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    return subprocess.Popen(program, text=True, **pipes)  # noqa: S603, words that stand here


@atexit.register
def _end_waiting():
    """End the processes that wait for a file; one that does not get to this has closed their input by ending."""
    while process := _take_waiting():
        process.communicate()
