"""Certificates are sound: seeded random alterations of results, one by one or as consistent lies, are all caught."""

import random
from functools import cache
from tempfile import TemporaryDirectory

import networkx as nx
import pyarrow as pa
import pytest
import shapely

import pipeline
import solids
from certify import mesh_lengths
from corpus.storage import read_json, read_table
from reebslice.certification.certificate import certify
from reebslice.certification.recount import cut_surface
from reebslice.certification.recount.curves import read_curves
from reebslice.schemas import EVENTS, GRAPHS, MODEL_TABLES, OPERATIONS, PIECE_KINDS, SCHEMAS

MODELS = {
    "nested": (solids.nested_shells(4), [0.1, 0.2, 0.97], {}),
    "torus": (solids.torus(upright=True), [0.1, 0.2, 0.97], {}),
    "flat": (solids.plate(3, upright=True), [0, 0, 1], {}),
    "holes": (solids.plate(2), [0.1, 0.2, 0.97], {}),
    "multiple saddle": (solids.wedges([1, -1, 1, 1, -1, 1, -1, -1], 5), [0, 0, 1], {}),
    "noisy": (
        solids.unite(solids.blob(3, 2), solids.move(solids.torus(upright=True), [6, 0, 0.3])),
        [0.1, 0.2, 0.97],
        {"refine": "feature"},
    ),
}
WORDS = {
    "why": ("uniform", "refined"), "kind": PIECE_KINDS, "side": ("A", "B"), "graph": ("solid", "surface", "void"),
    "operation": ("continuation", *OPERATIONS), "change": (None, *EVENTS), "method": ("exact", "similarity"),
}  # fmt: skip
# A vertex may move inside a flat and a cut between two of its vertices: the solid and the level remain the same.
# Shells, faces and vertices are the input of all other tables; that they fit each other is tested elsewhere.
SAME = {("levels", "tie_x"), ("levels", "tie_y")}
GIVEN = ("vertices", "faces")


@cache
def results(name):
    solid, direction, levels = MODELS[name]
    with TemporaryDirectory() as folder:
        pipeline.run_stages(solid, folder, tilt={"mode": "direction", "direction": direction}, levels=levels)
        tables = {table: read_table(f"{folder}/{table}.parquet", table) for table in MODEL_TABLES}
        graphs = {g: nx.read_graphml(f"{folder}/{g}.graphml", force_multigraph=True) for g in GRAPHS}
        tilt = read_json(f"{folder}/tilt.json")
    return tables, tilt, graphs, *mesh_lengths(tables["vertices"], tilt, pipeline.OPTIONS["levels"] | levels)


def test_curves_may_come_apart_from_the_table_of_contours():
    tables, tilt, graphs, size, distance = results("nested")
    whole = certify(tables, tilt, pipeline.as_read(graphs), size, distance)
    contours = tables["contours"]
    bare, blobs = contours.drop_columns(["geometry"]), contours["geometry"].combine_chunks()
    parts = [blobs.slice(0, 7), blobs.slice(7)]
    found = certify(tables | {"contours": bare}, tilt, pipeline.as_read(graphs), size, distance, read_curves(parts))
    assert found == whole
    for curves in (None, read_curves(parts[1:]), read_curves(parts[::-1])):
        found = certify(tables | {"contours": bare}, tilt, pipeline.as_read(graphs), size, distance, curves)
        assert found["verdict"] == "uncertified"


@pytest.mark.parametrize("name", ["nested", "multiple saddle"])
def test_runs_of_few_levels_certify_the_same(name, monkeypatch):
    tables, tilt, graphs, size, distance = results(name)
    whole = certify(tables, tilt, pipeline.as_read(graphs), size, distance)
    for cells in (1, 1000):
        monkeypatch.setattr(cut_surface, "CELLS_AT_ONCE", cells)
        assert certify(tables, tilt, pipeline.as_read(graphs), size, distance) == whole


