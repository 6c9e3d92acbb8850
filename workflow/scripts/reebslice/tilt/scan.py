"""Where the critical points of a height are, on a surface surveyed before.

`key` (n,) float64 is what decides which of two vertices is the higher: their
heights, or their ranks where heights tie.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..mesh.half_edges import behind, head_of, turn_around


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
    :func:`height_mesh.tilt_points` does: the same floats, to the last bit.
    """
    out = np.empty(len(points)) if out is None else out
    _fill_heights(*np.ascontiguousarray(np.transpose(points), float), *np.asarray(direction, float).tolist(), out)
    return out


@njit(cache=True)
def _fill_heights(x, y, z, dx, dy, dz, out):
    for i in range(len(x)):
        out[i] = dx * x[i] + dy * y[i] + dz * z[i]


def scan_directions(surface, points, directions):
    """What :func:`find_critical_points` needs of the heights along each of (k, 3) directions, for all of them at once.

    points : (n, 3). Returns the smallest difference of height over the edges in `surface.level`, (k,);
    and which of the doubtful vertices are critical, (k, d) bool.
    """
    x, y, z = np.ascontiguousarray(np.transpose(directions), float)
    margins = _find_margins(surface.level, points, x, y, z)
    return margins, _find_critical(surface.doubtful, surface.start, surface.ring, points, x, y, z)


@njit(cache=True)
def _find_margins(edges, points, dx, dy, dz):
    margins = np.full(len(dx), np.inf)
    for i in range(len(edges)):
        x, y, z = points[edges[i, 0], 0], points[edges[i, 0], 1], points[edges[i, 0], 2]
        a, b, c = points[edges[i, 1], 0], points[edges[i, 1], 1], points[edges[i, 1], 2]
        for k in range(len(dx)):  # sums as in `heights_along`
            rise = abs((dx[k] * x + dy[k] * y + dz[k] * z) - (dx[k] * a + dy[k] * b + dz[k] * c))
            margins[k] = min(margins[k], rise)
    return margins


@njit(cache=True)
def _find_critical(doubtful, start, ring, points, dx, dy, dz):
    critical, here = np.empty((len(dx), len(doubtful)), np.bool_), np.empty(len(dx))
    before, changes = np.empty(len(dx)), np.empty(len(dx))  # numbers of one size, for loops over directions in parallel
    for i in range(len(doubtful)):
        x, y, z = points[doubtful[i], 0], points[doubtful[i], 1], points[doubtful[i], 2]
        for k in range(len(dx)):
            here[k], changes[k] = dx[k] * x + dy[k] * y + dz[k] * z, 0
        last = ring[start[i + 1] - 1]
        x, y, z = points[last, 0], points[last, 1], points[last, 2]
        for k in range(len(dx)):
            before[k] = 1.0 if dx[k] * x + dy[k] * y + dz[k] * z < here[k] else 0.0
        for j in range(start[i], start[i + 1]):
            x, y, z = points[ring[j], 0], points[ring[j], 1], points[ring[j], 2]
            for k in range(len(dx)):
                below = 1.0 if dx[k] * x + dy[k] * y + dz[k] * z < here[k] else 0.0
                changes[k] += abs(below - before[k])
                before[k] = below
        for k in range(len(dx)):
            critical[k, i] = changes[k] != 2
    return critical


def find_critical_points(surface, key, scan=None):
    """The :class:`CriticalPoints` of `key`, heights along a direction that the surface was surveyed for, or ranks.

    scan : margin and critical ones (d,) of a direction from :func:`scan_directions`, if known.
    Where `key` ties two neighbours or two critical points, their order is
    open: then `vertices` is empty, and ranks must be given instead.
    """
    if scan is None:  # ranks are heights of points on a line
        line = np.column_stack([key, np.zeros((len(key), 2))])
        (margin,), (critical,) = scan_directions(surface, line, np.eye(3)[:1])
    else:
        margin, critical = scan
    if not margin < surface.least:
        margin = _find_margin_of_all(surface.corners, key)
    spots = np.flatnonzero(critical).astype(np.int32)
    index = _find_indices(spots, surface.doubtful, surface.start, surface.ring, key)
    heights = key[surface.doubtful[spots]]
    order = np.argsort(heights, kind="stable")
    if margin == 0 or (np.diff(heights[order]) == 0).any():
        order = order[:0]
    spots, index = spots[order], index[order]
    vertices = surface.doubtful[spots]
    return CriticalPoints(margin, spots, vertices, index, *_find_wedges(*surface[:3], key, vertices, index))


@njit(cache=True)
def _find_margin_of_all(corners, key):
    margin = np.inf
    for h in range(len(corners)):
        margin = min(margin, abs(key[corners[h]] - key[head_of(corners, h)]))
    return margin


@njit(cache=True)
def _find_indices(spots, doubtful, start, ring, key):
    index = np.empty(len(spots), np.int32)
    for i in range(len(spots)):
        spot, changes = spots[i], 0
        here = key[doubtful[spot]]
        before = key[ring[start[spot + 1] - 1]] < here
        for j in range(start[spot], start[spot + 1]):
            below = key[ring[j]] < here
            changes += below != before
            before = below
        index[i] = 1 - changes // 2
    return index


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
