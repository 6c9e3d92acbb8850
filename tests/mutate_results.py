"""Alter written results at random and ask check.py about each: `python tests/mutate_results.py RESULTS COUNT [SEED]`.

(With workflow/scripts on PYTHONPATH; RESULTS are folders of results, separated by commas.)

Every alteration is made in a folder of its own that is otherwise the model's. What check.py accepts must tell what it
told before: the same graphs with the same labels, of a mesh that has them. The counts of all ends are printed:
refused, harmless (accepted, and nothing that a reader asks for has changed), not read (a file that is not), unspoken
(of a model `exact_at_feature_size` an event is moved to another critical point of its part, of which docs/theorem.md
says that a yes does not speak) and wrong.
"""

import importlib.util
import itertools
import json
import random
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from reebslice.errors import ReebsliceError
from reebslice.graphs.exact import exact_graphs
from reebslice.schemas import EVENTS, MODEL_TABLES, OPERATIONS, PAIRINGS, PIECE_KINDS

CHECKOUT = Path(__file__).parent.parent
SPECIFICATION = importlib.util.spec_from_file_location("check", CHECKOUT / "check.py")
check = importlib.util.module_from_spec(SPECIFICATION)  # a script at the top, on no path
SPECIFICATION.loader.exec_module(check)

TAG = "{http://graphml.graphdrawing.org/xmlns}"
GRAPHS = ("solid.graphml", "surface.graphml")
WORDS = {
    "why": ("uniform", "refined"), "kind": PIECE_KINDS, "side": ("A", "B"), "graph": ("solid", "surface", "void"),
    "operation": ("continuation", *OPERATIONS), "change": (None, *EVENTS), "method": ("exact", "similarity"),
    "pairing": PAIRINGS,
}  # fmt: skip
# Tables that check.py reads are altered more often, and what it does not read it need not be asked about.
READ = tuple(check.COLUMNS)
FILES = {*(f"{name}.parquet" for name in READ), *GRAPHS, "tilt.json", "certificate.json"}
LABELS = (*check.NODE, "n_handles")
PLACES = ("x", "y", "z", "height", "lower", "upper")


def read_model(folder, without=()):
    """What a reader asks of a model, but for some labels: both graphs with their labels, and the verdict."""
    told, labels = [], [label for label in LABELS if label not in without]
    for name in GRAPHS:
        nodes, edges = check.read_graph(folder / name)
        # 0.0 and -0.0 are one number
        # where a node of the solid's graph lies in the material is not asked; its vertex is
        rows = ((name, *(data.get(f"vertex_{k}", data.get(k)) for k in labels)) for name, data in nodes.items())
        told.append(sorted((name, *(repr(value or 0) for value in values)) for name, *values in rows))
        ends = [k for k in ("lower", "upper", "inner") if k not in without]
        told.append(sorted((*sorted((a, b)), *(repr(data.get(k) or 0) for k in ends)) for a, b, data in edges))
    return told, json.loads((folder / "certificate.json").read_text())["verdict"]


def mesh_graphs(folder):
    """Arcs of both exact graphs of the mesh in a folder, as the library computes them, or why there are none."""
    tables = (pq.read_table(folder / f"{name}.parquet").drop_columns("model") for name in ("vertices", "faces"))
    points, faces = (table.to_pandas().to_numpy() for table in tables)
    body = np.zeros(len(points), int)
    rotation = np.array(json.loads((folder / "tilt.json").read_text())["rotation"])
    # as check.py does, of a rotation that is none, too: the tilted points are turned no further
    tilted = np.stack([a * points[:, 0] + b * points[:, 1] + c * points[:, 2] for a, b, c in rotation], axis=1)
    try:
        graphs = exact_graphs(tilted, faces[:, :3].astype(int), None, body)
    except ReebsliceError as fault:
        return str(fault)
    found = []
    for graph in graphs:
        first = np.unique(graph.vertex, return_index=True, return_inverse=True)
        ends = first[1][first[2]][graph.arcs]  # copies of one vertex are one node
        found.append(sorted(ends[ends[:, 0] != ends[:, 1]].tolist()))
    return found


