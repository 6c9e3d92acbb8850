"""A surface and its solid cut at events, and nowhere else: what lies between two cuts is on one arc.

At an event one cut suffices, on the side on which contours do not touch: right
below a union and a minimum, right above a separation and a maximum; there it
is below, or above, all vertices of the height of the event, so that no cut runs
inside a flat. What holds together is found at a cut halfway to the next height,
where no two contours touch; areas and positions are those at the height of the event itself.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.components import connected_items
from ..slicing.blocks import find_blocks, host_unseen_voids
from ..slicing.contours import Contours, Crossings, trace_crossings
from ..slicing.graph_slices import contours_of_arcs
from ..slicing.levels import Levels
from ..slicing.pieces import Pieces, PieceSurfaces, find_pieces, measure_pieces
from ..slicing.regions import Regions, find_regions


class EventSlices(NamedTuple):
    """A surface cut at K levels, at E events and at mere witnesses, into C contours, P pieces, R regions, B blocks.

    Attributes
    ----------
    levels : Levels
        The cuts at the heights of their events, ascending.
    side : (K,) int64
        1 of a cut right above its events, -1 of one right below, 0 of a witness.
    event, at : (E,) int64
        Ranks of the critical points, and the level at which each is cut.
    contours : Contours
        Their points are halfway to the next height, where no two contours touch.
    crossings : Crossings
        The contour that crosses each face at each level.
    pieces : Pieces
    surfaces : PieceSurfaces
        Areas and fluxes as the levels are at the heights of their events.
    regions : Regions
    block_of_piece : (P,) int32
    block_above, block_below : (R,) int32
        As of :class:`.slicing.slices.Slices`.
    n_blocks : int
    """

    levels: Levels
    side: np.ndarray
    event: np.ndarray
    at: np.ndarray
    contours: Contours
    crossings: Crossings
    pieces: Pieces
    surfaces: PieceSurfaces
    regions: Regions
    block_of_piece: np.ndarray
    block_above: np.ndarray
    block_below: np.ndarray
    n_blocks: int


class Sections(NamedTuple):
    """What is between events: the blocks of each arc of the solid, the pieces of each arc of the surface.

    Attributes
    ----------
    of_block : (B,) int64
        The section of every block: blocks that hang together, but for where an event is.
    of_piece : (P,) int64
        The same of pieces.
    ends_region : (R,) bool
        Whether a region is at an event of its solid, so that another section begins there.
    ends_contour : (C,) bool
        Whether a contour is at an event of its surface.
    flat : (B,) bool
        Whether a block is in a section without height, between two cuts below and above a flat.
    """

    of_block: np.ndarray
    of_piece: np.ndarray
    ends_region: np.ndarray
    ends_contour: np.ndarray
    flat: np.ndarray


def cut_at_events(mesh, graph, body_of_vertex, events, witnesses=None):
    """Cut a surface at events.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices whose saddles are simple.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32
        Bodies that may overlap.
    events : (E,) int
        Ranks of critical points, ascending. At the least and the greatest height of all nothing is cut.
    witnesses : Levels, optional
        Further cuts, at which nothing happens.

    Returns
    -------
    EventSlices
        With one level for all events that one cut serves, and one for each witness.

    Raises
    ------
    TooManyCrossingsError
        The contours would not fit into memory.
    """
    height = mesh.points[:, 2]
    events = np.asarray(events, np.int64)
    events = events[(height[events] > height[0]) & (height[events] < height[-1])]
    levels, apart, side, at = _order_cuts(mesh, graph, events, witnesses)
    contours, crossings = trace_crossings(mesh, apart)
    pieces = find_pieces(graph, apart, contours, contours_of_arcs(mesh, graph, apart, crossings))
    pieces, surfaces = measure_pieces(mesh, graph, levels, crossings, pieces)
    regions = find_regions(mesh, apart, contours, body_of_vertex[contours.lower], pieces)
    hosts = host_unseen_voids(mesh, apart, crossings, pieces, surfaces, body_of_vertex)
    blocks = find_blocks(pieces, contours, regions, hosts)
    return EventSlices(levels, side, events, at, contours, crossings, pieces, surfaces, regions, *blocks)


def _order_cuts(mesh, graph, events, witnesses):
    """Levels at the heights of events, the same halfway to the next height, their sides, and the level of each event."""
    height = mesh.points[:, 2]
    falls = np.bincount(graph.arcs[:, 1], minlength=len(graph.nodes))[np.searchsorted(graph.nodes, events)]
    side = np.where(falls == 1, 1, -1)  # above a separation and a maximum
    z = height[events]
    below = np.where(side > 0, np.searchsorted(height, z, side="right"), np.searchsorted(height, z))
    middle = height[below - 1] + (height[below] - height[below - 1]) / 2
    middle = np.where(middle < height[below], middle, height[below - 1])
    # of equal numbers of vertices below, and of equal heights, the cut above an event comes first and that below last
    rows = np.unique(np.column_stack([below, z, -side, middle]), axis=0)
    rows = np.column_stack([rows, np.full((len(rows), 2), np.nan)])
    if witnesses is not None:
        nothing = np.zeros(len(witnesses.height))
        columns = witnesses.below, witnesses.height, nothing, witnesses.height, witnesses.tie_x, witnesses.tie_y
        rows = np.concatenate([rows, np.column_stack(columns)])
    rows = rows[np.lexsort((rows[:, 2], rows[:, 1], rows[:, 0]))]
    place = {key: k for k, key in enumerate(map(tuple, rows[:, :3].tolist())) if key[2]}
    at = np.array([place[key] for key in zip(below.tolist(), z.tolist(), (-side).tolist())], np.int64)
    ties = [np.ascontiguousarray(column) for column in rows[:, 4:].T]
    exact, apart = (Levels(np.ascontiguousarray(rows[:, k]), rows[:, 0].astype(np.int32), *ties) for k in (1, 3))
    return exact, apart, -rows[:, 2].astype(np.int64), at


def find_sections(slices, graph):
    """Find what hangs together between events.

    Parameters
    ----------
    slices : EventSlices
    graph : ReebGraph
        The surface's.

    Returns
    -------
    Sections
        A region ends a section if it bounds a block that holds an event of its level, a contour if it bounds a
        piece that does.
    """
    regions, contours, pieces = slices.regions, slices.contours, slices.pieces
    piece = pieces.of_node[np.searchsorted(graph.nodes, slices.event)]
    is_low = slices.side[slices.at] < 0  # events right above their cut
    ends_region, ends_contour = np.zeros(len(regions.level), bool), np.zeros(len(contours.level), bool)
    for chosen, side, block, part in (
        (is_low, -1, slices.block_above, pieces.piece_above),
        (~is_low, 1, slices.block_below, pieces.piece_below),
    ):
        ends_region |= (slices.side[regions.level] == side) & np.isin(block, slices.block_of_piece[piece[chosen]])
        ends_contour |= (slices.side[contours.level] == side) & np.isin(part, piece[chosen])
    passed, led = ~ends_region, ~ends_contour
    of_block = connected_items(slices.block_below[passed], slices.block_above[passed], slices.n_blocks)
    of_piece = connected_items(pieces.piece_below[led], pieces.piece_above[led], len(pieces.slab))
    return Sections(of_block, of_piece, ends_region, ends_contour, _flat_blocks(slices, of_block))


def sections_at(slices, sections, graph, event, upward):
    """Find the sections of the solid that begin at an event, or end there.

    Parameters
    ----------
    slices : EventSlices
    sections : Sections
    graph : ReebGraph
        The surface's.
    event : int
        Rank of a critical point.
    upward : bool
        Whether those above the event are asked for.

    Returns
    -------
    (k,) int64
        Ascending. Where nothing is cut at the event, the one in which it lies. Of events at one height in one
        part of the solid, they are the same.
    """
    blocks = slices.block_of_piece[slices.pieces.of_node[np.searchsorted(graph.nodes, [event])]]
    place = np.searchsorted(slices.event, event)
    if place == len(slices.event) or slices.event[place] != event:
        return sections.of_block[blocks]
    level, near, far = slices.at[place], slices.block_below, slices.block_above
    if not upward:
        near, far = far, near
    if (slices.side[level] > 0) == upward:
        blocks = _step(slices, near, far, blocks, level)
    flat = sections.flat[blocks]
    while flat.any():
        level += 1 if upward else -1
        blocks = np.concatenate([blocks[~flat], _step(slices, near, far, blocks[flat], level)])
        flat = sections.flat[blocks]
    return np.unique(sections.of_block[blocks])


def _step(slices, near, far, blocks, level):
    """The blocks on the far side of the regions at a level that have one of some blocks on the near side."""
    here = slice(*np.searchsorted(slices.regions.level, [level, level + 1]))
    return far[here][np.isin(near[here], blocks)]


def _flat_blocks(slices, of_block):
    """Whether each block is in a section without height."""
    slab = np.empty(slices.n_blocks, np.int64)
    slab[slices.block_of_piece] = slices.pieces.slab
    height = np.concatenate([[-np.inf], slices.levels.height, [np.inf]])
    return (np.bincount(of_block, weights=height[slab + 2] > height[slab + 1]) == 0)[of_block]


def spread_labels(label, low, high):
    """Give items without a label that of their nearest neighbour with one.

    Parameters
    ----------
    label : (N,) int
        -1 for none.
    low, high : (E,) int
        Items that are neighbours.

    Returns
    -------
    (N,) int64
        Labels; of neighbours that are equally many steps away the lowest. -1 where no labelled item is to be reached.
    """
    label, nothing = np.array(label, np.int64), np.iinfo(np.int64).max
    while True:
        found = np.full(len(label), nothing)
        for one, other in ((low, high), (high, low)):
            reached = (label[one] < 0) & (label[other] >= 0)
            np.minimum.at(found, one[reached], label[other[reached]])
        if (found == nothing).all():
            return label
        label = np.where(found < nothing, found, label)
