"""Values at vertices that lie in a Parquet file beside a mesh file: what a stage that reads them depends on."""

from pathlib import Path

from .whole_files import digest_file


def describe_values(path):
    """Return the options that tell a stage where the values of a mesh are, and by a digest which they are.

    Parameters
    ----------
    path : str
        Of the mesh file.

    Returns
    -------
    dict
        `path`; and `values`, the digest of `bone.values.parquet` beside `bone.ply`, or None where there is no such
        file, as `reebslice.formats.vertex_values` looks for it.
    """
    beside = Path(path).with_suffix(".values.parquet")
    return {"path": str(path), "values": digest_file(beside) if beside.is_file() else None}
