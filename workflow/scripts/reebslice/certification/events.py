"""Checks of the events: holes and regions, blocks of the solid, handles, sides.

Each takes the case (what is known of the model so far) and a ledger to enter
its findings in; what it recomputes it leaves in the case for later checks.
"""

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .recount import cross
from .recount_graphs import find_blocks
from .recount_shapes import Nest, find_hosts, find_parents, first_face_along_x, local_sides
from ..schemas import EVENTS

INDEX_OF_KIND = {"birth": 0, "death": 2, "join": 1, "split": 1}


def check_holes(case, ledger):
    """Which contours are holes, and whose."""
    t, found = case.columns.contours, case.recount
    inner = np.asarray(t["inner"], bool)
    slack = case.noise * (found.perimeter + case.noise)
    certain = np.abs(found.area) > slack
    ledger.rows("contours.inner", ~certain | (inner == (found.area < 0)), "a hole is a contour of negative area")
    _check_chains(case, ledger, inner, certain)
    body = case.body[found.shell]
    nest = Nest(case.curves, found.area, slack, t["level"], case.noise, case.exact)
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
    links = coo_array((np.ones(len(high), np.int8), (low[case.below[high]], high)), shape=(n_contours,) * 2)
    return connected_components(links, directed=False)[1]


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
    heights = case.surface.points[case.surface.corners, 2]
    low, high, body = heights.min(axis=1), heights.max(axis=1), case.body[case.surface.shell]
    for piece in closed.tolist():
        shell = case.piece_shell[piece]
        own = case.tilted[case.shell_of_vertex == shell]
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
    return int(case.above[here[np.argmin(shapely.distance(case.curves[here], shapely.points(spot)[0]))]])


def _check_open_holes(case, ledger, found):
    """Holes between two regions are no matter unless regions that they touch lie in different blocks."""
    contours = case.columns.contours
    alternatives = 0
    for hole in np.flatnonzero(case.open_holes).tolist():
        same = (contours["level"] == contours["level"][hole]) & (case.body[found.shell] == case.body[found.shell[hole]])
        outers = np.flatnonzero(same & ~np.asarray(contours["inner"], bool))
        outers = [c for c in outers.tolist() if _distance(case.curves[c], case.curves[hole]) <= case.noise]
        blocks = {(int(case.block_above[r]), int(case.block_below[r])) for r in contours["region"][outers].tolist()}
        alternatives += len(blocks) > 1
    ledger.enter("holes_that_rounding_leaves_open", alternatives, 0)


def _distance(outer, curve):
    """From the closed region within the curve `outer` to another curve; 0 if they meet."""
    ring = shapely.make_valid(shapely.Polygon(outer)) if shapely.get_num_points(outer) >= 4 else outer
    return shapely.distance(ring, curve)


def check_handles(case, ledger):
    """One handle per essential critical point, at its vertex, of the event that the contours show."""
    t, pieces = case.columns.handles, case.columns.pieces
    vertex, piece = t["vertex"], t["piece"]
    expected = sorted(rank for ranks in pieces["critical_ranks"] for rank in ranks)
    ledger.enter("handles.rank", t["rank"].tolist() == expected, True)
    owner = {
        rank: (p, v)
        for p, both in enumerate(zip(pieces["critical_ranks"], pieces["critical"]))
        for rank, v in zip(*both)
    }
    placed = [owner.get(r) == (p, v) for r, p, v in zip(t["rank"].tolist(), piece.tolist(), vertex.tolist())]
    ledger.rows("handles.vertex", placed, "the critical point of its piece")
    ledger.rows(
        "handles.position",
        (case.model[vertex] == np.stack([t[k] for k in "xyz"], axis=1)).all(axis=1),
        "position of the vertex",
    )
    ledger.rows("handles.height", t["height"] == case.tilted[vertex, 2], "height of the vertex")
    for name, values in (("slab", case.slab), ("block", case.block)):
        ledger.rows(f"handles.{name}", t[name] == values[piece], f"{name} of the piece")
    ledger.rows("handles.index", t["index"] == case.index_of_vertex[vertex], "sign changes around the vertex")
    held = np.bincount(piece, minlength=len(case.kinds))
    wanted = np.array(
        [_essentials(*ends) for ends in zip(*(e.tolist() for e in case.piece_ends), case.piece_genus.tolist())]
    )
    wanted = np.stack([np.bincount(piece[t["index"] == i], minlength=len(held)) for i in range(3)], axis=1) == wanted
    ledger.rows("pieces.handles", wanted.all(axis=1), "critical points by index that its shape needs")
    _check_events(case, ledger, t, piece)
    _check_persistence(case, ledger, t)
    chains = np.array([_is_chain(case, b) for b in range(case.n_blocks)], bool)
    case.chains = chains
    case.block_resolved = np.array([len(h) <= 1 for h in case.handles_of_block], bool) | chains
    for end, regions in (("below", case.block_above), ("above", case.block_below)):
        members = [[] for _ in range(case.n_blocks)]
        for region, b in enumerate(regions.tolist()):
            members[b].append(region)
        same = [a == members[b] for a, b in zip(t[f"regions_{end}"], t["block"].tolist())]
        ledger.rows(f"handles.regions_{end}", same, f"regions {end} the block")


