"""Distances between models by their graphs, the most alike of each, and the map in the report."""

import itertools
import re

import numpy as np
import pyarrow as pa
import pytest
from gudhi.hera import wasserstein_distance
from hypothesis import given, settings
from hypothesis import strategies as st

import compare_shapes
import describe_shape
import graph_functions
import inspect_mesh
import pipeline
import solids
from corpus.configuration import ConfigError, check_comparison, check_config
from corpus.layout import chosen_stages
from corpus.storage import read_json, read_table, write_json
from reebslice.descriptors.graph_distances import LEAST, compare_diagrams, compare_graphs, share_functions
from reebslice.descriptors.neighbours import distance_table, map_models, neighbour_table
from reebslice.descriptors.surface import describe_surface
from reebslice.drawing.report import Run, make_report
from reebslice.errors import ReebsliceError
from reebslice.graphs.function_graphs import graph_function, stack_tables
from reebslice.schemas import PAIRINGS
from reebslice.table_checks import build_table
from test_pages import BROWSER, browse
from test_report import SCHEMA, make_rows

RUN = Run("data/meshes", None, "", 0, {})
SHAPES = {
    "torus": solids.torus(),
    "knot": solids.trefoil(),
    "plate": solids.plate(3),
    "monkey": solids.monkey_saddle(),
    "rings": solids.linked_rings(),
}


def tables(solid, values, name="f"):
    """The tables of nodes and of arcs of one function."""
    parts = graph_function(name, values, solid.points, solid.faces)
    return tuple(stack_tables(f"function_{kind}", [part]) for kind, part in zip(("nodes", "arcs"), parts))


def random_tables(seed):
    """The same of random values on some solid."""
    random = np.random.default_rng(seed)
    solid = SHAPES[sorted(SHAPES)[seed % len(SHAPES)]]
    return tables(solid, random.normal(size=len(solid.points)) * (np.arange(len(solid.points)) % 7 == 0))


def diagrams(nodes):
    """Of each kind the pairs of a table, in shares of the range of values."""
    rows = nodes.to_pylist()
    low, span = min(row["value"] for row in rows), np.ptp([row["value"] for row in rows])
    found = {kind: [] for kind in PAIRINGS}
    for row in rows:
        pair = [(row["value"] - low) / span, (rows[row["partner"]]["value"] - low) / span]
        if row["node"] < row["partner"] and pair[1] - pair[0] >= LEAST:
            found[row["pairing"]].append(pair)
    return {kind: np.array(pairs).reshape(-1, 2) for kind, pairs in found.items()}


@settings(deadline=None, max_examples=20, derandomize=True)
@given(st.integers(0, 1000), st.integers(0, 1000))
def test_distances_of_diagrams_are_those_of_an_auction(seed, other):
    nodes = [random_tables(seed)[0], random_tables(other)[0]]
    found = compare_diagrams(nodes)
    one, another = map(diagrams, nodes)
    expected = sum(wasserstein_distance(one[kind], another[kind], 1.0, np.inf, 0.001) for kind in PAIRINGS)
    assert found[0, 1] == found[1, 0] == pytest.approx(expected if seed != other else 0, rel=0.002)
    assert found[0, 0] == found[1, 1] == 0


@settings(deadline=None, max_examples=10, derandomize=True)
@given(st.lists(st.integers(0, 1000), min_size=3, max_size=3))
def test_both_distances_keep_the_laws_of_a_distance(seeds):
    nodes, arcs = zip(*map(random_tables, seeds))
    for found in (compare_diagrams(list(nodes)), compare_graphs(list(nodes), list(arcs))):
        assert (found == found.T).all() and (np.diag(found) == 0).all() and (found >= 0).all()
        for a, b, c in itertools.permutations(range(3)):
            assert found[a, b] <= (found[a, c] + found[c, b]) * (1 + 1e-5) + 1e-12


@pytest.mark.parametrize("name", SHAPES)
def test_a_model_in_other_units_and_another_order_is_at_no_distance(name):
    solid = SHAPES[name]
    values = np.random.default_rng(3).permutation(len(solid.points)).astype(float)
    order = np.random.default_rng(4).permutation(len(solid.points))
    renamed = solids.Solid(solid.points[order], np.argsort(order)[solid.faces])
    nodes, arcs = zip(tables(solid, values), tables(renamed, 25.4 * values[order] + 7))
    assert compare_diagrams(list(nodes))[0, 1] < 1e-9
    assert compare_graphs(list(nodes), list(arcs))[0, 1] == 0


