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
    """What is between events, of a solid (items are regions, parts are blocks) or of a surface (contours, pieces).

    Attributes
    ----------
    of_part : (P,) int64
        The section of every part: parts that hang together, but for where an event is.
    flat : (P,) bool
        Whether a part is in a section without height, between two cuts below and above a flat.
    of_node : (K,) int32
        The part that holds each critical point of the surface.
    level : (I,) int32
        Levels of the items, ascending.
    below, above : (I,) int32
        The parts on the lower and on the upper side of each item.
    ends : (I,) bool
        Whether the item bounds a part that holds an event of its level, so that another section begins there.
    """

    of_part: np.ndarray
    flat: np.ndarray
    of_node: np.ndarray
    level: np.ndarray
    below: np.ndarray
    above: np.ndarray
    ends: np.ndarray


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
    """Levels at the heights of events, the same halfway to the next height, their sides, and the level of events."""
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
    solid, surface : Sections
    """
    pieces, of_piece = slices.pieces, slices.block_of_piece
    slab = np.empty(slices.n_blocks, np.int64)
    slab[of_piece] = pieces.slab
    regions = slices.regions.level, slices.block_below, slices.block_above
    contours = slices.contours.level, pieces.piece_below, pieces.piece_above
    place = np.searchsorted(graph.nodes, slices.event)
    return (
        _find_sections(slices, place, of_piece[pieces.of_node], slab, *regions),
        _find_sections(slices, place, pieces.of_node, pieces.slab, *contours),
    )


def _find_sections(slices, place, of_node, slab, level, below, above):
    """The :class:`Sections` of parts with slabs; place : of events, among the critical points."""
    is_low, ends = slices.side[slices.at] < 0, np.zeros(len(level), bool)  # events right above their cut
    for chosen, side, beside in ((is_low, -1, above), (~is_low, 1, below)):
        ends |= (slices.side[level] == side) & np.isin(beside, of_node[place[chosen]])
    of_part = connected_items(below[~ends], above[~ends], len(slab))
    height = np.concatenate([[-np.inf], slices.levels.height, [np.inf]])
    rises = np.bincount(of_part, weights=height[slab + 2] > height[slab + 1])
    return Sections(of_part, rises[of_part] == 0, of_node, level, below, above, ends)


def sections_at(slices, sections, graph, event, upward):
    """Find the sections that begin at an event, or end there.

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
        part, they are the same.
    """
    parts = sections.of_node[np.searchsorted(graph.nodes, [event])]
    place = np.searchsorted(slices.event, event)
    if place == len(slices.event) or slices.event[place] != event:
        return sections.of_part[parts]
    level = slices.at[place]
    if (slices.side[level] > 0) == upward:
        parts = _step(sections, parts, level, upward)
    flat = sections.flat[parts]
    while flat.any():
        level += 1 if upward else -1
        parts = np.concatenate([parts[~flat], _step(sections, parts[flat], level, upward)])
        flat = sections.flat[parts]
    return np.unique(sections.of_part[parts])


def _step(sections, parts, level, upward):
    """The parts beyond the items of a level that bound one of some parts, from below to above or back."""
    here = slice(*np.searchsorted(sections.level, [level, level + 1]))
    near, far = sections.below[here], sections.above[here]
    return far[np.isin(near, parts)] if upward else near[np.isin(far, parts)]
