"""Levels added until every event, or every one of a feature size, is apart from the others."""

from functools import partial

import numpy as np

from ..errors import ReebsliceError
from ..morse.ordered_mesh import HeightMesh, check_ordered
from ..morse.reeb_graph import critical_persistence, surface_reeb_graph
from .crowding import crowded_intervals, crowded_void, unpierced_arcs
from .levels import Levels, cut_between, make_levels, pierce, uniform_heights
from .sampling_rule import sampling_rule
from .slices import Slices, cut_along_arcs, cut_surface


def feature_scale(height_range, distance, feature_size, units, **_):
    """Convert the distance between levels and the feature size to mesh units.

    Parameters
    ----------
    height_range : float
        Height of the model, mesh units.
    distance, feature_size : float
        As configured.
    units : {"absolute", "relative"}
        Relative ones are parts of the height range.

    Returns
    -------
    distance, feature_size : float
        Mesh units.
    """
    scale = height_range if units == "relative" else 1.0
    return distance * scale, feature_size * scale


def slice_surface(
    mesh: HeightMesh,
    body_of_vertex: np.ndarray,
    distance: float,
    refine: str = "feature",
    feature_size: float | None = None,
) -> tuple[Slices, np.ndarray]:
    """Cut a surface at equispaced levels, and at further ones where these leave events together.

    Each pass puts the fewest levels that separate the critical points in
    question into the slabs that need it, and nowhere else.

    Parameters
    ----------
    mesh : HeightMesh
        Closed surface of n vertices whose saddles are simple.
    body_of_vertex : (n,) int32
        Bodies that may overlap; a hole belongs to an outer contour of its own body.
    distance : float
        Upper bound of the spacing of the equispaced levels, mesh units.
    refine : {"feature", "exact", "none"}
        "feature" separates critical points of one piece or block, be it of the solid or of the void, that both have
        at least the persistence `feature_size`. "exact" separates all whose persistence is not zero, and whatever
        keeps a piece from being elementary: the graph is then that of the surface, whatever the distance. (Pairs at
        one height, inside a flat, are made by the order of ranks alone and are no features of the height.)
    feature_size : float, optional
        Mesh units; by default twice the distance, the sampling rule of the paper.

    Returns
    -------
    slices : Slices
        As of :func:`.slices.cut_surface`.
    refined : (K,) bool
        Which levels are further ones.

    Raises
    ------
    TooManyCrossingsError
        Levels or contours would not fit into memory; no memory is taken for them before.
    ReebsliceError
        The distance is no positive number, or `refine` is none of the three words.

    Examples
    --------
    >>> import numpy as np
    >>> from reebslice import height_mesh
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> slices, refined = slice_surface(height_mesh(points, faces), np.zeros(4, np.int32), 0.25)
    >>> slices.levels.height.tolist(), refined.tolist(), int(slices.n_blocks)
    ([0.125, 0.375, 0.625, 0.875], [False, False, False, False], 5)
    """
    if refine not in ("feature", "exact", "none"):
        raise ReebsliceError(f"refine is {refine!r}: it must be 'feature', 'exact' or 'none'.")
    check_ordered(mesh)
    if feature_size is not None and not feature_size > 0:
        raise ReebsliceError(f"feature_size is {feature_size}: it must be a positive number of mesh units.")
    distance, feature_size = sampling_rule(distance, feature_size)
    heights = uniform_heights(mesh.points[0, 2], mesh.points[-1, 2], distance)
    levels, refined = make_levels(mesh, heights), np.zeros(len(heights), bool)
    graph = surface_reeb_graph(mesh)
    if refine == "none":
        return cut_surface(mesh, levels, body_of_vertex, graph), refined
    persistence = critical_persistence(mesh, graph)  # NaN at regular vertices
    significant = persistence >= feature_size if refine == "feature" else persistence > 0
    if refine == "exact":
        levels, refined = _insert(mesh, levels, refined, unpierced_arcs(graph, levels, significant))

    def crowd(slices):
        pairs = crowded_intervals(slices, graph, significant, refine == "exact")
        return pairs + crowded_void(slices, significant if refine == "feature" else None)

    return _refine(cut_surface, mesh, graph, body_of_vertex, (levels, refined), crowd)


def exact_slices(mesh, graph, body_of_vertex, most=None):
    """Cut a surface at as few levels as it takes to leave no events together.

    Parameters
    ----------
    mesh : HeightMesh
        Closed surface of n vertices whose saddles are simple.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32
        Bodies that may overlap.
    most : int, optional
        Points that contours may have in all; by default as many as fit into memory.

    Returns
    -------
    Slices
        As of :func:`.slices.cut_along_arcs`, at one level halfway up and those that "exact" refinement adds to it.

    Raises
    ------
    TooManyCrossingsError
        There would be more points.
    """
    cut = partial(cut_along_arcs, most=most)
    significant = critical_persistence(mesh, graph) > 0
    levels, refined = make_levels(mesh, [(mesh.points[0, 2] + mesh.points[-1, 2]) / 2]), np.zeros(1, bool)
    start = _insert(mesh, levels, refined, unpierced_arcs(graph, levels, significant))
    return _refine(cut, mesh, graph, body_of_vertex, start, lambda s: crowded_intervals(s, graph, significant, True))[0]


def _refine(cut, mesh, graph, body_of_vertex, start, crowd):
    """Put in levels until no critical points are crowded: the slices that `cut` makes, and which levels are refined.

    start : the levels to begin with, and which of them are refined; crowd : a function of slices that lists the
    pairs of critical points to separate.
    """
    levels, refined = start
    while True:
        slices = cut(mesh, levels, body_of_vertex, graph)
        levels, refined = _insert(mesh, levels, refined, crowd(slices))
        if len(levels.height) == len(slices.levels.height):
            return slices, refined


def _insert(mesh, levels, refined, intervals):
    """The levels with the fewest further ones that meet all intervals of ranks, and which are refined."""
    cuts = [cut_between(mesh, *pair) for pair in pierce(intervals)]
    known = set(levels.below.tolist())
    cuts = [cut for cut in cuts if cut[1] not in known]
    if not cuts:
        return levels, refined
    more = Levels(*map(np.array, zip(*cuts)))
    merged = Levels(*(np.concatenate(pair) for pair in zip(levels, more)))
    order = np.lexsort((merged.height, merged.below))
    refined = np.concatenate([refined, np.ones(len(cuts), bool)])[order]
    return Levels(*(column[order].astype(kept.dtype) for column, kept in zip(merged, levels))), refined
