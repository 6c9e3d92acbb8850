"""Canonical orders of vertices by height, of faces and of their corners."""

import numpy as np

from ..arrays.sorting import find_starts, sort_by_counting
from ..kernels import njit


def height_order(points):
    """Sort vertices by height, ties by the two other coordinates and then by id: simulation of simplicity.

    Parameters
    ----------
    points : (n, 3) float64
        Without -0.0 and NaN.

    Returns
    -------
    (n,) int32
        Vertices in ascending order of (z, x, y, id).
    """
    z = np.ascontiguousarray(points[:, 2])
    order = np.argsort(z)
    tied = _order_few(order, np.ascontiguousarray(points))
    if len(tied):  # flats
        chosen = np.sort(order[tied])
        order[tied] = chosen[np.lexsort((points[chosen, 1], points[chosen, 0], z[chosen]))]
    return order.astype(np.int32)


def order_copies(order, keys, faces):
    """Put vertices that tie in all keys in order: maxima first, minima last, else by id.

    Where sheets meet in a point that is the top of one and the bottom of the
    other, the one ends before the other begins, as if they were pulled apart.

    Parameters
    ----------
    order : (n,) int32
        Vertices in ascending order of their keys; those that tie, of id.
    keys : (n, k) float64
        Of every vertex, without -0.0 and NaN.
    faces : (m, 3) int
        By these and `order` a vertex is a maximum or a minimum; corners of one may tie, as a rotation may round
        neighbours to one position.

    Returns
    -------
    (n,) int32
    """
    tie = _find_ties(order, np.ascontiguousarray(keys))
    if len(tie) == 0:
        return order
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    ranks = rank[faces]
    rises, falls = (np.zeros(len(order), bool) for _ in range(2))  # whether a mesh edge goes up, or down, from each
    rises[faces[ranks < ranks.max(axis=1, keepdims=True)]] = True
    falls[faces[ranks > ranks.min(axis=1, keepdims=True)]] = True
    places = np.union1d(tie, tie + 1)
    chosen, group = order[places], np.isin(places, tie + 1, invert=True).cumsum()
    out = order.copy()
    out[places] = chosen[np.lexsort((rises[chosen].astype(int) - falls[chosen], group))]
    return out


@njit
def _find_ties(order, keys):
    """The places in `order` of the vertices that tie in all keys with the one after them."""
    ties, count = np.empty(len(order), np.int64), 0
    for place in range(len(order) - 1):
        v, w, k = order[place], order[place + 1], keys.shape[1] - 1
        while k >= 0 and keys[v, k] == keys[w, k]:
            k -= 1
        if k < 0:
            ties[count] = place
            count += 1
    return ties[:count].copy()


@njit
def _order_few(order, points):
    """Put vertices in order where few tie in height, by insertion; returns the places in `order` where many do."""
    many, count, start = np.empty(len(order), np.int64), 0, 0
    for end in range(1, len(order) + 1):
        if end < len(order) and points[order[end], 2] == points[order[start], 2]:
            continue
        if end - start > 16:
            for place in range(start, end):
                many[count] = place
                count += 1
        else:
            for place in range(start + 1, end):
                v = order[place]
                while place > start and _vertex_comes_after(points, order[place - 1], v):
                    order[place] = order[place - 1]
                    place -= 1
                order[place] = v
        start = end
    return many[:count].copy()


@njit(inline="always")
def _vertex_comes_after(points, v, w):
    """Whether v comes after w, of the same height."""
    if points[v, 0] != points[w, 0]:
        return points[v, 0] > points[w, 0]
    return points[v, 1] > points[w, 1] or (points[v, 1] == points[w, 1] and v > w)


def canonical_faces(faces, rank):
    """Write faces in ranks, each from its smallest on, and sort them.

    Parameters
    ----------
    faces : (m, 3) int
        No two share a corner and the one after it, as none of an oriented
        edge-manifold do.
    rank : (n,) int
        The rank of every vertex.

    Returns
    -------
    (m, 3) int32
        In lexicographic order; the windings are kept.
    """
    return _sort_faces(np.ascontiguousarray(faces, dtype=np.int32), np.ascontiguousarray(rank, dtype=np.int32))


