"""What a run shows on the console: how far it is, what matters, and how it went."""

import io
import logging
from pathlib import Path
from types import SimpleNamespace

import pyarrow as pa
import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from corpus import console
from corpus.console import PACKAGE, Progress, matters, show_progress
from corpus.outcome import list_first, tell_outcome
from corpus.storage import write_parquet

MEMBERS = {"batch-0": ["a", "b"], "batch-1": ["c"], "batch-2": ["d"]}
JOBS = {1: ("slice_mesh", "batch-0"), 2: ("draw", "batch-0"), 3: ("draw", "batch-1"), 4: ("collect_models", None)}


def record(event=None, text="", level=logging.INFO, path=f"{PACKAGE}/x.py", **facts):
    made = logging.LogRecord("x", level, path, 1, text, None, None)
    made.__dict__.update(event=event, **facts)
    return made


class Screen(io.StringIO):
    def __init__(self, overwrites):
        super().__init__()
        self.isatty = lambda: overwrites


@pytest.fixture(params=[False, True], ids=["file", "terminal"])
def progress(request, monkeypatch):
    """A handler with a plan, a clock that stands still until it is set, and what it writes."""
    handler, clock = Progress(None, None), SimpleNamespace(now=0.0)
    monkeypatch.setattr(console, "time", SimpleNamespace(monotonic=lambda: clock.now))
    handler.shown, handler.clock = logging.StreamHandler(Screen(request.param)), clock
    handler.line_end = "" if request.param else "\n"
    handler.plan(JOBS, MEMBERS, {"batch-0": 2.0, "batch-1": 1.0, "batch-2": 1.0})
    return handler


def begin(handler, job):
    handler.handle(record(LogEvent.JOB_INFO, jobid=job))


def end(handler, job, at):
    handler.clock.now = at
    handler.handle(record(LogEvent.JOB_FINISHED, job_id=job))


def test_progress_counts_models_and_stages_and_foretells_the_time(progress):
    assert progress.describe() == "1 of 4 models done"  # of batch-2 nothing is left to do
    begin(progress, 1)
    begin(progress, 3)
    assert progress.describe() == "1 of 4 models done; at work: draw (1), slice_mesh (2)"
    end(progress, 1, at=60.0)
    assert progress.describe() == "1 of 4 models done; at work: draw (1); about 2 min left"  # 2 of 6 units of work done
    end(progress, 3, at=90.0)
    assert progress.describe() == "2 of 4 models done; about 2 min left"
    begin(progress, 2)
    end(progress, 2, at=120.0)
    begin(progress, 4)
    assert progress.describe() == "4 of 4 models done; at work: collect_models; about 20 s left"
    end(progress, 4, at=130.0)
    assert progress.describe() == "4 of 4 models done"


def test_nothing_is_counted_as_long_as_no_model_is_done(progress):
    progress.plan(JOBS, {batch: MEMBERS[batch] for batch in ("batch-0", "batch-1")}, {"batch-0": 2.0, "batch-1": 1.0})
    assert progress.describe() == "3 models"
    begin(progress, 1)
    assert progress.describe() == "3 models; at work: slice_mesh (2)"


def test_lines_are_overwritten_where_that_can_be_and_else_few(progress):
    for job in JOBS:
        begin(progress, job)
        end(progress, job, at=60.0 * job)
    progress.handle(record(text="careful", level=logging.WARNING))
    written = progress.shown.stream.getvalue()
    if progress.shown.stream.isatty():
        assert written.count("\n") == 1 and "\r\x1b[Kcareful\n4 of 4 models done" in written
    else:
        lines = written.splitlines()
        assert [line[:4] for line in lines] == ["  0%", " 33%", " 67%", " 83%", "100%", "care"]


def test_a_line_says_what_is_under_way_though_jobs_follow_one_another(progress):
    progress.plan(
        dict(enumerate([("slice_mesh", "batch-2"), ("certify", "batch-2"), ("draw", "batch-2")])), MEMBERS, {}
    )
    begin(progress, 0)
    assert progress.shown.stream.getvalue().endswith("3 of 4 models done; at work: slice_mesh (1)" + progress.line_end)
    end(progress, 0, at=60.0)
    begin(progress, 1)
    assert progress.shown.stream.getvalue().endswith("at work: certify (1); about 2 min left" + progress.line_end)
    end(progress, 1, at=120.0)
    begin(progress, 2)
    end(progress, 2, at=180.0)
    assert progress.shown.stream.getvalue().endswith("4 of 4 models done" + progress.line_end)


def test_of_jobs_that_the_user_interrupts_no_error_is_shown_but_what_the_workflow_says(progress):
    broken = {"text": "Error in rule draw", "level": logging.ERROR}
    progress.handle(record(LogEvent.JOB_ERROR, jobid=1, **broken))
    progress.handle(record(text="Terminating processes on user request, this might take some time."))
    progress.handle(record(LogEvent.JOB_ERROR, jobid=2, **broken))
    progress.handle(record(text="Stopped, as asked for.", level=logging.ERROR, path="/y/common.smk"))
    written = progress.shown.stream.getvalue()
    assert progress.stopped and written.count("Error in rule draw") == 1
    assert written.index("Error") < written.index("Terminating") < written.index("Stopped, as asked for.")


