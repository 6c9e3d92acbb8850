"""How a run ended, by the table of all models: what the last lines on the console say."""

from collections import Counter

import pyarrow.parquet as pq

from reebslice.drawing.verdicts import SOUND, shorten_numbers, tell_kind

FIRST = 3  # so many of a kind are told, and the number of all


def tell_outcome(path):
    """Return the last lines of a run over the models of the table at `path`.

    Returns
    -------
    lines : list of str
        How many models there are, by verdict; those that need a look, with
        their reasons, of each kind the first; the path of the table.
    failed : int
        How many models failed, which the next run tries again.
    """
    wanted = ("model", "status", "verdict", "reason", "void_verdict", "basins_count")
    file = pq.ParquetFile(path)
    rows = file.read(columns=[name for name in wanted if name in file.schema_arrow.names]).to_pylist()
    kinds = Counter(_kind(row) for row in rows)
    order = sorted(kinds, key=lambda kind: (*(kind != word for word in (*SOUND, "uncertified", "rejected")), kind))
    lines = [
        f"{len(rows)} model{'s' if len(rows) != 1 else ''}: {', '.join(f'{kinds[kind]} {kind}' for kind in order)}"
    ]
    looked = [kind for kind in order if kind not in SOUND]
    if looked:
        lines.append("What needs a look:")
    for kind in looked:
        told = [f"{row['model']}: {kind}: {shorten_numbers(row['reason'])}" for row in rows if _kind(row) == kind]
        lines += list_first(told)
    sound = [row for row in rows if _kind(row) in SOUND]
    unsure = [row["model"] for row in sound if "basins_count" in row and row.get("void_verdict") == "uncertified"]
    if unsure:
        lines.append(f"Pockets are not certified of {len(unsure)}, as the column void_reason says: {unsure[0]} first")
    noted = [row["model"] for row in sound if row["reason"]]
    if noted:
        told = f"Something beside the graphs is left out of {len(noted)}"
        lines.append(f"{told}, as the column reason says: {noted[0]} first")
    return [*lines, f"All models, with reasons and figures: {path.absolute()}"], kinds["FAILED"]


def close_idle_runs(workflow, close):
    """Have `close` called at the end of a run that finds nothing to do, for which Snakemake calls none of its hooks.

    Parameters
    ----------
    workflow : snakemake.workflow.Workflow
    close : function without arguments
    """
    execute = workflow.execute

    def execute_and_close(*arguments, **settings):
        execute(*arguments, **settings)
        if not (len(workflow.dag) or workflow.dryrun or workflow.execution_settings.no_hooks):
            close()

    workflow.execute = execute_and_close


def list_first(lines):
    """Return the first of some lines, indented, and how many more there are."""
    more = [f"and {len(lines) - FIRST} more"] if len(lines) > FIRST else []
    return [f"  {line}" for line in lines[:FIRST] + more]


def _kind(row):
    """Return the verdict of a model, or how else it ended."""
    kind = tell_kind(row["status"], row["verdict"])
    return "FAILED" if kind == "failed" else kind
