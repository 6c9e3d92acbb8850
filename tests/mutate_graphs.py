"""Alterations of the exact graphs that the workflow makes without levels, one by one or as consistent lies.

    python tests/mutate_graphs.py NUMBER [MESH ...]

alters the results of each mesh so often, or of some solids, and says how many alterations were refused.
"""

import contextlib
import sys
from collections import Counter
from functools import partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

import build_graphs
import inspect_mesh
import select_tilt
import solids
from corpus.storage import read_json, read_table
from pipeline import OPTIONS, write_off
from reebslice.certification.exact_graphs import TABLES, certify_exact_graphs
from reebslice.certification.graphml import ReadGraph, parse_graph
from reebslice.graphs.exact_tables import name_changes, name_graph
from reebslice.schemas import EVENTS, EXACT_GRAPHS

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
noisy_volumes = import_module("noisy_volumes")


def torus(around=80, across=50, amplitude=2.0):
    return solids.Solid(*noisy_volumes.bumpy_torus(around, across, amplitude, 1))


@contextlib.contextmanager
def built(source, mode="none"):
    """A folder with the model of a solid, or of a mesh file, up to its exact graphs."""
    with TemporaryDirectory() as folder:
        folder = Path(folder)
        path = folder / "solid.off" if isinstance(source, solids.Solid) else Path(source)
        if isinstance(source, solids.Solid):
            write_off(path, source)
        inspect_mesh.main(path, folder, OPTIONS["inspect"])
        select_tilt.main(folder, folder, {"mode": mode, "direction": None, "up": "z"})
        build_graphs.main(folder, folder, {})
        yield folder


def load(folder):
    """What `certify_exact_graphs` takes."""
    tables = {name: read_table(folder / f"{name}.parquet", name) for name in TABLES}
    graphs = {name: parse_graph((folder / f"{name}.graphml").read_bytes()) for name in EXACT_GRAPHS}
    return tables, read_json(folder / "tilt.json"), graphs, read_json(folder / "inspection.json"), folder.name


def rewrite(model, nodes, arcs):
    """The model with other tables, and graphs that tell the same: a consistent lie."""
    tables, tilt, graphs, *rest = model
    schemas = [tables[name].schema for name in ("exact_nodes", "exact_arcs")]
    made = [pa.table(columns, schema=schema) for columns, schema in zip((nodes, arcs), schemas)]
    drawn = {}
    for name in EXACT_GRAPHS:
        graph = name_graph(name, *made)
        edges = [(a, b, data["id"], data) for a, b, data in graph.edges]
        drawn[name] = ReadGraph(graph.nodes, edges, graphs[name].about)
    return tables | dict(zip(("exact_nodes", "exact_arcs"), made)), tilt, drawn, *rest


def columns_of(model):
    return [
        {c: model[0][name][c].to_pylist() for c in model[0][name].column_names}
        for name in ("exact_nodes", "exact_arcs")
    ]


def reconnect(nodes, arcs, row, source, target):
    arcs["source"][row], arcs["target"][row] = source, target
    arcs["lower"][row], arcs["upper"][row] = nodes["height"][source], nodes["height"][target]


def swap_ends(nodes, arcs, random, word):
    """Two arcs exchange their upper ends."""
    rows = [row for row, graph in enumerate(arcs["graph"]) if graph == word]
    one, other = (int(row) for row in random.choice(rows, 2, replace=False))
    low, high = ([arcs[end][row] for row in (one, other)] for end in ("source", "target"))
    if max(low) >= min(high):
        return False
    reconnect(nodes, arcs, one, low[0], high[1])
    reconnect(nodes, arcs, other, low[1], high[0])
    return True


def move_event(nodes, arcs, random):
    """An event of a hole goes over to another outer contour that is there at its height."""
    rows = [row for row, graph in enumerate(arcs["graph"]) if graph == "solid"]
    node = int(random.choice([k for k, change in enumerate(nodes["change"]) if "o" not in change] or [-1]))
    into, out = ([row for row in rows if arcs[end][row] == node] for end in ("target", "source"))
    over = [row for row in rows if arcs["source"][row] < node < arcs["target"][row] and row not in into + out]
    if len(into) != 1 or len(out) != 1 or not over:
        return False
    other = int(random.choice(over))
    ends = arcs["source"][other], arcs["target"][other]
    reconnect(nodes, arcs, into[0], arcs["source"][into[0]], arcs["target"][out[0]])
    reconnect(nodes, arcs, other, ends[0], node)
    reconnect(nodes, arcs, out[0], node, ends[1])
    return True


