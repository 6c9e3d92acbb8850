"""The certificate is sound: what the pipeline makes holds, and whatever is altered is caught."""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.parsers.expat import ExpatError

import networkx as nx
import numpy as np
import pyarrow as pa
import pytest
import shapely

from certify import mesh_lengths
from corpus.code_digest import find_sources
from corpus.storage import read_json, read_table
from pipeline import OPTIONS, TABLES, as_read, run_stages
from reebslice.certification.certificate import certify
from reebslice.certification.graphml import parse_graph
from reebslice.schemas import EVENTS, GRAPHS, PIECE_KINDS, SCHEMAS
from solids import (
    bowl_shape,
    cube,
    cup,
    hollow_ball,
    icosphere,
    linked_rings,
    monkey_saddle,
    move,
    nested_shells,
    overhang,
    plate,
    terrain,
    torus,
    unite,
    winding_voids,
)  # fmt: skip

SIZE = 0.2  # feature size, mesh units


def mixture():
    """A hollow ball, a standing torus, a four-fold saddle and a cup, apart."""
    return unite(
        hollow_ball(),
        move(torus(upright=True), [6, 0, 0.3]),
        move(monkey_saddle(4), [0, 5, 0]),
        move(cup(), [5, 5, 0.2]),
    )


@cache
def results(name):
    """Tables, tilt and graphs that the pipeline makes of a solid."""
    solid, direction, levels = {
        "mixture": (mixture(), [0.1, 0.2, 0.97], {}),
        "coarse": (mixture(), [0.1, 0.2, 0.97], {"refine": "none", "distance": 0.4}),
        "flat": (plate(3, upright=True), [0, 0, 1], {}),
    }[name]
    return run(solid, direction, levels)


def run(solid, direction, levels):
    """Levels at a distance relative to the height and the feature size SIZE, unless all is told."""
    if levels.get("units") != "absolute":
        height = np.ptp(solid.points @ (direction / np.linalg.norm(direction)))
        distance = height * levels.get("distance", OPTIONS["levels"]["distance"])
        levels = levels | {"units": "absolute", "distance": distance, "feature_size": SIZE}
    with TemporaryDirectory() as folder:
        run_stages(solid, folder, tilt={"mode": "direction", "direction": direction}, levels=levels)
        tables = {table: read_table(f"{folder}/{table}.parquet", table) for table in TABLES}
        graphs = {g: nx.read_graphml(f"{folder}/{g}.graphml", force_multigraph=True) for g in GRAPHS}
        return tables, read_json(f"{folder}/tilt.json"), graphs


def certificate(tables, tilt, graphs, feature_size=SIZE, distance=None):
    return certify(tables, tilt, as_read(graphs), feature_size, distance)


def failures(found):
    return [name for name, check in found["checks"].items() if not check["holds"]]


def alter(tables, name, change):
    """The tables with the rows of one of them changed: change(rows) in place."""
    rows = tables[name].to_pylist()
    change(rows)
    return tables | {name: pa.Table.from_pylist(rows, schema=SCHEMAS[name])}


def caught(tables, tilt, graphs):
    found = certificate(tables, tilt, graphs)
    return found["verdict"] == "uncertified" and bool(failures(found))


# --------------------------------------------------------------------------
# What is right holds


@pytest.mark.parametrize("name", ["mixture", "flat"])
def test_a_resolved_model_is_exact(name):
    found = certificate(*results(name))
    assert failures(found) == []
    assert found["verdict"] == "exact"
    assert found["hidden_genus"] == found["compound"] == found["unseen"] == 0


def test_the_figures_of_the_mixture():
    found = certificate(*results("mixture"))
    assert found["euler_characteristic"] == 8 and found["genus"] == 1 and found["voids"] == 1
    assert found["betti_solid"] == [4, 1, 1]
    assert found["loops_surface"] == found["loops_solid"] == 1
    assert found["similarity"]["max"] <= 1


