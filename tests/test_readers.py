"""Outputs that open: the files of a model, read by the programs of others (docs/readers.md)."""

import base64
import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree

import geopandas
import igraph
import networkx as nx
import numpy as np
import pandas as pd
import pytest

import certify
import export_model
import solids
from corpus.stages import Rejected
from corpus.storage import content_key
from pipeline import OPTIONS, run_stages
from reebslice.formats.graphml import TYPES, Graph, graphml_text
from reebslice.formats.swc import swc_text
from reebslice.graphs.spanning_trees import span_forest
from reebslice.schemas import GRAPHS

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def torus(tmp_path_factory):
    """A folder of a model whose solid, surface and void have parallel arcs or none."""
    folder = tmp_path_factory.mktemp("readers") / "a & <torus>"
    folder.mkdir()
    run_stages(solids.torus(upright=True), folder, levels={"distance": 0.2})
    return folder


@pytest.fixture(scope="module")
def hollow(tmp_path_factory):
    """A folder of a model that lies, whose void has a loop."""
    folder = tmp_path_factory.mktemp("readers") / "flat"
    folder.mkdir()
    run_stages(solids.torus(upright=False), folder, levels={"distance": 0.2})
    return folder


def same(found, expected):
    """Whether values are equal, and what is not known is NaN in both."""
    return found == expected or (found != found and expected != expected)


def same_rows(found, expected):
    return found.keys() == expected.keys() and all(same(found[name], value) for name, value in expected.items())


# --------------------------------------------------------------------------
# GraphML


def test_graphml_reads_back_as_the_graph_that_it_was(tmp_path):
    words = {"side": "o,o->o & <é>", "none": ""}
    nodes = {f"h{k}": {"height": -1.5e-17 / (k + 1), "index": k, "flag": k > 0} | words for k in range(3)}
    rows = [{"id": f"e{k}", "length": float("nan") if k else 0.1} for k in range(4)]
    graph = Graph(
        nodes, [(*ends, row) for ends, row in zip((("h0", "h1"), ("h1", "h0"), ("h1", "h2"), ("h2", "h2")), rows)]
    )
    (tmp_path / "g.graphml").write_text(graphml_text(graph, "solid", {"model": "a & <b>", "z": 0.5}), encoding="utf-8")
    found, expected = nx.read_graphml(tmp_path / "g.graphml", force_multigraph=True), graph.to_networkx()
    assert dict(found.nodes(data=True)) == dict(expected.nodes(data=True))
    ends = {key: (frozenset((a, b)), row) for a, b, key, row in found.edges(keys=True, data=True)}
    assert ends.keys() == {"e0", "e1", "e2", "e3"}
    assert all(
        ends[k][0] == frozenset((a, b)) and same_rows(ends[k][1], r)
        for a, b, k, r in expected.edges(keys=True, data=True)
    )
    assert found.graph["model"] == "a & <b>" and found.graph["z"] == 0.5


def test_rows_that_differ_in_their_attributes_are_no_graphml():
    for other in ({"x": 1.0}, {"y": 1.0, "x": 1.0}, {"x": 1, "y": 1.0}):
        with pytest.raises(ValueError, match="differ in their attributes"):
            graphml_text(Graph({"a": {"x": 1.0, "y": 2.0}, "b": other}, []), "solid", {})
    with pytest.raises(KeyError):
        graphml_text(Graph({"a": {"x": None}}, []), "solid", {})


