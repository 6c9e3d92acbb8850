"""The Reeb graphs as nodes, arcs and attributes: of solid and surface, simplified, and with every material point."""

import numpy as np

from ..formats.graphml import Graph
from .simplification import simplify_graph

JOINT_COLUMNS = ("handle", "x", "y", "z", "height", "index", "side", "operation", "change", "branches", "n_handles")
POINT_COLUMNS = ("node", "level", "region", "x", "y", "z", "height", "critical", "area", "inscribed_radius", "n_holes")


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
