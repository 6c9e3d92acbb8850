"""The exact Reeb graphs of a surface and of the solid that it bounds, from arrays, without a sampling distance."""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components

from ..arrays.grouping import group_of_members
from ..morse.height_mesh import height_mesh
from ..morse.reeb_graph import critical_persistence, surface_reeb_graph
from ..slicing.refinement import block_chains, exact_slices


class ExactGraph(NamedTuple):
    """A Reeb graph; K nodes, A arcs.

    vertex : (K,) int32, the vertex at which each node lies, upward; a multiple
        saddle is as many nodes as the simple saddles that it unfolds into.
        Where a surface crosses itself, regions may meet at no critical point;
        such a node has some vertex not far above.
    height : (K,) float64, ascending
    arcs : (A, 2) int32, places in `vertex`, the lower end first, in
        lexicographic order; several arcs may join the same two nodes
    """

    vertex: np.ndarray
    height: np.ndarray
    arcs: np.ndarray


def exact_graphs(points, faces, rotation=None, body_of_vertex=None):
    """The Reeb graphs of a surface and of its solid: two :class:`ExactGraph`.

    points : (n, 3) float; faces : (m, 3) int, counter-clockwise seen from
    outside, of a closed, edge-manifold, oriented surface without pinched
    vertices (:mod:`.mesh.repairs` makes them of others); rotation : (3, 3), the
    height is the third row of it times a point, by default z; body_of_vertex :
    (n,) int, where several bodies may overlap, by default all are one.

    The graph of the surface has every critical point of the height, equal
    heights told apart by x, then y (simulation of simplicity). Its loops are
    the genus. That of the solid is its quotient: each contour of a hole is one
    with the outer contour around it. Left out there are pairs of critical
    points at one height, inside flats, that cancel. Both are exact for any
    surface that does not cross itself: nothing is sampled, and what is decided
    by coordinates is decided in rational numbers where rounding leaves it
    open. The solid's takes the contours of the fewest levels that cut every
    arc, and of more only where several events in one part of the solid are
    still between two levels. Time and memory grow as the mesh and, for the
    solid, as the contours of those levels: little if the surface is smooth,
    most of the time if noise makes critical points by the ten thousand.

    Raises ValueError where a mesh edge has no twin, and TooManyCrossingsError where
    the solid's would need hundreds of millions of points, as of white noise.
    """
    mesh = height_mesh(points, faces, rotation)
    graph = surface_reeb_graph(mesh)
    body = np.zeros(len(mesh.points), np.int32) if body_of_vertex is None else np.asarray(body_of_vertex)[mesh.vertex]
    return _as_found(mesh, graph.nodes, graph.arcs), _as_found(mesh, *solid_reeb_graph(mesh, graph, body))


def _as_found(mesh, ranks, arcs):
    return ExactGraph(mesh.vertex[ranks], mesh.points[ranks, 2], arcs)


def solid_reeb_graph(mesh, graph, body_of_vertex):
    """Nodes (K,) ranks, ascending, and arcs (A, 2), places in them, of the solid's Reeb graph.

    graph : the mesh's :class:`reeb_graph.ReebGraph`; body_of_vertex : (n,).
    """
    slices = exact_slices(mesh, graph, body_of_vertex)
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
