"""Distances between models by the Reeb graphs of functions themselves: by their persistence, and as labelled graphs.

Heights are left out, as they are others for a model that is turned, and what is smaller than a hundredth of the range
of a function is, too: it is noise, and it would be most of many graphs.
"""

from collections import Counter
from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from ..errors import ReebsliceError
from ..graphs.simplification import simplify_graph
from ..schemas import PAIRINGS

NODE_COLUMNS, ARC_COLUMNS = ("function", "value", "partner", "pairing"), ("function", "source", "target")
LEAST = 0.01  # of the range of a function
ITERATIONS = 3


def compare_diagrams(nodes: Sequence[Any]) -> np.ndarray:
    """Measure how far apart models are by the extended persistence of their functions.

    Parameters
    ----------
    nodes : list of pyarrow.Table, or of dict of str to array
        `function_nodes` of M models, or its columns, as :func:`.graph_function` gives them.

    Returns
    -------
    (M, M) float64
        Symmetric, 0 on the diagonal. The sum, over functions that all models have and over kinds of pairs, of the
        Wasserstein distances of order 1, in shares of the range of a function in its model.

    Raises
    ------
    ReebsliceError
        There is no function to compare by.

    Notes
    -----
    Pairs are matched with pairs of their own kind, or with the diagonal, at least cost (the assignment problem, by
    scipy). Of a pair with birth above death, as those of loops are, both are exchanged, which changes no distance.

    References
    ----------
    D. Cohen-Steiner, H. Edelsbrunner and J. Harer, Extending persistence using Poincare and Lefschetz duality,
    Foundations of Computational Mathematics 9 (2009), doi:10.1007/s10208-008-9027-z

    D. F. Crouse, On implementing 2D rectangular assignment algorithms, IEEE Transactions on Aerospace and Electronic
    Systems 52 (2016), doi:10.1109/TAES.2016.140952

    Examples
    --------
    >>> import reebslice
    >>> import trimesh
    >>> nodes = []
    >>> for radius in (1.0, 1.0, 2.0):  # of the tubes of three tori
    ...     torus = trimesh.creation.torus(4.0, radius)
    ...     values = reebslice.barycentric_distance(torus)
    ...     nodes.append(reebslice.graph_function("barycentre", values, torus.vertices, torus.faces)[0])
    >>> distances = compare_diagrams(nodes)
    >>> float(distances[0, 1]), bool(distances[0, 2] > 0)
    (0.0, True)
    """
    models = [{name: _list_pairs(rows) for name, rows in _by_function(table, NODE_COLUMNS).items()} for table in nodes]
    distances = np.zeros((len(models), len(models)))
    for name in _common_functions(models):
        for one, other in combinations(range(len(models)), 2):
            distances[one, other] += sum(map(_match, models[one][name], models[other][name]))
    return distances + distances.T


def compare_graphs(nodes: Sequence[Any], arcs: Sequence[Any]) -> np.ndarray:
    """Measure how far apart models are by the Reeb graphs of their functions as labelled graphs.

    Parameters
    ----------
    nodes, arcs : list of pyarrow.Table, or of dict of str to array
        `function_nodes` and `function_arcs` of M models, or their columns.

    Returns
    -------
    (M, M) float64
        Symmetric, 0 on the diagonal, at most the root of 2: between the unit vectors of how often each label of
        Weisfeiler and Lehman occurs, in any function that all models have. Models whose graphs are isomorphic are at
        distance 0; but some graphs that are not are as well.

    Raises
    ------
    ReebsliceError
        There is no function to compare by, or networkx is not installed.

    References
    ----------
    N. Shervashidze et al., Weisfeiler-Lehman graph kernels, Journal of Machine Learning Research 12 (2011)

    Examples
    --------
    >>> import reebslice
    >>> import trimesh
    >>> graphs = []
    >>> for mesh in (trimesh.creation.torus(4, 1), trimesh.creation.torus(9, 1), trimesh.creation.icosphere()):
    ...     values = reebslice.geodesic_distance(mesh)
    ...     graphs.append(reebslice.graph_function("geodesic", values, mesh.vertices, mesh.faces))
    >>> distances = compare_graphs(*zip(*graphs))
    >>> float(distances[0, 1]), bool(distances[0, 2] > 0)
    (0.0, True)
    """
    if len(nodes) != len(arcs):
        raise ReebsliceError(
            f"There are nodes of {len(nodes)} models and arcs of {len(arcs)}: give both of each model."
        )
    links = [_by_function(table, ARC_COLUMNS) for table in arcs]
    models = [
        {name: (rows, links[k][name]) for name, rows in _by_function(table, NODE_COLUMNS).items() if name in links[k]}
        for k, table in enumerate(nodes)
    ]
    names = _common_functions(models)
    counts: list[Counter] = [sum((_count_labels(name, *model[name]) for name in names), Counter()) for model in models]
    place = {label: k for k, label in enumerate(sorted(set().union(*counts)))}
    vectors = np.zeros((len(models), len(place)))
    for vector, count in zip(vectors, counts):
        vector[[place[label] for label in count]] = list(count.values())
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    distances = np.array([np.linalg.norm(vectors - vector, axis=1) for vector in vectors])
    return distances.reshape(len(models), len(models))


