"""Checks of the graphs as labelled multigraphs, and of the identities of the whole.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

from collections import Counter

import numpy as np

from ...schemas import EVENTS, GRAPHS
from ..recount.graphs import count_loops, find_augmented_edges

SOLID_COLUMNS = ("arc", "lower", "upper", "length", "volume", "similarity_min")
SURFACE_COLUMNS = ("arc", "lower", "upper", "length", "area")
VOID_COLUMNS = ("arc", "lower", "upper", "length", "volume")
POSITION = ("x", "y", "z", "height")
VERTEX = ("vertex_x", "vertex_y", "vertex_z")
HANDLE_COLUMNS = ("handle", *POSITION, "index", "side", "operation", "change", "branches")
NODE_COLUMNS = ("node", "level", "region", "x", "y", "z", "height", "critical", "area", "inscribed_radius", "n_holes")


def check_graphs(facts, ledger):
    """The graphs as labelled multigraphs, with their attributes; that of the void is empty where it is not told."""
    _check_descriptions(facts, ledger)
    graphs = {"solid": ("s", SOLID_COLUMNS), "surface": ("c", SURFACE_COLUMNS), "void": ("v", VOID_COLUMNS)}
    for graph, (prefix, columns) in graphs.items():
        if graph not in facts.parts:
            ledger.enter("void.nodes and edges", [len(part) for part in facts.graphs["void"][:2]], [0, 0])
            continue
        _check_nodes(facts, ledger, graph)
        if graph not in facts.arcs:
            ledger.enter(f"{graph}.edges", False, True, says="Its arcs differ from those of the mesh.")
            continue
        arcs, inner, expected = _rows(facts.columns.arcs, columns), facts.columns.contours["inner"], {}
        for row, (source, target, _) in facts.arcs[graph].items():
            name, items = f"{prefix}{arcs[row]['arc']}", facts.columns.arcs["nodes"][row]
            data = arcs[row] | {"id": name, "n_nodes": len(items)}
            data |= {"inner": bool(items and inner[items[0]])} if graph == "surface" else {}
            data |= {"outside": not items} if graph == "void" else {}
            expected[name] = sorted((_name_node(source), _name_node(target))), data
        stated = {str(key): (sorted((a, b)), data) for a, b, key, data in facts.graphs[graph].edges}
        ledger.enter(f"{graph}.number_of_edges", len(facts.graphs[graph].edges), len(expected))
        ledger.enter(f"{graph}.edges", stated.keys() == expected.keys(), True)
        both = [(stated[key], expected[key]) for key in sorted(stated.keys() & expected.keys())]
        ledger.rows(f"{graph}.ends", [one[0] == other[0] for one, other in both], "the two events of the arc")
        same = [_hold(one[1], other[1]) for one, other in both]
        ledger.rows(f"{graph}.edge_attributes", same, "the columns of the arc, and what its contours are")
    _check_augmented(facts, ledger)
    _count_loops(facts, ledger)


def _name_node(number):
    """The name of the node of a handle, or of where the outside goes on below all, -1, and above all, -2."""
    return f"h{number}" if number >= 0 else f"b{-1 - number}"


def _check_descriptions(facts, ledger):
    """What the graphs tell of themselves: one model, the direction of tilt.json, the unit of inspection.json."""
    about = [facts.graphs[name].about for name in GRAPHS]
    told = {f"direction_{axis}": part for axis, part in zip("xyz", facts.tilt["direction"])}
    told |= {"model": about[0].get("model") if facts.model is None else facts.model}
    told |= {"unit": facts.inspection["unit"] or ""} if "unit" in facts.inspection else {}
    same = [_hold(own, told | {"graph": name}) for name, own in zip(GRAPHS, about)]
    ledger.rows("graphs.descriptions", same, "its name, and the model, direction and unit of all")


def _rows(table, columns):
    """The rows of some columns of a table, as dicts of plain values."""
    return [dict(zip(columns, row)) for row in zip(*(table[column].tolist() for column in columns))]


def _hold(data, expected):
    """Whether attributes are as expected, as GraphML has them: what is absent is "", -1 or NaN, and never left out."""
    return all(name in data and _same(data[name], value) for name, value in expected.items())


def _same(found, expected):
    """Whether an attribute is as expected; floats but for their last digits."""
    if expected is None or expected != expected:
        return found in ("", -1) or found != found
    if isinstance(expected, float):
        return isinstance(found, (int, float)) and abs(found - expected) <= 1e-12 * abs(expected)
    return found == expected


def _check_nodes(facts, ledger, graph):
    """The nodes of a graph and their attributes, against the tables handles and nodes."""
    handles = _rows(facts.columns.handles, HANDLE_COLUMNS)
    counts = _count_handles(facts, {"augmented": "solid"}.get(graph, graph))
    words = {h: {"label": f"h{h} {data['operation']} {data['side']}"} for h, data in enumerate(handles)}
    expected = {f"h{h}": handles[h] | words[h] | {"n_handles": count} for h, count in counts.items() if h >= 0}
    if graph in ("solid", "augmented"):
        expected = {name: data | _place(facts, data) for name, data in expected.items()}
    if graph == "void":
        expected = {name: data | {"branches": True} for name, data in expected.items()}
        for number, end, side in (
            (-1, handles[0], "below"),
            (-2, handles[-1], "above"),
        ):  # at the lowest, highest vertex
            place = {name: end[name] if name in POSITION else None for name in HANDLE_COLUMNS}
            own = {"label": f"outside, {side} all", "handle": number, "branches": False, "n_handles": 0}
            expected[_name_node(number)] = place | own
    if graph == "augmented":
        expected = _add_points(facts, expected)
    stated = facts.graphs[graph].nodes
    ledger.enter(f"{graph}.nodes", sorted(stated) == sorted(expected), True)
    same = [name in expected and _hold(data, expected[name]) for name, data in stated.items()]
    ledger.rows(f"{graph}.node_attributes", same, "the columns of the handle or node, and how many handles it counts")


def _place(facts, handle):
    """Where the node of a handle lies in the solid's graph, and its vertex; handle : a row of `handles`."""
    region = int(facts.spot_region[handle["handle"]])
    place = dict(zip("xyz", facts.spots[handle["handle"]].tolist())) | dict(zip(VERTEX, (handle[k] for k in "xyz")))
    return place | {"region": region if region >= 0 else None}


