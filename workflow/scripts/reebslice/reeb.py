"""The exact Reeb graph of a surface, without levels.

Two sweeps with union-find give the merge trees of the height, upward and
downward, and those give the contour tree (Carr, Snoeyink and Axen 2003,
doi:10.1016/S0925-7721(02)00093-7). A contour tree has no loops, so the surface
is cut first, along one contour right below the top of each loop (as Tierny,
Gyulassy, Simon and Pascucci 2009 do in volumes, doi:10.1109/TVCG.2009.163),
and its arcs are joined again behind. Beyond the order of heights, which the
mesh already holds, time and memory grow as the vertices, the faces and the
crossings of the cuts, one contour per unit of genus.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .heightmesh import next_half_edge
from .pairing import find, join


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
    """

    nodes: np.ndarray
    arcs: np.ndarray
    partner: np.ndarray


class Cuts(NamedTuple):
    """Contours along which the surface is cut, cut j between the ranks vertex[j] - 1 and vertex[j].

    vertex : (J,) ascending ranks
    first : (J,) one half-edge that each cut crosses
    half_edge, cut : (X,) all crossings, in order of half-edge, then of level
    """

    vertex: np.ndarray
    first: np.ndarray
    half_edge: np.ndarray
    cut: np.ndarray


def surface_reeb_graph(mesh):
    """The :class:`ReebGraph` of a mesh whose saddles are simple (`unfold_saddles`)."""
    ends = mesh.faces.ravel(), _heads(mesh.faces)
    rises, into, out = find_gates(mesh.faces, mesh.twins, len(mesh.points))
    critical = rises != 1
    nodes = np.flatnonzero(critical).astype(np.int32)
    below, above, partner = _merge_trees(_far_ends(into, ends[0]), _far_ends(out, ends[1]), critical)
    loose = nodes[(rises[nodes] == 2) & (partner[nodes] < 0)]
    cuts = _cut_loops(mesh.faces, mesh.twins, into, loose)
    if len(cuts.vertex):
        place, low, high = _cut_neighbours(into, out, ends, cuts)
        split = np.ones(len(low), bool)
        split[place] = critical
        below, above, _ = _merge_trees(low, high, split)
        arcs = _join_cuts(_contour_tree(below, above, np.flatnonzero(split)), place, cuts)
    else:
        arcs = _contour_tree(below, above, nodes)
    arcs = np.searchsorted(nodes, arcs).astype(np.int32)
    arcs = arcs[np.lexsort(arcs.T[::-1])]
    partner = np.where(partner < 0, -1, np.searchsorted(nodes, partner))[nodes].astype(np.int32)
    _pair_extremes(arcs, partner)
    _pair_loops(arcs, np.searchsorted(nodes, cuts.vertex), partner)
    return ReebGraph(nodes, arcs, partner)


def critical_persistence(mesh, graph):
    """Persistence of every vertex, (n,) float64 in mesh units; NaN if regular.

    The height between the members of each pair of the mesh's :class:`ReebGraph`.
    """
    height = mesh.points[graph.nodes, 2]
    persistence = np.full(len(mesh.points), np.nan)
    persistence[graph.nodes] = np.abs(height - height[graph.partner])
    return persistence


def _heads(faces):
    return faces[:, [1, 2, 0]].ravel()


# --------------------------------------------------------------------------
# Steps from a vertex to the ones met before it


@njit(cache=True)
def find_gates(faces, twins, n):
    """Wedges of every link, and a way down and up through each.

    faces : (m, 3) with the lowest corner first. Returns rises : (n,) int32,
    the number of upper wedges of the link where it has lower ones as well (1:
    regular, 0: extremum); into, out : (n, 2) int32, upward half-edges to the
    vertex from each of its first two lower wedges and from it to the upper
    ones, -1 where there is none. A regular vertex has one of either.
    """
    rises = np.zeros(n, np.int32)
    into, out = np.full((n, 2), np.int32(-1)), np.full((n, 2), np.int32(-1))
    for f in range(faces.shape[0]):
        a, b, c = faces[f]
        if out[a, 0] < 0:
            out[a, 0] = 3 * f
        if b > c:  # seen from c the link rises here, from a lower wedge into an upper one
            if rises[c] < 2:
                into[c, rises[c]], out[c, rises[c]] = twins[3 * f + 2], twins[3 * f + 1]
            rises[c] += 1
            if into[b, 0] < 0:
                into[b, 0] = 3 * f
        elif into[c, 0] < 0:
            into[c, 0] = 3 * f + 1
    return rises, into, out


