"""Checks of form: tables as declared, ids and references that name rows, words that are known.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

from types import SimpleNamespace

import numpy as np
import pyarrow as pa

from ...schemas import EVENTS, GRAPHS, MODEL_TABLES, OPERATIONS, PAIRINGS, PIECE_KINDS
from ...table_checks import check_table, list_id_faults
from ..graphml import ReadGraph

WORDS = {
    ("levels", "why"): ("uniform", "refined"), ("pieces", "kind"): PIECE_KINDS, ("handles", "side"): ("A", "B"),
    ("handles", "operation"): OPERATIONS, ("handles", "change"): (None, *EVENTS), ("handles", "index"): (0, 1, 2),
    ("edges", "operation"): ("continuation", *OPERATIONS), ("edges", "method"): ("exact", "similarity", "proximity"),
    ("arcs", "graph"): ("solid", "surface", "void"), ("critical_points", "pairing"): PAIRINGS,
}  # fmt: skip


def check_form(facts, ledger):
    """Tables as declared, ids that count their rows, references to rows that exist."""
    tables, apart = facts.tables, {} if facts.read_curves is None else {"contours": ("geometry",)}
    faults = [fault for name in MODEL_TABLES for fault in _schema_fault(name, tables.get(name), apart.get(name, ()))]
    if not faults:
        columns = {name: {c: read_column(tables[name][c]) for c in tables[name].column_names} for name in MODEL_TABLES}
        facts.columns = SimpleNamespace(**columns)
        size = {name: tables[name].num_rows for name in MODEL_TABLES}
        for name, of_table in columns.items():
            faults += list_id_faults(name, tables[name], size)
            faults += _handle_faults(tables, size) if name == "edges" else ()
            for column, values in of_table.items():
                faults += _column_faults(name, column, tables[name][column], values)
        faults += [f"Table {name} is empty." for name in ("faces", "levels", "pieces") if not size[name]]
        faults += _document_faults(facts.tilt, facts.graphs)
    ledger.enter("tables_in_form", len(faults), 0, says=faults[0] if faults else "")


def _schema_fault(name, table, apart):
    """What is wrong with the form of a table: a list of one sentence, or of none."""
    if not isinstance(table, pa.Table):
        return [f"Table {name} is missing."]
    try:
        check_table(name, table, apart)
    except ValueError as fault:
        return [str(fault).splitlines()[0]]
    return []


def read_column(column):
    """Numbers and flags as an array, -1 or NaN for null, and words; lists as a list of lists; bytes as they are."""
    kind = column.type
    if pa.types.is_binary(kind):
        return column
    if pa.types.is_boolean(kind):
        return read_column(column.cast(pa.int8())).astype(bool)
    if pa.types.is_integer(kind) or pa.types.is_floating(kind):
        missing = -1 if pa.types.is_integer(kind) else np.nan
        return np.from_dlpack((column.fill_null(missing) if column.null_count else column).combine_chunks())
    return column.to_pylist() if pa.types.is_list(kind) else np.array(column.to_pylist(), object)


def _handle_faults(tables, size):
    """What is wrong with the handles that edges name, as sentences."""
    rows = read_column(tables["edges"]["handle"].drop_null())
    if len(rows) and not 0 <= rows.min() <= rows.max() < size["handles"]:
        yield "Column handle of table edges names a row that table handles does not have."


def _column_faults(name, column, data, values):
    """What is wrong with the words or numbers of a column; data : as Arrow has it, values : as it is read."""
    odd = set(values) - set(WORDS[name, column]) if (name, column) in WORDS else ()
    if odd:
        yield f"Column {column} of table {name} holds {sorted(map(str, odd))[0]!r}, which is no such word."
    if pa.types.is_floating(data.type) and np.isfinite(values).sum() < len(values) - data.null_count:
        yield f"Column {column} of table {name} holds a number that is not finite."


def _document_faults(tilt, graphs):
    """What is wrong with the form of the tilt and the graphs, as sentences."""
    for name, shape in {"rotation": (3, 3), "direction": (3,)}.items():
        try:
            values = np.asarray(tilt[name], float)
        except (KeyError, TypeError, ValueError):
            return [f"tilt.json has no {name} of numbers."]
        if values.shape != shape or not np.isfinite(values).all():
            return [f"The {name} in tilt.json has shape {values.shape}, not {shape}, or is not finite."]
    wrong = (name for name in GRAPHS if not isinstance(graphs.get(name), ReadGraph))
    return [f"The graph {name} is missing or no undirected multigraph." for name in wrong]
