"""Arcs of the solid's Reeb graph from those of its surface, and graphs compared where pairs inside flats are left out.

Above and below a vertex each region has one outer contour. What happens at a vertex happens to one region: of the
contours there the outer ones end or begin at it, and the outer contour around the holes there, if it does not come to
the vertex itself, passes it.
"""

from collections import Counter

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components

from .hosts import HOLE, OUTER


def solid_arcs(arcs):
    """Part the outer arcs of a surface at the vertices that they pass.

    Parameters
    ----------
    arcs : Arcs
        Of a sweep, with no look open.

    Returns
    -------
    (B, 2) int64 or None
        Ranks of the critical vertices at both ends of each, the lower first; None where contours fit no solid.
    """
    holes = np.flatnonzero(arcs.kind == HOLE)
    vertex = np.concatenate([arcs.high[holes], arcs.low[holes]]).astype(np.int64)
    host = np.concatenate([arcs.below_high[holes], arcs.above_low[holes]])
    if (host < 0).any() or (arcs.kind[host] != OUTER).any():
        return None
    here = np.where(np.arange(len(host)) < len(holes), arcs.high[host], arcs.low[host]) == vertex
    passed = np.unique(np.column_stack([vertex, host])[~here], axis=0)
    within = (arcs.low[passed[:, 1]] < passed[:, 0]) & (passed[:, 0] < arcs.high[passed[:, 1]])
    if not within.all() or len(np.unique(passed[:, 0])) < len(passed):
        return None
    outer = np.flatnonzero(arcs.kind == OUTER)
    arc = np.concatenate([outer, outer, passed[:, 1]])
    rank = np.concatenate([arcs.low[outer], arcs.high[outer], passed[:, 0]]).astype(np.int64)
    order = np.lexsort((rank, arc))
    arc, rank = arc[order], rank[order]
    return np.column_stack([rank[:-1], rank[1:]])[arc[:-1] == arc[1:]]


def contract_flats(arcs, shown, height):
    """Contract the arcs of no height, and pass over what is not shown and does not branch.

    Parameters
    ----------
    arcs : (B, 2) int
        Ranks of both ends of each.
    shown : (n,) bool
        Ranks that are.
    height : (n,) float64

    Returns
    -------
    chains : Counter
        (lower group, upper group): how many arcs join them. A group that is not shown and does branch, or has no arcs,
        is in it as (-1, group).
    group : (n,) int
        Of ranks that arcs of no height join.
    """
    flat = height[arcs[:, 0]] == height[arcs[:, 1]]
    links = sparse.coo_array((np.ones(flat.sum(), bool), arcs[flat].T), shape=(len(height), len(height)))
    count, group = connected_components(links, directed=False)
    known, used = np.zeros(count, bool), np.zeros(count, bool)
    known[group[shown]] = used[group[arcs]] = True
    ends, up, down = group[arcs[~flat]].tolist(), {}, {}
    for number, (low, high) in enumerate(ends):
        up.setdefault(low, []).append(number)
        down.setdefault(high, []).append(number)
    odd = [k for k in np.flatnonzero(used & ~known).tolist() if len(up.get(k, ())) != 1 or len(down.get(k, ())) != 1]
    chains, known = Counter((-1, k) for k in odd), known.tolist()
    for low, high in ends:
        if known[low]:
            while not known[high] and len(up.get(high, ())) == 1:
                high = ends[up[high][0]][1]
            chains[low, high] += 1
    return chains, group


def count_loops(arcs):
    """Count the components and the loops of a graph without lonely nodes; arcs : (B, 2) ranks of their ends."""
    nodes, place = np.unique(arcs, return_inverse=True)
    place = place.reshape(-1, 2)
    links = sparse.coo_array((np.ones(len(place), bool), place.T), shape=(len(nodes), len(nodes)))
    parts = connected_components(links, directed=False)[0]
    return parts, len(place) - len(nodes) + parts
