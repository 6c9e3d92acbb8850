"""What a job asks of the process that it runs in: where prints go, what stays loaded, how much memory it took."""

import gc
import os
import sys
from contextlib import suppress
from pathlib import Path

import pyarrow as pa


def print_into(log):
    """Send everything printed from here on, by C libraries too, to the file `log`."""
    Path(log).parent.mkdir(parents=True, exist_ok=True)
    sys.stdout.flush()
    sys.stderr.flush()
    file = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    os.dup2(file, 1)
    os.dup2(file, 2)
    os.close(file)


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
