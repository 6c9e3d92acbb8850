"""Outputs that open: the files of a model, read by the programs of others (docs/readers.md)."""

import math
from xml.etree import ElementTree

import igraph
import networkx as nx
import pytest

import solids
from pipeline import run_stages
from reebslice.formats.graphml import TYPES, Graph, graphml_text
from reebslice.schemas import GRAPHS


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
