"""Reeb graphs of the solid and of the surface, and the augmented graph."""

import numpy as np

from .graphml import Graph
from .simplification import simplify_graph

JOINT_COLUMNS = ("handle", "x", "y", "z", "height", "index", "side", "operation", "change", "branches", "n_handles")
POINT_COLUMNS = ("node", "level", "region", "x", "y", "z", "height", "critical", "area", "inscribed_radius", "n_holes")


def trace_arcs(parts):
    """Arcs between joints: a list of dicts source, target, nodes, measure.

    nodes : the items along the arc, upward. measure : the sum over the plain
    parts that it runs through, and an equal share, among the arc ends that
    meet there, of the parts at its two ends. A plain part that does not link
    one item to one other (only a surface that crosses itself has any) ends
    the arcs that reach it, at a joint with a negative number.
    """
    joints = [
        list(inside) or ([] if len(lower) == len(upper) == 1 else [-1 - part])
        for part, (lower, upper, inside) in enumerate(zip(parts.below, parts.above, parts.joints))
    ]
    part_above = {item: part for part, lower in enumerate(parts.below) for item in lower}
    arcs, ends = [], np.zeros(len(joints), int)
    for part, inside in enumerate(joints):
        for source, target in zip(inside[:-1], inside[1:]):
            arcs.append({"source": source, "target": target, "nodes": [], "through": [], "between": (part, part)})
        for item in parts.above[part] if inside else ():
            nodes, through, following = [item], [], part_above[item]
            while not joints[following]:
                through.append(following)
                nodes.append(parts.above[following][0])
                following = part_above[nodes[-1]]
            target = joints[following][0]
            between = part, following
            arcs.append(
                {"source": inside[-1], "target": target, "nodes": nodes, "through": through, "between": between}
            )
    for arc in arcs:
        ends[list(arc["between"])] += 1 if arc["between"][0] != arc["between"][1] else 2
    share = (parts.measure / np.maximum(ends, 1)).tolist()
    for arc in arcs:
        shares = sum(share[part] for part in arc.pop("between"))
        arc["measure"] = float(parts.measure[arc.pop("through")].sum()) + shares
    return sorted(arcs, key=lambda arc: (arc["source"], arc["target"], arc["nodes"]))


def bounding_arcs(parts, solid, surface, region, inner):
    """Which surface arcs bound which arc of the solid: two lists of lists of arc numbers.

    parts : the solid's; solid, surface : its arcs and those of the surface, as
    :func:`trace_arcs` lists them; region, inner : (C,) of the contours. The
    first list has the surface arcs around each solid arc, outer ones before
    holes; the second, the solid arcs within each surface arc, upward.

    An arc of the solid keeps its surface arcs all along, because nothing
    happens on it. One without nodes lies between two events of a chain, and
    has those surface arcs of the regions next to the chain that pass it.
    """
    arc_of = {contour: number for number, arc in enumerate(surface) for contour in arc["nodes"]}
    walls = [set() for _ in range(max(region, default=-1) + 1)]
    for contour, place in enumerate(region):
        walls[place].add(arc_of[contour])
    near = {}
    for lower, upper, joints in zip(parts.below, parts.above, parts.joints):
        if len(joints) > 1:
            near |= dict.fromkeys(zip(joints[:-1], joints[1:]), walls[lower[0]] | walls[upper[0]])
    of_solid, of_surface = [], [[] for _ in surface]
    for number, arc in enumerate(solid):
        low, high = arc["source"], arc["target"]
        around = set().union(*(walls[node] for node in arc["nodes"])) if arc["nodes"] else near[low, high]
        if not arc["nodes"]:
            around = {k for k in around if surface[k]["source"] <= low and high <= surface[k]["target"]}
        of_solid.append(sorted(around, key=lambda k: (inner[surface[k]["nodes"][0]], k)))
        for k in of_solid[-1]:
            of_surface[k].append(number)
    return of_solid, of_surface


def arc_columns(arcs, graph, joints, points, similarity, bounds):
    """The arcs of one graph ("solid" or "surface") as columns of the table `arcs`.

    joints : {id: row with x, y, z, height}; points : (R, 3) positions of the
    items, same frame as the joints; similarity : {(item, item): value}, empty
    where there is none; bounds : of each arc, those of the other graph.
    """
    measure = [None if np.isnan(arc["measure"]) else arc["measure"] for arc in arcs]
    pairs = [list(zip(arc["nodes"][:-1], arc["nodes"][1:])) for arc in arcs]
    return {
        "arc": list(range(len(arcs))),
        "graph": [graph] * len(arcs),
        "source": [arc["source"] for arc in arcs],
        "target": [arc["target"] for arc in arcs],
        "lower": [joints[arc["source"]]["height"] for arc in arcs],
        "upper": [joints[arc["target"]]["height"] for arc in arcs],
        "length": _path_lengths(arcs, joints, points),
        "volume": measure if graph == "solid" else [None] * len(arcs),
        "area": measure if graph == "surface" else [None] * len(arcs),
        "nodes": [arc["nodes"] for arc in arcs],
        "bounds": bounds,
        "similarity_min": [min((similarity[p] for p in path if p in similarity), default=None) for path in pairs],
    }


