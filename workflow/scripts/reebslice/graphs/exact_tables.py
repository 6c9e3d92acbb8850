"""The exact Reeb graphs of surface and solid as tables and as GraphML, without levels."""

import numpy as np
import pyarrow.compute as pc

from ..errors import TooManyCrossingsError
from ..formats.graphml import Graph
from ..handles.classification import local_event
from ..morse.contour_trees import find_gates
from ..morse.critical_points import morse_indices
from ..morse.persistence import pair_kinds
from ..morse.reeb_graph import surface_reeb_graph
from ..schemas import EVENTS
from ..table_checks import build_table
from .exact import solid_reeb_graph
from .outer_arcs import find_inner_arcs

NODE_COLUMNS = ("node", "x", "y", "z", "height", "index", "side", "operation", "change", "branches", "persistence")
# by how many holes and outer contours there are below, and above
CHANGES = {
    tuple(end.count(kind) for end in change.split("->") for kind in "io"): change for change in EVENTS
}  # fmt: skip


def exact_tables(mesh, points, body_of_vertex):
    """Make the tables `exact_nodes` and `exact_arcs`.

    Parameters
    ----------
    mesh : HeightMesh
        Of k vertices, whose saddles are simple.
    points : (n, 3) float64
        Surface vertices, model frame.
    body_of_vertex : (k,) int32
        Bodies that may overlap.

    Returns
    -------
    nodes, arcs : pyarrow.Table
        As `schemas` declares them. A surface that crosses itself may have contours that fit no solid, or too many of
        them to tell its graph by; then no event has a `change`, and there is no graph of the solid.
    """
    graph = surface_reeb_graph(mesh)
    inner = find_inner_arcs(mesh, graph, find_gates(mesh.faces, mesh.twins, len(mesh.points)).into)
    solid = None if inner is None else _solid_arcs(mesh, graph, body_of_vertex)
    if solid is None:
        inner, solid = None, np.empty((0, 2), np.int64)
    return _node_table(mesh, points, graph, inner, solid), _arc_table(mesh.points[graph.nodes, 2], graph, inner, solid)


def _solid_arcs(mesh, graph, body_of_vertex):
    """Arcs (A, 2) of the solid between places in `graph.nodes`; None where sheets that cross make others."""
    try:
        ranks, arcs = solid_reeb_graph(mesh, graph, body_of_vertex)
    except TooManyCrossingsError:
        return None
    place = np.searchsorted(graph.nodes, ranks)
    if not (graph.nodes[np.minimum(place, len(graph.nodes) - 1)] == ranks).all():
        return None
    return place[arcs]


def _node_table(mesh, points, graph, inner, solid):
    """The table `exact_nodes`; inner : (A,) bool of the surface's arcs, or None; solid : arcs of the solid."""
    count, height = len(graph.nodes), mesh.points[graph.nodes, 2]
    index = morse_indices(mesh, graph.nodes)
    in_solid = np.zeros(count, bool)
    in_solid[solid.ravel()] = True
    if inner is None:
        change, branches = [None] * count, [True] * count
        side, operation = local_event(mesh, graph.nodes, index)
    else:
        change = name_changes(count, graph.arcs, inner)
        side, operation, branches = zip(*((EVENTS[c][0], EVENTS[c][5], EVENTS[c][4] != 0) for c in change))
    columns = {
        "node": np.arange(count),
        "vertex": mesh.vertex[graph.nodes],
        "rank": graph.nodes,
        "height": height,
        **dict(zip("xyz", points[mesh.vertex[graph.nodes]].T)),
        "index": index,
        "side": side,
        "operation": operation,
        "change": change,
        "branches": branches,
        "partner": graph.partner,
        "pairing": pair_kinds(index, graph.partner),
        "persistence": np.abs(height - height[graph.partner]),
        "in_solid": in_solid,
    }
    return build_table("exact_nodes", columns)


def name_changes(count, arcs, inner):
    """Name the event at every node of a surface's Reeb graph by the contours below and above it.

    Parameters
    ----------
    count : int
        Of nodes.
    arcs : (A, 2) int
        Nodes at both ends of each, the lower one first.
    inner : (A,) bool
        Which are holes.

    Returns
    -------
    list of str
        Such as "o->i,o", a key of `schemas.EVENTS`.
    """
    ends = [np.bincount(arcs[kind, end], minlength=count) for end in (1, 0) for kind in (inner, ~inner)]
    return [CHANGES[numbers] for numbers in zip(*(column.tolist() for column in ends))]


def _arc_table(height, graph, inner, solid):
    """The table `exact_arcs`; height : (K,) of the nodes."""
    arcs, sizes = np.concatenate([graph.arcs, solid]), (len(graph.arcs), len(solid))
    columns = {
        "graph": np.repeat(["surface", "solid"], sizes),
        "arc": np.concatenate([np.arange(size) for size in sizes]),
        **dict(zip(("source", "target"), arcs.T)),
        **dict(zip(("lower", "upper"), height[arcs].T)),
        "inner": np.append(np.zeros(sizes[0], bool) if inner is None else inner, np.zeros(sizes[1], bool)),
    }
    return build_table("exact_arcs", columns)


def name_graph(name, nodes, arcs):
    """Make one of the graphs of its tables.

    Parameters
    ----------
    name : {"exact_surface", "exact_solid"}
    nodes, arcs : pyarrow.Table
        `exact_nodes` and `exact_arcs`.

    Returns
    -------
    Graph
        Node c7 is the node 7 of `exact_nodes`; an edge's id is `c` or `s` and its number in `exact_arcs`.
    """
    solid = name == "exact_solid"
    shown = nodes.filter(nodes["in_solid"]) if solid else nodes
    named = {}
    for row in shown.select(NODE_COLUMNS).to_pylist():
        words = {"label": f"c{row['node']} {row['operation']} {row['side']}"}
        named[f"c{row['node']}"] = words | row | {"change": row["change"] or ""}
    columns, letter = ("arc", "lower", "upper", *([] if solid else ["inner"])), "s" if solid else "c"
    edges = []
    for row in arcs.filter(pc.equal(arcs["graph"], name.removeprefix("exact_"))).to_pylist():
        facts = {"id": f"{letter}{row['arc']}"} | {column: row[column] for column in columns}
        edges.append((f"c{row['source']}", f"c{row['target']}", facts))
    return Graph(named, edges)
