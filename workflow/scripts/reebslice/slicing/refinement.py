"""Levels added until every event, or every one of a feature size, is apart from the others."""

import numpy as np

from ..arrays.grouping import group_of_members
from ..errors import ReebsliceError
from ..morse.ordered_mesh import HeightMesh, check_ordered
from ..morse.reeb_graph import critical_persistence, surface_reeb_graph
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
        "feature" separates critical points of one piece or block that both have at least the persistence
        `feature_size`. "exact" separates all whose persistence is not zero, and whatever keeps a piece from
        being elementary: the graph is then that of the surface, whatever the distance. (Pairs at one height,
        inside a flat, are made by the order of ranks alone and are no features of the height.)
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
    if refine == "feature":
        return _refine(cut_surface, mesh, graph, body_of_vertex, (levels, refined), persistence >= feature_size, False)
    levels, refined = _insert(mesh, levels, refined, unpierced_arcs(graph, levels, persistence > 0))
    return _refine(cut_surface, mesh, graph, body_of_vertex, (levels, refined), persistence > 0, True)


def exact_slices(mesh, graph, body_of_vertex):
    """Cut a surface at as few levels as it takes to leave no events together.

    Parameters
    ----------
    mesh : HeightMesh
        Closed surface of n vertices whose saddles are simple.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32
        Bodies that may overlap.

    Returns
    -------
    Slices
        As of :func:`.slices.cut_along_arcs`, at one level halfway up and those that "exact" refinement adds to it.

    Raises
    ------
    TooManyCrossingsError
        The contours would not fit into memory.
    """
    significant = critical_persistence(mesh, graph) > 0
    levels, refined = make_levels(mesh, [(mesh.points[0, 2] + mesh.points[-1, 2]) / 2]), np.zeros(1, bool)
    start = _insert(mesh, levels, refined, unpierced_arcs(graph, levels, significant))
    return _refine(cut_along_arcs, mesh, graph, body_of_vertex, start, significant, True)[0]


def _refine(cut, mesh, graph, body_of_vertex, start, significant, elementary):
    """Put in levels until no critical points are crowded: the slices that `cut` makes, and which levels are refined.

    start : the levels to begin with, and which of them are refined.
    """
    levels, refined = start
    while True:
        slices = cut(mesh, levels, body_of_vertex, graph)
        crowded = crowded_intervals(slices, graph, significant, elementary)
        levels, refined = _insert(mesh, levels, refined, crowded)
        if len(levels.height) == len(slices.levels.height):
            return slices, refined


def unpierced_arcs(graph, levels, significant):
    """List the arcs of a surface's Reeb graph that no level cuts and whose ends are significant.

    Parameters
    ----------
    graph : ReebGraph
        The surface's.
    levels : Levels
        The cuts.
    significant : (n,) bool
        Of the ranks.

    Returns
    -------
    list of (low, high)
        Ranks of the ends of the arcs.
    """
    ends = graph.nodes[graph.arcs]
    first = np.searchsorted(levels.below, ends[:, 0], side="right")  # the lowest level above the lower end
    cut = np.append(levels.below, len(significant))[first] <= ends[:, 1]
    return list(map(tuple, ends[~cut & significant[ends].all(axis=1)].tolist()))


def crowded_intervals(slices, graph, significant, elementary):
    """List pairs of critical points that a further level should separate.

    These are consecutive significant ones of a piece, and of a block with several
    events of which one changes the number of regions.

    Parameters
    ----------
    slices : Slices
        The surface as it is cut so far.
    graph : ReebGraph
        The surface's.
    significant : (n,) bool
        Of the ranks; critical ones only.
    elementary : bool
        Whether all pieces are to become elementary, be their critical points significant or not.

    Returns
    -------
    list of (low, high)
        Ranks, ascending, each pair once.
    """
    chosen = significant[graph.nodes]
    groups = [(slices.pieces.of_node[chosen], graph.nodes[chosen])]
    essential, crowded = crowded_points(slices)
    piece = group_of_members(slices.pieces.critical)
    if elementary:
        groups.append((piece, essential))
    else:
        crowded &= significant[essential]
    groups.append((slices.block_of_piece[piece[crowded]], essential[crowded]))
    pairs = [_consecutive(*group) for group in groups]
    return list(map(tuple, np.unique(np.concatenate(pairs), axis=0).tolist()))


def _consecutive(group, ranks):
    """Pairs of neighbours (P, 2) in the order of ranks, within each group."""
    order = np.lexsort((ranks, group))
    group, ranks = group[order], ranks[order]
    return np.column_stack([ranks[:-1], ranks[1:]])[group[:-1] == group[1:]]


def crowded_points(slices):
    """Find the blocks whose order of events is open.

    A block is resolved if it has at most one event, or if it is a chain: see :func:`block_chains`.

    Parameters
    ----------
    slices : Slices
        A sliced surface with E essential critical points.

    Returns
    -------
    essential : (E,) int32
        Ranks of the essential critical points, by piece.
    crowded : (E,) bool
        Whether each is in a block that is not resolved.
    """
    critical = slices.pieces.critical
    block = slices.block_of_piece[group_of_members(critical)]
    resolved = (np.bincount(block, minlength=slices.n_blocks) <= 1) | block_chains(slices)
    return critical.member, ~resolved[block]


def block_chains(slices):
    """Tell which blocks are chains: one region on either side, and only events that leave their number alone.

    Parameters
    ----------
    slices : Slices
        A sliced surface of B blocks.

    Returns
    -------
    (B,) bool
        The order of events in a chain is that of their heights, so all are seen without a further level.
    """
    pieces, outer = slices.pieces, ~slices.regions.inner
    count = len(pieces.slab)
    below = np.bincount(pieces.piece_above[outer], minlength=count)
    above = np.bincount(pieces.piece_below[outer], minlength=count)
    events = np.diff(pieces.critical.start)
    changing = np.zeros(slices.n_blocks, bool)
    changing[slices.block_of_piece[(events > 1) | ((events == 1) & (below != above))]] = True
    ends = (np.bincount(ends, minlength=slices.n_blocks) for ends in (slices.block_above, slices.block_below))
    return ~changing & np.logical_and(*(count == 1 for count in ends))


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
