"""Which arcs of the written graphs each block and each piece between events lies on."""

from typing import NamedTuple

import numpy as np

from ..arrays.nearest_labels import spread_labels
from ..errors import ReebsliceError
from ..slicing.levels import Levels, pierce
from ..slicing.tables import levels_of_table
from .event_slices import EventSlices, cut_at_events, find_sections, sections_at

# Changes at which an arc of the solid and of the surface begins or ends, so that nothing is to be cut.
EXTREMES = ("->o", "o->")


class ArcSlices(NamedTuple):
    """A surface cut at its handles into P pieces and B blocks, and the arcs on which they lie.

    Attributes
    ----------
    slices : EventSlices
    solid_of_block : (B,) int64
        Rows of `arcs` of the graph `solid`; -1 for none: what lies wholly between two levels is a node without arcs.
    surface_of_piece : (P,) int64
        Rows of `arcs` of the graph `surface`; -1 likewise.
    flat : (B,) bool
        Whether a block is no more than a flat in which arcs end both below and above.
    """

    slices: EventSlices
    solid_of_block: np.ndarray
    surface_of_piece: np.ndarray
    flat: np.ndarray


class _Arcs(NamedTuple):
    """The arcs with height of one graph: rows, those of them that no witness can meet, and the arc of each contour."""

    rows: list
    unmet: list
    of_contour: np.ndarray


def slice_arcs(mesh, graph, body_of_vertex, levels, contours, handles, arcs):
    """Cut a surface at its handles and find the arcs between them.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices whose saddles are simple.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32
    levels, contours, handles, arcs : pyarrow.Table
        Of the surface; `contours` without `geometry`. The links are those of the mesh (`exact`).

    Returns
    -------
    ArcSlices
        Exact where every event is resolved. Where several share a piece or a block, what lies between them and is on
        no arc goes with the arc fewest events away, the lowest of equally many; what lies on several arcs,
        because levels hide how they part, with the lowest.
        Arcs without height have nothing on them.

    Raises
    ------
    ReebsliceError
        The tables are not of this surface.
    TooManyCrossingsError
        The contours would not fit into memory.
    """
    rank, change = handles["rank"].to_numpy(), handles["change"].to_pylist()
    cut = np.array([word not in EXTREMES for word in change], bool)
    cuts = levels_of_table(levels)
    generic = np.flatnonzero(np.isnan(cuts.tie_x))  # others run through flats
    solid, surface = _list_arcs(contours, arcs, generic)
    chosen = _choose_witnesses(contours, generic, (solid, surface))
    slices = cut_at_events(mesh, graph, body_of_vertex, rank[cut], Levels(*(column[chosen] for column in cuts)))
    here, there = _match_contours(slices, contours, chosen)
    of_solid, of_surface = find_sections(slices, graph)
    blocks, pieces = slices.block_above[slices.regions.of_contour[here]], slices.pieces.piece_above[here]
    labels = []
    for sections, known, parts in ((of_solid, solid, blocks), (of_surface, surface, pieces)):
        label = np.full(sections.of_part.max() + 1, -1)
        _label_lowest(label, sections.of_part[parts], known.of_contour[there])
        for row in known.unmet:
            ends = ((int(rank[row[end]]), upward) for end, upward in (("source", True), ("target", False)))
            between = np.intersect1d(*(sections_at(slices, sections, graph, *end) for end in ends))
            label[between[label[between] < 0][:1]] = row["arc"]
        low, high = (sections.of_part[side[sections.ends]] for side in (sections.below, sections.above))
        labels.append(spread_labels(label, low, high)[sections.of_part])
    return ArcSlices(slices, *labels, of_solid.flat)


def _list_arcs(contours, arcs, generic):
    """The :class:`_Arcs` of solid and surface; generic : levels that run through no flat."""
    level, region = contours["level"].to_numpy(), contours["region"].to_numpy()
    of_item = {"solid": region, "surface": np.arange(len(level))}
    rows = arcs.select(["arc", "graph", "source", "target", "lower", "upper", "nodes"]).to_pylist()
    found = []
    for graph, item in of_item.items():
        arc_of, level_of = np.full(item.max(initial=-1) + 1, -1), np.empty(item.max(initial=-1) + 1, np.int64)
        level_of[item] = level
        rising = [row for row in rows if row["graph"] == graph and row["lower"] < row["upper"]]
        met, unmet = [], []
        for row in rising:
            arc_of[row["nodes"]] = row["arc"]
            (met if np.isin(level_of[row["nodes"]], generic).any() else unmet).append(row)
        found.append(_Arcs(met, unmet, arc_of[item]))
    return found


def _choose_witnesses(contours, generic, graphs):
    """The fewest of the generic levels that meet every arc which any of them meets, ascending."""
    place = np.searchsorted(generic, contours["level"].to_numpy())
    spans = set()
    for graph in graphs:
        known = np.flatnonzero((graph.of_contour >= 0) & np.isin(contours["level"].to_numpy(), generic))
        arc = graph.of_contour[known]
        low, high = np.full(arc.max(initial=-1) + 1, len(generic)), np.full(arc.max(initial=-1) + 1, -1)
        np.minimum.at(low, arc, place[known])
        np.maximum.at(high, arc, place[known])
        spans.update(zip((low[high >= 0] - 1).tolist(), high[high >= 0].tolist()))
    return generic[[high for _, high in pierce(spans)]].astype(np.int64)


def _match_contours(slices, contours, chosen):
    """Contours of the slices at witnesses, and the same contours of the table."""
    level = contours["level"].to_numpy()
    witness = np.flatnonzero(slices.side == 0)
    here = np.flatnonzero(np.isin(slices.contours.level, witness))
    there = np.flatnonzero(np.isin(level, chosen))
    places = np.searchsorted(witness, slices.contours.level[here]), np.searchsorted(chosen, level[there])
    if not np.array_equal(*places):
        raise ReebsliceError("the tables are not of this surface: other contours are at their levels.")
    return here, there


def _label_lowest(label, section, arc):
    """Give sections the lowest of the arcs (-1 for none) that were seen on them; `label` is changed."""
    known = arc >= 0
    order = np.argsort(-arc[known], kind="stable")
    label[section[known][order]] = arc[known][order]
