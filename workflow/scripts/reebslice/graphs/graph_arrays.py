"""Reeb graphs as arrays: edge index and attributes, as libraries of learning on graphs take them."""

import numpy as np


def graph_arrays(graph, about):
    """Turn a graph into arrays by name.

    Parameters
    ----------
    graph : Graph
        N nodes with x, y, z and height, E edges with `arc`, `lower` and `upper`.
    about : dict
        Of the whole: words to str, int, float or lists of them.

    Returns
    -------
    dict of str to array
        `edge_index` (2, 2 E) int64, each edge upward and, E columns on, downward; `edge_attr` (2 E, F) float64 with
        the names of its columns in `edge_attr_names`; `pos` (N, 3) float64, model frame; `x` (N, D) float64 with
        `x_names`, words as one column per word that the field knows; `node`, names of the nodes; and `about`. What
        is unknown is NaN. Holds no objects, so that it is read without unpickling.
    """
    names, nodes = list(graph.nodes), list(graph.nodes.values())
    place = {name: k for k, name in enumerate(names)}
    height = [row["height"] for row in nodes]
    ends = [sorted((place[a], place[b]), key=lambda k: (height[k], k)) for a, b, _ in graph.edges]
    index = np.array(ends, np.int64).reshape(-1, 2).T
    columns, words = _number_columns([row for *_, row in graph.edges], ("id",))
    attributes = np.array(columns, np.float64).reshape(len(words), -1).T
    features, told = _number_columns(nodes, ("label", "change", "x", "y", "z"))
    return {
        "edge_index": np.concatenate([index, index[::-1]], axis=1),
        "edge_attr": np.concatenate([attributes, attributes]),
        "edge_attr_names": np.array(words, np.str_),
        "pos": np.array([[row[axis] for axis in "xyz"] for row in nodes], np.float64).reshape(-1, 3),
        "x": np.array(features, np.float64).reshape(len(told), -1).T,
        "x_names": np.array(told, np.str_),
        "node": np.array(names, np.str_),
        **{name: np.array(value) for name, value in about.items()},
    }


KNOWN = {"side": ("A", "B"), "operation": ("creation", "union", "separation", "annihilation")}


def _number_columns(rows, without):
    """Columns of numbers of some rows and their names; a word becomes a column for each one that is known."""
    columns, names = [], []
    for name in rows[0] if rows else ():
        values = [row[name] for row in rows]
        if name in KNOWN:
            columns += [[value == word for value in values] for word in KNOWN[name]]
            names += [f"{name}_{word}" for word in KNOWN[name]]
        elif name not in without:
            columns.append(values)
            names.append(name)
    return columns, names
