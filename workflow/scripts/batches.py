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

import hashlib
import json
import os
import shutil
import time
import traceback
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from storage import content_key, read_json, write_json, write_parquet
from surroundings import lighten, peak_memory_mb, print_into, reset_peak_memory

STAGES = (
    "inspect_mesh",
    "select_tilt",
    "slice_mesh",
    "classify_handles",
    "sample_nodes",
    "synthesize_edges",
    "certify",
    "draw",
)
MODELS_FOLDER = Path("results/models")

# One row per model of the batch. `path` is the mesh file; `reason` is empty
# for `ok`; `key` is the content key of the stage's outputs.
STATUS_SCHEMA = pa.schema(
    [
        pa.field("model", pa.string(), nullable=False),
        pa.field("path", pa.string(), nullable=False),
        pa.field("status", pa.string(), nullable=False),
        pa.field("reason", pa.string(), nullable=False),
        pa.field("seconds", pa.float64(), nullable=True),
        pa.field("peak_memory_mb", pa.float64(), nullable=True),
        pa.field("key", pa.string(), nullable=False),
    ]
)


class Rejected(Exception):
    """The model cannot go on, through no fault of the program.

    The text is a sentence for the user: what is wrong with the model, and
    what cures it. JSON files that the stage wrote before are kept.
    """


def run_batch(snakemake, main, outputs):
    """Run the stage `main` over the batch of a Snakemake job.

    Reads the models from ``input.status``, the status table of the stage
    before, or, in the first stage, from ``input.meshes`` and
    ``params.models``. Writes the status table of this stage. Everything that
    is printed on the way goes to the log.
    """
    stage, parameters = snakemake.rule, snakemake.params
    print_into(snakemake.log[0])
    lighten()
    if "status" in snakemake.input.keys():
        rows = read_status(snakemake.input.status)
    else:
        rows = _first_rows(parameters.models, snakemake.input.meshes)
    done = run_models(stage, rows, main, outputs, parameters.options, parameters.code)
    write_parquet(snakemake.output.status, pa.Table.from_pylist(done, schema=STATUS_SCHEMA))


def run_models(stage, rows, main, outputs, options, code):
    """Run the stage `main` on models, one after the other; return their rows of the status table.

    `rows` are those of the stage before. A model's files lie in
    :data:`MODELS_FOLDER` of the working directory; one whose receipt still
    holds is not computed, and keeps its seconds and memory.
    """
    return [_run_model(stage, row, main, outputs, options, code) for row in rows]


def read_status(path):
    """Return the rows of a status table as dictionaries."""
    return pq.ParquetFile(path).read().to_pylist()


def receipt_name(stage):
    """Return the name of the file that vouches for a stage's outputs."""
    return f".{stage}.json"


