"""What makes the numbers of a mesh unusable, before any geometry."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..kernels import njit

# Beyond these, areas multiplied by areas leave the range of float64.
LARGEST, SMALLEST = 1e75, 1e-75
STRAY, UNBOUNDED = 1, 2


class Names(NamedTuple):
    """How a file counts what it holds.

    Attributes
    ----------
    first : number of its first vertex.
    vertex, face : the name of the vertex, or face, of an id (counted from 0) such as "vertex 8 (line 12)".
    """

    first: int
    vertex: Callable[[int], str]
    face: Callable[[int], str]


COUNTED_FROM_0 = Names(0, "vertex {}".format, "face {}".format)


def find_fault(points, faces, names=COUNTED_FROM_0, sizes=None):
    """Find what makes points and faces unusable as numbers.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int, or the corners (c,) of polygons, one after another.
    names : Names, how the file counts.
    sizes : (k,) int, corners of each polygon; by default all faces are triangles.

    Returns
    -------
    str or None
        A sentence with the cure: there are no faces, an id does not exist, a
        coordinate in use is not finite, coordinates are too large or too small.
    """
    if not len(faces):
        return "The file holds no faces: it is empty or damaged; export the mesh again."
    ids = faces if faces.dtype == np.int32 else np.clip(faces, -1, len(points)).astype(np.int32)
    fault, low, high = _survey(np.ascontiguousarray(points, np.float64), np.ascontiguousarray(ids).ravel())
    if fault == STRAY:
        return _describe_strays(len(points), faces.ravel(), names, sizes)
    if fault == UNBOUNDED:
        used = find_used(len(points), faces)
        corners = points[used]
        bad = np.flatnonzero(~np.isfinite(corners).all(axis=1))
        return (
            f"{len(bad)} vertices have coordinates that are not finite numbers, the first is"
            f" {names.vertex(used[bad[0]])} at {format_point(corners[bad[0]])}; mend or remove them in the"
            " program that wrote the file."
        )
    reach, extent = max(-low.min(), high.max()), (high - low).max()
    if reach > LARGEST or extent < SMALLEST:
        return (
            f"Coordinates reach {reach:.3g} over an extent of {extent:.3g}, where areas and"
            f" volumes leave the range of numbers, the first vertex is at {format_point(points[faces.min()])};"
            " scale the mesh to an ordinary size."
        )
    return None


def _describe_strays(n_points, corners, names, sizes):
    strays = np.flatnonzero((corners < 0) | (corners >= n_points))
    first = strays[0]
    face = first // 3 if sizes is None else np.searchsorted(np.cumsum(sizes), first, "right")
    return (
        f"{len(strays)} face corners name a vertex that does not exist, the first is in {names.face(face)}: vertex"
        f" {corners[first] + names.first}, but there are {n_points} vertices, counted from {names.first}; the file is"
        " damaged, export the mesh again."
    )


@njit
def _survey(points, corners):
    """Whether a corner names no vertex, or a used one is not finite; and the box (3,), (3,) of the used ones."""
    low, high, finite = np.full(3, np.inf), np.full(3, -np.inf), True
    for v in corners:
        if v < 0 or v >= len(points):
            return STRAY, low, high
        for axis in range(3):
            x = points[v, axis]
            finite &= np.isfinite(x)
            low[axis], high[axis] = min(low[axis], x), max(high[axis], x)
    return 0 if finite else UNBOUNDED, low, high


def find_used(n_points, faces):
    """Return, ascending, the ids of the points that occur in faces."""
    return np.flatnonzero(_mark_used(n_points, np.ascontiguousarray(faces)))


@njit
def _mark_used(n_points, faces):
    """Whether each point occurs in faces, (n,) bool."""
    used = np.zeros(n_points, np.bool_)
    for v in faces.ravel():
        used[v] = True
    return used


def format_point(point):
    """Return a point as text, in the fewest digits that give the same numbers when they are read.

    >>> format_point([4785273.25, 0.1, 2.0])
    '(4785273.25, 0.1, 2)'
    """
    return "({})".format(", ".join(repr(float(x)).removesuffix(".0") for x in point))
