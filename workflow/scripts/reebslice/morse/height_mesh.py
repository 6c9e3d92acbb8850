"""The surface in the tilted frame, its vertices in order of height.

Everything combinatorial is decided here, once, on ranks: a vertex is above
another iff its rank is larger. Ties of height are broken by the two other
coordinates of the tilted frame and then by the vertex id, which is an
infinitesimal tilt (simulation of simplicity; Edelsbrunner and Muecke 1990,
doi:10.1145/77635.77639). A flat face is monotone in that order, so it makes
no critical points of its own.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..mesh.half_edges import find_twins
from ..mesh.orders import canonical_faces, height_order


class HeightMesh(NamedTuple):
    """A closed oriented surface whose vertex ids are ranks of height.

    points : (n, 3) float64, tilted frame, in ascending order of (z, x, y, id)
    faces : (m, 3) int32 ranks, counter-clockwise seen from outside, in an
        order that does not depend on the input's
    twins : (3 m,) int32; half-edge 3 f + k runs from faces[f, k] to
        faces[f, (k + 1) % 3], its twin runs back along the same mesh edge
    vertex : (n,) int32, the surface vertex that each rank stands for
    """

    points: np.ndarray
    faces: np.ndarray
    twins: np.ndarray
    vertex: np.ndarray


def tilt_points(points, rotation):
    """Rotate (n, 3) points by a (3, 3) matrix, row by row of the matrix.

    Computed element by element: a matrix product may round a row differently
    depending on its place in the array, and ranks must not depend on that.
    """
    return _rotate(np.ascontiguousarray(points, dtype=float), np.ascontiguousarray(rotation, dtype=float))


@njit(cache=True)
def _rotate(points, rotation):
    out = np.empty(points.shape)
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for r in range(3):
            out[i, r] = rotation[r, 0] * x + rotation[r, 1] * y + rotation[r, 2] * z
    return out


def order_by_height(points, faces, rotation):
    """The :class:`HeightMesh` of a closed, edge-manifold, oriented surface.

    points : (n, 3) model frame; faces : (m, 3); rotation : (3, 3) to the
    tilted frame. Raises ValueError where an edge has no twin.
    """
    tilted = tilt_points(points, rotation)
    vertex = height_order(tilted)
    rank = np.empty(len(vertex), np.int32)
    rank[vertex] = np.arange(len(vertex), dtype=np.int32)
    faces = canonical_faces(faces, rank)
    return HeightMesh(_pick_rows(tilted, vertex), faces, find_twins(faces, len(vertex)), vertex)


@njit(cache=True)
def _pick_rows(points, chosen):
    """points[chosen], several times as fast for rows of three."""
    out = np.empty((len(chosen), 3))
    for i in range(len(chosen)):
        for k in range(3):
            out[i, k] = points[chosen[i], k]
    return out


@njit(cache=True, inline="always")
def next_half_edge(faces, twins, h, cut):
    """The upward half-edge at which the contour through the upward half-edge h crosses next.

    The level is given by ranks: those from `cut` on are above it.
    """
    down = twins[h]
    face, corner = down // 3, down % 3
    return 3 * face + ((corner + 1) % 3 if faces[face, (corner + 2) % 3] >= cut else (corner + 2) % 3)


@njit(cache=True, inline="always")
def cross_at(low, high, z, x, y):
    """Where the mesh edge from `low` up to `high` meets the plane, as (x, y).

    The plane is z, tilted infinitesimally so that it passes through (x, y):
    of two ends at exactly the height z, the one with the smaller (x, y) is
    below. Positions only; which edges cross is decided on ranks.
    """
    if low[2] < high[2]:
        t = (z - low[2]) / (high[2] - low[2])
    elif low[0] < high[0]:
        t = (x - low[0]) / (high[0] - low[0])
    elif low[1] < high[1]:
        t = (y - low[1]) / (high[1] - low[1])
    else:
        t = 0.5
    t = min(max(t, 0.0), 1.0)
    return low[0] + t * (high[0] - low[0]), low[1] + t * (high[1] - low[1])
