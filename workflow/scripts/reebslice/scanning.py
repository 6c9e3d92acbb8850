"""Where the critical points of many heights are: one pass over the faces finds those of several at a time.

`key` (n,) float64 is what decides which of two vertices is the higher: their
heights, or their ranks where heights tie.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .heightmesh import find_twins


class Rings(NamedTuple):
    """The faces around each vertex of a closed surface, on which they are one fan.

    leaving : (n,) int32, a half-edge that leaves each vertex
    twins : (3 m,) int32, of :func:`heightmesh.find_twins`
    """

    leaving: np.ndarray
    twins: np.ndarray


class CriticalPoints(NamedTuple):
    """The critical points of a height.

    margin : smallest difference of `key` over all mesh edges
    index : (n,) int32, PL index of every vertex: 1 extremum, 0 regular, -k a k-fold saddle
    vertices : (c,) int32, the critical vertices in ascending order
    lowest : (c,) bool, which of them are minima
    start, around : around[start[i]:start[i + 1]] are the half-edges that leave vertices[i] in
        the faces in which it is the middle one: one into each lower and each upper wedge of
        a saddle's link, none at an extremum
    rings : of the surface
    """

    margin: float
    index: np.ndarray
    vertices: np.ndarray
    lowest: np.ndarray
    start: np.ndarray
    around: np.ndarray
    rings: Rings


def heights_along(points, directions):
    """Heights (k, n) of (n, 3) points along (k, 3) directions.

    Summed element by element in the order x, y, z, as
    :func:`heightmesh.tilt_points` does: the same floats, to the last bit.
    """
    return _heights(np.ascontiguousarray(points, float), np.array(directions, float))[0]


def find_rings(faces, n_vertices):
    """The :class:`Rings` of a closed, oriented surface, faces (m, 3) int32."""
    leaving = np.empty(n_vertices, np.int32)
    leaving[faces.ravel()] = np.arange(faces.size, dtype=np.int32)
    return Rings(leaving, find_twins(faces, n_vertices))


def find_critical_points(faces, key, rings=None):
    """The :class:`CriticalPoints` of `key` on a closed surface, faces (m, 3) int32.

    Where `key` ties two neighbours or two critical points, their order is
    open: then `vertices` is empty, and ranks must be given instead.
    """
    margins, vertices, counts, _ = _scan(faces, key[:, None])
    return _sort_critical_points(faces, rings or find_rings(faces, len(key)), key, margins[0], vertices, counts)


def scan_directions(points, faces, rings, directions):
    """Yield, for each direction (k, 3), the heights (n,) along it and their :class:`CriticalPoints`."""
    for first in range(0, len(directions), TOGETHER):
        heights, by_vertex = _heights(points, np.array(directions[first : first + TOGETHER], float))
        margins, vertices, counts, bounds = _scan(faces, by_vertex)
        for k, key in enumerate(heights):
            here = slice(bounds[k], bounds[k + 1])
            yield key, _sort_critical_points(faces, rings, key, margins[k], vertices[here], counts[here])


TOGETHER = 8  # directions scanned at a time: the heights of a vertex then fill one line of the cache


def _sort_critical_points(faces, rings, key, margin, vertices, counts):
    """counts (c,) : in how many faces each of the critical vertices is the middle one."""
    index = np.zeros(len(key), np.int32)
    index[vertices] = 1 - counts // 2
    vertices = vertices[np.argsort(key[vertices], kind="stable")]
    if margin == 0 or (np.diff(key[vertices]) == 0).any():
        vertices = vertices[:0]
    return CriticalPoints(margin, index, vertices, *_find_wedges(faces, *rings, key, index, vertices), rings)


@njit(cache=True)
def _heights(points, directions):
    """Heights (k, n), and once more (n, k)."""
    heights, by_vertex = np.empty((len(directions), len(points))), np.empty((len(points), len(directions)))
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for k in range(len(directions)):
            heights[k, i] = by_vertex[i, k] = directions[k, 0] * x + directions[k, 1] * y + directions[k, 2] * z
    return heights, by_vertex


@njit(cache=True)
def _scan(faces, keys):
    """Critical points of each of the `keys` (n, k), those of one after those of the other.

    Returns the margins (k,); the critical vertices, ascending by id; the number
    of faces in which each is the middle one; and where those of each key begin, (k + 1,).
    """
    n, several = keys.shape
    middle, margin, bounds = np.zeros((n, several), np.int32), np.full(several, np.inf), np.zeros(several + 1, np.int64)
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        for k in range(several):  # without branches, so that it is done for all at once
            x, y, z = keys[a, k], keys[b, k], keys[c, k]
            margin[k] = min(margin[k], abs(x - y), abs(y - z), abs(z - x))
            middle[a, k] += (z < x) == (x < y)
            middle[b, k] += (x < y) == (y < z)
            middle[c, k] += (y < z) == (z < x)
    for v in range(n):
        for k in range(several):
            bounds[k + 1] += middle[v, k] != 2
    for k in range(several):
        bounds[k + 1] += bounds[k]
    fill, vertices, counts = bounds[:-1].copy(), np.empty(bounds[-1], np.int32), np.empty(bounds[-1], np.int32)
    for v in range(n):
        for k in range(several):
            if middle[v, k] != 2:
                vertices[fill[k]], counts[fill[k]] = v, middle[v, k]
                fill[k] += 1
    return margin, vertices, counts, bounds


@njit(cache=True, inline="always")
def head_of(faces, h):
    return faces[h // 3, (h % 3 + 1) % 3]


@njit(cache=True, inline="always")
def turn_around(twins, h):
    """The half-edge that leaves the same vertex in the neighbouring face."""
    return twins[h + 2 if h % 3 == 0 else h - 1]


@njit(cache=True)
def _find_wedges(faces, leaving, twins, key, index, vertices):
    start, lowest = np.zeros(len(vertices) + 1, np.int64), np.zeros(len(vertices), np.bool_)
    for i in range(len(vertices)):
        start[i + 1] = start[i] + 2 * (1 - index[vertices[i]])
    around = np.empty(start[-1], np.int32)
    for i in range(len(vertices)):
        v, fill = vertices[i], start[i]
        h = leaving[v]
        if index[v] == 1:
            lowest[i] = key[head_of(faces, h)] > key[v]
        while fill < start[i + 1]:
            if (key[head_of(faces, h)] < key[v]) == (key[v] < key[faces[h // 3, (h % 3 + 2) % 3]]):
                around[fill] = h
                fill += 1
            h = turn_around(twins, h)
    return lowest, start, around