def test_without_a_plan_nothing_is_said_of_progress():
    handler = Progress(None, None)
    handler.shown = logging.StreamHandler(Screen(True))
    handler.handle(record(LogEvent.JOB_FINISHED, job_id=1))
    assert handler.shown.stream.getvalue() == ""


def test_many_jobs_are_some_lines(progress):
    progress.plan(dict.fromkeys(range(1000), ("draw", "batch-1")), MEMBERS, {"batch-1": 1.0})
    for job in range(1000):
        begin(progress, job)
        end(progress, job, at=0.1 * job)
    lines = progress.shown.stream.getvalue().rstrip("\n").split("\n")
    assert len(lines) == (1 if progress.shown.stream.isatty() else 11) and lines[-1].endswith("4 of 4 models done")


@pytest.mark.parametrize(
    "shown, given",
    [
        (True, {"text": "careful", "level": logging.WARNING}),
        (True, {"event": LogEvent.JOB_ERROR, "text": "broken", "level": logging.ERROR}),
        (True, {"text": "Configuration: x", "path": "/y/common.smk"}),
        (True, {"text": "Nothing to be done (all requested files are present and up to date)."}),
        (True, {"text": "Complete log(s): x"}),
        (True, {"text": "Trying to restart job 5."}),
        (False, {"text": "Select jobs to execute..."}),
        (False, {"event": LogEvent.WORKFLOW_STARTED}),
        (False, {"event": LogEvent.JOB_INFO, "text": "rule x"}),
        (False, {"text": "fine points", "level": logging.DEBUG}),
    ],
)
def test_what_matters_is_shown(shown, given):
    assert matters(record(**given)) == shown


@pytest.mark.parametrize("asked", ["", "verbose", "quiet", "dryrun", "debug_dag", "printshellcmds"])
def test_who_asks_for_another_console_gets_it(asked):
    options = dict.fromkeys(("verbose", "quiet", "dryrun", "debug_dag", "printshellcmds"), False)
    logger, default, file = (
        logging.Logger("x"),
        logging.StreamHandler(Screen(False)),
        logging.StreamHandler(Screen(False)),
    )
    default.name = "DefaultStreamHandler"
    logger.addHandler(default)
    logger.addHandler(file)
    settings = SimpleNamespace(**options | ({asked: True} if asked else {}))
    found = show_progress(SimpleNamespace(settings=settings, logger=logger))
    assert logger.handlers == ([default, file] if asked else [file, found])
    assert (found is None) == bool(asked)
    assert show_progress(SimpleNamespace(settings=settings, logger=logging.Logger("y"))) is None  # another's logger


def test_the_last_lines_tell_verdicts_and_what_needs_a_look(tmp_path):
    ends = [("ok", "exact", "")] * 3 + [("ok", "exact_at_feature_size", "")] + [("ok", "uncertified", "It crosses.")]
    ends += [("rejected", "rejected", f"hole {place}") for place in range(5)] + [("failed", None, "memory ran out")]
    rows = [
        {"model": f"m{place}", "status": status, "verdict": verdict, "reason": reason}
        for place, (status, verdict, reason) in enumerate(ends)
    ]
    path = Path(tmp_path, "models.parquet")
    write_parquet(path, pa.Table.from_pylist(rows))
    lines, failed = tell_outcome(path)
    assert failed == 1
    assert lines == [
        "11 models: 3 exact, 1 exact_at_feature_size, 1 uncertified, 5 rejected, 1 FAILED",
        "What needs a look:",
        "  m4: uncertified: It crosses.",
        "  m5: rejected: hole 0",
        "  m6: rejected: hole 1",
        "  m7: rejected: hole 2",
        "  and 2 more",
        "  m10: FAILED: memory ran out",
        f"All models, with reasons and figures: {path}",
    ]
    rows[4]["reason"] = "It crosses at (0.1234567890123, -2, 3e-05)."
    write_parquet(path, pa.Table.from_pylist(rows))
    assert "  m4: uncertified: It crosses at (0.123457, -2, 3e-05)." in tell_outcome(path)[0]
    unsure = {"void_verdict": "uncertified", "basins_count": 1}
    write_parquet(path, pa.Table.from_pylist([row | unsure for row in rows[:2]]))
    told = "Pockets are not certified of 2, as the column void_reason says: m0 first"
    assert tell_outcome(path)[0] == ["2 models: 2 exact", told, f"All models, with reasons and figures: {path}"]
    noted = [row | {"reason": "not exported: too many"} for row in rows[:2]]
    write_parquet(path, pa.Table.from_pylist(noted + rows[2:3]))
    told = "Something beside the graphs is left out of 2, as the column reason says: m0 first"
    assert tell_outcome(path)[0] == ["3 models: 3 exact", told, f"All models, with reasons and figures: {path}"]
    assert list_first(["a", "b", "c"]) == ["  a", "  b", "  c"]
