"""Receipts: what vouches for the files that a stage left of a model.

A receipt tells the content key of its stage and of the stage before, so that
those of a model form a chain that begins at the mesh, and of every output its
size, its time and the digest of its bytes. A seal over all that makes it the
receipt of this model and shows where it was altered. It is no signature: who
makes receipts can make false ones.
"""

import hashlib
import json
import os
import shutil
from contextlib import contextmanager

from .layout import BEFORE, MODELS_FOLDER, line_behind, line_to
from .storage import AlteredFileError, read_json, write_json
from .whole_files import digest_file

AGAIN = "its stage computes it again in the next run"


def receipt_name(stage):
    """Return the name of the file that vouches for a stage's outputs."""
    return f".{stage}.json"


def make_key(before, options, code):
    """Return the content key of a stage's outputs.

    Parameters
    ----------
    before : str
        Content key of the stage before, or the digest of the mesh (:func:`.companions.digest_mesh`).
    options : dict
        The options that the stage uses.
    code : str
        Digest of the stage's code.
    """
    return _digest([before, options, code])


def _digest(facts):
    text = json.dumps(facts, sort_keys=True, default=str)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


# --------------------------------------------------------------------------
# One receipt


def write_receipt(folder, stage, receipt):
    """Write the receipt of a stage into a model's folder, sealed."""
    write_json(folder / receipt_name(stage), receipt | {"seal": _seal(folder, receipt)})


def read_receipt(folder, stage):
    """Return the receipt of a stage in a model's folder, or None where there is none or none to rely upon.

    Parameters
    ----------
    folder : Path
        The model's folder.
    stage : str

    Returns
    -------
    dict or None
        `key`, `before`, `status` ("ok", "rejected" or "failed"), `reason`,
        `seconds`, `peak_memory_mb` and `outputs`: of every file, by its plain
        name, the list of its size in bytes, its time in ns and its digest.
    """
    path = folder / receipt_name(stage)
    try:
        receipt = read_json(path) if path.is_file() else None
        seal = receipt.pop("seal")
        return receipt if all(map(_is_plain, receipt["outputs"])) and seal == _seal(folder, receipt) else None
    except (OSError, ValueError, AttributeError, KeyError, TypeError, RecursionError):
        return None


def _is_plain(name):
    """Whether a text is the name of a file, and no way into another folder."""
    return name.isprintable() and name == os.path.basename(name) and name not in ("", ".", "..")


def _seal(folder, receipt):
    return _digest([folder.name, receipt])


def seal_table(path, *more, key=""):
    """Leave a receipt beside what is over all models, and more files of it, so that it is seen when one is altered.

    key : what it was made of.
    """
    marks = {file.name: _mark(file) for file in (path, *more)}
    write_receipt(path.parent, path.stem, {"before": "", "key": key, "outputs": marks, "status": "ok"})


def valid_receipt(folder, stage, key, outputs=None):
    """Return the model's receipt if it vouches for the content `key` and all its files are as it says, else None.

    The files are digested; they have to be the `outputs`, if given. A failure is no result, so it is tried again.
    """
    receipt = read_receipt(folder, stage)
    if receipt is None or receipt["key"] != key or receipt["status"] == "failed":
        return None
    if receipt["status"] == "ok" and outputs is not None and receipt["outputs"].keys() != set(outputs):
        return None
    return receipt if all(_is_same(folder / name, mark, True) for name, mark in receipt["outputs"].items()) else None


def _mark(path):
    """Return what a receipt tells of a file."""
    stat = path.stat()
    return [stat.st_size, stat.st_mtime_ns, digest_file(path)]


def _is_same(path, mark, digested):
    """Whether a file is as its mark says; one of the same size and time is digested only where `digested`."""
    size, time, digest = mark
    try:
        stat = path.stat()
        if stat.st_size != size or not path.is_file():
            return False
        return (stat.st_mtime_ns == time and not digested) or digest_file(path) == digest
    except (OSError, ValueError):
        return False


# --------------------------------------------------------------------------
# What a stage reads


@contextmanager
def unchanged_inputs(stage, row, digest=None):
    """Vouch for what a stage reads of a model: within this context, give the content key of every file.

    Parameters
    ----------
    stage : str
    row : dict
        Of the model, in the status table of the stage before.
    digest : function, optional
        Of the first stage: gives the key of a mesh file.

    Raises
    ------
    AlteredFileError
        Before, if a file is not what the stage that wrote it left. After, if
        one was replaced in the meantime; whatever the stage made of it, a
        rejection too, then says nothing.
    """
    last = BEFORE[stage]
    if last is None:
        try:
            yield {}
        finally:
            _check_mesh(row, digest)
    else:
        folder = MODELS_FOLDER / row["model"]
        keys = trace_inputs(folder, last, row["key"], digested=stage == "certify")
        try:
            yield keys
        finally:
            trace_inputs(folder, last, row["key"])


