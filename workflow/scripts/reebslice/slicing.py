"""Level sets of a surface as closed, oriented contours.

A crossing is a (mesh edge, level) pair, stored on the half-edge that runs
upward. The crossings of one half-edge cover consecutive levels, so a crossing
is an offset plus a level, the next one on its contour lies on the face across
the edge, and the contours are the cycles of a permutation: closed, oriented
with material on the left, without comparing any coordinates. Time and memory
grow as faces + crossings.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .heightmesh import cross_at


# Beyond these, contours and what is made of them fill more memory (some 60
# bytes a crossing) than most machines have.
MOST_CROSSINGS = 250_000_000


class TooManyCrossings(ValueError):
    """The levels cross the mesh edges more than MOST_CROSSINGS times; the text says how often."""


class Levels(NamedTuple):
    """Horizontal cuts in ascending order, K of them.

    height : (K,) float64
    below : (K,) int32, vertices below: rank r is above level k iff r >= below[k]
    tie_x, tie_y : (K,) float64; where, inside the vertices at exactly this
        height, the cut runs; NaN for an ordinary level
    """

    height: np.ndarray
    below: np.ndarray
    tie_x: np.ndarray
    tie_y: np.ndarray


class Contours(NamedTuple):
    """C contours, ordered by level and then by their first crossing.

    level : (C,) int32
    start : (C + 1,) int64, contour c owns points[start[c]:start[c + 1]]
    points : (X, 2) float64, tilted frame, in order along the contours
    lower, upper : (C,) int32 ranks of the ends of each contour's first mesh edge
    offset : (3 m + 1,) int64, label[offset[h] + j] is the contour that crosses
        half-edge h at its j-th level
    label : (X,) int32
    """

    level: np.ndarray
    start: np.ndarray
    points: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    offset: np.ndarray
    label: np.ndarray


def vertex_slabs(mesh, levels):
    """Number of levels below every vertex, (n,) int32: 0 is below them all."""
    ranks = np.arange(len(mesh.points))
    return np.searchsorted(levels.below, ranks, side="right").astype(np.int32)


def trace_contours(mesh, levels):
    """All contours of all levels: :class:`Contours`.

    Every contour is closed, has material on its left seen from +z, and starts
    at its first crossing in the order of half-edges, so the result does not
    depend on the order of vertices or faces in the input. Raises
    TooManyCrossings before it takes the memory for them.
    """
    slab = vertex_slabs(mesh, levels)
    offset = _count_crossings(mesh.faces, slab)
    if offset[-1] > MOST_CROSSINGS:
        raise TooManyCrossings(f"{len(levels.height)} levels cross the mesh edges {offset[-1]} times")
    label, level, first = _walk_contours(mesh.faces, mesh.twins, slab, offset)
    order = np.argsort(level, kind="stable")
    rename = np.empty(len(order), np.int32)
    rename[order] = np.arange(len(order), dtype=np.int32)
    label, level, first = rename[label], level[order], first[order]
    start = np.zeros(len(level) + 1, np.int64)
    np.cumsum(np.bincount(label, minlength=len(level)), out=start[1:])
    points = _trace_points(
        mesh.points, mesh.faces, mesh.twins, slab, level, first, start,
        levels.height, levels.tie_x, levels.tie_y,
    )  # fmt: skip
    lower = mesh.faces.ravel()[first] if len(first) else np.zeros(0, np.int32)
    face, corner = np.divmod(first, 3)
    return Contours(level, start, points, lower, mesh.faces[face, (corner + 1) % 3], offset, label)


@njit(cache=True)
def _count_crossings(faces, slab):
    m = faces.shape[0]
    offset = np.zeros(3 * m + 1, np.int64)
    for f in range(m):
        for k in range(3):
            low, high = faces[f, k], faces[f, (k + 1) % 3]
            rise = slab[high] - slab[low] if low < high else 0
            offset[3 * f + k + 1] = offset[3 * f + k] + rise
    return offset


@njit(cache=True, inline="always")
def _next_crossing(faces, twins, slab, h, level):
    """The upward half-edge at which the contour through (h, level) crosses next."""
    down = twins[h]
    face, corner = down // 3, down % 3
    third = faces[face, (corner + 2) % 3]
    return 3 * face + (corner + 1) % 3 if slab[third] > level else 3 * face + (corner + 2) % 3


@njit(cache=True)
def _walk_contours(faces, twins, slab, offset):
    """Contour of every crossing, level and first half-edge of every contour."""
    label = np.full(offset[-1], -1, np.int32)
    level, first = [np.int32(0) for _ in range(0)], [np.int64(0) for _ in range(0)]
    for h in range(3 * faces.shape[0]):
        if offset[h + 1] == offset[h]:
            continue
        base = slab[faces[h // 3, h % 3]]
        for j in range(offset[h + 1] - offset[h]):
            if label[offset[h] + j] >= 0:
                continue
            k = base + j
            name = len(level)
            level.append(np.int32(k))
            first.append(h)
            g = h
            while True:
                label[offset[g] + k - slab[faces[g // 3, g % 3]]] = name
                g = _next_crossing(faces, twins, slab, g, k)
                if g == h:
                    break
    return label, np.array(level, np.int32), np.array(first, np.int64)


@njit(cache=True)
def _trace_points(points, faces, twins, slab, level, first, start, height, tie_x, tie_y):
    out = np.empty((start[-1], 2))
    for c in range(len(level)):
        k, h = level[c], first[c]
        for place in range(start[c], start[c + 1]):
            low, high = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
            x, y = cross_at(points[low], points[high], height[k], tie_x[k], tie_y[k])
            out[place, 0], out[place, 1] = x, y
            h = _next_crossing(faces, twins, slab, h, k)
    return out


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
