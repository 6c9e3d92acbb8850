"""Processor time and its limit."""

import math
import resource


def processor_seconds():
    """Seconds of processor time of this process, all its threads together.

    Not time.process_time(), which moves in steps of milliseconds once a limit is set.
    """
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def limit_processor_seconds(seconds):
    """Let the system stop this process when it has used so many seconds more."""
    end = math.ceil(processor_seconds() + seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (end, resource.RLIM_INFINITY))
