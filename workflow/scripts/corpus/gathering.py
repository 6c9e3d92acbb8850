"""Gather one table of every model."""

from pathlib import Path

import pyarrow as pa

from .layout import MODELS_FOLDER, read_status
from .receipts import valid_receipt
from .storage import read_table


def gather_tables(tables, stage, name):
    """Return the table `name` over all accepted models, in the order of their ids; as of :func:`read_tables`."""
    return pa.concat_tables(read_tables(tables, stage, name).values())


def read_tables(tables, stage, name, all_or_none=True):
    """Return the table `name` of each accepted model, {id: pyarrow.Table}, in the order of ids.

    tables : paths of the status tables of `stage`. One that promises what is gone
    or altered is removed, so that the next run makes it again, and RuntimeError
    raised. With `all_or_none` also one that tells of a model that failed, which
    is left out otherwise; and then there has to be some model.
    """
    rows = {table: read_status(table) for table in tables}
    broken = {table: [row for row in rows[table] if _is_broken(row, stage, name, all_or_none)] for table in tables}
    for table in [table for table in tables if broken[table]]:
        Path(table).unlink()
    if any(broken.values()):
        gone = "its table is gone or altered"
        faults = [f"{row['model']}: {row['reason'] or gone}" for rows in broken.values() for row in rows]
        raise RuntimeError("not compared; the next run tries again:\n" + "\n".join(faults))
    done = sorted(row["model"] for table in tables for row in rows[table] if row["status"] == "ok")
    if not done and all_or_none:
        raise RuntimeError("there is no accepted model to compare anything on")
    return {model: read_table(MODELS_FOLDER / model / f"{name}.parquet", name) for model in done}


def _is_broken(row, stage, name, all_or_none):
    if row["status"] != "ok":
        return row["status"] == "failed" and all_or_none
    receipt = valid_receipt(MODELS_FOLDER / row["model"], stage, row["key"])
    return receipt is None or f"{name}.parquet" not in receipt["outputs"]
