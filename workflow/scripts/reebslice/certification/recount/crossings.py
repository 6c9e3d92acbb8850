"""Crossings of mesh edges with levels, their contours and the measures of those, counted again.

A crossing is a (mesh edge, level) pair; a face that a level meets joins the
two of its sides, and contours are the connected components.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .components import first_parents, join, number_sets


class Cut(NamedTuple):
    """Where K levels cut a surface of n vertices.

    place : (n,) int32, the levels below each vertex
    planes : (K, 3) float64, height, tie_x and tie_y of each level
    doubled : (n,) int64, how often the mesh edges up to a vertex may be
        doubled where the vertex, a multiple saddle, comes apart
    """

    place: np.ndarray
    planes: np.ndarray
    doubled: np.ndarray


class Run(NamedTuple):
    """Levels or slabs first..last-1, and ranges (begin, end) that hold all mesh edges and all faces that meet them."""

    first: int
    last: int
    sides: tuple
    faces: tuple


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


def find_crossings(surface, sides, cut, run):
    """Find the crossings of a surface with a run of levels, and the contours that they make.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
        The surface and its mesh edges.
    cut : Cut
        Where all levels are.
    run : Run
        The levels to look at.

    Returns
    -------
    Crossings
    """
    return Crossings(run.sides[0], *_find_crossings(surface, sides, cut, run))


@njit
def enter_ends(sides, place, run, crossings, name, enters, leaves):
    """Enter the contours at the highest and the lowest crossing of each mesh edge, if those are in the run.

    Parameters
    ----------
    sides : MeshEdges
    place : (n,) int32
        Levels below each vertex.
    run, crossings : Run, Crossings
    name : (P,) int64
        The contour that each part of the crossings is.
    enters, leaves : (E,) int32
        Filled in.
    """
    for side in range(run.sides[0], run.sides[1]):
        low, high = place[sides.lower[side]], place[sides.upper[side]]
        first = crossings.start[side - run.sides[0]]
        if low < high:
            if run.first <= high - 1 < run.last:
                enters[side] = name[crossings.part[first + high - 1]]
            if run.first <= low < run.last:
                leaves[side] = name[crossings.part[first + low]]


def cross(surface, low, high, height, tie_x, tie_y):
    """Find where mesh edges meet planes that are tilted infinitesimally.

    Parameters
    ----------
    surface : Ranked
    low, high : (k,) int
        The ends of the mesh edges, upward.
    height, tie_x, tie_y : float or (k,) float64
        Of the planes.

    Returns
    -------
    (k, 2) float64
    """
    planes = np.empty((len(low), 3))
    planes[:, 0], planes[:, 1], planes[:, 2] = height, tie_x, tie_y
    return _cross_all(surface.points, np.ascontiguousarray(low), np.ascontiguousarray(high), planes)


@njit
def _cross_all(points, low, high, planes):
    """As :func:`cross`, of planes (k, 3)."""
    spots = np.empty((len(low), 2))
    for k in range(len(low)):
        spots[k, 0], spots[k, 1] = _meet(_line(points, low[k], high[k]), planes, k)
    return spots


@njit
def _line(points, low, high):
    """What :func:`_meet` needs of the mesh edge from `low` up to `high`; ties of height are tilts."""
    axis, column = 2, 0
    if points[low, 2] == points[high, 2]:
        axis, column = (0, 1) if points[low, 0] != points[high, 0] else (1, 2)
    x, y, start = points[low, 0], points[low, 1], points[low, axis]
    return column, start, points[high, axis] - start, x, y, points[high, 0] - x, points[high, 1] - y


@njit
def _meet(line, planes, k):
    """Where a mesh edge meets plane k, (height, tie_x, tie_y)."""
    column, start, span, x, y, dx, dy = line
    share = (planes[k, column] - start) / span if span != 0 else 0.5
    share = 0.5 if np.isnan(share) else min(max(share, 0.0), 1.0)
    return x + share * dx, y + share * dy


@njit
def _find_crossings(surface, sides, cut, run):
    """Columns of :class:`Crossings`."""
    start, part = _join_crossings(surface, sides, cut.place, run)
    count = number_sets(part)
    level, shells = np.empty(count, np.int64), np.empty(count, np.int64)
    n_points, loose = np.zeros(count, np.int64), np.zeros(count, np.int64)
    area, perimeter, centre, spots = np.zeros(count), np.zeros(count), np.empty((count, 2)), np.empty((len(part), 2))
    for side in range(run.sides[0], run.sides[1]):
        low, high = sides.lower[side], sides.upper[side]
        line = _line(surface.points, low, high)
        for k in range(max(cut.place[low], run.first), min(cut.place[high], run.last)):
            crossing = start[side - run.sides[0]] + k
            c = part[crossing]
            x, y = _meet(line, cut.planes, k)
            spots[crossing, 0], spots[crossing, 1] = x, y
            centre[c, 0], centre[c, 1] = x, y  # any point of the contour: no cancellation far from the origin
            level[c] = k
            n_points[c] += 1
            loose[c] += cut.doubled[high]
    for f in range(run.faces[0], run.faces[1]):
        (low, middle, high), (ab, bc, ac) = _of_face(surface, sides, cut.place, f, run)
        for k in range(max(low, run.first), min(high, run.last)):
            p, q = start[ac] + k, start[ab if k < middle else bc] + k
            c = part[p]
            px, py = spots[p, 0] - centre[c, 0], spots[p, 1] - centre[c, 1]
            qx, qy = spots[q, 0] - centre[c, 0], spots[q, 1] - centre[c, 1]
            swept = 0.5 * (px * qy - py * qx)
            area[c] += swept if surface.even[f] else -swept
            perimeter[c] += np.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))
            shells[c] = surface.shell[f]
    return start, part, level, shells, n_points, loose, area, perimeter


@njit
def _join_crossings(surface, sides, place, run):
    """Where the crossings of each mesh edge begin, and their sets: a face joins those of its longest side to others."""
    origin, end = run.sides
    start, n = np.empty(end - origin, np.int64), 0
    for side in range(origin, end):
        low, high = max(place[sides.lower[side]], run.first), min(place[sides.upper[side]], run.last)
        start[side - origin] = n - low
        n += max(high - low, 0)
    part = first_parents(n)
    for f in range(run.faces[0], run.faces[1]):
        (low, middle, high), (ab, bc, ac) = _of_face(surface, sides, place, f, run)
        for k in range(max(low, run.first), min(high, run.last)):
            join(part, start[ac] + k, start[ab if k < middle else bc] + k)
    return start, part


@njit
def _of_face(surface, sides, place, f, run):
    """Of a face the levels below its corners, and its mesh edges ab, bc and ac counted from the first of the run."""
    a, b, c = surface.corners[f, 0], surface.corners[f, 1], surface.corners[f, 2]
    origin, of_face = run.sides[0], sides.of_face
    return (place[a], place[b], place[c]), (of_face[f, 0] - origin, of_face[f, 1] - origin, of_face[f, 2] - origin)
