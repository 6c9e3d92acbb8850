"""Which arcs of the written graphs each block and each piece between events lies on."""

from typing import NamedTuple

import numpy as np

from ..errors import ReebsliceError
from ..slicing.levels import Levels, pierce
from .event_slices import EventSlices, Sections, cut_at_events, find_sections, sections_at, spread_labels

# Changes at which an arc of the solid and of the surface begins or ends, so that nothing is to be cut.
EXTREMES = ("->o", "o->")


class ArcSlices(NamedTuple):
    """A surface cut at its handles, and the arcs on which its parts lie.

    Attributes
    ----------
    slices : EventSlices
        Of P pieces and B blocks.
    sections : Sections
    solid_of_block : (B,) int64
        Rows of `arcs` of the graph `solid`; -1 for none: what lies wholly between two levels is a node without arcs.
    surface_of_piece : (P,) int64
        Rows of `arcs` of the graph `surface`; -1 likewise.
    """

    slices: EventSlices
    sections: Sections
    solid_of_block: np.ndarray
    surface_of_piece: np.ndarray


def slice_arcs(mesh, graph, body_of_vertex, levels, contours, handles, arcs):
    """Cut a surface at its handles and find the arcs between them.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    body_of_vertex : (n,) int32
    levels, contours, handles, arcs : pyarrow.Table
        Of the surface; `contours` without `geometry`. The links are those of the mesh (`exact`).

    Returns
    -------
    ArcSlices
        Exact where every event is resolved. Where several share a piece or a block, what lies between them and is on
        no arc goes with the arc fewest events away, the lowest of equally many; what lies on several arcs,
        because levels hide how they part, with the lowest.

    Raises
    ------
    ReebsliceError
        The tables are not of this surface, or the links are not those of the mesh.
    TooManyCrossingsError
        The contours would not fit into memory.
    """
    rank, change = handles["rank"].to_numpy(), handles["change"].to_pylist()
    cut = np.array([word not in EXTREMES for word in change], bool)
    chosen, solid, surface = _choose_witnesses(levels, contours, arcs)
    slices = cut_at_events(mesh, graph, body_of_vertex, rank[cut], take_levels(levels, chosen))
    sections = find_sections(slices, graph)
    seen = _match_contours(slices, contours, chosen)
    of_section = np.full(slices.n_blocks, -1)
    region = slices.regions.of_contour[seen[0]]
    _label_lowest(of_section, sections.of_block[slices.block_above[region]], solid[seen[1]])
    for arc, low, high in _list_between(arcs, rank):
        above, below = sections_at(slices, sections, graph, low, True), sections_at(slices, sections, graph, high, False)
        between = np.intersect1d(above, below)
        of_section[between[of_section[between] < 0]] = arc
    low, high = sections.of_block[slices.block_below], sections.of_block[slices.block_above]
    of_section = spread_labels(of_section, low[sections.ends_region], high[sections.ends_region])
    of_part = np.full(len(slices.pieces.slab), -1)
    _label_lowest(of_part, sections.of_piece[slices.pieces.piece_above[seen[0]]], surface[seen[1]])
    ends = sections.of_piece[slices.pieces.piece_below], sections.of_piece[slices.pieces.piece_above]
    of_part = spread_labels(of_part, *(side[sections.ends_contour] for side in ends))
    return ArcSlices(slices, sections, of_section[sections.of_block], of_part[sections.of_piece])


def take_levels(levels, chosen):
    """Some rows of the table `levels` as :class:`Levels`."""
    ties = (levels[name].to_numpy(zero_copy_only=False).astype(float)[chosen] for name in ("tie_x", "tie_y"))
    return Levels(levels["height"].to_numpy()[chosen], levels["vertices_below"].to_numpy()[chosen], *ties)


def _choose_witnesses(levels, contours, arcs):
    """The fewest levels that meet every arc with nodes; the solid's and the surface's arc of each contour."""
    level, region = contours["level"].to_numpy(), contours["region"].to_numpy()
    of_region, of_contour = np.full(region.max(initial=-1) + 1, -1), np.full(len(level), -1)
    level_of_region = np.empty(len(of_region), np.int64)
    level_of_region[region] = level
    spans = []
    for row in arcs.select(["arc", "graph", "nodes", "source"]).to_pylist():
        label, where = {"solid": (of_region, level_of_region), "surface": (of_contour, level)}.get(
            row["graph"], (None, None)
        )
        if label is not None and row["nodes"]:
            label[row["nodes"]] = row["arc"]
            spans.append((int(where[row["nodes"][0]]) - 1, int(where[row["nodes"][-1]])))
    chosen = np.array([high for _, high in pierce(spans)], np.int64)
    return chosen, of_region[region], of_contour


def _match_contours(slices, contours, chosen):
    """Contours of the slices at witnesses, and the same contours of the table."""
    level = contours["level"].to_numpy()
    witness = np.flatnonzero(slices.side == 0)
    here = np.flatnonzero(np.isin(slices.contours.level, witness))
    there = np.flatnonzero(np.isin(level, chosen))
    same = len(here) == len(there) and (
        np.searchsorted(witness, slices.contours.level[here]) == np.searchsorted(chosen, level[there])
    ).all()
    if not same:
        raise ReebsliceError("the tables are not of this surface: other contours are at their levels.")
    return here, there


def _label_lowest(label, section, arc):
    """Give sections the lowest of the arcs (-1 for none) that were seen on them; `label` is changed."""
    known = arc >= 0
    order = np.argsort(-arc[known], kind="stable")
    label[section[known][order]] = arc[known][order]


def _list_between(arcs, rank):
    """Arcs of the solid between two events of a chain, which no level meets: arc, lower and upper rank of each."""
    rows = arcs.select(["arc", "graph", "nodes", "source", "target"]).to_pylist()
    between = [row for row in rows if row["graph"] == "solid" and not row["nodes"]]
    return [(row["arc"], int(rank[row["source"]]), int(rank[row["target"]])) for row in between]
