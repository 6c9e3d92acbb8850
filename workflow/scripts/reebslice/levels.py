"""Where to cut: equispaced levels, and refinement where they do not suffice."""

import math
from typing import NamedTuple

import numpy as np

from .pairing import pair_in_slabs
from .pieces import Pieces, find_pieces
from .reeb import critical_persistence, surface_reeb_graph
from .regions import Regions, find_blocks, find_regions, host_unseen_voids
from .slicing import Contours, Levels, trace_contours


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
        return height, int(np.searchsorted(mesh.points[:, 2], height, side="right")), np.nan, np.nan
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


def cut_surface(mesh, levels, body_of_vertex):
    """Cut at the given levels: :class:`Slices`. body_of_vertex : (n,) int32."""
    contours = trace_contours(mesh, levels)
    pieces = find_pieces(mesh, levels, contours, pair_in_slabs(mesh, levels, contours))
    regions = find_regions(mesh, levels, contours, pieces, body_of_vertex[contours.lower])
    hosts = host_unseen_voids(mesh, levels, contours, pieces, body_of_vertex)
    return Slices(levels, contours, pieces, regions, *find_blocks(pieces, contours, regions, hosts))


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
    while True:
        slices = cut_surface(mesh, levels, body_of_vertex)
        intervals = [] if refine == "none" else crowded_intervals(slices, significant, refine == "exact")
        more, refined = _insert(mesh, levels, refined, intervals)
        if len(more.height) == len(levels.height):
            return slices, refined
        levels = more


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
    ranks = np.flatnonzero(significant)
    groups = _members(slices.pieces.of_vertex[ranks], len(slices.pieces.slab), ranks)
    blocks = crowded_blocks(slices)
    groups += slices.pieces.critical + blocks if elementary else [block[significant[block]] for block in blocks]
    return sorted({pair for group in groups for pair in zip(group[:-1].tolist(), group[1:].tolist())})


def crowded_blocks(slices):
    """Essential critical points, ascending, of each block whose order of events is open.

    A block is resolved if it has at most one event, or one region on either
    side and only events that leave their number alone (a chain).
    """
    pieces, blocks = slices.pieces, slices.block_of_piece
    counts = np.array([len(critical) for critical in pieces.critical])
    events = np.bincount(blocks, weights=counts, minlength=slices.n_blocks)
    below = np.bincount(slices.block_above, minlength=slices.n_blocks)
    above = np.bincount(slices.block_below, minlength=slices.n_blocks)
    changing = np.zeros(slices.n_blocks, bool)
    changing[blocks[(counts > 0) & ~keeps_regions(slices)]] = True
    crowded = (events > 1) & (changing | (below != 1) | (above != 1))
    members = _members(blocks, slices.n_blocks, np.arange(len(blocks)))
    return [np.sort(np.concatenate([pieces.critical[piece] for piece in members[b]])) for b in np.flatnonzero(crowded)]


def keeps_regions(slices):
    """Whether each piece has one event, and as many outer contours above as below, (P,) bool."""
    pieces, outer = slices.pieces, ~slices.regions.inner
    count = len(pieces.slab)
    below = np.bincount(pieces.above[outer], minlength=count)
    above = np.bincount(pieces.below[outer], minlength=count)
    return (below == above) & np.array([len(critical) == 1 for critical in pieces.critical])


def _members(group, n_groups, values):
    """The values of each group, in their order: a list of n_groups arrays."""
    order = np.argsort(group, kind="stable")
    return np.split(values[order], np.searchsorted(group[order], np.arange(1, n_groups)))


def _insert(mesh, levels, refined, intervals):
    """The levels with the fewest further ones that meet all intervals of ranks, and which are refined."""
    cuts = [cut_between(mesh, *pair) for pair in pierce(intervals)]
    cuts = [cut for cut in cuts if cut[1] not in levels.below]
    if not cuts:
        return levels, refined
    height, below, tie_x, tie_y = map(np.array, zip(*cuts))
    merged = [np.concatenate(pair) for pair in zip(levels, (height, below, tie_x, tie_y))]
    refined = np.concatenate([refined, np.ones(len(cuts), bool)])
    order = np.lexsort((merged[0], merged[1]))
    merged = [column[order] for column in merged]
    return Levels(merged[0], merged[1].astype(np.int32), merged[2], merged[3]), refined[order]