@pytest.mark.parametrize(
    "solid", [cube(1), bowl_shape(), overhang(), linked_rings(), nested_shells(3), monkey_saddle(5), icosphere(2)]
)
@pytest.mark.parametrize("refine", ["exact", "feature", "none"])
def test_what_the_pipeline_makes_holds(solid, refine):
    found = certificate(*run(solid, [0, 0, 1], {"refine": refine}))
    assert failures(found) == []


def test_a_coarse_model_is_not_called_exact():
    assert failures(certificate(*results("coarse"))) == []
    for size, verdict in ((1e-3, "uncertified"), (100.0, "exact_at_feature_size")):
        coarse = {"refine": "none", "units": "absolute", "distance": 3.0, "feature_size": size}
        found = certificate(*run(mixture(), [0.1, 0.2, 0.97], coarse), feature_size=size)
        assert failures(found) == [] and found["verdict"] == verdict


def test_features_that_cancel_inside_a_slab_are_told():
    # two towers 4 high on a slab 5 high, and no level above 4.5
    towers = terrain(np.array([[5, 5, 5, 5, 5], [5, 9, 5, 9, 5], [5, 5, 5, 5, 5]]))
    for size, verdict in ((4.5, "exact_at_feature_size"), (3.5, "uncertified")):
        levels = {"refine": "none", "units": "absolute", "distance": 100.0, "feature_size": size}
        found = certificate(*run(towers, [0, 0, 1], levels), feature_size=size)
        assert (found["compound"], found["cancelled_pairs"], found["cancelled_persistence"]) == (0, 1, 4.0)
        assert failures(found) == [] and found["verdict"] == verdict
    assert certificate(*run(towers, [0, 0, 1], {"refine": "exact", "distance": 1.0}))["verdict"] == "exact"


def test_lengths_are_relative_to_the_height_range():
    tables, tilt, _ = results("flat")
    height = np.ptp(np.stack([tables["vertices"][axis].to_numpy() for axis in "xyz"]), axis=1)[2]
    relative = {"distance": 0.1, "units": "relative", "feature_size": 0.2}
    assert mesh_lengths(tables["vertices"], tilt, relative) == pytest.approx((0.2 * height, 0.1 * height))
    absolute = {"distance": 1.5, "units": "absolute", "feature_size": 3.0}
    assert mesh_lengths(tables["vertices"], tilt, absolute) == (3.0, 1.5)


def test_the_certifier_shares_no_code_with_what_it_certifies():
    scripts = Path(__file__).parents[1] / "workflow" / "scripts"
    library = {path.relative_to(scripts).as_posix() for path in find_sources(scripts / "certify.py")}
    shared = {name for name in library if name.startswith("reebslice/") and "/certification/" not in name}
    assert shared == {
        f"reebslice/{name}.py"
        for name in ("__init__", "corpus_tables", "declarations", "kernels", "schemas", "side_tables", "table_checks")
    }


# --------------------------------------------------------------------------
# What is altered is caught