def make_key(before, options, code):
    """Return the content key of a stage's outputs.

    Parameters
    ----------
    before : str
        Content key of the stage before, or the digest of the mesh file.
    options : dict
        The options that the stage uses.
    code : str
        Digest of the stage's code.
    """
    text = json.dumps([before, options, code], sort_keys=True, default=str)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def digest_file(path):
    """Return a digest of the bytes of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


# --------------------------------------------------------------------------
# One model


def _first_rows(models, meshes):
    """Return rows that stand for the stage before the first one."""
    meshes = [meshes] if isinstance(meshes, str) else meshes
    return [
        {"model": model, "path": path, "status": "ok", "reason": "", "key": digest_file(path)}
        for model, path in zip(models, meshes, strict=True)
    ]


def _run_model(stage, row, main, outputs, options, code):
    """Run the stage on one model, or take over what is there; return its new row."""
    folder = MODELS_FOLDER / row["model"]
    same = {"model": row["model"], "path": row["path"]}
    if row["status"] != "ok":
        _withdraw(folder, stage, outputs)
        reason = row["reason"] if row["status"] == "skipped" else f"{row['status']} earlier: {row['reason']}"
        return same | {"status": "skipped", "reason": reason, "seconds": None, "peak_memory_mb": None, "key": ""}
    key = make_key(row["key"], options, code)
    receipt = _valid_receipt(folder, stage, key, outputs)
    if receipt is None:
        source = Path(row["path"]) if stage == STAGES[0] else folder
        receipt = _compute(stage, source, folder, main, outputs, options, key)
        print(f"{row['model']}: {receipt['status']} in {receipt['seconds']:.2f} s. {receipt['reason']}", flush=True)
    else:
        print(f"{row['model']}: {receipt['status']}, already there. {receipt['reason']}", flush=True)
    return same | {name: receipt[name] for name in ("status", "reason", "seconds", "peak_memory_mb", "key")}


def _valid_receipt(folder, stage, key, outputs):
    """Return the model's receipt if it vouches for the content `key`, else None.

    A failure is no result, so it is tried again.
    """
    receipt = _read_receipt(folder, stage)
    if receipt is None or receipt["key"] != key or receipt["status"] == "failed":
        return None
    promised = outputs if receipt["status"] == "ok" else receipt["outputs"]
    return receipt if all((folder / name).is_file() for name in promised) else None


def _read_receipt(folder, stage):
    """Return the receipt of a stage in a model's folder, or None when there is none that can be read."""
    try:
        return read_json(folder / receipt_name(stage))
    except (OSError, ValueError):
        return None


def _compute(stage, source, folder, main, outputs, options, key):
    """Run the stage into a scratch folder, move the outputs in and return the receipt.

    Its seconds are those of all that the model causes in this stage: reading,
    computing, writing and moving in, all but the receipt itself, which tells them.
    """
    start = time.perf_counter()
    scratch = _make_scratch(folder / f".{stage}.scratch")
    reset_peak_memory()
    status, reason = "ok", ""
    try:
        with content_key(key):
            main(source, scratch, options)
        _check_written(scratch, outputs)
    except Rejected as rejection:
        status, reason = "rejected", _one_line(str(rejection))
    except Exception as fault:
        traceback.print_exc()
        status, reason = "failed", _one_line(f"{stage}: {type(fault).__name__}: {fault}")
    receipt = {
        "key": key,
        "outputs": _kept(scratch, outputs, status),
        "peak_memory_mb": peak_memory_mb(),
        "reason": reason,
        "status": status,
    }
    _move_in(stage, scratch, folder, outputs, receipt)
    receipt["seconds"] = round(time.perf_counter() - start, 4)
    write_json(folder / receipt_name(stage), receipt)
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


def _move_in(stage, scratch, folder, outputs, receipt):
    """Replace the model's files of this stage; its receipt is to be written last.

    When the content changes, what later stages made of the old one goes
    first: a model's folder never holds the results of two runs.
    """
    present = set(os.listdir(folder))
    if receipt_name(stage) not in present or _receipt_key(folder, stage) != receipt["key"] or receipt["status"] != "ok":
        for later in STAGES[STAGES.index(stage) + 1 :] if stage in STAGES else ():
            if receipt_name(later) in present:
                _withdraw(folder, later)
    if not present.isdisjoint({receipt_name(stage), *outputs}):
        _withdraw(folder, stage, outputs)
    for name in receipt["outputs"]:
        os.replace(scratch / name, folder / name)
    shutil.rmtree(scratch)


def _receipt_key(folder, stage):
    return (_read_receipt(folder, stage) or {}).get("key")


def _withdraw(folder, stage, outputs=()):
    """Remove a stage's receipt, then the outputs that it lists and those given."""
    listed = (_read_receipt(folder, stage) or {}).get("outputs", ())
    (folder / receipt_name(stage)).unlink(missing_ok=True)
    for name in {*outputs, *listed}:
        (folder / name).unlink(missing_ok=True)


def _one_line(text):
    return " ".join(text.split())[:500]
