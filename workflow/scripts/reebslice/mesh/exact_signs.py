"""Signs of determinants of points, exact: a filter in floating point, then expansions (doi:10.1007/PL00009321).

The filter's bounds are Shewchuk's A bounds, (3 + 16 e) e and (7 + 56 e) e with
e = 2^-53, rounded up. An expansion is a sum of floats that do not overlap, the
smallest first: its sign is that of its last component. All of it holds where
no product overflows or underflows, which `scale_points` sees to.
"""

import numpy as np

from ..kernels import njit

PLANE_BOUND = 8e-16  # of the sum of absolute terms; Shewchuk's is 7.7716e-16
LINE_BOUND = 4e-16  # Shewchuk's is 3.3307e-16
UNDERFLOW = 1e-280  # far above what underflow can lose, far below what points of some size give
LARGEST, SMALLEST = 300, -300  # exponents of coordinates whose triple products are exact in expansions
ROOM = 256  # components: more than the 192 that a determinant can have
SPLITTER = 134217729.0  # 2^27 + 1


def scale_points(points):
    """Scale points by a power of two, so that products of three differences neither overflow nor underflow.

    Parameters
    ----------
    points : (n, 3) float64
        Finite.

    Returns
    -------
    (n, 3) float64
        The same points in another unit, exactly; but coordinates below 2^-600
        of the largest one are 0.
    """
    largest = np.abs(points).max(initial=0.0)
    if largest == 0:
        return np.zeros(points.shape)
    scaled = np.ldexp(points, LARGEST - int(np.frexp(largest)[1]))
    scaled[np.abs(scaled) < 2.0**SMALLEST] = 0.0
    return scaled


@njit(inline="always")
def bounded_turn(p, q, r, s, t, u):
    """Twice the signed area of the triangle (p, q), (r, s), (t, u); 0.0 if rounding leaves its sign open.

    Parameters
    ----------
    p, q, r, s, t, u : float

    Returns
    -------
    float
        Positive if the corners are counter-clockwise.
    """
    one, two = (p - t) * (s - u), (q - u) * (r - t)
    turn = one - two
    return turn if abs(turn) > LINE_BOUND * (abs(one) + abs(two)) + UNDERFLOW else 0.0


@njit
def turn_sign(points, corners, axis, work):
    """Sign of the area of three points seen along an axis, exact.

    Parameters
    ----------
    points : (n, 3) float64
        Of `scale_points`.
    corners : tuple of 3 int
    axis : int
        The coordinate to leave out.
    work : (ROOM,) float64
        Overwritten.

    Returns
    -------
    int
        +1 if they are counter-clockwise in the other two coordinates, in cyclic
        order, -1 if clockwise, 0 if in line.
    """
    i, j, k = corners
    x, y = (axis + 1) % 3, (axis + 2) % 3
    turn = bounded_turn(points[i, x], points[i, y], points[j, x], points[j, y], points[k, x], points[k, y])
    if turn != 0:
        return 1 if turn > 0 else -1
    if i == j or j == k or k == i:
        return 0
    ax, bx = _two_difference(points[i, x], points[k, x]), _two_difference(points[j, x], points[k, x])
    ay, by = _two_difference(points[i, y], points[k, y]), _two_difference(points[j, y], points[k, y])
    n = 0
    for s in range(2):
        for t in range(2):
            n = _add_pair(work, n, ax[s], by[t], 1.0)
            n = _add_pair(work, n, ay[s], bx[t], -1.0)
    return _sign(work, n)


@njit
def side_sign(points, plane, v, work):
    """Side of the plane through three points that a fourth one is on, exact.

    Parameters
    ----------
    points : (n, 3) float64
        Of `scale_points`.
    plane : tuple of 3 int
    v : int
    work : (ROOM,) float64
        Overwritten.

    Returns
    -------
    int
        +1 if the points of the plane are counter-clockwise seen from the fourth, -1 if clockwise, 0 if
        it is on their plane or they are in line.
    """
    i, j, k = plane
    if v in (i, j, k) or i == j or j == k or k == i:
        return 0
    ux, uy, uz = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
    vx, vy, vz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
    wx, wy, wz = points[v, 0] - points[i, 0], points[v, 1] - points[i, 1], points[v, 2] - points[i, 2]
    side = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx)
    terms = abs(wx) * (abs(uy * vz) + abs(uz * vy)) + abs(wy) * (abs(uz * vx) + abs(ux * vz))
    terms += abs(wz) * (abs(ux * vy) + abs(uy * vx))
    if abs(side) > PLANE_BOUND * terms + UNDERFLOW:
        return 1 if side > 0 else -1
    return _exact_side(points, plane, v, work)


@njit(inner=True)
def _exact_side(points, plane, v, work):
    """As `side_sign`, in expansions."""
    i, j, k = plane
    n = 0
    for x in range(3):
        y, z = (x + 1) % 3, (x + 2) % 3
        wx = _two_difference(points[v, x], points[i, x])
        uy, uz = _two_difference(points[j, y], points[i, y]), _two_difference(points[j, z], points[i, z])
        vy, vz = _two_difference(points[k, y], points[i, y]), _two_difference(points[k, z], points[i, z])
        for r in range(2):
            if wx[r] == 0:
                continue
            for s in range(2):
                for t in range(2):
                    n = _add_triple(work, n, uy[s], vz[t], wx[r])
                    n = _add_triple(work, n, uz[s], vy[t], -wx[r])
    return _sign(work, n)


@njit(inline="always")
def _two_difference(a, b):
    """The rounded difference, and what rounding took off."""
    difference = a - b
    virtual = a - difference
    return difference, (a - (difference + virtual)) + (virtual - b)


@njit(inline="always")
def _two_product(a, b):
    """The rounded product, and what rounding took off (Dekker, Veltkamp)."""
    product = a * b
    c, d = SPLITTER * a, SPLITTER * b
    high, top = c - (c - a), d - (d - b)
    low, rest = a - high, b - top
    return product, low * rest - (((product - high * top) - low * top) - high * rest)


@njit(inner=True)
def _grow(work, n, b):
    """Add a float to the expansion of n components; returns their new number."""
    kept = 0
    for i in range(n):
        total = b + work[i]
        virtual = total - b
        rest = (b - (total - virtual)) + (work[i] - virtual)
        b = total
        if rest != 0:
            work[kept] = rest
            kept += 1
    if b != 0:
        work[kept] = b
        kept += 1
    return kept


@njit(inner=True)
def _add_pair(work, n, a, b, sign):
    """Add sign * a * b, where sign is 1.0 or -1.0."""
    if a == 0 or b == 0:
        return n
    high, low = _two_product(sign * a, b)
    return _grow(work, _grow(work, n, low), high)


@njit(inner=True)
def _add_triple(work, n, a, b, c):
    """Add a * b * c."""
    if a == 0 or b == 0:
        return n
    high, low = _two_product(a, b)
    for factor in (low, high):
        if factor != 0:
            top, rest = _two_product(factor, c)
            n = _grow(work, _grow(work, n, rest), top)
    return n


@njit(inline="always")
def _sign(work, n):
    if n == 0:
        return 0
    return 1 if work[n - 1] > 0 else -1
