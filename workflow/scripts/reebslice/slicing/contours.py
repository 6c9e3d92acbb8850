"""Level sets of a surface as closed, oriented contours.

A face that a level crosses has one crossing on the mesh edge that runs upward
in it, so a crossing is a (face, level) pair. The next crossing on its contour
lies in the face across that edge, and the contours are the cycles of a
permutation: closed, oriented with material on the left, without comparing any
coordinates. A plane sweeps upward and keeps the faces that it crosses, so time
grows as faces + crossings, and levels can be had a block at a time.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..arrays.grouping import split_into_blocks
from ..errors import TooManyCrossingsError
from ..morse.ordered_mesh import cross_at
from .levels import vertex_slabs

# A cut holds 20 bytes of each crossing, its point and its label: 5 GB of so many, and the
# stages that read all contours back hold several times that. trace_blocks knows no bound.
MOST_CROSSINGS = 250_000_000


class Contours(NamedTuple):
    """C contours, ordered by level and then by their first crossing.

    level : (C,) int32
    start : (C + 1,) int64, contour c owns points[start[c]:start[c + 1]]
    points : (X, 2) float64, tilted frame, in order along the contours
    first : (C,) int32, the half-edge, running upward, of each contour's first point
    lower, upper : (C,) int32, ranks of its ends
    """

    level: np.ndarray
    start: np.ndarray
    points: np.ndarray
    first: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


class Crossings(NamedTuple):
    """Which contour crosses each face at each level.

    offset : (m + 1,) int64, label[offset[f] + j] is the contour that crosses
        face f at the j-th level above its lowest corner
    label : (X,) int32
    """

    offset: np.ndarray
    label: np.ndarray


NO_CROSSINGS = Crossings(np.zeros(1, np.int64), np.zeros(0, np.int32))


def trace_contours(mesh, levels):
    """All contours of all levels: :class:`Contours`.

    Every contour is closed, has material on its left seen from +z, and starts
    at its first crossing in the order of half-edges, so the result does not
    depend on the order of vertices or faces in the input. Raises
    TooManyCrossingsError before it takes the memory for them.
    """
    return _trace_at_once(mesh, levels, NO_CROSSINGS)


def trace_crossings(mesh, levels):
    """The same, and the way from faces to contours: (:class:`Contours`, :class:`Crossings`)."""
    offset = _first_crossings(mesh.faces, vertex_slabs(mesh, levels))
    _refuse_too_many(levels, offset[-1])
    crossings = Crossings(offset, np.empty(offset[-1], np.int32))
    return _trace_at_once(mesh, levels, crossings), crossings


def trace_blocks(mesh, levels, most_crossings):
    """All contours, of a few consecutive levels at a time: an iterator of :class:`Contours`.

    A block has at most `most_crossings` points, or one level. Levels keep
    their numbers; contour c of a block is the one of number c + contours of
    the blocks before in what trace_contours makes of all levels, to the last
    bit. Beyond the mesh and a block it takes some 20 bytes a face.
    """
    count = _count_crossings(mesh.faces, vertex_slabs(mesh, levels), len(levels.height))
    return _sweep(mesh, levels, NO_CROSSINGS, count, split_into_blocks(np.cumsum([0, *count]), most_crossings))


def _trace_at_once(mesh, levels, crossings):
    count = _count_crossings(mesh.faces, vertex_slabs(mesh, levels), len(levels.height))
    _refuse_too_many(levels, count.sum())
    return next(_sweep(mesh, levels, crossings, count, [(0, len(count))]))


def _refuse_too_many(levels, crossings):
    if crossings > MOST_CROSSINGS:
        raise TooManyCrossingsError(f"{len(levels.height)} levels cross the mesh edges {crossings} times")


def _sweep(mesh, levels, crossings, count, blocks):
    """Contours of each block of levels; count : (K,) crossings of each level."""
    slab = vertex_slabs(mesh, levels)
    gates, active = np.empty((len(mesh.faces), 4), np.int32), np.empty((int(count.max(initial=0)), 2), np.int32)
    progress = np.zeros(2, np.int64)
    ends = mesh.faces.ravel()
    for first, end in blocks:
        points = np.empty((int(count[first:end].sum()), 2))
        level, start, edge = _trace_levels(
            mesh.points, mesh.faces, mesh.twins, slab, levels.height, levels.tie_x, levels.tie_y, first, end,
            gates, active, progress, crossings.offset, crossings.label, points,
        )  # fmt: skip
        yield Contours(level, start, points, edge, ends[edge], ends[edge + 1])


@njit(cache=True)
def _first_crossings(faces, slab):
    """How many crossings the faces before each one have, (m + 1,) int64."""
    offset = np.zeros(faces.shape[0] + 1, np.int64)
    for f in range(faces.shape[0]):
        offset[f + 1] = offset[f] + slab[max(faces[f, 1], faces[f, 2])] - slab[faces[f, 0]]
    return offset


@njit(cache=True)
def _count_crossings(faces, slab, n_levels):
    """Crossings of each level, (K,) int64: faces entered so far less those left."""
    count = np.zeros(n_levels + 1, np.int64)
    for f in range(faces.shape[0]):
        count[slab[faces[f, 0]]] += 1  # the first corner is the lowest
        count[slab[max(faces[f, 1], faces[f, 2])]] -= 1
    return np.cumsum(count)[:-1]


@njit(cache=True)
def _trace_levels(
    points, faces, twins, slab, height, tie_x, tie_y, first, end, gates, active, progress, offset, label, out
):  # fmt: skip
    """Contours of the levels from `first` up to `end`: their levels, starts and first half-edges.

    Fills in `out`, and `label` unless it is empty. What is kept from block to block:
    gates : (m, 4) int32 per face that a level crosses: the level from which
        on its second mesh edge runs through it and not the first, the faces
        across these two, the last level at which it was crossed
    active : faces that the level crosses, ascending, and the last level to do so
    progress : the first face not yet reached, the number of active ones
    """
    ends, place = faces.ravel(), 0
    level, start, edge = [np.int32(0) for _ in range(0)], [np.int64(0)], [np.int32(0) for _ in range(0)]
    for k in range(first, end):
        _move_up(faces, twins, slab, k, len(height), gates, active, progress)
        i, full = 0, place + progress[1]
        while place < full:
            f = np.int64(active[i, 0])
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
                if len(label) > 0:
                    label[offset[f] + k - slab[faces[f, 0]]] = len(level) - 1
                f = np.int64(gates[f, 1 + second])
            start.append(place)
    return np.array(level, np.int32), np.array(start, np.int64), np.array(edge, np.int32)


@njit(cache=True)
def _move_up(faces, twins, slab, k, n_levels, gates, active, progress):
    """Let go of the faces that are below level k and take in those that it is the first to cross."""
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
    """Signed area and perimeter of every contour, two (C,) float64 arrays."""
    return _measure(contours.points, contours.start)


@njit(cache=True)
def _measure(points, start):
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
