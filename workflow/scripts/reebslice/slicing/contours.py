"""Level sets of a surface as closed, oriented contours.

A face that a level crosses has one crossing on the mesh edge that runs upward
in it, so a crossing is a (face, level) pair. The next crossing on its contour
lies in the face across that edge, and the contours are the cycles of a
permutation: closed, oriented with material on the left, without comparing any
coordinates. A plane sweeps upward and keeps the faces that it crosses, so time
grows as faces + crossings, and levels can be had a block at a time.
"""

import math
from typing import NamedTuple

import numpy as np

from ..arrays.grouping import split_into_blocks
from ..errors import TooManyCrossingsError
from ..kernels import njit
from ..morse.ordered_mesh import cross_at
from .levels import vertex_slabs

# A cut holds 20 bytes of each crossing, its point and its label: so many are 5 GB, and the
# stages that read all contours back hold several times that. trace_blocks has no bound.
MOST_CROSSINGS = 250_000_000


class Contours(NamedTuple):
    """C contours with X points, ordered by level and then by their first crossing.

    Attributes
    ----------
    level : (C,) int32
        The level of each contour.
    start : (C + 1,) int64
        Contour c owns ``points[start[c]:start[c + 1]]``; the first point is not repeated at the end.
    points : (X, 2) float64
        Points in the tilted frame, in order along the contours, material on the left seen from +z.
    first : (C,) int32
        The half-edge, running upward, of each contour's first point.
    lower, upper : (C,) int32
        Ranks of the ends of that half-edge.
    """

    level: np.ndarray
    start: np.ndarray
    points: np.ndarray
    first: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


class Crossings(NamedTuple):
    """The contour that crosses each face at each level.

    Attributes
    ----------
    offset : (m + 1,) int64
        ``label[offset[f] + j]`` is the contour that crosses face f at the j-th level above its lowest corner.
    label : (X,) int32
        Contours. Empty if nobody asks for them.
    """

    offset: np.ndarray
    label: np.ndarray


class SweepState(NamedTuple):
    """What the sweeping plane keeps from level to level; all arrays are modified.

    Attributes
    ----------
    gates : (m, 4) int32
        Of a face that a level crosses: the level from which on its second mesh edge runs upward through
        the level, and not the first; the faces across these two edges; the last level whose contour came by.
    active : (F, 2) int32
        Faces that the level crosses, ascending, and the last level to cross each.
    progress : (2,) int64
        The first face not yet reached; the number of active faces.
    """

    gates: np.ndarray
    active: np.ndarray
    progress: np.ndarray


NO_CROSSINGS = Crossings(np.zeros(1, np.int64), np.zeros(0, np.int32))


def trace_contours(mesh, levels):
    """Trace the contours of all levels.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of m faces.
    levels : Levels
        The cuts; none give no contours.

    Returns
    -------
    Contours
        Every contour is closed, has material on its left seen from +z, and starts at its first crossing in the
        order of half-edges, so the result does not depend on the order of vertices or faces in the input.
        Time grows as the faces and the crossings.

    Raises
    ------
    TooManyCrossingsError
        The points would be more than MOST_CROSSINGS; no memory is taken for them before.
    """
    return _trace_at_once(mesh, levels, NO_CROSSINGS)


def trace_crossings(mesh, levels):
    """Trace the contours of all levels, and tell which of them cross each face.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of m faces.
    levels : Levels
        The cuts.

    Returns
    -------
    contours : Contours
        Those of :func:`trace_contours`.
    crossings : Crossings
        The way from faces to contours.

    Raises
    ------
    TooManyCrossingsError
        As for :func:`trace_contours`.
    """
    offset = _first_crossings(mesh.faces, vertex_slabs(mesh, levels))
    _refuse_too_many(levels, offset[-1])
    crossings = Crossings(offset, np.empty(offset[-1], np.int32))
    return _trace_at_once(mesh, levels, crossings), crossings


def trace_blocks(mesh, levels, most_crossings):
    """Trace the contours of a few consecutive levels at a time.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of m faces.
    levels : Levels
        The cuts, of which there may be more than memory holds contours.
    most_crossings : int
        Bound on the points of a block; a single level may have more.

    Yields
    ------
    Contours
        A block, whose levels keep their numbers. Contour c of a block is, to the last bit, contour
        c + (contours of the blocks before) of :func:`trace_contours`. Beyond the mesh and a block it
        takes some 20 bytes a face.
    """
    count = _count_crossings(mesh.faces, vertex_slabs(mesh, levels), len(levels.height))
    return _sweep_blocks(mesh, levels, NO_CROSSINGS, count, split_into_blocks(np.cumsum([0, *count]), most_crossings))


def _trace_at_once(mesh, levels, crossings):
    """Contours of all levels in one block; fills in the labels of `crossings`, if there are any."""
    count = _count_crossings(mesh.faces, vertex_slabs(mesh, levels), len(levels.height))
    _refuse_too_many(levels, count.sum())
    return next(_sweep_blocks(mesh, levels, crossings, count, [(0, len(count))]))


def _refuse_too_many(levels, crossings):
    """Raise TooManyCrossingsError for more than MOST_CROSSINGS."""
    if crossings > MOST_CROSSINGS:
        raise TooManyCrossingsError(
            f"{len(levels.height)} levels cross the mesh edges {crossings} times, more than the {MOST_CROSSINGS} "
            f"that can be held: take fewer, by a factor of {math.ceil(crossings / MOST_CROSSINGS)}"
        )


