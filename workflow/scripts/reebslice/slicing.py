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
    depend on the order of vertices or faces in the input.
    """
    slab = vertex_slabs(mesh, levels)
    offset = _count_crossings(mesh.faces, slab)
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


# A sum of areas smaller than this share of its terms is rounding.
CANCELS = 1e-9


def emerging_areas(mesh, levels, contours, chosen):
    """Signs of contours that enclose nothing in their plane, (k,) float64 in [-1, 1].

    Such contours lie inside flats, or at a level just above an extremum. In
    the infinitesimally tilted plane their area is of the order of the tilt,
    or of its square. Returned is the leading order's coefficient as a share
    of its terms: its sign is that of the area, its size says how surely; 0
    where both orders vanish. At an ordinary level the plane is not tilted but
    lifted by an infinitesimal height.
    """
    return _emerging_areas(
        mesh.points, mesh.faces, mesh.twins, vertex_slabs(mesh, levels), contours.offset, contours.label,
        contours.level, levels.height, levels.tie_x, levels.tie_y, np.asarray(chosen, np.int64),
    )  # fmt: skip


@njit(cache=True)
def _emerging_areas(points, faces, twins, slab, offset, label, level, height, tie_x, tie_y, chosen):
    first = np.full(len(level), -1, np.int64)
    for h in range(3 * faces.shape[0]):
        for i in range(offset[h], offset[h + 1]):
            if first[label[i]] < 0:
                first[label[i]] = h
    out = np.zeros(len(chosen))
    last, now = np.zeros((3, 2)), np.zeros((3, 2))  # a crossing's place by orders of the tilt
    for place in range(len(chosen)):
        k, start = level[chosen[place]], first[chosen[place]]
        total, size = np.zeros(2), np.zeros(2)
        h, began = start, False
        while True:
            low, high = points[faces[h // 3, h % 3]], points[faces[h // 3, (h % 3 + 1) % 3]]
            rates = _crossing_orders(low, high, height[k], tie_x[k], tie_y[k])
            for axis in range(2):
                now[0, axis] = low[axis] - points[faces[start // 3, start % 3], axis]
                for order in range(3):
                    step = rates[order] * (high[axis] - low[axis])
                    now[order, axis] = now[order, axis] + step if order == 0 else step
            if began:
                for order in range(1, 3):
                    for part in range(order + 1):
                        term = last[part, 0] * now[order - part, 1] - last[part, 1] * now[order - part, 0]
                        total[order - 1] += term
                        size[order - 1] += abs(term)
                if h == start:
                    break
            began = True
            last[:] = now
            h = _next_crossing(faces, twins, slab, h, k)
        for order in range(2):
            if abs(total[order]) > CANCELS * size[order]:
                out[place] = total[order] / size[order]
                break
    return out


@njit(cache=True, inline="always")
def _crossing_orders(low, high, z, x, y):
    """Where on the mesh edge the crossing lies, by orders of the tilt e: t0 + t1 e + t2 e^2.

    The height is z + e x + e^2 y. Where the ends tie in z, one order cancels;
    at an ordinary level (x is NaN) e lifts the plane instead.
    """
    rise = (high[2] - low[2], high[0] - low[0], high[1] - low[1])
    if np.isnan(x):
        t = (z - low[2]) / rise[0]
        return t, 1.0 / rise[0], 0.0
    part = (z - low[2], x - low[0], y - low[1])
    for tied in range(3):
        if rise[tied] > 0.0:
            t0 = part[tied] / rise[tied]
            t1 = (part[tied + 1] - t0 * rise[tied + 1]) / rise[tied] if tied < 2 else 0.0
            t2 = (part[2] - t0 * rise[2] - t1 * rise[1]) / rise[0] if tied == 0 else 0.0
            if tied == 1:
                t2 = -t1 * rise[2] / rise[1]
            return t0, t1, t2
    return 0.5, 0.0, 0.0