# --------------------------------------------------------------------------
# Alterations: each takes a source of choices, the folder to alter and the folders of other models


def alter_table(choice, folder, others):
    """Drop, double, swap or edit rows of a table."""
    name = choice.choice(READ * 3 + MODEL_TABLES)
    table = pq.read_table(folder / f"{name}.parquet")
    if not table.num_rows:
        return None
    way, row, other = choice.randrange(6), choice.randrange(table.num_rows), choice.randrange(table.num_rows)
    field = choice.choice(list(table.schema))
    order = np.arange(table.num_rows)
    if way == 0:
        table = table.take(np.delete(order, row))
    elif way == 1:
        table = table.take(np.insert(order, choice.choice([row, table.num_rows]), other))
    elif way == 2:
        order[[row, other]] = order[[other, row]]
        table = table.take(order)
    else:
        values = table[field.name].to_pylist()
        if way == 3:
            values[row], values[other] = values[other], values[row]
        else:
            values[row] = another(choice, values, row, field)
        place = table.schema.get_field_index(field.name)
        table = table.set_column(place, field, pa.array(values, field.type))
    pq.write_table(table, replace(folder / f"{name}.parquet"))
    return f"{name}.{('drop row', 'add row', 'swap rows', 'swap values', 'edit', 'edit')[way]}"


def another(choice, values, row, field):
    """Another value for a place of a column."""
    value = values[row]
    if isinstance(value, bool):
        return not value
    if field.name in WORDS:
        return choice.choice([word for word in WORDS[field.name] if word is not None or field.nullable])
    if isinstance(value, int):
        return choice.choice([value + 1, value - 1, choice.choice(values), -1, 10**6])
    if isinstance(value, float):
        return choice.choice(
            [value * (1 + 10 ** choice.uniform(-12, 0)) + 10 ** choice.uniform(-12, 0), np.nextafter(value, 9), -value]
        )
    if isinstance(value, bytes):
        return value[:-8] + bytes(8)
    if isinstance(value, list):
        return choice.choice([value[1:], value[::-1], [*value, 0], choice.choice(values)])
    return value


def alter_graph(choice, folder, others):
    """Drop, add, rewire or relabel nodes and edges of a graph."""
    path = folder / choice.choice(GRAPHS)
    ElementTree.register_namespace("", TAG[1:-1])
    tree = ElementTree.parse(path)
    graph = tree.getroot().find(f"{TAG}graph")
    nodes, edges = graph.findall(f"{TAG}node"), graph.findall(f"{TAG}edge")
    way = choice.choice(GRAPH_WAYS)
    done = way(choice, graph, nodes, edges)
    if done is None:
        return None
    tree.write(replace(path), xml_declaration=True, encoding="utf-8")
    return f"{path.name}.{way.__name__}"


def drop_element(choice, graph, nodes, edges):
    graph.remove(choice.choice(nodes + edges))
    return True


def add_edge(choice, graph, nodes, edges):
    if not edges:
        return None
    edge = ElementTree.fromstring(ElementTree.tostring(choice.choice(edges)))
    edge.set("id", "another")
    graph.append(edge)
    return True


def add_node(choice, graph, nodes, edges):
    node = ElementTree.fromstring(ElementTree.tostring(choice.choice(nodes)))
    node.set("id", choice.choice(["h999", choice.choice(nodes).get("id")]))
    graph.append(node)
    return True


def rewire(choice, graph, nodes, edges):
    if not edges:
        return None
    edge, end = choice.choice(edges), choice.choice(["source", "target"])
    edge.set(end, choice.choice(nodes).get("id"))
    return True


def swap_ends(choice, graph, nodes, edges):
    if len(edges) < 2:
        return None
    (one, two), ends = choice.sample(edges, 2), [choice.choice(["source", "target"]) for _ in range(2)]
    a, b = one.get(ends[0]), two.get(ends[1])
    one.set(ends[0], b)
    two.set(ends[1], a)
    return True


