"""Certificate of the Reeb graph of a function on the surface, counted again from the mesh and the values.

The order of vertices, their indices, shells, Euler characteristics, the pairs of components, and, at the fewest levels
that cross all arcs, the pieces of surface and how contours link them. Where all that agrees, the graph is the Reeb
graph of the function: between such levels every piece of the surface has one critical point at most, so its own graph
is an end, a fork or a plain arc, and these are glued along the same contours as those of the graph.
"""

from collections import Counter

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.csgraph import connected_components

from .ledger import Ledger
from .recount.cut_graphs import count_crossings, cut_graph, cut_surface, pierce_arcs
from .recount.elders import elder_pairs
from .recount.graph_pairs import graph_pairs

MOST_CROSSINGS = 20_000_000
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
        `verdict`: `exact`; `consistent`, where the levels would cross the surface too often and only sums and pairs
        were compared; `uncertified`, where a check fails. `components`, `loops`, `genus`, `euler_characteristic`,
        `minima`, `saddles`, `maxima`, and `checks`.
    """
    ledger = Ledger()
    rank = np.empty(len(points), np.int64)
    rank[np.lexsort((points[:, 1], points[:, 0], points[:, 2], values))] = np.arange(len(points))
    ordered = np.sort(rank[faces], axis=1)
    at = rank[nodes["vertex"]]
    ends = np.column_stack([arcs["source"], arcs["target"]]).astype(np.int64)
    ledger.rows("nodes.value", nodes["value"] == values[nodes["vertex"]], "the value at the vertex")
    ledger.rows("nodes.order", np.diff(at) >= 0, "not below the node before")
    ledger.rows("arcs.monotone", ends[:, 0] < ends[:, 1], "from the lower to the upper node")
    for side, name in enumerate(("lower", "upper")):
        ledger.rows(f"arcs.{name}", arcs[name] == nodes["value"][ends[:, side]], "the value at that end")
    index = _count_indices(ordered, len(points))
    _check_critical(ledger, index, ordered, at, nodes)
    degrees = [np.bincount(ends[:, side], minlength=len(at)).tolist() for side in (1, 0)]
    told = [pair in DEGREES.get(kind, ()) for pair, kind in zip(zip(*degrees), nodes["index"].tolist())]
    ledger.rows("nodes.degrees", told, "one arc at an extremum, three at a saddle, not all on one side")
    links = _link_faces(ordered)
    facts = _check_shells(ledger, ordered, index, links, (at, ends))
    _check_pairs(ledger, links, at, ends, nodes["partner"])
    complete = _check_pieces(ledger, ordered, links, at, ends)
    verdict = ("exact" if complete else "consistent") if ledger.holds() else "uncertified"
    counts = np.bincount(nodes["index"], minlength=3).tolist()
    return {"verdict": verdict, **facts, **dict(zip(("minima", "saddles", "maxima"), counts)), "checks": ledger.checks}


def _count_indices(ordered, count):
    """Index (n,) of every vertex: 1 - (faces in which it is the middle one) / 2."""
    return 1 - np.bincount(ordered[:, 1], minlength=count) // 2


def _check_critical(ledger, index, ordered, at, nodes):
    """Whether the nodes are the critical points, a multiple saddle as often as it counts."""
    is_top = np.zeros(len(index), bool)
    is_top[ordered[:, 2]] = True
    low = np.zeros(len(index), bool)
    low[ordered[:, 0]] = True
    expected = Counter()
    for v in np.flatnonzero(index != 0).tolist():
        expected[v, 1 if index[v] < 0 else 0 if low[v] else 2] = max(-int(index[v]), 1)
    found = Counter(zip(at.tolist(), nodes["index"].tolist()))
    says = "" if found == expected else "Nodes are not the critical points of the function."
    ledger.enter("nodes.critical", found.total(), expected.total(), found == expected, says)


def _link_faces(ordered):
    """Lower and upper rank of every mesh edge, and its two faces, (e, 4), in order of the ranks."""
    sides = np.concatenate([ordered[:, [0, 1]], ordered[:, [1, 2]], ordered[:, [0, 2]]])
    face = np.tile(np.arange(len(ordered)), 3)
    order = np.lexsort((face, sides[:, 1], sides[:, 0]))
    pairs = sides[order].reshape(-1, 2, 2)
    if (pairs[:, 0] != pairs[:, 1]).any():
        raise ValueError("the surface is not closed")
    return np.column_stack([pairs[:, 0], face[order].reshape(-1, 2)])


def _components(one, other, count):
    links = sparse.coo_array((np.ones(len(one), bool), (one, other)), shape=(count, count))
    return connected_components(links, directed=False)


def _check_shells(ledger, ordered, index, links, graph):
    """Components, loops against genus, and Euler characteristic of each shell; returns the sums."""
    at, ends = graph
    n_shells, shell = _components(links[:, 0], links[:, 1], len(index))
    chi = np.bincount(shell, minlength=n_shells) - np.bincount(shell[links[:, 0]], minlength=n_shells)
    chi = chi + np.bincount(shell[ordered[:, 0]], minlength=n_shells)
    by_index = np.bincount(shell, weights=index, minlength=n_shells)
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


def _check_pairs(ledger, links, at, ends, partner):
    """Pairs of components by the elder rule, of the mesh and of the graph, and the partners of all nodes."""
    count = len(np.unique(links[:, :2]))
    minima, maxima, loops = graph_pairs(len(at), ends)
    low, high = links[:, 0], links[:, 1]
    last = count - 1
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
    rest = expected < 0  # lowest and highest point of each component
    label = _components(*ends.T, len(at))[1]
    for k in np.flatnonzero(rest).tolist():
        others = np.flatnonzero(rest & (label == label[k]))
        expected[k] = others[0] + others[-1] - k
    ledger.rows("nodes.partner", partner == expected, "its partner by extended persistence")


def _check_pieces(ledger, ordered, links, at, ends):
    """Pieces between the levels that cross all arcs; returns whether they were looked at."""
    low, high = at[ends[:, 0]], at[ends[:, 1]]
    apart = low < high  # not between copies of a multiple saddle, which no level parts
    levels = pierce_arcs(low[apart], high[apart])
    if count_crossings(ordered[:, 0], ordered[:, 2], levels).sum() > MOST_CROSSINGS:
        return False
    found, expected = cut_graph(at, ends, levels), cut_surface(ordered, links, at, levels)
    says = "" if found == expected else "Contours of the surface are linked otherwise than the arcs of the graph."
    ledger.enter("pieces.linked", found.total(), expected.total(), found == expected, says)
    return True