def _add_points(facts, handles):
    """The attributes of the nodes of the augmented graph, given those of handles."""
    own = dict.fromkeys(NODE_COLUMNS) | {"kind": "handle", "critical": True}
    expected = {name: own | data for name, data in handles.items()}
    own = dict.fromkeys((*HANDLE_COLUMNS, *VERTEX)) | {"kind": "point", "branches": False, "n_handles": 0}
    points = enumerate(_rows(facts.columns.nodes, NODE_COLUMNS))
    return expected | {f"n{node}": own | data | {"label": f"n{node}"} for node, data in points}


def _count_handles(facts, graph):
    """How many handles each node of a graph counts: itself, and those of its part that are no nodes; {joint: count}.

    In the void's graph these are the ones that change the void.
    """
    joints = [h for members in facts.parts[graph].joints for h in members]
    if graph == "void":
        return {h: len(held) for members, held in zip(facts.parts[graph].joints, facts.void_events) for h in members}
    part = facts.columns.handles["piece" if graph == "surface" else "block"].tolist()
    others = Counter(part) - Counter(part[h] for h in joints)
    return {h: 1 + others[part[h]] for h in joints}


def _check_augmented(facts, ledger):
    """The graph of all material points: its nodes, edges and attributes."""
    _check_nodes(facts, ledger, "augmented")
    found, edges = facts.graphs["augmented"], facts.columns.edges
    expected = find_augmented_edges(facts.parts["solid"], facts.columns.handles["operation"])
    stated = sorted((*sorted((a, b)), data.get("operation")) for a, b, _, data in found.edges)
    says = "" if stated == expected else "Ends or operations differ."
    ledger.enter("augmented.edges", len(stated), len(expected), stated == expected, says)
    pairs = zip(edges["source"].tolist(), edges["target"].tolist())
    likeness = {frozenset((f"n{a}", f"n{b}")): s for (a, b), s in zip(pairs, edges["similarity"].tolist())}
    agree = []
    for a, b, key, data in found.edges:
        handles = {int(end[1:]) for end in (a, b) if end.startswith("h")}
        if handles:
            same = data.get("handle") in handles and _hold(data, {"similarity": None})
        else:
            same = _hold(data, {"similarity": likeness.get(frozenset((a, b))), "handle": None})
        agree.append(same and data.get("id") == key)
    ledger.rows("augmented.edge_attributes", agree, "the handle, or the similarity of the edge")


def _count_loops(facts, ledger):
    """Loops of the graphs as they are read, per component of the surface or the solid."""
    n = facts.n_shells
    for graph, group_of_shell in (("solid", facts.body), ("surface", np.arange(n))):
        joints = sorted(h for members in facts.parts[graph].joints for h in members)
        place = {f"h{handle}": k for k, handle in enumerate(joints)}
        pairs = [(place[a], place[b]) for a, b, *_ in facts.graphs[graph].edges if a in place and b in place]
        loops, part = count_loops(len(joints), pairs)
        setattr(facts, f"loops_{graph}", int(loops))
        group = group_of_shell[facts.shell_of_vertex[facts.columns.handles["vertex"][joints]]]
        together, wanted = np.unique(np.stack([part, group]), axis=1).shape[1], len(np.unique(group_of_shell))
        ledger.enter(f"{graph}.components", [int(part.max(initial=-1)) + 1, together], [wanted, wanted])
        nodes, low = np.bincount(group, minlength=n), np.array(pairs, np.int64).reshape(-1, 2)[:, 0]
        facts.loops_of_shell = np.where(nodes > 0, np.bincount(group[low], minlength=n) - nodes + 1, 0)
    if "void" in facts.parts:
        _count_void_loops(facts, ledger)