def test_graphs_that_differ_in_one_arc_or_upside_down_are_apart():
    solid = SHAPES["plate"]
    values = solid.points[:, 0] + 0.01 * solid.points[:, 1]
    upright, turned = tables(solid, values), tables(solid, -(values**3))
    torus = tables(SHAPES["torus"], SHAPES["torus"].points[:, 0])
    found = compare_graphs(*map(list, zip(upright, turned, torus)))
    assert found[0, 2] > 0.1 and found[1, 2] > 0.1
    one_up = {"source": [0, 1, 1], "target": [1, 2, 3], "lower": [0.0, 1, 1], "upper": [1.0, 2, 3]}
    one_down = {"source": [0, 1, 2], "target": [2, 2, 3], "lower": [0.0, 1, 2], "upper": [2.0, 2, 3]}
    nodes = [hand_made(values) for values in ([0.0, 1, 2, 3], [0.0, 1, 2, 3])]
    arcs = [build_table("function_arcs", {"function": ["f"] * 3, "arc": range(3), **one}) for one in (one_up, one_down)]
    assert compare_graphs(nodes, arcs)[0, 1] > 0.1  # a fork and a join


def hand_made(values):
    """A table of nodes of these values, whose pairs do not matter."""
    count, rest = len(values), dict.fromkeys(("x", "y", "z"), [0.0] * len(values))
    columns = {"function": ["f"] * count, "node": range(count), "vertex": range(count), "rank": range(count)}
    columns |= {"value": values, "index": [0] * count, "partner": range(count), "pairing": ["ordinary"] * count}
    return build_table("function_nodes", {**columns, "persistence": [0.0] * count, **rest})


def test_what_is_no_table_of_nodes_is_refused():
    nodes, arcs = tables(SHAPES["torus"], SHAPES["torus"].points[:, 0])
    for wrong, sentence in (
        ([(nodes, arcs)], "A tuple is given for a model: give a table or a dict with the columns function, value"),
        ([arcs], "give a table or a dict with the columns"),
        ([{**nodes.to_pydict(), "value": np.full(len(nodes), np.nan)}], "Values of a function are not finite"),
    ):
        with pytest.raises(ReebsliceError, match=sentence):
            compare_diagrams(wrong)
    with pytest.raises(ReebsliceError, match="nodes of 1 models and arcs of 2"):
        compare_graphs([nodes], [arcs, arcs])
    with pytest.raises(ReebsliceError, match="has no area"):
        describe_surface(np.zeros((4, 3)), [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], {})


def test_a_model_without_a_function_that_most_have_is_left_out_alone():
    torus = SHAPES["torus"]
    both = pa.concat_tables([tables(torus, torus.points[:, k], name)[0] for k, name in enumerate(("q", "geodesic"))])
    one, odd = tables(torus, torus.points[:, 1], "geodesic")[0], tables(torus, torus.points[:, 1], "rare")[0]
    models, lacking = share_functions({"a": both, "b": one, "c": both, "d": pa.concat_tables([both, odd])})
    assert models == ["a", "c", "d"] and lacking == {"b": ["q"]}
    assert share_functions({}) == ([], {})


def test_heights_alone_compare_nothing():
    solid = SHAPES["torus"]
    nodes = tables(solid, solid.points[:, 2], "height:0")[0]
    with pytest.raises(ReebsliceError, match="no function in common but heights"):
        compare_diagrams([nodes, nodes])


# Tables and map


def test_the_map_keeps_distances_of_a_plane_and_neighbours_are_in_order():
    places = np.random.default_rng(0).normal(size=(12, 2))
    distances = np.linalg.norm(places[:, None] - places, axis=2)
    drawn = map_models(distances)
    np.testing.assert_allclose(np.linalg.norm(drawn[:, None] - drawn, axis=2), distances, atol=1e-9)
    models = [f"m{k:02}" for k in range(12)]
    table = distance_table(models, distances).to_pandas()
    np.testing.assert_array_equal(np.vstack(table["distances"]), distances)
    rows = neighbour_table(models, distances, 3).to_pandas()
    for k, model in enumerate(models):
        own = rows[rows["model"] == model]
        assert own["neighbour"].tolist() == [models[j] for j in np.argsort(distances[k])[1:4]]
        assert own["distance"].is_monotonic_increasing and model not in set(own["neighbour"])


@pytest.mark.parametrize("count", [1, 2])
def test_few_models_have_a_map_as_well(count):
    models, distances = ["a", "b"][:count], (1 - np.eye(2))[:count, :count]
    assert len(distance_table(models, distances)) == count
    assert len(neighbour_table(models, distances, 5)) == count * (count - 1)


# Configuration and stages


def configured(**sections):
    return check_config(sections, SCHEMA)


@pytest.mark.parametrize(
    ("sections", "sentence"),
    [
        ({"descriptors": {"find": True}}, "descriptors.find is true, but functions is empty"),
        ({"similarity": {"find": True}}, "similarity.find is true, but descriptors.find is false"),
        (
            {"similarity": {"find": True, "by": "graphs"}, "functions": ["directions:3"]},
            "similarity.by is 'graphs', but functions names none but heights",
        ),
        ({"functions": ["directions:3", "directions:4"]}, "directions can be spread once"),
    ],
)
def test_what_cannot_be_compared_is_told_at_the_start(sections, sentence):
    with pytest.raises(ConfigError, match=sentence):
        configured(**sections)


