"""A surface cut at given levels: contours, regions, pieces and blocks.

There are two ways to a slice, and two questions. `nested_contours` gives the
level sets alone, contours and the regions that they bound (`nested_blocks` a
few levels at a time). `cut_surface` also gives what lies between the levels:
pieces and blocks. It visits every face, so it can measure the pieces, and it
takes the pieces from the surface's Reeb graph, which costs less than a search
on the mesh. `cut_along_arcs` visits only what the levels cross, and measures
nothing: for few levels on a large mesh, as the solid's Reeb graph needs them.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ReebsliceError
from ..morse.ordered_mesh import HeightMesh, check_ordered
from ..morse.reeb_graph import surface_reeb_graph
from .blocks import find_blocks, host_unseen_voids
from .contours import Contours, trace_blocks, trace_contours, trace_crossings
from .graph_slices import contours_of_arcs, trace_arcs_at_levels
from .levels import Levels, make_levels
from .pieces import Pieces, PieceSurfaces, find_pieces, measure_pieces
from .regions import Regions, find_regions


class Slices(NamedTuple):
    """A surface cut at a set of levels into C contours, P pieces, R regions and B blocks.

    Attributes
    ----------
    levels : Levels
        The cuts.
    contours : Contours
        The surface at the levels.
    pieces : Pieces
        The surface between the levels.
    regions : Regions
        The material at the levels.
    block_of_piece : (P,) int32
        The block, a connected component of the material between two levels, that each piece bounds.
    block_above, block_below : (R,) int32
        The block on the upper and on the lower side of every region.
    n_blocks : int
        Number of blocks.
    surfaces : PieceSurfaces or None
        Vertices, areas and fluxes of the pieces; None from :func:`cut_along_arcs`, which visits no faces for them.
    """

    levels: Levels
    contours: Contours
    pieces: Pieces
    regions: Regions
    block_of_piece: np.ndarray
    block_above: np.ndarray
    block_below: np.ndarray
    n_blocks: int
    surfaces: PieceSurfaces | None


def nested_contours(
    mesh: HeightMesh, heights: ArrayLike, body_of_vertex: np.ndarray | None = None
) -> tuple[Contours, Regions]:
    """Cut a surface at heights, and tell which contours lie inside which.

    Parameters
    ----------
    mesh : HeightMesh
        Closed surface of n vertices, in order of height.
    heights : (K,) array_like of float
        Ascending heights of the levels, mesh units.
    body_of_vertex : (n,) int32, optional
        Bodies that may overlap; a hole belongs to an outer contour of its own body. By default all are one.

    Returns
    -------
    contours : Contours
        Closed contours with material on their left; their order does not depend on that of the input.
    regions : Regions
        Outer contours with their holes. What is closer than rounding is decided in rational numbers.

    Raises
    ------
    TooManyCrossingsError
        The contours would not fit into memory; :func:`nested_blocks` gives them in parts.

    Examples
    --------
    >>> import numpy as np
    >>> from reebslice import height_mesh
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> contours, regions = nested_contours(height_mesh(points, faces), [0.05, 0.5])
    >>> contours.level.tolist(), regions.area.round(4).tolist()
    ([0, 1], [0.0625, 0.1736])
    """
    levels = make_levels(mesh, _take_heights(mesh, heights))
    return _nest(mesh, levels, trace_contours(mesh, levels), body_of_vertex)


def nested_blocks(
    mesh: HeightMesh, heights: ArrayLike, most_crossings: int, body_of_vertex: np.ndarray | None = None
) -> Iterator[tuple[Contours, Regions]]:
    """Do as :func:`nested_contours`, a few consecutive levels at a time, where all would not fit into memory.

    Parameters
    ----------
    mesh, heights, body_of_vertex
        As for :func:`nested_contours`.
    most_crossings : int
        Bound on the points of a block; a single level may have more.

    Yields
    ------
    contours : Contours
        Those of :func:`.contours.trace_blocks`.
    regions : Regions
        Contours and regions are numbered from 0 in each block; in the order of blocks they are those of all levels.

    Examples
    --------
    >>> import numpy as np
    >>> from reebslice import height_mesh
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> blocks = nested_blocks(height_mesh(points, faces), [0.05, 0.5], most_crossings=4)
    >>> [len(regions.level) for contours, regions in blocks]
    [1, 1]
    """
    if not most_crossings >= 1:
        raise ReebsliceError(f"most_crossings is {most_crossings}: give a number of 1 or more.")
    levels = make_levels(mesh, _take_heights(mesh, heights))
    for contours in trace_blocks(mesh, levels, most_crossings):
        yield _nest(mesh, levels, contours, body_of_vertex)


def _take_heights(mesh, heights):
    """Heights of levels as an ascending array, checked, and that the mesh is one."""
    check_ordered(mesh)
    try:
        taken = np.array(heights, float)
    except (TypeError, ValueError):
        taken = np.full((), np.nan)
    if taken.ndim != 1 or not np.isfinite(taken).all() or (np.diff(taken) < 0).any():
        raise ReebsliceError("heights must be a sequence of finite numbers in ascending order.")
    return taken


def _nest(mesh, levels, contours, body_of_vertex):
    """The contours, and their regions."""
    body = np.zeros(len(contours.level), np.int32) if body_of_vertex is None else body_of_vertex[contours.lower]
    return contours, find_regions(mesh, levels, contours, body)


def cut_surface(mesh, levels, body_of_vertex, graph=None):
    """Cut a surface at levels into contours, pieces, regions and blocks.

    Parameters
    ----------
    mesh : HeightMesh
        Closed surface of n vertices whose saddles are simple.
    levels : Levels
        The cuts.
    body_of_vertex : (n,) int32
        Bodies that may overlap; a hole belongs to an outer contour of its own body.
    graph : ReebGraph, optional
        The mesh's, if it is at hand; by default it is computed.

    Returns
    -------
    Slices
        With `surfaces`. Pieces are ordered by slab, then by lowest vertex, and blocks by first piece.

    Raises
    ------
    TooManyCrossingsError
        The contours would not fit into memory.
    """
    graph = surface_reeb_graph(mesh) if graph is None else graph
    contours, crossings = trace_crossings(mesh, levels)
    pieces = find_pieces(graph, levels, contours, contours_of_arcs(mesh, graph, levels, crossings))
    pieces, surfaces = measure_pieces(mesh, graph, levels, crossings, pieces)
    regions = find_regions(mesh, levels, contours, body_of_vertex[contours.lower], pieces)
    hosts = host_unseen_voids(mesh, levels, crossings, pieces, surfaces, body_of_vertex)
    return Slices(levels, contours, pieces, regions, *find_blocks(pieces, contours, regions, hosts), surfaces)


def cut_along_arcs(mesh, levels, body_of_vertex, graph, most=None):
    """Do as :func:`cut_surface`, but visit only what the levels cross.

    Parameters
    ----------
    mesh, levels, body_of_vertex, graph
        As for :func:`cut_surface`.
    most : int, optional
        Points that contours may have in all; by default as many as fit into memory.

    Returns
    -------
    Slices
        Pieces come in any order, blocks by first piece. Without `surfaces`, unless some closed piece lies wholly
        between two levels: it takes faces to tell where a void inside a slab is.

    Raises
    ------
    TooManyCrossingsError
        There would be more points.
    """
    contours, of_arcs = trace_arcs_at_levels(mesh, graph, levels, most)
    pieces = find_pieces(graph, levels, contours, of_arcs)
    if (pieces.n_below + pieces.n_above == 0).any():
        return cut_surface(mesh, levels, body_of_vertex, graph)
    regions = find_regions(mesh, levels, contours, body_of_vertex[contours.lower], pieces)
    return Slices(levels, contours, pieces, regions, *find_blocks(pieces, contours, regions, {}), None)