@pytest.mark.parametrize("name", MODELS)
def test_every_mutation_is_caught(name):
    tables, tilt, graphs, size, distance = results(name)
    assert certify(tables, tilt, pipeline.as_read(graphs), size, distance)["verdict"] != "uncertified"
    choice, tried, missed = random.Random(name), 0, []
    while tried < 40:
        altered_tables, altered_graphs = tables, graphs
        mutate = choice.choice([change_value] * 4 + [change_rows, change_graph, *LIES])
        if mutate is change_graph:
            altered_graphs = change_graph(choice, graphs)
        else:
            altered_tables = mutate(choice, tables)
        if altered_tables is None or altered_graphs is None:
            continue
        tried += 1
        if certify(altered_tables, tilt, pipeline.as_read(altered_graphs), size, distance)["verdict"] != "uncertified":
            missed.append((mutate.__name__, *differences(tables, altered_tables)))
    assert missed == []


def differences(tables, altered):
    """What was altered in the tables, to be read in a failure."""
    for name in tables:
        rows = zip(tables[name].to_pylist(), altered[name].to_pylist())
        for place, (one, two) in enumerate(rows):
            yield from ((name, place, key, one[key], two[key]) for key in one if one[key] != two[key])


def alter(tables, name, change):
    """The tables with the rows of one of them changed in place by change(rows)."""
    rows = tables[name].to_pylist()
    change(rows)
    return tables | {name: pa.Table.from_pylist(rows, schema=SCHEMAS[name])}


# --------------------------------------------------------------------------
# Alterations of one place; None where the choice leaves everything as it was


def change_value(choice, tables):
    name = choice.choice([name for name in MODEL_TABLES if name not in GIVEN and tables[name].num_rows])
    field, rows = choice.choice(list(SCHEMAS[name])), tables[name].to_pylist()
    row = choice.randrange(len(rows))
    value = another(choice, rows, row, field)
    if value == rows[row][field.name] or (name, field.name) in SAME:
        return None
    return alter(tables, name, lambda rows: rows[row].update({field.name: value}))


def another(choice, rows, row, field):
    value = rows[row][field.name]
    if isinstance(value, bool):
        return not value
    if field.name in WORDS:
        return choice.choice([word for word in WORDS[field.name] if word is not None or field.nullable])
    if isinstance(value, int):
        return choice.choice([value + 1, value - 1, choice.choice(rows)[field.name]])
    if isinstance(value, float):
        return value * (1 + 10 ** choice.uniform(-4, 0)) + 10 ** choice.uniform(-4, 0)
    if isinstance(value, bytes):
        curve, by = shapely.from_wkb(value), 10 ** choice.uniform(-4, 0)
        return shapely.to_wkb(choice.choice([shapely.reverse(curve), shapely.transform(curve, lambda p: p + [by, 0])]))
    if isinstance(value, list):
        return choice.choice([value[1:], value[::-1], value + [0], choice.choice(rows)[field.name]])
    return value if value is None or isinstance(value, str) else None


def change_rows(choice, tables):
    name = choice.choice([name for name in MODEL_TABLES if tables[name].num_rows])
    row = choice.randrange(tables[name].num_rows)
    drop = choice.random() < 0.5
    return alter(tables, name, lambda rows: rows.pop(row) if drop else rows.insert(row, dict(rows[row])))


def change_graph(choice, graphs):
    name = choice.choice(GRAPHS)
    graph = graphs[name].copy()
    if not graph.number_of_edges():
        return None
    a, b, key, data = choice.choice(list(graph.edges(keys=True, data=True)))
    node, attribute = choice.choice(list(graph)), choice.choice(list(data))
    if (way := choice.randrange(5)) == 0:
        graph.remove_edge(a, b, key)
    elif way == 1:
        graph.add_edge(a, b, key="another", **data)
    elif way == 2 and node not in (a, b):
        graph.remove_edge(a, b, key)
        graph.add_edge(a, node, key=key, **data)
    elif way == 3:
        graph.edges[a, b, key][attribute] = unlike(data[attribute])
    elif way == 4:
        attribute = choice.choice(list(graph.nodes[node]))
        graph.nodes[node][attribute] = unlike(graph.nodes[node][attribute])
    else:
        return None
    return graphs | {name: graph}


def unlike(value):
    if isinstance(value, bool):
        return not value
    if isinstance(value, (int, float)):
        return value + 1
    return "o->" if value != "o->" else "->o"


# --------------------------------------------------------------------------
# Lies that are told alike in all tables


