"""Gather one table of every model, each the result of a stage that is asked for by name."""

from pathlib import Path

import pyarrow as pa

from .layout import MODELS_FOLDER, read_status
from .receipts import valid_receipt
from .storage import read_table


def gather_tables(tables, stage, name):
    """Return the table `name` over all accepted models, in the order of their ids.

    tables : paths of the status tables of `stage`. One that tells of a
    model that failed, or promises what is gone or altered, is removed, so that
    the next run makes it again, and RuntimeError raised.
    """
    rows = {table: read_status(table) for table in tables}
    broken = {table: [row for row in rows[table] if _is_broken(row, stage, name)] for table in tables}
    for table in [table for table in tables if broken[table]]:
        Path(table).unlink()
    if any(broken.values()):
        gone = "its table is gone or altered"
        faults = [f"{row['model']}: {row['reason'] or gone}" for rows in broken.values() for row in rows]
        raise RuntimeError("not compared; the next run tries again:\n" + "\n".join(faults))
    done = sorted(row["model"] for table in tables for row in rows[table] if row["status"] == "ok")
    if not done:
        raise RuntimeError("there is no accepted model to compare anything on")
    return pa.concat_tables(read_table(MODELS_FOLDER / model / f"{name}.parquet", name) for model in done)


def _is_broken(row, stage, name):
    if row["status"] != "ok":
        return row["status"] == "failed"
    return valid_receipt(MODELS_FOLDER / row["model"], stage, row["key"], [f"{name}.parquet"]) is None
