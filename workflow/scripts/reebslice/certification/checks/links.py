"""Checks of what connects the levels: nodes, edges, arcs.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import itertools

import numpy as np
import shapely

from ..recount.graphs import GraphParts, find_arcs
from ..recount.regions import build_polygons, find_regions, look_around, share


def check_nodes(facts, ledger):
    """One material point per region, inside it, at the height of its level."""
    t, contours, found = facts.columns.nodes, facts.columns.contours, facts.recount
    inner, region, n = np.asarray(contours["inner"], bool), contours["region"], len(t["node"])
    ledger.rows("nodes.region", t["region"] == t["node"], "the region's own number")
    outer_level = np.full(n, -1)
    outer_level[region] = contours["level"]
    ledger.rows("nodes.level", t["level"] == outer_level, "level of the region's contours")
    ledger.rows("nodes.height", t["height"] == facts.levels["height"][t["level"]], "height of the level")
    ledger.rows("nodes.n_holes", t["n_holes"] == np.bincount(region[inner], minlength=n), "holes of the region")
    area = np.bincount(region, found.area, n)
    size = np.bincount(region, np.abs(found.area), n)
    edge = np.bincount(region, found.perimeter, n)
    ledger.rows(
        "nodes.area",
        np.abs(t["area"] - area) <= 1e-9 * size + facts.noise * (edge + facts.noise),
        "outer contour less holes",
    )
    eventful = np.array([bool(h) for h in facts.handles_of_block], bool)
    ledger.rows(
        "nodes.critical",
        t["critical"] == (eventful[facts.block_above] | eventful[facts.block_below]),
        "an event above or below",
    )
    drawn = facts.drawn_area, facts.drawn_perimeter
    facts.regions = find_regions(facts.curves, *drawn, found.area, region, inner, n)
    facts.open["regions that cross themselves"] = facts.regions.broken.sum()
    outer = np.flatnonzero(~inner)
    body = np.full(n, -1)
    body[region[outer]] = facts.body[found.shell[outer]]
    facts.entangled = _share_material(facts, outer_level, body)
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
    ledger.rows(
        "nodes.position", np.abs(points[:, 2] - t["height"]) <= facts.noise, "the point is in the plane of its level"
    )
    # the outline is without holes that are mere points or lines
    inside, clearance, edge = look_around(facts.regions, points[:, :2])
    ledger.rows("nodes.inside", inside | (clearance <= facts.noise), "the point is inside its region")
    radius = t["inscribed_radius"]
    room = 1e-9 * clearance + facts.noise
    fits = [np.abs(radius - np.where(inside, d, 0.0)) <= room for d in (clearance, edge)]
    ledger.rows("nodes.inscribed_radius", fits[0] | fits[1], "distance of the point to the region's contours")


def check_edges(facts, ledger):
    """The links are those of the blocks, and carry the similarities of their regions."""
    t, level = facts.columns.edges, facts.columns.nodes["level"]
    source, target = t["source"], t["target"]
    below, above = ([[] for _ in range(facts.n_blocks)] for _ in range(2))
    for region, (low, high) in enumerate(zip(facts.block_above.tolist(), facts.block_below.tolist())):
        below[low].append(region)
        above[high].append(region)
    operation = facts.columns.handles["operation"]
    expected = {}
    for lower, upper, handles, chain in zip(below, above, facts.handles_of_block, facts.chains):
        first = next(iter(handles if chain else _largest(facts, handles)), None)
        word = "continuation" if first is None else operation[first]
        expected |= {(a, b): (first, word) for a in lower for b in upper}
    stated = list(zip(source.tolist(), target.tolist()))
    ledger.enter("edges.method", sorted(set(t["method"])), ["exact"] if stated else [])
    ledger.enter("edges_once_each", len(set(stated)), len(stated))
    missing = sorted(set(expected) - set(stated))
    ledger.enter("links_without_an_edge", len(missing), 0, says=f"The first is {missing[0]}." if missing else "")
    ledger.rows("edges.link", [pair in expected for pair in stated], "regions that one block joins")
    ledger.rows(
        "edges.linked", t["linked"] == np.array([pair in expected for pair in stated], bool), "what the mesh says"
    )
    ledger.rows("edges.slab", (t["slab"] == level[source]) & (level[target] == level[source] + 1), "levels of its ends")
    ledger.rows(
        "edges.handle",
        [expected.get(p, (h,))[0] == h for p, h in zip(stated, t["handle"])],
        "handle that names the block",
    )
    ledger.rows(
        "edges.operation",
        [expected.get(p, (0, w))[1] == w for p, w in zip(stated, t["operation"])],
        "operation of the handle",
    )
    _check_similarity(facts, ledger, t, source, target)


def _check_similarity(facts, ledger, t, source, target):
    """Areas of regions, of what pairs of them share and of their union, and the ratio of those."""
    area, length, broken = facts.regions.area, facts.regions.length, facts.regions.broken
    areas = {"area_source": area[source], "area_target": area[target]}
    areas["area_intersection"] = share(facts.regions, source, target)
    areas["area_union"] = areas["area_source"] + areas["area_target"] - areas["area_intersection"]
    room = facts.noise * (length[source] + length[target] + facts.noise)
    mended = broken[source] | broken[target]
    for name, values in areas.items():
        # overlays of shapes that touch along a line may go either way by a sliver
        slack = room + 1e-7 * np.maximum(areas["area_source"], areas["area_target"]) * (1 + 1e3 * mended)
        ledger.rows(f"edges.{name}", np.abs(t[name] - values) <= slack, f"{name} of the two regions")
    union = t["area_union"]
    ratio = np.divide(t["area_intersection"], union, out=np.zeros(len(union)), where=union > 0)
    ledger.rows("edges.similarity", np.abs(t["similarity"] - ratio) <= 1e-12, "intersection over union")
    facts.similarity = t["similarity"]


def check_arcs(facts, ledger):
    """Arcs are the maximal chains between joints, with their sums."""
    t = facts.columns.arcs
    facts.parts = {"solid": _solid_parts(facts), "surface": _surface_parts(facts)}
    levels = {"solid": facts.columns.nodes["level"], "surface": facts.columns.contours["level"]}
    facts.arcs = {}
    for graph, parts in facts.parts.items():
        expected, odd = find_arcs(parts, levels[graph])
        ledger.enter(f"arcs.{graph}.parts_that_no_arc_passes", len(odd), 0)
        rows = np.flatnonzero(t["graph"] == graph)
        ledger.rows(f"arcs.{graph}.arc", t["arc"][rows] == np.arange(len(rows)), "counted from 0")
        keys = [(int(t["source"][r]), int(t["target"][r]), tuple(t["nodes"][r])) for r in rows]
        ledger.enter(f"arcs.{graph}.number", len(keys), len(expected))
        ledger.enter(f"arcs.{graph}.distinct", len(set(keys)), len(keys))
        ledger.rows(f"arcs.{graph}.chain", [key in expected for key in keys], "a maximal chain between two events")
        if all(key in expected for key in keys):
            facts.arcs[graph] = dict(zip(rows.tolist(), keys))
            _check_arc_measures(facts, ledger, graph, rows, keys, np.array([expected[key] for key in keys]))
    _check_arc_similarity(facts, ledger, t)
    if len(facts.arcs) == 2:
        _check_bounds(facts, ledger, t)


def _check_arc_measures(facts, ledger, graph, rows, keys, wanted):
    """Volumes or areas, heights of the ends and lengths of arcs; wanted : volume or area of each."""
    t, height, parts = facts.columns.arcs, facts.columns.handles["height"], facts.parts[graph]
    measure, other, total, noise = {
        "solid": ("volume", "area", facts.volume, facts.volume_noise),
        "surface": ("area", "volume", facts.area, facts.area_noise),
    }[graph]
    values = np.array([np.nan if t[measure][r] is None else t[measure][r] for r in rows], float)
    room = noise + 1e-7 * np.abs(wanted)
    ledger.rows(f"arcs.{graph}.{measure}", np.abs(values - wanted) <= room, f"{measure} of its slabs")
    alone = sum(parts.measure[p] for p in _lone_parts(parts))
    ledger.close(f"arcs.{graph}.total_{measure}", float(np.nansum(values)) + float(alone), total, 100 * noise)
    ledger.rows(f"arcs.{graph}.no_{other}", [t[other][r] is None for r in rows], f"the {graph} graph has no {other}")
    for end, place in (("lower", 0), ("upper", 1)):
        same = t[end][rows] == height[[key[place] for key in keys]]
        ledger.rows(f"arcs.{graph}.{end}", same, f"height of the {end} event")
    points = _path_points(facts)[graph]
    length = np.array([_length(facts, key, points) for key in keys])
    room = 1e-9 * length + facts.noise
    ledger.rows(f"arcs.{graph}.length", np.abs(t["length"][rows] - length) <= room, "length along its points")


def _check_arc_similarity(facts, ledger, t):
    """The smallest similarity along each arc of the solid."""
    edges = facts.columns.edges
    pairs = dict(zip(zip(edges["source"].tolist(), edges["target"].tolist()), edges["similarity"].tolist()))
    holds = []
    for graph, nodes, stated in zip(t["graph"], t["nodes"], t["similarity_min"]):
        found = [pairs[p] for p in itertools.pairwise(nodes) if p in pairs] if graph == "solid" else []
        holds.append(stated == min(found, default=None))
    ledger.rows("arcs.similarity_min", holds, "smallest similarity of its edges")


def _check_bounds(facts, ledger, t):
    """Which surface arcs bound which arc of the solid, and that each bounds an unbroken path of them."""
    inner, region = facts.columns.contours["inner"], facts.columns.contours["region"]
    wall = np.full(len(inner), -1)  # of each contour its surface arc
    for row, key in facts.arcs["surface"].items():
        wall[list(key[2])] = t["arc"][row]
    walls = [set() for _ in facts.columns.nodes["node"]]
    for contour, place in enumerate(region.tolist()):
        walls[place].add(int(wall[contour]))
    passing = _walls_in_chains(facts, wall, walls)
    hole = {int(t["arc"][row]): bool(inner[key[2][0]]) for row, key in facts.arcs["surface"].items()}
    paths, holds = {arc: [] for arc in hole}, []
    for row, key in facts.arcs["solid"].items():
        expected = set().union(*(walls[node] for node in key[2])) if key[2] else passing.get(key[:2], set())
        outer, holes = ([k for k in sorted(expected) if hole[k] == kind] for kind in (False, True))
        holds.append(t["bounds"][row] == outer + holes and len(outer) == 1)
        for arc in expected:
            paths[arc].append((int(t["arc"][row]), key))
    ledger.rows("arcs.solid.bounds", holds, "the surface arcs around its regions, one of them outer")
    stated = [t["bounds"][row] == [arc for arc, _ in paths[int(t["arc"][row])]] for row in facts.arcs["surface"]]
    ledger.rows("arcs.surface.bounds", stated, "the solid arcs whose regions its contours bound, upward")
    node = _node_of_handle(facts)
    whole = []
    for row, key in facts.arcs["surface"].items():
        steps = [(node[key[0]],) * 2, *(step[:2] for _, step in paths[int(t["arc"][row])]), (node[key[1]],) * 2]
        whole.append(all(low[1] == high[0] for low, high in itertools.pairwise(steps)))
    ledger.rows("arcs.surface.bounds_a_path", whole, "a path in the solid's graph between the arc's own two events")


def _walls_in_chains(facts, wall, walls):
    """Surface arcs around the solid between consecutive events of a chain: {(handle, handle): set}.

    From the region below the chain upward, each event takes away the surface
    arcs below it and brings those above it.
    """
    passing = {}
    for block in np.flatnonzero(facts.chains).tolist():
        current = walls[int(np.flatnonzero(facts.block_above == block)[0])]
        handles = facts.handles_of_block[block]
        for handle, following in itertools.pairwise(handles):
            ends = (facts.columns.handles[f"contours_{end}"][handle] for end in ("below", "above"))
            gone, come = (set(wall[contours].tolist()) for contours in ends)
            current = (current - gone) | come
            passing[handle, following] = current
    return passing


def _node_of_handle(facts):
    """The node of the solid's graph that stands for each handle: a list of handles."""
    blocks = enumerate(facts.columns.handles["block"].tolist())
    of_block = facts.handles_of_block
    return [handle if facts.chains[block] else _largest(facts, of_block[block])[0] for handle, block in blocks]


