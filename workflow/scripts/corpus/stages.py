"""Run one stage over the models of one batch.

Models share a process, because starting one costs more than most models do.
A stage is a function ``main(source, target, options)``. Of every model it
leaves its outputs in ``results/models/{model}/`` and, once all of them are in
place, a receipt ``.{stage}.json`` with the content key: the digest of what
the outputs depend on. A model whose receipt still holds is not computed
again; nor are its files read where the last status table still stands for
them. The batch as a whole leaves one status table, which is what Snakemake
tracks.

A model that cannot be computed stops nothing but itself: it becomes a row of
the status table with the reason, and later stages skip it. That holds, too,
for one that ends the process which works on it (:mod:`.workers`).
"""

import fcntl
import os
import shutil
import time
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import NamedTuple

import pyarrow as pa

from .companions import digest_mesh
from .layout import BEFORE, MODELS_FOLDER, STATUS_SCHEMA, read_status
from .process import Failed, describe_fault, log_line, peak_memory_mb, reset_peak_memory, trim_startup
from .promises import keep_promises, recall_standing, vouch
from .receipts import disown, make_key, move_in, unchanged_inputs, valid_receipt, withdraw, write_receipt
from .storage import AlteredFileError, content_key, write_parquet
from .whole_files import remove_remains
from .workers import Limits, Lost, map_apart


class Rejected(Exception):
    """The model cannot go on, through no fault of the program.

    The text is a sentence for the user: what is wrong with the model, and
    what cures it. JSON files that the stage wrote before are kept.
    """


class _Task(NamedTuple):
    """What is to be done to every model: the stage, its function, outputs and options, and the digest of its code.

    Of the first stage also the function that gives the key of a mesh file.
    """

    stage: str
    main: object
    outputs: tuple
    options: dict
    code: str
    digest: object = None


def run_batch(job, main, outputs):
    """Run the stage `main` over the batch of a job.

    Reads the models from ``input.status``, the status table of the stage
    before, or, in the first stage, from ``params.models`` and
    ``params.paths``, since not every path of a mesh can be an input. The models of ``params.own``
    have options of their own, the others ``params.options``. Writes the
    status table of this stage.

    Parameters
    ----------
    job : .jobs.Job
    main : function of source, target, options
    outputs : tuple of str
        Names of the files that it leaves.
    """
    status, parameters = Path(job.output.status), job.params
    stage, digest = status.parent.name, None
    trim_startup()
    if BEFORE[stage] is None:
        digest = digest_mesh
        rows = _first_rows(parameters.models, parameters.paths, digest)
    else:
        rows = read_status(job.input.status)
    own = getattr(parameters, "own", {})
    rows = [row | {"options": own[row["model"]]} if row["model"] in own else row for row in rows]
    keys = {row["model"]: _key_of(row, parameters.options, parameters.code) for row in rows if row["status"] == "ok"}
    standing = recall_standing(status, keys, outputs)
    due = [row for row in rows if row["model"] not in standing]
    done = run_models(stage, due, main, outputs, parameters.options, parameters.code, digest, Limits(**job.limits))
    done = standing | {row["model"]: row for row in vouch(stage, done, outputs)}
    done = [done[row["model"]] | {"path": row["path"]} for row in rows]
    remove_remains(status.parent, status.name)
    write_parquet(status, pa.Table.from_pylist(done, schema=STATUS_SCHEMA))
    keep_promises(status)


def run_models(stage, rows, main, outputs, options, code, digest=None, limits=None):
    """Run the stage `main` on models, one after the other; return their rows of the status table.

    `rows` are those of the stage before, of a model that has some with its own `options`. A model's files lie in
    :data:`MODELS_FOLDER` of the working directory; one whose receipt still
    holds is not computed, and keeps its seconds and memory. Within `limits`,
    :class:`.workers.Limits`, a child process does the work; without, this one.
    """
    task = _Task(stage, main, outputs, options, code, digest)
    if limits is None:
        return [_run_model(task, row) for row in rows]
    found = map_apart(partial(_run_apart, task), rows, limits)
    return [_lose(task, row, new) if isinstance(new, Lost) else new for row, new in zip(rows, found, strict=True)]


# --------------------------------------------------------------------------
# One model


def _first_rows(models, paths, digest):
    """Return rows that stand for the stage before the first one; the key of a mesh that cannot be read is None."""
    rows = []
    for model, path in zip(models, paths, strict=True):
        key, reason = None, ""
        try:
            key = digest(path)
        except Exception as fault:
            reason = f"the mesh file cannot be read ({describe_fault(fault)})"
        rows.append({"model": model, "path": path, "status": "ok", "reason": reason, "key": key})
    return rows


def _run_apart(task, row):
    """Run the stage on one model; return its new row, and whether this process is fit for the next model."""
    row = _run_model(task, row)
    return row, row["status"] != "failed"


