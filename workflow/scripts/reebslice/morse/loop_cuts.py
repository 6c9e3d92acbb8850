"""Cuts that open the loops of a surface, one contour right below the top of each.

J. Tierny, A. Gyulassy, E. Simon and V. Pascucci (2009,
doi:10.1109/TVCG.2009.163) do so in volumes.

Numbers of nodes: the critical points are 0, 1, ... in order of rank, and each
cut adds two nodes right below its vertex: cuts.top[j], the highest point of
the surface below cut j, and cuts.top[j] + 1, the lowest point of the surface
above it. So the cut's vertex itself is node cuts.top[j] + 2.
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from .ordered_mesh import next_half_edge


class Cuts(NamedTuple):
    """Contours along which a surface is cut: J of them, cut j between the ranks vertex[j] - 1 and vertex[j].

    Attributes
    ----------
    vertex : (J,) int32
        Ranks, ascending.
    top : (J,) int32
        Number of the node right below each cut.
    first : (J,) int32
        One half-edge that each cut crosses.
    half_edge, cut : (X,) int32
        All crossings: the upward half-edge and which cut crosses it, in order
        of half-edge, then of level.
    """

    vertex: np.ndarray
    top: np.ndarray
    first: np.ndarray
    half_edge: np.ndarray
    cut: np.ndarray


def no_cuts():
    """Make the `Cuts` of a surface that stays whole."""
    return Cuts(*(np.zeros(0, np.int32) for _ in Cuts._fields))


def number_nodes(nodes, cuts):
    """Number the critical points so that the nodes of the cuts have their places in between.

    Parameters
    ----------
    nodes : (K,) int32
        Ranks of the critical points, ascending.
    cuts : Cuts
        J cuts.

    Returns
    -------
    (K,) int32
        The number of each critical point among all K + 2 J nodes.
    """
    cuts_below = np.searchsorted(cuts.vertex, nodes, side="right")  # that of a node itself among them
    return (np.arange(len(nodes)) + 2 * cuts_below).astype(np.int32)


def cut_loops(mesh, gates, nodes, loose):
    """Choose one contour right below each saddle that has two there.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    gates : Gates
        Of the mesh.
    nodes : (K,) int32
        Ranks of the critical points, ascending.
    loose : (L,) int32
        Ranks of the saddles that may be the top of a loop, ascending: those
        that unite no two components, neither upward nor downward.

    Returns
    -------
    Cuts
        One per loop; of the two contours the one with fewer crossings.
    """
    length, start = _measure_cuts(mesh.faces, mesh.twins, gates.into, loose)
    tops = length > 0
    if not tops.any():
        return no_cuts()
    vertex, first, length = loose[tops], start[tops], length[tops]
    half_edge = _walk_cuts(mesh.faces, mesh.twins, vertex, first, int(length.sum()))
    cut = np.repeat(np.arange(len(vertex), dtype=np.int32), length)
    order = np.lexsort((cut, half_edge))
    top = np.searchsorted(nodes, vertex) + 2 * np.arange(len(vertex))  # as many nodes below it, and of so many cuts
    return Cuts(vertex, top.astype(np.int32), first, half_edge[order], cut[order])


@njit
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


@njit
def _walk_cuts(faces, twins, vertex, first, total):
    """The half-edges that the cuts cross, cut after cut, `total` of them."""
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


@njit(inline="always")
def code_of_node(node):
    """Code the node of a cut so that it is told from a vertex (>= 0) and from none (-1).

    Parameters
    ----------
    node : int
        Number of a node, or its code.

    Returns
    -------
    int
        -2 - node, at most -2; the code of a code is the node again.
    """
    return -2 - node


@njit
def divert(near, faces, gates, cuts, upward):
    """Stop the ways from vertex to vertex at the cuts that they cross.

    Parameters
    ----------
    near : (n, 2) int32
        The vertex behind each gate, -1 for none. In place, where a cut crosses
        a gate, the code of the cut's node on this side takes the vertex's place.
    faces : (m, 3) int32
        Of the mesh.
    gates : (n, 2) int32
        The gates through which the sweep looks back: `Gates.into` upward,
        `Gates.out` downward.
    cuts : Cuts
        J cuts.
    upward : bool
        Whether the sweep goes upward, and so looks back downward.

    Returns
    -------
    (J,) int32
        What is behind each cut: a vertex, or the code of another cut's node.
    """
    half_edge, cut, top = cuts.half_edge, cuts.cut, cuts.top
    behind, back = np.empty(len(top), np.int32), -1 if upward else 1
    for place in range(len(cut)):
        h = half_edge[place]
        tail, head = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        vertex, far = (head, tail) if upward else (tail, head)
        if cuts.first[cut[place]] == h:
            crossed = 0 <= place + back < len(cut) and half_edge[place + back] == h
            behind[cut[place]] = _code_of_cut(top[cut[place + back]], upward) if crossed else far
        if not 0 <= place - back < len(cut) or half_edge[place - back] != h:
            for k in range(2):
                if gates[vertex, k] == h:
                    near[vertex, k] = _code_of_cut(top[cut[place]], upward)
    return behind


@njit(inline="always")
def _code_of_cut(top, upward):
    """Code of the node of a cut that a sweep comes from: upward, the one above the cut."""
    return code_of_node(top + 1 if upward else top)
