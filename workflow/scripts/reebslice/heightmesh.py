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
    x, y, z = np.asarray(points, float).T
    return np.column_stack([a * x + b * y + c * z for a, b, c in np.asarray(rotation, float)])


def height_order(points):
    """Surface vertices (n,) in ascending order of (z, x, y, id)."""
    x, y, z = np.ascontiguousarray(points.T)
    order = np.argsort(z)
    same = z[order[1:]] == z[order[:-1]]
    if same.any():  # ties are few, but in flats: only these are compared any further
        tied = np.flatnonzero(np.append(same, False) | np.append(False, same))
        chosen = np.sort(order[tied])
        order[tied] = chosen[np.lexsort((y[chosen], x[chosen], z[chosen]))]
    return order.astype(np.int32)


def order_by_height(points, faces, rotation):
    """The :class:`HeightMesh` of a closed, edge-manifold, oriented surface.

    points : (n, 3) model frame; faces : (m, 3); rotation : (3, 3) to the
    tilted frame. Raises ValueError where an edge has no twin.
    """
    tilted = tilt_points(points, rotation)
    vertex = height_order(tilted)
    rank = np.empty(len(vertex), np.int32)
    rank[vertex] = np.arange(len(vertex), dtype=np.int32)
    faces = canonical_faces(rank[faces])
    return HeightMesh(tilted[vertex], faces, find_twins(faces, len(vertex)), vertex)


def canonical_faces(faces):
    """Faces with their smallest vertex first, in lexicographic order."""
    return _sort_faces(np.ascontiguousarray(faces, dtype=np.int32), int(faces.max(initial=-1)) + 1)


@njit(cache=True)
def _sort_faces(faces, n):
    """A counting sort by the first corner, then by insertion, as few faces share that."""
    m = faces.shape[0]
    start = np.zeros(n + 1, np.int64)
    for f in range(m):
        start[min(faces[f, 0], faces[f, 1], faces[f, 2]) + 1] += 1
    for v in range(n):
        start[v + 1] += start[v]
    fill, out = start[:-1].copy(), np.empty((m, 3), np.int32)
    for f in range(m):
        a, b, c = faces[f]
        if b < a and b < c:
            a, b, c = b, c, a
        elif c < a and c < b:
            a, b, c = c, a, b
        i = fill[a]
        fill[a] += 1
        while i > start[a] and (b < out[i - 1, 1] or (b == out[i - 1, 1] and c < out[i - 1, 2])):
            out[i] = out[i - 1]
            i -= 1
        out[i, 0], out[i, 1], out[i, 2] = a, b, c
    return out


def find_twins(faces, n_vertices):
    """The opposite half-edge of every half-edge, (3 m,) int32.

    Raises ValueError if some mesh edge does not lie in exactly two faces that
    run along it in opposite directions.
    """
    twins, bad = _match_half_edges(np.ascontiguousarray(faces, dtype=np.int32), n_vertices)
    if bad >= 0:
        face, corner = divmod(int(bad), 3)
        ends = faces[face, corner], faces[face, (corner + 1) % 3]
        raise ValueError(f"the surface is not closed and oriented at mesh edge {ends[0]}-{ends[1]}")
    return twins


@njit(cache=True)
def _match_half_edges(faces, n):
    m = faces.shape[0]
    start = np.zeros(n + 1, np.int64)
    for f in range(m):
        for k in range(3):
            start[min(faces[f, k], faces[f, (k + 1) % 3]) + 1] += 1
    for v in range(n):
        start[v + 1] += start[v]
    fill = start[:-1].copy()
    bucket = np.empty(3 * m, np.int32)
    for f in range(m):
        for k in range(3):
            low = min(faces[f, k], faces[f, (k + 1) % 3])
            bucket[fill[low]] = 3 * f + k
            fill[low] += 1
    twins = np.full(3 * m, -1, np.int32)
    for v in range(n):
        for i in range(start[v], start[v + 1]):
            h = bucket[i]
            if twins[h] >= 0:
                continue
            tail, head = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
            for j in range(i + 1, start[v + 1]):
                g = bucket[j]
                if faces[g // 3, g % 3] == head and faces[g // 3, (g % 3 + 1) % 3] == tail:
                    if twins[g] >= 0:
                        return twins, h
                    twins[h], twins[g] = g, h
                    break
            if twins[h] < 0:
                return twins, h
    return twins, -1


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
