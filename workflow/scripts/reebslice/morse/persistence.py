"""Extended persistence of a graph whose nodes are in order of height: a Reeb graph, or what is left of one.

Upward, a component of the sublevel sets is born at a minimum and dies where it
meets an older one; downward, so do the components of the superlevel sets; a
loop is born at its top, seen from above, and dies at its bottom. In the Reeb
graph of a surface every node belongs to exactly one pair.

References
----------
P. K. Agarwal, H. Edelsbrunner, J. Harer and Y. Wang, Extreme elevation on a
2-manifold, Discrete & Computational Geometry 36 (2006),
doi:10.1007/s00454-006-1265-8
"""

from typing import NamedTuple

import numpy as np

from ..arrays.components import find
from ..arrays.grouping import list_incidence
from ..kernels import njit


class ExtendedPairs(NamedTuple):
    """Pairs of nodes, the lower one first, by what they begin and end.

    Attributes
    ----------
    ordinary : (p, 2) int32
        Components of sublevel sets: minimum, and union with an older one.
    relative : (q, 2) int32
        Components of superlevel sets: separation from an older one, and maximum.
    loops : (l, 2) int32
        Bottom and top of the loops, each top with the thinnest loop below it.
    extremes : (s, 2) int32
        Lowest and highest node of each component of the graph that has arcs.
    """

    ordinary: np.ndarray
    relative: np.ndarray
    loops: np.ndarray
    extremes: np.ndarray


def extended_pairs(n_nodes, arcs):
    """Pair the nodes of a graph by extended persistence.

    Parameters
    ----------
    n_nodes : int
        Number of nodes; they are 0, 1, ... in order of height, of any degree.
    arcs : (A, 2) int
        Nodes that each arc joins, the lower end first; several may join the
        same two.

    Returns
    -------
    ExtendedPairs
        A node of higher degree may be in several pairs. Where all nodes have
        one or three arcs, as in a Reeb graph of simple critical points, each
        is in exactly one.
    """
    return _extended_pairs(np.ascontiguousarray(arcs, np.int32).reshape(-1, 2), n_nodes)


def pair_kinds(index, partner):
    """Name what each node of the Reeb graph of a surface begins or ends.

    Parameters
    ----------
    index, partner : (K,) int
        Morse index of each node, and the other member of its pair.

    Returns
    -------
    list of str
        `ordinary`, `relative`, `loop` or `extended`, as :class:`ExtendedPairs` has them.
    """
    lower, upper = np.minimum(index, index[partner]), np.maximum(index, index[partner])
    kinds = [np.where(lower == 0, "ordinary", "loop"), "relative"]
    return np.select([upper == 1, lower == 1], kinds, "extended").tolist()


@njit(inner=True)
def _pair_components(arcs, incident, upward):
    """Pairs (p, 2) by the elder rule, loops that each node closes (n,), and for each node one nearer the oldest."""
    start, member, n = incident.start, incident.member, len(incident.start) - 1
    pairs, found, closed = np.empty((n, 2), np.int32), 0, np.zeros(n, np.int32)
    root, near, far = np.arange(n).astype(np.int32), 1 if upward else 0, 0 if upward else 1
    for step in range(n):
        node = np.int32(step if upward else n - 1 - step)
        oldest = node  # of the component of this node, which it represents
        for place in range(start[node], start[node + 1]):
            arc = member[place]
            if arcs[arc, near] != node:
                continue
            other = find(root, arcs[arc, far])
            if other == oldest:
                closed[node] += 1
                continue
            low, high = min(oldest, other), max(oldest, other)
            young, oldest = (high, low) if upward else (low, high)
            root[young] = oldest
            if young != node:
                pairs[found, far], pairs[found, near] = young, node
                found += 1
    return pairs[:found], closed, root


@njit(inner=True)
def _pair_extremes(root):
    """The lowest node of each component, to which `root` leads, and its highest."""
    pairs, found, met = np.empty((len(root), 2), np.int32), 0, np.zeros(len(root), np.bool_)
    for node in range(len(root) - 1, -1, -1):
        lowest = find(root, node)
        if not met[lowest] and lowest != node:
            pairs[found, 0], pairs[found, 1] = lowest, node
            found += 1
        met[lowest] = True
    return pairs[:found]


@njit(inner=True)
def _pair_loops(arcs, incident, closed):
    """Bottom and top of every loop; closed : (n,) loops of which each node is the top.

    From the top downward, arcs are joined where they meet; a loop ends where
    two groups meet that both hang from the top.
    """
    start, member = incident.start, incident.member
    total = 0
    for count in closed:
        total += count
    pairs, found = np.empty((total, 2), np.int32), 0
    root, hangs = np.arange(len(arcs)), np.zeros(len(arcs), np.bool_)
    for top in range(len(closed)):
        if closed[top] == 0:
            continue
        for arc in member[start[top] : start[top + 1]]:
            hangs[arc] = arcs[arc, 1] == top
        node, left = top, closed[top]
        while left > 0:
            node -= 1
            for arc in member[start[node] : start[node + 1]]:
                one, other = find(root, member[start[node]]), find(root, arc)
                if one != other:
                    root[other] = one
                    if hangs[one] and hangs[other]:
                        pairs[found, 0], pairs[found, 1] = node, top
                        found, left = found + 1, left - 1
                    hangs[one] |= hangs[other]
        for arc in member[start[node] : start[top + 1]]:  # as before, for the next top
            root[arc], hangs[arc] = arc, False
    return pairs


@njit
def _extended_pairs(arcs, n):
    """The :class:`ExtendedPairs`, in one call."""
    incident = list_incidence(arcs, n)
    ordinary, closed, root = _pair_components(arcs, incident, True)
    relative, _, _ = _pair_components(arcs, incident, False)
    return ExtendedPairs(ordinary, relative, _pair_loops(arcs, incident, closed), _pair_extremes(root))