def _count_void_loops(facts, ledger):
    """Components and loops of the void's graph as it is read, which are those of the surface that the solid's are not.

    At a height, regions of solid and void with the contours between them are a tree, and so are their blocks with the
    pieces between them in a slab. So the homology of the surface's graph is the sum of the other two's
    (Mayer-Vietoris): of bodies that are apart and of a surface that does not cross itself.
    """
    graph = facts.graphs["void"]
    place = {node: k for k, node in enumerate(graph.nodes)}
    pairs = [(place[a], place[b]) for a, b, *_ in graph.edges if a in place and b in place]
    loops, part = count_loops(len(place), pairs)
    facts.loops_void = int(loops)
    if not doubts_void(facts):
        ledger.enter("void.components", int(part.max(initial=-1)) + 1, 1 + facts.voids)
        ledger.enter("loops_surface = loops_solid + loops_void", facts.loops_solid + int(loops), facts.loops_surface)


def doubts_void(facts):
    """Tell whether contours may not tell what is void: where sheets cross, or bodies share material or touch."""
    told = any(facts.inspection.get(f"{which}_crossings") for which in ("self", "body"))
    unsure = facts.open["contours of unsure parent"] > 0
    return bool("void" not in facts.parts or facts.crossing or facts.entangled or told or unsure)


def check_identities(facts, ledger):
    """What theory says of any closed surface and the solid that it bounds."""
    t, n = facts.columns.handles, facts.n_shells
    sign, (b0, b1, b2) = np.where(t["index"] == 1, -1, 1), facts.betti
    by_shell = np.bincount(facts.shell_of_vertex[t["vertex"]], sign, n)
    euler, hidden = (np.bincount(facts.recount.piece_shell, v, n) for v in (facts.recount.euler, facts.piece_genus))
    sides = [2 * int(sign[t["side"] == side].sum()) for side in "AB"]
    facts.suppressed = facts.genus - facts.loops_surface - facts.hidden
    ledger.enter("euler_characteristic = #0 - #1 + #2", int(sign.sum()), facts.euler)
    ledger.enter("sums over sides A and B = euler_characteristic / 2", sides, [facts.euler] * 2)
    ledger.enter("2 (b0 - b1 + b2) = euler_characteristic", 2 * (b0 - b1 + b2), facts.euler)
    ledger.enter("genus = loops + suppressed + hidden", facts.loops_surface + facts.hidden, facts.genus)
    ledger.enter("loops_solid <= b1", facts.loops_solid, f"at most {b1}", facts.loops_solid <= b1)
    ledger.enter("shells = b0 + b2", n, b0 + b2)
    for name, found, expected, what in (
        ("euler_characteristic of each shell", by_shell, facts.shell_euler, "#0 - #1 + #2 over its handles"),
        ("euler_characteristic of the pieces of each shell", euler, facts.shell_euler, "sum over its pieces"),
        ("genus of each shell = loops + hidden genus", facts.loops_of_shell + hidden, facts.shell_genus, "genus"),
    ):
        ledger.rows(name, found == expected, what)
    flux, area = (float(facts.columns.pieces[name].sum()) for name in ("flux", "area"))
    ledger.close("flux of the pieces = volume", flux, facts.volume, 100 * facts.volume_noise)
    ledger.close("area of the pieces = area", area, facts.area, 100 * facts.area_noise)
    _check_region_counts(facts, ledger, t)


def _check_region_counts(facts, ledger, t):
    """Regions at a level: the sum over the events below of how they change their number."""
    n, mixed = len(facts.levels["height"]), np.flatnonzero(~facts.elementary)
    ends = [facts.change[piece].split("->") for piece in mixed.tolist()]
    gains = [EVENTS[change][4] if change else 0 for change in t["change"]]
    gains += [above.count("o") - below.count("o") for below, above in ends]
    gain = np.bincount(np.concatenate([t["slab"], facts.recount.slab[mixed]]) + 1, gains, n + 1).astype(int)
    same = facts.columns.levels["n_regions"] == np.cumsum(gain)[:n]
    ledger.rows("regions at each level = sum of R below", same, "events below the level")
    ledger.enter("sum of R over all events", int(gain.sum()), 0)
