"""Tables made from columns, and held against their declaration."""

import pyarrow as pa

from .schemas import SCHEMAS


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