def _largest(facts, handles):
    """Of some handles the one that names their node: of the largest persistence, the lowest of those."""
    persistence = facts.columns.handles["persistence"]
    return [min(handles, key=lambda h: (-persistence[h], h))] if handles else []


def _solid_parts(facts):
    """The blocks as parts, each with the handles that are nodes of the solid's graph."""
    joints = [h if chain else _largest(facts, h) for h, chain in zip(facts.handles_of_block, facts.chains)]
    measure = np.bincount(facts.block, facts.piece_flux, facts.n_blocks)
    return GraphParts(facts.block_above, facts.block_below, joints, measure)


def _surface_parts(facts):
    """The pieces as parts, each with the handle that is a node of the surface's graph."""
    handles = [[] for _ in facts.kinds]
    for handle, piece in enumerate(facts.columns.handles["piece"].tolist()):
        handles[piece].append(handle)
    joints = [_largest(facts, members) for members in handles]
    return GraphParts(facts.above, facts.below, joints, facts.piece_area)


def _lone_parts(parts):
    """Parts with a joint that no arc meets."""
    touched = np.bincount(np.concatenate([parts.above, parts.below]), minlength=len(parts.joints)) > 0
    return [p for p, joints in enumerate(parts.joints) if len(joints) == 1 and not touched[p]]


def _path_points(facts):
    """Points (I, 3) in the model frame that arcs pass, per graph."""
    nodes, contours = facts.columns.nodes, facts.columns.contours
    centres = np.column_stack([facts.centres, contours["height"]]) @ facts.rotation
    return {"solid": np.stack([nodes[k] for k in "xyz"], axis=1), "surface": centres}


def _length(facts, key, points):
    """Length of the path from the lower event of an arc along its points to the upper one."""
    source, target, items = key
    ends = np.stack([column[facts.columns.handles["vertex"][[source, target]]] for column in facts.points], axis=-1)
    path = np.concatenate([ends[:1], points[list(items)].reshape(-1, 3), ends[1:]])
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
