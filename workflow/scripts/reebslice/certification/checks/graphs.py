"""Checks of the three graphs as labelled multigraphs, and of the identities of the whole.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

from collections import Counter

import numpy as np

from ...schemas import EVENTS
from ..recount.graphs import count_loops, find_augmented_edges

SOLID_COLUMNS = ("arc", "lower", "upper", "length", "volume", "similarity_min")
SURFACE_COLUMNS = ("arc", "lower", "upper", "length", "area")
HANDLE_COLUMNS = ("handle", "x", "y", "z", "height", "index", "side", "operation", "change", "branches")
NODE_COLUMNS = ("node", "level", "region", "x", "y", "z", "height", "critical", "area", "inscribed_radius", "n_holes")


def check_graphs(facts, ledger):
    """The three graphs as labelled multigraphs, with their attributes."""
    for graph, prefix, columns in (("solid", "s", SOLID_COLUMNS), ("surface", "c", SURFACE_COLUMNS)):
        parts, found = facts.parts[graph], facts.graphs[graph]
        joints = sorted(h for members in parts.joints for h in members)
        ledger.enter(f"{graph}.nodes", sorted(found.nodes) == sorted(f"h{h}" for h in joints), True)
        _check_attributes(facts, ledger, graph, found)
        if graph not in facts.arcs:
            ledger.enter(f"{graph}.edges", False, True, says="Its arcs differ from those of the mesh.")
            continue
        expected = {
            f"{prefix}{facts.columns.arcs['arc'][row]}": (sorted((f"h{key[0]}", f"h{key[1]}")), row, key)
            for row, key in facts.arcs[graph].items()
        }
        stated = {str(key): (sorted((a, b)), data) for a, b, key, data in found.edges}
        ledger.enter(f"{graph}.number_of_edges", len(found.edges), len(expected))
        ledger.enter(f"{graph}.edges", stated.keys() == expected.keys(), True)
        common = sorted(stated.keys() & expected.keys())
        ledger.rows(f"{graph}.ends", [stated[k][0] == expected[k][0] for k in common], "the two events of the arc")
        same = [_same_edge(facts, k, stated[k][1], expected[k][1], expected[k][2], columns) for k in common]
        ledger.rows(f"{graph}.edge_attributes", same, "the columns of the arc")
        if graph == "surface":
            inner = facts.columns.contours["inner"]
            signs = [
                bool(stated[k][1].get("inner")) == bool(expected[k][2][2] and inner[expected[k][2][2][0]])
                for k in common
            ]
            ledger.rows("surface.inner", signs, "whether the arc's contours are holes")
    _check_augmented(facts, ledger)
    _count_loops(facts, ledger)


def _same_edge(facts, name, data, row, key, columns):
    """Whether an edge of a graph has what the columns of its arc say."""
    arcs = facts.columns.arcs
    same = all(_same(data.get(c), arcs[c][row]) for c in columns)
    return same and data.get("id") == name and data.get("n_nodes") == len(key[2])


def _rows(table, columns):
    """The rows of some columns of a table as tuples of plain values."""
    return zip(*(list(table[c]) if isinstance(table[c], list) else table[c].tolist() for c in columns))


def _same(found, expected):
    """Equal as GraphML tells it: an absent number is left out, an absent word is ""."""
    if found == expected:
        return True
    if expected is None:
        return found is None or found == ""
    if isinstance(expected, (float, np.floating)):
        return isinstance(found, (int, float)) and abs(found - expected) <= 1e-12 * abs(expected)
    return found == expected


def _check_attributes(facts, ledger, graph, found):
    """Node attributes of a graph against the tables handles and nodes."""
    expected = {f"h{row[0]}": (HANDLE_COLUMNS, row) for row in _rows(facts.columns.handles, HANDLE_COLUMNS)}
    if graph == "augmented":
        expected |= {f"n{row[0]}": (NODE_COLUMNS, row) for row in _rows(facts.columns.nodes, NODE_COLUMNS)}
    agree = []
    for name, data in found.nodes.items():
        columns, row = expected.get(name, ((), ()))
        agree.append(bool(row) and all(map(_same, map(data.get, columns), row)))
    ledger.rows(f"{graph}.node_attributes", agree, "the columns of the handle or node")
    standing = _count_handles(facts, graph)
    held = [data.get("n_handles") == standing.get(str(name)) for name, data in found.nodes.items()]
    ledger.rows(f"{graph}.n_handles", held, "itself and the handles of its part that are no nodes")


def _count_handles(facts, graph):
    """The number of handles that each node of a graph stands for: {name of node: number}."""
    part = facts.columns.handles["piece" if graph == "surface" else "block"].tolist()
    joints = {h for members in facts.parts["surface" if graph == "surface" else "solid"].joints for h in members}
    others = Counter(place for handle, place in enumerate(part) if handle not in joints)
    return {f"h{handle}": 1 + others[part[handle]] for handle in joints}


def _check_augmented(facts, ledger):
    """The graph of all material points: its nodes, edges and attributes."""
    found, parts = facts.graphs["augmented"], facts.parts["solid"]
    joints = sorted(h for members in parts.joints for h in members)
    names = [f"h{h}" for h in joints] + [f"n{n}" for n in facts.columns.nodes["node"].tolist()]
    ledger.enter("augmented.nodes", sorted(found.nodes) == sorted(names), True)
    expected = find_augmented_edges(parts, facts.columns.handles["operation"])
    stated = sorted((*sorted((a, b)), data.get("operation")) for a, b, _, data in found.edges)
    ledger.enter(
        "augmented.edges",
        len(stated),
        len(expected),
        stated == expected,
        "" if stated == expected else "Ends or operations differ.",
    )
    kinds = [data.get("kind") == {"h": "handle", "n": "point"}.get(str(name)[:1]) for name, data in found.nodes.items()]
    ledger.rows("augmented.kind", kinds, "handle or point")
    _check_attributes(facts, ledger, "augmented", found)
    edges = facts.columns.edges
    pairs = dict(zip(zip(edges["source"].tolist(), edges["target"].tolist()), edges["similarity"].tolist()))
    agree = []
    for a, b, key, data in found.edges:
        handles = {int(end[1:]) for end in (a, b) if str(end).startswith("h")}
        named = data.get("id") == key
        if handles:
            agree.append(named and data.get("handle") in handles)
        else:
            low, high = sorted((int(a[1:]), int(b[1:])), key=lambda n: facts.columns.nodes["level"][n])
            agree.append(named and _same(data.get("similarity"), pairs.get((low, high))))
    ledger.rows("augmented.edge_attributes", agree, "the handle, or the similarity of the edge")


def _count_loops(facts, ledger):
    """Loops of the recounted graphs, per component, and of the graphs as they are read."""
    for graph, groups in (("solid", facts.body), ("surface", np.arange(facts.n_shells))):
        parts = facts.parts[graph]
        joints = sorted(h for members in parts.joints for h in members)
        place = {h: k for k, h in enumerate(joints)}
        names = {f"h{h}": k for h, k in place.items()}
        pairs = [(names[a], names[b]) for a, b, *_ in facts.graphs[graph].edges if a in names and b in names]
        loops, part = count_loops(len(joints), pairs)
        setattr(facts, f"loops_{graph}", int(loops))
        shell = facts.shell_of_vertex[facts.columns.handles["vertex"][joints]]
        group = groups[shell]
        together = len(np.unique(np.stack([part, group]), axis=1).T)
        wanted = len(np.unique(groups))
        ledger.enter(f"{graph}.components", [int(part.max(initial=-1)) + 1, together], [wanted, wanted])
        ends = np.array(pairs, np.int64).reshape(-1, 2)
        degree = np.bincount(group[ends[:, 0]], minlength=facts.n_shells) - np.bincount(group, minlength=facts.n_shells)
        facts.loops_of_shell = np.where(np.bincount(group, minlength=facts.n_shells) > 0, degree + 1, 0)


def check_identities(facts, ledger):
    """What theory says of any closed surface and the solid that it bounds."""
    t = facts.columns.handles
    shell = facts.shell_of_vertex[t["vertex"]]
    sign = np.where(t["index"] == 1, -1, 1)
    ledger.enter("euler_characteristic = #0 - #1 + #2", int(sign.sum()), facts.euler)
    per_shell = np.bincount(shell, sign, facts.n_shells).astype(int)
    ledger.rows("euler_characteristic of each shell", per_shell == facts.shell_euler, "#0 - #1 + #2 over its handles")
    pieces = np.bincount(facts.piece_shell, facts.piece_euler, facts.n_shells).astype(int)
    ledger.rows("euler_characteristic of the pieces of each shell", pieces == facts.shell_euler, "sum over its pieces")
    total = [int(sign[t["side"] == side].sum()) for side in "AB"]
    ledger.enter("sums over sides A and B = euler_characteristic / 2", [2 * s for s in total], [facts.euler] * 2)
    b0, b1, b2 = facts.betti
    ledger.enter("2 (b0 - b1 + b2) = euler_characteristic", 2 * (b0 - b1 + b2), facts.euler)
    hidden = np.bincount(facts.piece_shell, facts.piece_genus, facts.n_shells).astype(int)
    genus = facts.loops_of_shell + hidden
    ledger.rows("genus of each shell = loops + hidden genus", genus == facts.shell_genus, "genus of the mesh")
    facts.suppressed = facts.genus - facts.loops_surface - facts.hidden
    ledger.enter("genus = loops + suppressed + hidden", facts.loops_surface + facts.hidden, facts.genus)
    ledger.enter("loops_solid <= b1", facts.loops_solid, f"at most {b1}", facts.loops_solid <= b1)
    ledger.enter("shells = b0 + b2", facts.n_shells, b0 + b2)
    _check_region_counts(facts, ledger, t)
    ledger.close(
        "flux of the pieces = volume", float(facts.columns.pieces["flux"].sum()), facts.volume, 100 * facts.volume_noise
    )
    ledger.close(
        "area of the pieces = area", float(facts.columns.pieces["area"].sum()), facts.area, 100 * facts.area_noise
    )


def _check_region_counts(facts, ledger, t):
    """Regions at a level: the sum over the events below of how they change their number."""
    n = len(facts.levels["height"])
    gain = np.zeros(n + 1, np.int64)
    for slab, change in zip(t["slab"].tolist(), t["change"]):
        if change is not None:
            gain[slab + 1] += EVENTS[change][4]
    for piece in np.flatnonzero(~facts.elementary).tolist():
        ends = facts.change[piece].split("->")
        gain[facts.slab[piece] + 1] += ends[1].count("o") - ends[0].count("o")
    ledger.rows(
        "regions at each level = sum of R below",
        facts.columns.levels["n_regions"] == np.cumsum(gain)[:n],
        "events below the level",
    )
    ledger.enter("sum of R over all events", int(gain.sum()), 0)