def turn_hole(nodes, arcs, random):
    """An arc of the surface is said to be a hole, or not to be one, and all events accordingly."""
    rows = [row for row, graph in enumerate(arcs["graph"]) if graph == "surface"]
    row = int(random.choice(rows))
    arcs["inner"][row] = not arcs["inner"][row]
    ends = np.array([[arcs["source"][k], arcs["target"][k]] for k in rows])
    try:
        nodes["change"] = name_changes(len(nodes["node"]), ends, np.array([arcs["inner"][k] for k in rows]))
    except KeyError:
        return True
    for column, place in (("side", 0), ("operation", 5)):
        nodes[column] = [EVENTS[change][place] for change in nodes["change"]]
    nodes["branches"] = [EVENTS[change][4] != 0 for change in nodes["change"]]
    return True


def leave_out(nodes, arcs, random):
    """An event that does not branch is left out of the solid."""
    rows = [row for row, graph in enumerate(arcs["graph"]) if graph == "solid"]
    degree = Counter([arcs[end][row] for row in rows for end in ("source", "target")])
    node = int(random.choice([k for k, d in degree.items() if d == 2 and not nodes["branches"][k]] or [-1]))
    into, out = ([row for row in rows if arcs[end][row] == node] for end in ("target", "source"))
    if len(into) != 1 or len(out) != 1:
        return False
    reconnect(nodes, arcs, into[0], arcs["source"][into[0]], arcs["target"][out[0]])
    for column in arcs.values():
        del column[out[0]]
    count = arcs["graph"].count("surface")
    arcs["arc"] = [*range(count), *range(len(arcs["graph"]) - count)]
    nodes["in_solid"][node] = False
    return True


def change_cell(nodes, arcs, random):
    """A cell of a table takes what another row has there, or is counted up."""
    table = (nodes, arcs)[int(random.integers(2))]
    column = str(random.choice(list(table)))
    row, other = (int(k) for k in random.integers(len(table[column]), size=2))
    before = table[column][row]
    is_number = type(before) in (int, float)
    table[column][row] = (
        before + int(random.integers(1, 3)) if is_number and random.random() < 0.5 else table[column][other]
    )
    return table[column][row] != before


WAYS = (
    partial(swap_ends, word="solid"),
    partial(swap_ends, word="surface"),
    move_event,
    turn_hole,
    leave_out,
    change_cell,
)


def change_graph(model, random):
    """An attribute, a node or an edge of a graph alone is altered."""
    tables, tilt, graphs, *rest = model
    name = str(random.choice(EXACT_GRAPHS))
    graph = graphs[name]
    nodes, edges = {node: dict(data) for node, data in graph.nodes.items()}, list(graph.edges)
    row = int(random.integers(len(edges)))
    a, b, key, data = edges[row]
    which = int(random.integers(4))
    if which == 0:
        del edges[row]
    elif which == 1:
        edges[row] = (str(random.choice(list(nodes))), b, key, data)
    elif which == 2:
        edges[row] = (a, b, key, data | {"upper": data["upper"] + 1.0})
    else:
        node, column = str(random.choice(list(nodes))), str(random.choice(["x", "height", "label", "change", "index"]))
        value = nodes[node][column]
        nodes[node][column] = value + ("?" if isinstance(value, str) else 1)
    same = edges == graph.edges and nodes == graph.nodes
    return None if same else (tables, tilt, graphs | {name: ReadGraph(nodes, edges, graph.about)}, *rest)


def reading(model):
    """What a reader sees of the graphs: events, and arcs as a multiset, copies of one vertex taken together."""
    nodes, arcs = columns_of(model)
    vertex = nodes["vertex"]
    rows = zip(*(arcs[name] for name in ("graph", "source", "target", "inner")))
    told = Counter((graph, vertex[a], vertex[b], inner) for graph, a, b, inner in rows if vertex[a] != vertex[b])
    events = {name: column for name, column in nodes.items() if name != "node"}
    return told, events


def alter(model, random):
    """The model altered at random so that a reader sees something else, and the way."""
    while True:
        way = int(random.integers(len(WAYS) + 1))
        if way == len(WAYS):
            altered = change_graph(model, random)
        else:
            nodes, arcs = columns_of(model)
            altered = rewrite(model, nodes, arcs) if WAYS[way](nodes, arcs, random) else None
            altered = altered if altered and (way == 5 or reading(altered) != reading(model)) else None
        if altered:
            return altered, way


def count_refused(model, number, seed):
    """How many of so many alterations are refused, and the ways of those that are not."""
    random, passed = np.random.default_rng(seed), Counter()
    assert certify_exact_graphs(*model)["verdict"] == "exact"
    for _ in range(number):
        altered, way = alter(model, random)
        passed[way] += certify_exact_graphs(*altered)["verdict"] == "exact"
    return number - passed.total(), dict(+passed)


if __name__ == "__main__":
    for source in sys.argv[2:] or [torus(40, 30, 1.2), *map(solids.csg, range(3)), *map(solids.machined, range(3))]:
        with built(source, "auto") as place:
            print(
                source if isinstance(source, str) else len(source.faces),
                count_refused(load(place), int(sys.argv[1]), 0),
                flush=True,
            )
