"""Checks of meshes that a caller hands over as arrays or as another library's object."""

from numbers import Real

import numpy as np

from ..errors import NotASolidError, ReebsliceError
from ..kernels import njit
from .faults import find_used, format_point

LEAST = float(np.nextafter(0, 1))  # the bound of what must be more than 0
MEND = "reebslice.inspect_surface(points, faces)"


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
    points, faces = take_arrays(points, faces)
    if faces.min() < 0 or faces.max() >= len(points):
        face, corner = np.argwhere((faces < 0) | (faces >= len(points)))[0]
        raise NotASolidError(
            f"faces[{face}, {corner}] is {faces[face, corner]}, but points has the rows 0 to {len(points) - 1};"
            " ids count from 0."
        )
    points, faces = np.ascontiguousarray(points, np.float64), np.ascontiguousarray(faces, np.int32)
    volume = _sum_volume(points, faces)
    if not np.isfinite(volume):
        used = find_used(len(points), faces)
        bad = used[~np.isfinite(points[used]).all(axis=1)]
        if len(bad):
            raise NotASolidError(
                f"{len(bad)} points have coordinates that are not finite, the first is points[{bad[0]}] ="
                f" {format_point(points[bad[0]])}; mend or remove them."
            )
    if volume < 0:
        raise NotASolidError(
            "The faces point inward: the volume they enclose is negative. Reverse their corners, faces[:, ::-1],"
            f" or let {MEND} turn them."
        )
    return points, faces


def take_arrays(points, faces=None, least=1):
    """Take points and faces as arrays of rows of three, whatever holds them; what they say is not looked at.

    Parameters
    ----------
    points, faces
        As for :func:`take_mesh`.
    least : int
        Number of rows that there must be.

    Returns
    -------
    points : (n, 3) array of numbers
    faces : (m, 3) array of int

    Raises
    ------
    NotASolidError
        The arrays have other shapes or types, or fewer rows.
    """
    if faces is None:
        points, faces = _take_apart(points)
    points = _as_rows("points", points, np.number, "real numbers", least)
    return points, _as_rows("faces", faces, np.integer, "whole numbers", least)


def take_rotation(rotation):
    """Take a rotation as a matrix.

    Parameters
    ----------
    rotation : (3, 3) array_like or None
        From the model frame to the tilted frame; None for no rotation.

    Returns
    -------
    (3, 3) float64

    Raises
    ------
    ReebsliceError
        It has another shape, is not finite, or is no rotation: its rows are not
        orthonormal to 1e-6, or it mirrors.
    """
    if rotation is None:
        return np.eye(3)
    try:
        matrix = np.array(rotation, float)
    except (TypeError, ValueError):
        raise ReebsliceError(f"rotation is a {type(rotation).__name__}: give a matrix of shape (3, 3).") from None
    if matrix.shape != (3, 3):
        raise ReebsliceError(f"rotation has the shape {matrix.shape}: give a matrix of shape (3, 3).")
    if not np.abs(matrix @ matrix.T - np.eye(3)).max() <= 1e-6 or np.linalg.det(matrix) < 0:
        raise ReebsliceError(
            f"rotation {matrix.tolist()} is no rotation: its rows must be of length one, at right angles to each other,"
            " and must not mirror."
        )
    return matrix


def take_bodies(body_of_vertex, count):
    """Take the bodies of vertices as an array.

    Parameters
    ----------
    body_of_vertex : (n,) array_like of int, or None
        None if all are one body.
    count : int
        Number n of vertices.

    Returns
    -------
    (n,) int32

    Raises
    ------
    ReebsliceError
        It has another length, or holds other values than ids of 0 or more.
    """
    if body_of_vertex is None:
        return np.zeros(count, np.int32)
    body = np.asarray(body_of_vertex)
    if body.shape != (count,) or not np.issubdtype(body.dtype, np.integer):
        raise ReebsliceError(
            f"body_of_vertex has the shape {body.shape} and the type {body.dtype}: give one whole number for each of"
            f" the {count} vertices."
        )
    if body.min() < 0 or body.max() > np.iinfo(np.int32).max:
        raise ReebsliceError(f"body_of_vertex runs from {body.min()} to {body.max()}: give ids of 0 or more.")
    return body.astype(np.int32)


