"""Certificate of the Reeb graph of a function on the surface, counted again from the mesh and the values.

The order of vertices, their indices, shells, Euler characteristics, the pairs of components, and every arc, by a sweep
that keeps the contours of a moving level. Where all that agrees, the graph is the Reeb graph of the function.
"""

from collections import Counter

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components

from .ledger import Ledger
from .recount.elders import elder_pairs
from .recount.graph_pairs import graph_pairs
from .recount.surface import copies, find_mesh_edges, part_copies, sort_corners
from .recount.sweep import sweep_surface

DEGREES = {0: ((0, 1),), 1: ((1, 2), (2, 1)), 2: ((1, 0),)}  # arcs below and above, by index


def certify_function(points, faces, values, nodes, arcs):
    """Certify the Reeb graph of a function.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
        The cleaned surface.
    values : (n,) float64
    nodes, arcs : dict of str to (K,) or (A,) array
        Columns of the tables `function_nodes` and `function_arcs`, the rows of this function.

    Returns
    -------
    dict
        `verdict`: `exact`, or `uncertified`, where a check fails. `components`, `loops`, `genus`,
        `euler_characteristic`, `minima`, `saddles`, `maxima`, and `checks`.
    """
    ledger = Ledger()
    order = np.lexsort((points[:, 1], points[:, 0], points[:, 2], values))
    order = part_copies(order, (values, *points.T), faces.T)
    rank = np.empty(len(points), np.int32)
    rank[order] = np.arange(len(points), dtype=np.int32)
    surface = sort_corners(points[order], order, rank, faces.T, np.zeros(len(faces), np.int32))
    sides = find_mesh_edges(surface)
    if sides is None:
        raise ValueError("the surface is not closed")
    ledger.rows("nodes.value", nodes["value"] == values[nodes["vertex"]], "the value at the vertex")
    named = nodes | {"at": rank[nodes["vertex"]]}
    swept = sweep_surface(surface, sides)[0]
    facts = check_surface_graph(ledger, surface, sides, named, arcs, swept)
    verdict = "exact" if ledger.holds() else "uncertified"
    counts = np.bincount(nodes["index"], minlength=3).tolist()
    return {"verdict": verdict, **facts, **dict(zip(("minima", "saddles", "maxima"), counts)), "checks": ledger.checks}


def check_surface_graph(ledger, surface, sides, nodes, arcs, swept):
    """Check the Reeb graph of a function against the surface.

    Parameters
    ----------
    ledger : Ledger
    surface, sides : Ranked, MeshEdges
        In the order of the function.
    nodes : dict of str to (K,) array
        `at`, the ranks of their vertices in `surface`; `value`, `index`, `partner`.
    arcs : dict of str to (A,) array
        `source`, `target`, `lower`, `upper`.
    swept : Arcs
        Of the sweep.

    Returns
    -------
    dict
        `components`, `loops`, `genus`, `euler_characteristic`.
    """
    at, ends = nodes["at"], np.column_stack([arcs["source"], arcs["target"]]).astype(np.int64)
    ledger.rows("nodes.order", np.diff(at) >= 0, "not below the node before")
    ledger.rows("arcs.monotone", ends[:, 0] < ends[:, 1], "from the lower to the upper node")
    for side, name in enumerate(("lower", "upper")):
        ledger.rows(f"arcs.{name}", arcs[name] == nodes["value"][ends[:, side]], "the value at that end")
    _check_critical(ledger, surface, at, nodes)
    degrees = [np.bincount(ends[:, side], minlength=len(at)).tolist() for side in (1, 0)]
    told = [pair in DEGREES.get(kind, ()) for pair, kind in zip(zip(*degrees), nodes["index"].tolist())]
    ledger.rows("nodes.degrees", told, "one arc at an extremum, three at a saddle, not all on one side")
    facts = _check_shells(ledger, surface, sides, (at, ends))
    _check_pairs(ledger, sides, len(surface.points), (at, ends), nodes["partner"])
    apart = at[ends[:, 0]] < at[ends[:, 1]]  # not between copies of a multiple saddle
    found, expected = Counter(zip(*at[ends[apart]].T.tolist())), Counter(zip(swept.low.tolist(), swept.high.tolist()))
    says = "" if found == expected else "The sweep over the surface finds other arcs than the graph has."
    ledger.enter("arcs.swept", found.total(), expected.total(), found == expected, says)
    return facts


