"""The flat drawing of a graph by height: y is the height, x is free.

Every arc gets a lane, a vertical line on which it runs from its lower to its
upper node, and bends only near its two ends. A node stands on the lane of
its only arc above, or below, so that a join is a Y and an arc that ends in a
leaf is straight; through a node with one arc on each side the lane runs on.
Lanes that are side by side at some height keep their order, so arcs cross
only where a bend runs over a lane, and crossings can be counted exactly: one
for every node and every arc that passes the node's height between the
outermost lanes of that node. The order is improved by sifting (C. Matuszewski, R. Schoenfeld, P. Molitor,
Using sifting for k-layer straightline crossing minimization, GD 1999,
doi:10.1007/3-540-46648-7_22); the positions then alternate between the mean
of the neighbours and the nearest placing that keeps lanes apart.
"""

from typing import NamedTuple

import numba
import numpy as np

LANE_GAP = 1.0
NODE_GAP = 0.7


class FlatLayout(NamedTuple):
    """Positions across: `nodes` (n,), `lanes` (m,) of the arcs, in units of one lane."""

    nodes: np.ndarray
    lanes: np.ndarray
    crossings: int


def place_graph(heights, sources, targets, hints, margin=0.0):
    """Place the nodes and arcs of a multigraph side by side.

    Parameters
    ----------
    heights, hints : (n,) floats
        Height of every node, and a position across that decides the order
        where nothing else does, such as that in a picture of the model.
    sources, targets : (m,) ints
        The nodes that every arc joins, in any order; several arcs may join
        the same two.
    margin : float
        Half the height of a node's mark: two nodes that lie nearer than
        twice this are kept apart across.

    Returns
    -------
    FlatLayout
        Arcs that pass the same height, and share no node there, lie at least
        1 apart. Nodes at heights within 2 `margin` of each other lie at
        least 0.7 apart, and so does a node from a lane that is not its own.
        The result depends on nothing else than the arguments.
    """
    heights, hints = np.asarray(heights, float), np.asarray(hints, float)
    rank = np.empty(len(heights), np.int64)
    rank[np.lexsort((np.arange(len(heights)), heights))] = np.arange(len(heights))
    ends = np.column_stack([sources, targets]).astype(np.int64).reshape(-1, 2)
    ends = np.where(rank[ends[:, :1]] > rank[ends[:, 1:]], ends[:, ::-1], ends)
    lane_of, home, lanes = _join_lanes(ends, heights, 2 * margin)
    order, crossings = _best_order(lanes, rank, hints)
    x = _relax(_list_items(order, lanes, home, hints), lanes, home, heights, margin)
    nodes = np.where(home >= 0, x[len(heights) + home], x[: len(heights)]) if len(lanes) else x[: len(heights)]
    return FlatLayout(nodes, x[len(heights) :][lane_of], crossings)


def count_crossings(order, ends, rank):
    """Number of crossings when the arcs' lanes stand in `order`, a permutation (m,).

    `ends` (m, 2): lower and upper node of every arc; `rank` (n,): place of
    every node in the order of heights.
    """
    place = np.empty(len(order), np.int64)
    place[np.asarray(order)] = np.arange(len(order))
    total = 0
    for node in range(len(rank)):
        own = (ends == node).any(axis=1)
        if own.any():
            passing = (rank[ends[:, 0]] < rank[node]) & (rank[ends[:, 1]] > rank[node]) & ~own
            between = (place > place[own].min()) & (place < place[own].max())
            total += int((passing & between).sum())
    return total


def trace_arc(lower, upper, lane, bend, points=16):
    """The curve (k, 2) of an arc from `lower` (x, y) to `upper` along the line x = lane.

    Within the height `bend` of each end, or half the arc's own height if that
    is less, it turns from the node onto the lane in a quarter of an ellipse.
    The first and the last point are exactly `lower` and `upper`.
    """
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    reach = min(bend, 0.5 * (upper[1] - lower[1]))
    t = np.linspace(0, 1, points)
    turn = np.sqrt(1 - (1 - t) ** 2)
    start = np.column_stack([lower[0] + (lane - lower[0]) * turn, lower[1] + reach * t])
    stop = np.column_stack([upper[0] + (lane - upper[0]) * turn, upper[1] - reach * t])
    return np.vstack([start, stop[::-1]])


# --------------------------------------------------------------------------
# Lanes