def another(value, field):
    """A value of the same type that says something else."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return value * 1.001 + 1.3e-3 if value == value else 1.0
    if isinstance(value, bytes):
        curve = shapely.from_wkb(value)
        return shapely.to_wkb(shapely.transform(curve, lambda points: points + [1e-3, 0.0]))
    if isinstance(value, list):
        return value[:-1] if value else [0]
    if isinstance(value, str):
        return (
            {
                **dict.fromkeys(PIECE_KINDS, "compound"),
                "compound": "join",
                "A": "B",
                "B": "A",
                "exact": "proximity",
            }.get(
                value,
                "union" if value in ("continuation", "separation", "creation", "annihilation") else "continuation",
            )
            if value not in EVENTS and value != "union"
            else {"union": "separation"}.get(value, next(e for e in EVENTS if e != value))
        )
    return 0 if pa.types.is_integer(field.type) else 0.5 if pa.types.is_floating(field.type) else "->o"


COLUMNS = [(name, field.name) for name in TABLES for field in SCHEMAS[name]]


@pytest.mark.parametrize("name, column", COLUMNS)
def test_every_column_is_held_against_the_mesh(name, column):
    tables, tilt, graphs = results("mixture")
    row = tables[name].num_rows * 2 // 3

    def change(rows):
        rows[row][column] = another(rows[row][column], SCHEMAS[name].field(column))

    assert caught(alter(tables, name, change), tilt, graphs)


LISTS = [("pieces", "below"), ("pieces", "above")] + [
    ("handles", f"{items}_{end}") for items in ("contours", "regions") for end in ("below", "above")
]


@pytest.mark.parametrize("name, column", LISTS)
def test_lists_are_held_against_the_mesh_in_their_order(name, column):
    tables, tilt, graphs = results("mixture")
    row = next(k for k, members in enumerate(tables[name][column].to_pylist()) if len(members) > 1)
    assert caught(alter(tables, name, lambda rows: rows[row][column].reverse()), tilt, graphs)


@pytest.mark.parametrize("name, column", [("contours", "parent"), ("edges", "handle"), ("levels", "tie_x")])
def test_numbers_for_null_are_caught(name, column):
    tables, tilt, graphs = results("mixture")
    row, number = tables[name][column].to_pylist().index(None), 0.5 if column == "tie_x" else -1
    assert caught(alter(tables, name, lambda rows: rows[row].update({column: number})), tilt, graphs)


@pytest.mark.parametrize("name", list(TABLES))
def test_a_row_too_few_or_too_many_is_caught(name):
    tables, tilt, graphs = results("mixture")
    assert caught(alter(tables, name, lambda rows: rows.pop()), tilt, graphs)
    assert caught(alter(tables, name, lambda rows: rows.append(dict(rows[-1]))), tilt, graphs)


def renumbered(rows, key):
    for place, row in enumerate(rows):
        row[key] = place


def drop_edge(tables):
    def change(rows):
        del rows[len(rows) // 2]
        renumbered(rows, "edge")

    return alter(tables, "edges", change)


def swap_links(tables):
    def change(rows):
        level = next(s for s in {r["slab"] for r in rows} if sum(r["slab"] == s for r in rows) > 1)
        one, two = [r for r in rows if r["slab"] == level][:2]
        one["target"], two["target"] = two["target"], one["target"]
        if one["target"] == two["target"]:
            one["source"], two["source"] = two["source"], one["source"] + 1

    return alter(tables, "edges", change)


def swap_pieces(tables):
    def change(rows):
        one, two = [r for r in rows if r["kind"] == "cylinder" and r["slab"] == 5][:2]
        one["above"], two["above"] = two["above"], one["above"]

    return alter(tables, "pieces", change)


def flip_hole(tables):
    """A hole turned into an outer contour with a region of its own, consistently in two tables."""
    hole = next(r for r in tables["contours"].to_pylist() if r["inner"])

    def change(rows):
        rows[hole["contour"]]["inner"] = False

    return alter(tables, "contours", change)


def give_hole_away(tables):
    """A hole handed to another region of its level, holes of nodes counted anew."""
    rows = tables["contours"].to_pylist()
    hole = next(r for r in rows if r["inner"])
    other = next(r["region"] for r in rows if r["level"] == hole["level"] and r["region"] != hole["region"])
    tables = alter(tables, "contours", lambda rows: rows[hole["contour"]].update(region=other))

    def recount(rows):
        rows[hole["region"]]["n_holes"] -= 1
        rows[other]["n_holes"] += 1

    return alter(tables, "nodes", recount)


def shift_level(tables):
    """A level moved between the same vertices, its contours and nodes with it."""
    by = 1e-4
    tables = alter(tables, "levels", lambda rows: rows[4].update(height=rows[4]["height"] + by))
    for name in ("contours", "nodes"):
        tables = alter(tables, name, lambda rows: [r.update(height=r["height"] + by) for r in rows if r["level"] == 4])
    return tables


def move_handle(tables):
    """A handle moved to a neighbouring vertex, all its columns consistent."""
    vertex = tables["handles"].to_pylist()[3]["vertex"]
    other = tables["vertices"].to_pylist()[vertex + 1]

    def change(rows):
        rows[3].update(vertex=vertex + 1, **other)

    return alter(tables, "handles", change)


def move_node(tables):
    """A node moved out of its region within the plane of its level."""

    def change(rows):
        rows[7]["x"] += 50 * 0.97
        rows[7]["z"] -= 50 * 0.1

    return alter(tables, "nodes", change)


def add_arc(tables):
    def change(rows):
        extra = dict(rows[-1])
        rows.append(extra | {"arc": extra["arc"] + 1})

    return alter(tables, "arcs", change)


def merge_contours(tables):
    """Two contours of one level both anchored on the first."""

    def change(rows):
        one, two = [r for r in rows if r["level"] == 5][:2]
        two.update(lower_vertex=one["lower_vertex"], upper_vertex=one["upper_vertex"])

    return alter(tables, "contours", change)


def turn_surface(tables):
    return alter(tables, "faces", lambda rows: [r.update(b=r["c"], c=r["b"]) for r in rows])


def hide_genus(tables):
    """A compound of genus 1 passed off as a cylinder, Euler characteristic and all."""

    def change(rows):
        row = next(r for r in rows if r["kind"] == "cylinder")
        row.update(genus=1, euler_characteristic=row["euler_characteristic"] - 2, kind="compound")

    return alter(tables, "pieces", change)


def swap_reasons(tables):
    """A uniform level called refined, and the refined one next to it uniform."""

    def change(rows):
        place = next(k for k in range(len(rows) - 1) if {r["why"] for r in rows[k : k + 2]} == {"uniform", "refined"})
        rows[place]["why"], rows[place + 1]["why"] = rows[place + 1]["why"], rows[place]["why"]

    return alter(tables, "levels", change)


def adopt_shell(tables):
    """A body outside of all others put into one of them."""

    def change(rows):
        one, two = [r for r in rows if r["parent"] is None][:2]
        one["parent"] = two["shell"]

    return alter(tables, "shells", change)


def free_shell(tables):
    return alter(tables, "shells", lambda rows: next(r for r in rows if r["void"]).update(parent=None))


def bound_elsewhere(tables):
    """A void's wall said to bound the solid beside it, in both graphs alike."""
    inner = {r["contour"] for r in tables["contours"].to_pylist() if r["inner"]}

    def change(rows):
        wall = next(r for r in rows if r["graph"] == "surface" and r["nodes"][0] in inner)
        other = next(r for r in rows if r["graph"] == "solid" and wall["arc"] not in r["bounds"])
        other["bounds"] = other["bounds"] + [wall["arc"]]
        wall["bounds"] = sorted(wall["bounds"] + [other["arc"]])

    return alter(tables, "arcs", change)