def swap_names(choice, graph, nodes, edges):
    if len(nodes) < 2:
        return None
    one, two = choice.sample(nodes, 2)
    a, b = one.get("id"), two.get("id")
    one.set("id", b)
    two.set("id", a)
    return True


def swap_everything(choice, graph, nodes, edges):
    """Two nodes trade their places in the graph, attributes and all."""
    if len(nodes) < 2:
        return None
    a, b = (node.get("id") for node in choice.sample(nodes, 2))
    other = {a: b, b: a}
    for edge in edges:
        for end in ("source", "target"):
            edge.set(end, other.get(edge.get(end), edge.get(end)))
    return True


def change_attribute(choice, graph, nodes, edges):
    data = choice.choice(list(choice.choice(nodes + edges)))
    text = data.text or ""
    try:
        number = float(text)
        data.text = choice.choice([str(int(number) + 1), repr(number + 10 ** choice.uniform(-9, 0)), "", "0"])
    except ValueError:
        data.text = choice.choice([*EVENTS, *OPERATIONS, "A", "B", "True", "False", ""])
    return True


def drop_attribute(choice, graph, nodes, edges):
    element = choice.choice(nodes + edges)
    element.remove(choice.choice(list(element)))
    return True


GRAPH_WAYS = (drop_element, add_edge, add_node, rewire, rewire, swap_ends, swap_ends, swap_names, swap_everything,
              change_attribute, change_attribute, drop_attribute)  # fmt: skip


def exchange_file(choice, folder, others):
    """Take one to three files from another model, or a graph for the other one."""
    names = sorted(path.name for path in folder.iterdir() if path.suffix in (".parquet", ".json", ".graphml"))
    if choice.random() < 0.1:
        content = (folder / GRAPHS[0]).read_bytes()
        replace(folder / GRAPHS[1]).write_bytes(content)
        return "solid for surface"
    other, taken = choice.choice(others), choice.sample(names, choice.choice([1, 1, 2, 3]))
    for name in taken:
        if (other / name).exists():
            replace(folder / name).write_bytes((other / name).read_bytes())
    return "files of another model"


def alter_json(choice, folder, others):
    """Change a figure of the certificate, or the rotation."""
    name = choice.choice(["certificate.json", "tilt.json"])
    told = json.loads((folder / name).read_text())
    if name == "tilt.json":
        row, column = choice.randrange(3), choice.randrange(3)
        told["rotation"][row][column] += choice.choice([1, -1]) * 10 ** choice.uniform(-12, 0)
    else:
        key = choice.choice(["verdict", *(k for k, v in sorted(told.items()) if isinstance(v, (int, str)))])
        verdicts = ["exact", "exact_at_feature_size", "uncertified"]
        told[key] = choice.choice(verdicts) if key == "verdict" else choice.choice([0, 1, 2, "something"])
    replace(folder / name).write_text(json.dumps(told))
    return name


def lie_alike(choice, folder, others):
    """Change a column of a handle, or move it to another vertex, in the table and in both graphs alike."""
    table = pq.read_table(folder / "handles.parquet")
    rows, vertices = table.to_pylist(), pq.read_table(folder / "vertices.parquet").to_pylist()
    row = choice.choice(rows)
    if choice.random() < 0.5:
        points = pq.read_table(folder / "critical_points.parquet").to_pylist()
        point = choice.choice(points)
        row.update(vertex=point["vertex"], rank=point["rank"], height=point["height"], **vertices[point["vertex"]])
        if choice.random() < 0.5:
            row["index"] = point["index"]
    else:
        field = table.schema.field(choice.choice(["index", "side", "operation", "change", "branches", "height", "x"]))
        values = [r[field.name] for r in rows]
        row[field.name] = another(choice, values, rows.index(row), field)
    if any(a["rank"] >= b["rank"] for a, b in itertools.pairwise(rows)):
        return None
    pq.write_table(pa.Table.from_pylist(rows, schema=table.schema), replace(folder / "handles.parquet"))
    ElementTree.register_namespace("", TAG[1:-1])
    for name in GRAPHS:
        tree = ElementTree.parse(folder / name)
        keys = {k.get("id"): k.get("attr.name") for k in tree.getroot().iter(f"{TAG}key")}
        for node in tree.getroot().iter(f"{TAG}node"):
            told = {keys[data.get("key")]: data for data in node}
            for key in check.NODE if told["handle"].text == str(row["handle"]) else ():
                told[key].text = "" if row[key] is None else str(row[key])
        for edge in tree.getroot().iter(f"{TAG}edge"):
            told = {keys[data.get("key")]: data for data in edge}
            ends = sorted(int(edge.get(end)[1:]) for end in ("source", "target"))
            told["lower"].text, told["upper"].text = (repr(rows[h]["height"]) for h in ends)
        tree.write(replace(folder / name), xml_declaration=True, encoding="utf-8")
    return "handle in all files"


