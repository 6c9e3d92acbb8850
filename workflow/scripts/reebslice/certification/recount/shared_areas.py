"""Areas that pairs of regions share, without their intersections.

How often a region covers a point is how often its outline runs upward to the
right of it, less how often it runs downward. So the area that two regions share
is the sum over pairs of upright chains, one of each outline, of the area
left of both, counted with the signs of their directions. Nothing is decided by
coordinates: whatever meets, touches or coincides, the sum is continuous, and
wrong by no more than the rounding of its terms.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit


class Chains(NamedTuple):
    """Outlines cut into H chains that only rise or only fall, by region.

    lowest, highest : (H,) the point of each that is lowest, and highest; those between run from one to the other
    bottom, top : (H,) float64, their heights in the plane
    sign : (H,) +1 where the region is left of the chain, -1 where it is right of it
    begin : (R + 1,) the first chain of each region
    """

    lowest: np.ndarray
    highest: np.ndarray
    bottom: np.ndarray
    top: np.ndarray
    sign: np.ndarray
    begin: np.ndarray


def find_chains(points, first, ring, region, turn, n_regions):
    """Cut the outlines of regions into chains.

    Parameters
    ----------
    points, first
        Of :class:`Curves`.
    ring : (Q,) int
        The curves that bound a region, by region.
    region : (Q,) int
        Of each.
    turn : (Q,) int
        +1 where the region is left of the curve as it is drawn, -1 where it is right of it.
    n_regions : int

    Returns
    -------
    Chains
    """
    lowest, highest, owner = _find_chains(points, first, ring)
    sign, begin = (
        np.where(lowest < highest, 1, -1) * turn[owner],
        np.searchsorted(region[owner], np.arange(n_regions + 1)),
    )
    return Chains(lowest, highest, points[lowest, 1], points[highest, 1], sign, begin)


@njit
def _find_chains(points, first, ring):
    """Lowest and highest point of each chain, and the ring that it is of."""
    lowest, highest, owner = [0 for _ in range(0)], [0 for _ in range(0)], [0 for _ in range(0)]
    for q in range(len(ring)):
        begin, end, way = first[ring[q]], first[ring[q] + 1] - 1, 0.0
        for k in range(begin, end + 1):
            step = points[k + 1, 1] - points[k, 1] if k < end else 0.0
            if k == end or step * way < 0:
                if way != 0:
                    lowest.append(begin if way > 0 else k)
                    highest.append(k if way > 0 else begin)
                    owner.append(q)
                begin, way = k, 0.0
            if way == 0:
                way = np.sign(step)
    return np.array(lowest), np.array(highest), np.array(owner)


@njit
def share_areas(points, chains, one, other):
    """Measure the areas that pairs of regions share.

    Parameters
    ----------
    points : (N, 2) float64
        Of the curves.
    chains : Chains
    one, other : (E,) int
        The regions.

    Returns
    -------
    (E,) float64
    """
    lowest, highest, bottom, top, sign, begin = chains
    shared = np.zeros(len(one))
    for e in range(len(one)):
        for i in range(begin[one[e]], begin[one[e] + 1]):
            base = points[lowest[begin[one[e]]], 0]  # seen from here, little cancels
            for j in range(begin[other[e]], begin[other[e] + 1]):
                if bottom[i] < top[j] and bottom[j] < top[i]:
                    both = _left_of_both(points, (lowest[i], highest[i]), (lowest[j], highest[j]), base)
                    shared[e] += sign[i] * sign[j] * both
    return shared


@njit(inner=True)
def _left_of_both(points, one, other, base):
    """Area left of two chains, (lowest, highest), as high as both reach, from an upright line at `base`."""
    (p, p_end), (q, q_end) = one, other
    up, on = 1 if p_end > p else -1, 1 if q_end > q else -1
    y, top, total = max(points[p, 1], points[q, 1]), min(points[p_end, 1], points[q_end, 1]), 0.0
    p, q = _last_below(points, p, up, abs(p_end - p), y), _last_below(points, q, on, abs(q_end - q), y)
    while y < top:
        following = min(points[p + up, 1], points[q + on, 1], top)
        a, b = _cross(points, p, p + up, y) - base, _cross(points, q, q + on, y) - base
        c, d = _cross(points, p, p + up, following) - base, _cross(points, q, q + on, following) - base
        before, after = abs(a - b), abs(c - d)
        apart = before + after
        if (a < b) != (c < d) and apart > 0:  # they cross in between
            apart = (before * before + after * after) / apart
        total += (following - y) * (a + b + c + d - apart) / 4
        y = following
        while points[p + up, 1] <= y and p + up != p_end:
            p += up
        while points[q + on, 1] <= y and q + on != q_end:
            q += on
    return total


@njit(inner=True)
def _last_below(points, start, step, count, y):
    """The last point but one of a chain of `count` segments that is not above height y."""
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) // 2
        if points[start + step * middle, 1] <= y:
            low = middle
        else:
            high = middle
    return start + step * low


@njit
def _cross(points, p, q, y):
    """Where the segment from point p up to point q is at height y."""
    rise = points[q, 1] - points[p, 1]
    share = (y - points[p, 1]) / rise if rise > 0.0 else 1.0
    return points[p, 0] + share * (points[q, 0] - points[p, 0])
