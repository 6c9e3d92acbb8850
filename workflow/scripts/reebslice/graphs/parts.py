"""Parts of a Reeb graph between consecutive levels.

Items are the points of the graph at a level: regions for the solid and for the
void, contours for the surface. A part, a block or a piece, links the items below
it to those above it. Joints are the events of a part, the nodes of the graph.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.components import connected_items
from ..schemas import EVENTS
from ..slicing.tables import block_regions


class GraphParts(NamedTuple):
    """Parts of a solid, of the void or of a surface.

    Attributes
    ----------
    below, above : list of list of int
        Items below and above each of B parts.
    joints : list of list of int
        Handle ids of each part, ascending; none in a plain continuation, several
        in a chain of events.
    measure : (B,) float64
        Volume (solid, void) or area (surface) of each part.
    """

    below: list
    above: list
    joints: list
    measure: np.ndarray


def solid_parts(pieces, contours, handles):
    """Take the blocks of the solid as parts over regions.

    Events that leave the number of regions alone form a chain where a block
    has one region below and one above; any other block that holds events is
    one joint, named after the most persistent of them (the lowest such), so
    that an event keeps its node whatever noise shares its block.

    Parameters
    ----------
    pieces, contours, handles : pyarrow.Table

    Returns
    -------
    GraphParts
        In order of blocks.
    """
    below, above = block_regions(pieces, contours)
    events = [[] for _ in below]
    persistence = handles["persistence"].to_pylist()
    for row in zip(*(handles[name].to_pylist() for name in ("handle", "block", "change"))):
        events[row[1]].append((row[0], row[2]))
    joints = []
    for lower, upper, inside in zip(below, above, events):
        chain = len(lower) == len(upper) == 1 and all(EVENTS[c][4] == 0 if c else False for _, c in inside)
        numbers = [handle for handle, _ in inside]
        joints.append(numbers if chain else most_persistent(numbers, persistence))
    block = pieces["block"].to_numpy()
    return GraphParts(below, above, joints, np.bincount(block, pieces["flux"].to_numpy(), len(below)))


def most_persistent(numbers, persistence):
    """Pick the most persistent of some handles, the lowest such.

    Parameters
    ----------
    numbers : list of int
        Handle ids, ascending.
    persistence : list of float
        Of all handles.

    Returns
    -------
    list of int
        One handle, or none where none is given.
    """
    return [max(numbers, key=persistence.__getitem__)] if numbers else []


def surface_parts(pieces, handles):
    """Take the pieces of the surface as parts over contours, with the most persistent event of each as its joint.

    Parameters
    ----------
    pieces, handles : pyarrow.Table

    Returns
    -------
    GraphParts
        In order of pieces.
    """
    events, persistence = [[] for _ in range(len(pieces))], handles["persistence"].to_pylist()
    for handle, piece in zip(handles["handle"].to_pylist(), handles["piece"].to_pylist()):
        events[piece].append(handle)
    joints = [most_persistent(inside, persistence) for inside in events]
    columns = (pieces[name].to_pylist() for name in ("below", "above"))
    return GraphParts(*columns, joints, pieces["area"].to_numpy())


def linked_parts(level, links):
    """Make parts of links that were found without the mesh.

    Parameters
    ----------
    level : (R,) int
        Level of every item.
    links : list of (int, int)
        Pairs of items of consecutive levels, the lower first.

    Returns
    -------
    GraphParts
        Components of the links. Whatever is not one item below and one above
        is a joint, numbered upward; `measure` is NaN.
    """
    level, count = np.asarray(level), len(level)
    low, high = np.array(links, np.int64).reshape(-1, 2).T
    # every item has two ends: 2 i faces the slab below it, 2 i + 1 the one above
    part = connected_items(2 * low + 1, 2 * high, 2 * count)
    slab = np.repeat(level, 2) - 1 + np.arange(2 * count) % 2
    found, first, part = np.unique(part, return_index=True, return_inverse=True)
    order = np.lexsort((first, slab[first]))
    rank = np.argsort(order)
    below, above = [[] for _ in found], [[] for _ in found]
    for end in range(2 * count):
        (below if end % 2 else above)[rank[part[end]]].append(end // 2)
    joints, number = [], 0
    for lower, upper in zip(below, above):
        plain = len(lower) == len(upper) == 1
        joints.append([] if plain else [number])
        number += not plain
    return GraphParts(below, above, joints, np.full(len(found), np.nan))
