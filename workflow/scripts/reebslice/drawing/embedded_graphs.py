"""The Reeb graphs of a model as they are shown in place: nodes, and arcs as curves with the faces around them."""

import itertools
from typing import NamedTuple

import numpy as np

from .arc_routes import route_arcs

SHOWN = ("solid", "solid_simplified", "surface", "surface_simplified")
LARGEST = 3000  # nodes and arcs, beyond which a graph cannot be read and is left out
ROUTED = 10 * LARGEST  # arcs of a full graph, beyond which simplified ones are not routed through it
FIGURES = ("arc", "lower", "upper", "length", "volume", "area", "similarity_min", "inner")


class EmbeddedGraph(NamedTuple):
    """A graph of K nodes and A arcs.

    Attributes
    ----------
    nodes : list of dict
        Attributes of the nodes as GraphML has them, and `name`.
    ends : (A, 2) int
        Lower and upper node of every arc.
    arcs : list of dict
        Attributes of the arcs.
    spots : (K, 3) float64
        Where the nodes are drawn, model frame: of the solid's graph where they lie in the material; of the
        surface's at their critical vertices, or, where arcs meet on one side, at the last point of the one arc on
        the other, so that no arc is pulled to the vertex.
    paths : list of (k, 3) float64
        From the lower to the upper node.
    walls : list of list of int
        Arcs of the surface's graph on which the faces around each arc lie.
    """

    nodes: list
    ends: np.ndarray
    arcs: list
    spots: np.ndarray
    paths: list
    walls: list


def embed_graphs(graphs, arcs, material, centres):
    """Embed the graphs of a model.

    Parameters
    ----------
    graphs : dict of str to Graph
        Those in `SHOWN`, as the workflow wrote them.
    arcs : list of dict
        Rows of the table `arcs`.
    material, centres : (R, 3) and (C, 3) float64
        Material points of regions and centroids of contours, model frame.

    Returns
    -------
    dict of str to EmbeddedGraph
        Without those of more than `LARGEST` nodes and arcs. An arc of a simplified graph runs through the full
        one, and has around it the faces of all that was simplified into it.
    """
    embedded = {}
    for name, graph in graphs.items():
        whole = name.split("_")[0]
        if len(graph.nodes) + len(graph.edges) > LARGEST:
            continue
        own = [row for row in arcs if row["graph"] == whole]
        if name == whole or len(own) <= ROUTED:
            embedded[name] = embed_graph(name, graph, own, material if whole == "solid" else centres)
    return embedded


def embed_graph(name, graph, arcs, points):
    """Embed one graph, whatever its size.

    Parameters
    ----------
    name : str
        One of `SHOWN`.
    graph : Graph
    arcs : list of dict
        Rows of the table `arcs` of the full graph.
    points : (R, 3) or (C, 3) float64
        Material points of regions, or centroids of contours, model frame.

    Returns
    -------
    EmbeddedGraph
        Arcs of a simplified graph are straight, and have nothing around them, where the full one has more than
        `ROUTED` arcs.
    """
    rows = {row["arc"]: row for row in arcs}
    if "_" not in name:
        return _embed_full(graph, rows, points)
    if len(rows) <= ROUTED:
        return _embed_simplified(graph, rows, points)
    nodes, ends, taken = _take_graph(graph)
    return EmbeddedGraph(nodes, ends, taken, *_place(nodes, ends, [np.empty((0, 3))] * len(taken)), [[] for _ in taken])


def _embed_full(graph, rows, points):
    """The :class:`EmbeddedGraph` of a graph whose arcs are rows of the table."""
    nodes, ends, arcs = _take_graph(graph)
    own = [rows[arc["arc"]] for arc in arcs]
    spots, paths = _place(nodes, ends, [points[row["nodes"]] for row in own])
    return EmbeddedGraph(nodes, ends, arcs, spots, paths, [_walls(row) for row in own])


