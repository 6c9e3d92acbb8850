"""Certificate of the exact Reeb graphs of surface and solid that are made without levels.

The nodes are held against the mesh, vertex by vertex, the arcs of the surface against a sweep over it, and those of
the solid against what lines through the contours of every arc, at both of its ends, tell of what is around them.
"""

from collections import Counter
from types import SimpleNamespace

import numpy as np

from ..schemas import EVENTS
from ..table_checks import check_table, list_id_faults
from .certificate import APART, BY_SOS
from .checks.critical_points import PAIRINGS
from .checks.form import read_column
from .checks.surface import check_mesh, check_tilt
from .facts import Facts
from .functions import check_surface_graph
from .ledger import Ledger
from .recount.exact_hosts import settle_doubts
from .recount.hosts import HOLE
from .recount.ranges import expand_ranges
from .recount.solid_arcs import contract_flats, count_loops, solid_arcs
from .recount.surface import copies
from .recount.sweep import sweep_surface

TABLES = ("vertices", "faces", "shells", "exact_nodes", "exact_arcs")
NODE_COLUMNS = ("node", "x", "y", "z", "height", "index", "side", "operation", "change", "branches", "persistence")
CONTRADICTIONS = (ValueError, KeyError, IndexError, TypeError)
CROSSES = (
    "The surface crosses itself, so the graph of the solid is not certified; take the parts that cross apart, or unite "
    "them, in the program that made the mesh."
)
TOUCHES = "Contours touch, or come so near that it is open which is around which at {} of them; take another tilt."
DIFFERENT = (
    "The check {!r} fails: the graphs do not fit the mesh; delete the model's folder in results/models and start "
    "again, and if it fails again, report it."
)


def certify_exact_graphs(tables, tilt, graphs, inspection, model):
    """Certify the exact graphs of one model.

    Parameters
    ----------
    tables : dict of pyarrow.Table
        Those of `TABLES`, as `schemas` declares them.
    tilt : dict
        The content of tilt.json.
    graphs : dict of ReadGraph
        By the names in `schemas.EXACT_GRAPHS`.
    inspection : dict
        The content of inspection.json. Of it are taken, as stated, `self_crossings`, `body_crossings` and `unit`.
    model : str
        Its id.

    Returns
    -------
    dict
        `verdict`: `exact` or `uncertified`, and `reason`, why it is; `surface_verdict`, that of the surface's graph
        alone; figures; and `checks`, each by name with its two sides. Never raises on account of the tables.
    """
    facts = Facts(tables, tilt, graphs, 0.0, inspection=inspection, model=model)
    found = SimpleNamespace(n_open=0, odd=bool(inspection.get("self_crossings")), figures={})
    ledgers = Ledger(), Ledger()
    for steps, ledger in zip(((_check_form, _check_surface), (_check_solid,)), ledgers):
        for step in steps:
            try:
                if ledgers[0].holds() or not ledgers[0].checks:
                    step(facts, found, ledger)
            except CONTRADICTIONS as fault:
                ledger.enter(f"{step.__name__[1:]}: made", False, True, says=f"{type(fault).__name__}: {fault}")
    surface, solid = (ledger.holds() for ledger in ledgers)
    exact = surface and solid and not found.odd and not found.n_open
    return {
        "verdict": "exact" if exact else "uncertified",
        "reason": "" if exact else _tell_why(ledgers, found),
        "surface_verdict": "exact" if surface else "uncertified",
        **found.figures,
        "height_interpretation": BY_SOS if tilt.get("morse") == "by_sos" else "",
        "solid_interpretation": APART if inspection.get("body_crossings") else "",
        "checks": ledgers[0].checks | ledgers[1].checks,
    }


def _tell_why(ledgers, found):
    """Why the model is uncertified and what to do, in a sentence."""
    if ledgers[0].holds() and found.odd:
        return CROSSES
    failed = [name for ledger in ledgers for name, check in ledger.checks.items() if not check["holds"]]
    return DIFFERENT.format(failed[0]) if failed else TOUCHES.format(found.n_open)


def _check_form(facts, found, ledger):
    """Tables as declared, and references to rows that exist."""
    for name in TABLES:
        check_table(name, facts.tables[name])
    size = {name: facts.tables[name].num_rows for name in TABLES}
    faults = [fault for name in TABLES for fault in list_id_faults(name, facts.tables[name], size)]
    columns = {name: {c: read_column(table[c]) for c in table.column_names} for name, table in facts.tables.items()}
    odd = set(columns["exact_arcs"]["graph"]) - {"surface", "solid"}
    faults += [f"Column graph of table exact_arcs holds {word!r}." for word in sorted(odd)]
    facts.columns = SimpleNamespace(**columns)
    ledger.enter("tables_in_form", len(faults), 0, says=faults[0] if faults else "")


