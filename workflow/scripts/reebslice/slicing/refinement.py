"""Levels added until every event, or every one of a feature size, is apart from the others."""

import numpy as np

from ..morse.reeb_graph import critical_persistence, surface_reeb_graph
from .contours import trace_crossings
from .graph_slices import contours_of_arcs
from .levels import Levels, cut_between, make_levels, pierce, uniform_heights
from .slices import _block_along_arcs, _finish, cut_along_arcs, cut_surface


def feature_scale(height_range, distance, units, feature_size=None, **_):
    """Sampling distance and feature size in mesh units, (distance, feature_size).

    units : "absolute", or "relative" to the height range. Of the two the
    missing one follows from the paper's rule: features of size d need a
    distance of d / 2.
    """
    scale = height_range if units == "relative" else 1.0
    distance = feature_size / 2 if distance is None else distance
    feature_size = 2 * distance if feature_size is None else feature_size
    return distance * scale, feature_size * scale


def slice_surface(mesh, body_of_vertex, distance, refine="feature", feature_size=None):
    """Cut at equispaced levels and refine: (:class:`Slices`, refined (K,) bool).

    distance, feature_size : mesh units, feature_size defaults to 2 x distance
    refine : "none"; "feature", separate critical points of one piece or block
        that both have at least the persistence `feature_size`; "exact",
        separate all whose persistence is not zero, and whatever keeps a piece
        from being elementary: the graph is then that of the surface, whatever
        the distance. (Pairs at one height, inside a flat, are made by the
        order of ranks alone and are no features of the height.)

    Each pass puts the fewest levels that separate the critical points in
    question into the slabs that need it, and nowhere else.
    """
    heights = uniform_heights(mesh.points[0, 2], mesh.points[-1, 2], distance)
    levels = make_levels(mesh, heights)
    refined = np.zeros(len(heights), bool)
    graph = surface_reeb_graph(mesh)
    persistence = critical_persistence(mesh, graph)  # NaN at regular vertices
    size = 2 * distance if feature_size is None else feature_size
    significant = persistence > 0 if refine == "exact" else persistence >= size
    if refine == "exact":
        levels, refined = _insert(mesh, levels, refined, unpierced_arcs(graph, levels, significant))
    while refine != "none":
        contours, crossings = trace_crossings(mesh, levels)
        of_arcs = contours_of_arcs(mesh, graph, levels, crossings)
        slices = _block_along_arcs(mesh, graph, levels, body_of_vertex, contours, of_arcs)
        more, refined = _insert(mesh, levels, refined, crowded_intervals(slices, significant, refine == "exact"))
        if len(more.height) == len(levels.height):
            return _finish(mesh, levels, body_of_vertex, contours, crossings, slices.regions), refined
        levels = more
    return cut_surface(mesh, levels, body_of_vertex), refined


def exact_slices(mesh, graph, body_of_vertex):
    """The :class:`Slices`, as `cut_along_arcs` makes them, at the levels that "exact" puts between no uniform ones."""
    significant = critical_persistence(mesh, graph) > 0
    levels, refined = make_levels(mesh, [(mesh.points[0, 2] + mesh.points[-1, 2]) / 2]), np.zeros(1, bool)
    more, refined = _insert(mesh, levels, refined, unpierced_arcs(graph, levels, significant))
    slices = None
    while slices is None or len(more.height) > len(levels.height):
        levels = more
        slices = cut_along_arcs(mesh, graph, levels, body_of_vertex)
        more, refined = _insert(mesh, levels, refined, crowded_intervals(slices, significant, True))
    return slices


def unpierced_arcs(graph, levels, significant):
    """Arcs of the surface's Reeb graph, (low, high), that no level cuts and whose ends are significant."""
    ends = graph.nodes[graph.arcs]
    first = np.searchsorted(levels.below, ends[:, 0], side="right")  # the lowest level above the lower end
    cut = np.append(levels.below, len(significant))[first] <= ends[:, 1]
    return list(map(tuple, ends[~cut & significant[ends].all(axis=1)].tolist()))


def crowded_intervals(slices, significant, elementary):
    """Pairs of critical points that a further level should separate: [(low, high)].

    Consecutive significant ones of a piece, and of a block with several
    events of which one changes the number of regions. significant : (n,) bool;
    elementary : whether all pieces are to become so, be their critical points
    significant or not.
    """
    ranks, (essential, crowded) = np.flatnonzero(significant), crowded_points(slices)
    piece = slices.pieces.of_vertex
    groups = [(piece[ranks], ranks)]
    if elementary:
        groups.append((piece[essential], essential))
    else:
        crowded &= significant[essential]
    groups.append((slices.block_of_piece[piece[essential[crowded]]], essential[crowded]))
    pairs = [_consecutive(*group) for group in groups]
    return list(map(tuple, np.unique(np.concatenate(pairs), axis=0).tolist()))


def _consecutive(group, ranks):
    """Pairs of neighbours (P, 2) in the order of ranks, within each group."""
    order = np.lexsort((ranks, group))
    group, ranks = group[order], ranks[order]
    return np.column_stack([ranks[:-1], ranks[1:]])[group[:-1] == group[1:]]


def crowded_points(slices):
    """Ranks of the essential critical points (E,), and which of them are in blocks whose order of events is open.

    A block is resolved if it has at most one event, or one region on either
    side and only events that leave their number alone (a chain).
    """
    pieces, blocks = slices.pieces, slices.block_of_piece
    essential = np.concatenate(pieces.critical)
    block = blocks[pieces.of_vertex[essential]]
    chain = ~(np.bincount(block, minlength=slices.n_blocks) > 1) | block_chains(slices, essential)
    return essential, ~chain[block]


def block_chains(slices, essential):
    """Whether each block has one region on either side, and only events that leave their number alone, (B,) bool."""
    pieces, outer = slices.pieces, ~slices.regions.inner
    count = len(pieces.slab)
    below = np.bincount(pieces.above[outer], minlength=count)
    above = np.bincount(pieces.below[outer], minlength=count)
    events = np.bincount(pieces.of_vertex[essential], minlength=count)
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
    height, below, tie_x, tie_y = map(np.array, zip(*cuts))
    merged = [np.concatenate(pair) for pair in zip(levels, (height, below, tie_x, tie_y))]
    refined = np.concatenate([refined, np.ones(len(cuts), bool)])
    order = np.lexsort((merged[0], merged[1]))
    merged = [column[order] for column in merged]
    return Levels(merged[0], merged[1].astype(np.int32), merged[2], merged[3]), refined[order]