def swap_contours(choice, tables):
    """Two contours of a level trade what is above them."""
    level = choice.choice(tables["contours"]["level"].to_pylist())
    members = [row["contour"] for row in tables["contours"].to_pylist() if row["level"] == level]
    if len(members) < 2:
        return None
    a, b = choice.sample(members, 2)
    other = {a: b, b: a}

    def trade(key):
        return lambda rows: [row.update({key: sorted(other.get(c, c) for c in row[key])}) for row in rows]

    altered = alter(alter(tables, "pieces", trade("below")), "handles", trade("contours_below"))
    return None if altered["pieces"].equals(tables["pieces"]) else altered


def swap_links(choice, tables):
    """Two edges of a slab trade their upper ends."""
    rows = tables["edges"].to_pylist()
    slab = choice.choice(rows)["slab"]
    members = [row["edge"] for row in rows if row["slab"] == slab]
    if len(members) < 2:
        return None
    a, b = choice.sample(members, 2)
    one, two = rows[a]["target"], rows[b]["target"]
    if one == two or rows[a]["source"] == rows[b]["source"]:
        return None
    return alter(tables, "edges", lambda rows: (rows[a].update(target=two), rows[b].update(target=one)))


def turn_contour(choice, tables):
    """An outer contour becomes a hole, or a hole an outer contour."""
    row = choice.randrange(tables["contours"].num_rows)

    def turn(rows):
        curve = shapely.to_wkb(shapely.reverse(shapely.from_wkb(rows[row]["geometry"])))
        rows[row].update(inner=not rows[row]["inner"], signed_area=-rows[row]["signed_area"], geometry=curve)

    return alter(tables, "contours", turn)


def delete_contour(choice, tables):
    """A contour vanishes from contours, levels, pieces and handles."""
    gone = choice.randrange(tables["contours"].num_rows)
    level = tables["contours"]["level"][gone].as_py()

    def renumber(contour):
        return None if contour in (None, gone) else contour - (contour > gone)

    def drop(rows):
        rows.pop(gone)
        for row in rows:
            row.update(contour=renumber(row["contour"]), parent=renumber(row["parent"]))

    def forget(*keys):
        def change(rows):
            for row in rows:
                row.update({key: [renumber(c) for c in row[key] if c != gone] for key in keys})
                if keys[0] == "below":
                    row.update(n_below=len(row["below"]), n_above=len(row["above"]))

        return change

    tables = alter(alter(tables, "contours", drop), "pieces", forget("below", "above"))
    tables = alter(tables, "handles", forget("contours_below", "contours_above"))
    return alter(tables, "levels", lambda rows: rows[level].update(n_contours=rows[level]["n_contours"] - 1))


def shift_level(choice, tables):
    """A level moves a little, with its contours and nodes."""
    level, by = choice.randrange(tables["levels"].num_rows), 10 ** choice.uniform(-4, -2)
    for name in ("levels", "contours", "nodes"):
        tables = alter(
            tables, name, lambda rows: [row.update(height=row["height"] + by) for row in rows if row["level"] == level]
        )
    return tables


def alter_genus(choice, tables):
    """A piece, or a shell, gets a handle."""
    name = choice.choice(["pieces", "shells"])
    place = choice.randrange(tables[name].num_rows)
    kind = {"kind": "compound"} if name == "pieces" else {}

    def change(rows):
        row = rows[place]
        row.update(genus=row["genus"] + 1, euler_characteristic=row["euler_characteristic"] - 2, **kind)

    return alter(tables, name, change)


def swap_handles(choice, tables):
    """Two handles trade their places, their events, or their persistences."""
    rows, parts = tables["handles"].to_pylist(), (
        ("vertex", "x", "y", "z", "height", "rank"), ("change", "side", "operation", "branches"),
        ("index",), ("persistence", "pair"), ("piece", "slab", "block", "contours_below", "contours_above"),
    )  # fmt: skip
    (a, b), keys = choice.sample(range(len(rows)), 2), choice.choice(parts)
    one, two = ({key: rows[k][key] for key in keys} for k in (a, b))
    return None if one == two else alter(tables, "handles", lambda rows: (rows[a].update(two), rows[b].update(one)))


LIES = (swap_contours, swap_links, turn_contour, delete_contour, shift_level, alter_genus, swap_handles)
