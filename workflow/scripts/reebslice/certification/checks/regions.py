"""Checks of holes, regions and the blocks of the solid between levels.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np
import shapely

from ..recount.components import find_components
from ..recount.graphs import find_blocks, list_members
from ..recount.holes import ContourNesting, find_hosts, find_parents


def check_holes(facts, ledger):
    """Which contours are holes, and whose."""
    t, found = facts.columns.contours, facts.recount
    inner = np.asarray(t["inner"], bool)
    slack = facts.slack
    certain = np.abs(found.area) > slack
    ledger.rows("contours.inner", ~certain | (inner == (found.area < 0)), "a hole is a contour of negative area")
    facts.crossing = _check_chains(facts, ledger, inner, certain)
    body = facts.body[found.shell]
    nest = ContourNesting(
        facts.curves, facts.boxes, found.area, slack, t["level"].astype(np.int64), facts.noise, facts.exact
    )
    host, is_open = find_hosts(nest, inner, body)
    _check_regions(facts, ledger, inner, host)
    facts.open["holes between two regions"] = is_open.sum()
    facts.open_holes = is_open
    parent, unsure = find_parents(nest)
    stated = t["parent"]
    for contour in np.flatnonzero(~unsure & (stated != parent)).tolist():  # of two that meet none need be around
        others = [o for o in (stated[contour], parent[contour]) if o >= 0]
        unsure[contour] = bool(others) and nest.meet(contour, others)
    ledger.rows("contours.parent", unsure | (stated == parent), "the smallest contour around it")
    facts.open["contours of unsure parent"] = (unsure & (stated != parent)).sum()
    lonely = inner & (parent < 0) & ~unsure
    around = np.where(stated >= 0, stated, np.arange(len(stated)))
    nested = ~inner & ~inner[around] & (around != np.arange(len(stated))) & (body == body[around])
    facts.crossing |= bool((nested | lonely | is_open).any()) or nest.crosses_itself(body)


def _check_chains(facts, ledger, inner, certain):
    """Along a chain of cylinders all contours are holes or none is; return whether some chain turns over.

    Where no contour of a chain has an area beyond rounding, that of its
    shortest one is found in exact numbers.
    """
    area, n_points = facts.recount.area, facts.recount.n_points
    chain = _cylinder_chains(facts, len(inner))
    first = np.zeros(chain.max(initial=-1) + 1, bool)
    first[chain] = inner
    ledger.rows("contours.inner_along_cylinders", inner == first[chain], "the same along a chain of cylinders")
    order = np.lexsort((-n_points, chain))
    shortest = order[np.flatnonzero(np.diff(chain[order], append=-1))]
    positive, negative = (np.bincount(chain[certain & (sign * area > 0)], minlength=len(first)) > 0 for sign in (1, -1))
    small = shortest[~(positive | negative)[chain[shortest]]].tolist()
    areas = [facts.exact.area(contour) for contour in small]
    signs = [area != 0 and (area < 0) == inner[contour] for area, contour in zip(areas, small)]
    ledger.rows("contours.inner_below_rounding", signs, "sign of the exact area")
    return bool((positive & negative).any())


def _cylinder_chains(facts, n_contours):
    """The chain of each contour, (C,): contours that cylinders, one on top of the other, hold together."""
    cylinder = (facts.kinds == "cylinder")[facts.recount.above], (facts.kinds == "cylinder")[facts.recount.below]
    low = np.full(len(facts.kinds), -1)
    low[facts.recount.above[cylinder[0]]] = np.flatnonzero(cylinder[0])
    high = np.flatnonzero(cylinder[1])
    return find_components(low[facts.recount.below[high]], high, n_contours)[1]


def _check_regions(facts, ledger, inner, host):
    """Regions have one outer contour each, and the holes that it is the smallest around."""
    t, nodes = facts.columns.contours, facts.columns.nodes
    region = t["region"]
    outer = np.flatnonzero(~inner)
    ledger.enter("regions_with_one_outer_contour", bool(np.array_equal(np.sort(region[outer]), nodes["region"])), True)
    ledger.rows("contours.region.level", nodes["level"][region] == t["level"], "level of the region")
    ledger.rows("holes_in_some_region", ~inner | (host >= 0), "an outer contour of the same body around the hole")
    expected = np.where(inner & (host >= 0), region[host], region)
    ledger.rows("contours.region", region == expected, "the smallest outer contour of the same body around the hole")


def check_blocks(facts, ledger):
    """Components of the solid in each slab."""
    t, contours, found = facts.columns.pieces, facts.columns.contours, facts.recount
    hosts, lost = _host_voids(facts)
    ledger.enter("voids_within_a_slab_without_a_host", lost, 0)
    n_regions = len(facts.columns.nodes["node"])
    args = facts.recount.above, facts.recount.below, contours["region"].astype(np.int64), len(t["piece"]), n_regions
    block, above, below, n = find_blocks(*args, hosts)
    stated = t["block"].astype(np.int64)
    pairs = np.unique(np.stack([block, stated]), axis=1).shape[1]
    ledger.enter("blocks", [len(np.unique(stated)), pairs], [n, n])
    if not (len(np.unique(stated)) == pairs == n):
        raise ValueError("the blocks of the pieces are not the components of the solid in the slabs")
    rename = np.empty(n, np.int64)
    rename[block] = stated  # blocks by the numbers of the table
    top = int(stated.max()) + 1
    facts.block, facts.block_above, facts.block_below, facts.n_blocks = stated, rename[above], rename[below], top
    if facts.columns.handles["block"].max(initial=-1) >= top:
        raise ValueError("a handle names a block of which no piece is part")
    facts.handles_of_block = list_members(facts.columns.handles["block"], top)
    _check_open_holes(facts, ledger, found)


def _host_voids(facts):
    """For each void within one slab a piece around it, {piece: piece}; and how many have none."""
    closed = np.flatnonzero((facts.kinds == "unseen") & facts.void[facts.recount.piece_shell])
    walls = sorted(facts.walls, key=lambda void: facts.walls[void][1])
    around = dict(zip(walls, facts.recount.piece_of_cell.tolist()))
    of_shell = zip(closed.tolist(), facts.recount.piece_shell[closed].tolist())
    hosts = {piece: around[shell] for piece, shell in of_shell if shell in around}
    return hosts, len(closed) - len(hosts)


def _check_open_holes(facts, ledger, found):
    """Holes between two regions are no matter unless regions that they touch lie in different blocks."""
    contours = facts.columns.contours
    alternatives = 0
    for hole in np.flatnonzero(facts.open_holes).tolist():
        same = (contours["level"] == contours["level"][hole]) & (
            facts.body[found.shell] == facts.body[found.shell[hole]]
        )
        outers = np.flatnonzero(same & ~np.asarray(contours["inner"], bool))
        curve, *around = facts.curves.lines([hole, *outers])
        outers = [c for c, ring in zip(outers.tolist(), around) if _distance(ring, curve) <= facts.noise]
        blocks = {(int(facts.block_above[r]), int(facts.block_below[r])) for r in contours["region"][outers].tolist()}
        alternatives += len(blocks) > 1
    ledger.enter("holes_that_rounding_leaves_open", alternatives, 0)


def _distance(outer, curve):
    """From the closed region within the curve `outer` to another curve; 0 if they meet."""
    ring = shapely.make_valid(shapely.Polygon(outer)) if shapely.get_num_points(outer) >= 4 else outer
    return shapely.distance(ring, curve)
