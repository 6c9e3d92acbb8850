"""What makes the numbers of a mesh unusable, before any geometry."""

import numpy as np
from numba import njit

# Beyond these, areas multiplied by areas leave the range of float64.
LARGEST, SMALLEST = 1e75, 1e-75


def find_fault(points, faces):
    """Return what makes (n, 3) points and (m, 3) faces unusable as numbers, or None."""
    if not len(faces):
        return "The file holds no faces: it is empty or damaged; export the mesh again."
    ids = faces if faces.dtype == np.int32 else np.clip(faces, -1, len(points)).astype(np.int32)
    fault, low, high = _survey(np.ascontiguousarray(points, np.float64), np.ascontiguousarray(ids))
    if fault == STRAY:
        strays = np.argwhere((faces < 0) | (faces >= len(points)))
        face, corner = strays[0]
        return (
            f"{len(strays)} face corners name a vertex that does not exist, the first is vertex"
            f" {faces[face, corner]} of {len(points)} in face {face}; the file is damaged:"
            " export the mesh again."
        )
    if fault == UNBOUNDED:
        used = find_used(len(points), faces)
        corners = points[used]
        bad = np.flatnonzero(~np.isfinite(corners).all(axis=1))
        return (
            f"{len(bad)} vertices have coordinates that are not finite numbers, the first is"
            f" vertex {used[bad[0]]} at {format_point(corners[bad[0]])}; mend or remove them in the"
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


STRAY, UNBOUNDED = 1, 2


@njit(cache=True)
def _survey(points, faces):
    """Whether a corner names no vertex, or a used one is not finite; and the box (3,), (3,) of the used ones."""
    low, high, finite = np.full(3, np.inf), np.full(3, -np.inf), True
    for f in range(len(faces)):
        for k in range(3):
            v = faces[f, k]
            if v < 0 or v >= len(points):
                return STRAY, low, high
            for axis in range(3):
                x = points[v, axis]
                finite &= np.isfinite(x)
                low[axis], high[axis] = min(low[axis], x), max(high[axis], x)
    return 0 if finite else UNBOUNDED, low, high


def find_used(n_points, faces):
    """Return, ascending, the ids of the points that occur in faces."""
    used = np.zeros(n_points, bool)
    used[faces] = True
    return np.flatnonzero(used)


def format_point(point):
    """Return a point as text, in the fewest digits that give the same numbers when they are read.

    >>> format_point([4785273.25, 0.1, 2.0])
    '(4785273.25, 0.1, 2)'
    """
    return "({})".format(", ".join(repr(float(x)).removesuffix(".0") for x in point))
