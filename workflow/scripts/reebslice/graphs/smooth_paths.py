"""Material points chosen together along the arcs: the shortest paths among circles that are nearly largest.

Candidates of a region are points whose circle has at least `STEADY` of its
largest radius: the centre of that, where one comes from the point below or
above with no more sideways steps than that takes, and where the path would go
if it were straight for some levels. Among those dynamic programming finds the
shortest path of a whole chain of regions, between the points of the regions
that the chain begins and ends next to, which stay meanwhile.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import group_items
from ..kernels import njit
from ..planar.distances import nearest_point

# Circles of at least this share of the largest radius count as nearly largest.
STEADY = 0.9
# Steps of the search for one, each at most half as long as a radius.
STEPS = 8
# Levels to both sides over which a path is tried straight, one after the other.
WINDOWS = (8, 2, 1)


class Chains(NamedTuple):
    """Chains of R regions, one above the other, and what lies next to their ends.

    Attributes
    ----------
    start : (C + 1,) int64
        Chain c has the regions member[start[c]] up to member[start[c + 1]].
    member : (R,) int64
        Upward in each chain.
    below, above : Groups
        Regions linked to each region that are in other chains, lower and upper ones.
    """

    start: np.ndarray
    member: np.ndarray
    below: tuple
    above: tuple


def find_chains(below, above, count):
    """Find the chains of regions that blocks link one to one.

    Parameters
    ----------
    below, above : lists of B lists of int
        Regions below and above each block.
    count : int
        Number R of regions, which are in ascending order of level.

    Returns
    -------
    Chains
        In order of their lowest regions.
    """
    following, first, pairs = np.full(count, -1), np.ones(count, bool), []
    for lower, upper in zip(below, above):
        if len(lower) == len(upper) == 1:
            following[lower[0]], first[upper[0]] = upper[0], False
        else:
            pairs += [(low, high) for low in lower for high in upper]
    low, high = np.array(pairs, np.int64).reshape(-1, 2).T
    start, member = _list_chains(following, np.flatnonzero(first))
    sides = []
    for owner, other in ((high, low), (low, high)):
        groups = group_items(owner, count)
        sides.append(groups._replace(member=other[groups.member]))
    return Chains(start, member, *sides)


@njit
def _list_chains(following, firsts):
    """Chains as `start` and `member`, given the region above each, or -1, and the first of every chain."""
    start, member, end = np.zeros(len(firsts) + 1, np.int64), np.empty(len(following), np.int64), 0
    for c in range(len(firsts)):
        region = firsts[c]
        while region >= 0:
            member[end] = region
            end += 1
            region = following[region]
        start[c + 1] = end
    return start, member


def smooth_points(outlines, centre, radius, height, below, above):
    """Choose a point in every region so that paths through them are short.

    Parameters
    ----------
    outlines : Outlines
        Of R regions, in ascending order of level.
    centre, radius : (R, 2), (R,) float64
        Largest circles; a region without room has radius 0, and the point that it keeps as centre.
    height : (R,) float64
    below, above : lists of B lists of int
        Regions below and above each block.

    Returns
    -------
    (R, 2) float64
        Whose clearance is at least `STEADY` times the radius.
    """
    count = len(radius)
    chains = find_chains(below, above, count)
    lower, upper = np.full(count, -1), np.full(count, -1)
    for low, high in zip(below, above):
        if len(low) == 1:
            lower[high] = low[0]
        if len(high) == 1:
            upper[low] = high[0]
    rings = outlines.points, outlines.ring, outlines.start
    order = np.arange(count)
    upward = walk_steadily(rings, centre, radius, lower, order)
    downward = walk_steadily(rings, centre, radius, upper, order[::-1].copy())
    chosen = np.column_stack([upward, height])
    candidates = np.stack([upward, upward, downward, centre], axis=1)
    for window in (0, *WINDOWS):
        if window:
            candidates[:, 0] = _straighten(rings, radius, chosen, chains, window)
        _choose_paths(candidates, chosen, chains)
    return chosen[:, :2].copy()


@njit
def walk_steadily(rings, centre, radius, neighbour, order):
    """Go from region to region, and sideways only where the circle would be less than nearly largest.

    Parameters
    ----------
    rings : tuple
        points, ring and start of the outlines of R regions.
    centre, radius : (R, 2), (R,) float64
        Largest circles.
    neighbour : (R,) int64
        The region that one comes from, or -1.
    order : (R,) int64
        In which the regions are entered, each after its neighbour.

    Returns
    -------
    (R, 2) float64
        Points whose clearance is at least `STEADY` times the radius; the centre where the walk finds none.
    """
    points = centre.copy()
    for r in order:
        if neighbour[r] >= 0:
            x, y = points[neighbour[r]]
            points[r, 0], points[r, 1] = _approach(rings, radius, r, x, y, points[r, 0], points[r, 1])
    return points


@njit(inner=True)
def _approach(rings, radius, r, x, y, other_x, other_y):
    """Near (x, y) a point of region r whose circle is nearly largest, or the other point."""
    outline, ring, start = rings
    if radius[r] > 0.0:
        x, y, gain = _climb(outline, ring, start[r], start[r + 1], x, y, radius[r])
        if gain >= STEADY * radius[r]:
            return x, y
    return other_x, other_y


@njit(inner=True)
def _climb(outline, ring, first, end, x, y, radius):
    """Walk away from the outline until the clearance is no less than STEADY x radius, or STEPS are done.

    Returns x, y and the clearance there. The walk stays near where it
    starts: in a ring it goes across, not around.
    """
    stride = 0.5 * radius
    gain, foot_x, foot_y = nearest_point(outline, ring, first, end, x, y)
    for _ in range(STEPS):
        length = np.hypot(x - foot_x, y - foot_y)
        if gain >= STEADY * radius or length == 0.0:
            break
        step = stride / length if gain >= 0.0 else -stride / length
        tried_x, tried_y = x + step * (x - foot_x), y + step * (y - foot_y)
        better, new_x, new_y = nearest_point(outline, ring, first, end, tried_x, tried_y)
        if better > gain:
            x, y, gain, foot_x, foot_y = tried_x, tried_y, better, new_x, new_y
        else:
            stride /= 2
    return x, y, gain


@njit
def _straighten(rings, radius, chosen, chains, window):
    """Points of all regions, (R, 2), where paths would go that are straight for `window` levels to both sides."""
    start, member, (below_start, below), (above_start, above) = chains
    pulled = chosen[:, :2].copy()
    for c in range(len(start) - 1):
        first, last = start[c], start[c + 1] - 1
        low_end = _mean_point(chosen, below, below_start[member[first]], below_start[member[first] + 1], member[first])
        top_end = _mean_point(chosen, above, above_start[member[last]], above_start[member[last] + 1], member[last])
        for i in range(first, last + 1):
            r = member[i]
            low = chosen[member[i - window]] if i - window >= first else low_end
            top = chosen[member[i + window]] if i + window <= last else top_end
            if top[2] > low[2] and low[2] <= chosen[r, 2] <= top[2]:
                share = (chosen[r, 2] - low[2]) / (top[2] - low[2])
                x, y = low[0] + share * (top[0] - low[0]), low[1] + share * (top[1] - low[1])
                pulled[r, 0], pulled[r, 1] = _approach(rings, radius, r, x, y, chosen[r, 0], chosen[r, 1])
    return pulled


@njit(inner=True)
def _mean_point(chosen, member, begin, end, alone):
    """The mean of the chosen points of some regions, or that of the region itself where there are none."""
    if begin == end:
        return chosen[alone].copy()
    total = np.zeros(3)
    for k in range(begin, end):
        total += chosen[member[k]]
    return total / (end - begin)


@njit
def _choose_paths(candidates, chosen, chains):
    """Replace `chosen` (R, 3), chain by chain, by the candidates (R, K, 2) of the shortest path.

    The points of now are candidates too, so that no path gets longer.
    """
    start, member, (below_start, below), (above_start, above) = chains
    k = candidates.shape[1] + 1
    for c in range(len(start) - 1):
        own = member[start[c] : start[c + 1]]
        spots, came = np.empty((len(own), k, 3)), np.zeros((len(own), k), np.int64)
        cost, first, last = np.zeros(k), own[0], own[-1]
        for i in range(len(own)):
            for a in range(k):
                place = candidates[own[i], a - 1] if a else chosen[own[i]]
                spots[i, a, 0], spots[i, a, 1], spots[i, a, 2] = place[0], place[1], chosen[own[i], 2]
        _add_ends(cost, spots[0], chosen, below[below_start[first] : below_start[first + 1]])
        for i in range(1, len(own)):
            cost = _step(cost, spots[i - 1], spots[i], came[i])
        _add_ends(cost, spots[-1], chosen, above[above_start[last] : above_start[last + 1]])
        best = np.argmin(cost)
        for i in range(len(own) - 1, -1, -1):
            chosen[own[i], 0], chosen[own[i], 1] = spots[i, best, 0], spots[i, best, 1]
            best = came[i, best]


@njit(inner=True)
def _add_ends(cost, spots, chosen, others):
    """Add to the cost of each spot its distances to the chosen points of other regions."""
    for a in range(len(cost)):
        for other in others:
            cost[a] += _distance(spots[a], chosen[other])


@njit
def _step(cost, low, high, came):
    """The least cost at each upper spot, coming from the best lower one, which is noted."""
    least = np.full(len(cost), np.inf)
    for a in range(len(cost)):
        for b in range(len(cost)):
            reached = cost[b] + _distance(low[b], high[a])
            if reached < least[a]:
                least[a], came[a] = reached, b
    return least


@njit(inline="always")
def _distance(p, q):
    """Between two points."""
    x, y, z = p[0] - q[0], p[1] - q[1], p[2] - q[2]
    return np.sqrt(x * x + y * y + z * z)
