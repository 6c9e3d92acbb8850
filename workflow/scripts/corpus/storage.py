"""Reading and writing the files that the stages hand on.

Parquet for tables, JSON for single facts. Every table is held against its
declaration in :mod:`reebslice.schemas` on the way out and on the way in, where
its ids are also held against the tables beside it that they point into.
"""

import json
import math
import os
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import lru_cache
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from reebslice.schemas import FORMAT_VERSION, SCHEMAS, file_schema
from reebslice.table_checks import REFERENCES, check_ids, check_nulls, check_schema, check_table

from .whole_files import place_whole

KEY = b"reebslice:content_key"
TABLE = b"reebslice:table"
VERSION = b"reebslice:format_version"

# GeoParquet 1.1; the coordinates are those of the tilted frame, in the units
# of the mesh, so there is no coordinate reference system to name.
GEOPARQUET = {
    name: {
        "version": "1.1.0",
        "primary_column": "geometry",
        "columns": {"geometry": {"encoding": "WKB", "geometry_types": types, "crs": None, "edges": "planar"}},
    }
    for name, types in (("contours", ["LineString"]), ("regions", ["Polygon", "MultiPolygon"]))
}

# Of columns of numbers the bytes of equal weight are laid side by side, or the
# steps from row to row; both halve files and the time for them where dictionaries
# do nothing, because hardly a value occurs twice.
ENCODINGS = {pa.float64(): "BYTE_STREAM_SPLIT", pa.int32(): "DELTA_BINARY_PACKED"}

_content_key = ContextVar("content_key", default="")
_input_keys = ContextVar("input_keys", default=None)
_model = ContextVar("model", default=None)
ROWS = 2**20  # of a column that says one word throughout, which share its bytes in memory


class AlteredFileError(ValueError):
    """A file is not what was written there; the text says which, how it differs, and the cure.

    Attributes
    ----------
    path : path-like
        The file.
    """

    def __init__(self, path, text):
        super().__init__(text)
        self.path = path


@contextmanager
def content_key(key, inputs=None, model=None):
    """Within this context every table written carries the content key `key`, and in its column `model` that model.

    Of the tables read, those that `inputs` names, {file name: key}, must carry theirs, and all the model.
    """
    tokens = _content_key.set(key), _input_keys.set(inputs), _model.set(model)
    try:
        yield
    finally:
        _content_key.reset(tokens[0])
        _input_keys.reset(tokens[1])
        _model.reset(tokens[2])


def write_table(path, name, table, key=None):
    """Write `table`, declared as `name`, to the Parquet file `path`.

    The file's metadata tell the content key (`key`, or the one of the
    surrounding :func:`content_key`), the table's name and the format's
    version; its first column is the model, so that tables of many can be put
    together. Raises ValueError when the table does not match its declaration.
    """
    write_blocks(path, name, [table], key)


def write_blocks(path, name, tables, key=None):
    """The same of a table that comes as an iterable of blocks of rows, at least one, of which one is held at a time."""
    schema = file_schema(name)
    metadata = schema.metadata | {
        KEY: (key if key is not None else _content_key.get()).encode(),
        TABLE: name.encode(),
        VERSION: FORMAT_VERSION.encode(),
    }
    if name in GEOPARQUET:
        metadata[b"geo"] = json.dumps(GEOPARQUET[name]).encode()
    _write_row_groups(path, schema.with_metadata(metadata), (_as_declared(name, table) for table in tables))


def _as_declared(name, table):
    check_table(name, table)
    table = table.cast(SCHEMAS[name])  # puts the declared units back on the columns
    schema = file_schema(name)
    return table if schema.names == table.column_names else table.add_column(0, schema.field(0), _say_model(len(table)))


