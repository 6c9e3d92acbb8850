"""Reeb graphs of functions on the surface as tables and as GraphML."""

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from ..formats.graphml import Graph
from ..morse.critical_points import morse_indices
from ..morse.persistence import pair_kinds
from ..morse.reeb_graph import surface_reeb_graph
from ..morse.value_mesh import value_mesh
from ..schemas import SCHEMAS
from ..table_checks import build_table


def graph_function(name: str, values: ArrayLike, points: ArrayLike, faces: ArrayLike) -> tuple[dict, dict]:
    """Build the Reeb graph of a function.

    Parameters
    ----------
    name : str
        Of the function.
    values : (n,) float64
    points, faces : (n, 3) float64 and (m, 3) int
        The cleaned surface.

    Returns
    -------
    nodes, arcs : dict of str to array or list
        Columns of `function_nodes` and `function_arcs`.

    Raises
    ------
    ReebsliceError
        Values are not finite.

    Examples
    --------
    >>> import trimesh
    >>> torus = trimesh.creation.torus(4.0, 1.0)
    >>> nodes, arcs = graph_function("x", torus.vertices[:, 0], torus.vertices, torus.faces)
    >>> nodes["index"].tolist(), nodes["pairing"], len(arcs["arc"])
    ([0, 1, 1, 2], ['extended', 'loop', 'loop', 'extended'], 4)
    """
    points = np.asarray(points, np.float64)
    mesh = value_mesh(values, points, faces)
    graph = surface_reeb_graph(mesh)
    value, index = mesh.points[graph.nodes, 2], morse_indices(mesh, graph.nodes)
    x, y, z = points[mesh.vertex[graph.nodes]].T
    nodes = {
        "function": [name] * len(graph.nodes),
        "node": np.arange(len(graph.nodes)),
        "vertex": mesh.vertex[graph.nodes],
        "rank": graph.nodes,
        "value": value,
        "index": index,
        "partner": graph.partner,
        "pairing": pair_kinds(index, graph.partner),
        "persistence": np.abs(value - value[graph.partner]),
        "x": x,
        "y": y,
        "z": z,
    }
    arcs = {
        "function": [name] * len(graph.arcs),
        "arc": np.arange(len(graph.arcs)),
        **dict(zip(("source", "target"), graph.arcs.T)),
        **dict(zip(("lower", "upper"), value[graph.arcs].T)),
    }
    return nodes, arcs


def stack_tables(name, parts):
    """Put columns of several functions together, in their order.

    Parameters
    ----------
    name : str
        Of the table.
    parts : list of dict of str to array or list

    Returns
    -------
    pyarrow.Table
    """
    return pa.concat_tables([SCHEMAS[name].empty_table(), *(build_table(name, part) for part in parts)])


def merge_graphs(nodes, arcs):
    """Put the graphs of all functions beside each other in one.

    Parameters
    ----------
    nodes, arcs : pyarrow.Table
        `function_nodes` and `function_arcs`.

    Returns
    -------
    Graph
        Node `geodesic:7` is node 7 of the function geodesic, edge `geodesic:e7` its arc 7. Both have the attribute
        `function`.
    """
    names = {f"{row['function']}:{row['node']}": row for row in nodes.to_pylist()}
    edges = [
        (
            f"{row['function']}:{row['source']}",
            f"{row['function']}:{row['target']}",
            {"id": f"{row['function']}:e{row['arc']}"} | {k: row[k] for k in ("function", "lower", "upper")},
        )
        for row in arcs.to_pylist()
    ]
    return Graph(names, edges)