def test_more_models_than_can_be_compared_are_refused_at_the_start():
    config = configured(functions=["geodesic"], similarity={"find": True, "by": "diagrams"})
    check_comparison(config, 3000)
    with pytest.raises(ConfigError, match="there are 3001 models: at most 3000 .* more by descriptors"):
        check_comparison(config, 3001)


def test_the_stage_is_chosen_by_its_key():
    assert "describe_shape" not in chosen_stages(configured(functions=["geodesic"]))
    assert "describe_shape" in chosen_stages(configured(functions=["geodesic"], descriptors={"find": True}))


def test_models_are_compared_by_each_way(tmp_path, monkeypatch, capsys):
    for name in ("torus", "knot", "plate"):
        made = tmp_path / name
        made.mkdir()
        pipeline.write_off(made / "model.off", SHAPES[name])
        inspect_mesh.main(made / "model.off", made, pipeline.OPTIONS["inspect"] | {"overlaps": "keep", "unit": None})
        graph_functions.main(made, made, {"functions": ["geodesic", "barycentre", "directions:2"]})
        describe_shape.main(made, made, {})
    described = read_table(tmp_path / "knot" / "descriptors.parquet", "descriptors")
    assert set(described["function"].to_pylist()) == {"", "geodesic", "barycentre", "height"}

    def read_tables(tables, stage, name, all_or_none):
        """Those of the folders, whatever status tables say."""
        return {model: read_table(tmp_path / model / f"{name}.parquet", name) for model in ("knot", "plate", "torus")}

    monkeypatch.setattr(compare_shapes, "read_tables", read_tables)
    monkeypatch.setattr(compare_shapes, "MODELS_FOLDER", tmp_path)
    for by in compare_shapes.WAYS:
        distances, neighbours = compare_shapes.main([], by, False, 1)
        assert distances["model"].to_pylist() == ["knot", "plate", "torus"]
        matrix = np.vstack(distances["distances"].to_pylist())
        assert (matrix == matrix.T).all() and (matrix[~np.eye(3, dtype=bool)] > 0).all()
        assert len(neighbours) == 3
    told = read_json(tmp_path / "plate" / "functions.json")
    told["functions"]["barycentre"]["verdict"] = "uncertified"
    write_json(tmp_path / "plate" / "functions.json", told)
    for by in ("diagrams", "graphs"):  # what is not certified is not compared
        assert compare_shapes.main([], by, False, 1)[0]["model"].to_pylist() == ["knot", "torus"]
        assert (
            "plate is left out of the comparison, as it has no certified graph of barycentre" in capsys.readouterr().out
        )
    monkeypatch.setattr(compare_shapes, "read_tables", lambda *_, **__: {})  # every model was rejected
    for by in compare_shapes.WAYS:
        assert [len(table) for table in compare_shapes.main([], by, by == "descriptors", 3)] == [0, 0]
    monkeypatch.setattr(compare_shapes, "read_tables", read_tables)
    ranked = np.vstack(compare_shapes.main([], "descriptors", True, 1)[0]["distances"].to_pylist())
    assert (ranked == ranked.T).all() and (np.diag(ranked) == 0).all() and ranked.max() <= 1


# The page


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_the_report_shows_a_map_of_models_and_who_is_like_whom(tmp_path):
    rows = make_rows(8)
    accepted = [row["model"] for row in rows if row["status"] == "ok"]
    places = np.array([[k, k * k] for k in range(len(accepted))], float)
    places[1] = places[0]  # a copy
    distances = np.linalg.norm(places[:, None] - places, axis=2)
    likeness = distance_table(accepted, distances), neighbour_table(accepted, distances, 2)
    page = tmp_path / "report.html"
    page.write_text(make_report(pa.Table.from_pylist(rows), [set() for _ in rows], None, RUN, likeness))
    dom, console = browse("--dump-dom", page.as_uri())
    assert console == []
    spots = re.findall(r'<span class="spot[^>]*aria-label="([^"]*)"[^>]*style="left: ([0-9.]+)%; top: ([0-9.]+)%', dom)
    assert [name for name, *_ in spots] == accepted
    assert all(0 <= float(share) <= 100 for _, *both in spots for share in both)
    assert spots[0][1:] == spots[1][1:] and re.findall(r"translate: (\w+)", dom)[:3] == ["0px", "7px", "0px"]
    alike = re.search(r'<div id="alike".*?</ol>', dom)[0].replace("<wbr>", "")
    assert re.findall(r"part_\d{4}(?=</)", alike)[:3] == accepted[:3]
    none = distance_table([], np.zeros((0, 0))), neighbour_table([], np.zeros((0, 0)), 2)
    assert f"{len(accepted)} of 8 models could be compared. " in page.read_text()
    assert 'id="likeness"' not in make_report(pa.Table.from_pylist(rows), [set() for _ in rows], None, RUN, none)
    assert 'id="likeness"' not in make_report(pa.Table.from_pylist(rows), [set() for _ in rows], None, RUN)
