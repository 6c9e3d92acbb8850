"""Critical points that levels leave together, so that the order of events is open."""

import numpy as np

from ..arrays.grouping import group_of_members
from .void_blocks import find_void_blocks


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


def crowded_void(slices, significant=None):
    """List pairs of critical points that a further level should separate so that the void's order of events shows.

    These are consecutive ones of a block of the void that change its regions.

    Parameters
    ----------
    slices : Slices
        The surface as it is cut so far.
    significant : (n,) bool, optional
        Of the ranks; of others no pair is listed.

    Returns
    -------
    list of (low, high)
        Ranks, ascending, each pair once; none where contours do not tell what is void.
    """
    regions, pieces = slices.regions, slices.pieces
    faces = regions.inner, regions.parent, regions.of_contour, slices.contours.level
    sides = pieces.piece_above, pieces.piece_below
    void = find_void_blocks(*faces, *sides, pieces.slab, np.empty(0, np.int64))
    if void is None:
        return []
    below, above = (np.bincount(side[regions.inner], minlength=len(pieces.slab)) for side in sides)
    events, seen = np.diff(pieces.critical.start), pieces.n_below + pieces.n_above > 0
    changing = seen & ((events > 1) | ((events == 1) & (below != above)))
    piece, essential = group_of_members(pieces.critical), pieces.critical.member
    chosen = changing[piece]
    if significant is not None:
        chosen &= significant[essential]
    pairs = _consecutive(void.of_piece[piece[chosen]], essential[chosen])
    return list(map(tuple, np.unique(pairs, axis=0).tolist()))


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