def trace_inputs(folder, last, key, digested=False):
    """Follow the chain of receipts from the mesh to that of a stage, which is to have this content key.

    Parameters
    ----------
    folder : Path
        The model's folder.
    last : str
        The stage.
    key : str
    digested : bool
        Digest every file, and not only those of another size or time than their receipt says.

    Returns
    -------
    dict
        The content key of each file by its name.

    Raises
    ------
    AlteredFileError
        If a receipt is missing or none to rely upon, is not about what the one
        before it vouches for, or a file is not as its receipt says.
    """
    keys, before = {}, None
    for stage in line_to(last):
        receipt = read_receipt(folder, stage)
        path = folder / receipt_name(stage)
        if receipt is None:
            raise AlteredFileError(path, f"{path}: is missing, or was altered; {AGAIN}")
        if before not in (None, receipt["before"]):
            raise AlteredFileError(path, f"{path}: vouches for what was made of other files than are there; {AGAIN}")
        for name, mark in receipt["outputs"].items():
            path = folder / name
            if not _is_same(path, mark, digested):
                raise AlteredFileError(path, f"{path}: is not the file that {stage} wrote; {AGAIN}")
            keys[name] = receipt["key"]
        before = receipt["key"]
    if before != key:
        path = folder / receipt_name(last)
        raise AlteredFileError(path, f"{path}: is not the receipt of the status table; start the run again")
    return keys


def _check_mesh(row, digest):
    """Raise AlteredFileError unless the mesh file still is the one whose digest the row holds."""
    path = row["path"]
    try:
        same = digest is None or digest(path) == row["key"]
    except OSError:
        same = False
    if not same:
        raise AlteredFileError(path, f"{path}: was replaced while it was read; the next run reads it again")


def disown(model, path):
    """Forget the stage that wrote the file `path` of a model, and those behind it, which may have read it."""
    folder = MODELS_FOLDER / model
    for stage in BEFORE:
        written = (read_receipt(folder, stage) or {}).get("outputs", ())
        if os.path.basename(path) in (receipt_name(stage), *written):
            for later in line_behind(stage):
                forget_stage([model], later)
            return


# --------------------------------------------------------------------------
# What a stage leaves


def forget_stage(models, stage):
    """Remove what vouches for a stage's outputs of these models, so that it computes them anew."""
    for model in models:
        _remove(MODELS_FOLDER / model / receipt_name(stage))


def move_in(stage, scratch, folder, outputs, receipt):
    """Replace the model's files of this stage, and mark them in its receipt, which is to be written last.

    When the content changes, what later stages made of the old one goes
    first: a model's folder never holds the results of two runs. So it does
    where a file was altered, as they may have read it.

    Parameters
    ----------
    stage : str
    scratch : Path
        Folder that holds the files; it goes.
    folder : Path
        The model's folder.
    outputs : sequence of str
        All that the stage may leave.
    receipt : dict
        Its `outputs`, the names of the files, become their marks.
    """
    present, old = set(os.listdir(folder)), read_receipt(folder, stage)
    if old is None or old["key"] != receipt["key"] or receipt["status"] != "ok" or _is_altered(folder, old):
        for later in line_behind(stage)[1:]:
            if receipt_name(later) in present:
                withdraw(folder, later)
    if not present.isdisjoint({receipt_name(stage), *outputs}):
        withdraw(folder, stage, outputs)
    for name in receipt["outputs"]:
        os.replace(scratch / name, folder / name)
    receipt["outputs"] = {name: _mark(folder / name) for name in receipt["outputs"]}
    shutil.rmtree(scratch)


def _is_altered(folder, receipt):
    """Whether a file is there that is not as the receipt says."""
    marks = receipt["outputs"].items()
    return any((folder / name).exists() and not _is_same(folder / name, mark, True) for name, mark in marks)


def withdraw(folder, stage, outputs=()):
    """Remove a stage's receipt, then the outputs that it lists and those given."""
    listed = (read_receipt(folder, stage) or {}).get("outputs", ())
    for name in (receipt_name(stage), *outputs, *listed):
        _remove(folder / name)


def _remove(path):
    """Remove what is at `path`, if anything: a folder, too, would be in the way of a file."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
