"""Lay polygons flat along their Newell normals, in an order of corners that depends on their coordinates alone.

References: I. E. Sutherland, R. F. Sproull, R. A. Schumacker, A characterization of ten hidden-surface algorithms, ACM
Computing Surveys 6 (1974): Newell's normal. J. P. Duval, Factorizing words over an ordered alphabet, Journal of
Algorithms 4 (1983): least rotation in linear time.
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit

THIN = 1e-14  # of the size squared: an area below has no plane


class Flat(NamedTuple):
    """A polygon in its plane.

    Attributes
    ----------
    turned : whether its corners were taken backward.
    area : twice the area there, positive; 0 if there is no plane.
    reach : squared diagonal of its box there; of its box in space if there is no plane.
    spread : sum of the areas, doubled, of the fan from its first corner, in space.
    bend : largest distance of a corner from the plane, relative to the diagonal of its box in space.
    """

    turned: bool
    area: float
    reach: float
    spread: float
    bend: float


@njit
def lay_flat(points, ids, order, places):
    """Lay a polygon into its plane.

    Parameters
    ----------
    points : (n, 3) float64
    ids : (c,) its corners.
    order : (>= c,) filled with the ids in an order that depends on coordinates alone, whatever the first corner and
        the winding.
    places : (>= c, 2) filled with where they lie, counter-clockwise. Two coordinates of space carry the plane: corners
        move along the normal, so that all areas shrink alike.

    Returns
    -------
    Flat
    """
    start, step = _find_start(points, ids)
    n = len(ids)
    at = start
    for i in range(n):
        order[i] = ids[at]
        at = at + step if 0 <= at + step < n else at + step - n * step
    x, y, z, spread = _sum_areas(points, order[:n])
    size, length = _measure_box(points, order[:n]), np.sqrt(x * x + y * y + z * z)
    if not length > THIN * size:
        return Flat(step < 0, 0.0, size, spread, 0.0)
    steepest = max(abs(x), abs(y), abs(z))
    k = 0 if abs(x) == steepest else 1 if abs(y) == steepest else 2
    normal = (x / length, y / length, z / length)
    bend, reach = _project(points, order[:n], normal, k, places)
    return Flat(step < 0, length * length / steepest, reach, spread, bend / np.sqrt(size))


@njit(inner=True)
def _sum_areas(points, order):
    """Sum the areas of the fan from the first corner, doubled: as vectors (Newell's normal), and their lengths."""
    x = y = z = spread = 0.0
    o, p = order[0], order[1]
    bx, by, bz = points[p, 0] - points[o, 0], points[p, 1] - points[o, 1], points[p, 2] - points[o, 2]
    for i in range(2, len(order)):
        q = order[i]
        cx, cy, cz = points[q, 0] - points[o, 0], points[q, 1] - points[o, 1], points[q, 2] - points[o, 2]
        ax, ay, az = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
        x, y, z, spread = x + ax, y + ay, z + az, spread + np.sqrt(ax * ax + ay * ay + az * az)
        bx, by, bz = cx, cy, cz
    return x, y, z, spread


@njit(inner=True)
def _measure_box(points, order):
    """Return the squared diagonal of the box around corners."""
    size = 0.0
    for axis in range(3):
        low = high = points[order[0], axis]
        for v in order:
            low, high = min(low, points[v, axis]), max(high, points[v, axis])
        size += (high - low) ** 2
    return size


@njit(inner=True)
def _project(points, order, normal, k, places):
    """Move corners along the normal to coordinate plane k.

    Returns the largest distance from the plane through their centre, and the squared diagonal of their box there.
    """
    i, j = ((k + 1) % 3, (k + 2) % 3) if normal[k] > 0 else ((k + 2) % 3, (k + 1) % 3)
    o = order[0]
    low_u = high_u = low_v = high_v = low = high = total = 0.0
    for c in range(len(order)):
        p = order[c]
        u, v, w = points[p, i] - points[o, i], points[p, j] - points[o, j], points[p, k] - points[o, k]
        distance = u * normal[i] + v * normal[j] + w * normal[k]
        u, v = u - w / normal[k] * normal[i], v - w / normal[k] * normal[j]
        places[c, 0], places[c, 1] = u, v
        low_u, high_u, low_v, high_v = min(low_u, u), max(high_u, u), min(low_v, v), max(high_v, v)
        low, high, total = min(low, distance), max(high, distance), total + distance
    bend = max(high - total / len(order), total / len(order) - low)
    return bend, (high_u - low_u) ** 2 + (high_v - low_v) ** 2


# --------------------------------------------------------------------------
# The order of corners


@njit(inner=True)
def _find_start(points, ids):
    """Find the corner, and the way +1 or -1 around, that give the least sequence of coordinates."""
    n, least, alone = len(ids), 0, True
    for i in range(1, n):
        order = compare(points, ids[i], ids[least])
        if order <= 0:
            least, alone = i, order < 0
    if alone:
        order = compare(points, ids[least + 1 if least + 1 < n else 0], ids[least - 1 if least > 0 else n - 1])
        if order != 0:
            return least, -order
    ahead, back = _find_least(points, ids, 1), _find_least(points, ids, -1)
    for k in range(n):
        order = compare(points, ids[(ahead + k) % n], ids[(back - k) % n])
        if order != 0:
            return (ahead, 1) if order < 0 else (back, -1)
    return ahead, 1


@njit(inner=True)
def _find_least(points, ids, step):
    """Find where the least rotation of a cyclic sequence begins, in linear time."""
    n, i, j, k = len(ids), 0, 1, 0
    while i < n and j < n and k < n:
        order = compare(points, ids[step * (i + k) % n], ids[step * (j + k) % n])
        if order == 0:
            k += 1
            continue
        if order > 0:
            i += k + 1
        else:
            j += k + 1
        if i == j:
            j += 1
        k = 0
    return step * min(i, j) % n


@njit
def compare(points, a, b):
    """Compare points by x, then y, then z: -1, 0 or 1."""
    for axis in range(3):
        if points[a, axis] != points[b, axis]:
            return -1 if points[a, axis] < points[b, axis] else 1
    return 0
