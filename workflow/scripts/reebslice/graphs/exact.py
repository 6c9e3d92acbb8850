"""The exact Reeb graphs of a surface and of the solid that it bounds, from arrays, without a sampling distance."""

from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse
from numpy.typing import ArrayLike
from scipy.sparse.csgraph import connected_components

from ..arrays.grouping import group_of_members
from ..errors import TooManyCrossingsError
from ..morse.height_mesh import height_mesh_of_bodies
from ..morse.reeb_graph import critical_persistence, surface_reeb_graph
from ..slicing.crowding import block_chains
from ..slicing.refinement import exact_slices
from .flat_pairs import cancel_pairs, find_flat_pairs
from .solid_by_trees import solid_graph_by_trees

LARGEST = 300  # exponent of coordinates, and negative: areas of contours neither overflow nor underflow
FEW_CROSSINGS = 100_000  # points of contours that are traced in some hundredths of a second


class ExactGraph(NamedTuple):
    """A Reeb graph of K nodes and A arcs.

    Attributes
    ----------
    vertex : (K,) int32
        The vertex at which each node lies, upward; a multiple saddle is as many
        nodes as the simple saddles that it unfolds into. Where a surface crosses
        itself, regions may meet at no critical point; such a node has some
        vertex not far above.
    height : (K,) float64
        Ascending, mesh units.
    arcs : (A, 2) int32
        Places in `vertex`, the lower end first, in lexicographic order; several
        arcs may join the same two nodes.
    """

    vertex: np.ndarray
    height: np.ndarray
    arcs: np.ndarray

    def to_networkx(self):
        """Convert to networkx.

        Returns
        -------
        networkx.MultiGraph
            Node k has the attributes `vertex` and `height`; edges are keyed by
            the number of their arc, so parallel arcs are kept.
        """
        import networkx  # not among the packages that the library itself needs

        graph = networkx.MultiGraph()
        rows = zip(self.vertex.tolist(), self.height.tolist())
        graph.add_nodes_from((k, {"vertex": vertex, "height": height}) for k, (vertex, height) in enumerate(rows))
        graph.add_edges_from((low, high, number) for number, (low, high) in enumerate(self.arcs.tolist()))
        return graph


def exact_graphs(
    points: Any,
    faces: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
    body_of_vertex: ArrayLike | None = None,
) -> tuple[ExactGraph, ExactGraph]:
    """Build the Reeb graphs of a surface and of the solid that it bounds.

    Both are exact for any surface that does not cross itself: nothing is
    sampled, and what is decided by coordinates is decided in rational numbers
    where rounding leaves it open. The solid's graph takes the
    contours of the fewest levels that leave no events together, where these are
    few; else it is made from merge trees of the surface, which a plumb line at
    each extremum of a void ties together (:mod:`.graphs.solid_by_trees`), so
    noise that makes critical points by the hundred thousand costs little. Where
    the surface crosses itself and plumb lines find out, contours have to do;
    time and memory then grow as these.

    Parameters
    ----------
    points : (n, 3) float, mesh units
        Or, with `faces` left out, a `trimesh.Trimesh`, a `pyvista.PolyData` or a :class:`HeightMesh`.
    faces : (m, 3) int
        Counter-clockwise seen from outside, of a closed, oriented surface
        without pinched vertices (:func:`inspect_surface` makes one of others).
    rotation : (3, 3) float, optional
        The height is its third row times a point; by default z.
    body_of_vertex : (n,) int, optional
        Bodies that may overlap; by default all are one.

    Returns
    -------
    surface : ExactGraph
        Every critical point of the height is a node, equal heights told apart by
        x, then y (simulation of simplicity). Its loops are the genus.
    solid : ExactGraph
        The quotient in which each contour of a hole is one with the outer
        contour around it. Pairs of critical points at one height, inside flats,
        that cancel are left out.

    Raises
    ------
    NotASolidError
        The mesh is not as above; the message says where, and the cure.
    ReebsliceError
        The rotation or the bodies are none.
    TooManyCrossingsError
        The surface crosses itself, or has loops at very many heights, and the
        solid's graph would need hundreds of millions of points;
        :func:`surface_reeb_graph` needs none.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> surface, solid = exact_graphs(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> solid.height.tolist(), solid.arcs.tolist()
    ([0.0, 1.0], [[0, 1]])
    """
    mesh, body = height_mesh_of_bodies(points, faces, rotation, body_of_vertex)
    graph = surface_reeb_graph(mesh)
    return _name_vertices(mesh, graph.nodes, graph.arcs), _name_vertices(mesh, *solid_reeb_graph(mesh, graph, body))


def _name_vertices(mesh, ranks, arcs):
    """The :class:`ExactGraph` of nodes that are given by their ranks."""
    return ExactGraph(mesh.vertex[ranks], mesh.points[ranks, 2], arcs)