def take_number(value, name, low, high=np.inf):
    """Take a finite real number from `low` to `high`.

    Parameters
    ----------
    value, name : object and str
    low, high : float
        `LEAST` stands for more than 0.

    Returns
    -------
    float

    Raises
    ------
    ReebsliceError
        It is no number, or out of bounds.
    """
    if not isinstance(value, Real) or not low <= value <= high or value == np.inf:
        bounds = "more than 0" if low == LEAST else f"at least {low:g}"
        bounds += f" and at most {high:g}" if high < np.inf else ""
        raise ReebsliceError(f"{name} is {value!r}: it must be a number, {bounds}.")
    return float(value)


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


def _as_rows(name, values, kind, what, least):
    """The argument as an array of rows of three numbers of this kind."""
    try:
        rows = np.asarray(values)
    except ValueError:  # rows of unequal length
        raise NotASolidError(f"{name} has rows of unequal length; give an array of shape (n, 3).") from None
    if rows.ndim != 2 or rows.shape[1] != 3:
        also = "; cut polygons into triangles first" if name == "faces" else ""
        raise NotASolidError(f"{name} has the shape {rows.shape}; give an array of shape (n, 3){also}.")
    if len(rows) < least:
        raise NotASolidError(f"{name} is empty; a solid has at least four vertices and four faces.")
    if not np.issubdtype(rows.dtype, kind) or np.iscomplexobj(rows):
        raise NotASolidError(f"{name} holds values of type {rows.dtype}; give {what}.")
    return rows


@njit
def _sum_volume(points, faces):
    """Six times the signed volume, about a point of the surface, so that one far from the origin is as exact."""
    x, y, z = points[faces[0, 0]]
    total = 0.0
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = points[a, 0] - x, points[a, 1] - y, points[a, 2] - z
        bx, by, bz = points[b, 0] - x, points[b, 1] - y, points[b, 2] - z
        cx, cy, cz = points[c, 0] - x, points[c, 1] - y, points[c, 2] - z
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total


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
    corners = points[find_used(len(points), faces)]
    if len(np.unique(corners, axis=0)) < len(corners):
        return NotASolidError(
            f"The surface is open along the mesh edge from {where}, and some points coincide: corners are not"
            f" merged, as in an STL file. {MEND} merges them."
        )
    return NotASolidError(
        f"The mesh edge from {where} does not lie in two faces that run along it in opposite directions: the surface"
        f" is open, branches, or is not oriented. {MEND} repairs what it can and says what it cannot."
    )


def check_fans(points, faces, twins):
    """Raise NotASolidError where the faces around a vertex are more than one fan.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int32
        Of a closed surface; every point is in some face.
    twins : (3 m,) int32
        The opposite half-edge of every half-edge.
    """
    vertex = _find_pinch(faces.ravel(), twins, len(points))
    if vertex >= 0:
        raise NotASolidError(
            f"Sheets touch in the vertex at {format_point(points[vertex])}: the faces around it are more than one fan."
            f" {MEND} takes them apart."
        )


@njit
def _find_pinch(corners, twins, n):
    """A vertex with more than one fan, -1 if none: one fan is walked of each; where none is, these have all corners."""
    length = np.zeros(n, np.int32)
    total = 0
    for h in range(len(corners)):
        v = corners[h]
        if length[v] == 0:
            g = h
            while True:
                length[v] += 1
                g = twins[g - 1 + 3 * (g % 3 == 0)]  # leaves the vertex in the next face around it
                if g == h:
                    break
            total += length[v]
    if total < len(corners):
        for h in range(len(corners)):
            length[corners[h]] -= 1
        for v in range(n):
            if length[v] < 0:
                return v
    return -1
