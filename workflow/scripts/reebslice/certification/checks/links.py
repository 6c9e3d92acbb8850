"""Checks of what connects the levels: nodes, edges, arcs.

Each takes the case (what is known of the model so far) and a ledger to enter
its findings in; what it recomputes it leaves in the case for later checks.
"""

import numpy as np
import shapely

from ..recount.graphs import GraphParts, find_arcs
from ..recount.regions import build_polygons, find_regions, look_around, share


def check_nodes(case, ledger):
    """One material point per region, inside it, at the height of its level."""
    t, contours, found = case.columns.nodes, case.columns.contours, case.recount
    inner, region, n = np.asarray(contours["inner"], bool), contours["region"], len(t["node"])
    ledger.rows("nodes.region", t["region"] == t["node"], "the region's own number")
    outer_level = np.full(n, -1)
    outer_level[region] = contours["level"]
    ledger.rows("nodes.level", t["level"] == outer_level, "level of the region's contours")
    ledger.rows("nodes.height", t["height"] == case.levels["height"][t["level"]], "height of the level")
    ledger.rows("nodes.n_holes", t["n_holes"] == np.bincount(region[inner], minlength=n), "holes of the region")
    area = np.bincount(region, found.area, n)
    size = np.bincount(region, np.abs(found.area), n)
    edge = np.bincount(region, found.perimeter, n)
    ledger.rows(
        "nodes.area",
        np.abs(t["area"] - area) <= 1e-9 * size + case.noise * (edge + case.noise),
        "outer contour less holes",
    )
    eventful = np.array([bool(h) for h in case.handles_of_block], bool)
    ledger.rows(
        "nodes.critical",
        t["critical"] == (eventful[case.block_above] | eventful[case.block_below]),
        "an event above or below",
    )
    drawn = case.drawn_area, case.drawn_perimeter
    case.regions = find_regions(case.curves, *drawn, found.area, region, inner, n)
    case.open["regions that cross themselves"] = case.regions.broken.sum()
    outer = np.flatnonzero(~inner)
    body = np.full(n, -1)
    body[region[outer]] = case.body[found.shell[outer]]
    case.entangled |= _share_material(case, outer_level, body)
    _check_material(case, ledger, t)


def _share_material(case, level, body):
    """Whether regions of different bodies overlap at some level, by more than rounding."""
    if len(np.unique(body)) < 2:
        return False
    runs = np.split(np.argsort(level, kind="stable"), np.cumsum(np.bincount(level))[:-1])
    for run in (run for run in runs if len(np.unique(body[run])) > 1):
        polygons = build_polygons(case.regions, run)
        one, two = shapely.STRtree(polygons).query(polygons, predicate="intersects")
        apart = (one < two) & (body[run[one]] != body[run[two]])
        one, two = polygons[one[apart]], polygons[two[apart]]
        shared = shapely.area(shapely.intersection(one, two))
        rounding = case.noise * np.minimum(shapely.length(one), shapely.length(two))
        if np.any(shared > 1e-9 * np.minimum(shapely.area(one), shapely.area(two)) + rounding):
            return True
    return False


def _check_material(case, ledger, t):
    points = np.stack([t[k] for k in "xyz"], axis=1) @ case.rotation.T
    ledger.rows(
        "nodes.position", np.abs(points[:, 2] - t["height"]) <= case.noise, "the point is in the plane of its level"
    )
    # the outline is without holes that are mere points or lines
    inside, clearance, edge = look_around(case.regions, points[:, :2])
    ledger.rows("nodes.inside", inside | (clearance <= case.noise), "the point is inside its region")
    radius = t["inscribed_radius"]
    room = 1e-9 * clearance + case.noise
    fits = [np.abs(radius - np.where(inside, d, 0.0)) <= room for d in (clearance, edge)]
    ledger.rows("nodes.inscribed_radius", fits[0] | fits[1], "distance of the point to the region's contours")


def check_edges(case, ledger):
    """The links are those of the blocks, and carry the similarities of their regions."""
    t, level = case.columns.edges, case.columns.nodes["level"]
    source, target = t["source"], t["target"]
    below, above = ([[] for _ in range(case.n_blocks)] for _ in range(2))
    for region, (low, high) in enumerate(zip(case.block_above.tolist(), case.block_below.tolist())):
        below[low].append(region)
        above[high].append(region)
    operation = case.columns.handles["operation"]
    expected = {}
    for lower, upper, handles, chain in zip(below, above, case.handles_of_block, case.chains):
        first = next(iter(handles if chain else _largest(case, handles)), None)
        word = "continuation" if first is None else operation[first]
        expected |= {(a, b): (first, word) for a in lower for b in upper}
    stated = list(zip(source.tolist(), target.tolist()))
    ledger.enter("edges.method", sorted(set(t["method"])), ["exact"] if len(stated) else [])
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
    _check_similarity(case, ledger, t, source, target)