def _check_critical(ledger, surface, at, nodes):
    """Whether the nodes are the critical points, a multiple saddle as often as it counts."""
    critical = np.flatnonzero(surface.index >= 0)
    keys = zip(critical.tolist(), surface.index[critical].tolist())
    expected = Counter(dict(zip(keys, copies(surface)[critical].tolist())))
    found = Counter(zip(at.tolist(), nodes["index"].tolist()))
    says = "" if found == expected else "Nodes are not the critical points of the function."
    ledger.enter("nodes.critical", found.total(), expected.total(), found == expected, says)


def _components(one, other, count):
    links = sparse.coo_array((np.ones(len(one), bool), (one, other)), shape=(count, count))
    return connected_components(links, directed=False)


def _check_shells(ledger, surface, sides, graph):
    """Components, loops against genus, and Euler characteristic of each shell; returns the sums."""
    at, ends = graph
    n_shells, shell = _components(sides.lower, sides.upper, len(surface.points))
    chi = np.bincount(shell, minlength=n_shells) - np.bincount(shell[sides.lower], minlength=n_shells)
    chi = chi + np.bincount(shell[surface.corners[:, 0]], minlength=n_shells)
    by_index = np.bincount(shell, weights=1 - surface.changes // 2, minlength=n_shells)
    n_parts = _components(*ends.T, len(at))[0]
    ledger.enter("graph.components", n_parts, n_shells)
    ledger.rows("arcs.shell", shell[at[ends[:, 0]]] == shell[at[ends[:, 1]]], "both ends on one shell")
    loops = np.bincount(shell[at[ends[:, 0]]], minlength=n_shells) - np.bincount(shell[at], minlength=n_shells) + 1
    ledger.rows("graph.loops", 2 - 2 * loops == chi, "as many loops as the genus of each shell")
    ledger.rows("surface.euler", by_index == chi, "minima - saddles + maxima of each shell")
    return {
        "components": n_parts,
        "loops": len(ends) - len(at) + n_parts,
        "genus": int((2 - chi).sum()) // 2,
        "euler_characteristic": int(chi.sum()),
    }


def _check_pairs(ledger, sides, count, graph, partner):
    """Pairs of components by the elder rule, of the mesh and of the graph, and the partners of all nodes."""
    at, ends = graph
    minima, maxima, loops = graph_pairs(len(at), ends)
    low, high, last = sides.lower, sides.upper, count - 1
    of_mesh = elder_pairs(low, high, count, 0), last - elder_pairs(last - high, last - low, count, 0)
    of_graph = ([(at[a], at[b]) for a, b in minima], [(at[b], at[a]) for a, b in maxima])
    for name, mesh, graph in zip(("sublevels", "superlevels"), of_mesh, of_graph):
        found = Counter((int(a), int(b)) for a, b in graph)
        expected = Counter(map(tuple, mesh.tolist()))
        says = "" if found == expected else "Components unite in the graph otherwise than on the surface."
        ledger.enter(f"pairs.{name}", found.total(), expected.total(), found == expected, says)
    expected = np.full(len(at), -1)
    for a, b in (*minima, *maxima, *loops):
        expected[a], expected[b] = b, a
    rest = np.flatnonzero(expected < 0)  # lowest and highest point of each component
    label = _components(*ends.T, len(at))[1][rest]
    rest = rest[np.argsort(label, kind="stable")]
    first, last = (np.unique(np.sort(label)[::step], return_index=True)[1] for step in (1, -1))
    low, high = rest[first], rest[::-1][last]
    expected[high], expected[low] = low, high
    ledger.rows("nodes.partner", partner == expected, "its partner by extended persistence")
