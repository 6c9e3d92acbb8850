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
    return _rotate(np.ascontiguousarray(points, dtype=float), np.ascontiguousarray(rotation, dtype=float))


@njit(cache=True)
def _rotate(points, rotation):
    out = np.empty(points.shape)
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for r in range(3):
            out[i, r] = rotation[r, 0] * x + rotation[r, 1] * y + rotation[r, 2] * z
    return out


def height_order(points):
    """Surface vertices (n,) in ascending order of (z, x, y, id)."""
    z = np.ascontiguousarray(points[:, 2])
    order = np.argsort(z)
    tied = _order_few(order, np.ascontiguousarray(points))
    if len(tied):  # flats
        chosen = np.sort(order[tied])
        order[tied] = chosen[np.lexsort((points[chosen, 1], points[chosen, 0], z[chosen]))]
    return order.astype(np.int32)


@njit(cache=True)
def _order_few(order, points):
    """Put vertices in order where few tie in height, by insertion; returns the places in `order` where many do."""
    many, count, start = np.empty(len(order), np.int64), 0, 0
    for end in range(1, len(order) + 1):
        if end < len(order) and points[order[end], 2] == points[order[start], 2]:
            continue
        if end - start > 16:
            many[count : count + end - start] = np.arange(start, end)
            count += end - start
        else:
            for place in range(start + 1, end):
                v = order[place]
                while place > start and _comes_after(points, order[place - 1], v):
                    order[place] = order[place - 1]
                    place -= 1
                order[place] = v
        start = end
    return many[:count].copy()


@njit(cache=True, inline="always")
def _comes_after(points, v, w):
    """Whether v comes after w, of the same height."""
    if points[v, 0] != points[w, 0]:
        return points[v, 0] > points[w, 0]
    return points[v, 1] > points[w, 1] or (points[v, 1] == points[w, 1] and v > w)


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


def canonical_faces(faces, rank):
    """Faces (m, 3) in terms of ranks, the smallest first, in lexicographic order: (m, 3) int32.

    rank : (n,) int32 of every vertex. No two faces may share a corner and
    the one after it, as none of an oriented edge-manifold do.
    """
    return _sort_faces(np.ascontiguousarray(faces, dtype=np.int32), np.ascontiguousarray(rank, dtype=np.int32))


@njit(cache=True)
def _sort_faces(faces, rank):
    turned = np.empty(faces.shape, np.int32)
    for f in range(len(faces)):
        a, b, c = rank[faces[f, 0]], rank[faces[f, 1]], rank[faces[f, 2]]
        if b < a and b < c:
            a, b, c = b, c, a
        elif c < a and c < b:
            a, b, c = c, a, b
        turned[f, 0], turned[f, 1], turned[f, 2] = a, b, c
    return sort_faces(turned, len(rank))


@njit(cache=True)
def sort_faces(faces, n):
    """Faces (m, 3) int32 of n vertices in lexicographic order, no two with the same first and second corner.

    A counting sort by the first corner, then a sort of the few faces that share it.
    """
    start, out = np.zeros(n + 1, np.int32), np.empty(faces.shape, np.int32)
    for f in range(len(faces)):
        start[faces[f, 0] + 1] += 1
    for v in range(n):
        start[v + 1] += start[v]
    for f in range(len(faces)):
        place = start[faces[f, 0]]
        start[faces[f, 0]] += 1
        out[place, 0], out[place, 1], out[place, 2] = faces[f, 0], faces[f, 1], faces[f, 2]
    first = 0
    for v in range(n):
        _sort_fan(out, first, start[v])
        first = start[v]
    return out


@njit(cache=True)
def _sort_fan(faces, first, end):
    """Shell's sort of the faces from `first` up to `end` by their second corner: far from quadratic in a large fan."""
    gap = end - first
    while gap > 1:
        gap = max(gap * 5 // 11, 1)
        for f in range(first + gap, end):
            b, c, place = faces[f, 1], faces[f, 2], f
            while place >= first + gap and faces[place - gap, 1] > b:
                faces[place, 1], faces[place, 2] = faces[place - gap, 1], faces[place - gap, 2]
                place -= gap
            faces[place, 1], faces[place, 2] = b, c


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
    """Twins, and a half-edge that has none or more than one; -1 if all have one.

    The half-edges with one lower end are chained, and each is met once by its twin.
    """
    m, ends = faces.shape[0], faces.ravel()
    newest, older = np.full(n, -1, np.int32), np.empty(3 * m, np.int32)
    for f in range(m):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        for k, low in ((0, min(a, b)), (1, min(b, c)), (2, min(c, a))):
            older[3 * f + k] = newest[low]
            newest[low] = 3 * f + k
    twins = np.empty(3 * m, np.int32)
    met = np.full((n, 2), -1, np.int32)  # per upper end: the lower end last seen, the half-edge between, -1 if matched
    for v in range(n):
        h, single = newest[v], 0
        while h >= 0:
            tail = ends[h]
            upper = ends[h - 2 if h % 3 == 2 else h + 1] if tail == v else tail
            g = met[upper, 1]
            if met[upper, 0] != v:
                met[upper, 0], met[upper, 1] = v, h
                single += 1
            elif g < 0 or ends[g] == tail:
                return twins, h
            else:
                twins[g], twins[h], met[upper, 1] = h, g, -1
                single -= 1
            h = older[h]
        if single > 0:
            return twins, _first_single(ends, newest[v], older, met, v)
    return twins, -1


@njit(cache=True)
def _first_single(ends, h, older, met, v):
    """A half-edge of the chain from h whose twin was not met."""
    while met[ends[h - 2 if h % 3 == 2 else h + 1] if ends[h] == v else ends[h], 1] != h:
        h = older[h]
    return h


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
