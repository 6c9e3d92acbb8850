"""Checks of meshes that a caller hands over as arrays or as another library's object."""

import numpy as np

from ..errors import NotASolidError
from ..kernels import njit
from .faults import find_used, format_point

READ = "reebslice.inspect_surface(points, faces)"


def take_mesh(points, faces=None):
    """Turn what a caller hands over into the arrays of a surface.

    Parameters
    ----------
    points : (n, 3) array_like, mesh units
        Or, with `faces` left out, an object that has the arrays itself: a
        `trimesh.Trimesh` (``vertices``, ``faces``) or a `pyvista.PolyData` of
        triangles (``points``, ``regular_faces``).
    faces : (m, 3) array_like of int
        Triangles, counter-clockwise seen from outside the material.

    Returns
    -------
    points : (n, 3) float64
    faces : (m, 3) int32
        All ids exist, all coordinates in use are finite, and the signed volume
        is not negative. Whether the surface is closed is told by whoever
        matches its half-edges; :func:`explain_open` then says where it is not.

    Raises
    ------
    NotASolidError
        The arrays have other shapes or are empty, an id is out of range, a
        coordinate is not finite, or the faces point inward. The message says
        where, and the cure.
    """
    if faces is None:
        points, faces = _take_apart(points)
    points, faces = _as_rows("points", points, float), _as_rows("faces", faces, int)
    _check_ids(points, faces)
    points, faces = np.ascontiguousarray(points, np.float64), np.ascontiguousarray(faces, np.int32)
    _check_finite(points, faces)
    if _volume(points, faces) < 0:
        raise NotASolidError(
            "The faces point inward: the volume they enclose is negative. Reverse their corners, faces[:, ::-1],"
            f" or let {READ} turn them."
        )
    return points, faces


def _take_apart(mesh):
    """Points and faces of another library's mesh object."""
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    if hasattr(mesh, "points") and hasattr(mesh, "regular_faces"):
        if not mesh.is_all_triangles:
            raise NotASolidError("The PolyData has faces that are not triangles; call its triangulate() first.")
        return mesh.points, mesh.regular_faces
    raise NotASolidError(
        f"A {type(mesh).__name__} is given alone: give points (n, 3) and faces (m, 3), a trimesh.Trimesh, or a"
        " pyvista.PolyData."
    )


def _as_rows(name, values, kind):
    """The argument as an array of rows of three numbers of this kind."""
    try:
        rows = np.asarray(values)
    except ValueError:  # rows of unequal length
        raise NotASolidError(f"{name} has rows of unequal length; give an array of shape (n, 3).") from None
    if rows.ndim != 2 or rows.shape[1] != 3:
        also = "; cut polygons into triangles first" if name == "faces" else ""
        raise NotASolidError(f"{name} has the shape {rows.shape}; give an array of shape (n, 3){also}.")
    if not len(rows):
        raise NotASolidError(f"{name} is empty; a solid has at least four vertices and four faces.")
    if not np.issubdtype(rows.dtype, np.integer if kind is int else np.number) or np.iscomplexobj(rows):
        what = "whole numbers" if kind is int else "real numbers"
        raise NotASolidError(f"{name} holds values of type {rows.dtype}; give {what}.")
    return rows


def _check_ids(points, faces):
    """Raise NotASolidError where a face names a point that does not exist."""
    if faces.min() >= 0 and faces.max() < len(points):
        return
    face, corner = np.argwhere((faces < 0) | (faces >= len(points)))[0]
    raise NotASolidError(
        f"faces[{face}, {corner}] is {faces[face, corner]}, but points has the rows 0 to {len(points) - 1};"
        " ids count from 0."
    )


def _check_finite(points, faces):
    """Raise NotASolidError where a point that a face uses is not finite."""
    if np.isfinite(points).all():
        return
    used = find_used(len(points), faces)
    bad = used[~np.isfinite(points[used]).all(axis=1)]
    if len(bad):
        raise NotASolidError(
            f"{len(bad)} points have coordinates that are not finite, the first is points[{bad[0]}] ="
            f" {format_point(points[bad[0]])}; mend or remove them."
        )


def explain_open(points, faces):
    """Say where a surface is not closed and oriented, and what cures it.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int
        Of which some mesh edge does not lie in two faces of opposite directions.

    Returns
    -------
    NotASolidError
        To be raised by whoever found the surface open.
    """
    tails, heads = faces.ravel().astype(np.int64), np.roll(faces, -1, axis=1).ravel().astype(np.int64)
    along, back = tails * len(points) + heads, heads * len(points) + tails
    _, place, count = np.unique(along, return_inverse=True, return_counts=True)
    edge = np.flatnonzero((count[place] > 1) | ~np.isin(along, back))[0]
    where = " to ".join(f"points[{end}] = {format_point(points[end])}" for end in (tails[edge], heads[edge]))
    if len(np.unique(points, axis=0)) < len(points):
        return NotASolidError(
            f"The surface is open along the mesh edge from {where}, and some points coincide: corners are not"
            f" merged, as in an STL file. {READ} merges them."
        )
    return NotASolidError(
        f"The mesh edge from {where} does not lie in two faces that run along it in opposite directions: the surface"
        f" is open, branches, or is not oriented. {READ} repairs what it can and says what it cannot."
    )


@njit
def _volume(points, faces):
    """Six times the signed volume, about a point of the surface, so that one far from the origin is as exact."""
    x, y, z = points[faces[0, 0]]
    total = 0.0
    for a, b, c in faces:
        ax, ay, az = points[a, 0] - x, points[a, 1] - y, points[a, 2] - z
        bx, by, bz = points[b, 0] - x, points[b, 1] - y, points[b, 2] - z
        cx, cy, cz = points[c, 0] - x, points[c, 1] - y, points[c, 2] - z
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total
