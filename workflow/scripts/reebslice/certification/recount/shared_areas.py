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

FLAT = 1e-290  # what rises less is level, lest its slope overflow


class Chains(NamedTuple):
    """Outlines cut into chains that only rise or only fall, by region and then by the height they begin at.

    lowest, highest : (H,) the point of each that is lowest, and highest; those between run from one to the other
    sign : (H,) +1 where the region is left of the chain, -1 where it is right of it
    begin : (R + 1,) the first chain of each region
    """

    lowest: np.ndarray
    highest: np.ndarray
    sign: np.ndarray
    begin: np.ndarray


def find_chains(points, first, ring, region, turn, n_regions):
    """Cut the outlines of regions into chains.

    Parameters
    ----------
    points, first
        Of :class:`Curves`.
    ring : (Q,) int
        The curves that bound a region.
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
    up = np.where(lowest < highest, 1, -1)
    order = np.lexsort((points[lowest, 1], region[owner]))
    counts = np.bincount(region[owner], minlength=n_regions)
    begin = np.concatenate([[0], np.cumsum(counts)])
    return Chains(lowest[order], highest[order], (up * turn[owner])[order], begin)


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
    lowest, highest, sign, begin = chains
    shared = np.zeros(len(one))
    for e in range(len(one)):
        now, ends = np.array([begin[one[e]], begin[other[e]]]), (begin[one[e] + 1], begin[other[e] + 1])
        opened = np.empty((2, max(ends[0] - now[0], ends[1] - now[1], 1)), np.int64)
        n_open, base = np.zeros(2, np.int64), 0.0
        if now[0] < ends[0]:
            base = points[lowest[now[0]], 0]
        while now[0] < ends[0] or now[1] < ends[1]:
            first_ends = now[0] == ends[0]
            if not first_ends and now[1] < ends[1]:
                first_ends = points[lowest[now[1]], 1] < points[lowest[now[0]], 1]
            side = 1 if first_ends else 0
            chain = now[side]
            now[side] += 1
            floor, kept = points[lowest[chain], 1], 0
            for k in range(n_open[1 - side]):
                met = opened[1 - side, k]
                if points[highest[met], 1] <= floor:
                    continue
                opened[1 - side, kept] = met
                kept += 1
                ends_of = lowest[chain], highest[chain], lowest[met], highest[met]
                shared[e] += sign[chain] * sign[met] * _left_of_both(points, *ends_of, base)
            n_open[1 - side] = kept
            opened[side, n_open[side]] = chain
            n_open[side] += 1
    return shared


@njit
def _left_of_both(points, p, p_end, q, q_end, base):
    """Area left of two chains as high as both reach, from an upright line at `base`.

    p, q : points where they begin; the first chain begins no lower than the other
    """
    up, on = 1 if p_end > p else -1, 1 if q_end > q else -1
    y, top = points[p, 1], min(points[p_end, 1], points[q_end, 1])
    low, high = 0, abs(q_end - q)
    while high - low > 1:  # the last point of the other chain that is not above
        middle = (low + high) // 2
        if points[q + on * middle, 1] <= y:
            low = middle
        else:
            high = middle
    q += on * low
    p_x, p_y, p_slope = _segment(points, p, p + up)
    q_x, q_y, q_slope = _segment(points, q, q + on)
    total, a, b = 0.0, points[p, 0] - base, q_x - (q_y - y) * q_slope - base
    while y < top:
        following = min(p_y, q_y, top)
        c, d = p_x - (p_y - following) * p_slope - base, q_x - (q_y - following) * q_slope - base
        before, after = abs(a - b), abs(c - d)
        apart = before + after
        if (a < b) != (c < d) and apart > 0:  # they cross in between
            apart = (before * before + after * after) / apart
        total += (following - y) * (a + b + c + d - apart) / 4
        y, a, b = following, c, d
        while p_y == y and p + up != p_end:
            p, a = p + up, p_x - base
            p_x, p_y, p_slope = _segment(points, p, p + up)
        while q_y == y and q + on != q_end:
            q, b = q + on, q_x - base
            q_x, q_y, q_slope = _segment(points, q, q + on)
    return total


@njit
def _segment(points, p, q):
    """Where the segment from point p to point q ends, and how far it goes sideways as it rises by one."""
    rise = points[q, 1] - points[p, 1]
    return points[q, 0], points[q, 1], (points[q, 0] - points[p, 0]) / rise if rise > FLAT else 0.0
