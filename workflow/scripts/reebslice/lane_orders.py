"""The order of lanes from left to right in a flat drawing of a graph.

A lane is the vertical line on which an arc runs. Lanes that are side by side
at some height keep their order, so arcs cross only where a node's bends run
over a lane, and crossings can be counted exactly: one for every node and
every lane that passes the node's height between the outermost lanes of that
node. The order is improved by sifting: every lane in turn tries all places
(C. Matuszewski, R. Schoenfeld, P. Molitor, Using sifting for k-layer
straightline crossing minimization, GD 1999, doi:10.1007/3-540-46648-7_22).
"""

import numba
import numpy as np


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
    start, incident = list_incidence(ends, len(rank))
    by_hint = np.lexsort((np.arange(len(ends)), hints[ends].mean(axis=1)))
    rounds, found = int(np.clip(2e6 / len(ends) ** 2, 1, 12)), []
    for order in (by_hint, _walk_order(ends, hints, start, incident)):
        order = order.astype(np.int64)
        _sift(order, ends, rank, short, start, incident, rounds)
        found.append((_count(order, ends, rank, short, start, incident), order))
    return min(found, key=lambda pair: pair[0])[1]


def list_incidence(ends, n):
    """Lanes at every node: those of node v are incident[start[v]:start[v + 1]]."""
    nodes = ends.ravel()
    order = np.argsort(nodes, kind="stable")
    start = np.concatenate([[0], np.cumsum(np.bincount(nodes, minlength=n))]).astype(np.int64)
    return start, (order // 2).astype(np.int64)


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


@numba.njit(cache=True)
def _between(node, lane, moved, to, ends, rank, short, start, incident, place, at):
    """1 if `lane`, standing at `at`, is crossed by a bend of `node`; `moved` counts as standing at `to`."""
    if ends[lane, 0] == node or ends[lane, 1] == node:
        if not short[lane]:
            return 0
    elif not rank[ends[lane, 0]] < rank[node] < rank[ends[lane, 1]]:
        return 0
    least, most = len(place), -1
    for k in range(start[node], start[node + 1]):
        p = to if incident[k] == moved else place[incident[k]]
        least, most = min(least, p), max(most, p)
    return 1 if least < at < most else 0


@numba.njit(cache=True)
def _swap_gain(left, right, ends, rank, short, start, incident, place):
    """Crossings added when the neighbours `left`, `right` change places."""
    p = place[left]
    gain = 0
    for i in range(2):
        if i == 0 or ends[left, 0] != ends[left, 1]:
            node = ends[left, i]
            gain += _between(node, right, left, p + 1, ends, rank, short, start, incident, place, p)
            gain -= _between(node, right, left, p, ends, rank, short, start, incident, place, p + 1)
        if i == 0 or ends[right, 0] != ends[right, 1]:
            node = ends[right, i]
            gain += _between(node, left, right, p, ends, rank, short, start, incident, place, p + 1)
            gain -= _between(node, left, right, p + 1, ends, rank, short, start, incident, place, p)
    return gain


@numba.njit(cache=True)
def _move(lane, to, order, place):
    step = 1 if to > place[lane] else -1
    while place[lane] != to:
        p = place[lane]
        order[p], order[p + step] = order[p + step], lane
        place[order[p]], place[lane] = p, p + step


@numba.njit(cache=True)
def _sift(order, ends, rank, short, start, incident, rounds):
    """Put every lane in turn where it crosses least, until nothing improves; in place."""
    place = np.empty(len(order), np.int64)
    for p in range(len(order)):
        place[order[p]] = p
    for _ in range(rounds):
        improved = False
        for lane in range(len(order)):
            home = place[lane]
            best, best_cost = home, 0
            for step in (-1, 1):
                cost = 0
                while 0 <= place[lane] + step < len(order):
                    p = place[lane]
                    other = order[p + step]
                    left, right = (lane, other) if step > 0 else (other, lane)
                    cost += _swap_gain(left, right, ends, rank, short, start, incident, place)
                    _move(lane, p + step, order, place)
                    if cost < best_cost or (cost == best_cost and abs(p + step - home) < abs(best - home)):
                        best, best_cost = p + step, cost
                _move(lane, home, order, place)
            _move(lane, best, order, place)
            improved |= best_cost < 0
        if not improved:
            break


@numba.njit(cache=True)
def _count(order, ends, rank, short, start, incident):
    place = np.empty(len(order), np.int64)
    for p in range(len(order)):
        place[order[p]] = p
    total = 0
    for node in range(len(rank)):
        if start[node] < start[node + 1]:
            for lane in range(len(order)):
                total += _between(node, lane, -1, 0, ends, rank, short, start, incident, place, place[lane])
    return total
