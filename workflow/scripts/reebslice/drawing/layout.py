"""The flat drawing of a graph by height: y is the height, x is free.

Every arc gets a lane, a vertical line on which it runs from its lower to its
upper node, and bends only near its two ends. A node stands on the lane of
its only arc above, or below, so that a join is a Y and an arc that ends in a
leaf is straight; through a node with one arc on each side the lane runs on.
The order of the lanes is that of :mod:`reebslice.drawing.lane_orders`; the positions
alternate between the mean of the neighbours and the nearest placing that
keeps lanes and nodes apart.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import list_incidence
from ..kernels import njit
from .lane_orders import order_lanes

LANE_GAP = 1.0
NODE_GAP = 0.7
HINT = 0.25
LARGEST = 3000
ROUNDS = 120


class FlatLayout(NamedTuple):
    """Positions across: `nodes` (n,), `lanes` (m,) of the arcs, in units of one lane."""

    nodes: np.ndarray
    lanes: np.ndarray


def place_graph(heights, sources, targets, hints, margin=0.0):
    """Place the nodes and arcs of a multigraph side by side.

    Parameters
    ----------
    heights, hints : (n,) floats
        Height of every node, and a position across toward which it is drawn,
        such as that in a picture of the model.
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
        Exempt are arcs that end within 2 `margin`, which run anywhere
        between their nodes unless another joins the same two. A graph of
        more than 3000 nodes and arcs is too large to be read this way: its
        nodes stay where the hints put them. The result depends on nothing
        else than the arguments.
    """
    heights, hints = np.asarray(heights, float), np.asarray(hints, float)
    rank = np.empty(len(heights), np.int64)
    rank[np.lexsort((np.arange(len(heights)), heights))] = np.arange(len(heights))
    ends = np.column_stack([sources, targets]).astype(np.int64).reshape(-1, 2)
    ends = np.where(rank[ends[:, :1]] > rank[ends[:, 1:]], ends[:, ::-1], ends)
    if len(heights) + len(ends) > LARGEST:
        return FlatLayout(hints, hints[ends].mean(axis=1))
    lane_of, home, lanes = _join_lanes(ends, heights, 2 * margin)
    order = order_lanes(lanes, rank, hints, heights[lanes[:, 1]] - heights[lanes[:, 0]] < 2 * margin)
    x = _relax(_list_items(order, lanes, home, hints), lanes, home, heights, hints, margin)
    nodes = np.where(home >= 0, x[len(heights) + home], x[: len(heights)]) if len(lanes) else x[: len(heights)]
    run = _straighten(x[len(heights) :][lane_of], ends, nodes, heights, 2 * margin)
    return FlatLayout(nodes, run)


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


def _straighten(run, ends, nodes, heights, reach):
    """Positions (m,) of the arcs, those shorter than `reach` and without a parallel moved between their nodes."""
    _pairs, number, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    short = (heights[ends[:, 1]] - heights[ends[:, 0]] < reach) & (count[number.ravel()] == 1)
    return np.where(short, np.clip(run, nodes[ends].min(axis=1), nodes[ends].max(axis=1)), run)


# --------------------------------------------------------------------------
# Positions. Items are the nodes 0..n-1 and then the lanes, n + lane; a node
# at home on a lane is no item of its own.


def _list_items(order, lanes, home, hints):
    """All items from left to right: every homeless node after the middle one of its lanes.

    Nodes without arcs stand where their hints put them among the others.
    """
    n, place = len(hints), np.empty(len(order))
    place[order] = np.arange(len(order))
    start, incident = list_incidence(lanes, n)
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


@njit(inner=True)
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


@njit(inner=True)
def _is_short(lane, low, high):
    """Whether the marks of the lane's ends would meet: spans hold a margin at each end of the lane."""
    return (high[lane] - low[lane]) / 2 < high[0] - low[0]


@njit
def _list_gaps(items, low, high, lanes, n):
    """All pairs that keep a distance: left item, right item, distance, in the order of the left ones."""
    left, right, gaps = [], [], []
    for i in range(len(items)):
        for j in range(i + 1, len(items)):
            gap = _gap(items[i], items[j], low, high, lanes, n)
            if gap > 0:
                left.append(items[i])
                right.append(items[j])
                gaps.append(gap)
    return np.array(left, dtype=np.int64), np.array(right, dtype=np.int64), np.array(gaps, dtype=np.float64)


@njit
def _keep_apart(x, left, right, gaps):
    """The mean of the two placings that only push right, or only push left.

    Both keep every gap, and so does their mean.
    """
    pushed, pulled = x.copy(), x.copy()
    for k in range(len(gaps)):
        pushed[right[k]] = max(pushed[right[k]], pushed[left[k]] + gaps[k])
    for k in range(len(gaps) - 1, -1, -1):
        pulled[left[k]] = min(pulled[left[k]], pulled[right[k]] - gaps[k])
    return (pushed + pulled) / 2


@njit
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


def _relax(items, lanes, home, heights, hints, margin):
    """Positions (n + k,) of all items: near their neighbours, and a little near their hints."""
    n = len(heights)
    low = np.r_[heights, heights[lanes[:, 0]]] - margin
    high = np.r_[heights, heights[lanes[:, 1]]] + margin
    start, incident = list_incidence(lanes, n)
    gaps = _list_gaps(items, low, high, lanes, n)
    x = _keep_apart(np.zeros(len(low)), *gaps)
    target = np.r_[hints, hints[lanes].mean(axis=1)]
    target = (target - target.min(initial=np.inf)) / max(np.ptp(target) if len(target) else 0, 1e-300)
    target = x.min(initial=0) + target * (x.max(initial=0) - x.min(initial=0))
    for _ in range(ROUNDS):
        wish = (1 - HINT) * _pull(x, lanes, home, start, incident) + HINT * target
        x = _keep_apart(wish, *gaps)
    return x