def _check_surface(facts, found, ledger):
    """The mesh, the tilt, and the graph of the surface; sweeps the surface."""
    check_mesh(facts, ledger)
    check_tilt(facts, ledger)
    if not ledger.holds():
        return
    t, surface = facts.columns.exact_nodes, facts.surface
    first, count = surface.weight[:-1], np.where(surface.index < 0, 0, copies(surface))
    point, ranks = expand_ranges(first, first + count)
    ledger.enter("exact_nodes.rank", np.array_equal(t["rank"], ranks), True)
    if not ledger.holds():
        return
    ledger.compare(
        "exact_nodes", t,
        ("vertex", surface.origin[point], "the vertex of that rank"),
        ("height", surface.points[point, 2], "height of the vertex"),
        ("index", surface.index[point], "sign changes around it"),
        *((axis, column[surface.origin[point]], "its vertex") for axis, column in zip("xyz", facts.points)),
        ("persistence", np.abs(t["height"] - t["height"][t["partner"]]), "height to the partner"),
        ("pairing", _name_pairings(t["index"], t["partner"]), "by the two indices"),
    )  # fmt: skip
    of = facts.columns.exact_arcs["graph"] == "surface"
    arcs = {name: column[of] for name, column in facts.columns.exact_arcs.items()}
    ledger.enter("exact_arcs.arc", np.array_equal(arcs["arc"], np.arange(of.sum())), True)
    body = facts.body[surface.shell]
    found.swept, doubts = sweep_surface(surface, facts.sides, body)
    nodes = t | {"at": point, "value": t["height"]}
    figures = check_surface_graph(ledger, surface, facts.sides, nodes, arcs, found.swept)
    found.figures = {"loops_surface": figures.pop("loops"), "loops_solid": None} | figures
    _check_graph(facts, ledger, "exact_surface", arcs, np.ones(len(point), bool))
    found.n_open, odd = settle_doubts(surface, facts.sides, body, found.swept, doubts)
    found.odd, found.at = found.odd or odd, point


def _name_pairings(index, partner):
    """The word for the pair that each node is in."""
    pairs = np.sort(np.column_stack([index, index[partner]]), axis=1).tolist()
    return np.array([PAIRINGS.get(tuple(pair)) for pair in pairs], object)


def _check_solid(facts, found, ledger):
    """Holes, events, and the graph of the solid."""
    t, at, swept, table = facts.columns.exact_nodes, found.at, found.swept, facts.columns.exact_arcs
    parts = [{name: column[table["graph"] == word] for name, column in table.items()} for word in ("surface", "solid")]
    of_surface, arcs = parts
    low, high = at[of_surface["source"]], at[of_surface["target"]]
    apart = low < high
    stated = Counter(zip(low[apart].tolist(), high[apart].tolist(), of_surface["inner"][apart].tolist()))
    expected = Counter(zip(swept.low.tolist(), swept.high.tolist(), (swept.kind == HOLE).tolist()))
    ledger.enter("exact_arcs.inner", stated.total(), expected.total(), stated == expected)
    _check_events(ledger, t, of_surface)
    if not ledger.holds():  # the rest builds on it
        return
    ends = np.column_stack([arcs["source"], arcs["target"]]).astype(np.int64)
    ledger.enter("exact_arcs.arc of the solid", np.array_equal(arcs["arc"], np.arange(len(ends))), True)
    ledger.rows("exact_arcs.upward", ends[:, 0] < ends[:, 1], "from the lower to the upper node")
    heights = arcs["lower"] == t["height"][ends[:, 0]], arcs["upper"] == t["height"][ends[:, 1]]
    ledger.rows("exact_arcs.heights", heights[0] & heights[1] & ~arcs["inner"], "those of its ends, and no holes")
    _check_degrees(ledger, t, ends)
    _check_solid_arcs(facts, found, ledger, at[ends])
    _check_graph(facts, ledger, "exact_solid", arcs, t["in_solid"])
    sign = np.where(t["index"] == 1, -1, 1)
    sums = [2 * int(sign[t["side"] == side].sum()) for side in "AB"]
    ledger.enter("sums over sides A and B = euler_characteristic / 2", sums, [facts.euler] * 2)


