"""Merge trees of the height on a surface, and the contour tree that they make.

Two sweeps, upward and downward, give the merge trees, and those give the
contour tree (Carr, Snoeyink and Axen 2003, doi:10.1016/S0925-7721(02)00093-7).
Only critical points are merged: a regular vertex belongs to the component of
the vertex behind it, on the side that the sweep comes from. The surface may be
cut along contours; the nodes are then the critical points and two per cut,
numbered as :mod:`loop_cuts` says.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.components import find
from ..kernels import njit
from .loop_cuts import code_of_node, divert, number_nodes


class Gates(NamedTuple):
    """Ways from every vertex down and up, one through each wedge of its link.

    A wedge is a run of the link on one side of the vertex's height. A regular
    vertex has one lower and one upper wedge, a simple saddle two of either.

    Attributes
    ----------
    rises : (n,) int32
        Upper wedges where there are lower ones as well: 1 at a regular vertex,
        0 at an extremum.
    into : (n, 2) int32
        Upward half-edges that arrive from the first two lower wedges, -1 where
        there is none.
    out : (n, 2) int32
        Upward half-edges that leave into the first two upper wedges, -1 where
        there is none.
    """

    rises: np.ndarray
    into: np.ndarray
    out: np.ndarray


class MergeTree(NamedTuple):
    """How the components of the sublevel sets, or of the superlevel sets, of N nodes unite.

    Attributes
    ----------
    following : (N,) int32
        The next node in the component of each, -1 for none.
    children : (N, 2) int32
        The nodes that each follows, in the order of its gates, -1 for none; two
        where it unites two components.
    """

    following: np.ndarray
    children: np.ndarray


@njit
def find_gates(faces, twins, n):
    """Find a way down and a way up through each wedge of every link.

    Parameters
    ----------
    faces : (m, 3) int32
        Ranks, with the lowest corner first.
    twins : (3 m,) int32
        Of the mesh.
    n : int
        Number of vertices.

    Returns
    -------
    Gates
        Of vertices with more than two wedges, as multiple saddles have, of the
        first two.
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
    return Gates(rises, into, out)


def merge_components(faces, gates, nodes, cuts, upward, ties=None):
    """Build the merge tree of the sublevel sets or, downward, of the superlevel sets.

    Parameters
    ----------
    faces : (m, 3) int32
        Of the mesh.
    gates : (n, 2) int32
        `Gates.into` for the upward sweep, `Gates.out` for the downward one.
    nodes : (K,) int32
        Ranks of the critical points, ascending.
    cuts : Cuts
        J contours along which the surface is cut.
    upward : bool
        Which way the sweep goes.
    ties : (T,) int and (T,) int, optional
        Extrema at which the sweep begins components, and what else each hangs together with: a vertex that the
        sweep comes to before, or the code of a cut's node.

    Returns
    -------
    MergeTree
        Over N = K + 2 J nodes.
    """
    near = _neighbours(faces, gates, upward)
    behind_cuts = divert(near, faces, gates, cuts, upward) if len(cuts.vertex) else cuts.top
    if ties is not None:
        near[ties[0], 0] = ties[1]
    return _merge(_step_back(near, nodes, number_nodes(nodes, cuts), cuts.top, behind_cuts, upward), upward)


@njit
def _neighbours(faces, gates, upward):
    """The vertex behind each gate, (n, 2) int32, -1 for none."""
    near, ends = np.empty(gates.shape, np.int32), faces.ravel()
    for v in range(len(gates)):
        for k in range(2):
            h = gates[v, k]
            near[v, k] = -1 if h < 0 else ends[h] if upward else ends[h + 1 if h % 3 < 2 else h - 2]
    return near


@njit
def _step_back(near, nodes, number, top, behind_cuts, upward):
    """A node of the component that a sweep finds behind each gate of each node, (N, 2) int32, -1 for none.

    near : (n, 2) the vertex behind each gate, or the code of a cut's node; behind_cuts : (J,) likewise.
    """
    n, k = len(near), len(nodes)
    reached = np.empty(n, np.int32)  # the node that is met from each vertex, going back through the first gates
    place = 0 if upward else k - 1
    for i in range(n):
        v = i if upward else n - 1 - i
        if 0 <= place < k and nodes[place] == v:
            reached[v] = number[place]
            place += 1 if upward else -1
        else:
            reached[v] = reached[near[v, 0]] if near[v, 0] >= 0 else code_of_node(near[v, 0])
    behind = np.full((k + 2 * len(top), 2), np.int32(-1))
    for place in range(k):
        for gate in range(2):
            met = near[nodes[place], gate]
            if met != -1:
                behind[number[place], gate] = reached[met] if met >= 0 else code_of_node(met)
    for j in range(len(top)):
        met = behind_cuts[j]
        behind[top[j] if upward else top[j] + 1, 0] = reached[met] if met >= 0 else code_of_node(met)
    return behind


@njit
def _merge(behind, upward):
    """The merge tree of nodes behind whose gates `behind` (N, 2) lie, by union-find."""
    n = len(behind)
    root = np.arange(n).astype(np.int32)
    newest = root.copy()  # the last node of each component, at its root
    following, children = np.full(n, np.int32(-1)), np.full((n, 2), np.int32(-1))
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
                root[young] = old  # the older component is as a rule the larger one, so ways to the root stay short
        root[v], newest[old] = old, v
    return MergeTree(following, children)


@njit
def prune_leaves(up, down):
    """Build the contour tree from both merge trees, leaf by leaf.

    A node without children in one tree and with one child in the other is a
    leaf; its arc is the one to its parent. The sum of the children's numbers
    tells the one child where there is one.

    Parameters
    ----------
    up, down : (N,) int32
        `MergeTree.following` of the upward and of the downward sweep; both are
        overwritten.

    Returns
    -------
    (A, 2) int32
        Arcs, the lower end first; N - 1 for each component of the surface that
        has N nodes.

    References
    ----------
    H. Carr, J. Snoeyink and U. Axen, Computing contour trees in all dimensions,
    Computational Geometry 24 (2003), algorithm 4.2,
    doi:10.1016/S0925-7721(02)00093-7
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


@njit
def choose_gates(arcs, children):
    """Tell through which upper gate of its lower node each arc of the contour tree leaves.

    Parameters
    ----------
    arcs : (A, 2) int32
        Of the contour tree, the lower end first.
    children : (N, 2) int32
        `MergeTree.children` of the downward sweep, in the order of the gates.

    Returns
    -------
    (A,) int32
        0 or 1. Where two arcs leave, they lie in different superlevel
        components, so the merge tree is built again, and each arc is found by
        its upper node.
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
