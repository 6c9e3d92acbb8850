"""The Reeb graph of a solid from merge trees of its surface that plumb lines tie together.

**Without loops** the Reeb graph is the contour tree, and that follows from the
two merge trees: of the sublevel sets of the solid and of its superlevel sets
(Carr, Snoeyink and Axen 2003, doi:10.1016/S0925-7721(02)00093-7), for any
nodes that are asked for; here these are all critical points of the surface,
those of holes too, which pass arcs of the solid.

The merge tree of the sublevel sets of the solid M is that of the surface S,
with one tie more: at each minimum where void begins (``->i``) a plumb line runs
down through the material to the first face that it meets, and ties the
minimum to the lowest corner of that face, which it reaches without rising.
Claim: at every height h the sublevel set of S with the ties below h has a
component in each component of M's, and just one. As h rises past a critical
point,

* ``->o`` begins a component of both;
* ``->i`` begins one of S and none of M, and its tie joins it to what is below
  it in M;
* a saddle where void ends above (side A) glues a band to M between two places
  of contours that meet in the saddle: where these are of two components of M,
  both unite, and so do, by the same saddle, two of S;
* any other event leaves the components of M alone, and what it unites of S was
  in one component of M, and so, by the claim below h, of the ties.

The superlevel sets are the same upside down: lines run up from each maximum
where void ends (``i->``). Where a line passes exactly above a mesh edge, either
of its faces will do.

**Loops** are cut. M between two levels and its complement there have a slab in
common with S as their intersection, so by Mayer and Vietoris every loop of M
between the levels comes from loops of S; and both map onto their Reeb graphs.
So where levels pierce each loop of the surface's Reeb graph, the solid's is a
forest between consecutive levels. Few levels pierce them all
(:mod:`.solid_levels`). Each region of a level is a leaf of the tree below it
and one of the tree above, whose arcs are one; a line that comes to a level
ends in the region there.

| what | needs |
| --- | --- |
| merge trees | the order of ranks |
| which extrema are of voids | signs of contours (:mod:`.outer_arcs`) |
| ends of lines | signs of determinants (:mod:`.plumb_lines`, :mod:`.exact_lines`) |
| regions of levels | nesting of contours (:mod:`..slicing.regions`) |

The signs of all contours tell which event each node is, and so how many arcs
end and begin there. Trees know nothing of these signs but at extrema, so that
a surface that crosses itself hardly fits both.
"""

import numpy as np

from ..kernels import njit
from ..mesh.exact_signs import scale_points
from ..morse.contour_trees import find_gates, merge_components, prune_leaves
from ..morse.loop_cuts import number_nodes
from .exact_lines import settle_hits
from .outer_arcs import find_inner_arcs
from .plumb_lines import meet_faces
from .solid_levels import cut_at_loops, end_lines


def solid_graph_by_trees(mesh, graph, body_of_vertex):
    """Build the Reeb graph of the solid from that of its surface, every event a node.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    graph : ReebGraph
        Of the mesh, of K nodes.
    body_of_vertex : (n,) int32
        Bodies that may overlap.

    Returns
    -------
    (A, 2) int64 or None
        Arcs between places in `graph.nodes`, the lower end first, in lexicographic order; nodes and order of events
        are those of the ranks. None where lines or trees fit no solid, and where two vertices are at one place or a
        vertex is on a face.

    Raises
    ------
    TooManyCrossingsError
        The surface has so many loops apart from each other that contours that pierce them do not fit into memory.
    """
    if _touches_itself(mesh):
        return None
    gates = find_gates(mesh.faces, mesh.twins, len(mesh.points))
    inner = find_inner_arcs(mesh, graph, gates.into)
    if inner is None:
        return None
    vertices, upward = _ends_of_void(graph, inner)
    scaled = scale_points(mesh.points)
    hits = meet_faces(scaled, mesh.faces, body_of_vertex, vertices, upward)
    if hits is None:
        return None
    if (hits.winding != np.where(upward, 1, -1)).any():
        return None
    hits = settle_hits(mesh, scaled, body_of_vertex, (vertices, upward), hits)
    if hits is None or (hits.rises != upward).any():
        return None
    cut = cut_at_loops(mesh, graph, body_of_vertex)
    behind = end_lines(mesh, cut, body_of_vertex, (vertices, upward), hits)
    if behind is None:
        return None
    ways, ties = (gates.into, gates.out), [(vertices[side], behind[side]) for side in (~upward, upward)]
    up, down = (
        merge_components(mesh.faces, way, graph.nodes, cut.cuts, sweep_up, tie)
        for way, sweep_up, tie in zip(ways, (True, False), ties)
    )
    arcs = _graph_of_trees(up.following, down.following, number_nodes(graph.nodes, cut.cuts), cut.cuts.top)
    return arcs if arcs is not None and _fits_events(graph, inner, arcs) else None


