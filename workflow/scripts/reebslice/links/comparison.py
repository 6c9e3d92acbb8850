"""Links guessed from shapes, counted against the links of the mesh."""

import hashlib

import numpy as np
import pandas as pd
import shapely

from ..arrays.components import connected_items
from ..handles.classification import name_change
from ..planar.outlines import outline_polygons
from ..schemas import EVENTS
from ..slicing.tables import block_regions, contour_curves, region_levels, region_outlines
from .similarity import link_by_proximity, link_by_similarity, near_pairs

METHODS = ("similarity", "groups", "overlap", "proximity")
KINDS = ("continuation", *EVENTS, "compound")
EVERY = "all"  # the row that counts all kinds at once
# Thresholds of link_by_groups, the plain reading of the paper.
PAIR_SHARE = 0.3
GROUP_SHARE = 0.5


def link_by_overlap(pairs):
    """Link all shapes of consecutive levels that overlap at all.

    Parameters
    ----------
    pairs : Pairs
        What :func:`.similarity.near_pairs` returns.

    Returns
    -------
    list of (low, high)
        Sorted.
    """
    linked = pairs.overlap > 0
    return sorted(zip(pairs.low[linked].tolist(), pairs.high[linked].tolist()))


def link_by_groups(shapes, pairs):
    """Link shapes by fixed shares of pairs and of groups.

    Two shapes are linked if they share PAIR_SHARE of the smaller. Then a shape
    is linked to all that overlap it across from it, if they share GROUP_SHARE
    of the larger one: the shape, or their union.

    Parameters
    ----------
    shapes : (R,) array of shapely polygons
        Those of one level are taken to be disjoint.
    pairs : Pairs
        What :func:`.similarity.near_pairs` returns.

    Returns
    -------
    list of (low, high)
        Sorted.
    """
    linked, area = pairs.share > PAIR_SHARE, shapely.area(shapes)
    for single, member in ((pairs.low, pairs.high), (pairs.high, pairs.low)):
        members, union, covered = (
            np.bincount(single, weight * (pairs.overlap > 0), minlength=len(shapes))[single]
            for weight in (np.ones(len(single)), area[member], pairs.overlap)
        )
        linked |= (pairs.overlap > 0) & (members > 1) & (covered > GROUP_SHARE * np.maximum(union, area[single]))
    return sorted(zip(pairs.low[linked].tolist(), pairs.high[linked].tolist()))


def link_by_rules(level, height, shapes):
    """Link shapes by every rule.

    Parameters
    ----------
    level, height, shapes
        As for :func:`.similarity.near_pairs`.

    Returns
    -------
    dict of str to list of (low, high)
        The sorted links of each of METHODS.
    """
    pairs = near_pairs(level, height, shapes)
    return {
        "similarity": link_by_similarity(level, height, shapes, pairs),
        "groups": link_by_groups(shapes, pairs),
        "overlap": link_by_overlap(pairs),
        "proximity": link_by_proximity(level, height, shapes),
    }


def model_half(model):
    """Tell which half of the corpus a model belongs to, by a hash of its id.

    Thresholds are set by looking at the results of the one half, and figures are given for the other.

    Parameters
    ----------
    model : str
        The id.

    Returns
    -------
    str
        "tuning" or "report".
    """
    return ("tuning", "report")[hashlib.blake2b(model.encode(), digest_size=8).digest()[-1] % 2]


def compare_rules(contours, pieces):
    """Count the right and wrong links of every rule on one sliced surface.

    Parameters
    ----------
    contours, pieces : pyarrow.Table
        The tables.

    Returns
    -------
    list of dict
        One per rule and kind of event: the columns `method` to `loops_found` of the table `comparison`.
    """
    below, above = block_regions(pieces, contours)
    curves, level = contour_curves(contours, contours["geometry"].chunks), region_levels(contours)
    shapes = outline_polygons(region_outlines(contours, curves))
    height = np.empty(len(level))
    height[contours["region"].to_numpy()] = contours["height"].to_numpy()
    kinds = block_kinds(contours, pieces)
    rules = link_by_rules(level, height, shapes)
    return [
        {"method": method, **row}
        for method, links in rules.items()
        for row in count_links(level, below, above, kinds, links)
    ]


def block_kinds(contours, pieces):
    """Tell what happens in every block.

    Parameters
    ----------
    contours, pieces : pyarrow.Table
        The tables, of B blocks.

    Returns
    -------
    list of B str
        Of KINDS: "continuation" if all its pieces are cylinders, the event if one of them alone holds one,
        else "compound".
    """
    inner = contours["inner"].to_numpy(zero_copy_only=False)
    changes = [[] for _ in range(max(pieces["block"].to_pylist()) + 1)]
    columns = (pieces[name].to_pylist() for name in ("block", "kind", "below", "above"))
    for block, kind, below, above in zip(*columns):
        if kind in ("compound", "unseen"):  # the contours alone may look like one event
            changes[block].append(kind)
        elif kind != "cylinder":
            changes[block].append(name_change(inner[below], inner[above]))
    return [_one_kind(change) for change in changes]


