"""Receipts: what vouches for the files that a stage left of a model."""

import hashlib
import json
import os
import shutil

from .layout import MODELS_FOLDER, STAGES
from .storage import read_json


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
    text = json.dumps([before, options, code], sort_keys=True, default=str)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def forget_stage(models, stage):
    """Remove what vouches for a stage's outputs of these models, so that it computes them anew."""
    for model in models:
        (MODELS_FOLDER / model / receipt_name(stage)).unlink(missing_ok=True)


def valid_receipt(folder, stage, key, outputs):
    """Return the model's receipt if it vouches for the content `key`, else None.

    A failure is no result, so it is tried again.
    """
    receipt = read_receipt(folder, stage)
    if receipt is None or receipt["key"] != key or receipt["status"] == "failed":
        return None
    promised = outputs if receipt["status"] == "ok" else receipt["outputs"]
    return receipt if all((folder / name).is_file() for name in promised) else None


def read_receipt(folder, stage):
    """Return the receipt of a stage in a model's folder, or None when there is none that can be read."""
    try:
        return read_json(folder / receipt_name(stage))
    except (OSError, ValueError):
        return None


def move_in(stage, scratch, folder, outputs, receipt):
    """Replace the model's files of this stage; its receipt is to be written last.

    When the content changes, what later stages made of the old one goes
    first: a model's folder never holds the results of two runs.
    """
    present = set(os.listdir(folder))
    if receipt_name(stage) not in present or _receipt_key(folder, stage) != receipt["key"] or receipt["status"] != "ok":
        for later in STAGES[STAGES.index(stage) + 1 :] if stage in STAGES else ():
            if receipt_name(later) in present:
                withdraw(folder, later)
    if not present.isdisjoint({receipt_name(stage), *outputs}):
        withdraw(folder, stage, outputs)
    for name in receipt["outputs"]:
        os.replace(scratch / name, folder / name)
    shutil.rmtree(scratch)


def _receipt_key(folder, stage):
    return (read_receipt(folder, stage) or {}).get("key")


def withdraw(folder, stage, outputs=()):
    """Remove a stage's receipt, then the outputs that it lists and those given."""
    listed = (read_receipt(folder, stage) or {}).get("outputs", ())
    (folder / receipt_name(stage)).unlink(missing_ok=True)
    for name in {*outputs, *listed}:
        (folder / name).unlink(missing_ok=True)