def _far_ends(gates, end):
    return np.where(gates < 0, np.int32(-1), end[gates])


def _cut_neighbours(into, out, ends, cuts):
    """What a sweep meets next to every node of the cut surface, below and above.

    Right below its vertex, a cut adds two nodes: the highest point of what is
    below it and then the lowest point of what is above. Returns place (n,) of
    the vertices among the N nodes, low and high : (N, 2), -1 for none.
    """
    ranks = np.arange(len(into), dtype=np.int32)
    place = (ranks + 2 * np.searchsorted(cuts.vertex, ranks, side="right")).astype(np.int32)
    top, bottom = place[cuts.vertex] - 2, place[cuts.vertex] - 1
    low, high = np.full((2, len(place) + 2 * len(top), 2), -1, np.int32)

    def step(gates, crossing, side):
        """The cut at place `crossing` of the list, if it is on the half-edge, else the end of that."""
        crossing = np.clip(crossing, 0, len(cuts.cut) - 1)
        end = (place[ends[0][gates]], bottom) if side == 0 else (place[ends[1][gates]], top)
        met = (cuts.half_edge[crossing] == gates) & (crossing != own)
        return np.where(met, end[1][cuts.cut[crossing]], end[0])

    own = -1
    is_cut = np.zeros(len(ends[0]), bool)
    is_cut[cuts.half_edge] = True
    for side, (gates, near) in enumerate(((into, low), (out, high))):
        met = _far_ends(gates, ends[side])
        near[place] = np.where(met < 0, -1, place[met])
        row, k = np.nonzero((gates >= 0) & is_cut[gates])
        crossing = np.searchsorted(cuts.half_edge, gates[row, k], side="left" if side else "right") - 1 + side
        near[place[row], k] = step(gates[row, k], crossing, side)
    keys = cuts.half_edge.astype(np.int64) * len(top) + cuts.cut
    own = np.searchsorted(keys, cuts.first.astype(np.int64) * len(top) + np.arange(len(top)))
    low[top, 0] = step(cuts.first, own - 1, 0)
    high[bottom, 0] = step(cuts.first, own + 1, 1)
    return place, low, high


# --------------------------------------------------------------------------
# Merge trees and contour tree


def _merge_trees(low, high, critical):
    """Both merge trees and the elder rule's pairs, three (N,) arrays of nodes, -1 for none.

    The next critical point upward in the component of the sublevel set,
    downward in that of the superlevel set, and the partner.
    """
    below, partner = _sweep(low, critical)
    above, partner_above = _sweep(_mirror(high)[::-1].copy(), critical[::-1].copy())
    return below, _mirror(above)[::-1], np.maximum(partner, _mirror(partner_above)[::-1])


def _mirror(nodes):
    return np.where(nodes < 0, nodes, len(nodes) - 1 - nodes).astype(np.int32)


@njit(cache=True)
def _sweep(earlier, critical):
    n = len(critical)
    root = np.arange(n).astype(np.int32)  # the oldest member represents its component
    head = np.arange(n).astype(np.int32)  # the last critical point of a component
    after, partner = np.full(n, np.int32(-1)), np.full(n, np.int32(-1))
    for v in range(n):
        if earlier[v, 0] < 0:
            continue
        old = find(root, earlier[v, 0])
        root[v] = old
        if not critical[v]:
            continue
        after[head[old]] = v
        if earlier[v, 1] >= 0:
            other = find(root, earlier[v, 1])
            if other != old:
                after[head[other]] = v
                young, old = max(old, other), min(old, other)
                root[young] = root[v] = old
                partner[young], partner[v] = v, young
        head[old] = v
    return after, partner


