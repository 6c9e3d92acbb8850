"""Where the critical points of a height are, on a surface surveyed before.

`key` (n,) float64 is what decides which of two vertices is the higher: their
heights, or their ranks where heights tie.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .surveying import behind, head_of, turn_around


class CriticalPoints(NamedTuple):
    """The critical points of a height.

    margin : smallest difference of `key` over all mesh edges
    spots : (c,) int32, the places of the critical vertices in `doubtful` of the surface
    vertices : (c,) int32, the critical vertices in ascending order
    index : (c,) int32, PL index of each: 1 extremum, -k a k-fold saddle
    lowest : (c,) bool, which of them are minima
    start, around : around[start[i]:start[i + 1]] are the half-edges that leave vertices[i] in
        the faces in which it is the middle one: one into each lower and each upper wedge of
        a saddle's link, none at an extremum
    """

    margin: float
    spots: np.ndarray
    vertices: np.ndarray
    index: np.ndarray
    lowest: np.ndarray
    start: np.ndarray
    around: np.ndarray


def heights_along(points, direction, out=None):
    """Heights (n,) of (n, 3) points along a direction (3,); `out` (n,) float64 takes them, if given.

    Summed element by element in the order x, y, z, as
    :func:`heightmesh.tilt_points` does: the same floats, to the last bit.
    """
    out = np.empty(len(points)) if out is None else out
    _fill_heights(*np.ascontiguousarray(np.transpose(points), float), *np.asarray(direction, float).tolist(), out)
    return out


@njit(cache=True)
def _fill_heights(x, y, z, dx, dy, dz, out):
    for i in range(len(x)):
        out[i] = dx * x[i] + dy * y[i] + dz * z[i]


def find_critical_points(surface, key):
    """The :class:`CriticalPoints` of `key`, heights along a direction that the surface was surveyed for, or ranks.

    Where `key` ties two neighbours or two critical points, their order is
    open: then `vertices` is empty, and ranks must be given instead.
    """
    margin = _find_margin(surface.level, key)
    if not margin < surface.least:
        margin = _find_margin_of_all(surface.corners, key)
    spots, index = _find_critical(surface.doubtful, surface.start, surface.ring, key)
    heights = key[surface.doubtful[spots]]
    order = np.argsort(heights, kind="stable")
    if margin == 0 or (np.diff(heights[order]) == 0).any():
        order = order[:0]
    spots, index = spots[order], index[order]
    vertices = surface.doubtful[spots]
    return CriticalPoints(margin, spots, vertices, index, *_find_wedges(*surface[:3], key, vertices, index))


@njit(cache=True)
def _find_margin(edges, key):
    margin = np.inf
    for i in range(len(edges)):
        margin = min(margin, abs(key[edges[i, 0]] - key[edges[i, 1]]))
    return margin


@njit(cache=True)
def _find_margin_of_all(corners, key):
    margin = np.inf
    for h in range(len(corners)):
        margin = min(margin, abs(key[corners[h]] - key[head_of(corners, h)]))
    return margin


@njit(cache=True)
def _find_critical(doubtful, start, ring, key):
    """The critical ones of the `doubtful` vertices, by their places, and the index of each."""
    spots, index, count = np.empty(len(doubtful), np.int32), np.empty(len(doubtful), np.int32), 0
    for i in range(len(doubtful)):
        here, changes = key[doubtful[i]], 0
        before = key[ring[start[i + 1] - 1]] < here
        for j in range(start[i], start[i + 1]):
            below = key[ring[j]] < here
            changes += below != before
            before = below
        if changes != 2:
            spots[count], index[count] = i, 1 - changes // 2
            count += 1
    return spots[:count].copy(), index[:count].copy()


@njit(cache=True)
def _find_wedges(corners, twins, leaving, key, vertices, index):
    start, lowest = np.zeros(len(vertices) + 1, np.int64), np.zeros(len(vertices), np.bool_)
    for i in range(len(vertices)):
        start[i + 1] = start[i] + 2 * (1 - index[i])
    around = np.empty(start[-1], np.int32)
    for i in range(len(vertices)):
        v, fill = vertices[i], start[i]
        h = leaving[v]
        if index[i] == 1:
            lowest[i] = key[head_of(corners, h)] > key[v]
        while fill < start[i + 1]:
            if (key[head_of(corners, h)] < key[v]) == (key[v] < key[corners[behind(h)]]):
                around[fill] = h
                fill += 1
            h = turn_around(twins, h)
    return lowest, start, around
