"""Run one stage over the models of one batch.

Models share a process, because starting one costs more than most models do.
A stage is a function ``main(source, target, options)``. Of every model it
leaves its outputs in ``results/models/{model}/`` and, once all of them are in
place, a receipt ``.{stage}.json`` with the content key: the digest of what
the outputs depend on. A model whose receipt still holds is not computed
again. The batch as a whole leaves one status table, which is what Snakemake
tracks.

A model that cannot be computed stops nothing but itself: it becomes a row of
the status table with the reason, and later stages skip it.
"""

import shutil
import time
import traceback
from pathlib import Path

import pyarrow as pa

from .layout import MODELS_FOLDER, STAGES, STATUS_SCHEMA, read_status
from .process import peak_memory_mb, print_into, reset_peak_memory, trim_startup
from .promises import vouch
from .receipts import disown, make_key, move_in, unchanged_inputs, valid_receipt, withdraw, write_receipt
from .storage import AlteredFileError, content_key, write_parquet


class Rejected(Exception):
    """The model cannot go on, through no fault of the program.

    The text is a sentence for the user: what is wrong with the model, and
    what cures it. JSON files that the stage wrote before are kept.
    """


def run_batch(snakemake, main, outputs, digest=None):
    """Run the stage `main` over the batch of a Snakemake job.

    Reads the models from ``input.status``, the status table of the stage
    before, or, in the first stage, from ``params.models`` and
    ``params.paths``, since not every path of a mesh can be an input; `digest`
    then gives the content key of a mesh file. Writes the
    status table of this stage. Everything that is printed goes to the log.
    """
    stage, parameters = snakemake.rule, snakemake.params
    print_into(snakemake.log[0])
    trim_startup()
    if "status" in snakemake.input.keys():  # noqa: SIM118, a list with names
        rows = read_status(snakemake.input.status)
    else:
        rows = _first_rows(parameters.models, parameters.paths, digest)
    done = run_models(stage, rows, main, outputs, parameters.options, parameters.code, digest)
    done = vouch(stage, done, outputs)
    write_parquet(snakemake.output.status, pa.Table.from_pylist(done, schema=STATUS_SCHEMA))


def run_models(stage, rows, main, outputs, options, code, digest=None):
    """Run the stage `main` on models, one after the other; return their rows of the status table.

    `rows` are those of the stage before. A model's files lie in
    :data:`MODELS_FOLDER` of the working directory; one whose receipt still
    holds is not computed, and keeps its seconds and memory.
    """
    return [_run_model(stage, row, main, outputs, options, code, digest) for row in rows]


# --------------------------------------------------------------------------
# One model


def _first_rows(models, paths, digest):
    """Return rows that stand for the stage before the first one."""
    return [
        {"model": model, "path": path, "status": "ok", "reason": "", "key": digest(path)}
        for model, path in zip(models, paths, strict=True)
    ]


def _run_model(stage, row, main, outputs, options, code, digest):
    """Run the stage on one model, or take over what is there; return its new row."""
    folder = MODELS_FOLDER / row["model"]
    same = {"model": row["model"], "path": row["path"]}
    if row["status"] != "ok":
        withdraw(folder, stage, outputs)
        reason = row["reason"] if row["status"] == "skipped" else f"{row['status']} earlier: {row['reason']}"
        return same | {"status": "skipped", "reason": reason, "seconds": None, "peak_memory_mb": None, "key": ""}
    key = make_key(row["key"], options, code)
    receipt = valid_receipt(folder, stage, key, outputs)
    if receipt is None:
        receipt = _compute(stage, row, main, outputs, options, key, digest)
        print(f"{row['model']}: {receipt['status']} in {receipt['seconds']:.2f} s. {receipt['reason']}", flush=True)
    else:
        print(f"{row['model']}: {receipt['status']}, already there. {receipt['reason']}", flush=True)
    return same | {name: receipt[name] for name in ("status", "reason", "seconds", "peak_memory_mb", "key")}


def _compute(stage, row, main, outputs, options, key, digest):
    """Run the stage into a scratch folder, move the outputs in and return the receipt.

    Its seconds are those of all that the model causes in this stage: reading,
    computing, writing and moving in, all but the receipt itself, which tells them.
    """
    start, folder = time.perf_counter(), MODELS_FOLDER / row["model"]
    source = Path(row["path"]) if stage == STAGES[0] else folder
    scratch = _make_scratch(folder / f".{stage}.scratch")
    reset_peak_memory()
    status, reason = "ok", ""
    try:
        with unchanged_inputs(stage, row, digest) as keys, content_key(key, keys):
            main(source, scratch, options)
        _check_written(scratch, outputs)
    except Rejected as rejection:
        status, reason = "rejected", _one_line(str(rejection))
    except AlteredFileError as fault:
        status, reason = "failed", _one_line(str(fault))
        disown(row["model"], fault.path)
    except Exception as fault:
        traceback.print_exc()
        status, reason = "failed", _one_line(f"{stage}: {type(fault).__name__}: {fault}")
    receipt = {
        "before": row["key"],
        "key": key,
        "outputs": _kept(scratch, outputs, status),
        "peak_memory_mb": peak_memory_mb(),
        "reason": reason,
        "status": status,
    }
    move_in(stage, scratch, folder, outputs, receipt)
    receipt["seconds"] = round(time.perf_counter() - start, 4)
    write_receipt(folder, stage, receipt)
    return receipt


def _make_scratch(scratch):
    """Make an empty folder at the path `scratch`, whatever a run that was killed left there; return the path."""
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