@njit
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


@njit
def sort_faces(faces, n):
    """Sort faces lexicographically: by counting on the first corner, then the few faces that share it.

    Parameters
    ----------
    faces : (m, 3) int32
        No two with the same first and second corner.
    n : int
        Bound of the ids.

    Returns
    -------
    (m, 3) int32
    """
    ends, out, first = find_starts(faces[:, 0], n), np.empty(faces.shape, np.int32), 0
    for f in range(len(faces)):
        place = ends[faces[f, 0]]
        ends[faces[f, 0]] += 1
        out[place, 0], out[place, 1], out[place, 2] = faces[f, 0], faces[f, 1], faces[f, 2]
    for v in range(n):
        _sort_fan(out, first, ends[v])
        first = ends[v]
    return out


@njit(inner=True)
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


def order_corners(faces, n_vertices):
    """Find the corners that put faces and their corners in canonical order.

    Parameters
    ----------
    faces : (m, 3) int
        Each with three different corners, below `n_vertices`.
    n_vertices : int

    Returns
    -------
    (m, 3) int32
        `faces.ravel()[corners]` are the same faces, each beginning at its
        smallest id, in lexicographic order of the *unordered* triples: turning
        faces over does not change their order, and faces with the same corners
        are neighbours; of those, the ones that run 0, 1, 2 come before the ones
        that run 0, 2, 1.
    """
    first, *keys = _sort_corners(np.ascontiguousarray(faces, np.int32))
    return _turn_corners(_order_triples(*keys, n_vertices), first)


@njit
def _sort_corners(faces):
    """Of each face the corner of its smallest id; its ids, ascending, the last doubled, plus 1 if it runs 0, 2, 1."""
    m = len(faces)
    first, low, middle, high = np.empty(m, np.int8), np.empty(m, np.int32), np.empty(m, np.int32), np.empty(m, np.int32)
    for f in range(m):
        k = 1 if faces[f, 1] < faces[f, 0] else 0
        k = 2 if faces[f, 2] < faces[f, k] else k
        second, third = faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
        first[f], low[f], middle[f] = k, faces[f, k], min(second, third)
        high[f] = 2 * max(second, third) + (second > third)
    return first, low, middle, high


@njit
def _order_triples(a, b, c, bound):
    """Argsort, stable and lexicographic, of triples: by counting on `a`, below `bound`, then of the few with it."""
    order, ends = sort_by_counting(a, np.arange(len(a), dtype=np.int32), bound)
    begin = 0
    for number in range(bound):
        _sort_few(order, begin, ends[number], b, c)
        begin = ends[number]
    return order


@njit(inner=True)
def _sort_few(order, begin, end, b, c):
    """Shell's sort of order[begin:end] by (b, c, itself): far from quadratic where they are many."""
    gap = end - begin
    while gap > 1:
        gap = max(gap * 5 // 11, 1)
        for place in range(begin + gap, end):
            i = order[place]
            while place >= begin + gap and _corner_comes_after(order[place - gap], i, b, c):
                order[place] = order[place - gap]
                place -= gap
            order[place] = i


@njit(inline="always")
def _corner_comes_after(i, j, b, c):
    if b[i] != b[j]:
        return b[i] > b[j]
    return c[i] > c[j] or (c[i] == c[j] and i > j)


@njit
def _turn_corners(rows, first):
    """The corners (m, 3) int32 of the faces `rows`, beginning at their corners `first`."""
    corners = np.empty((len(rows), 3), np.int32)
    for i in range(len(rows)):
        k = np.int64(first[rows[i]])
        for step in range(3):
            corners[i, step] = 3 * rows[i] + (k + step) % 3
    return corners
