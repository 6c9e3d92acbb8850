"""The Reeb graphs as nodes, arcs and attributes: of solid and surface, simplified, and with every material point."""

import itertools
from math import nan

import numpy as np

from ..arrays.components import connected_items
from ..formats.graphml import Graph
from .simplification import simplify_graph

JOINT_COLUMNS = ("handle", "x", "y", "z", "height", "index", "side", "operation", "change", "branches", "n_handles")
PLACE_COLUMNS = ("region", "vertex_x", "vertex_y", "vertex_z")  # of the solid's nodes alone
POINT_COLUMNS = ("node", "level", "region", "x", "y", "z", "height", "critical", "area", "inscribed_radius", "n_holes")
# What stands for an attribute that a node or edge does not have: GraphML holds no nulls, and readers refuse gaps.
WORDS = ("side", "operation", "change")
WHOLE = ("handle", "index", "n_handles", "node", "level", "region", "n_holes")
ABSENT = dict.fromkeys(WORDS, "") | dict.fromkeys(WHOLE, -1)


def reeb_graph(arcs, joints, attributes, prefix):
    """Make a Reeb graph of its arcs and joints.

    Parameters
    ----------
    arcs : list of dict
        Rows of the table `arcs` of one graph.
    joints : dict
        Row of every joint by its id, those without arcs included.
    attributes : tuple of str
        Columns of the arcs that edges carry.
    prefix : str
        Begins the id of every edge.

    Returns
    -------
    Graph
        Node h7 is the joint 7; an edge's id is `prefix` and the arc's number. It
        is an attribute as well, because igraph 1.0 takes the ids of nodes for
        those of edges unless an attribute `id` tells otherwise. Several edges
        may join the same two nodes. All nodes have all attributes, and all edges; one that is unknown or does
        not apply is "", -1 or NaN.
    """
    nodes = {joint_name(number): _joint(number, joints[number]) for number in sorted(joints)}
    edges = [
        (
            joint_name(row["source"]),
            joint_name(row["target"]),
            {"id": f"{prefix}{row['arc']}"} | _fill(row, attributes),
        )
        for row in arcs
    ]
    return Graph(nodes, edges)


def simplified_graph(arcs, joints, measure, size, prefix):
    """Make a Reeb graph without its features below a size.

    Parameters
    ----------
    arcs, joints, prefix
        As for :func:`reeb_graph`.
    measure : {"volume", "area"}
        Column whose sum over each component stays.
    size : float
        Mesh units. All pairs of the graph's extended persistence below it are
        cancelled, and components of less height are left out.

    Returns
    -------
    Graph
        A joint that does not branch, or that no arc meets, stays if its own
        persistence is not below the size.
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
    """Leave out the components of a graph that are lower than a size.

    Parameters
    ----------
    arcs : list of dict
        With source, target, lower and upper.
    size : float
        Mesh units.

    Returns
    -------
    list of dict
        Arcs of components at least that high, numbered anew in `arc`.
    """
    place = {}
    ends = [[place.setdefault(row[end], len(place)) for end in ("source", "target")] for row in arcs]
    source, target = np.array(ends, np.int64).reshape(-1, 2).T
    component = connected_items(source, target, len(place))[source]
    low, high = np.full(len(place), np.inf), np.full(len(place), -np.inf)
    np.minimum.at(low, component, [row["lower"] for row in arcs])
    np.maximum.at(high, component, [row["upper"] for row in arcs])
    left = [row for row, part in zip(arcs, component.tolist()) if high[part] - low[part] >= size]
    return [row | {"arc": number} for number, row in enumerate(left)]


def augmented_graph(parts, joints, nodes, similarity):
    """Subdivide the solid's graph by every material point.

    Parameters
    ----------
    parts : GraphParts
        Of the solid.
    joints : dict
        Row of every joint by its id.
    nodes : pyarrow.Table
    similarity : dict
        Of the edges, by lower and upper node.

    Returns
    -------
    Graph
        Node n5 is the material point 5, h7 the joint 7. An edge between two
        points is a continuation; an edge at a joint carries its operation.
    """
    rest = [name for name in POINT_COLUMNS if name not in (*JOINT_COLUMNS, "region")]
    lacks = _fill({"critical": True}, rest)
    named = {joint_name(k): {"kind": "handle"} | _joint(k, joints[k]) | lacks for k in sorted(joints)}
    lacks = {"kind": "point"} | _fill({"branches": False, "n_handles": 0}, ("label", *JOINT_COLUMNS, *PLACE_COLUMNS))
    for row in nodes.select(POINT_COLUMNS).to_pylist():
        named[f"n{row['node']}"] = lacks | {"label": f"n{row['node']}"} | row
    edges = []

    def connect(low, high, operation, similarity=nan, handle=-1):
        facts = {"id": f"e{len(edges)}", "operation": operation, "similarity": similarity, "handle": handle}
        edges.append((low, high, facts))

    for part, (lower, upper, inside) in enumerate(zip(parts.below, parts.above, parts.joints)):
        if not inside and len(lower) == len(upper) == 1:
            pair = lower[0], upper[0]
            connect(f"n{pair[0]}", f"n{pair[1]}", operation="continuation", similarity=similarity[pair])
            continue
        chain = list(inside) or [-1 - part]
        first, last = joints[chain[0]], joints[chain[-1]]
        for item in lower:
            connect(f"n{item}", joint_name(chain[0]), operation=first["operation"], handle=chain[0])
        for low, high in itertools.pairwise(chain):
            connect(joint_name(low), joint_name(high), operation=joints[high]["operation"], handle=high)
        for item in upper:
            connect(joint_name(chain[-1]), f"n{item}", operation=last["operation"], handle=chain[-1])
    return Graph(named, edges)


def describe_graph(name, model, direction, unit):
    """Describe a graph as a whole.

    Parameters
    ----------
    name : str
        One of `schemas.GRAPHS`.
    model : str
    direction : (3,) float64
        Of height, a unit vector of the model frame.
    unit : str or None
        Of lengths.

    Returns
    -------
    dict
        Attributes of the graph in GraphML; an unknown unit is "".
    """
    place = {f"direction_{axis}": float(part) for axis, part in zip("xyz", direction)}
    return {"model": model, "graph": name, **place, "unit": unit or "", "certificate": "certificate.json"}


def joint_name(number):
    """Return the node id of a joint: h7 for the handle 7, b3 for a joint without a handle, number -4."""
    return f"h{number}" if number >= 0 else f"b{-1 - number}"


def _joint(number, row):
    """The attributes of the node of a joint; the first one are words to show."""
    facts = _fill(row, JOINT_COLUMNS if "region" not in row else (*JOINT_COLUMNS, *PLACE_COLUMNS))
    words = row.get("label") or " ".join(filter(None, (joint_name(number), facts["operation"], facts["side"])))
    return {"label": words} | facts


def _fill(row, names):
    """Some attributes of a row, what stands for those that it does not have included."""
    return {name: ABSENT.get(name, nan) if row.get(name) is None else row[name] for name in names}