@pytest.mark.parametrize(
    "mutate",
    [swap_reasons, adopt_shell, free_shell, bound_elsewhere,
     drop_edge, swap_links, swap_pieces, flip_hole, give_hole_away, shift_level, move_handle, move_node, add_arc,
     merge_contours, turn_surface, hide_genus],
)  # fmt: skip
def test_consistent_lies_are_caught(mutate):
    tables, tilt, graphs = results("mixture")
    assert caught(mutate(tables), tilt, graphs)


def test_every_other_unfolding_of_a_saddle_is_caught():
    """Of the five upper wedges around the vertex three are split off, and between all copies runs a level."""
    tables, tilt, graphs = run(monkey_saddle(5), [0, 0, 1], {})
    rows = tables["unfoldings"].to_pylist()
    assert certificate(tables, tilt, graphs)["verdict"] == "exact" and len(rows) == 3
    vertex, points = rows[0]["vertex"], np.stack([tables["vertices"][axis].to_numpy() for axis in "xyz"], axis=1)
    faces = np.stack([tables["faces"][corner].to_numpy() for corner in "abc"], axis=1)
    after = dict(
        np.roll(face, -face.tolist().index(vertex))[1:].tolist() for face in faces[(faces == vertex).any(axis=1)]
    )
    upper = {w for w in after if points[w, 2] > points[vertex, 2]}
    wedges = []
    for w in upper - {after[u] for u in upper}:
        first = w
        while after[w] in upper:
            w = after[w]
        wedges.append({"first": first, "last": w})
    assert len(wedges) == 5
    told = [{"first": row["first"], "last": row["last"]} for row in rows]
    for row, wedge in ((row, wedge) for row in range(3) for wedge in wedges if wedge != told[row]):
        other = dict(told[row])

        def trade(rows, row=row, wedge=wedge, other=other):
            for one in rows:  # a wedge that another copy has goes to this one's
                one.update(other if {"first": one["first"], "last": one["last"]} == wedge else {})
            rows[row].update(wedge)

        assert caught(alter(tables, "unfoldings", trade), tilt, graphs)