def solid_reeb_graph(mesh, graph, body_of_vertex):
    """Build the Reeb graph of the solid from that of its surface, in the way that costs less.

    Parameters
    ----------
    mesh, graph, body_of_vertex
        As for :func:`merged_solid_graph`.

    Returns
    -------
    nodes, arcs
        As of :func:`merged_solid_graph`.
    """
    exponent = int(np.frexp(np.abs(mesh.points).max(initial=0.0))[1])
    if abs(exponent) > LARGEST:
        mesh = mesh._replace(points=np.ldexp(mesh.points, -exponent))
    most = max(FEW_CROSSINGS, len(mesh.faces) // 4)  # merge trees take a visit to every face
    # each arc is crossed, by a contour of three points at least; and of flat pairs slices keep some
    if 3 * len(graph.arcs) <= most and not len(find_flat_pairs(mesh.points[graph.nodes, 2], graph)):
        with suppress(TooManyCrossingsError):
            return sliced_solid_graph(mesh, graph, body_of_vertex, most)
    return merged_solid_graph(mesh, graph, body_of_vertex)


def merged_solid_graph(mesh, graph, body_of_vertex):
    """Build the Reeb graph of the solid from that of its surface by merge trees or, where these fit none, by slices.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    graph : ReebGraph
        Of the mesh.
    body_of_vertex : (n,) int32

    Returns
    -------
    nodes : (K,) int32
        Ranks, ascending. Pairs of :mod:`.flat_pairs` are left out.
    arcs : (A, 2) int32
        Places in `nodes`, in lexicographic order.
    """
    arcs = solid_graph_by_trees(mesh, graph, body_of_vertex)
    if arcs is None:
        return sliced_solid_graph(mesh, graph, body_of_vertex)
    pairs = find_flat_pairs(mesh.points[graph.nodes, 2], graph)
    if len(pairs):
        arcs = cancel_pairs(arcs, len(graph.nodes), pairs)
    kept, place = np.unique(arcs, return_inverse=True)
    arcs = place.reshape(-1, 2).astype(np.int32)
    return graph.nodes[kept], arcs[np.lexsort(arcs.T[::-1])]


def sliced_solid_graph(mesh, graph, body_of_vertex, most=None):
    """Do as :func:`merged_solid_graph` by slices, for surfaces that cross themselves as well.

    Parameters
    ----------
    mesh, graph, body_of_vertex
        As for :func:`merged_solid_graph`.
    most : int, optional
        Points that contours may have in all; by default as many as fit into memory.

    Returns
    -------
    nodes, arcs
        As of :func:`merged_solid_graph`; but a pair of equal height stays where a level parts it for others' sake.

    Raises
    ------
    TooManyCrossingsError
        There would be more points.
    """
    slices = exact_slices(mesh, graph, body_of_vertex, most)
    node, block = _nodes_of_blocks(slices, critical_persistence(mesh, graph))
    first, last = (np.searchsorted(block, np.arange(slices.n_blocks), side=side) for side in ("left", "right"))
    plain = first == last
    # regions that plain blocks link make an arc
    count = len(slices.regions.level)
    above = np.full(slices.n_blocks, -1)
    above[slices.block_below] = np.arange(count)
    low = np.flatnonzero(plain[slices.block_above])
    links = sparse.coo_array((np.ones(len(low), bool), (low, above[slices.block_above[low]])), shape=(count, count))
    n_arcs, arc = connected_components(links, directed=False)
    lowest, highest = np.full(n_arcs, count), np.full(n_arcs, -1)
    np.minimum.at(lowest, arc, np.arange(count))
    np.maximum.at(highest, arc, np.arange(count))
    arcs = np.column_stack([last[slices.block_below[lowest]] - 1, first[slices.block_above[highest]]])
    chained = np.flatnonzero(block[:-1] == block[1:])
    arcs = np.concatenate([arcs, np.column_stack([chained, chained + 1])])
    order = np.argsort(node, kind="stable")
    place = np.argsort(order, kind="stable")
    arcs = place[arcs].astype(np.int32)
    return node[order], arcs[np.lexsort(arcs.T[::-1])]


def _nodes_of_blocks(slices, persistence):
    """Ranks of the nodes (K,) and their blocks, in order of blocks, then of ranks.

    In a chain every event is a node, and in any other block the most
    persistent, the lowest such. A surface that crosses itself may have blocks
    that join regions without an event.
    """
    essential, block = slices.pieces.critical.member, slices.block_of_piece[group_of_members(slices.pieces.critical)]
    order = np.lexsort((essential, -persistence[essential], block))
    essential, block = essential[order], block[order]
    kept = block_chains(slices)[block] | np.append(True, block[1:] != block[:-1])
    odd, lowest = _odd_blocks(slices, block)
    ranks, block = np.append(essential[kept], lowest), np.append(block[kept], odd)
    order = np.lexsort((ranks, block))
    return ranks[order], block[order]


def _odd_blocks(slices, block):
    """Blocks without events (`block` has some) that link no region to just one other, and the lowest rank there."""
    count = slices.n_blocks
    is_odd = np.bincount(slices.block_above, minlength=count) != 1
    is_odd |= np.bincount(slices.block_below, minlength=count) != 1
    is_odd[block] = False
    slab = np.empty(count, np.int32)
    slab[slices.block_of_piece] = slices.pieces.slab
    return np.flatnonzero(is_odd), np.append(slices.levels.below, 0)[slab[is_odd]]
