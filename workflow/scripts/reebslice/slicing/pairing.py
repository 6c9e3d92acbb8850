"""Critical points that cancel inside a slab, by the elder rule.

An upward sweep pairs each minimum with the saddle at which its component
meets an older one; a downward sweep pairs maxima likewise (Edelsbrunner,
Letscher and Zomorodian 2002, doi:10.1007/s00454-002-2885-2). Inside slabs,
whatever enters through a level is older than anything that begins in the slab.
The sweeps run over the surface's Reeb graph, which has the components of all
sublevel and superlevel sets that the surface has.
"""

import numpy as np

from ..arrays.components import find
from ..arrays.grouping import list_incidence
from ..kernels import njit


def pair_in_slabs(graph, of_arcs):
    """Pair the critical points that cancel inside their slab.

    Parameters
    ----------
    graph : ReebGraph
        The surface's, of K nodes and A arcs.
    of_arcs : Groups
        The contours of each arc, upward, as of :func:`.graph_slices.contours_of_arcs`.

    Returns
    -------
    (K,) int32
        Partner of every node, a place in ``graph.nodes``; -1 for the essential ones, which have none. A
        cylinder has no essential critical point and any other elementary piece has one; their alternating
        sum over a piece is its Euler characteristic.
    """
    return _pair_nodes(graph.arcs, list_incidence(graph.arcs, len(graph.nodes)), of_arcs)


@njit
def _pair_nodes(arcs, incidence, of_arcs):
    """Kernel of `pair_in_slabs`: a union-find over nodes and contours for each of the two sweeps.

    What enters through a level has age and birth -1: it is the oldest, and nothing in the slab gave birth to it.
    """
    start, member, offset, contour = incidence.start, incidence.member, of_arcs.start, of_arcs.member
    k, c = len(start) - 1, len(contour)
    partner = np.full(k, -1, np.int32)
    for upward in (True, False):
        root, age, birth = np.arange(k + c), np.full(k + c, -1), np.full(k + c, -1)
        for time in range(k):
            v = time if upward else k - 1 - time
            age[v], birth[v] = time, v
            for i in range(start[v], start[v + 1]):
                arc = member[i]
                if arcs[arc, 1 if upward else 0] != v:
                    continue
                met = np.int64(arcs[arc, 0 if upward else 1])
                if offset[arc] < offset[arc + 1]:
                    met = k + contour[offset[arc + 1] - 1 if upward else offset[arc]]
                a, b = find(root, v), find(root, met)
                if a == b:
                    continue
                if age[a] < age[b]:
                    a, b = b, a
                if birth[a] >= 0 and birth[a] != v:
                    partner[birth[a]], partner[v] = v, birth[a]
                root[a] = b
    return partner
