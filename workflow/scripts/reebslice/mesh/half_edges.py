"""Half-edges of triangles: half-edge h of face h // 3 runs from its corner h % 3 to the next."""

import numpy as np
from numba import njit

from ..arrays.sorting import sort_stably


def find_twins(faces, n_vertices):
    """The opposite half-edge of every half-edge, (3 m,) int32.

    Raises ValueError if some mesh edge does not lie in exactly two faces that
    run along it in opposite directions.
    """
    twins, bad = _find_twins(np.ascontiguousarray(faces, dtype=np.int32), n_vertices)
    if bad >= 0:
        face, corner = divmod(int(bad), 3)
        ends = faces[face, corner], faces[face, (corner + 1) % 3]
        raise ValueError(f"the surface is not closed and oriented at mesh edge {ends[0]}-{ends[1]}")
    return twins


@njit(cache=True)
def _find_twins(faces, n):
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


def group_half_edges(faces, n_vertices):
    """Group the half-edges by mesh edge.

    Returns `order`, (3m,) half-edges sorted by mesh edge, and `starts`, the
    (e + 1,) offsets in it at which the mesh edges begin and end.
    """
    low, high = _find_ends(np.ascontiguousarray(faces, np.int64))
    order = sort_stably((high, n_vertices), (low, n_vertices))
    return order, _find_starts(low, high, order)


@njit(cache=True)
def _find_ends(faces):
    """The smaller and the larger id on each half-edge, two (3m,)."""
    low, high = np.empty(3 * len(faces), np.int64), np.empty(3 * len(faces), np.int64)
    for h in range(len(low)):
        one, two = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        low[h], high[h] = min(one, two), max(one, two)
    return low, high


@njit(cache=True)
def _find_starts(low, high, order):
    starts, count = np.zeros(len(order) + 1, np.int64), 0
    for i in range(1, len(order) + 1):
        if i == len(order) or low[order[i]] != low[order[i - 1]] or high[order[i]] != high[order[i - 1]]:
            count += 1
            starts[count] = i
    return starts[: count + 1].copy()


def pair_half_edges(order):
    """Return (3m,) int32 the other half-edge of each one, of half-edges (3m,) in pairs."""
    opposite = np.empty(len(order), np.int32)
    opposite[order[0::2]] = order[1::2]
    opposite[order[1::2]] = order[0::2]
    return opposite


def match_half_edges(faces, n_vertices):
    """Return (3m,) int32 the other half-edge of each half-edge's mesh edge, or None if not all have two faces."""
    opposite, complete = _match_half_edges(np.ascontiguousarray(faces, np.int32).ravel(), n_vertices)
    return opposite if complete else None


@njit(cache=True)
def _match_half_edges(tails, n):
    """The half-edges with one lower end are chained, and each looks for another one with its upper end."""
    newest, older = np.full(n, -1, np.int32), np.empty(len(tails), np.int32)
    for h in range(len(tails)):
        low = min(tails[h], tails[_ahead(h)])
        older[h], newest[low] = newest[low], h
    opposite = np.empty(len(tails), np.int32)
    met = np.full((n, 2), -1, np.int32)  # per upper end: the lower end last seen, the half-edge between, -1 if matched
    for v in range(n):
        h, single = newest[v], 0
        while h >= 0:
            upper = max(tails[h], tails[_ahead(h)])
            g = met[upper, 1]
            if met[upper, 0] != v:
                met[upper, 0], met[upper, 1] = v, h
                single += 1
            elif g < 0:
                return opposite, False
            else:
                opposite[g], opposite[h], met[upper, 1] = h, g, -1
                single -= 1
            h = older[h]
        if single > 0:
            return opposite, False
    return opposite, True


@njit(cache=True, inline="always")
def _ahead(h):
    """The next half-edge of the same face."""
    return h + 1 - 3 * (h % 3 == 2)


@njit(cache=True, inline="always")
def ahead(h):
    """The next half-edge of the same face, without a branch that would be foretold wrongly every third time."""
    return h + 1 - 3 * (h % 3 == 2)


@njit(cache=True, inline="always")
def behind(h):
    """The half-edge before, of the same face."""
    return h - 1 + 3 * (h % 3 == 0)


@njit(cache=True, inline="always")
def head_of(corners, h):
    return corners[ahead(h)]


@njit(cache=True, inline="always")
def turn_around(twins, h):
    """The half-edge that leaves the same vertex in the neighbouring face."""
    return twins[behind(h)]