def _say_model(rows):
    """The column that says the model of the surrounding :func:`content_key` in each of some rows."""
    word = pa.repeat(pa.scalar(_model.get() or "", pa.string()), min(rows, ROWS))
    return pa.chunked_array([*[word] * (rows // ROWS), word.slice(0, rows % ROWS)])


def read_table(path, name, without=()):
    """Return the table `name` from the Parquet file `path`, but for the columns `without` and the model.

    Raises AlteredFileError, which is a ValueError, when the file is no Parquet
    file, holds another table or one of another content key or model than the
    surrounding :func:`content_key` says, was written in another format version,
    does not match the declaration, or holds ids that are not those of rows of
    the tables beside it.
    """
    path = Path(path)
    with _refusal(path):
        file = _open_table(path, name)
        wanted = [column for column in SCHEMAS[name].names if column not in without]
        table = file.read(wanted, use_threads=False)
        check_nulls(name, table)
    _check_ids_beside(path, name, table)
    return table


def read_blocks(path, name, column):
    """Yield a column of the table `name` in the Parquet file `path`, block by block of rows, as Arrow arrays.

    Of a column that is large one block is held at a time. Raises as :func:`read_table` does.
    """
    path = Path(path)
    with _refusal(path):
        file = _open_table(path, name)
        for group in range(file.num_row_groups):
            table = file.read_row_group(group, [column], use_threads=False)
            check_nulls(name, table)
            yield from table[column].chunks


def _open_table(path, name):
    """Open the file, held against declaration, name, version and content key."""
    file = pq.ParquetFile(path, memory_map=True)  # files are replaced whole, never written in place
    metadata = file.schema_arrow.metadata or {}
    found = metadata.get(TABLE, b"").decode(), metadata.get(VERSION, b"").decode()
    if found != (name, FORMAT_VERSION):
        raise ValueError(
            f"holds table {found[0]!r} in format {found[1]!r}, expected {name!r} in format {FORMAT_VERSION!r}"
        )
    key, expected = metadata.get(KEY, b"").decode(), (_input_keys.get() or {}).get(path.name)
    if expected not in (None, key):
        raise ValueError(f"carries the content key {key!r}, but its receipt says {expected!r}: it is of other results")
    schema, columns = file.schema_arrow, file_schema(name).names
    if schema.names[:1] != columns[:1]:
        raise ValueError(f"its first column is not {columns[0]}")
    check_schema(name, schema if columns == SCHEMAS[name].names else schema.remove(0))
    if columns != SCHEMAS[name].names and _model.get() is not None:
        _check_model(file.metadata, _model.get())
    return file


def _check_model(metadata, model):
    """Refuse a table of another model, by the least and the greatest word in its column of models."""
    for group in range(metadata.num_row_groups):
        told = metadata.row_group(group).column(0).statistics
        if metadata.row_group(group).num_rows and not (told and told.has_min_max and told.min == told.max == model):
            raise ValueError(f"holds rows of another model than {model!r}")


@contextmanager
def _refusal(path):
    """Say of which file it is that it cannot be read, and what cures that."""
    try:
        yield
    except (FileNotFoundError, MemoryError):
        raise
    except (ValueError, OSError, pa.ArrowException) as fault:
        cure = "delete the file and run the workflow again"
        raise AlteredFileError(path, f"{path}: {fault}; {cure}") from None


def _check_ids_beside(path, name, table):
    """Hold the ids of a table against the tables beside it that are there."""
    rows = {name: table.num_rows}
    for target in {target for _, target in REFERENCES.get(name, ())} - rows.keys():
        beside = path.with_name(f"{target}.parquet")
        with suppress(FileNotFoundError), _refusal(beside):
            rows[target] = _count_rows(beside, beside.stat().st_mtime_ns)
    with _refusal(path):
        check_ids(name, table, rows)


@lru_cache(maxsize=64)  # of one model many tables point into few
def _count_rows(path, time):
    """Return the number of rows of the Parquet file that was at the path at that time."""
    return pq.ParquetFile(path).metadata.num_rows


def read_key(path):
    """Return the content key that the Parquet file `path` carries, or ''."""
    return (pq.read_schema(path).metadata or {}).get(KEY, b"").decode()


def write_parquet(path, table):
    """Write any table to `path`, compressed with snappy, whole or not at all.

    It is on the disk before it appears, and its name when this returns.
    """
    _write_row_groups(path, table.schema, [table], durably=True)


def _write_row_groups(path, schema, tables, durably=False):
    words = [field.name for field in schema if pa.types.is_string(field.type)]
    raw = [field.name for field in schema if pa.types.is_binary(field.type)]
    compression = {name: "none" if name in raw else "snappy" for name in schema.names} if raw else "snappy"
    encodings = {field.name: ENCODINGS[field.type] for field in schema if field.type in ENCODINGS}
    style = {"compression": compression, "use_dictionary": words, "column_encoding": encodings}
    with place_whole(path, durably) as scratch, pq.ParquetWriter(scratch, schema, **style) as writer:
        for table in tables:
            writer.write_table(table.replace_schema_metadata(schema.metadata))


def write_text(path, text):
    """Write `text` to `path` in UTF-8, whole or not at all."""
    with place_whole(path) as scratch:
        scratch.write_text(text, encoding="utf-8")


def write_json(path, facts):
    """Write the mapping `facts` to `path`: sorted keys, numpy values allowed.

    Raises ValueError, naming the place, on a number that is not finite: JSON
    cannot say it, and an unknown figure is null.
    """
    try:
        text = json.dumps(facts, sort_keys=True, indent=1, allow_nan=False, default=_plain)
    except ValueError:
        place = _first_nonfinite(facts)
        raise ValueError(f"{path}: {place} is not a finite number; write None for an unknown figure") from None
    write_text(path, text + "\n")


def read_json(path):
    """Return what the JSON file `path` holds."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def _plain(value):
    """Turn a numpy scalar or array, or a path, into what JSON knows."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} {value!r} cannot be written as JSON")


def _first_nonfinite(value, place=""):
    """Return the place of the first NaN or infinity in nested facts, or None."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return None if math.isfinite(value) else place or "the value"
    if isinstance(value, dict):
        entries = [(f"{place}.{name}" if place else str(name), entry) for name, entry in value.items()]
    elif isinstance(value, (list, tuple)):
        entries = [(f"{place}[{i}]", entry) for i, entry in enumerate(value)]
    else:
        return None
    return next((found for name, entry in entries if (found := _first_nonfinite(entry, name))), None)
