"""Values at the vertices of a mesh file: a property of a PLY file, or a column of a Parquet file beside it."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.spatial import cKDTree

from ..errors import MeshFormatError
from ..mesh.faults import format_point
from .meshes import read_mesh
from .ply import read_ply_property

ENDING = ".values.parquet"


def find_values_file(path):
    """Tell where the Parquet file with values for a mesh file lies: `bone.values.parquet` beside `bone.ply`."""
    return Path(path).with_suffix(ENDING)


def read_vertex_values(path, name, points, tolerance=0.0):
    """Read a function on a surface from the mesh file, or from the file beside it where there is one.

    Parameters
    ----------
    path : path
        The mesh file.
    name : str
        Of the property, or of the column, which has a number for each vertex in the order of the file.
    points : (n, 3) float64
        Vertices of the surface that was made of it.
    tolerance : float
        Within which vertices of the file may have been merged, as a part of the largest extent.

    Returns
    -------
    (n,) float64
        The values at the vertices of the file that lie where those of the surface do.

    Raises
    ------
    MeshFormatError
        There are no such values, not as many as vertices, some are not finite, two that were merged differ, or none
        is at a vertex of the surface, since a repair moved it.
    """
    mesh, beside = read_mesh(path), find_values_file(path)
    if beside.is_file():
        values = _read_column(beside, name)
    elif Path(path).suffix.lower() == ".ply":
        values = read_ply_property(Path(path), name)
    else:
        raise MeshFormatError(
            f"There are no values {name}: only PLY files carry any; write them as a column of {beside.name} beside it."
        )
    if len(values) != len(mesh.points):
        raise MeshFormatError(
            f"{beside.name} has {len(values)} rows, but the mesh file {len(mesh.points)} vertices: one row for each, in"
            " the order of the file."
        )
    _check_finite(values, mesh.points, name)
    _check_merged(mesh.points, values, points, tolerance * np.ptp(mesh.points, axis=0).max(), name)
    return _look_up(mesh.points, values, points, name)


def _read_column(path, name):
    """A column of numbers of a Parquet file, (k,) float64, nulls as NaN."""
    try:
        file = pq.ParquetFile(path)
        if name not in file.schema_arrow.names:
            raise MeshFormatError(f"{path.name} has no column {name}, but {', '.join(file.schema_arrow.names)}.")
        column = file.read([name])[name]
        return column.cast(pa.float64()).combine_chunks().to_numpy(zero_copy_only=False)
    except (OSError, pa.ArrowException) as fault:
        raise MeshFormatError(f"{path.name} has no numbers {name} that can be read ({fault}).") from None


def _check_finite(values, places, name):
    """Refuse values that are no numbers."""
    odd = np.flatnonzero(~np.isfinite(values))
    if len(odd):
        raise MeshFormatError(
            f"{len(odd)} values of {name} are not finite; the first is {values[odd[0]]:g} in row {odd[0]} from 0,"
            f" at {format_point(places[odd[0]])}."
        )


def _check_merged(places, values, points, distance, name):
    """Refuse values of vertices of the file that were merged into one of another value."""
    away, nearest = cKDTree(places).query(points)
    of_point = values[nearest]
    pairs = cKDTree(points).query(places, distance_upper_bound=max(distance, np.finfo(float).tiny))
    merged = np.flatnonzero((pairs[0] > 0) & np.isfinite(pairs[0]))
    torn = merged[(values[merged] != of_point[pairs[1][merged]]) & (away[pairs[1][merged]] == 0)]
    if len(torn):
        at = pairs[1][torn[0]]
        raise MeshFormatError(
            f"{name} has several values where vertices are merged, {of_point[at]:g} and {values[torn[0]]:g} at"
            f" {format_point(points[at])}, for {len(torn)} vertices: give vertices that are merged one value."
        )


def _look_up(places, values, points, name):
    """Values at `points` by those at `places`."""
    spots, row = np.unique(np.concatenate([points, places]) + 0.0, axis=0, return_inverse=True)
    row = row.ravel()
    of_file, wanted = row[len(points) :], row[: len(points)]
    low, high = np.full(len(spots), np.inf), np.full(len(spots), -np.inf)
    np.minimum.at(low, of_file, values)
    np.maximum.at(high, of_file, values)
    lacking = np.flatnonzero(low[wanted] == np.inf)
    if len(lacking):
        raise MeshFormatError(
            f"{len(lacking)} vertices of the surface are at no vertex of the file, since repairs moved or added them,"
            f" and so have no {name}; the first is at {format_point(points[lacking[0]])}. Mend the mesh in the file."
        )
    torn = np.flatnonzero(low[wanted] < high[wanted])
    if len(torn):
        at = wanted[torn[0]]
        raise MeshFormatError(
            f"{name} has several values at one place, {low[at]:g} and {high[at]:g} at {format_point(spots[at])}, for"
            f" {len(torn)} vertices: give vertices at one place one value."
        )
    return low[wanted]
