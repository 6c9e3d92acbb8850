"""How a table is declared: types of columns, and what their metadata tell."""

import pyarrow as pa

INT = pa.int32()
INTS = pa.list_(pa.int32())
REAL = pa.float64()
REALS = pa.list_(pa.float64())
FLAG = pa.bool_()
TEXT = pa.string()
WKB = pa.binary()


def _field(name, kind, description, unit="", null=False):
    """Declare a column."""
    metadata = {"description": description} | ({"unit": unit} if unit else {})
    return pa.field(name, kind, nullable=null, metadata=metadata)


def table(key, description, *columns):
    """Declare a table by its primary key, what a row of it is, and its columns."""
    metadata = {"reebslice:primary_key": key, "description": description}
    return pa.schema([_field(*column[:3], **dict(column[3:])) for column in columns], metadata=metadata)


def with_model(schema):
    """Declare a table of one model as its file holds it.

    Parameters
    ----------
    schema : pyarrow.Schema
        Of :func:`table`.

    Returns
    -------
    pyarrow.Schema
        The first column is `model`, so that the tables of many models can be put together; in memory a table is of
        one model and does without. Metadata tell the key of the rows.
    """
    if "model" in schema.names:
        return schema
    key = f"model, {schema.metadata[b'reebslice:primary_key'].decode()}"
    model = table(key, schema.metadata[b"description"].decode(), ("model", TEXT, "Id of the model."))
    return pa.schema([*model, *schema], metadata=model.metadata)
