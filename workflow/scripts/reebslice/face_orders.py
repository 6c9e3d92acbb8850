"""Faces in order of their vertices, whichever order a file has them in."""

import numpy as np
from numba import njit


def order_corners(faces, n_vertices):
    """Return (m, 3) corners that put faces and their corners in canonical order.

    `faces.ravel()[corners]` are the same faces, each beginning at its smallest
    id, in lexicographic order of the *unordered* triples: turning faces over
    does not change their order, and faces with the same corners are neighbours;
    of those, the ones that run 0, 1, 2 come before the ones that run 0, 2, 1.
    """
    first, *keys = _sort_corners(np.ascontiguousarray(faces, np.int32))
    return _turn_corners(_order_triples(*keys, n_vertices), first)


@njit(cache=True)
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


@njit(cache=True)
def _order_triples(a, b, c, bound):
    """Argsort, stable and lexicographic, of triples: by counting on `a`, below `bound`, then of the few with it."""
    start, order = np.zeros(bound + 1, np.int32), np.empty(len(a), np.int32)
    for number in a:
        start[number + 1] += 1
    for number in range(bound):
        start[number + 1] += start[number]
    for i in range(len(a)):
        order[start[a[i]]] = i
        start[a[i]] += 1
    begin = 0
    for number in range(bound):
        _sort_few(order, begin, start[number], b, c)
        begin = start[number]
    return order


@njit(cache=True)
def _sort_few(order, begin, end, b, c):
    """Shell's sort of order[begin:end] by (b, c, itself): far from quadratic where they are many."""
    gap = end - begin
    while gap > 1:
        gap = max(gap * 5 // 11, 1)
        for place in range(begin + gap, end):
            i = order[place]
            while place >= begin + gap and _comes_after(order[place - gap], i, b, c):
                order[place] = order[place - gap]
                place -= gap
            order[place] = i


@njit(cache=True, inline="always")
def _comes_after(i, j, b, c):
    if b[i] != b[j]:
        return b[i] > b[j]
    return c[i] > c[j] or (c[i] == c[j] and i > j)


@njit(cache=True)
def _turn_corners(rows, first):
    """The corners (m, 3) int32 of the faces `rows`, beginning at their corners `first`."""
    corners = np.empty((len(rows), 3), np.int32)
    for i in range(len(rows)):
        k = np.int64(first[rows[i]])
        for step in range(3):
            corners[i, step] = 3 * rows[i] + (k + step) % 3
    return corners


def sort_stably(*keys):
    """Argsort by whole numbers, the most significant last as `np.lexsort` has it; linear in time.

    keys : pairs of an array (m,) int64 and a bound that its numbers, none negative, stay below.
    """
    order = np.arange(len(keys[0][0]))
    for numbers, bound in keys:
        order = _sort_by(numbers, order, bound)
    return order


@njit(cache=True)
def _sort_by(numbers, order, bound):
    """Put `order` in order of numbers[order], by counting, equal ones left as they are."""
    fill = np.zeros(bound + 1, np.int64)
    for number in numbers:
        fill[number + 1] += 1
    for number in range(bound):
        fill[number + 1] += fill[number]
    out = np.empty_like(order)
    for i in order:
        out[fill[numbers[i]]] = i
        fill[numbers[i]] += 1
    return out
