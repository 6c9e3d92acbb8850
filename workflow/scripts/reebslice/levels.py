"""Where to cut: equispaced levels, and refinement where they do not suffice."""

import math
from bisect import bisect_right
from typing import NamedTuple

import numpy as np

from .graph_slices import contours_of_arcs, pieces_of_graph, trace_arcs_at_levels
from .pairing import pair_in_slabs
from .pieces import Pieces, find_pieces
from .reeb import critical_persistence, surface_reeb_graph
from .regions import Regions, find_blocks, find_regions, host_unseen_voids
from .slicing import Contours, Levels, trace_blocks, trace_contours, trace_crossings


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


def uniform_heights(low, high, distance):
    """Heights of equispaced levels, half a spacing inside both ends.

    The spacing is the largest one that divides [low, high] evenly and does
    not exceed `distance` (> 0, mesh units).
    """
    count = max(1, math.ceil((high - low) / distance * (1 - 1e-12)))
    return low + (high - low) * (np.arange(count) + 0.5) / count


def make_levels(mesh, heights):
    """Ordinary :class:`Levels` at ascending heights: what is higher is above."""
    heights = np.asarray(heights, float)
    below = np.searchsorted(mesh.points[:, 2], heights, side="right").astype(np.int32)
    nothing = np.full(len(heights), np.nan)
    return Levels(heights, below, nothing, nothing)


def cut_between(mesh, low, high):
    """A level above vertex `low` and not above vertex `high`, low < high in rank.

    Halfway between their heights or, where these are equal, inside the flat
    that holds both: halfway in x, then in y. Returns (height, below, tie_x, tie_y).
    """
    p, q = mesh.points[low], mesh.points[high]
    if p[2] < q[2]:
        height = _halfway(p[2], q[2])
        return height, bisect_right(mesh.points[:, 2], height, low + 1, high), np.nan, np.nan
    if p[0] < q[0]:
        tie = (_halfway(p[0], q[0]), float(mesh.points[:, 1].max()))
    else:
        tie = (p[0], _halfway(p[1], q[1]))
    last = low  # the highest rank that is still below the cut
    while last + 1 < high and mesh.points[last + 1, 2] == p[2] and tuple(mesh.points[last + 1, :2]) <= tie:
        last += 1
    return p[2], last + 1, *tie


def _halfway(a, b):
    """A number in [a, b) for a < b."""
    middle = a + (b - a) / 2
    return middle if a <= middle < b else a


def pierce(intervals):
    """The fewest cuts that meet all intervals (k, 2) of ranks, low < cut <= high.

    Greedy by upper end, which is optimal for intervals. Returns (low, high)
    of what each group of intervals has in common.
    """
    groups = []
    for low, high in sorted(intervals, key=lambda pair: (pair[1], pair[0])):
        if groups and low < groups[-1][1]:
            groups[-1] = (max(groups[-1][0], low), groups[-1][1])
        else:
            groups.append((low, high))
    return groups


def nested_contours(mesh, heights, body_of_vertex=None):
    """The level sets of a surface at ascending heights, and no more: (:class:`Contours`, :class:`Regions`).

    mesh : :func:`heightmesh.order_by_height` makes it of points, faces and a rotation
    body_of_vertex : (n,) int32, where bodies may overlap; a hole belongs to a contour of its body
    """
    levels = make_levels(mesh, heights)
    return _nest(mesh, levels, trace_contours(mesh, levels), body_of_vertex)


def nested_blocks(mesh, heights, most_crossings, body_of_vertex=None):
    """The same, of a few consecutive levels at a time, where all would not fit into memory.

    An iterator of (:class:`Contours`, :class:`Regions`) whose blocks are those
    of :func:`slicing.trace_blocks`; regions and contours are numbered in each
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
