"""Checks of holes, regions and the blocks of solid and void between levels.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np
import shapely

from ..recount.graphs import find_blocks, find_chains, find_void_regions
from ..recount.holes import ContourNesting, find_hosts, find_parents
from ..recount.ranges import list_members


def check_holes(facts, ledger):
    """Which contours are holes, and whose."""
    t, found = facts.columns.contours, facts.recount
    inner, stated, body = t["inner"], t["parent"], facts.body[found.shell]
    certain = np.abs(found.area) > facts.slack
    ledger.rows("contours.inner", ~certain | (inner == (found.area < 0)), "a hole is a contour of negative area")
    facts.crossing = _check_chains(facts, ledger, inner, certain)
    level = t["level"].astype(np.int64)
    nest = ContourNesting(facts.curves, facts.boxes, found.area, facts.slack, level, facts.noise, facts.exact)
    host, facts.open_holes = find_hosts(nest, inner, body)
    _check_regions(facts, ledger, inner, host)
    parent, unsure = find_parents(nest)
    for contour in np.flatnonzero(~unsure & (stated != parent)).tolist():  # of two that meet none need be around
        others = [other for other in (stated[contour], parent[contour]) if other >= 0]
        unsure[contour] = bool(others) and nest.meet(contour, others)
    ledger.rows("contours.parent", unsure | (stated == parent), "the smallest contour around it")
    facts.open["holes between two regions"] = facts.open_holes.sum()
    facts.open["contours of unsure parent"] = (unsure & (stated != parent)).sum()
    facts.void_regions = find_void_regions(inner, stated, t["region"], t["level"], len(facts.levels["height"]))
    lonely = inner & (parent < 0) & ~unsure
    nested = ~inner & (stated >= 0) & ~inner[stated] & (body == body[stated])
    seen = facts.crossing or nest.crosses_itself(body)
    facts.crossing = seen or bool((nested | lonely | facts.open_holes).any())
    told = facts.inspection.get("self_crossings")
    ledger.enter("crossings_of_a_body_are_told", told, "more than 0" if seen else told, told != 0 or not seen)


def _check_chains(facts, ledger, inner, certain):
    """Along a chain of cylinders all contours are holes or none is; return whether some chain turns over.

    Where no contour of a chain has an area beyond rounding, that of its
    shortest one is found in exact numbers.
    """
    found = facts.recount
    n, chain = find_chains(found.above, found.below, facts.kinds == "cylinder")
    first, holes = np.zeros(n, bool), certain & (found.area < 0)
    first[chain] = inner
    ledger.rows("contours.inner_along_cylinders", inner == first[chain], "the same along a chain of cylinders")
    negative, positive = (np.bincount(chain[sure], minlength=n) > 0 for sure in (holes, certain & ~holes))
    order = np.lexsort((-found.n_points, chain))
    shortest = order[np.flatnonzero(np.diff(chain[order], append=-1))]
    small = shortest[~(positive | negative)[chain[shortest]]].tolist()
    areas = [facts.exact.area(contour) for contour in small]
    signs = [area != 0 and (area < 0) == inner[contour] for area, contour in zip(areas, small)]
    ledger.rows("contours.inner_below_rounding", signs, "sign of the exact area")
    return bool((positive & negative).any())


def _check_regions(facts, ledger, inner, host):
    """Regions have one outer contour each, and the holes that it is the smallest around."""
    t, nodes = facts.columns.contours, facts.columns.nodes
    region, hosted = t["region"], inner & (host >= 0)
    alone = np.array_equal(np.sort(region[~inner]), nodes["region"])
    ledger.enter("regions_with_one_outer_contour", bool(alone), True)
    ledger.rows("contours.region.level", nodes["level"][region] == t["level"], "level of the region")
    ledger.rows("holes_in_some_region", ~inner | hosted, "an outer contour of the same body around the hole")
    expected = np.where(hosted, region[host], region)
    ledger.rows("contours.region", region == expected, "the smallest outer contour of the same body around the hole")


def check_blocks(facts, ledger):
    """Components of the solid, and of the void, in each slab."""
    found, region = facts.recount, facts.columns.contours["region"].astype(np.int64)
    hosts, lost = _host_voids(facts)
    ledger.enter("voids_within_a_slab_without_a_host", lost, 0)
    sizes, stated = (len(facts.kinds), len(facts.columns.nodes["node"])), facts.columns.pieces["block"].astype(np.int64)
    block, above, below, n = find_blocks(found.above, found.below, region, *sizes, sorted(hosts.items()))
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
    if facts.void_regions is not None:
        facts.void_blocks = _find_void_blocks(facts, found)


def _find_void_blocks(facts, found):
    """The blocks of the void, as of :func:`find_blocks`; the outside is one block in each slab.

    A body within one slab counts as in the outside, of which it changes nothing.
    """
    regions, n_pieces = facts.void_regions, len(facts.kinds)
    first, n_regions = n_pieces + len(regions.hole), len(regions.level)
    links = [(up, up + n_regions + 1) for up in range(first, n_pieces + n_regions - 1)]
    links += [(first + 1 + int(found.slab[piece]), piece) for piece in find_floating(facts).tolist()]
    return find_blocks(found.above, found.below, regions.of_contour, n_pieces, n_regions, links)


def find_floating(facts):
    """Find the pieces that are bodies within one slab."""
    return np.flatnonzero((facts.kinds == "unseen") & ~facts.void[facts.recount.piece_shell])


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
    contours, body, alternatives = facts.columns.contours, facts.body[found.shell], 0
    for hole in np.flatnonzero(facts.open_holes).tolist():
        outers = (contours["level"] == contours["level"][hole]) & (body == body[hole]) & ~contours["inner"]
        curve, *around = facts.curves.lines([hole, *np.flatnonzero(outers)])
        touched = contours["region"][outers][[_distance(ring, curve) <= facts.noise for ring in around]]
        blocks = facts.block_above[touched], facts.block_below[touched]
        alternatives += np.unique(np.stack(blocks), axis=1).shape[1] > 1
    ledger.enter("holes_that_rounding_leaves_open", int(alternatives), 0)


def _distance(outer, curve):
    """From the closed region within the curve `outer` to another curve; 0 if they meet."""
    ring = shapely.make_valid(shapely.Polygon(outer)) if shapely.get_num_points(outer) >= 4 else outer
    return shapely.distance(ring, curve)
