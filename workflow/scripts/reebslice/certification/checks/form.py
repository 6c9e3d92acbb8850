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

WORDS = (
    ("levels", "why", ("uniform", "refined")), ("pieces", "kind", PIECE_KINDS), ("handles", "side", ("A", "B")),
    ("handles", "operation", OPERATIONS), ("handles", "change", (None, *EVENTS)), ("handles", "index", (0, 1, 2)),
    ("edges", "operation", ("continuation", *OPERATIONS)), ("edges", "method", ("exact", "similarity", "proximity")),
    ("arcs", "graph", ("solid", "surface")), ("critical_points", "pairing", PAIRINGS),
)  # fmt: skip


def check_form(facts, ledger):
    """Tables as declared, ids that count their rows, references to rows that exist."""
    apart = {} if facts.read_curves is None else {"contours": ("geometry",)}
    given = ((name, facts.tables.get(name), apart.get(name, ())) for name in MODEL_TABLES)
    faults = [fault for table in given for fault in _schema_fault(*table)]
    if faults:
        ledger.enter("tables_in_form", len(faults), 0, says=faults[0])
        return
    facts.columns = SimpleNamespace(**{name: _columns(facts.tables[name]) for name in MODEL_TABLES})
    size = {name: facts.tables[name].num_rows for name in MODEL_TABLES}
    for name in MODEL_TABLES:
        faults += list_id_faults(name, facts.tables[name], size)
    for name, column, words in WORDS:
        odd = set(getattr(facts.columns, name)[column]) - set(words)
        if odd:
            faults.append(f"Column {column} of table {name} holds {sorted(map(str, odd))[0]!r}, which is no such word.")
    for name in MODEL_TABLES:
        for column, values in getattr(facts.columns, name).items():
            if isinstance(values, np.ndarray) and values.dtype.kind == "f" and not np.isfinite(values).all():
                faults.append(f"Column {column} of table {name} holds a number that is not finite.")
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


def _document_faults(tilt, graphs):
    """What is wrong with the form of the tilt and the graphs, as sentences."""
    shapes = {"rotation": (3, 3), "direction": (3,)}
    for name, shape in shapes.items():
        try:
            values = np.asarray(tilt[name], float)
        except (KeyError, TypeError, ValueError):
            return [f"tilt.json has no {name} of numbers."]
        if values.shape != shape or not np.isfinite(values).all():
            return [f"The {name} in tilt.json has shape {values.shape}, not {shape}, or is not finite."]
    return [
        f"The graph {name} is missing or no undirected multigraph."
        for name in GRAPHS
        if not isinstance(graphs.get(name), ReadGraph)
    ]


def _columns(table):
    """Columns as arrays; those with lists or nulls as Python lists, those of bytes as they are."""
    out = {}
    for field in table.schema:
        column = table[field.name]
        if pa.types.is_integer(field.type) or pa.types.is_floating(field.type):
            out[field.name] = column.to_pylist() if field.nullable else np.from_dlpack(column.combine_chunks())
        elif pa.types.is_binary(field.type):
            out[field.name] = column
        elif pa.types.is_list(field.type) or field.nullable:
            out[field.name] = column.to_pylist()
        else:
            out[field.name] = np.array(column.to_pylist(), bool if pa.types.is_boolean(field.type) else object)
    return out