def _check_events(ledger, t, arcs):
    """What becomes of contours at each node, by the arcs of the surface, and what follows from it."""
    inner, count = arcs["inner"], len(t["node"])
    ends = [np.bincount(arcs[end][kind], minlength=count) for end in ("target", "source") for kind in (inner, ~inner)]
    changes = ["->".join(",".join("i" * i + "o" * o) for i, o in ((a, b), (c, d))) for a, b, c, d in zip(*ends)]
    ledger.rows("exact_nodes.change", t["change"] == np.array(changes, object), "its arcs, and which are holes")
    events = [EVENTS.get(change, (None,) * 6) for change in changes]
    for column, place in (("side", 0), ("operation", 5)):
        same = [event[place] == word for event, word in zip(events, t[column].tolist())]
        ledger.rows(f"exact_nodes.{column}", same, "that of its event")
    ledger.rows("exact_nodes.branches", [(e[4] != 0) == b for e, b in zip(events, t["branches"].tolist())], "its event")


def _check_degrees(ledger, t, ends):
    """Arcs of the solid below and above every node, by its event; and which nodes are left out."""
    count, shown = len(t["node"]), t["in_solid"]
    left = ~shown & (t["persistence"] == 0) & ~shown[t["partner"]]
    ledger.rows("exact_nodes.in_solid", shown | left, "left out only with its partner at the same height")
    degrees = list(zip(*(np.bincount(ends[:, side], minlength=count).tolist() for side in (1, 0))))
    wanted = []
    for change, there in zip(t["change"].tolist(), shown.tolist()):
        below, above = change.split("->")
        hosted = "o" not in change or change in ("i,o->i", "i->i,o")
        wanted.append((below.count("o") + hosted, above.count("o") + hosted) if there else (0, 0))
    same = [one == other for one, other in zip(degrees, wanted)]
    ledger.rows("exact_nodes.arcs of the solid", same, "those of its event below and above")


def _check_solid_arcs(facts, found, ledger, ends):
    """The arcs of the solid against those that the sweep finds; ends : ranks."""
    if found.n_open:
        return
    expected, shown = solid_arcs(found.swept), np.zeros(len(facts.rank), bool)
    found.odd |= expected is None
    if found.odd:
        return
    shown[found.at[facts.columns.exact_nodes["in_solid"]]] = True
    wanted, group = contract_flats(expected, shown, facts.surface.points[:, 2])
    ends = ends[ends[:, 0] != ends[:, 1]]  # not between copies of a multiple saddle
    (parts, loops), told = count_loops(ends), count_loops(expected)
    ends = group[ends]
    stated = Counter(zip(*ends[ends[:, 0] != ends[:, 1]].T.tolist()))
    says = "" if stated == wanted else "What is around the holes joins the outer contours otherwise."
    ledger.enter("exact_arcs.solid", stated.total(), wanted.total(), stated == wanted, says)
    ledger.enter("solid.components and loops", [parts, loops], list(told))
    found.figures["loops_solid"], most = loops, facts.betti[1]
    ledger.enter("loops_solid <= b1", loops, f"at most {most}", loops <= most)


def _check_graph(facts, ledger, name, arcs, shown):
    """A graph as read from GraphML against the tables; shown : (K,) which nodes it has."""
    graph, t, solid = facts.graphs[name], facts.columns.exact_nodes, name == "exact_solid"
    rows = [row for row, there in zip(_rows(t, NODE_COLUMNS), shown.tolist()) if there]
    nodes = {f"c{row['node']}": row | {"label": f"c{row['node']} {row['operation']} {row['side']}"} for row in rows}
    for row in nodes.values():
        row["change"] = row["change"] or ""
    ledger.enter(f"{name}.nodes", graph.nodes == nodes, True)
    columns, letter = ("arc", "lower", "upper") if solid else ("arc", "lower", "upper", "inner"), "s" if solid else "c"
    pairs = zip(arcs["source"].tolist(), arcs["target"].tolist(), _rows(arcs, columns))
    rows = ((f"c{a}", f"c{b}", row | {"id": f"{letter}{row['arc']}"}) for a, b, row in pairs)
    edges = {row["id"]: ({a, b}, row) for a, b, row in rows}
    stated = {key: ({a, b}, data) for a, b, key, data in graph.edges}
    ledger.enter(f"{name}.edges", [stated == edges, len(graph.edges)], [True, len(edges)])
    about = {f"direction_{axis}": part for axis, part in zip("xyz", facts.tilt["direction"])}
    about |= {"graph": name, "model": facts.model, "unit": facts.inspection.get("unit") or ""}
    ledger.enter(f"{name}.description", graph.about, about | {"certificate": "exact_graphs.json"})


def _rows(table, columns):
    """The rows of some columns of a table, as dicts of plain values."""
    return [dict(zip(columns, row)) for row in zip(*(table[column].tolist() for column in columns))]
