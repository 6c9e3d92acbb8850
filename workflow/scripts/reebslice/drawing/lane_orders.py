"""The order of lanes from left to right in a flat drawing of a graph.

A lane is the vertical line on which an arc runs. Lanes that are side by side
at some height keep their order, so arcs cross only where a node's bends run
over a lane, and crossings can be counted exactly: one for every node and
every lane that passes the node's height between the outermost lanes of that
node. The order is improved by sifting: every lane in turn tries all places
(C. Matuszewski, R. Schoenfeld, P. Molitor, Using sifting for k-layer
straightline crossing minimization, GD 1999, doi:10.1007/3-540-46648-7_22).
"""

import numpy as np

from ..arrays.grouping import list_incidence
from ..kernels import njit


def count_crossings(order, ends, rank):
    """Number of crossings when the lanes stand in `order`, a permutation (m,).

    `ends` (m, 2): lower and upper node of every lane; `rank` (n,): place of
    every node in the order of heights.
    """
    place = np.empty(len(order), np.int64)
    place[np.asarray(order, np.int64)] = np.arange(len(order))
    total = 0
    for node in range(len(rank)):
        own = (ends == node).any(axis=1)
        if own.any():
            passing = (rank[ends[:, 0]] < rank[node]) & (rank[ends[:, 1]] > rank[node]) & ~own
            between = (place > place[own].min()) & (place < place[own].max())
            total += int((passing & between).sum())
    return total


def order_lanes(ends, rank, hints, short):
    """An order of the lanes from left to right: a permutation (k,).

    `ends` (k, 2): lower and upper node of every lane; `rank` (n,): place of
    every node in the order of heights; `hints` (n,): a position across that
    decides where crossings do not; `short` (k,): whether the far end of a
    lane is level with its node, to the eye, so that a bend of the node must
    not run over it either. Of two starts, one by the hints and one that keeps
    branches together, the better is taken after sifting.
    """
    if len(ends) == 0:
        return np.empty(0, np.int64)
    by_hint = np.lexsort((np.arange(len(ends)), hints[ends].mean(axis=1))).astype(np.int64)
    starts = by_hint, _walk_order(ends, hints, *list_incidence(ends, len(rank)))
    ranks = rank[ends].astype(np.int64)
    reach = 2 * ranks + np.where(short[:, None], [-1, 1], 0)
    start, incident = list_incidence(ranks, len(rank))
    rounds = int(np.clip(2e6 / len(ends) ** 2, 1, 12))
    found = [(_sift(order, ranks, reach, start, incident, rounds), order) for order in starts]
    return min(found, key=lambda pair: pair[0])[1]


def _walk_order(ends, hints, start, incident):
    """Lanes in the order of a walk that keeps every branch together, left to right."""
    seen, order = np.zeros(len(ends), bool), []
    for root in np.argsort(hints, kind="stable"):
        stack = [int(root)]
        while stack:
            node = stack.pop()
            fresh = [int(a) for a in incident[start[node] : start[node + 1]] if not seen[a]]
            far = [int(ends[a].sum() - node) for a in fresh]
            for lane, other in sorted(zip(fresh, far), key=lambda pair: (hints[pair[1]], pair[0])):
                if not seen[lane]:
                    seen[lane] = True
                    order.append(lane)
                    stack.append(other)
    return np.array(order, np.int64)


@njit(inner=True)
def _find_outermost(place, start, incident, without):
    """Places (n,) of the first and of the last lane of every node, the lane `without` left out."""
    first, last = np.full(len(start) - 1, len(place)), np.full(len(start) - 1, -1)
    for node in range(len(first)):
        for k in range(start[node], start[node + 1]):
            if incident[k] != without:
                p = place[incident[k]]
                first[node], last[node] = min(first[node], p), max(last[node], p)
    return first, last


@njit
def _sift(order, ends, reach, start, incident, rounds):
    """Put every lane in turn where it crosses least, until nothing improves, in place; the crossings that remain.

    Nodes go by their rank; a lane passes a node if twice the rank lies within `reach` (k, 2).
    """
    place = np.empty(len(order), np.int64)
    for p in range(len(order)):
        place[order[p]] = p
    for _ in range(rounds):
        improved = False
        for lane in range(len(order)):
            first, last = _find_outermost(place, start, incident, lane)
            a, b, low, high = ends[lane, 0], ends[lane, 1], reach[lane, 0], reach[lane, 1]
            home = place[lane]
            best, best_cost = home, 0
            for step in (-1, 1):
                cost, p = 0, home + step
                while 0 <= p < len(order):
                    # crossings added when the lane moves from the left of the other one to its right
                    other = order[p]
                    c, d = ends[other, 0], ends[other, 1]
                    gain = (reach[other, 0] < 2 * a < reach[other, 1]) * (int(first[a] < p) - int(last[a] > p))
                    gain += (reach[other, 0] < 2 * b < reach[other, 1]) * (int(first[b] < p) - int(last[b] > p))
                    gain -= (low < 2 * c < high) * (int(first[c] < p) - int(last[c] > p))
                    gain -= (low < 2 * d < high) * (int(first[d] < p) - int(last[d] > p))
                    cost += step * gain
                    if cost < best_cost or (cost == best_cost and abs(p - home) < abs(best - home)):
                        best, best_cost = p, cost
                    p += step
            step = 1 if best > home else -1
            for p in range(home, best, step):
                order[p], order[p + step] = order[p + step], lane
                place[order[p]], place[lane] = p, p + step
            improved |= best_cost < 0
        if not improved:
            break
    first, last = _find_outermost(place, start, incident, -1)
    total = 0
    for node in range(len(first)):
        for lane in range(len(order)):
            total += first[node] < place[lane] < last[node] and reach[lane, 0] < 2 * node < reach[lane, 1]
    return total