def _essentials(n_below, n_above, genus):
    """Critical points of index 0, 1, 2 that a piece cannot do without."""
    saddles = max(n_below, 1) + max(n_above, 1) - 2 + 2 * genus
    return (n_below == 0, saddles, n_above == 0) if (n_below, n_above, genus) != (1, 1, 0) else (0, 0, 0)


def _check_events(case, ledger, t, piece):
    """Changes, sides, operations, counts of contours of the elementary pieces."""
    inner = np.asarray(case.columns.contours["inner"], bool)
    pieces = case.columns.pieces
    changes = [_change(inner, a, b) for a, b in zip(pieces["below"], pieces["above"])]
    resolved = case.elementary & np.array([c in EVENTS for c in changes], bool)
    eventful = case.elementary & (case.kinds != "cylinder")
    ledger.rows("pieces.change", ~eventful | resolved, "one of the twelve events")
    case.change = changes
    expected = [changes[p] if resolved[p] else None for p in piece.tolist()]
    ledger.rows("handles.change", [a == b for a, b in zip(t["change"], expected)], "signs of the contours of its piece")
    ledger.rows("handles.resolved", t["resolved"] == resolved[piece], "its piece is elementary")
    for end in ("below", "above"):
        same = [sorted(a) == sorted(pieces[end][p]) for a, p in zip(t[f"contours_{end}"], piece.tolist())]
        ledger.rows(f"handles.contours_{end}", same, f"contours {end} its piece")
    events = [EVENTS.get(change) for change in t["change"]]
    for name, place in (("side", 0), ("index", 1), ("operation", 5)):
        same = [e is None or e[place] == v for e, v in zip(events, t[name])]
        ledger.rows(f"handles.{name}_of_change", same, f"{name} of the event")
    ledger.rows(
        "handles.branches",
        [b == (e is None or e[4] != 0) for b, e in zip(t["branches"], events)],
        "the number of regions changes",
    )
    wanted = [INDEX_OF_KIND.get(case.kinds[p]) for p in piece.tolist()]
    fits = [w is None or w == i for w, i in zip(wanted, t["index"].tolist())]
    ledger.rows("handles.index_of_kind", fits, "index by the contours below and above")


def _change(inner, below, above):
    sides = (sorted("i" if inner[c] else "o" for c in end) for end in (below, above))
    return "->".join(",".join(end) for end in sides)


def _check_persistence(case, ledger, t):
    """Persistence and partner, against the exact graph, which was checked before."""
    points = case.columns.critical_points
    place = np.searchsorted(points["rank"], t["rank"])
    ledger.rows("handles.persistence", t["persistence"] == points["persistence"][place], "that of the critical point")
    handle = dict(zip(t["rank"].tolist(), t["handle"].tolist()))
    partner = points["rank"][points["partner"][place]].tolist()
    ledger.rows("handles.pair", [p == handle.get(r) for p, r in zip(t["pair"], partner)], "the handle of the partner")
    stated = [handle.get(rank) for rank in points["rank"].tolist()]
    ledger.rows("critical_points.handle", [a == b for a, b in zip(points["handle"], stated)], "the handle of that rank")


def _is_chain(case, block):
    """Whether a block holds one region throughout and only events that leave it whole."""
    handles = case.handles_of_block[block]
    changes = [case.columns.handles["change"][h] for h in handles]
    whole = all(c in EVENTS and EVENTS[c][4] == 0 for c in changes)
    return bool(whole and (case.block_above == block).sum() == 1 == (case.block_below == block).sum())


def check_sides(case, ledger):
    """Sides from the geometry around each critical point, against those of the events.

    Where a contour next to the critical point crosses itself, material has no
    side that both could agree on; such handles are counted, and the
    interpretation of the solid tells.
    """
    t = case.columns.handles
    rank = np.empty(len(case.surface.origin), np.int64)
    rank[case.surface.origin] = np.arange(len(rank))
    places, place = np.unique(rank[t["vertex"]], return_inverse=True)
    local = np.array(local_sides(case.surface, places), object)[place]
    bounding = [below + above for below, above in zip(t["contours_below"], t["contours_above"])]
    crosses = ~shapely.is_simple(case.curves)
    tangled = np.array([crosses[contours].any() for contours in bounding], bool)
    agree = local == t["side"]
    decided = (local != "") & (agree | ~tangled)
    differ = np.flatnonzero(decided & ~agree)
    says = f"Handle {differ[0]} is the first that differs." if len(differ) else ""
    ledger.enter("sides_by_local_geometry", [int(agree.sum()), len(differ)], [int(decided.sum()), 0], says=says)
    case.open["sides that the geometry leaves open"] = (~decided).sum()
    case.crossing |= bool((~decided & tangled & (local != "")).any())
