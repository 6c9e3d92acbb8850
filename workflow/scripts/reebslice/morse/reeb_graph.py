"""The exact Reeb graph of a surface, without levels.

The merge trees of the height, upward and downward, give its contour tree
(:mod:`contour_trees`). A contour tree has no loops, so a surface that has some
is cut first, along one contour right below the top of each loop
(:mod:`loop_cuts`), and its arcs are joined again behind. Beyond the order of
heights, which the mesh already holds, time and memory grow as the vertices,
the faces and the crossings of the cuts, one contour per unit of genus.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..arrays.components import find, join
from .contour_trees import choose_gates, find_gates, merge_components, prune_leaves
from .loop_cuts import cut_loops, no_cuts


class ReebGraph(NamedTuple):
    """Reeb graph of a closed surface with simple saddles; K nodes, A arcs.

    nodes : (K,) int32, ranks of the critical points, ascending
    arcs : (A, 2) int32, places in `nodes`, the lower end first, in
        lexicographic order; several arcs may join the same two nodes
    partner : (K,) int32, places in `nodes`: the extended persistence pairing
        (Agarwal, Edelsbrunner, Harer and Wang 2006,
        doi:10.1007/s00454-006-1265-8). A minimum goes with the union that
        ends its component of a sublevel set, a maximum with the separation
        that ends its component of a superlevel set, the lowest point of a
        shell with the highest, and the union at the top of a loop with the
        separation at the bottom of the thinnest such loop.
    gates : (A,) int32, half-edges that run upward from the lower end of each
        arc into it
    """

    nodes: np.ndarray
    arcs: np.ndarray
    partner: np.ndarray
    gates: np.ndarray


def surface_reeb_graph(mesh):
    """The :class:`ReebGraph` of a mesh whose saddles are simple (`unfold_saddles`)."""
    faces, twins = mesh.faces, mesh.twins
    rises, into, out = find_gates(faces, twins, len(mesh.points))
    nodes = np.flatnonzero(rises != 1).astype(np.int32)
    cuts = no_cuts()
    up, _, partner = merge_components(faces, into, nodes, cuts, True)
    down, children, partner_below = merge_components(faces, out, nodes, cuts, False)
    partner = np.maximum(partner, partner_below)
    loose = nodes[(rises[nodes] == 2) & (partner < 0)]
    if len(loose):
        cuts = cut_loops(faces, twins, into, nodes, loose)
        up, _, _ = merge_components(faces, into, nodes, cuts, True)
        down, children, _ = merge_components(faces, out, nodes, cuts, False)
    arcs = prune_leaves(up, down)
    arcs, gates = _join_cuts(arcs, choose_gates(arcs, children), cuts, len(nodes))
    gates = out[nodes[arcs[:, 0]], gates]
    order = np.lexsort(arcs.T[::-1])
    arcs, gates = arcs[order], gates[order]
    _pair_extremes(arcs, partner)
    _pair_loops(arcs, np.searchsorted(nodes, cuts.vertex), partner)
    return ReebGraph(nodes, arcs, partner, gates)


def _join_cuts(arcs, gates, cuts, n_critical):
    """Arcs (A, 2) between places of critical points, the two nodes of each cut joined again, and their gates."""
    place = np.full(n_critical + 2 * len(cuts.top), -1, np.int32)
    critical = np.ones(len(place), bool)
    critical[cuts.top] = critical[cuts.top + 1] = False
    place[critical] = np.arange(n_critical)
    # what ends at a cut from below goes on to the cut's vertex, and nothing else is there
    place[cuts.top] = place[cuts.top + 2]
    kept = place[arcs[:, 0]] >= 0
    return place[arcs[kept]], gates[kept]


def critical_persistence(mesh, graph):
    """Persistence of every vertex, (n,) float64 in mesh units; NaN if regular.

    The height between the members of each pair of the mesh's :class:`ReebGraph`.
    """
    height = mesh.points[graph.nodes, 2]
    persistence = np.full(len(mesh.points), np.nan)
    persistence[graph.nodes] = np.abs(height - height[graph.partner])
    return persistence


# --------------------------------------------------------------------------
# Extended persistence


@njit(cache=True)
def _pair_extremes(arcs, partner):
    """Pair the lowest and the highest node of every shell, in place."""
    root = np.arange(len(partner))
    for low, high in arcs:
        join(root, low, high)
    for v in range(len(partner) - 1, -1, -1):
        lowest = find(root, v)
        if partner[lowest] < 0:
            partner[lowest], partner[v] = v, lowest


@njit(cache=True)
def _pair_loops(arcs, tops, partner):
    """Pair the top of each loop with the bottom of the thinnest loop below it, in place.

    From the top downward, arcs are joined where they meet; the two that hang
    from the top meet at the highest low point that any loop between them has.
    """
    n = len(partner)
    start, member = incident_arcs(arcs, n)
    root = np.arange(len(arcs))
    for top in tops:
        ends = np.full(2, -1)
        for i in range(start[top], start[top + 1]):
            if arcs[member[i], 1] == top:
                ends[1 if ends[0] >= 0 else 0] = member[i]
        node = top
        while find(root, ends[0]) != find(root, ends[1]):
            node -= 1
            before = -1
            for i in range(start[node], start[node + 1]):
                if before >= 0:
                    join(root, before, member[i])
                before = member[i]
        partner[top], partner[node] = node, top
        for v in range(node, top + 1):
            for i in range(start[v], start[v + 1]):
                root[member[i]] = member[i]


@njit(cache=True)
def incident_arcs(arcs, n):
    """The arcs at every node v, member[start[v]:start[v + 1]], ascending."""
    start = np.zeros(n + 1, np.int64)
    for a in range(len(arcs)):
        for end in arcs[a]:
            start[end + 1] += 1
    start = np.cumsum(start)
    fill, member = start[:-1].copy(), np.empty(start[-1], np.int32)
    for a in range(len(arcs)):
        for end in arcs[a]:
            member[fill[end]] = a
            fill[end] += 1
    return start, member