def _check_similarity(case, ledger, t, source, target):
    area, length, broken = case.regions.area, case.regions.length, case.regions.broken
    areas = {"area_source": area[source], "area_target": area[target]}
    areas["area_intersection"] = share(case.regions, source, target)
    areas["area_union"] = areas["area_source"] + areas["area_target"] - areas["area_intersection"]
    room = case.noise * (length[source] + length[target] + case.noise)
    mended = broken[source] | broken[target]
    for name, values in areas.items():
        # overlays of shapes that touch along a line may go either way by a sliver
        slack = room + 1e-7 * np.maximum(areas["area_source"], areas["area_target"]) * (1 + 1e3 * mended)
        ledger.rows(f"edges.{name}", np.abs(t[name] - values) <= slack, f"{name} of the two regions")
    union = t["area_union"]
    ratio = np.divide(t["area_intersection"], union, out=np.zeros(len(union)), where=union > 0)
    ledger.rows("edges.similarity", np.abs(t["similarity"] - ratio) <= 1e-12, "intersection over union")
    case.similarity = t["similarity"]


def check_arcs(case, ledger):
    """Arcs are the maximal chains between joints, with their sums."""
    t, handles = case.columns.arcs, case.columns.handles
    case.parts = {"solid": _solid_parts(case), "surface": _surface_parts(case)}
    levels = {"solid": case.columns.nodes["level"], "surface": case.columns.contours["level"]}
    points = _path_points(case)
    case.arcs = {}
    for graph, measure, total, noise in (
        ("solid", "volume", case.volume, case.volume_noise),
        ("surface", "area", case.area, case.area_noise),
    ):
        parts = case.parts[graph]
        expected, odd = find_arcs(parts, levels[graph])
        ledger.enter(f"arcs.{graph}.parts_that_no_arc_passes", len(odd), 0)
        rows = np.flatnonzero(t["graph"] == graph)
        ledger.rows(f"arcs.{graph}.arc", t["arc"][rows] == np.arange(len(rows)), "counted from 0")
        keys = [(int(t["source"][r]), int(t["target"][r]), tuple(t["nodes"][r])) for r in rows]
        ledger.enter(f"arcs.{graph}.number", len(keys), len(expected))
        ledger.enter(f"arcs.{graph}.distinct", len(set(keys)), len(keys))
        ledger.rows(f"arcs.{graph}.chain", [key in expected for key in keys], "a maximal chain between two events")
        if not all(key in expected for key in keys):
            continue
        case.arcs[graph] = dict(zip(rows.tolist(), keys))
        values = np.array([np.nan if t[measure][r] is None else t[measure][r] for r in rows], float)
        wanted = np.array([expected[key] for key in keys])
        ledger.rows(
            f"arcs.{graph}.{measure}",
            np.abs(values - wanted) <= noise + 1e-7 * np.abs(wanted),
            f"{measure} of its slabs",
        )
        alone = sum(parts.measure[p] for p in _lone_parts(parts))
        ledger.close(f"arcs.{graph}.total_{measure}", float(np.nansum(values)) + float(alone), total, 100 * noise)
        other = "area" if measure == "volume" else "volume"
        ledger.rows(
            f"arcs.{graph}.no_{other}", [t[other][r] is None for r in rows], f"the {graph} graph has no {other}"
        )
        source, target = ([key[k] for key in keys] for k in (0, 1))
        ledger.rows(f"arcs.{graph}.lower", t["lower"][rows] == handles["height"][source], "height of the lower event")
        ledger.rows(f"arcs.{graph}.upper", t["upper"][rows] == handles["height"][target], "height of the upper event")
        length = [_length(case, key, points[graph]) for key in keys]
        ledger.rows(
            f"arcs.{graph}.length",
            np.abs(t["length"][rows] - length) <= 1e-9 * np.array(length) + case.noise,
            "length of the path along its points",
        )
    _check_arc_similarity(case, ledger, t)
    if len(case.arcs) == 2:
        _check_bounds(case, ledger, t)


def _check_arc_similarity(case, ledger, t):
    edges = case.columns.edges
    pairs = dict(zip(zip(edges["source"].tolist(), edges["target"].tolist()), edges["similarity"].tolist()))
    holds = []
    for graph, nodes, stated in zip(t["graph"], t["nodes"], t["similarity_min"]):
        found = [pairs[p] for p in zip(nodes[:-1], nodes[1:]) if p in pairs] if graph == "solid" else []
        holds.append(stated == min(found, default=None))
    ledger.rows("arcs.similarity_min", holds, "smallest similarity of its edges")