@pytest.mark.parametrize("name", GRAPHS)
def test_no_node_or_edge_lacks_an_attribute(torus, name):
    """By the text itself: one key per attribute, a value at every node and edge, spelled as XML Schema has it."""
    root = ElementTree.parse(torus / f"{name}.graphml").getroot()
    keys = {scope: [] for scope in ("graph", "node", "edge")}
    kinds = {}
    for key in root.findall("{*}key"):
        keys[key.get("for")].append(key.get("id"))
        kinds[key.get("id")] = key.get("attr.type")
    (graph,) = root.findall("{*}graph")
    assert graph.attrib == {"id": name, "edgedefault": "undirected"}
    seen = 0
    for scope, elements in (("graph", [graph]), ("node", graph.findall("{*}node")), ("edge", graph.findall("{*}edge"))):
        for element in elements:
            data = element.findall("{*}data")
            assert [value.get("key") for value in data] == keys[scope]
            for value in data:
                spelled = {"string": str, "long": int, "double": float}[kinds[value.get("key")]](value.text or "")
                assert value.text == "NaN" or spelled == spelled
                seen += 1
    assert seen > 20
    assert set(kinds.values()) <= set(TYPES.values())


@pytest.mark.parametrize("name", GRAPHS)
def test_graphs_tell_whose_they_are(torus, name):
    about = nx.read_graphml(torus / f"{name}.graphml").graph
    told = {key: about[key] for key in about if not key.endswith("_default")}
    direction = {"direction_x": 0.0, "direction_y": 0.0, "direction_z": 1.0}
    assert told == {"model": "a & <torus>", "graph": name, **direction, "unit": "", "certificate": "certificate.json"}


@pytest.mark.filterwarnings("ignore:Could not add edge ids")  # it keeps the attribute, as it should
@pytest.mark.parametrize("name", GRAPHS)
def test_igraph_reads_the_same_multigraph(torus, hollow, name):
    path = (hollow if name == "void" else torus) / f"{name}.graphml"
    graph, read = nx.read_graphml(path, force_multigraph=True), igraph.Graph.Read_GraphML(str(path))
    assert not read.is_directed() and read.vs["id"] == list(graph)
    ends = [frozenset(read.vs[end]["id"] for end in edge.tuple) for edge in read.es]
    assert dict(zip(read.es["id"], ends)) == {key: frozenset((a, b)) for a, b, key in graph.edges(keys=True)}
    if name != "augmented":
        assert len(set(ends)) < len(ends), "the two arcs of the loop join the same nodes"
    for node in read.vs:
        assert same_rows(node.attributes(), graph.nodes[node["id"]] | {"id": node["id"]})
    rows = {key: row for *_, key, row in graph.edges(keys=True, data=True)}
    assert all(same_rows(edge.attributes(), rows[edge["id"]]) for edge in read.es)
    assert read["model"] == graph.graph["model"] and math.isclose(read["direction_z"], 1.0)


@pytest.mark.parametrize("name", GRAPHS)
def test_rustworkx_reads_the_same_multigraph(torus, hollow, name):
    import rustworkx

    path = (hollow if name == "void" else torus) / f"{name}.graphml"
    graph, (read,) = nx.read_graphml(path, force_multigraph=True), rustworkx.read_graphml(str(path))
    assert read.attrs["model"] == graph.graph["model"] and read.attrs["id"] == name
    assert isinstance(read, rustworkx.PyGraph) and read.multigraph

    def told(row):  # it takes an empty word for none
        return {key: None if value == "" else value for key, value in row.items()}

    for node in read.nodes():
        assert same_rows(node, told(graph.nodes[node["id"]]) | {"id": node["id"]})
    rows = {key: (frozenset((a, b)), row) for a, b, key, row in graph.edges(keys=True, data=True)}
    for a, b, row in read.weighted_edge_list():
        assert rows[row["id"]][0] == frozenset((read[a]["id"], read[b]["id"]))
        assert same_rows(row, told(rows[row["id"]][1]))
    assert read.num_edges() == graph.number_of_edges() > 0


# --------------------------------------------------------------------------
# What export_model writes


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """Folders of models with everything that is written for other programs: two loops, holes, two bodies and a void."""
    folder = tmp_path_factory.mktemp("exported")
    shapes = {"plate": solids.plate(2, upright=True), "nested": solids.nested_shells(3), "torus": solids.torus()}
    for name, solid in shapes.items():
        (folder / name).mkdir()
        with content_key("key", model=name):
            sections = {"tilt": {"mode": "auto"}, "nodes": {"sampler": "inscribed"}}
            run_stages(solid, folder / name, levels={"distance": 0.1}, **sections)
            certify.main(folder / name, folder / name, OPTIONS["levels"] | {"distance": 0.1})
            export_model.main(folder / name, folder / name, {"method": "exact"})
    return folder


