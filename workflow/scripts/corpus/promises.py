"""Promises: a status table vouches for files that Snakemake does not track."""

import os

from .layout import MODELS_FOLDER, MODELS_TABLE, STAGES, STATUS_FOLDER
from .receipts import receipt_name
from .storage import read_json

# --------------------------------------------------------------------------
# Promises: a status table vouches for files that Snakemake does not track


def find_broken_promises(batches, outputs):
    """Return, of every batch, the first status table that promises what is not there.

    A table is broken when a file of one of its models is gone. It is so, too,
    when one of its models failed, as a failure is tried again in every run,
    and when it is itself missing though later ones exist, which Snakemake
    would pass over.

    Parameters
    ----------
    batches : dict of str to list of str
        Models by batch.
    outputs : dict of str to tuple of str
        Names of the outputs per model, by stage.

    Returns
    -------
    list of str
        Paths of status tables, at most one per batch.
    """
    tables = {stage: _names(STATUS_FOLDER / stage) for stage in STAGES}
    collected = MODELS_TABLE.exists()
    broken = []
    for batch, members in batches.items():
        made = [f"{batch}.parquet" in tables[stage] for stage in STAGES]
        stages = [_first_broken_stage(model, made, outputs) for model in members]
        first = min(stages, default=len(STAGES))
        if first < len(STAGES) and (collected or any(made[first:])):
            broken.append(str(STATUS_FOLDER / STAGES[first] / f"{batch}.parquet"))
    return broken


def _first_broken_stage(model, made, outputs):
    """Return the number of the first stage that lacks its table or, of this model, a file."""
    folder = MODELS_FOLDER / model
    present = _names(folder)
    for number, stage in enumerate(STAGES):
        if not made[number] or receipt_name(stage) not in present:
            return number
        if not present.issuperset(outputs[stage]):
            receipt = read_json(folder / receipt_name(stage))
            rejected = receipt["status"] == "rejected" and present.issuperset(receipt["outputs"])
            # Of a rejected model later stages leave no file: their tables alone are asked for.
            return [*made, False].index(False) if rejected else number
    return len(STAGES)


def _names(folder):
    try:
        return set(os.listdir(folder))
    except FileNotFoundError:
        return set()
