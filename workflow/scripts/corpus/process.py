"""What a job asks of the process that it runs in: where prints go, what stays loaded, how much memory it took."""

import ctypes
import errno
import gc
import os
import signal
import sys
import traceback
from contextlib import suppress
from functools import partial
from pathlib import Path

import pyarrow as pa

ENDED = "This job ended: "  # so begins the last line of the log of a job that came to no end of its own
NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
SCARCE = 64  # MB; a disk with less left is likely why a run did not finish


class Failed(Exception):
    """What was asked for could not be done in this run, through no fault of a mesh; the next run tries again.

    The text is a sentence for the user: what stood in the way, and what cures it.
    """


def print_into(log):
    """Send everything printed from here on, by C libraries too, to the file `log`.

    An exception that ends the process is told there, and in a sentence on the
    terminal as well, since the log may be what could not be written.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    terminal = os.dup(2)
    sys.excepthook = partial(tell_end, log, terminal)
    Path(log).parent.mkdir(parents=True, exist_ok=True)
    file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    os.dup2(file, 1)
    os.dup2(file, 2)
    os.close(file)


def log_line(text):
    """Print a line, after the traceback of the exception that is being handled, if any; a full disk is no fault."""
    with suppress(OSError):
        if sys.exc_info()[0]:
            traceback.print_exc()
        print(text, flush=True)


def tell_end(log, terminal, kind, fault, trace):
    """Tell of an exception that ends this process."""
    sentence = " ".join(f"{ENDED}{describe_fault(fault)}".split())
    with suppress(OSError):
        sys.stdout.flush()  # or what was printed before would come after the last word
    with suppress(OSError):
        traceback.print_exception(kind, fault, trace)
        print(sentence, file=sys.stderr, flush=True)
    if issubclass(kind, Exception):  # a user who interrupts the run knows
        os.write(terminal, f"{log}: {sentence}\n".encode(errors="backslashreplace"))


def describe_fault(fault):
    """Return a sentence on what an exception says, with a cure where the machine is at fault."""
    if isinstance(fault, Failed):
        return str(fault)
    if isinstance(fault, MemoryError):
        text = f" ({fault})" if str(fault) else ""
        return f"memory ran out{text}: use fewer cores, a larger limits.memory, or a machine with more"
    said = f"{type(fault).__name__}: {fault}"
    if isinstance(fault, OSError) and fault.errno in NO_SPACE:
        return f"the disk is full, or a quota used up ({said}), in {os.getcwd()}: free space and start again"
    return said


def find_last_words(logs, since):
    """Return why jobs ended, by the paths of their logs: of those below `logs`, changed since a time, that say so."""
    words = {}
    for path in sorted(Path(logs).glob("**/*.log")):
        with suppress(OSError):
            if path.stat().st_mtime >= since:
                *_, last = path.read_text(errors="replace").splitlines() or [""]
                if last.startswith(ENDED):
                    words[str(path)] = last.removeprefix(ENDED)
    return words


def trim_startup():
    """Spare this process two costs of what it has loaded.

    pyarrow would load pandas, a quarter of a second, when it first makes an
    array, to see whether it is given a data frame; what it finds then, it
    keeps to. And what is loaded stays to the end, but would be looked through
    for garbage time and again, a twentieth of a second each.
    """
    sys.meta_path.insert(0, _WithoutPandas)
    pa.array([0])
    sys.meta_path.remove(_WithoutPandas)
    gc.freeze()


class _WithoutPandas:
    """A finder of modules to which pandas is not installed."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        if name == "pandas":
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


def die_with(parent):
    """Have the system end this process when its parent ends (Linux): nothing goes on behind a job that was killed."""
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(1)


def reset_peak_memory():
    """Start the peak anew for this model, where the system can (Linux)."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def peak_memory_mb():
    """Return the peak resident memory in MB since the last reset, or of the process."""
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        import resource

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak / (2**20 if sys.platform == "darwin" else 1024)


def find_full_disks(folders):
    """Return a sentence on each folder of these whose disk has hardly any space, or names for files, left."""
    told = []
    for folder in sorted({os.path.realpath(folder) for folder in folders}):
        disk = os.statvfs(folder)
        space = disk.f_bavail * disk.f_frsize / 2**20
        if space < SCARCE or (disk.f_files and not disk.f_favail):
            left = f"{space:.1f} MB" if space < SCARCE else "no names for files"
            told.append(f"the disk that holds {folder} has {left} left: free space before you start again")
    return told