def _touches_itself(mesh):
    """Whether two vertices are at one place, where no line tells sheets of the surface apart.

    Copies of an unfolded saddle are one vertex; and what is at one place is next to each other in order.
    """
    return ((mesh.points[1:] == mesh.points[:-1]).all(axis=1) & (mesh.vertex[1:] != mesh.vertex[:-1])).any()


def _ends_of_void(graph, inner):
    """Extrema where void begins or ends: ranks (Q,), ascending, and whether material is above, (Q,) bool."""
    begins, ends = (np.bincount(graph.arcs[inner, k], minlength=len(graph.nodes)) > 0 for k in (0, 1))
    void = np.flatnonzero((begins | ends) & (np.bincount(graph.arcs.ravel()) == 1))
    return graph.nodes[void].astype(np.int64), ends[void]


def _fits_events(graph, inner, arcs):
    """Whether as many arcs end and begin at each node of the solid's graph as outer contours do.

    The contour around the event counts for both where the one contour below or above is a hole.
    """
    count, outer = len(graph.nodes), graph.arcs[~inner]
    ends = [np.bincount(graph.arcs[:, k], minlength=count) for k in (0, 1)]
    own = [np.bincount(outer[:, k], minlength=count) for k in (0, 1)]
    hosted = ((ends[0] == 1) & (own[0] == 0)) | ((ends[1] == 1) & (own[1] == 0))
    return all((np.bincount(arcs[:, k], minlength=count) == own[k] + hosted).all() for k in (0, 1))


def _graph_of_trees(up, down, number, top):
    """Arcs (A, 2) between critical points, in lexicographic order, or None where the trees make no forest.

    up, down : (N,) `MergeTree.following`; number : (K,) of the critical points; top : (J,) of the cuts' lower nodes.
    """
    roots = (up < 0).sum()
    if roots != (down < 0).sum():
        return None
    arcs = prune_leaves(up, down)
    if len(arcs) != len(up) - roots:
        return None
    joined = _join_regions(arcs.astype(np.int64), number, top.astype(np.int64))
    if joined is None:
        return None
    return joined[np.lexsort(joined.T[::-1])]


@njit
def _join_regions(arcs, number, top):
    """Arcs between critical points, where an arc that ends at a cut goes on above it; None if any goes on in two.

    arcs : (A, 2) between all nodes; number, top : as for `_graph_of_trees`.
    """
    count = len(number) + 2 * len(top)
    place, ahead, ends = np.full(count, -1), np.full(count, -1), np.zeros(count, np.int64)
    for k in range(len(number)):
        place[number[k]] = k
    for low, high in arcs:
        ends[low] += 1
        ends[high] += 1
        if place[low] < 0:
            ahead[low] = high
    for node in top:
        if ends[node] != 1 or ends[node + 1] != 1 or ahead[node] >= 0 or ahead[node + 1] < 0:
            return None
    joined, kept = np.empty((len(arcs), 2), np.int64), 0
    for low, high in arcs:
        if place[low] >= 0:
            while place[high] < 0:
                high = ahead[high + 1]
            joined[kept, 0], joined[kept, 1] = place[low], place[high]
            kept += 1
    return joined[:kept]
