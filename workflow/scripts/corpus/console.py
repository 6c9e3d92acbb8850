"""What a run shows on the console: how far it is, warnings, errors, and how it went; the log file has the rest.

A handler on the interface of Snakemake's logger plugins, which the workflow
itself puts in the place of the default one. A plugin would have to be named on
the command line, and `quiet` would thin out the log file as well.
"""

import time
from collections import Counter
from pathlib import Path

import snakemake
from snakemake.common import NOTHING_TO_BE_DONE_MSG
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

PACKAGE = str(Path(snakemake.__file__).parent)
# What Snakemake says by way of information that is shown.
STOPPING = "Terminating processes on user request"
SHOWN = (NOTHING_TO_BE_DONE_MSG, "Complete log(s):", "Trying to restart job", STOPPING, "Congratulations")
STEP, PAUSE = 0.1, 300.0  # where lines cannot be overwritten, one for this part of the work, or for so many seconds
EARLY = 0.05  # part of the work before which nothing is said of the time left


def show_progress(manager):
    """Put a :class:`Progress` in the place of the default handler, and return it.

    Not where the user asked for more or for less on the console, by an option
    of Snakemake or another logger: then None.

    Parameters
    ----------
    manager : snakemake.logging.LoggerManager
    """
    asked, handlers = manager.settings, manager.logger.handlers
    default = next((handler for handler in handlers if handler.name == "DefaultStreamHandler"), None)
    if default is None or asked.verbose or asked.quiet or asked.dryrun or asked.debug_dag or asked.printshellcmds:
        return None
    progress = Progress(asked, None)
    progress.shown = default
    manager.logger.removeHandler(default)
    manager.logger.addHandler(progress)
    return progress


class Progress(LogHandlerBase):
    """A handler that shows what matters, through the default one, and one line on how far the run is."""

    writes_to_stream, writes_to_file = True, False
    has_filter, has_formatter, needs_rulegraph = True, True, False

    def __post_init__(self):
        self.name = "ReebsliceProgress"
        self.shown = None  # the default handler
        self.stopped = False  # whether the user has interrupted the run: errors of jobs that end so are no news
        self.timed = True  # whether the time that jobs took tells of the time left; not while they compile
        self._left, self._running, self._all = {}, {}, 0.0
        self._told, self._line, self._due = (0.0, 0.0), "", False

    def plan(self, jobs, members, work):
        """Take note of what is to be done.

        Parameters
        ----------
        jobs : dict of int to (str, str or None)
            Rule and batch of every job, by its id.
        members : dict of str to list of str
            Models by batch.
        work : dict of str to float
            About how much work every batch is at any stage.
        """
        self._left, self._members, self._work = dict(jobs), members, work
        self._all, self._began = self._work_left(), time.monotonic()
        self._told, self._due = (-STEP, self._began), bool(jobs)

    def emit(self, record):
        """Show the record if it matters, and how far the run is if that has changed."""
        event = getattr(record, "event", None)
        if event == LogEvent.JOB_INFO and record.jobid in self._left:
            self._running[record.jobid] = self._left[record.jobid]
            if self._due:
                self._show_line()
        elif event == LogEvent.JOB_FINISHED:
            self._left.pop(record.job_id, None)
            self._running.pop(record.job_id, None)
            self._due = bool(self._all and self._left and not self._running)  # once it is known what is at work next
            if self._all and not self._due:
                self._show_line()
        elif event == LogEvent.JOB_ERROR:
            self._running.pop(record.jobid, None)
        self.stopped |= str(record.msg).startswith(STOPPING)
        if matters(record) and not (self.stopped and record.levelname == "ERROR" and _is_of_snakemake(record)):
            self._write("\r\x1b[K" if self._line else "")
            self.shown.handle(record)
            self._write(self._line)

    def describe(self):
        """Return a line on how far the run is: models done of how many, the stages at work, the time left."""
        waiting = {batch for _, batch in self._left.values() if batch}
        count = {batch: len(self._members[batch]) for batch in self._members}
        total = sum(count.values())
        done = total - sum(count[batch] for batch in waiting)  # batches go side by side, so at first for long none
        at = Counter()
        for rule, batch in self._running.values():
            at[rule] += count.get(batch, 0)
        now = ", ".join(f"{rule} ({n})" if n else rule for rule, n in sorted(at.items()))
        models = f"{done} of {total} models done" if done else f"{total} models"
        words = [models, now and f"at work: {now}", self._time_left()]
        return "; ".join(word for word in words if word)

    def close(self):
        """Leave the console as it is."""
        self._write("\r\x1b[K" if self._line else "")
        self._line = ""
        super().close()

    def _show_line(self):
        """Show how far the run is, in place of the line before where the console can do that, else now and then."""
        self._due = False
        part, now = 1 - self._work_left() / self._all if self._left else 1.0, time.monotonic()
        if self.shown.stream.isatty():
            self._line = self.describe()[:150]
            self._write(f"\r\x1b[K{self._line}")
        elif part >= self._told[0] + STEP or now >= self._told[1] + PAUSE or not self._left:
            self._told = part, now
            self._write(f"{part:4.0%}  {self.describe()}\n")

    def _work_left(self):
        return sum(self._work.get(batch, 1.0) for _, batch in self._left.values())

    def _time_left(self):
        """Say about how long the run will take from here, by how long it took so far; '' where that says little."""
        part = 1 - self._work_left() / self._all
        if not (self.timed and EARLY < part < 1):
            return ""
        seconds = (time.monotonic() - self._began) * (1 - part) / part
        return f"about {_round_time(seconds)} left"

    def _write(self, text):
        if text:
            self.shown.stream.write(text)
            self.shown.stream.flush()


def matters(record):
    """Whether a log record is shown: warnings, errors, and what the workflow itself says."""
    if record.levelname != "INFO":
        return record.levelno > 20
    told = str(record.msg)
    return told.startswith(SHOWN) or not _is_of_snakemake(record)


def _is_of_snakemake(record):
    return record.pathname.startswith(PACKAGE)


def _round_time(seconds):
    """Say a time in the unit that suits it."""
    for size, unit in ((3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{round(seconds / size)} {unit}"
    return f"{round(seconds, -1) or 10:.0f} s"
