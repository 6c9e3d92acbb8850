"""Cells (face, slab) of a cut surface, the pieces that they make and the measures of those, counted again.

A mesh edge that meets a slab joins the cells of its two faces there, and
pieces are the connected components.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .recount_joins import join, number_sets


class Cells(NamedTuple):
    """The cells in slabs first..last-1, slab s being the one below level s, and the P pieces they make.

    start : (m,) the cell of face f and slab s is start[f] + s
    part : (N,) the piece of each cell. Per piece: `slab`, `shell`, `euler`
    (V - E + F), `area`, `flux`
    """

    start: np.ndarray
    part: np.ndarray
    slab: np.ndarray
    shell: np.ndarray
    euler: np.ndarray
    area: np.ndarray
    flux: np.ndarray


def find_cells(surface, sides, centre, place, height, of_vertex, count, first, last):
    """The :class:`Cells` of a surface in a run of slabs.

    centre : (s, 2) middle of each shell, of :func:`find_centres`; place : (n,)
    levels below each vertex; height : (K,) of the levels.
    Pieces of the vertices in the run are entered in `of_vertex` (n,), counted
    on from `count`. The flux is the integral over height of the signed area
    that the cell's level segment sweeps around the middle of its shell; it is
    quadratic on either side of the middle corner, where Simpson's rule is
    exact. A face within one horizontal plane counts whole where its middle
    corner lies.
    """
    mesh = surface.points, surface.corners, surface.even, surface.shell, sides.lower, sides.upper, sides.faces
    bounds = np.concatenate([[-np.inf], height, [np.inf]])
    return Cells(*_find_cells(*mesh, centre, place, bounds, of_vertex, count, first, last))


@njit(cache=True)
def find_centres(points, corners, shell):
    """The middle of the lowest corners of each shell's faces, (n, 2)."""
    n = shell.max() + 1
    centre, weight = np.zeros((n, 2)), np.zeros(n)
    for f in range(len(corners)):
        centre[shell[f], 0] += points[corners[f, 0], 0]
        centre[shell[f], 1] += points[corners[f, 0], 1]
        weight[shell[f]] += 1
    return centre / np.maximum(weight, 1).reshape(-1, 1)


@njit(cache=True)
def _find_cells(
    points, corners, even, shell, lower, upper, faces, centre, place, bounds, of_vertex, count, first, last
):
    start, n = np.empty(len(corners), np.int64), 0
    for f in range(len(corners)):
        low, high = max(place[corners[f, 0]], first), min(place[corners[f, 2]] + 1, last)
        start[f] = n - low
        n += max(high - low, 0)
    part = np.arange(n)
    for side in range(len(lower)):
        one, two = start[faces[side, 0]], start[faces[side, 1]]
        for s in range(max(place[lower[side]], first), min(place[upper[side]] + 1, last)):
            join(part, one + s, two + s)
    n_parts = number_sets(part)
    slab, shells, euler = np.empty(n_parts, np.int64), np.empty(n_parts, np.int64), np.zeros(n_parts, np.int64)
    area, flux = np.zeros(n_parts), np.zeros(n_parts)
    for f in range(len(corners)):
        a, b, c = _point(points, corners[f, 0]), _point(points, corners[f, 1]), _point(points, corners[f, 2])
        middle = centre[shell[f], 0], centre[shell[f], 1]
        for s in range(max(place[corners[f, 0]], first), min(place[corners[f, 2]] + 1, last)):
            p = part[start[f] + s]
            share, swept = _measure(a, b, c, middle, bounds[s], bounds[s + 1])
            if c[2] == a[2] and s == place[corners[f, 1]]:
                share = 1.0
            area[p] += share * _area(a, b, c)
            flux[p] += swept if even[f] else -swept
            slab[p], shells[p] = s, shell[f]
            euler[p] += 1
        for corner in range(3):
            v = corners[f, corner]
            if first <= place[v] < last:
                of_vertex[v] = part[start[f] + place[v]] + count
    # boundary circles have as many crossings as segments, so they cancel
    for side in range(len(lower)):
        for s in range(max(place[lower[side]], first), min(place[upper[side]] + 1, last)):
            euler[part[start[faces[side, 0]] + s]] -= 1
    for v in range(len(place)):
        if first <= place[v] < last and of_vertex[v] >= count:
            euler[of_vertex[v] - count] += 1
    return start, part, slab, shells, euler, area, flux


@njit(cache=True)
def _point(points, vertex):
    """As a tuple, which compiled code keeps in registers."""
    return points[vertex, 0], points[vertex, 1], points[vertex, 2]


@njit(cache=True)
def _measure(a, b, c, centre, floor, ceiling):
    """Of a face a, b, c between two heights: its share of the face's area, and its flux were it even."""
    share, flux, rise = 0.0, 0.0, c[2] - a[2]
    for low, high, corner in ((a, b, a), (b, c, c)):
        z0, z1 = max(low[2], floor), min(high[2], ceiling)
        deep = z1 - z0
        if deep <= 0.0:
            continue
        # the level segment's length in parts of the longest one is linear here
        share += (_share(z0, corner[2], b[2]) + _share(z1, corner[2], b[2])) * deep / rise
        swept = _swept(z0, a, b, c, corner, centre) + _swept(z1, a, b, c, corner, centre)
        flux += deep / 6 * (swept + 4 * _swept((z0 + z1) / 2, a, b, c, corner, centre))
    return share, flux


@njit(cache=True)
def _share(z, start, end):
    """How far z is on the way from `start` to `end`, within 0 and 1."""
    return min(max((z - start) / (end - start), 0.0), 1.0) if end != start else 1.0


@njit(cache=True)
def _swept(z, a, b, c, corner, centre):
    """Signed area between `centre` and the level segment from side ac to the middle corner's side."""
    s, t = _share(z, a[2], c[2]), _share(z, corner[2], b[2])
    px, py = a[0] + s * (c[0] - a[0]) - centre[0], a[1] + s * (c[1] - a[1]) - centre[1]
    qx, qy = corner[0] + t * (b[0] - corner[0]) - centre[0], corner[1] + t * (b[1] - corner[1]) - centre[1]
    return 0.5 * (px * qy - py * qx)


@njit(cache=True)
def _area(a, b, c):
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return 0.5 * np.sqrt((uy * vz - uz * vy) ** 2 + (uz * vx - ux * vz) ** 2 + (ux * vy - uy * vx) ** 2)
