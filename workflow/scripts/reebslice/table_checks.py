"""Tables made from columns, and held against their declaration and against each other."""

import numpy as np
import pyarrow as pa

from .schemas import SCHEMAS

# Columns that count the rows of their table from 0.
ROW_IDS = {
    name: name[:-1]
    for name in (
        "shells", "levels", "contours", "pieces", "handles", "nodes", "edges", "loops", "pockets", "islands", "regions",
    )
} | {
    "critical_points": "critical", "critical_arcs": "arc", "unfoldings": "unfolding", "centreline_points": "point",
    "branches": "branch", "exact_nodes": "node",
}  # fmt: skip
# Foreign keys: of every table the columns that hold numbers of rows, or lists of
# them, and the table whose rows they are. Regions are the rows of `nodes`, and no
# more than there are contours; blocks, no more than pieces. A slab may also be -1.
# The `handle` of an edge and the ends of an arc are not among them: where links are
# guessed, they are joints of other numbers.
_ENDS = (
    ("begin", "vertices"), ("end", "vertices"), ("begin_handle", "handles"), ("end_handle", "handles"),
    ("shells", "shells"),
)  # fmt: skip
REFERENCES = {
    "faces": (("a", "vertices"), ("b", "vertices"), ("c", "vertices"), ("shell", "shells")),
    "shells": (("body", "shells"), ("parent", "shells")),
    "contours": (
        ("level", "levels"), ("shell", "shells"), ("region", "nodes"), ("region", "contours"), ("parent", "contours"),
        ("lower_vertex", "vertices"), ("upper_vertex", "vertices"),
    ),
    "unfoldings": (("vertex", "vertices"), ("first", "vertices"), ("last", "vertices")),
    "pieces": (
        ("slab", "levels"), ("shell", "shells"), ("block", "pieces"), ("below", "contours"), ("above", "contours"),
        ("critical", "vertices"),
    ),
    "handles": (
        ("slab", "levels"), ("piece", "pieces"), ("block", "pieces"), ("vertex", "vertices"), ("pair", "handles"),
        ("contours_below", "contours"), ("contours_above", "contours"),
        ("regions_below", "nodes"), ("regions_above", "nodes"),
    ),
    "critical_points": (("vertex", "vertices"), ("partner", "critical_points"), ("handle", "handles")),
    "critical_arcs": (("source", "critical_points"), ("target", "critical_points")),
    "nodes": (("level", "levels"), ("region", "nodes")),
    "edges": (("source", "nodes"), ("target", "nodes"), ("slab", "levels")),
    "pockets": (*_ENDS, ("into", "pockets")),
    "islands": (*_ENDS, ("into", "islands")),
    "loops": (
        ("bottom", "vertices"), ("top", "vertices"), ("path", "vertices"),
        ("bottom_handle", "handles"), ("top_handle", "handles"),
    ),
    "face_arcs": (
        ("face", "faces"), ("surface_arc", "arcs"), ("solid_arc", "arcs"), ("critical_arc", "critical_arcs"),
    ),
    "parts": (("solid_arc", "arcs"),),
    "regions": (("region", "nodes"), ("level", "levels")),
    "exact_nodes": (("vertex", "vertices"), ("partner", "exact_nodes")),
    "exact_arcs": (("source", "exact_nodes"), ("target", "exact_nodes")),
    "function_values": (("vertex", "vertices"),),
    "function_nodes": (("vertex", "vertices"),),
    "branches": (
        ("source", "centreline_points"), ("target", "centreline_points"), ("points", "centreline_points"),
    ),
}  # fmt: skip


def build_table(name, columns):
    """Make the table `name` from a mapping of column name to array or list.

    Raises ValueError, naming the table and the column, when a column is
    missing, unknown or cannot be stored losslessly in its declared type.
    """
    schema = SCHEMAS[name]
    missing = [field.name for field in schema if field.name not in columns]
    unknown = [column for column in columns if column not in schema.names]
    if missing or unknown:
        raise ValueError(f"table {name}: missing columns {missing}, unknown columns {unknown}")
    arrays = []
    for field in schema:
        try:
            arrays.append(pa.array(columns[field.name], type=field.type))
        except (pa.ArrowInvalid, pa.ArrowTypeError) as error:
            raise ValueError(f"table {name}, column {field.name}: {error}") from error
    table = pa.Table.from_arrays(arrays, schema=schema)
    check_table(name, table)
    return table


def check_table(name, table, without=()):
    """Raise ValueError unless `table` has exactly the columns declared for `name`, but for those `without`.

    Types and order are compared, and a null in a column that admits none is
    an error. Metadata of the file (content key, GeoParquet) are not compared.
    """
    check_schema(name, table.schema, without)
    check_nulls(name, table)


def check_schema(name, schema, without=()):
    """Raise ValueError unless `schema` has exactly the columns declared for `name`, in order, but for `without`."""
    expected = pa.schema([field for field in SCHEMAS[name] if field.name not in without])
    if not schema.equals(expected, check_metadata=False):
        raise ValueError(
            f"table {name} does not match its schema:\nfound\n{schema.to_string(show_schema_metadata=False)}"
            f"\nexpected\n{expected.to_string(show_schema_metadata=False)}"
        )


def check_nulls(name, table):
    """Raise ValueError if a column that admits no null holds one; `table` may lack columns."""
    for column in table.column_names:
        if not SCHEMAS[name].field(column).nullable and table[column].null_count:
            raise ValueError(f"table {name}, column {column}: holds nulls, and may not")


def check_ids(name, table, rows):
    """Raise ValueError if a column that counts the rows does not, or one names a row that is not there.

    Parameters
    ----------
    name : str
    table : pyarrow.Table
        As declared; it may lack columns.
    rows : dict of str to int
        Numbers of rows of the tables that are known. What points into another is not checked.
    """
    faults = list_id_faults(name, table, rows)
    if faults:
        raise ValueError(faults[0])


def list_id_faults(name, table, rows):
    """List what is wrong with the ids of a table, one sentence a column; parameters as for :func:`check_ids`."""
    faults = []
    counting = ROW_IDS.get(name)
    if counting in table.column_names:
        ids = _numbers(table[counting])
        if not np.array_equal(ids, np.arange(len(ids))):
            faults.append(f"Column {counting} of table {name} does not count its rows from 0.")
    for column, target in REFERENCES.get(name, ()):
        if column in table.column_names and target in rows:
            ids, lowest = _numbers(table[column]), -1 if column == "slab" else 0
            if len(ids) and not (ids.min() >= lowest and ids.max() < rows[target]):
                faults.append(f"Column {column} of table {name} names a row that table {target} does not have.")
    return faults


def _numbers(column):
    """Return the numbers of a column, those in its lists one after the other, without nulls."""
    array = column.combine_chunks()
    array = array.flatten() if pa.types.is_list(column.type) else array
    if array.null_count:
        return np.array([number for number in array.to_pylist() if number is not None], np.int64)
    return np.from_dlpack(array)  # its own to_numpy would import pandas
