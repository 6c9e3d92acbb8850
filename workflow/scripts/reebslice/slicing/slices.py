"""A surface cut at given levels: contours, regions, pieces and blocks."""

from typing import NamedTuple

import numpy as np

from .blocks import find_blocks, host_unseen_voids
from .contours import Contours, trace_blocks, trace_contours, trace_crossings
from .graph_slices import pieces_of_graph, trace_arcs_at_levels
from .levels import Levels, make_levels
from .pairing import pair_in_slabs
from .pieces import Pieces, find_pieces
from .regions import Regions, find_regions


class Slices(NamedTuple):
    """A surface cut at a set of levels.

    block_of_piece : (P,), block_above, block_below : (R,) int32, the blocks
    that each piece bounds and each region faces.
    """

    levels: Levels
    contours: Contours
    pieces: Pieces
    regions: Regions
    block_of_piece: np.ndarray
    block_above: np.ndarray
    block_below: np.ndarray
    n_blocks: int


def nested_contours(mesh, heights, body_of_vertex=None):
    """The level sets of a surface at ascending heights, and no more: (:class:`Contours`, :class:`Regions`).

    mesh : :func:`height_mesh.height_mesh` makes it of points, faces and a rotation
    body_of_vertex : (n,) int32, where bodies may overlap; a hole belongs to a contour of its body
    """
    levels = make_levels(mesh, heights)
    return _nest(mesh, levels, trace_contours(mesh, levels), body_of_vertex)


def nested_blocks(mesh, heights, most_crossings, body_of_vertex=None):
    """The same, of a few consecutive levels at a time, where all would not fit into memory.

    An iterator of (:class:`Contours`, :class:`Regions`) whose blocks are those
    of :func:`contours.trace_blocks`; regions and contours are numbered in each
    block from 0, and in the order of blocks they are those of all levels.
    """
    levels = make_levels(mesh, heights)
    for contours in trace_blocks(mesh, levels, most_crossings):
        yield _nest(mesh, levels, contours, body_of_vertex)


def _nest(mesh, levels, contours, body_of_vertex):
    body = np.zeros(len(contours.level), np.int32) if body_of_vertex is None else body_of_vertex[contours.lower]
    return contours, find_regions(mesh, levels, contours, body)


def cut_surface(mesh, levels, body_of_vertex):
    """Cut at the given levels: :class:`Slices`. body_of_vertex : (n,) int32."""
    return _finish(mesh, levels, body_of_vertex, *trace_crossings(mesh, levels))


def _finish(mesh, levels, body_of_vertex, contours, crossings, regions=None):
    pieces = find_pieces(mesh, levels, contours, crossings, *pair_in_slabs(mesh, levels, contours, crossings))
    if regions is None:
        regions = find_regions(mesh, levels, contours, body_of_vertex[contours.lower], pieces)
    hosts = host_unseen_voids(mesh, levels, crossings, pieces, body_of_vertex)
    return Slices(levels, contours, pieces, regions, *find_blocks(pieces, contours, regions, hosts))


def cut_along_arcs(mesh, graph, levels, body_of_vertex):
    """The :class:`Slices` by the surface's Reeb graph: fast, and without the areas and fluxes of pieces.

    Pieces come in any order, and `pieces.of_vertex` knows the critical points alone.
    """
    contours, of_arcs = trace_arcs_at_levels(mesh, graph, levels)
    return _block_along_arcs(mesh, graph, levels, body_of_vertex, contours, of_arcs)


def _block_along_arcs(mesh, graph, levels, body_of_vertex, contours, of_arcs):
    pieces = pieces_of_graph(mesh, graph, levels, contours, of_arcs)
    if (pieces.n_below + pieces.n_above == 0).any():  # it takes faces to tell where a void inside a slab is
        return cut_surface(mesh, levels, body_of_vertex)
    regions = find_regions(mesh, levels, contours, body_of_vertex[contours.lower], pieces)
    return Slices(levels, contours, pieces, regions, *find_blocks(pieces, contours, regions, {}))
