"""The exact Reeb graph of a surface, without levels.

The merge trees of the height, upward and downward, give its contour tree
(:mod:`contour_trees`). A contour tree has no loops, so a surface that has some
is cut first, along one contour right below the top of each loop
(:mod:`loop_cuts`), and the arcs of the contour tree are joined again across the
cuts. Beyond the order of heights, which the mesh already holds, time and memory
grow as the vertices, the faces and the crossings of the cuts, one contour per
unit of genus.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.sorting import sort_stably
from .contour_trees import choose_gates, find_gates, merge_components, prune_leaves
from .loop_cuts import cut_loops, no_cuts
from .ordered_mesh import HeightMesh, check_ordered
from .persistence import extended_pairs
from .value_mesh import ValueMesh


class ReebGraph(NamedTuple):
    """Reeb graph of a closed surface with simple saddles: K nodes, A arcs.

    Attributes
    ----------
    nodes : (K,) int32
        Ranks of the critical points, ascending.
    arcs : (A, 2) int32
        Places in `nodes`, the lower end first, in lexicographic order; two arcs
        may join the same two nodes.
    partner : (K,) int32
        Places in `nodes`: the other member of the one pair of
        :class:`persistence.ExtendedPairs` that each node is in.
    gates : (A,) int32
        Half-edges that run upward from the lower end of each arc into it.
    """

    nodes: np.ndarray
    arcs: np.ndarray
    partner: np.ndarray
    gates: np.ndarray


def surface_reeb_graph(mesh: HeightMesh | ValueMesh) -> ReebGraph:
    """Build the Reeb graph of the height, or of any other function, on a surface.

    Parameters
    ----------
    mesh : HeightMesh or ValueMesh
        Surface of any number of shells whose saddles are simple
        (:func:`height_mesh.height_mesh`, :func:`value_mesh.value_mesh`).

    Returns
    -------
    ReebGraph
        Exact for the order of the ranks: its nodes are all critical points, its
        arcs all components of regular contours, and A - K + shells is the genus.

    References
    ----------
    H. Carr, J. Snoeyink and U. Axen, Computing contour trees in all dimensions,
    Computational Geometry 24 (2003), doi:10.1016/S0925-7721(02)00093-7

    J. Tierny, A. Gyulassy, E. Simon and V. Pascucci, Loop surgery for
    volumetric meshes, IEEE TVCG 15 (2009), doi:10.1109/TVCG.2009.163

    Examples
    --------
    >>> import numpy as np
    >>> from reebslice import height_mesh
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> graph = surface_reeb_graph(height_mesh(points, faces))
    >>> graph.nodes.tolist(), graph.arcs.tolist()
    ([0, 3], [[0, 1]])
    """
    if not isinstance(mesh, ValueMesh):
        check_ordered(mesh)
    gates = find_gates(mesh.faces, mesh.twins, len(mesh.points))
    nodes = np.flatnonzero(gates.rises != 1).astype(np.int32)
    cuts = no_cuts()
    up, down = _merge_trees(mesh.faces, gates, nodes, cuts)
    loose = nodes[(gates.rises[nodes] == 2) & (up.children[:, 1] < 0) & (down.children[:, 1] < 0)]
    if len(loose):
        cuts = cut_loops(mesh, gates, nodes, loose)
        up, down = _merge_trees(mesh.faces, gates, nodes, cuts)
    arcs = prune_leaves(up.following, down.following)
    arcs, gate = _join_cuts(arcs, choose_gates(arcs, down.children), cuts, len(nodes))
    low, high = arcs.T.astype(np.int64)
    order = sort_stably((high, len(nodes)), (low, len(nodes)))
    arcs, gate = arcs[order], gate[order]
    return ReebGraph(nodes, arcs, _find_partners(len(nodes), arcs), gates.out[nodes[arcs[:, 0]], gate])


def _merge_trees(faces, gates, nodes, cuts):
    """The merge tree of the sublevel sets and that of the superlevel sets."""
    up = merge_components(faces, gates.into, nodes, cuts, upward=True)
    return up, merge_components(faces, gates.out, nodes, cuts, upward=False)


def _join_cuts(arcs, gate, cuts, n_critical):
    """Arcs (A, 2) between places of critical points, the two nodes of each cut joined again, and their gates (A,)."""
    place = np.full(n_critical + 2 * len(cuts.top), -1, np.int32)
    critical = np.ones(len(place), bool)
    critical[cuts.top] = critical[cuts.top + 1] = False
    place[critical] = np.arange(n_critical)
    # the arc that ends at a cut from below goes on to the cut's vertex, and there is no other arc at the cut
    place[cuts.top] = place[cuts.top + 2]
    kept = place[arcs[:, 0]] >= 0
    return place[arcs[kept]], gate[kept]


def _find_partners(n_nodes, arcs):
    """The other member (K,) int32 of the pair of each node."""
    pairs = np.concatenate(extended_pairs(n_nodes, arcs))
    partner = np.empty(n_nodes, np.int32)
    partner[pairs[:, 0]], partner[pairs[:, 1]] = pairs[:, 1], pairs[:, 0]
    return partner


def critical_persistence(mesh, graph):
    """Measure the persistence of every vertex.

    Parameters
    ----------
    mesh : HeightMesh or ValueMesh
        Surface of n vertices.
    graph : ReebGraph
        Of the mesh.

    Returns
    -------
    (n,) float64
        Height, or difference of values, between the members of each pair of the
        graph; NaN at regular vertices.
    """
    height = mesh.points[graph.nodes, 2]
    persistence = np.full(len(mesh.points), np.nan)
    persistence[graph.nodes] = np.abs(height - height[graph.partner])
    return persistence
