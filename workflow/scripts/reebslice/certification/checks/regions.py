"""Checks of holes, regions and the blocks of the solid between levels.

Each takes the case (what is known of the model so far) and a ledger to enter
its findings in; what it recomputes it leaves in the case for later checks.
"""

import numpy as np
import shapely

from ..recount.components import find_components
from ..recount.crossings import cross
from ..recount.graphs import find_blocks
from ..recount.holes import ContourNesting, find_hosts, find_parents
from ..recount.rays import first_face_along_x


def check_holes(case, ledger):
    """Which contours are holes, and whose."""
    t, found = case.columns.contours, case.recount
    inner = np.asarray(t["inner"], bool)
    slack = case.noise * (found.perimeter + case.noise)
    certain = np.abs(found.area) > slack
    ledger.rows("contours.inner", ~certain | (inner == (found.area < 0)), "a hole is a contour of negative area")
    _check_chains(case, ledger, inner, certain)
    body = case.body[found.shell]
    nest = ContourNesting(
        case.curves, case.boxes, found.area, slack, t["level"].astype(np.int64), case.noise, case.exact
    )
    host, is_open = find_hosts(nest, inner, body)
    _check_regions(case, ledger, inner, host)
    case.open["holes between two regions"] = is_open.sum()
    case.open_holes = is_open
    parent, unsure = find_parents(nest)
    stated = np.array([-1 if p is None else p for p in t["parent"]], np.int64)
    ledger.rows("contours.parent", unsure | (stated == parent), "the smallest contour around it")
    case.open["contours of unsure parent"] = (unsure & (stated != parent)).sum()
    _find_entangled(case, inner, body, stated)


def _check_chains(case, ledger, inner, certain):
    """Along a chain of cylinders all contours are holes or none is.

    Where no contour of a chain has an area beyond rounding, that of its
    shortest one is found in exact numbers.
    """
    chain = _cylinder_chains(case, len(inner))
    first = np.zeros(chain.max(initial=-1) + 1, bool)
    first[chain] = inner
    ledger.rows("contours.inner_along_cylinders", inner == first[chain], "the same along a chain of cylinders")
    order = np.lexsort((-case.recount.n_points, chain))
    shortest = order[np.flatnonzero(np.diff(chain[order], append=-1))]
    known = np.zeros(len(first), bool)
    known[chain[certain]] = True
    small = shortest[~known[chain[shortest]]].tolist()
    areas = [case.exact.area(contour) for contour in small]
    signs = [area != 0 and (area < 0) == inner[contour] for area, contour in zip(areas, small)]
    ledger.rows("contours.inner_below_rounding", signs, "sign of the exact area")


def _cylinder_chains(case, n_contours):
    cylinder = (case.kinds == "cylinder")[case.above], (case.kinds == "cylinder")[case.below]
    low = np.full(len(case.kinds), -1)
    low[case.above[cylinder[0]]] = np.flatnonzero(cylinder[0])
    high = np.flatnonzero(cylinder[1])
    return find_components(low[case.below[high]], high, n_contours)[1]


def _check_regions(case, ledger, inner, host):
    t, nodes = case.columns.contours, case.columns.nodes
    region = t["region"]
    outer = np.flatnonzero(~inner)
    ledger.enter("regions_with_one_outer_contour", bool(np.array_equal(np.sort(region[outer]), nodes["region"])), True)
    ledger.rows("contours.region.level", nodes["level"][region] == t["level"], "level of the region")
    ledger.rows("holes_in_some_region", ~inner | (host >= 0), "an outer contour of the same body around the hole")
    expected = np.where(inner & (host >= 0), region[host], region)
    ledger.rows("contours.region", region == expected, "the smallest outer contour of the same body around the hole")


def _find_entangled(case, inner, body, parent):
    """Whether material lies within that of another body, or of its own, at some level."""
    around = np.where(parent >= 0, parent, np.arange(len(parent)))
    nested = ~inner & ~inner[around] & (around != np.arange(len(parent)))
    case.entangled = bool((nested & (body != body[around])).any())
    case.crossing = bool((nested & (body == body[around])).any() or case.open_holes.any())