MODELS = pytest.mark.parametrize("model", ["plate", "nested", "torus"])


@MODELS
def test_geopandas_measures_the_regions_as_they_are(exported, model):
    frame = geopandas.read_parquet(exported / model / "regions.parquet")
    nodes = pd.read_parquet(exported / model / "nodes.parquet")
    assert frame.crs is None and frame.geometry.is_valid.all()
    np.testing.assert_allclose(frame.area, nodes["area"], rtol=1e-12)
    assert (frame["area"] == frame.area).all() and (frame["region"] == nodes["region"]).all()
    assert (frame.geometry.count_interior_rings() == frame["n_holes"]).all()
    assert (frame["n_holes"] == nodes["n_holes"]).all() and (frame["level"] == nodes["level"]).all()
    assert frame["n_holes"].max() == {"plate": 0, "nested": 1, "torus": 1}[model]


def test_regions_of_many_models_are_put_together(exported):
    frame = pd.concat(geopandas.read_parquet(path) for path in sorted(exported.glob("*/regions.parquet")))
    assert sorted(frame["model"].unique()) == ["nested", "plate", "torus"]
    assert not frame.duplicated(["model", "region"]).any()


@MODELS
def test_a_tree_and_its_cuts_are_the_graph(exported, model):
    folder = exported / model
    graph = nx.read_graphml(folder / "augmented.graphml", force_multigraph=True)
    lines = (folder / "solid.swc").read_text().splitlines()
    assert lines[:3] == [f"# model: {model}", "# verdict: exact", "# unit: "]
    rows = [line.split() for line in lines[3:]]
    points = {int(n): (float(x), float(y), float(z)) for n, _, x, y, z, _, _ in rows}
    radius = {int(row[0]): float(row[5]) for row in rows}
    parent = {int(row[0]): int(row[6]) for row in rows}
    assert list(points) == list(range(1, len(graph) + 1)) and all(above < n for n, above in parent.items())
    place = {}
    for name, row in graph.nodes(data=True):
        place.setdefault((row["x"], row["y"], row["z"]), []).append(name)
    tree = nx.Graph((n, above) for n, above in parent.items() if above > 0)
    tree.add_nodes_from(points)
    assert nx.is_forest(tree)
    assert nx.number_connected_components(tree) == nx.number_connected_components(graph)
    cuts = json.loads((folder / "solid_cuts.json").read_text())
    loops = graph.number_of_edges() - len(graph) + nx.number_connected_components(graph)
    assert cuts["model"] == model and len(cuts["cuts"]) == loops == {"plate": 2, "nested": 0, "torus": 0}[model]
    for cut in cuts["cuts"]:
        assert graph.has_edge(*cut["nodes"], key=cut["edge"])
        assert [cut["nodes"][k] in place[points[n]] for k, n in enumerate(cut["points"])] == [True, True]
        tree.add_edge(*cut["points"])
    spots = nx.Graph((points[a], points[b]) for a, b in tree.edges)
    same = {name: (row["x"], row["y"], row["z"]) for name, row in graph.nodes(data=True)}
    assert nx.utils.edges_equal(spots.edges, nx.Graph((same[a], same[b]) for a, b, _ in graph.edges).edges)
    nodes = pd.read_parquet(folder / "nodes.parquet").set_index(["x", "y", "z"])["inscribed_radius"]
    known = [nodes.get(points[n], 0.0) == r for n, r in radius.items()]
    assert all(known) and max(radius.values()) == nodes.max()


