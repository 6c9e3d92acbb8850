"""The loops of a surface's Reeb graph: their ends, arcs that cut all of them, and cycles that run along them."""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import maximum_bipartite_matching

from ..arrays.components import connected_items, find
from ..arrays.grouping import Groups, group_of_members, list_incidence
from ..kernels import njit


class Core(NamedTuple):
    """What is left of a graph of K nodes and A arcs when its branches without loops are pruned.

    Attributes
    ----------
    arcs : (A, 2) int32
        Places of nodes, the lower end first; of all arcs.
    incident : Groups
        The arcs of each node, of those that are kept.
    kept : (C,) int
        The arcs of the core, ascending.
    chain : (A,) int64
        The chain of each arc of the core, -1 for others. A chain is a run of arcs between nodes
        at which the core branches, so a cycle has all of its arcs or none.
    """

    arcs: np.ndarray
    incident: Groups
    kept: np.ndarray
    chain: np.ndarray


def find_core(graph):
    """Prune a surface's Reeb graph down to its :class:`Core`."""
    count = len(graph.nodes)
    kept = np.flatnonzero(_prune(graph.arcs, list_incidence(graph.arcs, count)))
    incident = list_incidence(graph.arcs[kept], count)
    incident = Groups(incident.start, kept[incident.member])
    plain = incident.start[:-1][np.diff(incident.start) == 2]
    links = incident.member[plain], incident.member[plain + 1]
    chain = np.full(len(graph.arcs), -1)
    _, chain[kept] = np.unique(connected_items(*links, len(graph.arcs))[kept], return_inverse=True)
    return Core(graph.arcs, incident, kept, chain)


@njit
def _prune(arcs, incident):
    """Whether each arc is left, (A,) bool, when nodes of one arc are taken away as long as there are any."""
    start, member, n = incident.start, incident.member, len(incident.start) - 1
    degree, left = np.empty(n, np.int64), np.full(len(arcs), True)
    for node in range(n):
        degree[node] = start[node + 1] - start[node]
    for first in range(n):
        node = first
        while degree[node] == 1:
            degree[node] = 0
            for arc in member[start[node] : start[node + 1]]:
                if left[arc]:
                    left[arc] = False
                    other = arcs[arc, 0] + arcs[arc, 1] - node
                    degree[other] -= 1
            node = other if other < first else node  # later nodes have their turn
    return left


def pair_loops(graph):
    """List the loops of a surface's Reeb graph by extended persistence.

    Parameters
    ----------
    graph : ReebGraph
        The surface's.

    Returns
    -------
    bottom, top : (L,) int
        Places in `graph.nodes` of the two saddles of each loop, by bottom. L is the genus.
    """
    is_saddle = np.bincount(graph.arcs.ravel(), minlength=len(graph.nodes)) == 3
    places = np.arange(len(graph.nodes))
    bottom = np.flatnonzero(is_saddle & is_saddle[graph.partner] & (places < graph.partner))
    return bottom, graph.partner[bottom].astype(np.int64)


def cut_cycles(core, order):
    """Choose arcs that together cut all cycles, none of them in vain.

    The other arcs are a spanning forest, grown arc by arc in the `order` given
    (Kruskal 1956): with the best arcs last, no choice that cuts all cycles has
    a better k-th best arc, for any k (cuts are the bases of a matroid).

    Parameters
    ----------
    core : Core
    order : (C,) int
        All arcs of the core, the best to cut last.

    Returns
    -------
    (L,) int64
        Arcs, ascending.
    """
    return np.sort(_cut(core.arcs, order, len(core.incident.start) - 1))


@njit
def _cut(arcs, order, n):
    """Kernel of `cut_cycles`."""
    root, cut = np.arange(n), [np.int64(0) for _ in range(0)]
    for arc in order:
        low, high = find(root, np.int64(arcs[arc, 0])), find(root, np.int64(arcs[arc, 1]))
        if low == high:
            cut.append(arc)
        root[max(low, high)] = min(low, high)
    return np.array(cut)


def trace_loops(core, bottom, top):
    """Find a cycle through both ends of each loop.

    Parameters
    ----------
    core : Core
    bottom, top : (L,) int
        As of :func:`pair_loops`.

    Returns
    -------
    Groups
        The arcs of each cycle, in turn, from its top round to its top again. It visits no node
        twice and stays between the heights of the two; among such it has fewest arcs.
    """
    return Groups(*_trace(core.arcs, core.incident, bottom, top))


@njit
def _trace(arcs, incident, bottom, top):
    """Kernel of `trace_loops`: breadth first, from the end of the second arc below the top to that of the first."""
    start, member, n = incident.start, incident.member, len(incident.start) - 1
    found, ends = [np.int64(0) for _ in range(0)], np.zeros(len(top) + 1, np.int64)
    towards, seen, queue = np.empty(n, np.int64), np.full(n, -1, np.int64), np.empty(n, np.int64)
    for k in range(len(top)):
        below = [arc for arc in member[start[top[k]] : start[top[k] + 1]] if arcs[arc, 1] == top[k]]
        node, goal = np.int64(arcs[below[0], 0]), np.int64(arcs[below[1], 0])
        queue[0], seen[goal], taken, count = goal, k, 0, 1
        while seen[node] != k:
            here = queue[taken]
            taken += 1
            for arc in member[start[here] : start[here + 1]]:
                other = np.int64(arcs[arc, 0] + arcs[arc, 1] - here)
                if bottom[k] <= other < top[k] and seen[other] != k:
                    seen[other], towards[other], queue[count] = k, arc, other
                    count += 1
        found.append(below[0])
        while node != goal:
            found.append(towards[node])
            node = np.int64(arcs[towards[node], 0] + arcs[towards[node], 1] - node)
        found.append(below[1])
        ends[k + 1] = len(found)
    return ends, np.array(found)


def match_cuts(cycles, cut, n_arcs):
    """Give each cycle a cut of its own, on one of its arcs.

    Cycles and cuts are bases that are dual but for a change of basis, so the matrix of which cycle
    passes which cut has a determinant of 1 or -1, and one of the products that sum to it is not zero.

    Parameters
    ----------
    cycles : Groups
        L cycles, a basis of all.
    cut : (L,) int
        Arcs that cut all cycles.
    n_arcs : int

    Returns
    -------
    (L,) int64
        The arc of each cycle.
    """
    place = np.full(n_arcs, -1)
    place[cut] = np.arange(len(cut))
    on = place[cycles.member] >= 0
    where = group_of_members(cycles)[on], place[cycles.member[on]]
    matrix = sparse.csr_array((np.ones(on.sum(), bool), where), shape=(len(cut), len(cut)))
    return cut[maximum_bipartite_matching(matrix, perm_type="column")]
