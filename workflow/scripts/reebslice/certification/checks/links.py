"""Checks of what connects the levels: nodes and edges.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np
import shapely

from ...schemas import EVENTS
from ..recount.graphs import GraphParts, list_items
from ..recount.ranges import list_members
from ..recount.regions import build_polygons, find_regions, look_around, share
from .regions import find_floating


def check_nodes(facts, ledger):
    """One material point per region, inside it, at the height of its level."""
    t, contours, found = facts.columns.nodes, facts.columns.contours, facts.recount
    inner, region, n = contours["inner"], contours["region"], len(t["node"])
    level = np.full(n, -1)
    level[region] = contours["level"]
    area, size, edge = (np.bincount(region, v, n) for v in (found.area, np.abs(found.area), found.perimeter))
    eventful = np.bincount(facts.columns.handles["block"], minlength=facts.n_blocks) > 0
    ledger.compare(
        "nodes", t,
        ("region", t["node"], "the region's own number"),
        ("level", level, "level of the region's contours"),
        ("height", facts.levels["height"][t["level"]], "height of the level"),
        ("n_holes", np.bincount(region[inner], minlength=n), "holes of the region"),
        ("area", area, "outer contour less holes", 1e-9 * size + facts.noise * (edge + facts.noise)),
        ("critical", eventful[facts.block_above] | eventful[facts.block_below], "an event above or below"),
    )  # fmt: skip
    drawn = facts.drawn_area, facts.drawn_perimeter
    facts.regions = find_regions(facts.curves, *drawn, found.area, region, inner, n)
    facts.open["regions that cross themselves"] = facts.regions.broken.sum()
    body = np.full(n, -1)
    body[region[~inner]] = facts.body[found.shell[~inner]]
    facts.entangled = _share_material(facts, level, body)
    _check_material(facts, ledger, t)


def _share_material(facts, level, body):
    """Whether regions of different bodies overlap at some level, by more than rounding."""
    if len(np.unique(body)) < 2:
        return False
    runs = np.split(np.argsort(level, kind="stable"), np.cumsum(np.bincount(level))[:-1])
    for run in (run for run in runs if len(np.unique(body[run])) > 1):
        polygons = build_polygons(facts.regions, run)
        one, two = shapely.STRtree(polygons).query(polygons, predicate="intersects")
        apart = (one < two) & (body[run[one]] != body[run[two]])
        one, two = polygons[one[apart]], polygons[two[apart]]
        shared = shapely.area(shapely.intersection(one, two))
        rounding = facts.noise * np.minimum(shapely.length(one), shapely.length(two))
        if np.any(shared > 1e-9 * np.minimum(shapely.area(one), shapely.area(two)) + rounding):
            return True
    return False


def _check_material(facts, ledger, t):
    """Points are in the plane of their level, inside their region, as far from its contours as told."""
    points = np.stack([t[k] for k in "xyz"], axis=1) @ facts.rotation.T
    flat = np.abs(points[:, 2] - t["height"]) <= facts.noise
    ledger.rows("nodes.position", flat, "the point is in the plane of its level")
    # the outline is without holes that are mere points or lines
    inside, clearance, edge = look_around(facts.regions, points[:, :2])
    facts.inside = inside | (clearance <= facts.noise)
    ledger.rows("nodes.inside", facts.inside, "the point is inside its region")
    room = 1e-9 * clearance + facts.noise
    fits = [np.abs(t["inscribed_radius"] - np.where(inside, d, 0.0)) <= room for d in (clearance, edge)]
    ledger.rows("nodes.inscribed_radius", fits[0] | fits[1], "distance of the point to the region's contours")


def check_edges(facts, ledger):
    """The links are those of the blocks, and carry the similarities of their regions."""
    t, level = facts.columns.edges, facts.columns.nodes["level"]
    facts.parts = {"solid": _solid_parts(facts), "surface": _surface_parts(facts), **_void_parts(facts)}
    rows = zip(*list_items(facts.parts["solid"]), facts.parts["solid"].joints)
    links = {(a, b): joints[0] if joints else -1 for low, high, joints in rows for a in low for b in high}
    stated = list(zip(t["source"].tolist(), t["target"].tolist()))
    linked = np.array([pair in links for pair in stated], bool)
    handle = np.array([links.get(pair, -1) for pair in stated], np.int64)
    operation = np.append(facts.columns.handles["operation"], "continuation")[handle]
    ledger.enter("edges.method", sorted(set(t["method"])), ["exact"] if stated else [])
    ledger.enter("edges_once_each", len(set(stated)), len(stated))
    missing = sorted(set(links) - set(stated))
    ledger.enter("links_without_an_edge", len(missing), 0, says=f"The first is {missing[0]}." if missing else "")
    ledger.rows("edges.link", linked, "regions that one block joins")
    ledger.compare(
        "edges", t,
        ("linked", linked, "what the mesh says"),
        ("slab", level[t["source"]], "level of its lower end"),
        ("handle", handle, "handle that names the block"),
        ("operation", operation, "operation of the handle"),
    )  # fmt: skip
    _check_similarity(facts, ledger, t, t["source"], t["target"])


def _check_similarity(facts, ledger, t, source, target):
    """Areas of regions, of what pairs of them share and of their union, and the ratio of those."""
    area, length, broken = facts.regions.area, facts.regions.length, facts.regions.broken
    shared, larger = share(facts.regions, source, target), np.maximum(area[source], area[target])
    # overlays of shapes that touch along a line may go either way by a sliver
    room = 1e-7 * larger * (1 + 1e3 * (broken[source] | broken[target]))
    room += facts.noise * (length[source] + length[target] + facts.noise)
    union = t["area_union"]
    ratio = np.divide(t["area_intersection"], union, out=np.zeros(len(union)), where=union > 0)
    ledger.compare(
        "edges", t,
        ("area_source", area[source], "area of the lower region", room),
        ("area_target", area[target], "area of the upper region", room),
        ("area_intersection", shared, "area that both regions share", room),
        ("area_union", area[source] + area[target] - shared, "area of both regions together", room),
        ("similarity", ratio, "intersection over union", 1e-12),
    )  # fmt: skip
    facts.similarity = t["similarity"]


def _solid_parts(facts):
    """The blocks as parts, each with the handles that are nodes of the solid's graph."""
    chains = zip(facts.handles_of_block, facts.chains)
    joints = [handles if chain else find_largest(facts, handles) for handles, chain in chains]
    measure = np.bincount(facts.block, facts.recount.flux, facts.n_blocks)
    return GraphParts(facts.block_above, facts.block_below, joints, measure)