def test_the_widest_edges_are_kept():
    ends, width = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5]], [1.0, 0.5, 1.0, 1.0, 0.1]
    forest = span_forest(7, ends, width)
    assert forest.order.tolist() == [0, 1, 3, 2, 4, 5, 6] and forest.parent.tolist() == [-1, 0, 0, 2, -1, 4, -1]
    assert forest.cut.tolist() == [1]
    assert [part.tolist() for part in span_forest(0, [], [])] == [[], [], []]
    random = np.random.default_rng(3)
    for _ in range(20):
        graph = nx.gnm_random_graph(12, random.integers(0, 30), seed=int(random.integers(1e6)))
        ends, width = np.array(graph.edges).reshape(-1, 2), random.integers(1, 5, graph.number_of_edges()).astype(float)
        nx.set_edge_attributes(graph, dict(zip(graph.edges, width.tolist())), "w")
        found, best = span_forest(12, ends, width), nx.maximum_spanning_tree(graph, weight="w")
        assert width[np.delete(np.arange(len(ends)), found.cut)].sum() == best.size(weight="w")
        assert sorted(found.order.tolist()) == list(range(12)) and (found.parent < np.arange(12)).all()


def test_of_edges_between_the_same_nodes_the_widest_is_kept():
    forest = span_forest(3, [[0, 1], [1, 0], [1, 2], [2, 0], [1, 2]], [1.0, 3.0, 2.0, 1.0, 2.0])
    assert forest.order.tolist() == [0, 1, 2] and forest.parent.tolist() == [-1, 0, 1]
    assert forest.cut.tolist() == [0, 3, 4]


def test_a_child_before_its_parent_is_no_swc():
    with pytest.raises(ValueError, match="must come before"):
        swc_text(np.zeros((2, 3)), [1, 1], [1, -1], {})


@MODELS
@pytest.mark.parametrize("name", ["solid", "surface"])
def test_arrays_are_the_graph_for_learning(exported, model, name):
    folder = exported / model
    graph = nx.read_graphml(folder / f"{name}.graphml", force_multigraph=True)
    with np.load(folder / f"{name}.npz") as file:  # no objects: nothing is unpickled
        data = dict(file)
    node, index = data["node"].tolist(), data["edge_index"]
    assert index.dtype == np.int64 and index.shape == (2, 2 * graph.number_of_edges())
    assert node == list(graph)
    half = index.shape[1] // 2
    assert (index[:, half:] == index[::-1, :half]).all()
    ends = sorted(tuple(sorted((node[a], node[b]))) for a, b in index[:, :half].T.tolist())
    assert ends == sorted(tuple(sorted(pair)) for pair in graph.edges())
    columns = dict(zip(data["edge_attr_names"].tolist(), data["edge_attr"][:half].T))
    rows = {row["arc"]: row for *_, row in graph.edges(data=True)}
    for arc, lower, upper, a, b in zip(columns["arc"], columns["lower"], columns["upper"], *index[:, :half]):
        assert (rows[arc]["lower"], rows[arc]["upper"]) == (lower, upper)
        assert graph.nodes[node[a]]["height"] == lower and graph.nodes[node[b]]["height"] == upper
    features = dict(zip(data["x_names"].tolist(), data["x"].T))
    for k, row in enumerate(graph.nodes.values()):
        assert data["pos"][k].tolist() == [row["x"], row["y"], row["z"]] and features["index"][k] == row["index"]
        assert features[f"side_{row['side']}"][k] == features[f"operation_{row['operation']}"][k] == 1
    assert np.isfinite(data["x"]).all() and (data["x"].sum(axis=0) != 0).any()
    assert [str(data[key]) for key in ("model", "verdict", "unit", "graph")] == [model, "exact", "", name]
    assert np.isclose(np.linalg.norm(data["direction"]), 1)


