"""Checks of the arcs: chains of links between events, and which arcs of the surface bound which of solid and void.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

from itertools import pairwise

import numpy as np

from ..recount.graphs import find_arcs
from ..recount.ranges import list_members
from .links import find_largest

MEASURES = {"solid": ("volume", "area"), "surface": ("area", "volume"), "void": ("volume", "area")}


def check_arcs(facts, ledger):
    """Arcs are the maximal chains between joints, with their sums."""
    t, facts.arcs = facts.columns.arcs, {}
    levels = {"solid": facts.columns.nodes["level"], "surface": facts.columns.contours["level"]}
    levels |= {"void": facts.void_regions.level} if "void" in facts.parts else {}
    for graph in MEASURES:
        rows = np.flatnonzero(t["graph"] == graph)
        found, odd = find_arcs(facts.parts[graph], levels[graph]) if graph in levels else ({}, ())
        expected = {(*key[:2], tuple(_name_items(facts, graph, key[2]))): key for key in found}
        ledger.enter(f"arcs.{graph}.parts_that_no_arc_passes", len(odd), 0)
        keys = [(int(t["source"][r]), int(t["target"][r]), tuple(t["nodes"][r])) for r in rows]
        ledger.enter(f"arcs.{graph}.number", len(keys), len(expected))
        ledger.enter(f"arcs.{graph}.distinct", len(set(keys)), len(keys))
        ledger.rows(f"arcs.{graph}.chain", [key in expected for key in keys], "a maximal chain between two events")
        if graph in levels and all(key in expected for key in keys):
            keys = [expected[key] for key in keys]
            facts.arcs[graph] = dict(zip(rows.tolist(), keys))
            _check_measures(facts, ledger, graph, rows, keys, np.array([found[key] for key in keys]))
    _check_similarity(facts, ledger, t)
    if facts.arcs.keys() >= {"solid", "surface"}:
        _check_bounds(facts, ledger, t)


def _name_items(facts, graph, items):
    """Items as the column `nodes` tells them: of the void the contours of holes, of the outside nothing."""
    if graph != "void":
        return items
    hole = facts.void_regions.hole
    return [int(hole[item]) for item in items if item < len(hole)]


def _check_measures(facts, ledger, graph, rows, keys, wanted):
    """Volumes or areas, heights of the ends and lengths of arcs; wanted : volume or area of each."""
    t, (measure, other), parts = facts.columns.arcs, MEASURES[graph], facts.parts[graph]
    height, noise = extend_ends(facts.columns.handles["height"]), getattr(facts, f"{measure}_noise")
    of_graph = {column: values[rows] for column, values in t.items() if isinstance(values, np.ndarray)}
    length = _path_lengths(facts, graph, keys)
    ledger.compare(
        f"arcs.{graph}", of_graph,
        ("arc", np.arange(len(rows)), "counted from 0"),
        (measure, wanted, f"{measure} of its slabs", noise + 1e-7 * np.abs(wanted)),
        ("lower", height[[source for source, _, _ in keys]], "height of the lower event"),
        ("upper", height[[target for _, target, _ in keys]], "height of the upper event"),
        ("length", length, "length along its points", 1e-9 * length + facts.noise),
    )  # fmt: skip
    ledger.rows(f"arcs.{graph}.no_{other}", np.isnan(of_graph[other]), f"the {graph} graph has no {other}")
    if graph == "void":  # most of it is the outside's
        return
    touched = np.bincount(np.concatenate([parts.above, parts.below]), minlength=len(parts.joints)) > 0
    alone = sum(parts.measure[p] for p, joints in enumerate(parts.joints) if len(joints) == 1 and not touched[p])
    total = np.nansum(of_graph[measure]) + alone
    ledger.close(f"arcs.{graph}.total_{measure}", total, getattr(facts, measure), 100 * noise)


def extend_ends(column):
    """Append to a column of `handles` what -2 and -1 stand for: the highest and the lowest, in order of height."""
    return np.append(column, column[[-1, 0]])


def _path_lengths(facts, graph, keys):
    """Lengths of the paths from the lower node of each arc along its points to the upper one; NaN for the outside."""
    nodes, contours = facts.columns.nodes, facts.columns.contours
    if graph == "solid":
        points = np.stack([nodes[k] for k in "xyz"], axis=1)
    else:
        points = np.column_stack([facts.centres, contours["height"]]) @ facts.rotation
    vertex, lengths = extend_ends(facts.columns.handles["vertex"]), []
    spots = facts.spots if graph == "solid" else np.stack([column[vertex] for column in facts.points], axis=-1)
    for source, target, items in keys:
        items = list(_name_items(facts, graph, items))
        path = np.concatenate([spots[[source]], points[items].reshape(-1, 3), spots[[target]]])
        length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        lengths.append(np.nan if graph == "void" and not items else length)
    return np.array(lengths)


def _check_similarity(facts, ledger, t):
    """The smallest similarity along each arc of the solid."""
    edges = facts.columns.edges
    pairs = dict(zip(zip(edges["source"].tolist(), edges["target"].tolist()), edges["similarity"].tolist()))
    steps = (pairwise(nodes) if graph == "solid" else () for graph, nodes in zip(t["graph"], t["nodes"]))
    least = np.array([min((pairs[p] for p in path if p in pairs), default=np.nan) for path in steps])
    same = (t["similarity_min"] == least) | (np.isnan(t["similarity_min"]) & np.isnan(least))
    ledger.rows("arcs.similarity_min", same, "smallest similarity of its edges")


def _check_bounds(facts, ledger, t):
    """Which surface arcs bound which arc of the solid, and that each bounds an unbroken path of them."""
    inner, region = facts.columns.contours["inner"], facts.columns.contours["region"]
    wall = np.full(len(inner), -1)  # of each contour its surface arc
    for row, key in facts.arcs["surface"].items():
        wall[list(key[2])] = t["arc"][row]
    walls = [set() for _ in facts.columns.nodes["node"]]
    for place, arc in zip(region.tolist(), wall.tolist()):
        walls[place].add(arc)
    passing = _walls_in_chains(facts, wall, walls)
    hole = {int(t["arc"][row]): bool(inner[key[2][0]]) for row, key in facts.arcs["surface"].items()}
    paths, holds = {arc: [] for arc in hole}, []
    for row, key in facts.arcs["solid"].items():
        expected = set().union(*(walls[node] for node in key[2])) if key[2] else passing.get(key[:2], set())
        around = sorted(expected, key=lambda arc: (hole[arc], arc))  # the outer one first
        holds.append(t["bounds"][row] == around and [hole[arc] for arc in around].count(False) == 1)
        for arc in expected:
            paths[arc].append((int(t["arc"][row]), key))
    ledger.rows("arcs.solid.bounds", holds, "the surface arcs around its regions, one of them outer")
    node, stated, whole = _node_of_handle(facts), [], []
    for row, key in facts.arcs["surface"].items():
        path = paths[int(t["arc"][row])]
        stated.append(t["bounds"][row] == [arc for arc, _ in path])
        steps = [(node[key[0]],) * 2, *(step[:2] for _, step in path), (node[key[1]],) * 2]
        whole.append(all(low[1] == high[0] for low, high in pairwise(steps)))
    ledger.rows("arcs.surface.bounds", stated, "the solid arcs whose regions its contours bound, upward")
    ledger.rows("arcs.surface.bounds_a_path", whole, "a path in the solid's graph between the arc's own two events")
    if "void" in facts.arcs:
        _check_void_bounds(facts, ledger, t, wall, hole)


def _check_void_bounds(facts, ledger, t, wall, hole):
    """The surface arcs next to the regions along each arc of the void, those of holes first.

    wall : (C,) surface arc of each contour; hole : {surface arc: whether its contours are holes}
    """
    regions, holds = facts.void_regions, []
    beside = list_members(regions.of_contour, len(regions.level))
    for row, (_, _, items) in facts.arcs["void"].items():
        expected = set(wall[[contour for item in items for contour in beside[item]]].tolist())
        holds.append(t["bounds"][row] == sorted(expected, key=lambda arc: (not hole[arc], arc)))
    ledger.rows("arcs.void.bounds", holds, "the surface arcs next to its regions, those of holes first")


def _walls_in_chains(facts, wall, walls):
    """Surface arcs around the solid between consecutive events of a chain: {(handle, handle): set}.

    From the region below the chain upward, each event takes away the surface
    arcs below it and brings those above it.
    """
    passing, handles = {}, facts.columns.handles
    for block in np.flatnonzero(facts.chains).tolist():
        current = walls[int(np.flatnonzero(facts.block_above == block)[0])]
        for handle, following in pairwise(facts.handles_of_block[block]):
            gone, come = (set(wall[handles[f"contours_{end}"][handle]].tolist()) for end in ("below", "above"))
            current = passing[handle, following] = (current - gone) | come
    return passing


def _node_of_handle(facts):
    """The node of the solid's graph that stands for each handle: a list of handles."""
    blocks = enumerate(facts.columns.handles["block"].tolist())
    of_block = facts.handles_of_block
    return [handle if facts.chains[block] else find_largest(facts, of_block[block])[0] for handle, block in blocks]