def _one_kind(changes):
    """The kind of a block from the events in it."""
    if not changes:
        return "continuation"
    return changes[0] if len(changes) == 1 and changes[0] in EVENTS else "compound"


def count_links(level, below, above, kinds, links):
    """Count links against those of the blocks, kind by kind.

    A missed link counts with its block; a false one with the block above its
    lower end or, if nothing happens there, with the one below its upper end. A
    block or slab is right if none of its links is missed and no false one
    touches it.

    Parameters
    ----------
    level : (R,) int
        Levels of the regions.
    below, above : list of B lists of int
        Regions below and above every block.
    kinds : list of B str
        What :func:`block_kinds` returns.
    links : iterable of (low, high)
        Pairs of regions.

    Returns
    -------
    list of dict
        One for EVERY and one per kind that occurs.
    """
    truth = {(a, b): block for block, ends in enumerate(zip(below, above)) for a in ends[0] for b in ends[1]}
    block_over, block_under = _blocks_of(below), _blocks_of(above)
    found = set(links)
    missed = [block for pair, block in truth.items() if pair not in found]
    touched = [(block_over[a], block_under[b]) for a, b in found if (a, b) not in truth]
    false = [under if kinds[over] == "continuation" else over for over, under in touched]
    between = [block for block, ends in enumerate(zip(below, above)) if len(ends[0]) + len(ends[1])]
    slab = {b: int(level[below[b][0]]) if below[b] else int(level[above[b][0]]) - 1 for b in between}
    between = [block for block in between if 0 <= slab[block] < level.max()]
    wrong = {*missed, *(block for pair in touched for block in pair)}
    wrong_slabs = {slab[block] for block in wrong}
    loops = {EVERY: (count_loops(level, truth), count_loops(level, found))}
    rows = []
    for kind in (EVERY, *KINDS):
        members = [block for block in between if kind in (EVERY, kinds[block])]
        slabs = {slab[block] for block in members}
        row = {
            "kind": kind,
            "links": sum(len(below[block]) * len(above[block]) for block in members),
            "links_missed": sum(kind in (EVERY, kinds[block]) for block in missed),
            "links_false": sum(kind in (EVERY, kinds[block]) for block in false),
            "blocks": len(members),
            "blocks_right": len(members) - len(wrong.intersection(members)),
            "slabs": len(slabs),
            "slabs_right": len(slabs - wrong_slabs),
            **dict(zip(("loops", "loops_found"), loops.get(kind, (None, None)))),
        }
        rows += [row] if members else []
    return rows


def _blocks_of(ends):
    """The block of every region among the ends: {region: block}."""
    return {region: block for block, regions in enumerate(ends) for region in regions}


def count_loops(level, links):
    """Count the loops of the graph that links make of regions.

    Every region is an edge from a node below it to one above it, and every link makes the node above its lower
    region and the node below its upper region one.

    Parameters
    ----------
    level : (R,) int
        Levels of the regions.
    links : iterable of (low, high)
        Pairs of regions.

    Returns
    -------
    int
        Edges - nodes + components.
    """
    count = len(level)
    low, high = np.array(sorted(links), np.int64).reshape(-1, 2).T
    part = connected_items(2 * low + 1, 2 * high, 2 * count)  # 2 r: below region r; 2 r + 1: above it
    n_parts = int(part.max()) + 1
    return count - n_parts + int(connected_items(part[::2], part[1::2], n_parts).max()) + 1


def rates(table, by):
    """Sum the table `comparison` over groups.

    Parameters
    ----------
    table : pandas.DataFrame
        The table.
    by : list of str
        Columns that tell the groups apart.

    Returns
    -------
    pandas.DataFrame
        Indexed by the columns `by`: links; missed and false (per thousand links); blocks, slabs; blocks_right and
        slabs_right (shares); loop_error (sum of the differences in the number of loops). NaN where there is
        nothing to divide by.
    """
    table = table.assign(loop_error=(table["loops_found"] - table["loops"]).abs())
    total = table.groupby(list(by), sort=False).sum(numeric_only=True)
    return pd.DataFrame(
        {
            "links": total["links"],
            "missed": 1000 * total["links_missed"] / total["links"],
            "false": 1000 * total["links_false"] / total["links"],
            "blocks": total["blocks"],
            "blocks_right": total["blocks_right"] / total["blocks"],
            "slabs": total["slabs"],
            "slabs_right": total["slabs_right"] / total["slabs"],
            "loop_error": total["loop_error"],
        }
    )