def _join_lanes(ends, heights, reach):
    """The lane of every arc (m,), the home lane of every node (n,) or -1, and the ends (k, 2) of the lanes.

    A node's home is the lane of its only arc below, or above, unless that
    arc is shorter than `reach`; where it is at home on both they are one lane.
    """
    n, long = len(heights), heights[ends[:, 1]] - heights[ends[:, 0]] >= reach
    sole = np.full((n, 2), -1)
    for side in (0, 1):  # 0: the node is the arc's lower end, the arc lies above
        single = np.bincount(ends[:, side], minlength=n) == 1
        arcs = np.flatnonzero(single[ends[:, side]] & long)
        sole[ends[arcs, side], side] = arcs
    lane_of = np.arange(len(ends))
    through = np.flatnonzero((sole >= 0).all(axis=1))
    for node in through[np.argsort(heights[through], kind="stable")]:
        lane_of[sole[node, 0]] = lane_of[sole[node, 1]]
    firsts, lane_of = np.unique(lane_of, return_inverse=True)
    lanes = ends[firsts]
    for arc in np.flatnonzero(~np.isin(ends[:, 1], through)):
        lanes[lane_of[arc], 1] = ends[arc, 1]
    arc = sole.max(axis=1)
    home = np.where(arc >= 0, lane_of[arc], -1) if len(ends) else np.full(n, -1)
    return lane_of, home, lanes


# --------------------------------------------------------------------------
# Order of the lanes


def _best_order(ends, rank, hints):
    """The better of two starts, sifted, and its number of crossings."""
    if len(ends) == 0:
        return np.empty(0, np.int64), 0
    start, incident = _incidence(ends, len(rank))
    by_hint = np.lexsort((np.arange(len(ends)), hints[ends].mean(axis=1)))
    found = []
    for order in (by_hint, _walk_order(ends, hints, start, incident)):
        order = order.astype(np.int64)
        _sift(order, ends, rank, start, incident, 12 if len(ends) <= 2000 else 2)
        found.append((_count_fast(order, ends, rank, start, incident), order))
    crossings, order = min(found, key=lambda pair: pair[0])
    return order, int(crossings)