def test_bounds_of_an_arc_between_two_levels_are_held_against_its_events():
    tables, tilt, graphs = run(winding_voids(), [0.31, 0.23, 0.92], {})
    assert failures(certificate(tables, tilt, graphs)) == []
    arcs = tables["arcs"].to_pylist()
    (solid, wall) = next((r["arc"], r["bounds"][1]) for r in arcs if not r["nodes"] and len(r["bounds"]) > 1)

    def change(rows):
        for graph, arc, other in (("solid", solid, wall), ("surface", wall, solid)):
            row = next(r for r in rows if (r["graph"], r["arc"]) == (graph, arc))
            row["bounds"] = [k for k in row["bounds"] if k != other]

    found = certificate(alter(tables, "arcs", change), tilt, graphs)
    assert "arcs.solid.bounds" in failures(found)


@pytest.mark.parametrize("name", GRAPHS)
def test_every_change_of_a_graph_is_caught(name):
    tables, tilt, graphs = results("mixture")

    def check(change):
        other = graphs[name].copy()
        change(other)
        assert caught(tables, tilt, graphs | {name: other}), change

    edges = list(graphs[name].edges(keys=True, data=True))
    a, b, key, data = edges[len(edges) // 2]
    others = [n for n in graphs[name].nodes if n not in (a, b)]
    check(lambda g: g.remove_edge(a, b, key))
    check(lambda g: g.add_edge(a, b, key="extra", **data))
    check(lambda g: g.remove_node(a))
    check(lambda g: g.add_node("h9999", **g.nodes[a]))

    def move_end(g):
        g.remove_edge(a, b, key)
        g.add_edge(a, others[-1], key=key, **data)

    check(move_end)
    if name != "augmented":
        check(lambda g: (g.remove_edge(a, b, key), g.add_edge(a, b, key="renamed", **data)))
    for attribute in data:
        if attribute != "id":
            check(lambda g, at=attribute: g.edges[a, b, key].update({at: another(data[at], pa.field("", pa.string()))}))
    for attribute, value in graphs[name].nodes[a].items():
        check(
            lambda g, at=attribute, v=value: g.nodes[a].update(
                {at: another(v, pa.field("", pa.string())) if v != "" else "o->"}
            )
        )


@pytest.mark.parametrize("key", ["direction", "rotation", "angle", "margin", "morse", "critical"])
def test_every_figure_of_the_tilt_is_caught(key):
    tables, tilt, graphs = results("mixture")
    value = tilt[key]
    if key == "direction":
        value = [value[0], value[1], -value[2]]
    elif key == "rotation":
        value = (np.array(value)[[1, 0, 2]]).tolist()
    elif key == "critical":
        value = value | {"saddles": value["saddles"] + 1}
    else:
        value = {"proven": "by_sos", "by_sos": "proven"}[value] if key == "morse" else value + 1e-3
    assert caught(tables, tilt | {key: value}, graphs)
    assert caught(tables, {k: v for k, v in tilt.items() if k != key}, graphs)


@pytest.mark.parametrize("name", TABLES)
def test_malformed_tables_fail_a_check_and_raise_nothing(name):
    tables, tilt, graphs = results("mixture")
    assert caught(tables | {name: tables[name].slice(0, 0)}, tilt, graphs)
    assert caught(tables | {name: tables[name].drop_columns(tables[name].column_names[:1])}, tilt, graphs)
    assert caught({n: t for n, t in tables.items() if n != name}, tilt, graphs)


def test_a_missing_graph_or_a_simple_one_fails_a_check():
    tables, tilt, graphs = results("flat")
    assert caught(tables, tilt, {n: g for n, g in graphs.items() if n != "solid"})
    assert caught(tables, tilt, graphs | {"surface": nx.Graph(graphs["surface"])})


@pytest.mark.parametrize("name", GRAPHS)
def test_graphs_are_read_as_networkx_reads_them(name, tmp_path):
    _, _, graphs = results("mixture")
    nx.write_graphml(graphs[name], tmp_path / "graph.graphml", edge_id_from_attribute="id")
    found = parse_graph((tmp_path / "graph.graphml").read_bytes())
    expected = as_read({name: nx.read_graphml(tmp_path / "graph.graphml", force_multigraph=True)})[name]
    assert repr(found) == repr(expected) and len(found.nodes) > 3  # NaN included
    types = [[type(value) for value in data.values()] for graph in (found, expected) for data in graph.nodes.values()]
    assert types[: len(found.nodes)] == types[len(found.nodes) :]


def test_documents_that_are_no_one_undirected_graph_are_refused(tmp_path):
    one = nx.MultiGraph([("a", "b", {"id": "e0", "word": "x < y & z"})])
    nx.write_graphml(one, tmp_path / "graph.graphml", edge_id_from_attribute="id")
    text = (tmp_path / "graph.graphml").read_bytes()
    assert parse_graph(text).edges == [("a", "b", "e0", {"id": "e0", "word": "x < y & z"})]
    for old, new in (
        (b'"undirected"', b'"directed"'),
        (b'<edge source="a"', b'<edge directed="true" source="a"'),
        (b'<node id="b"', b'<node id="a"'),
        (b"</graph>", b'</graph><graph edgedefault="undirected"/>'),
        (b' target="b"', b""),
        (b'<data key="d0"', b'<data key="d7"'),
        (b"</graph>", b'<x:node xmlns:x="http://graphml.graphdrawing.org/xmlns" id="c"/><hyperedge/></graph>'),
        (b"</graph>", b'<y:node xmlns:y="elsewhere" id="c"/></graph>'),
        (b"</graph></graphml>", b""),
    ):
        assert old in text
        with pytest.raises((ValueError, KeyError, ExpatError)):
            parse_graph(text.replace(old, new))


def test_an_element_with_a_prefix_is_read_as_others_read_it(tmp_path):
    nx.write_graphml(nx.MultiGraph([("a", "b", {"id": "e0"})]), tmp_path / "graph.graphml", edge_id_from_attribute="id")
    added = b'<x:node xmlns:x="http://graphml.graphdrawing.org/xmlns" id="c"/></graph>'
    (tmp_path / "graph.graphml").write_bytes((tmp_path / "graph.graphml").read_bytes().replace(b"</graph>", added))
    assert set(nx.read_graphml(tmp_path / "graph.graphml")) == {"a", "b", "c"}
    assert set(parse_graph((tmp_path / "graph.graphml").read_bytes()).nodes) == {"a", "b", "c"}


def test_links_of_a_heuristic_are_not_certified():
    tables, tilt, graphs = results("mixture")
    assert caught(alter(tables, "edges", lambda rows: [r.update(method="similarity") for r in rows]), tilt, graphs)


def test_a_gap_between_levels_is_caught():
    found = certificate(*results("mixture"), distance=1e-3)
    assert failures(found) == ["largest_gap_between_levels"]