def _run_model(task, row):
    """Run the stage on one model, or take over what is there; return its new row."""
    folder = MODELS_FOLDER / row["model"]
    if row["status"] != "ok":
        with suppress(OSError):  # of a folder that cannot be written, the stage before has told
            withdraw(folder, task.stage, task.outputs)
        reason = row["reason"] if row["status"] == "skipped" else f"{row['status']} earlier: {row['reason']}"
        return _new_row(row, {"status": "skipped", "reason": reason, "key": ""})
    key = _key_of(row, task.options, task.code)
    start, told = time.perf_counter(), "already there"
    try:
        with _alone_in(folder):
            receipt = valid_receipt(folder, task.stage, key, task.outputs)
            if receipt is None:
                receipt = _compute(task, row, folder, key)
                told = f"in {receipt['seconds']:.2f} s"
    except Exception as fault:  # the folder, or what lies in it, cannot be read or written
        log_line(f"{row['model']}: {folder} cannot be read or written.")
        receipt = _failure(key, f"{task.stage}: {folder}: {describe_fault(fault)}", time.perf_counter() - start)
    log_line(f"{row['model']}: {receipt['status']}, {told}. {receipt['reason']}")
    return _new_row(row, receipt)


def _key_of(row, options, code):
    """Return the content key of what a stage makes of a model, by its row of the stage before."""
    return make_key(row["key"], row.get("options", options), code)


def _new_row(row, receipt):
    """Return the row of the status table that a model's row of the stage before becomes."""
    names = ("status", "reason", "seconds", "peak_memory_mb", "key")
    return {"model": row["model"], "path": row["path"]} | {name: receipt.get(name) for name in names}


@contextmanager
def _alone_in(folder):
    """Make the folder of a model, and wait until no other run is at work on it, where the file system can tell."""
    folder.mkdir(parents=True, exist_ok=True)
    place = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(place, fcntl.LOCK_EX)
        yield
    finally:
        os.close(place)


def _compute(task, row, folder, key):
    """Run the stage into a scratch folder, move the outputs in and return the receipt.

    Its seconds are those of all that the model causes in this stage: reading,
    computing, writing and moving in, all but the receipt itself, which tells them.
    """
    start = time.perf_counter()
    source = Path(row["path"]) if BEFORE[task.stage] is None else folder
    scratch = _make_scratch(folder, task.stage)
    reset_peak_memory()
    status, reason = "ok", ""
    try:
        if row["key"] is None:
            raise Failed(row["reason"])
        with unchanged_inputs(task.stage, row, task.digest) as keys, content_key(key, keys, row["model"]):
            task.main(source, scratch, row.get("options", task.options))
        _check_written(scratch, task.outputs)
    except Rejected as rejection:
        status, reason = "rejected", _one_line(str(rejection))
    except AlteredFileError as fault:
        status, reason = "failed", _one_line(str(fault))
        disown(row["model"], fault.path)
    except Exception as fault:
        log_line(f"{row['model']}: a fault in {task.stage}.")
        status, reason = "failed", _one_line(f"{task.stage}: {describe_fault(fault)}")
    receipt = {
        "before": row["key"],
        "key": key,
        "outputs": _kept(scratch, task.outputs, status),
        "peak_memory_mb": peak_memory_mb(),
        "reason": reason,
        "status": status,
    }
    return _leave(task, scratch, folder, receipt, start)


def _leave(task, scratch, folder, receipt, start):
    """Move the outputs in that the receipt lists, and write it; return it."""
    move_in(task.stage, scratch, folder, task.outputs, receipt)
    receipt["seconds"] = round(time.perf_counter() - start, 4)
    write_receipt(folder, task.stage, receipt)
    return receipt


def _lose(task, row, lost):
    """Leave of a model whose process ended what a failure leaves; return its new row."""
    folder = MODELS_FOLDER / row["model"]
    key = _key_of(row, task.options, task.code)
    receipt = {"before": row["key"]} | _failure(key, f"{task.stage}: {lost.reason}", lost.seconds)
    log_line(f"{row['model']}: failed. {receipt['reason']}")
    with suppress(OSError), _alone_in(folder):
        _leave(task, _make_scratch(folder, task.stage), folder, receipt, time.perf_counter() - lost.seconds)
    return _new_row(row, receipt)


def _failure(key, reason, seconds):
    """Return the receipt of a failure of which no memory is known."""
    seconds = round(seconds, 4)
    return {
        "key": key,
        "outputs": [],
        "peak_memory_mb": None,
        "reason": _one_line(reason),
        "seconds": seconds,
        "status": "failed",
    }


def _make_scratch(folder, stage):
    """Make an empty folder for what a stage writes, whatever a run that was killed left there; return its path."""
    scratch = folder / f".{stage}.scratch"
    remove_remains(folder)
    try:
        scratch.mkdir(parents=True)
    except FileExistsError:
        shutil.rmtree(scratch)
        scratch.mkdir()
    return scratch


def _check_written(scratch, outputs):
    missing = [name for name in outputs if not (scratch / name).is_file()]
    if missing:
        raise FileNotFoundError(f"the stage did not write {', '.join(missing)}")


def _kept(scratch, outputs, status):
    """Name the outputs that stay: of a rejection what explains it, of a failure nothing."""
    if status == "ok":
        return sorted(outputs)
    return sorted(path.name for path in scratch.glob("*.json")) if status == "rejected" else []


def _one_line(text):
    return " ".join(text.split())[:500]