WAYS = (alter_table,) * 6 + (alter_graph,) * 5 + (exchange_file, alter_json, alter_json, lie_alike, lie_alike)


def replace(path):
    """The path, freed of the link to the model's own file."""
    path.unlink()
    return path


# --------------------------------------------------------------------------


def judge(choice, folder, model, others, certify=None):
    """Make one alteration in a folder of links to a model: (what was done, what became of it), or None if nothing."""
    done = choice.choice(WAYS)(choice, folder, others)
    changed = [path.name for path in folder.iterdir() if not path.is_symlink()]
    if done is None or all((folder / name).read_bytes() == (model / name).read_bytes() for name in changed):
        return None
    found = certify(folder) if certify else None
    if FILES.isdisjoint(changed):
        return done, "not read", found
    try:
        said = check.check_model(folder)
    except Exception:  # whatever it says, it is a refusal
        return done, "refused", found
    if not said.startswith("yes"):
        return done, "no claim", found
    same, exact = read_model(folder) == read_model(model), read_model(folder)[1] == "exact"
    if not exact and read_model(folder, PLACES) == read_model(model, PLACES):
        return done, "harmless" if same else "unspoken", found
    if same and any(name in changed for name in ("vertices.parquet", "faces.parquet", "tilt.json")):
        same = mesh_graphs(folder) == mesh_graphs(model)
    return done, "harmless" if same else "wrong", found


def link(folder, model):
    """Make the folder one of links to the files of a model, where it is not yet."""
    folder.mkdir(exist_ok=True)
    for path in model.iterdir():
        place = folder / path.name
        if (
            path.suffix in (".parquet", ".json", ".graphml")
            and not path.name.startswith(".")
            and not place.is_symlink()
        ):
            place.unlink(missing_ok=True)
            place.symlink_to(path)


def run(models, count, seed, certify=None):
    """Alter models until `count` results were altered; return counts by deed and end, and what was wrong."""
    choice, ends, wrong = random.Random(seed), Counter(), []
    with TemporaryDirectory() as scratch:
        while sum(ends.values()) < count:
            model, state = choice.choice(models), choice.getrandbits(64)
            folder = Path(scratch) / model.name
            link(folder, model)
            found = judge(random.Random(state), folder, model, [m for m in models if m != model], certify)
            if found:
                ends[found[0].split(".")[0], *found[1:]] += 1
                if found[1] == "wrong":
                    wrong.append((model.name, state, found[0]))
    return ends, wrong


if __name__ == "__main__":
    folders = [
        path.parent for root in sys.argv[1].split(",") for path in sorted(Path(root).glob("models/*/certificate.json"))
    ]
    counts, faults = run([f.absolute() for f in folders], int(sys.argv[2]), int((sys.argv[3:] or ["1"])[0]))
    for (what, end, _), times in sorted(counts.items()):
        print(f"{what:28} {end:10} {times:6}")
    for end in ("refused", "no claim", "not read", "harmless", "unspoken", "wrong"):
        print(f"{end:39} {sum(times for (_, e, _), times in counts.items() if e == end):6}")
    print(*faults, sep="\n")
    sys.exit(bool(faults))
