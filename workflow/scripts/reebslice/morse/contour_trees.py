"""Merge trees of the height on a surface, and the contour tree that they make.

Two sweeps, upward and downward, give the merge trees, and those give the
contour tree (Carr, Snoeyink and Axen 2003, doi:10.1016/S0925-7721(02)00093-7).
Only critical points are merged: a regular vertex belongs where the vertex next
to it, on the side that the sweep comes from, belongs. The surface may be cut
along contours (:mod:`loop_cuts`); each cut j then adds two nodes right below
its vertex, cuts.top[j], the highest point of what is below the cut, and, one
more, the lowest point of what is above.
"""

import numpy as np
from numba import njit

from ..arrays.components import find
from .loop_cuts import divert


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


def merge_components(faces, gates, nodes, cuts, upward):
    """Merge tree of the sublevel sets or, downward, of the superlevel sets, over N nodes.

    gates : `into` of `find_gates` for the upward sweep, `out` for the downward
    one; nodes : (K,) critical vertices, which with the nodes of the cuts, in
    ascending order, make the N. Returns, -1 for none, following : (N,) int32,
    the next node in the component; children : (N, 2) int32, the nodes that it
    follows, in the order of its gates; partner : (N,) int32, by the elder
    rule: for the node that unites two components the one that began the
    younger, and back.
    """
    number = (np.arange(len(nodes)) + 2 * np.searchsorted(cuts.vertex, nodes, side="right")).astype(np.int32)
    near = _neighbours(faces, gates, upward)
    behind_cuts = divert(near, faces, gates, cuts, upward) if len(cuts.vertex) else cuts.top
    return _merge(_step_back(near, nodes, number, cuts.top, behind_cuts, upward), upward)


@njit(cache=True)
def _neighbours(faces, gates, upward):
    """The vertex behind each gate, (n, 2) int32, -1 for none."""
    near, ends = np.empty(gates.shape, np.int32), faces.ravel()
    for v in range(len(gates)):
        for k in range(2):
            h = gates[v, k]
            near[v, k] = -1 if h < 0 else ends[h] if upward else ends[h + 1 if h % 3 < 2 else h - 2]
    return near


@njit(cache=True)
def _step_back(near, nodes, number, top, behind_cuts, upward):
    """A node of the component that a sweep finds behind each gate of each node, (N, 2) int32, -1 for none.

    near : (n, 2) the vertex behind each gate, or -2 - node where a cut comes before it.
    """
    n, k = len(near), len(nodes)
    reached = np.empty(n, np.int32)  # from each vertex, going back through the first gates
    place = 0 if upward else k - 1
    for i in range(n):
        v = i if upward else n - 1 - i
        if 0 <= place < k and nodes[place] == v:
            reached[v] = number[place]
            place += 1 if upward else -1
        else:
            reached[v] = reached[near[v, 0]] if near[v, 0] >= 0 else -2 - near[v, 0]
    behind = np.full((k + 2 * len(top), 2), np.int32(-1))
    for place in range(k):
        for gate in range(2):
            met = near[nodes[place], gate]
            if met != -1:
                behind[number[place], gate] = reached[met] if met >= 0 else -2 - met
    for j in range(len(top)):
        met = behind_cuts[j]
        behind[top[j] if upward else top[j] + 1, 0] = reached[met] if met >= 0 else -2 - met
    return behind


@njit(cache=True)
def _merge(behind, upward):
    n = len(behind)
    root = np.arange(n).astype(np.int32)  # the oldest member represents its component
    newest = root.copy()  # the last node of a component
    following, children, partner = np.full(n, np.int32(-1)), np.full((n, 2), np.int32(-1)), np.full(n, np.int32(-1))
    for i in range(n):
        v = i if upward else n - 1 - i
        if behind[v, 0] < 0:
            continue
        old = find(root, behind[v, 0])
        children[v, 0], following[newest[old]] = newest[old], v
        if behind[v, 1] >= 0:
            other = find(root, behind[v, 1])
            if other != old:
                children[v, 1], following[newest[other]] = newest[other], v
                young, old = (max(old, other), min(old, other)) if upward else (min(old, other), max(old, other))
                root[young] = old
                partner[young], partner[v] = v, young
        root[v], newest[old] = old, v
    return following, children, partner


@njit(cache=True)
def prune_leaves(up, down):
    """Arcs (A, 2) of the contour tree, lower end first, from the parents of its nodes in both merge trees.

    A node without children in one tree and with one child in the other is a
    leaf; its arc is the one to its parent. The sum of the children's numbers
    tells the one child where there is one. `up` and `down` are overwritten.
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


@njit(cache=True)
def choose_gates(arcs, children):
    """Through which upper gate of its lower node each arc of the contour tree leaves, (A,) int32, 0 or 1.

    children : (N, 2), those of the downward merge tree. Where two arcs leave,
    they lie in different superlevel components, so the tree is built again,
    and each is found by its upper node.
    """
    n = len(children)
    leaving, gate = np.full((n, 2), np.int32(-1)), np.zeros(len(arcs), np.int32)
    for a in range(len(arcs)):
        leaving[arcs[a, 0], 1 if leaving[arcs[a, 0], 0] >= 0 else 0] = a
    root = np.arange(n)
    for v in range(n - 1, -1, -1):
        one, other = leaving[v]
        if other >= 0:
            crossed = find(root, arcs[one, 1]) != find(root, children[v, 0])
            gate[one if crossed else other] = 1
        for child in children[v]:
            if child >= 0:
                root[find(root, child)] = v
    return gate
