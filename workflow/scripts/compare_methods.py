"""Gather the comparison of all models into one table and one figure."""

from pathlib import Path

import pyarrow as pa

from corpus.layout import MODELS_FOLDER, read_status
from corpus.process import print_into
from corpus.receipts import valid_receipt
from corpus.storage import read_table, write_table
from reebslice.drawing.charts import draw_comparison
from reebslice.links.comparison import EVERY, rates


def main(tables):
    """Return the table `comparison` over all accepted models.

    tables : paths of the status tables of compare_links. One that tells of a
    model that failed, or promises what is gone or altered, is removed, so that
    the next run makes it again, and RuntimeError raised.
    """
    rows = {table: read_status(table) for table in tables}
    broken = {table: [row for row in rows[table] if _is_broken(row)] for table in tables}
    for table in [table for table in tables if broken[table]]:
        Path(table).unlink()
    if any(broken.values()):
        gone = "its table is gone or altered"
        faults = [f"{row['model']}: {row['reason'] or gone}" for rows in broken.values() for row in rows]
        raise RuntimeError("not compared; the next run tries again:\n" + "\n".join(faults))
    done = sorted(row["model"] for table in tables for row in rows[table] if row["status"] == "ok")
    if not done:
        raise RuntimeError("there is no accepted model to compare the methods on")
    return pa.concat_tables(read_table(_place(model), "comparison") for model in done)


def _place(model):
    return MODELS_FOLDER / model / "comparison.parquet"


def _is_broken(row):
    if row["status"] != "ok":
        return row["status"] == "failed"
    place = _place(row["model"])
    return valid_receipt(place.parent, "compare_links", row["key"], [place.name]) is None


if "snakemake" in globals():
    print_into(snakemake.log[0])
    table = main(list(snakemake.input))
    write_table(snakemake.output.table, "comparison", table)
    draw_comparison(table).savefig(snakemake.output.figure)
    frame = table.to_pandas()
    every = frame[frame["kind"] == EVERY]
    print(rates(every, ("half", "tilt", "n_levels", "method")).round(3).to_string())