@MODELS
def test_poly_data_has_graph_contours_and_surface(exported, model):
    folder = exported / model
    arcs = pd.read_parquet(folder / "arcs.parquet").query("graph == 'solid'")
    lines, cells, points, facts = read_poly_data(folder / "solid.vtp")
    assert facts == {"model": model, "verdict": "exact", "unit": ""}
    assert cells["arc"].tolist() == arcs["arc"].tolist() and [len(line) for line in lines] == [
        len(n) + 2 for n in arcs["nodes"]
    ]
    nodes = pd.read_parquet(folder / "nodes.parquet")
    for line, inside in zip(lines, arcs["nodes"]):
        assert points["MaximumInscribedSphereRadius"][line[1:-1]].tolist() == nodes["inscribed_radius"][inside].tolist()
    lengths = [np.linalg.norm(np.diff(points["Points"][line], axis=0), axis=1).sum() for line in lines]
    np.testing.assert_allclose(lengths, arcs["length"], rtol=1e-12)
    direction = json.loads((folder / "tilt.json").read_text())["direction"]
    contours = pd.read_parquet(folder / "contours.parquet")
    lines, cells, points, _ = read_poly_data(folder / "contours.vtp")
    assert cells["contour"].tolist() == contours["contour"].tolist() and all(line[0] == line[-1] for line in lines)
    lengths = [np.linalg.norm(np.diff(points["Points"][line], axis=0), axis=1).sum() for line in lines]
    np.testing.assert_allclose(lengths, contours["perimeter"], rtol=1e-9)
    heights = [np.ptp(points["Points"][line] @ direction) for line in lines]
    assert max(heights) < 1e-12 and points["Points"][lines[0][0]] @ direction == pytest.approx(contours["height"][0])
    faces, cells, points, _ = read_poly_data(folder / "surface.vtp", "Polys")
    table = pd.read_parquet(folder / "faces.parquet")
    assert np.array_equal(np.array(faces), table[["a", "b", "c"]].to_numpy())
    assert set(cells["solid_arc"]) == set(arcs["arc"]) and len(cells["surface_arc"]) == len(table)
    assert (points["Points"] == pd.read_parquet(folder / "vertices.parquet")[["x", "y", "z"]].to_numpy()).all()


def read_poly_data(path, kind="Lines"):
    """Cells as lists of points, data of cells and of points, and words about the whole, read by hand."""
    root = ElementTree.parse(path).getroot()
    (piece,) = root.iter("Piece")
    kinds = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}

    def numbers(element):
        raw = base64.b64decode(element.text)
        assert int.from_bytes(raw[:8], "little") == len(raw) - 8
        return np.frombuffer(raw[8:], kinds[element.get("type")])

    data = {part: {one.get("Name"): numbers(one) for one in piece.find(part)} for part in ("CellData", kind)}
    points = {one.get("Name"): numbers(one) for one in piece.findall("PointData/*")}
    points["Points"] = numbers(piece.find("Points/DataArray")).reshape(-1, 3)
    facts = {one.get("Name"): bytes(map(int, one.text.split()[:-1])).decode() for one in root.iter("Array")}
    cells = [cell.tolist() for cell in np.split(data[kind]["connectivity"], data[kind]["offsets"][:-1])]
    assert len(cells) == int(piece.get(f"NumberOf{kind}"))
    return cells, data["CellData"], points, facts


def test_what_links_do_not_tell_is_not_exported(tmp_path):
    with pytest.raises(Rejected, match="method: exact"):
        export_model.main(tmp_path, tmp_path, {"method": "similarity"})


def test_the_same_model_makes_the_same_files(exported, tmp_path):
    with content_key("key", model="plate"):
        export_model.main(exported / "plate", tmp_path, {"method": "exact"})
    for name in export_model.OUTPUTS:
        assert (tmp_path / name).read_bytes() == (exported / "plate" / name).read_bytes()


def test_the_versions_that_the_docs_tell_are_those_of_the_script():
    script, page = ((ROOT / path).read_text() for path in ("tests/readers/read_outputs.py", "docs/readers.md"))
    pins = re.findall(r'"(?:@xmldom/)?([\w-]+)(?:==|@)([\d.]+)"', script)
    told = {name: version for name, version in pins if name not in ("xmldom", "networkx")}
    assert len(told) == 10
    for name, version in told.items():
        assert version in page, name
    assert re.search(r'BOOST = "([\d.]+)', script)[1] in page