def share_functions(nodes):
    """Pick the models that have all those functions which at least half of them have, heights aside.

    Parameters
    ----------
    nodes : dict of str to pyarrow.Table
        `function_nodes` of each model.

    Returns
    -------
    models : list of str
    lacking : dict of str to list of str
        Of each of the others the functions that it lacks.
    """
    have = {model: set(_by_function(table, NODE_COLUMNS)) for model, table in nodes.items()}
    counts = Counter(name for names in have.values() for name in names)
    shared = {name for name, count in counts.items() if 2 * count >= len(nodes)}
    lacking = {model: sorted(shared - names) for model, names in have.items() if shared - names}
    return [model for model in nodes if model not in lacking], lacking


def _by_function(table, wanted):
    """The rows of each function, as columns, but for heights; wanted : names of columns."""
    try:
        columns = table if isinstance(table, dict) else dict(zip(table.column_names, table.itercolumns()))
        columns = {name: np.asarray(columns[name]) for name in wanted}
    except (AttributeError, KeyError):
        told = f"A {type(table).__name__} is given for a model"
        raise ReebsliceError(f"{told}: give a table or a dict with the columns {', '.join(wanted)}.") from None
    names = columns["function"]
    found = sorted(name for name in set(names) if not name.startswith("height:"))
    return {name: {key: column[names == name] for key, column in columns.items()} for name in found}


def _common_functions(models):
    """Functions that all models have, sorted."""
    names = sorted(set.intersection(*map(set, models))) if models else []
    if models and not names:
        raise ReebsliceError(
            "The models have no function in common but heights, which are others for a model that is turned: build the"
            " graphs of geodesic, barycentre or a file's values."
        )
    return names


def _list_pairs(rows):
    """Pairs of each kind, lesser value first, as shares of the range of the function: four (k, 2) arrays."""
    if not np.isfinite(np.ptp(rows["value"])):
        raise ReebsliceError("Values of a function are not finite, or too large to be subtracted: give others.")
    value, partner, low, span = rows["value"], rows["partner"], rows["value"].min(), np.ptp(rows["value"])
    first = np.arange(len(value)) < partner
    pairs = (np.column_stack([value, value[partner]])[first] - low) / (span or 1.0)
    kinds = rows["pairing"][first]
    large = pairs[:, 1] - pairs[:, 0] >= LEAST
    return [pairs[large & (kinds == kind)] for kind in PAIRINGS]


def _match(pairs, others):
    """Least cost of matching pairs (k, 2) with others (l, 2) or with the diagonal, in the maximum norm."""
    to_diagonal, of_others = ((each[:, 1] - each[:, 0]) / 2 for each in (pairs, others))
    apart = np.abs(pairs[:, None] - others).max(axis=2)
    # What is matched costs this much less than if both went to the diagonal.
    spared = to_diagonal[:, None] + of_others - apart
    matched = linear_sum_assignment(np.maximum(spared, 0), maximize=True)
    return to_diagonal.sum() + of_others.sum() - np.maximum(spared, 0)[matched].sum()


def _count_labels(name, rows, links):
    """How often each Weisfeiler-Lehman label occurs in the simplified graph of a function, by (function, label)."""
    try:
        import networkx as nx
    except ImportError:
        raise ReebsliceError("Distances of graphs take the package networkx: pip install networkx.") from None
    ends = np.column_stack([links["source"], links["target"]])
    size = LEAST * np.ptp(rows["value"])
    arcs = simplify_graph(rows["value"], ends.tolist(), np.zeros(len(ends)), size)[0].tolist()
    graph = nx.Graph()  # an arc is two nodes in a row, so that arcs beside each other and their direction are seen
    for number, (low, high) in enumerate(arcs):
        graph.add_node(("lower", number), kind="lower")
        graph.add_node(("upper", number), kind="upper")
        nx.add_path(graph, [low, ("lower", number), ("upper", number), high])
    for node in {node for arc in arcs for node in arc}:
        graph.nodes[node]["kind"] = "node"
    labels = nx.weisfeiler_lehman_subgraph_hashes(graph, node_attr="kind", iterations=ITERATIONS)
    return Counter((name, label) for found in labels.values() for label in found)