def _check_bounds(case, ledger, t):
    """Which surface arcs bound which arc of the solid, and that each bounds an unbroken path of them."""
    inner, region = case.columns.contours["inner"], case.columns.contours["region"]
    wall = np.full(len(inner), -1)  # of each contour its surface arc
    for row, key in case.arcs["surface"].items():
        wall[list(key[2])] = t["arc"][row]
    walls = [set() for _ in case.columns.nodes["node"]]
    for contour, place in enumerate(region.tolist()):
        walls[place].add(int(wall[contour]))
    passing = _walls_in_chains(case, wall, walls)
    hole = {int(t["arc"][row]): bool(inner[key[2][0]]) for row, key in case.arcs["surface"].items()}
    paths, holds = {arc: [] for arc in hole}, []
    for row, key in case.arcs["solid"].items():
        expected = set().union(*(walls[node] for node in key[2])) if key[2] else passing.get(key[:2], set())
        outer, holes = ([k for k in sorted(expected) if hole[k] == kind] for kind in (False, True))
        holds.append(t["bounds"][row] == outer + holes and len(outer) == 1)
        for arc in expected:
            paths[arc].append((int(t["arc"][row]), key))
    ledger.rows("arcs.solid.bounds", holds, "the surface arcs around its regions, one of them outer")
    stated = [t["bounds"][row] == [arc for arc, _ in paths[int(t["arc"][row])]] for row in case.arcs["surface"]]
    ledger.rows("arcs.surface.bounds", stated, "the solid arcs whose regions its contours bound, upward")
    node = _node_of_handle(case)
    whole = []
    for row, key in case.arcs["surface"].items():
        steps = [(node[key[0]],) * 2, *(step[:2] for _, step in paths[int(t["arc"][row])]), (node[key[1]],) * 2]
        whole.append(all(low[1] == high[0] for low, high in zip(steps[:-1], steps[1:])))
    ledger.rows("arcs.surface.bounds_a_path", whole, "a path in the solid's graph between the arc's own two events")


def _walls_in_chains(case, wall, walls):
    """Surface arcs around the solid between consecutive events of a chain: {(handle, handle): set}.

    From the region below the chain upward, each event takes away the surface
    arcs below it and brings those above it.
    """
    passing = {}
    for block in np.flatnonzero(case.chains).tolist():
        current = walls[int(np.flatnonzero(case.block_above == block)[0])]
        handles = case.handles_of_block[block]
        for handle, following in zip(handles[:-1], handles[1:]):
            ends = (case.columns.handles[f"contours_{end}"][handle] for end in ("below", "above"))
            gone, come = (set(wall[contours].tolist()) for contours in ends)
            current = (current - gone) | come
            passing[handle, following] = current
    return passing


def _node_of_handle(case):
    """The node of the solid's graph that stands for each handle: a list of handles."""
    blocks = enumerate(case.columns.handles["block"].tolist())
    of_block = case.handles_of_block
    return [handle if case.chains[block] else _largest(case, of_block[block])[0] for handle, block in blocks]


def _largest(case, handles):
    """Of some handles the one that names their node: of the largest persistence, the lowest of those."""
    persistence = case.columns.handles["persistence"]
    return [min(handles, key=lambda h: (-persistence[h], h))] if handles else []


def _solid_parts(case):
    joints = [h if chain else _largest(case, h) for h, chain in zip(case.handles_of_block, case.chains)]
    measure = np.bincount(case.block, case.piece_flux, case.n_blocks)
    return GraphParts(case.block_above, case.block_below, joints, measure)


def _surface_parts(case):
    handles = [[] for _ in case.kinds]
    for handle, piece in enumerate(case.columns.handles["piece"].tolist()):
        handles[piece].append(handle)
    joints = [_largest(case, members) for members in handles]
    return GraphParts(case.above, case.below, joints, case.piece_area)


def _lone_parts(parts):
    """Parts with a joint that no arc meets."""
    touched = np.bincount(np.concatenate([parts.above, parts.below]), minlength=len(parts.joints)) > 0
    return [p for p, joints in enumerate(parts.joints) if len(joints) == 1 and not touched[p]]


def _path_points(case):
    nodes, contours = case.columns.nodes, case.columns.contours
    centres = np.column_stack([case.centres, contours["height"]]) @ case.rotation
    return {"solid": np.stack([nodes[k] for k in "xyz"], axis=1), "surface": centres}


def _length(case, key, points):
    source, target, items = key
    ends = np.stack([column[case.columns.handles["vertex"][[source, target]]] for column in case.points], axis=-1)
    path = np.concatenate([ends[:1], points[list(items)].reshape(-1, 3), ends[1:]])
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