def _surface_parts(facts):
    """The pieces as parts, each with the handle that is a node of the surface's graph."""
    handles = list_members(facts.columns.handles["piece"], len(facts.kinds))
    joints = [find_largest(facts, members) for members in handles]
    return GraphParts(facts.recount.above, facts.recount.below, joints, facts.recount.piece_area)


def _void_parts(facts):
    """The blocks of the void as parts, {"void": parts}; {} where contours do not tell what is void.

    The outside goes on below all at the joint -1, above all at -2.
    """
    if facts.void_regions is None:
        return {}
    (of_piece, above, below, n), regions, t = facts.void_blocks, facts.void_regions, facts.columns.handles
    floating, outside = find_floating(facts), slice(len(regions.hole), None)
    counts = [change not in EVENTS or EVENTS[change][3] != 0 for change in t["change"]]
    events = np.flatnonzero(np.array(counts, bool) & ~np.isin(t["piece"], floating))
    facts.void_events = list_members(of_piece[t["piece"][events]], n, events)
    joints = [find_largest(facts, members) for members in facts.void_events]
    joints[below[outside][0]], joints[above[-1]] = [-1], [-2]
    measure = -np.bincount(of_piece, facts.recount.flux, n)
    measure[of_piece[np.isin(facts.recount.slab, facts.recount.slab[floating])]] = np.nan
    measure[above[outside]] = measure[below[outside]] = np.nan
    parts = GraphParts(above, below, joints, measure)
    plain = [len(low) == len(high) == 1 for low, high in zip(*list_items(parts))]
    return {"void": parts} if all(flag or named for flag, named in zip(plain, joints)) else {}


def find_largest(facts, handles):
    """Find of some handles the one that names their node: of the largest persistence, the lowest of those; a list."""
    persistence = facts.columns.handles["persistence"]
    return [min(handles, key=lambda h: (-persistence[h], h))] if handles else []
