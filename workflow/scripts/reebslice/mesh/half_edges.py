"""Half-edges of triangles: half-edge h of face h // 3 runs from its corner h % 3 to the next.

A mesh edge is a pair of vertices; its half-edges are those of the faces that
share it. Half-edge h starts at corner h, so both bear one number.
"""

import numpy as np

from ..arrays.sorting import sort_stably
from ..kernels import njit


def find_twins(faces, n_vertices):
    """Find the opposite half-edge of every half-edge of a closed and oriented surface.

    Parameters
    ----------
    faces : (m, 3) int
        Vertex ids, below `n_vertices`.
    n_vertices : int

    Returns
    -------
    (3 m,) int32
        An involution without fixed points; the two run in opposite directions.

    Raises
    ------
    ValueError
        If some mesh edge does not lie in exactly two faces that run along it in
        opposite directions; the message names its vertices.
    """
    twins, bad = _match(np.ascontiguousarray(faces, np.int32), int(n_vertices), True)
    if bad >= 0:
        face, corner = divmod(int(bad), 3)
        ends = faces[face, corner], faces[face, (corner + 1) % 3]
        raise ValueError(f"the surface is not closed and oriented at mesh edge {ends[0]}-{ends[1]}")
    return twins


def match_half_edges(faces, n_vertices):
    """Find the other half-edge of every mesh edge, whichever way the faces are wound.

    Parameters
    ----------
    faces : (m, 3) int
        Vertex ids, below `n_vertices`.
    n_vertices : int

    Returns
    -------
    (3 m,) int32 or None
        None if some mesh edge does not lie in exactly two faces.
    """
    opposite, bad = _match(np.ascontiguousarray(faces, np.int32), int(n_vertices), False)
    return opposite if bad < 0 else None


@njit
def _match(faces, n, oriented):
    """The other half-edge of each, (3m,) int32, and a half-edge without exactly one such; -1 if all have one.

    The half-edges with one lower end are chained, and each is met once by the
    other one with its upper end; if `oriented`, only by one that runs against it.
    """
    newest, older, tails = np.full(n, -1, np.int32), np.empty(faces.size, np.int32), faces.ravel()
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        for k, low in ((0, min(a, b)), (1, min(b, c)), (2, min(c, a))):
            older[3 * f + k], newest[low] = newest[low], 3 * f + k
    opposite = np.empty(len(tails), np.int32)
    met = np.full((n, 2), -1, np.int32)  # per upper end: the lower end last seen, the half-edge between, -1 if matched
    for v in range(n):
        h, single = newest[v], 0
        while h >= 0:
            tail = tails[h]
            upper = tails[h - 2 if h % 3 == 2 else h + 1] if tail == v else tail
            g = met[upper, 1]
            if met[upper, 0] != v:
                met[upper, 0], met[upper, 1] = v, h
                single += 1
            elif g < 0 or (oriented and tails[g] == tail):
                return opposite, h
            else:
                opposite[g], opposite[h], met[upper, 1] = h, g, -1
                single -= 1
            h = older[h]
        if single > 0:
            return opposite, _first_single(tails, newest[v], older, met)
    return opposite, -1


@njit(inner=True)
def _first_single(tails, h, older, met):
    """The first half-edge of the chain from h on whose other half-edge was not met."""
    while met[max(tails[h], tails[ahead(h)]), 1] != h:
        h = older[h]
    return h


def group_half_edges(faces, n_vertices):
    """Group the half-edges by mesh edge, of which any number of faces may share one.

    Parameters
    ----------
    faces : (m, 3) int
        Vertex ids, below `n_vertices`.
    n_vertices : int

    Returns
    -------
    order : (3 m,) int64
        Half-edges by mesh edge, that is by lower and then by upper end; those of one mesh edge ascend.
    starts : (e + 1,) int64
        Offsets in `order` at which the mesh edges begin and end.
    """
    low, high = _find_ends(np.ascontiguousarray(faces, np.int64))
    order = sort_stably((high, n_vertices), (low, n_vertices))
    return order, _find_starts(low, high, order)


@njit
def _find_ends(faces):
    """The smaller and the larger id on each half-edge, two (3m,)."""
    low, high = np.empty(3 * len(faces), np.int64), np.empty(3 * len(faces), np.int64)
    for h in range(len(low)):
        one, two = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        low[h], high[h] = min(one, two), max(one, two)
    return low, high


@njit
def _find_starts(low, high, order):
    starts, count = np.zeros(len(order) + 1, np.int64), 0
    for i in range(1, len(order) + 1):
        if i == len(order) or low[order[i]] != low[order[i - 1]] or high[order[i]] != high[order[i - 1]]:
            count += 1
            starts[count] = i
    return starts[: count + 1].copy()


def pair_half_edges(order):
    """Turn a list of half-edges in pairs into a map from each half-edge to the other one.

    Parameters
    ----------
    order : (3 m,) int
        Half-edges, those at 2 i and 2 i + 1 belong together.

    Returns
    -------
    (3 m,) int32
    """
    opposite = np.empty(len(order), np.int32)
    opposite[order[0::2]] = order[1::2]
    opposite[order[1::2]] = order[0::2]
    return opposite


@njit(inline="always")
def ahead(h):
    """The next half-edge of the same face, without a branch that the processor would mispredict every third time."""
    return h + 1 - 3 * (h % 3 == 2)


@njit(inline="always")
def behind(h):
    """The half-edge before, of the same face."""
    return h - 1 + 3 * (h % 3 == 0)
