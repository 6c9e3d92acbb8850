"""Crossings of mesh edges with levels, their contours and the measures of those, counted again.

A crossing is a (mesh edge, level) pair; a face that a level meets joins the
two of its sides, and contours are the connected components.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .recount_joins import join, number_sets


class Crossings(NamedTuple):
    """The crossings with levels first..last-1, and the P contours they make.

    start : (E,) the crossing of mesh edge e and level k is start[e] + k
    part : (N,) the contour of each crossing. Per contour: `level`, `shell`,
    `n_points`, `loose`, signed `area`, `perimeter`
    """

    start: np.ndarray
    part: np.ndarray
    level: np.ndarray
    shell: np.ndarray
    n_points: np.ndarray
    loose: np.ndarray
    area: np.ndarray
    perimeter: np.ndarray


def find_crossings(surface, sides, place, levels, doubled, first, last):
    """The :class:`Crossings` of a surface with a run of levels; arguments as for `recount.recount`."""
    planes = np.stack([levels[column] for column in ("height", "tie_x", "tie_y")], axis=1)
    mesh = surface.points, surface.corners, surface.even, surface.shell, sides.lower, sides.upper, sides.of_face
    return Crossings(*_find_crossings(*mesh, place, planes, doubled, first, last))


def cross(surface, low, high, height, tie_x, tie_y):
    """Where mesh edges from `low` up to `high` meet tilted planes, (k, 2)."""
    planes = np.empty((len(low), 3))
    planes[:, 0], planes[:, 1], planes[:, 2] = height, tie_x, tie_y
    return _cross_all(surface.points, np.ascontiguousarray(low), np.ascontiguousarray(high), planes)


@njit(cache=True)
def _cross_all(points, low, high, planes):
    spots = np.empty((len(low), 2))
    for k in range(len(low)):
        spots[k, 0], spots[k, 1] = _cross(points, low[k], high[k], planes, k)
    return spots


@njit(cache=True)
def _cross(points, low, high, planes, k):
    """Where the mesh edge from `low` up to `high` meets plane k, (height, tie_x, tie_y); ties of height are tilts."""
    axis, column = 2, 0
    if points[low, 2] == points[high, 2]:
        axis, column = (0, 1) if points[low, 0] != points[high, 0] else (1, 2)
    start, span = points[low, axis], points[high, axis] - points[low, axis]
    share = (planes[k, column] - start) / span if span != 0 else 0.5
    share = 0.5 if np.isnan(share) else min(max(share, 0.0), 1.0)
    x, y = points[low, 0], points[low, 1]
    return x + share * (points[high, 0] - x), y + share * (points[high, 1] - y)


@njit(cache=True)
def _find_crossings(points, corners, even, shell, lower, upper, of_face, place, planes, doubled, first, last):
    start, n = np.empty(len(lower), np.int64), 0
    for side in range(len(lower)):
        low, high = max(place[lower[side]], first), min(place[upper[side]], last)
        start[side] = n - low
        n += max(high - low, 0)
    part = np.arange(n)
    for f in range(len(corners)):
        for k in range(max(place[corners[f, 0]], first), min(place[corners[f, 2]], last)):
            join(part, start[of_face[f, 2]] + k, start[_short(corners, of_face, place, f, k)] + k)
    count = number_sets(part)
    level, shells = np.empty(count, np.int64), np.empty(count, np.int64)
    n_points, loose = np.zeros(count, np.int64), np.zeros(count, np.int64)
    area, perimeter, centre, spots = np.zeros(count), np.zeros(count), np.empty((count, 2)), np.empty((n, 2))
    for side in range(len(lower)):
        for k in range(max(place[lower[side]], first), min(place[upper[side]], last)):
            c = part[start[side] + k]
            x, y = _cross(points, lower[side], upper[side], planes, k)
            spots[start[side] + k, 0], spots[start[side] + k, 1] = x, y
            centre[c, 0], centre[c, 1] = x, y  # any point of the contour: no cancellation far from the origin
            level[c] = k
            n_points[c] += 1
            loose[c] += doubled[upper[side]]
    for f in range(len(corners)):
        for k in range(max(place[corners[f, 0]], first), min(place[corners[f, 2]], last)):
            long, short = start[of_face[f, 2]] + k, start[_short(corners, of_face, place, f, k)] + k
            c = part[long]
            p, q = (long, short) if even[f] else (short, long)
            px, py = spots[p, 0] - centre[c, 0], spots[p, 1] - centre[c, 1]
            qx, qy = spots[q, 0] - centre[c, 0], spots[q, 1] - centre[c, 1]
            area[c] += 0.5 * (px * qy - py * qx)
            perimeter[c] += np.hypot(qx - px, qy - py)
            shells[c] = shell[f]
    return start, part, level, shells, n_points, loose, area, perimeter


@njit(cache=True)
def _short(corners, of_face, place, f, k):
    """Of face `f` the side, besides its longest, that level `k` meets."""
    return of_face[f, 0] if place[corners[f, 1]] > k else of_face[f, 1]
