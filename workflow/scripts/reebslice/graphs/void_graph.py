"""The sliced Reeb graph of the void: the other side of the pieces that give the solid's.

Its items are the regions of the void at the levels, and its parts the blocks of
:mod:`..slicing.void_blocks`. Events that leave the number of holes alone change
nothing about the void's regions and are no nodes of its graph.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import group_items, list_groups
from ..schemas import EVENTS
from ..slicing.void_blocks import VoidBlocks, find_void_blocks
from .arcs import arc_columns, trace_arcs
from .parts import GraphParts, most_persistent

# Where the outside goes on below all and above all: nodes without a handle.
BELOW, ABOVE = -1, -2


class VoidParts(NamedTuple):
    """Parts of the void over its regions.

    Attributes
    ----------
    parts : GraphParts
        In order of blocks.
    blocks : VoidBlocks
    held : list of int
        Events in each part that change the void, or of which contours do not show whether they do.
    """

    parts: GraphParts
    blocks: VoidBlocks
    held: list


def void_parts(pieces, contours, handles):
    """Take the blocks of the void as parts over its regions.

    Parameters
    ----------
    pieces, contours, handles : pyarrow.Table

    Returns
    -------
    VoidParts or None
        The most persistent event of each part is its joint. The measure is the volume of void, NaN for the outside
        and where a body floats within the slab. None where contours do not tell what is void, because the surface
        crosses itself or bodies share material.
    """
    above, below = _pieces_of_contours(pieces, len(contours))
    slab, floating = pieces["slab"].to_numpy(), _floating_bodies(pieces, handles)
    inner = contours["inner"].to_numpy(zero_copy_only=False)
    faces = contours["parent"].fill_null(-1).to_numpy(), contours["region"].to_numpy(), contours["level"].to_numpy()
    void = find_void_blocks(inner, *faces, above, below, slab, floating)
    if void is None:
        return None
    first, last = len(void.hole), len(void.above) - 1  # regions of the outside
    joints, held = _void_joints(void, handles, floating, len(pieces))
    joints[void.below[first]], joints[void.above[last]] = [BELOW], [ABOVE]
    measure = -np.bincount(void.of_piece, pieces["flux"].to_numpy(), void.count)
    measure[void.of_piece[np.isin(slab, slab[floating])]] = np.nan
    measure[void.above[first:]] = measure[void.below[first:]] = np.nan
    ends = (list_groups(group_items(side, void.count)) for side in (void.above, void.below))
    parts = GraphParts(*ends, joints, measure)
    if any(not inside and not len(low) == len(up) == 1 for low, up, inside in zip(*parts[:3])):
        return None
    return VoidParts(parts, void, held)


def _pieces_of_contours(pieces, count):
    """The piece above and the piece below each of `count` contours, two (count,) int32."""
    sides = []
    for column in ("below", "above"):
        bounding, side = pieces[column].combine_chunks(), np.empty(count, np.int32)
        owner = np.repeat(np.arange(len(pieces), dtype=np.int32), np.diff(bounding.offsets.to_numpy()))
        side[bounding.flatten().to_numpy()] = owner
        sides.append(side)
    return sides


def _floating_bodies(pieces, handles):
    """The pieces that are closed within a slab and bound a body, not a void: they begin with material."""
    closed = np.flatnonzero(pieces["n_below"].to_numpy() + pieces["n_above"].to_numpy() == 0)
    if not len(closed):
        return closed
    first = dict(zip(handles["piece"].to_pylist()[::-1], handles["side"].to_pylist()[::-1]))
    return np.array([piece for piece in closed.tolist() if first.get(piece) == "A"], np.int64)


def _void_joints(void, handles, floating, n_pieces):
    """The joints of each block, and how many events they stand for."""
    events, persistence = [[] for _ in range(void.count)], handles["persistence"].to_pylist()
    passed = np.zeros(n_pieces, bool)
    passed[floating] = True
    piece = handles["piece"].to_numpy()
    rows = zip(void.of_piece[piece].tolist(), passed[piece].tolist(), handles["change"].to_pylist())
    for handle, (block, floats, change) in enumerate(rows):
        if not floats and (change is None or EVENTS[change][3] != 0):
            events[block].append(handle)
    return [most_persistent(inside, persistence) for inside in events], [len(inside) for inside in events]


def void_arcs(pieces, contours, handles, centres, walls):
    """Trace the arcs of the void's graph.

    Parameters
    ----------
    pieces, contours, handles : pyarrow.Table
    centres : (C, 3) float64
        Centroids of the contours, model frame.
    walls : list of dict
        Arcs of the surface's graph, of :func:`.arcs.trace_arcs`.

    Returns
    -------
    columns : dict of list
        Of the table `arcs`. The nodes of an arc are the contours of the holes along it; the outside has none, and
        no length. None where :func:`void_parts` finds no void.
    joints : dict
        Row of every node by the number of its handle, and of BELOW and ABOVE.
    """
    void = void_parts(pieces, contours, handles)
    if void is None:
        return None, {}
    arcs, hole, joints = trace_arcs(void.parts), void.blocks.hole.tolist(), _joint_rows(void, handles)
    bounds = _bounding_walls(void, arcs, walls, contours["inner"].to_pylist())
    for arc in arcs:
        arc["nodes"] = [hole[item] for item in arc["nodes"] if item < len(hole)]
    columns = arc_columns(arcs, "void", joints, centres, {}, bounds)
    columns["length"] = [length if arc["nodes"] else None for length, arc in zip(columns["length"], arcs)]
    return columns, joints


def _joint_rows(void, handles):
    """Describe the nodes; those without a handle are at the lowest and the highest vertex, which are handles.

    Events are nodes because they change how many regions the void has, so all branch.
    """
    rows, joints = handles.to_pylist(), {}
    for inside, count in zip(void.parts.joints, void.held):
        joints |= {joint: rows[joint] | {"branches": True, "n_handles": count} for joint in inside if joint >= 0}
    for joint, row, words in ((BELOW, rows[0], "outside, below all"), (ABOVE, rows[-1], "outside, above all")):
        place = {name: row[name] for name in ("x", "y", "z", "height")}
        joints[joint] = place | {"label": words, "handle": joint, "branches": False, "n_handles": 0}
    return joints


def _bounding_walls(void, arcs, walls, inner):
    """The arcs of the surface around each arc of the void, those of holes first."""
    wall = {contour: number for number, arc in enumerate(walls) for contour in arc["nodes"]}
    around = list_groups(group_items(void.blocks.region, len(void.blocks.above)))
    is_hole = [inner[arc["nodes"][0]] for arc in walls]
    members = ({wall[contour] for item in arc["nodes"] for contour in around[item]} for arc in arcs)
    return [sorted(found, key=lambda number: (not is_hole[number], number)) for found in members]
