"""A surface and a graph, both cut at the same levels: which pieces there are, and which contours link them.

Between levels that cross every arc a connected piece has one critical point at most, so surface and graph are the same
if their pieces and the chains between them are.
"""

from collections import Counter

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components


def pierce_arcs(low, high):
    """Choose the fewest levels that cross all arcs.

    Parameters
    ----------
    low, high : (A,) int
        Ranks of the ends of each arc.

    Returns
    -------
    (L,) int64
        Ascending; ranks from the level on are above it.
    """
    levels = []
    for a, b in sorted(zip(low.tolist(), high.tolist()), key=lambda arc: arc[1]):
        if not levels or levels[-1] <= a:
            levels.append(b)
    return np.array(levels, np.int64)


def count_crossings(low, high, levels):
    """Count how often levels cross what reaches from one rank to another, (n,) int64; `low`, `high` : (n,) int."""
    return np.searchsorted(levels, high, side="right") - np.searchsorted(levels, low, side="right")


def cut_surface(faces, links, critical, levels):
    """Cut a surface at levels.

    Parameters
    ----------
    faces : (m, 3) int
        Ranks, each row ascending.
    links : (e, 4) int
        Of each mesh edge the lower and the upper rank, and both faces.
    critical : (K,) int
        Ranks of critical points, a multiple one as often as it counts.
    levels : (L,) int

    Returns
    -------
    Counter
        Of :func:`_name_chains`.
    """
    low, high = (np.searchsorted(levels, faces[:, k], side="right") for k in (0, 2))
    start, owner, slab = _spread(low, high - low + 1)
    # cells joined across mesh edges, within slabs and along levels
    below, above = (np.searchsorted(levels, links[:, k], side="right") for k in (0, 1))
    _, edge, at = _spread(below, above - below + 1)
    one, other = (start[links[edge, k]] + at - low[links[edge, k]] for k in (2, 3))
    piece = _join(one, other, len(owner))
    across = at < above[edge]  # the level above this slab crosses the mesh edge
    ring = _join(one[across], other[across], len(owner))
    crossed = slab < high[owner]
    first = np.unique(ring[crossed], return_index=True)[1]
    cells = np.flatnonzero(crossed)[first]
    corner = np.empty(faces.max() + 1, np.int64)
    corner[faces.ravel()] = np.repeat(np.arange(len(faces)), 3)
    home = corner[critical]
    at_home = piece[start[home] + np.searchsorted(levels, critical, side="right") - low[home]]
    return _name_chains(piece[cells], piece[cells + 1], at_home, critical, piece.max() + 1)


def cut_graph(rank, arcs, levels):
    """Cut a graph at levels.

    Parameters
    ----------
    rank : (K,) int
        Of the nodes.
    arcs : (A, 2) int
        Nodes at both ends of each.
    levels : (L,) int
        Each arc is crossed by one at least.

    Returns
    -------
    Counter
        Of :func:`_name_chains`.
    """
    slab = np.searchsorted(levels, rank, side="right")
    low, high = slab[arcs[:, 0]], slab[arcs[:, 1]]
    start, owner, at = _spread(low, high - low + 1)
    ends = np.concatenate([start, start + high - low])
    piece = _join(ends, len(owner) + arcs.T.ravel(), len(owner) + len(rank))
    below = np.flatnonzero(at < high[owner])
    return _name_chains(piece[below], piece[below + 1], piece[len(owner) :], rank, piece.max() + 1)


def _spread(first, count):
    """Where the items of each owner begin, the owner of each item, and numbers that count up from `first`."""
    start = np.cumsum(count) - count
    owner = np.repeat(np.arange(len(count)), count)
    return start, owner, np.arange(len(owner)) - start[owner] + first[owner]


def _join(one, other, count):
    """The component of each of `count` items."""
    links = sparse.coo_array((np.ones(len(one), bool), (one, other)), shape=(count, count))
    return connected_components(links, directed=False)[1].astype(np.int64)


def _name_chains(below, above, home, critical, count):
    """Count the chains of pieces without critical points, by the critical points at both ends.

    below, above : the pieces next to each contour; home : the piece of each critical point. The Counter has, besides,
    the critical points of each piece and -1 - (how often) for what is not as in a graph of simple events.
    """
    order = np.argsort(critical, kind="stable")
    members = [[] for _ in range(count)]
    for node in order.tolist():
        members[home[node]].append(int(critical[node]))
    plain = np.array([not member for member in members])
    n_below, n_above = (np.bincount(side, minlength=count) for side in (above, below))
    found = Counter(("piece", *members[k], int(n_below[k]), int(n_above[k])) for k in np.flatnonzero(~plain).tolist())
    found["odd"] = int((plain & ((n_below != 1) | (n_above != 1))).sum())
    # contours that plain pieces link are one chain
    contour_above = np.full(count, -1)
    contour_above[below] = np.arange(len(below))
    linked = np.flatnonzero(plain[above] & (contour_above[above] >= 0))
    chain = _join(linked, contour_above[above[linked]], len(below))
    bottom, top = np.full(chain.max(initial=-1) + 1, -1), np.full(chain.max(initial=-1) + 1, -1)
    bottom[chain[~plain[below]]] = below[~plain[below]]
    top[chain[~plain[above]]] = above[~plain[above]]
    named = [tuple(members[k]) if k >= 0 else () for k in (*bottom.tolist(), *top.tolist())]
    found.update(("chain", a, b) for a, b in zip(named[: len(bottom)], named[len(bottom) :]))
    return found
