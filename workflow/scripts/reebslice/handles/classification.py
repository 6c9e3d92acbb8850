"""Morse events: one handle per essential critical point."""

import numpy as np

from ..morse.critical_points import morse_indices
from ..morse.persistence import pair_kinds
from ..schemas import EVENTS
from ..slicing.tables import block_regions
from ..table_checks import build_table
from .sides import link_areas, saddle_contours


def classify_handles(mesh, graph, points, pieces, contours):
    """Make the table `handles`, one row per essential critical point.

    Where a piece is elementary, its contours below and above name the event
    (`change`), and with it the side, index and operation; else these are taken
    from the link of the vertex, and `resolved` is false.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    graph : ReebGraph
        The mesh's.
    points : (n, 3) float64
        Surface vertices, model frame.
    pieces, contours : pyarrow.Table
        The tables of the slices.

    Returns
    -------
    pyarrow.Table
        As `schemas` declares it, in the order of heights.
    """
    rows = _handle_rows(pieces, contours)
    ranks = np.array([row["rank"] for row in rows], np.int32)
    critical = np.searchsorted(graph.nodes, ranks)
    partner = graph.nodes[graph.partner[critical]]
    index = morse_indices(mesh, ranks)
    side, operation = local_event(mesh, ranks, index)
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    events = [EVENTS.get(change) for change in columns["change"]]
    columns |= {
        "handle": np.arange(len(rows)),
        "vertex": mesh.vertex[ranks],
        "height": mesh.points[ranks, 2],
        **dict(zip("xyz", points[mesh.vertex[ranks]].T)),
        "index": index,
        "side": [event[0] if event else local for event, local in zip(events, side)],
        "operation": [event[5] if event else local for event, local in zip(events, operation)],
        "branches": [event is None or event[4] != 0 for event in events],
        "persistence": np.abs(mesh.points[ranks, 2] - mesh.points[partner, 2]),
        "pair": _positions(ranks, partner),
    }
    return build_table("handles", columns)


def critical_tables(mesh, graph, handles):
    """Make the tables of the surface's Reeb graph, which no levels change.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    graph : ReebGraph
        The mesh's.
    handles : pyarrow.Table
        The table.

    Returns
    -------
    critical_points, critical_arcs : pyarrow.Table
        As `schemas` declares them.
    """
    height, index = mesh.points[graph.nodes, 2], morse_indices(mesh, graph.nodes)
    points = {
        "critical": np.arange(len(graph.nodes)),
        "vertex": mesh.vertex[graph.nodes],
        "rank": graph.nodes,
        "height": height,
        "index": index,
        "partner": graph.partner,
        "pairing": pair_kinds(index, graph.partner),
        "persistence": np.abs(height - height[graph.partner]),
        "handle": _positions(handles["rank"].to_numpy(), graph.nodes),
    }
    arcs = {
        "arc": np.arange(len(graph.arcs)),
        **dict(zip(("source", "target"), graph.arcs.T)),
        **dict(zip(("lower", "upper"), height[graph.arcs].T)),
    }
    return build_table("critical_points", points), build_table("critical_arcs", arcs)


def _positions(ranks, wanted):
    """The place of each wanted rank in ascending `ranks`, None where it is not there."""
    place = np.minimum(np.searchsorted(ranks, wanted), len(ranks) - 1)
    return [p if there else None for p, there in zip(place.tolist(), (ranks[place] == wanted).tolist())]


def _handle_rows(pieces, contours):
    """What the slices tell of every handle, dicts in the order of ranks."""
    inner = contours["inner"].to_numpy(zero_copy_only=False)
    regions_below, regions_above = block_regions(pieces, contours)
    n_events = np.diff(pieces["critical_ranks"].combine_chunks().offsets.to_numpy())
    eventful = pieces.take(np.flatnonzero(n_events)).to_pylist()
    rows = []
    for piece in eventful:
        change = name_change(inner[piece["below"]], inner[piece["above"]])
        resolved = piece["kind"] not in ("compound", "unseen") and change in EVENTS
        for rank in piece["critical_ranks"]:
            rows.append(
                {
                    "rank": rank,
                    "slab": piece["slab"],
                    "piece": piece["piece"],
                    "block": piece["block"],
                    "change": change if resolved else None,
                    "contours_below": piece["below"],
                    "contours_above": piece["above"],
                    "regions_below": regions_below[piece["block"]],
                    "regions_above": regions_above[piece["block"]],
                    "resolved": resolved,
                }
            )
    return sorted(rows, key=lambda row: row["rank"])


def name_change(inner_below, inner_above):
    """Name the event that turns contours into others.

    Parameters
    ----------
    inner_below, inner_above : bool arrays
        Of the contours below and above the event, True for holes.

    Returns
    -------
    str
        Such as "o->i,o": the contours below and above, i for holes and o for outer ones. Whether there
        is such an event at all, `schemas.EVENTS` tells.
    """
    holes = [int(np.count_nonzero(end)) for end in (inner_below, inner_above)]
    return _name(holes[0], len(inner_below) - holes[0], holes[1], len(inner_above) - holes[1])


def _name(holes_below, outer_below, holes_above, outer_above):
    """The same, from numbers of contours."""
    ends = (["i"] * holes_below + ["o"] * outer_below, ["i"] * holes_above + ["o"] * outer_above)
    return "->".join(map(",".join, ends))


def local_event(mesh, ranks, index):
    """Tell side and operation of critical points from the contours right at them, without levels.

    Extrema by the area of the link, saddles by the signs of the contours just
    below and just above.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    ranks : (k,) int
        Critical points.
    index : (k,) int
        Their indices: 0, 1 or 2.

    Returns
    -------
    side : list of k str
        "A" where material appears as height rises, "B" where void does. A surface that crosses itself may show
        signs that no event has; its saddle then counts as side A.
    operation : list of k str
        "creation", "union", "separation" or "annihilation".
    """
    saddle = index == 1
    # A minimum with the outside up opens a void, a maximum with it ends material.
    side = np.full(len(ranks), "A", object)
    side[np.flatnonzero(~saddle)[link_areas(mesh, ranks[~saddle]) > 0]] = "B"
    operation = np.where(index == 0, "creation", "annihilation").astype(object)
    below, above = saddle_contours(mesh, ranks[saddle])
    counts = np.stack([below < 0, below >= 0, above < 0, above >= 0]).sum(axis=2).T  # NaN is neither
    changes = [_name(*row) for row in counts.tolist()]
    side[saddle] = [EVENTS[change][0] if change in EVENTS else "A" for change in changes]
    operation[saddle] = np.where(np.isnan(above[:, 1]), "union", "separation")
    return side.tolist(), operation.tolist()