def _incidence(ends, n):
    """Arcs at every node: arcs of node v are incident[start[v]:start[v + 1]]."""
    nodes = ends.ravel()
    order = np.argsort(nodes, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(nodes, minlength=n))]).astype(np.int64)
    return start, (order // 2).astype(np.int64)


def _walk_order(ends, hints, start, incident):
    """Arcs in the order of a walk that keeps every branch together, left to right."""
    seen, order = np.zeros(len(ends), bool), []
    for root in np.argsort(hints, kind="stable"):
        stack = [int(root)]
        while stack:
            node = stack.pop()
            fresh = [int(a) for a in incident[start[node] : start[node + 1]] if not seen[a]]
            far = [int(ends[a].sum() - node) for a in fresh]
            for arc, other in sorted(zip(fresh, far), key=lambda pair: (hints[pair[1]], pair[0])):
                if not seen[arc]:
                    seen[arc] = True
                    order.append(arc)
                    stack.append(other)
    return np.array(order, np.int64)


@numba.njit(cache=True)
def _between(node, arc, moved, to, ends, rank, start, incident, place, at):
    """1 if `arc`, standing at `at`, is crossed by a bend of `node`; `moved` counts as standing at `to`."""
    low, high = rank[ends[arc, 0]], rank[ends[arc, 1]]
    if not low < rank[node] < high:
        return 0
    least, most = len(place), -1
    for k in range(start[node], start[node + 1]):
        p = to if incident[k] == moved else place[incident[k]]
        least, most = min(least, p), max(most, p)
    return 1 if least < at < most else 0


@numba.njit(cache=True)
def _swap_gain(left, right, ends, rank, start, incident, place):
    """Crossings added when the neighbours `left`, `right` change places."""
    p = place[left]
    gain = 0
    for i in range(2):
        if i == 0 or ends[left, 0] != ends[left, 1]:
            node = ends[left, i]
            gain += _between(node, right, left, p + 1, ends, rank, start, incident, place, p)
            gain -= _between(node, right, left, p, ends, rank, start, incident, place, p + 1)
        if i == 0 or ends[right, 0] != ends[right, 1]:
            node = ends[right, i]
            gain += _between(node, left, right, p, ends, rank, start, incident, place, p + 1)
            gain -= _between(node, left, right, p + 1, ends, rank, start, incident, place, p)
    return gain


@numba.njit(cache=True)
def _move(arc, to, order, place):
    step = 1 if to > place[arc] else -1
    while place[arc] != to:
        p = place[arc]
        order[p], order[p + step] = order[p + step], arc
        place[order[p]], place[arc] = p, p + step


@numba.njit(cache=True)
def _sift(order, ends, rank, start, incident, rounds):
    """Put every arc in turn where it crosses least, until nothing improves; in place."""
    place = np.empty(len(order), np.int64)
    for p in range(len(order)):
        place[order[p]] = p
    for _ in range(rounds):
        improved = False
        for arc in range(len(order)):
            home = place[arc]
            best, best_cost = home, 0
            for step in (-1, 1):
                cost = 0
                while 0 <= place[arc] + step < len(order):
                    p = place[arc]
                    other = order[p + step]
                    left, right = (arc, other) if step > 0 else (other, arc)
                    cost += _swap_gain(left, right, ends, rank, start, incident, place)
                    _move(arc, p + step, order, place)
                    if cost < best_cost or (cost == best_cost and abs(p + step - home) < abs(best - home)):
                        best, best_cost = p + step, cost
                _move(arc, home, order, place)
            _move(arc, best, order, place)
            improved |= best_cost < 0
        if not improved:
            break


@numba.njit(cache=True)
def _count_fast(order, ends, rank, start, incident):
    place = np.empty(len(order), np.int64)
    for p in range(len(order)):
        place[order[p]] = p
    total = 0
    for node in range(len(rank)):
        if start[node] < start[node + 1]:
            for arc in range(len(order)):
                total += _between(node, arc, -1, 0, ends, rank, start, incident, place, place[arc])
    return total


# --------------------------------------------------------------------------
# Positions. Items are the nodes 0..n-1 and then the lanes, n + lane; a node
# at home on a lane is no item of its own.


def _list_items(order, lanes, home, hints):
    """All items from left to right: every homeless node after the middle one of its lanes.

    Nodes without arcs stand where their hints put them among the others.
    """
    n, place = len(hints), np.empty(len(order))
    place[order] = np.arange(len(order))
    start, incident = _incidence(lanes, n)
    middle = np.full(n, np.nan)
    for node in np.flatnonzero(np.diff(start)):
        own = np.sort(place[incident[start[node] : start[node + 1]]])
        middle[node] = own[(len(own) - 1) // 2] + 0.5
    known = np.flatnonzero(~np.isnan(middle))
    for node in np.flatnonzero(np.isnan(middle)):
        middle[node] = middle[known][hints[known] < hints[node]].max(initial=-1.0)
    free = np.flatnonzero(home < 0)
    keys, ties = np.r_[middle[free], place], np.r_[hints[free], np.zeros(len(place))]
    items = np.r_[free, n + np.arange(len(order))]
    return items[np.lexsort((items, ties, keys))].astype(np.int64)


@numba.njit(cache=True)
def _gap(a, b, low, high, lanes, n):
    """Distance that two items must keep, 0 if they never meet."""
    if low[a] > high[b] or low[b] > high[a]:
        return 0.0
    if a < n and b < n:
        return NODE_GAP
    if a >= n and b >= n:
        i, j = a - n, b - n
        stacked = lanes[i, 0] == lanes[j, 1] or lanes[i, 1] == lanes[j, 0]
        met = _is_short(a, low, high) or _is_short(b, low, high)
        return LANE_GAP if not stacked else NODE_GAP if met else 0.0
    node, lane = (a, b) if a < n else (b, a)
    own = lanes[lane - n, 0] == node or lanes[lane - n, 1] == node
    return NODE_GAP if not own or _is_short(lane, low, high) else 0.0


@numba.njit(cache=True)
def _is_short(lane, low, high):
    """Whether the marks of the lane's ends would meet: spans hold a margin at each end of the lane."""
    return (high[lane] - low[lane]) / 2 < high[0] - low[0]


@numba.njit(cache=True)
def _keep_apart(items, x, low, high, lanes, n):
    """The mean of the two placings that only push right, or only push left.

    Both keep every gap, and so does their mean.
    """
    right, left = x.copy(), x.copy()
    for i in range(len(items)):
        b = items[i]
        for j in range(i):
            gap = _gap(items[j], b, low, high, lanes, n)
            if gap > 0:
                right[b] = max(right[b], right[items[j]] + gap)
    for i in range(len(items) - 1, -1, -1):
        a = items[i]
        for j in range(i + 1, len(items)):
            gap = _gap(a, items[j], low, high, lanes, n)
            if gap > 0:
                left[a] = min(left[a], left[items[j]] - gap)
    return (left + right) / 2


@numba.njit(cache=True)
def _pull(x, lanes, home, start, incident):
    """Where every item would like to be: nodes amid their lanes, lanes at their nodes."""
    n, wish = len(home), x.copy()
    for node in range(n):
        if home[node] < 0 and start[node] < start[node + 1]:
            wish[node] = x[n + incident[start[node] : start[node + 1]]].mean()
    for lane in range(len(lanes)):
        total, count = 0.0, 0
        for i in range(2):
            node = lanes[lane, i]
            if home[node] != lane:
                total, count = total + (wish[node] if home[node] < 0 else x[n + home[node]]), count + 1
            elif start[node + 1] - start[node] > 1:
                others = x[n + incident[start[node] : start[node + 1]]].sum() - x[n + lane]
                total, count = total + others / (start[node + 1] - start[node] - 1), count + 1
        if count:
            wish[n + lane] = total / count
    return wish


def _relax(items, lanes, home, heights, margin):
    """Positions (n + k,) of all items."""
    n = len(heights)
    low = np.r_[heights, heights[lanes[:, 0]]] - margin
    high = np.r_[heights, heights[lanes[:, 1]]] + margin
    start, incident = _incidence(lanes, n)
    x = _keep_apart(items, np.zeros(len(low)), low, high, lanes, n)
    for _ in range(int(np.clip(2e8 / max(len(items), 1) ** 2, 3, 200))):
        x = _keep_apart(items, _pull(x, lanes, home, start, incident), low, high, lanes, n)
    return x