def _sweep_blocks(mesh, levels, crossings, count, blocks):
    """Contours of each block of levels; count : (K,) crossings of each level."""
    slab = vertex_slabs(mesh, levels)
    gates, active = np.empty((len(mesh.faces), 4), np.int32), np.empty((int(count.max(initial=0)), 2), np.int32)
    state, ends = SweepState(gates, active, np.zeros(2, np.int64)), mesh.faces.ravel()
    for first, end in blocks:
        points = np.empty((int(count[first:end].sum()), 2))
        level, start, edge = _trace_levels(mesh, levels, slab, first, end, state, crossings, points)
        yield Contours(level, start, points, edge, ends[edge], ends[edge + 1])


@njit
def _first_crossings(faces, slab):
    """How many crossings the faces before each one have, (m + 1,) int64."""
    offset = np.zeros(faces.shape[0] + 1, np.int64)
    for f in range(faces.shape[0]):
        offset[f + 1] = offset[f] + slab[max(faces[f, 1], faces[f, 2])] - slab[faces[f, 0]]
    return offset


@njit
def _count_crossings(faces, slab, n_levels):
    """Crossings of each level, (K,) int64: faces entered so far less those left."""
    count = np.zeros(n_levels + 1, np.int64)
    for f in range(faces.shape[0]):
        count[slab[faces[f, 0]]] += 1  # the first corner is the lowest
        count[slab[max(faces[f, 1], faces[f, 2])]] -= 1
    for k in range(n_levels):
        count[k + 1] += count[k]
    return count[:-1]


@njit
def _trace_levels(mesh, levels, slab, first, end, state, crossings, out):
    """Contours of the levels from `first` up to `end`: their levels, starts and first half-edges.

    Fills in `out`, the points, and the labels of `crossings`, if there are any. A half-edge 3 f + second
    is the first or, from a certain level on, the second one of face f, of which one runs upward through a level.
    """
    points, faces, gates = mesh.points, mesh.faces, state.gates
    height, tie_x, tie_y = levels.height, levels.tie_x, levels.tie_y
    ends, place, labelled = faces.ravel(), 0, len(crossings.label) > 0
    level, start, edge = [np.int32(0) for _ in range(0)], [np.int64(0)], [np.int32(0) for _ in range(0)]
    for k in range(first, end):
        _move_up(mesh, slab, k, len(height), state)
        i, full = 0, place + state.progress[1]
        while place < full:
            f = np.int64(state.active[i, 0])
            i += 1
            if gates[f, 3] == k:
                continue
            level.append(np.int32(k))
            edge.append(np.int32(3 * f + (k >= gates[f, 0])))
            while gates[f, 3] != k:
                gates[f, 3] = k
                second = np.int64(k >= gates[f, 0])
                low, high = ends[3 * f + second], ends[3 * f + second + 1]
                out[place, 0], out[place, 1] = cross_at(points[low], points[high], height[k], tie_x[k], tie_y[k])
                place += 1
                if labelled:
                    crossings.label[crossings.offset[f] + k - slab[faces[f, 0]]] = len(level) - 1
                f = np.int64(gates[f, 1 + second])
            start.append(place)
    return np.array(level, np.int32), np.array(start, np.int64), np.array(edge, np.int32)


@njit(inner=True)
def _move_up(mesh, slab, k, n_levels, state):
    """Let go of the faces that are below level k and take in those that it is the first to cross."""
    faces, twins = mesh.faces, mesh.twins
    gates, active, progress = state.gates, state.active, state.progress
    f, kept = progress[0], 0
    for i in range(progress[1]):
        active[kept, 0], active[kept, 1] = active[i, 0], active[i, 1]
        kept += active[i, 1] >= k
    while f < faces.shape[0] and slab[faces[f, 0]] <= k:  # faces ascend by their lowest corner
        b, c = faces[f, 1], faces[f, 2]
        top = slab[max(b, c)]
        if top > k:
            gates[f, 0] = slab[b] if b < c else n_levels
            gates[f, 1], gates[f, 2], gates[f, 3] = twins[3 * f] // 3, twins[3 * f + 1] // 3, -1
            active[kept, 0], active[kept, 1] = f, top - 1
            kept += 1
        f += 1
    progress[0], progress[1] = f, kept


def measure_contours(contours):
    """Measure the signed area and the perimeter of every contour.

    Parameters
    ----------
    contours : Contours
        C contours.

    Returns
    -------
    area : (C,) float64
        Shoelace formula relative to a point of the contour, so that nothing cancels; negative for holes.
    perimeter : (C,) float64
        Length, mesh units.
    """
    return _measure(contours.points, contours.start)


@njit
def _measure(points, start):
    """Kernel of `measure_contours`."""
    n = len(start) - 1
    area, perimeter = np.zeros(n), np.zeros(n)
    for c in range(n):
        x0, y0 = points[start[c]]  # relative to a point of the contour: no cancellation
        px, py = points[start[c + 1] - 1, 0] - x0, points[start[c + 1] - 1, 1] - y0
        for i in range(start[c], start[c + 1]):
            qx, qy = points[i, 0] - x0, points[i, 1] - y0
            area[c] += 0.5 * (px * qy - py * qx)
            perimeter[c] += np.hypot(qx - px, qy - py)
            px, py = qx, qy
    return area, perimeter