def _path_lengths(arcs, joints, points):
    """Of each arc the length from joint to joint along its points, a list."""
    place = {number: len(points) + k for k, number in enumerate(joints)}
    every = np.vstack([points, *([row[axis] for axis in "xyz"] for row in joints.values())])
    paths = [[place[arc["source"]], *arc["nodes"], place[arc["target"]]] for arc in arcs]
    steps = np.diff(every[[item for path in paths for item in path]], axis=0)
    length, end = np.linalg.norm(steps, axis=1), np.cumsum([len(path) for path in paths]).tolist()
    return [float(length[b - len(path) : b - 1].sum()) for path, b in zip(paths, end)]


def reeb_graph(arcs, joints, attributes, prefix):
    """A Reeb graph as a :class:`graphml.Graph`; several arcs may join the same two nodes.

    arcs : rows of the table `arcs` of one graph; joints : {id: row}, those
    without arcs included; attributes : names of the arc columns to carry.
    Node h7 is the joint 7; edge ids are `prefix` and the arc's number. They are
    an attribute as well, because igraph 1.0 takes the ids of nodes for those
    of edges unless an attribute `id` tells otherwise.
    """
    nodes = {joint_name(number): _scalars(joints[number], JOINT_COLUMNS) for number in sorted(joints)}
    edges = [
        (
            joint_name(row["source"]),
            joint_name(row["target"]),
            {"id": f"{prefix}{row['arc']}"} | _scalars(row, attributes),
        )
        for row in arcs
    ]
    return Graph(nodes, edges)


def simplified_graph(arcs, joints, measure, size, prefix):
    """A Reeb graph without its features below a size, as a :class:`graphml.Graph`.

    arcs, joints, prefix : as for :func:`reeb_graph`; measure : the column,
    "volume" or "area", whose sum over each component stays; size : mesh units,
    all pairs of the graph's extended persistence below it are cancelled, and
    components of less height are left out. A joint that does not branch, or that no arc meets,
    stays if its own persistence is not below the size.
    """
    order = sorted(joints, key=lambda number: (joints[number]["height"], number))
    place = {number: k for k, number in enumerate(order)}
    ends = [(place[row["source"]], place[row["target"]]) for row in arcs]
    kept = [place[number] for number, row in joints.items() if (row.get("persistence") or 0.0) >= size]
    heights = [joints[number]["height"] for number in order]
    left, measures = simplify_graph(heights, ends, [row[measure] or 0.0 for row in arcs], size, kept)
    rows = [
        {"source": order[low], "target": order[high], "lower": heights[low], "upper": heights[high], measure: m}
        for (low, high), m in zip(left.tolist(), measures.tolist())
    ]
    lonely = set(joints).difference(*((row["source"], row["target"]) for row in arcs))
    rows = drop_small_components(rows, size)
    shown = lonely.intersection(order[k] for k in kept).union(*((row["source"], row["target"]) for row in rows))
    return reeb_graph(rows, {number: joints[number] for number in shown}, ("arc", "lower", "upper", measure), prefix)


def drop_small_components(arcs, size):
    """Of a graph's arcs, dicts with source, target, lower, upper, those of components at least `size` high."""
    root = {row[end]: row[end] for row in arcs for end in ("source", "target")}

    def find(node):
        while root[node] != node:
            root[node] = node = root[root[node]]
        return node

    for row in arcs:
        root[find(row["source"])] = find(row["target"])
    low, high = {}, {}
    for row in arcs:
        part = find(row["source"])
        low[part], high[part] = min(low.get(part, np.inf), row["lower"]), max(high.get(part, -np.inf), row["upper"])
    tall = {part for part in low if high[part] - low[part] >= size}
    left = [row for row in arcs if find(row["source"]) in tall]
    return [row | {"arc": number} for number, row in enumerate(left)]


def augmented_graph(parts, joints, nodes, similarity):
    """The solid graph subdivided by every material point, a :class:`graphml.Graph`.

    nodes : the table; similarity : {(lower node, upper node): value} of the
    edges. Node n5 is the material point 5. An edge between two points is a
    continuation; an edge at a joint carries its operation.
    """
    named = {joint_name(k): {"kind": "handle"} | _scalars(joints[k], JOINT_COLUMNS) for k in sorted(joints)}
    for row in nodes.select(POINT_COLUMNS).to_pylist():
        named[f"n{row['node']}"] = {"kind": "point"} | row
    edges = []

    def connect(low, high, **labels):
        edges.append((low, high, {"id": f"e{len(edges)}"} | labels))

    for part, (lower, upper, inside) in enumerate(zip(parts.below, parts.above, parts.joints)):
        if not inside and len(lower) == len(upper) == 1:
            pair = lower[0], upper[0]
            connect(f"n{pair[0]}", f"n{pair[1]}", operation="continuation", similarity=similarity[pair])
            continue
        chain = list(inside) or [-1 - part]
        first, last = joints[chain[0]], joints[chain[-1]]
        for item in lower:
            connect(f"n{item}", joint_name(chain[0]), operation=first["operation"], handle=chain[0])
        for low, high in zip(chain[:-1], chain[1:]):
            connect(joint_name(low), joint_name(high), operation=joints[high]["operation"], handle=high)
        for item in upper:
            connect(joint_name(chain[-1]), f"n{item}", operation=last["operation"], handle=chain[-1])
    return Graph(named, edges)


def joint_name(number):
    """Node id of a joint: h7 for the handle 7, b3 for a joint without a handle."""
    return f"h{number}" if number >= 0 else f"b{-1 - number}"


def _scalars(row, names):
    """GraphML holds no nulls: an absent word becomes "", an absent number is left out."""
    words = {"side", "operation", "change"}
    return {n: "" if row[n] is None else row[n] for n in names if n in words or row.get(n) is not None}
