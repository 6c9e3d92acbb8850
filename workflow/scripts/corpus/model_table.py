"""One table over all models: how each ended and why, its figures, seconds and memory."""

import re
from contextlib import suppress
from functools import cache
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from .layout import MODELS_FOLDER, SIDE_STAGES, STAGES, read_status
from .receipts import forget_stage, make_key, seal_table, valid_receipt
from .storage import read_json
from .whole_files import digest_file, place_whole

# Files of figures, and the stages that write them; of figures of one name, that of the later file counts.
FIGURES = {"inspection.json": "inspect_mesh", "sampling.json": "classify_handles"}
FIGURES |= {"exact_graphs.json": "certify_graphs", "certificate.json": "certify"}
FIGURES |= {"pockets.json": "find_pockets", "loops.json": "find_loops", "centrelines.json": "trace_centrelines"}
FIGURES |= {"functions.json": "graph_functions"}
FIRST = ("model", "path", "status", "reason", "verdict")
LONGEST = 8  # entries of a group or list that is spread over columns
PARTS = Path(".snakemake/reebslice_models")  # of the table, one per batch, as they were made last


def make_model_table(tables, code=None):
    """Return the table of models.

    Parameters
    ----------
    tables : mapping of str to sequence of str
        Paths of the status tables by stage, one per batch, the batches in one order.
    code : str, optional
        Digest of the code that makes the table. With it, the part of a batch
        is kept in :data:`PARTS`, and taken from there as long as the status
        tables, whose stamps tell of the files of figures, are the same.
    """
    stages = [stage for stage in STAGES if stage in tables]
    last = [f"{figure}_{stage}" for figure in ("seconds", "peak_memory_mb") for stage in stages]
    parts = []
    for paths in zip(*(tables[stage] for stage in stages), strict=True):  # rows as objects are held of one batch
        parts.append(_make_part(stages, paths, last)[0] if code is None else _keep_part(stages, paths, last, code))
    return _concatenate(parts, last).sort_by("model")


def _make_part(stages, paths, last):
    """Return the table of one batch, and whether all its files of figures could be read."""
    rows, whole = _join_stages(stages, paths)
    return _make_table(rows, last), whole


def _keep_part(stages, paths, last, code):
    """Return the table of one batch as it was kept, if that was made of the same; else make it, and try to keep it."""
    path = PARTS / Path(paths[0]).name
    key = make_key([digest_file(each) for each in paths], stages, code)
    if valid_receipt(PARTS, path.stem, key, [path.name]):
        return pq.ParquetFile(path).read()
    part, whole = _make_part(stages, paths, last)
    if whole:
        with suppress(OSError):
            with place_whole(path) as scratch:
                pq.write_table(part, scratch)
            seal_table(path, key=key)
    return part


def _join_stages(stages, paths):
    """Return the rows of one batch, from its status tables in the order of stages, and whether all could be read."""
    rows, without, whole = {}, set(), True
    for stage, path in zip(stages, paths, strict=True):
        for entry in read_status(path):
            row = rows.setdefault(entry["model"], _begun(entry))
            if stage == "certify_graphs" and entry["status"] == "ok":
                without.add(entry["model"])
            if row["status"] == "ok":  # the first stage that is not tells why
                aside = stage in SIDE_STAGES and entry["status"] in ("rejected", "skipped")  # its graphs are there
                row["status"] = "ok" if aside else entry["status"]
                row["reason"] = (row["reason"] if row["status"] == "ok" else "") or entry["reason"]
            row[f"seconds_{stage}"] = entry["seconds"]
            row[f"peak_memory_mb_{stage}"] = entry["peak_memory_mb"]
    for row in rows.values():
        if row["status"] == "rejected" and row["model"] in without:  # its graphs are there, made without levels
            row |= {"status": "ok", "reason": f"Exact graphs alone, without levels: {row['reason']}"}
        figures, fault = _figures(row["model"], stages)
        whole = whole and not fault
        row |= {name: figure for name, figure in figures.items() if name not in row}
        if fault and row["status"] in ("ok", "rejected"):
            row |= {"status": "failed", "reason": fault}
        if row["status"] == "ok":  # why it is uncertified, and what was refused aside
            row["reason"] = " ".join(filter(None, (figures.get("reason"), row["reason"])))
        if row["status"] != "ok":
            row["verdict"] = "rejected" if row["status"] == "rejected" else None
    return list(rows.values()), whole


def _begun(entry):
    """Return the beginning of a model's row."""
    return {"model": entry["model"], "path": entry["path"], "status": "ok", "reason": ""}


def _figures(model, stages):
    """Return the scalar figures that these stages left in JSON files, and a sentence on a file that is broken, or ''.

    The receipt of the stage that wrote that one goes, so that the next run makes it again.
    """
    figures, fault = {}, ""
    for name, stage in FIGURES.items():
        if stage not in stages:
            continue  # what an earlier configuration left
        path = MODELS_FOLDER / model / name
        try:
            figures |= _scalars(read_json(path))
        except FileNotFoundError:
            continue
        except (OSError, ValueError, AttributeError, RecursionError) as broken:  # damaged, or no group of figures
            fault = f"{path} cannot be read ({type(broken).__name__}: {broken}); the next run makes it again"
            with suppress(OSError):
                forget_stage([model], stage)
    return figures, fault


def _scalars(facts):
    """Spread facts over columns: scalars as they are, short groups and lists of scalars one level deep."""
    figures = {}
    for name, value in facts.items():
        if isinstance(value, (dict, list)):
            entries = value if isinstance(value, dict) else dict(enumerate(value[: LONGEST + 1]))
            if len(entries) <= LONGEST and not any(isinstance(entry, (dict, list)) for entry in entries.values()):
                figures |= {f"{name}_{key}": entry for key, entry in entries.items()}
        else:
            figures[name] = value
    return {_plain_name(name): value for name, value in figures.items()}


@cache
def _plain_name(name):
    return re.sub(r"\W+", "_", name)


def _make_table(rows, last):
    """Return the rows as a table, with a column for every figure that one of them has."""
    names = sorted({*FIRST, *last}.union(*rows))
    return pa.table({name: _column([row.get(name) for row in rows], name in last) for name in names})


def _column(values, real=False):
    """Return the values as an array of the narrowest type that holds all of them."""
    kinds = {type(value) for value in values if value is not None}
    if real or (kinds <= {int, float} and float in kinds):
        return pa.array([None if value is None else float(value) for value in values], pa.float64())
    if len(kinds) < 2 and kinds <= {int, bool}:
        return pa.array(values, {(int,): pa.int64(), (bool,): pa.bool_(), (): pa.null()}[tuple(kinds)])
    return pa.array([None if value is None else str(value) for value in values], pa.string())


def _concatenate(parts, last):
    """Return the tables as one: first who and how, then the figures by name, then seconds and memory."""
    types = {}
    for field in (field for part in parts for field in part.schema):
        types.setdefault(field.name, set()).add(field.type)
    figures = sorted(types.keys() - {*FIRST, *last})
    schema = pa.schema({name: _common_type(types[name]) for name in (*FIRST, *figures, *last)})
    parts = [part.cast(pa.schema([schema.field(name) for name in part.column_names])) for part in parts]
    return pa.concat_tables(parts, promote_options="default").select(schema.names)


def _common_type(types):
    """Return the narrowest type that holds the values of columns of these types."""
    types = types - {pa.null()}
    if len(types) == 1:
        return types.pop()
    return pa.float64() if types == {pa.int64(), pa.float64()} else pa.string()
