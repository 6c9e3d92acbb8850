"""Graphs as trees: a spanning forest, and the edges that it leaves out, one per loop."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree


class SpanningForest(NamedTuple):
    """A spanning forest of a graph of n nodes.

    Attributes
    ----------
    order : (n,) int64
        The nodes, each behind its parent, component by component.
    parent : (n,) int64
        The place in `order` of the parent of each of them; -1 of a root.
    cut : (L,) int64
        The edges that are left out, ascending: as many as the graph has loops.
    """

    order: np.ndarray
    parent: np.ndarray
    cut: np.ndarray


def span_forest(count, ends, width):
    """Find the spanning forest that keeps the widest edges.

    Parameters
    ----------
    count : int
        Nodes. The first one of each component is the root of its tree.
    ends : (E, 2) int
        Edges, none from a node to itself.
    width : (E,) float64
        Of equally wide edges the first ones are kept.

    Returns
    -------
    SpanningForest
        Each loop is cut at its narrowest edge.
    """
    ends = np.asarray(ends, np.int64).reshape(-1, 2)
    rank = np.empty(len(ends))
    rank[np.argsort(-np.asarray(width, float), kind="stable")] = np.arange(1, len(ends) + 1)
    order = np.lexsort((rank, ends.max(axis=1), ends.min(axis=1)))
    pairs = np.sort(ends[order], axis=1)
    widest = order[np.append(True, (pairs[1:] != pairs[:-1]).any(axis=1))[: len(order)]]  # of those between two nodes
    tree = minimum_spanning_tree(csr_array((rank[widest], tuple(ends[widest].T)), shape=(count, count)))
    kept = np.zeros(len(ends) + 1, bool)
    kept[tree.data.astype(np.int64)] = True
    order, above = [], np.full(count, -1)
    for root in np.unique(connected_components(tree, directed=False)[1], return_index=True)[1]:
        reached, before = breadth_first_order(tree, root, directed=False)
        order.append(reached)
        above[reached[1:]] = before[reached[1:]]
    order = np.concatenate([np.zeros(0, np.int64), *order]).astype(np.int64)
    place = np.argsort(order)
    parent = np.where(above[order] < 0, -1, place[above[order]])
    return SpanningForest(order, parent, np.flatnonzero(~kept[rank.astype(np.int64)]))
