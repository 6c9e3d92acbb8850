"""Cut quads along the diagonal that does not fold, the same one from any first corner and of either winding.

All sums and products come out the same to the last bit from whichever corner they begin.
"""

import numpy as np

from ..kernels import njit
from .flat_polygons import THIN, compare

FOLDED = 1e-6  # of a polygon's size squared: triangles may cover no more than this beyond the polygon's area
STRAIGHT = 1e-9  # of an area, and sine of an angle: what is below is no ear for sure


@njit(inner=True)
def cut_quad(points, quad, faces):
    """Cut one quad.

    Parameters
    ----------
    points : (n, 3) float64
    quad : (4,) ids of points.
    faces : (2, 3) filled with the triangles.

    Returns
    -------
    bool, float
        Whether both diagonals fold, seen along the normal: a flat quad then
        crosses itself, and the sides of a bent one pass each other; how far its
        corners are off a plane, relative to the diagonal of its box. A bent
        quad is cut along the diagonal that folds less.
    """
    a, b, c, d = quad
    x, y, z = _cross(points, a, c, b, d)
    area, size = x * x + y * y + z * z, _measure_box(points, a, b, c, d)
    length = np.sqrt(area)
    if not length > THIN * size:
        bend, crossed = 0.0, _length(_cross(points, a, b, a, c)) + _length(_cross(points, a, c, a, d)) > FOLDED * size
        first = _is_first_shorter(points, a, b, c, d)
    else:
        normal = (x, y, z)
        from_a = min(_dot(_cross(points, b, c, b, a), normal), _dot(_cross(points, d, a, d, c), normal))
        from_b = min(_dot(_cross(points, a, b, a, d), normal), _dot(_cross(points, c, d, c, b), normal))
        sure = min(from_a, from_b) > STRAIGHT * area or from_a == from_b
        first = _is_first_shorter(points, a, b, c, d) if sure else from_a > from_b
        rise = _dot((points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]), normal)
        bend = abs(rise) / length / 2 / np.sqrt(size)
        crossed = max(from_a, from_b) < -FOLDED * size * length
    i = 0 if first else 1
    for t in range(2):
        faces[t, 0], faces[t, 1], faces[t, 2] = quad[i], quad[i + t + 1], quad[(i + t + 2) % 4]
    return crossed, bend


@njit(inner=True)
def _is_first_shorter(points, a, b, c, d):
    """Tell whether diagonal ac is shorter than bd, or as long and at the least corner by coordinates."""
    ac = bd = 0.0
    for axis in range(3):
        ac += (points[c, axis] - points[a, axis]) ** 2
        bd += (points[d, axis] - points[b, axis]) ** 2
    if ac != bd:
        return ac < bd
    one, other = a if compare(points, a, c) <= 0 else c, b if compare(points, b, d) <= 0 else d
    return compare(points, one, other) <= 0


@njit(inline="always")
def _cross(points, a, b, c, d):
    """The cross product of the ways from a to b and from c to d."""
    ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    vx, vy, vz = points[d, 0] - points[c, 0], points[d, 1] - points[c, 1], points[d, 2] - points[c, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@njit(inline="always")
def _dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


@njit(inline="always")
def _length(u):
    return np.sqrt(_dot(u, u))


@njit(inline="always")
def _measure_box(points, a, b, c, d):
    """The squared diagonal of the box around four points."""
    size = 0.0
    for axis in range(3):
        low = min(points[a, axis], points[b, axis], points[c, axis], points[d, axis])
        high = max(points[a, axis], points[b, axis], points[c, axis], points[d, axis])
        size += (high - low) ** 2
    return size
