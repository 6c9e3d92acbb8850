"""Crossings of mesh edges with levels, their contours and the measures of those, counted again.

A crossing is a (mesh edge, level) pair; a face that a level meets joins the
two of its sides, and contours are the connected components.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .components import first_parents, join, number_sets


class Crossings(NamedTuple):
    """The crossings with levels first..last-1, and the P contours they make.

    origin : the first mesh edge that may meet those levels
    start : the crossing of mesh edge e and level k is start[e - origin] + k
    part : (N,) the contour of each crossing. Per contour: `level`, `shell`,
    `n_points`, `loose`, signed `area`, `perimeter`
    """

    origin: int
    start: np.ndarray
    part: np.ndarray
    level: np.ndarray
    shell: np.ndarray
    n_points: np.ndarray
    loose: np.ndarray
    area: np.ndarray
    perimeter: np.ndarray


def find_crossings(surface, sides, place, levels, doubled, first, last, run_sides, run_faces):
    """The :class:`Crossings` of a surface with a run of levels.

    place : (n,) levels below each vertex; the run as :func:`cut_surface._runs` tells it, others as for `cut_surface.recount`.
    """
    planes = np.stack([levels[column] for column in ("height", "tie_x", "tie_y")], axis=1)
    mesh = surface.points, surface.corners, surface.even, surface.shell, sides.lower, sides.upper, sides.of_face
    found = _find_crossings(*mesh, place, planes, doubled, first, last, run_sides, run_faces)
    return Crossings(run_sides[0], *found)


@njit(cache=True)
def enter_ends(place, lower, upper, start, part, name, first, last, run, enters, leaves):
    """Enter the contours, `name` by part, at the highest and lowest crossing of each mesh edge, if in this run."""
    for side in range(run[0], run[1]):
        low, high = place[lower[side]], place[upper[side]]
        if low < high:
            if first <= high - 1 < last:
                enters[side] = name[part[start[side - run[0]] + high - 1]]
            if first <= low < last:
                leaves[side] = name[part[start[side - run[0]] + low]]


def cross(surface, low, high, height, tie_x, tie_y):
    """Where mesh edges from `low` up to `high` meet tilted planes, (k, 2)."""
    planes = np.empty((len(low), 3))
    planes[:, 0], planes[:, 1], planes[:, 2] = height, tie_x, tie_y
    return _cross_all(surface.points, np.ascontiguousarray(low), np.ascontiguousarray(high), planes)


@njit(cache=True)
def _cross_all(points, low, high, planes):
    spots = np.empty((len(low), 2))
    for k in range(len(low)):
        spots[k, 0], spots[k, 1] = _meet(_line(points, low[k], high[k]), planes, k)
    return spots


@njit(cache=True)
def _line(points, low, high):
    """What :func:`_meet` needs of the mesh edge from `low` up to `high`; ties of height are tilts."""
    axis, column = 2, 0
    if points[low, 2] == points[high, 2]:
        axis, column = (0, 1) if points[low, 0] != points[high, 0] else (1, 2)
    x, y, start = points[low, 0], points[low, 1], points[low, axis]
    return column, start, points[high, axis] - start, x, y, points[high, 0] - x, points[high, 1] - y


@njit(cache=True)
def _meet(line, planes, k):
    """Where a mesh edge meets plane k, (height, tie_x, tie_y)."""
    column, start, span, x, y, dx, dy = line
    share = (planes[k, column] - start) / span if span != 0 else 0.5
    share = 0.5 if np.isnan(share) else min(max(share, 0.0), 1.0)
    return x + share * dx, y + share * dy


@njit(cache=True)
def _find_crossings(
    points, corners, even, shell, lower, upper, of_face, place, planes, doubled, first, last, run_sides, run_faces
):
    origin, end = run_sides
    start, n = np.empty(end - origin, np.int64), 0
    for side in range(origin, end):
        low, high = max(place[lower[side]], first), min(place[upper[side]], last)
        start[side - origin] = n - low
        n += max(high - low, 0)
    part = first_parents(n)
    for f in range(run_faces[0], run_faces[1]):
        middle, (ab, bc, ac) = place[corners[f, 1]], _numbers(of_face, f, origin)
        for k in range(max(place[corners[f, 0]], first), min(place[corners[f, 2]], last)):
            join(part, start[ac] + k, start[ab if k < middle else bc] + k)  # the longest and one of the others
    count = number_sets(part)
    level, shells = np.empty(count, np.int64), np.empty(count, np.int64)
    n_points, loose = np.zeros(count, np.int64), np.zeros(count, np.int64)
    area, perimeter, centre, spots = np.zeros(count), np.zeros(count), np.empty((count, 2)), np.empty((n, 2))
    for side in range(origin, end):
        line = _line(points, lower[side], upper[side])
        for k in range(max(place[lower[side]], first), min(place[upper[side]], last)):
            crossing = start[side - origin] + k
            c = part[crossing]
            x, y = _meet(line, planes, k)
            spots[crossing, 0], spots[crossing, 1] = x, y
            centre[c, 0], centre[c, 1] = x, y  # any point of the contour: no cancellation far from the origin
            level[c] = k
            n_points[c] += 1
            loose[c] += doubled[upper[side]]
    for f in range(run_faces[0], run_faces[1]):
        middle, (ab, bc, ac) = place[corners[f, 1]], _numbers(of_face, f, origin)
        for k in range(max(place[corners[f, 0]], first), min(place[corners[f, 2]], last)):
            p, q = start[ac] + k, start[ab if k < middle else bc] + k
            c = part[p]
            px, py = spots[p, 0] - centre[c, 0], spots[p, 1] - centre[c, 1]
            qx, qy = spots[q, 0] - centre[c, 0], spots[q, 1] - centre[c, 1]
            swept = 0.5 * (px * qy - py * qx)
            area[c] += swept if even[f] else -swept
            perimeter[c] += np.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))
            shells[c] = shell[f]
    return start, part, level, shells, n_points, loose, area, perimeter


@njit(cache=True)
def _numbers(of_face, f, origin):
    """The mesh edges ab, bc and ac of a face, counted from `origin`."""
    return of_face[f, 0] - origin, of_face[f, 1] - origin, of_face[f, 2] - origin