def _contour_tree(below, above, nodes):
    """Arcs (A, 2) of the contour tree, its nodes named as in `nodes`, lower end first."""
    up, down = (_places(tree[nodes], nodes) for tree in (below, above))
    arcs = _prune_leaves(up, down)
    return nodes[arcs]


def _places(chosen, nodes):
    return np.where(chosen < 0, -1, np.searchsorted(nodes, chosen)).astype(np.int32)


@njit(cache=True)
def _prune_leaves(up, down):
    """Arcs of the contour tree, from the parents of its nodes in both merge trees.

    A node without children in one tree and with one child in the other is a
    leaf; its arc is the one to its parent. The sum of the children's numbers
    tells the one child where there is one.
    """
    k = len(up)
    count, total = np.zeros((2, k), np.int32), np.zeros((2, k), np.int64)
    for v in range(k):
        for tree, parent in ((0, up[v]), (1, down[v])):
            if parent >= 0:
                count[tree, parent] += 1
                total[tree, parent] += v
    arcs, found = np.empty((k, 2), np.int32), 0
    stack, height = np.empty(2 * k, np.int32), 0
    for v in range(k):
        if count[0, v] + count[1, v] == 1:
            stack[height] = v
            height += 1
    while height > 0:
        height -= 1
        v = stack[height]
        if count[0, v] + count[1, v] != 1:
            continue
        lower = count[0, v] == 0
        here, there = (up, down) if lower else (down, up)
        i = 0 if lower else 1
        w, child, parent = here[v], total[1 - i, v], there[v]
        arcs[found, 0], arcs[found, 1] = (v, w) if lower else (w, v)
        found += 1
        count[i, w] -= 1
        total[i, w] -= v
        there[child] = parent
        if parent >= 0:
            total[1 - i, parent] += child - v
        count[1 - i, v] = 0
        if count[0, w] + count[1, w] == 1:
            stack[height] = w
            height += 1
    return arcs[:found]


# --------------------------------------------------------------------------
# Loops


def _cut_loops(faces, twins, into, saddles):
    """One contour right below each saddle that has two there: :class:`Cuts`.

    Of the two contours the one with fewer crossings is taken.
    """
    length, start = _measure_cuts(faces, twins, into, saddles)
    tops = length > 0
    vertex, first, length = saddles[tops], start[tops], length[tops]
    half_edge = _walk_cuts(faces, twins, vertex, first, int(length.sum()))
    cut = np.repeat(np.arange(len(vertex), dtype=np.int32), length)
    order = np.lexsort((cut, half_edge))
    return Cuts(vertex, first, half_edge[order], cut[order])


@njit(cache=True)
def _measure_cuts(faces, twins, into, saddles):
    """Crossings of the shorter contour below each saddle, 0 if there is but one; its first half-edge."""
    length, start = np.zeros(len(saddles), np.int64), np.full(len(saddles), np.int32(-1))
    for s in range(len(saddles)):
        v = saddles[s]
        first, second = into[v]
        a, b, steps = first, second, 0
        while True:
            steps += 1
            a = next_half_edge(faces, twins, a, v)
            b = next_half_edge(faces, twins, b, v)
            if a == second or b == first:
                break
            if a == first or b == second:
                length[s], start[s] = steps, a if a == first else b
                break
    return length, start


@njit(cache=True)
def _walk_cuts(faces, twins, vertex, first, total):
    out, place = np.empty(total, np.int32), 0
    for j in range(len(vertex)):
        h = first[j]
        while True:
            out[place] = h
            place += 1
            h = next_half_edge(faces, twins, h, vertex[j])
            if h == first[j]:
                break
    return out


def _join_cuts(arcs, place, cuts):
    """Arcs between ranks of vertices, the two nodes of each cut joined again."""
    rank = np.empty(place[-1] + 1, np.int32)
    rank[place] = np.arange(len(place))
    top = place[cuts.vertex] - 2
    # what ends at a cut from below goes on to the cut's vertex, and nothing else is there
    rank[top] = cuts.vertex
    begins = np.zeros(len(rank), bool)
    begins[top + 1] = True
    return rank[arcs[~begins[arcs[:, 0]]]]


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
    start, member = _incident_arcs(arcs, n)
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
def _incident_arcs(arcs, n):
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