def check_blocks(case, ledger):
    """Components of the solid in each slab."""
    t, contours, found = case.columns.pieces, case.columns.contours, case.recount
    hosts, lost = _host_voids(case)
    ledger.enter("voids_within_a_slab_without_a_host", lost, 0)
    n_regions = len(case.columns.nodes["node"])
    args = case.above, case.below, contours["region"].astype(np.int64), len(t["piece"]), n_regions
    block, above, below, n = find_blocks(*args, hosts)
    stated = t["block"].astype(np.int64)
    pairs = np.unique(np.stack([block, stated]), axis=1).shape[1]
    ledger.enter("blocks", [len(np.unique(stated)), pairs], [n, n])
    if not (len(np.unique(stated)) == pairs == n):
        raise ValueError("the blocks of the pieces are not the components of the solid in the slabs")
    rename = np.empty(n, np.int64)
    rename[block] = stated  # blocks by the numbers of the table
    top = int(stated.max()) + 1
    case.block, case.block_above, case.block_below, case.n_blocks = stated, rename[above], rename[below], top
    case.used = np.bincount(stated, minlength=top) > 0
    case.handles_of_block = [[] for _ in range(top)]
    for handle, b in enumerate(case.columns.handles["block"].tolist()):
        if b >= top:
            raise ValueError(f"handle {handle} names block {b}, of which no piece is part")
        case.handles_of_block[b].append(handle)
    _check_open_holes(case, ledger, found)


def _host_voids(case):
    """For each void within one slab a piece around it, met by a ray along +x; and how many have none."""
    closed = np.flatnonzero((case.kinds == "unseen") & case.void[case.piece_shell])
    hosts, lost = {}, 0
    if not len(closed):
        return hosts, lost
    heights = case.surface.points[case.surface.corners, 2]
    low, high, body = heights.min(axis=1), heights.max(axis=1), case.body[case.surface.shell]
    for piece in closed.tolist():
        shell = case.piece_shell[piece]
        own = case.surface.points[case.rank[case.shell_of_vertex == shell]]
        start, span = own[np.argmax(own[:, 0])], np.ptp(own, axis=0)
        z = start[2] + 1e-7 * 0.618 * span[2] * (1 if start[2] < own[:, 2].mean() else -1)
        other = (case.surface.shell != shell) & (body == case.body[shell])
        others = np.flatnonzero(other & (low <= z) & (z <= high))
        corners = case.surface.points[case.surface.corners[others]]
        hit = first_face_along_x(corners, start[0], start[1] + 1e-7 * 0.414 * span[1], z)
        if hit < 0:
            lost += 1
            continue
        hosts[piece] = _piece_of(case, others[hit], case.slab[piece])
    return hosts, lost


def _piece_of(case, face, slab):
    """The piece that a face (of the ranked surface) belongs to in a slab that it meets."""
    corners = case.surface.origin[case.surface.corners[face]]
    split = np.flatnonzero(np.isin(case.split.origin[case.split.corners], corners).all(axis=1))
    for side in np.unique(case.split_sides.of_face[split]).tolist():
        for end in (case.split_sides.lower[side], case.split_sides.upper[side]):
            piece = case.piece[case.recount.piece_of_vertex[end]]
            if case.slab[piece] == slab:
                return int(piece)
        # a mesh edge that enters or leaves by a contour of this slab
        for contour, ends, level in (
            (case.recount.enters[side], case.above, slab),
            (case.recount.leaves[side], case.below, slab + 1),
        ):
            if contour >= 0 and case.columns.contours["level"][contour] == level:
                return int(ends[contour])
    return _piece_of_crossed(case, face, slab)


def _piece_of_crossed(case, face, slab):
    """As :func:`_piece_of` for a face that passes through the slab: its curve at the level below."""
    level = case.columns.contours["level"]
    low, high = case.surface.corners[face][[0, 2]]
    spot = cross(
        case.surface, np.array([low]), np.array([high]), *(case.levels[k][[slab]] for k in ("height", "tie_x", "tie_y"))
    )
    here = np.flatnonzero((level == slab) & (case.recount.shell == case.surface.shell[face]))
    return int(case.above[here[np.argmin(shapely.distance(case.curves.lines(here), shapely.points(spot)[0]))]])


def _check_open_holes(case, ledger, found):
    """Holes between two regions are no matter unless regions that they touch lie in different blocks."""
    contours = case.columns.contours
    alternatives = 0
    for hole in np.flatnonzero(case.open_holes).tolist():
        same = (contours["level"] == contours["level"][hole]) & (case.body[found.shell] == case.body[found.shell[hole]])
        outers = np.flatnonzero(same & ~np.asarray(contours["inner"], bool))
        curve, *around = case.curves.lines([hole, *outers])
        outers = [c for c, ring in zip(outers.tolist(), around) if _distance(ring, curve) <= case.noise]
        blocks = {(int(case.block_above[r]), int(case.block_below[r])) for r in contours["region"][outers].tolist()}
        alternatives += len(blocks) > 1
    ledger.enter("holes_that_rounding_leaves_open", alternatives, 0)


def _distance(outer, curve):
    """From the closed region within the curve `outer` to another curve; 0 if they meet."""
    ring = shapely.make_valid(shapely.Polygon(outer)) if shapely.get_num_points(outer) >= 4 else outer
    return shapely.distance(ring, curve)