def _embed_simplified(graph, rows, points):
    """The same of a graph whose arcs are simplified ones."""
    nodes, ends, arcs = _take_graph(graph)
    numbers = sorted(rows)
    full = np.array([[rows[k]["source"], rows[k]["target"]] for k in numbers], np.int64).reshape(-1, 2)
    joint = [int(node["name"][1:]) if node["name"][0] == "h" else -1 - int(node["name"][1:]) for node in nodes]
    _, place = np.unique(np.concatenate([full.ravel(), np.array(joint, np.int64)]), return_inverse=True)
    full, joint = place[: full.size].reshape(-1, 2), place[full.size :]
    rise = np.array([rows[k]["upper"] - rows[k]["lower"] for k in numbers], float)
    amount = np.array([rows[k]["volume"] or rows[k]["area"] or 0.0 for k in numbers], float)
    wide = amount / max(amount.max(initial=0.0), 1e-300) + 1e-6
    steps = rise / max(rise.max(initial=0.0), 1e-300) + 1e-6
    routes, owner = route_arcs(full, steps / wide, joint[ends])
    own = [[rows[numbers[k]] for k in np.flatnonzero(owner == arc)] for arc in range(len(arcs))]
    walls = [sorted(set(itertools.chain.from_iterable(map(_walls, members)))) for members in own]
    starts = joint[ends[:, 0]]
    chains = [_follow(route, start, full, [rows[k]["nodes"] for k in numbers]) for route, start in zip(routes, starts)]
    spots, paths = _place(nodes, ends, [points[chain] for chain in chains])
    return EmbeddedGraph(nodes, ends, arcs, spots, paths, walls)


def _follow(route, start, ends, items):
    """Items along a route from a node through arcs, which it may follow downward."""
    at, chain = start, []
    for arc in route:
        rises = ends[arc, 0] == at
        chain += items[arc][:: 1 if rises else -1]
        at = ends[arc, 1 if rises else 0]
    return chain


def _place(nodes, ends, inside):
    """Spots of the nodes and paths of the arcs, given the points (k, 3) inside each arc."""
    spots = np.array([[node[axis] for axis in "xyz"] for node in nodes], float).reshape(-1, 3)
    degree = [np.bincount(ends[:, side], minlength=len(nodes)) for side in (1, 0)]  # arcs below, above
    in_material = any("region" in node for node in nodes)
    for (low, high), points in zip(ends.tolist(), inside if not in_material else ()):
        if len(points) and degree[1][low] == 1 and degree[0][low] > 0:
            spots[low] = points[0]
        if len(points) and degree[0][high] == 1 and degree[1][high] > 1:
            spots[high] = points[-1]
    paths = [np.vstack([spots[i : i + 1], points, spots[j : j + 1]]) for (i, j), points in zip(ends.tolist(), inside)]
    return spots, paths


def find_vertices(nodes):
    """Find the critical vertices of nodes.

    Parameters
    ----------
    nodes : list of dict
        Attributes as GraphML has them.

    Returns
    -------
    (K, 3) float64
        Model frame; where a node has none, the node itself.
    """
    places = [[node.get(f"vertex_{axis}", node[axis]) for axis in "xyz"] for node in nodes]
    return np.array(places, float).reshape(-1, 3)


def _take_graph(graph):
    """Nodes, ends (A, 2) and arcs of a graph, by the numbers of its arcs, the lower end first; without NaN."""
    place = {name: k for k, name in enumerate(graph.nodes)}
    nodes = [{"name": name} | {k: v for k, v in facts.items() if v == v} for name, facts in graph.nodes.items()]
    edges = sorted(graph.edges, key=lambda edge: edge[2]["arc"])
    ends = [sorted((place[a], place[b]), key=lambda k: (nodes[k]["height"], k)) for a, b, _ in edges]
    arcs = [
        {name: facts[name] for name in FIGURES if facts.get(name, np.nan) == facts.get(name)} for *_, facts in edges
    ]
    return nodes, np.array(ends, np.int64).reshape(-1, 2), arcs


def _walls(row):
    """Arcs of the surface around a row of the table `arcs`."""
    return [row["arc"]] if row["graph"] == "surface" else row["bounds"]
