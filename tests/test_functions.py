"""Reeb graphs of any function on the surface, centrelines, and the stages that write them."""

import json
from dataclasses import replace
from pathlib import Path

import networkx as nx
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import graph_functions
import inspect_mesh
import pipeline
import solids
from corpus.carried_values import describe_values
from corpus.configuration import check_config
from corpus.layout import chosen_stages
from corpus.stages import Rejected
from corpus.storage import read_table
from corpus.surfaces import read_faces, read_points
from reebslice import (
    barycentric_distance,
    geodesic_distance,
    height_mesh,
    surface_reeb_graph,
    value_mesh,
)
from reebslice.certification.functions import certify_function
from reebslice.errors import MeshFormatError, ReebsliceError
from reebslice.formats.vertex_values import read_vertex_values
from reebslice.functions.heights import spread_axes
from reebslice.graphs.function_graphs import graph_function
from reebslice.tilt.choice import rotation_to_vertical

SHAPES = {
    "torus": solids.torus(),
    "knot": solids.trefoil(),
    "plate": solids.plate(3),
    "monkey": solids.monkey_saddle(),
    "shells": solids.hollow_ball(),
    "rings": solids.linked_rings(),
}
GENUS = {"torus": 1, "knot": 1, "plate": 3, "monkey": 0, "shells": 0, "rings": 2}


def certify(solid, values):
    """Nodes and arcs of the graph of values, and the certificate."""
    nodes, arcs = graph_function("f", values, solid.points, solid.faces)
    return nodes, arcs, certify_function(solid.points, solid.faces, values, nodes, arcs)


# The graph of any function


@pytest.mark.parametrize("name", SHAPES)
def test_the_height_as_values_makes_the_graph_of_the_height(name):
    solid = SHAPES[name]
    mesh, lifted = height_mesh(solid.points, solid.faces), value_mesh(solid.points[:, 2], solid.points, solid.faces)
    for one, other in zip(mesh, lifted):
        assert np.array_equal(one, other)
    for one, other in zip(surface_reeb_graph(mesh), surface_reeb_graph(lifted)):
        assert np.array_equal(one, other)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(st.sampled_from(sorted(SHAPES)), st.integers(0, 1000), st.sampled_from([1, 2, 5, 10**6]))
def test_any_values_have_a_graph_with_a_loop_per_genus_that_is_certified(name, seed, steps):
    solid = SHAPES[name]
    values = np.random.default_rng(seed).integers(0, steps, len(solid.points)).astype(float)
    _, _, certificate = certify(solid, values)
    assert certificate["verdict"] == "exact", certificate
    assert certificate["loops"] == certificate["genus"] == GENUS[name]


@settings(deadline=None, max_examples=25, derandomize=True)
@given(st.sampled_from(["torus", "plate", "rings"]), st.integers(0, 1000))
def test_graphs_follow_any_renaming_of_values_and_of_vertices(name, seed):
    """4 f has the graph of f, exp(f) but for multiple saddles, -f as many loops, whatever the order of vertices."""
    solid, random = SHAPES[name], np.random.default_rng(seed)
    values = random.normal(size=len(solid.points))
    graph = surface_reeb_graph(value_mesh(values, solid.points, solid.faces))
    scaled = surface_reeb_graph(value_mesh(4 * values, solid.points, solid.faces))
    assert all(np.array_equal(one, other) for one, other in zip(graph, scaled))
    grown = surface_reeb_graph(value_mesh(np.exp(values), solid.points, solid.faces))
    assert np.array_equal(graph.nodes, grown.nodes) and len(graph.arcs) == len(grown.arcs)
    order = random.permutation(len(values))
    place = np.argsort(order)
    mesh = value_mesh(values[order], solid.points[order], place[solid.faces])
    moved = surface_reeb_graph(mesh)
    assert all(np.array_equal(one, other) for one, other in zip(graph, moved))
    down = surface_reeb_graph(value_mesh(-values, solid.points, solid.faces))
    assert len(down.arcs) - len(down.nodes) == len(graph.arcs) - len(graph.nodes)


def test_a_certificate_sees_what_is_wrong():
    solid = SHAPES["plate"]
    values = np.random.default_rng(5).normal(size=len(solid.points))
    nodes, arcs, certificate = certify(solid, values)
    assert certificate["verdict"] == "exact"

    def failing(nodes=nodes, arcs=arcs, values=values):
        found = certify_function(solid.points, solid.faces, values, nodes, arcs)
        assert found["verdict"] == "uncertified"
        return {name for name, check in found["checks"].items() if not check["holds"]}

    moved = nodes["vertex"].copy()
    moved[[3, 4]] = moved[[4, 3]]
    assert "nodes.order" in failing(nodes | {"vertex": moved})
    assert "nodes.partner" in failing(nodes | {"partner": np.roll(nodes["partner"], 1)})
    assert "nodes.critical" in failing(nodes | {"index": np.where(nodes["index"] == 2, 0, nodes["index"])})
    assert "nodes.value" in failing(values=values + 1)
    few = {name: column[:-1] for name, column in arcs.items()}
    assert "graph.loops" in failing(arcs=few)


def test_a_certificate_sees_arcs_that_are_joined_otherwise():
    """Two arcs over the same heights that exchange their upper ends: all sums stay as they are."""
    solid = SHAPES["plate"]
    values = np.random.default_rng(5).normal(size=len(solid.points))
    nodes, arcs, _ = certify(solid, values)
    tried, seen = 0, 0
    for one in range(len(arcs["arc"])):
        for other in range(one):
            low, high = arcs["source"][[one, other]], arcs["target"][[one, other]]
            kinds = nodes["index"][high]
            if low.max() >= high.min() or low[0] == low[1] or high[0] == high[1] or kinds[0] != kinds[1]:
                continue
            target = arcs["target"].copy()
            target[[one, other]] = target[[other, one]]
            changed = arcs | {"target": target, "upper": nodes["value"][target]}
            pair = nx.MultiGraph(zip(arcs["source"].tolist(), arcs["target"].tolist()))
            swapped = nx.MultiGraph(zip(arcs["source"].tolist(), target.tolist()))
            same = sorted(map(sorted, pair.edges())) == sorted(map(sorted, swapped.edges()))
            verdict = certify_function(solid.points, solid.faces, values, nodes, changed)["verdict"]
            assert (verdict == "exact") == same
            tried, seen = tried + 1, seen + (not same)
            if seen == 25:
                return
    assert seen > 5, tried


@pytest.mark.parametrize(
    "values, sentence",
    [
        ([1.0, 2.0], "values has the shape (2,), but there are 8 points"),
        ([np.nan, *range(7)], "1 values are not finite, the first is values[0] = nan"),
        ([*range(7), np.inf], "the first is values[7] = inf"),
        (["high"] * 8, "give real numbers"),
        ([1j] * 8, "give real numbers"),
        (np.ones((8, 1)), "values has the shape (8, 1)"),
        ([[1], [2, 3]], "rows of unequal length"),
    ],
)
def test_values_that_are_none_are_refused(values, sentence):
    solid = solids.cube()
    with pytest.raises(ReebsliceError) as caught:
        value_mesh(values, solid.points, solid.faces)
    assert sentence in str(caught.value)


def test_points_in_no_face_need_no_value():
    solid = solids.torus()
    points, values = np.vstack([solid.points, [[9, 9, 9]]]), np.append(solid.points[:, 0], np.nan)
    graph = surface_reeb_graph(value_mesh(values, points, solid.faces))
    assert all(
        np.array_equal(one, other)
        for one, other in zip(graph, surface_reeb_graph(value_mesh(values[:-1], solid.points, solid.faces)))
    )
    assert np.isnan(geodesic_distance(points, solid.faces)[-1]) and np.isnan(
        barycentric_distance(points, solid.faces)[-1]
    )


# Functions


def test_distance_from_the_centre_of_mass_is_that_of_the_solid():
    """A box with one face cut finely: the centre of its vertices is elsewhere."""
    solid = solids.box(2, 4, 6, centre=(1.0, 2.0, 3.0))
    expected = np.linalg.norm(solid.points - solid.points.mean(axis=0), axis=1)
    assert barycentric_distance(solid.points, solid.faces) == pytest.approx(expected)
    cone = solids.tetrahedron()
    centre = cone.points.mean(axis=0)
    assert barycentric_distance(cone.points, cone.faces) == pytest.approx(np.linalg.norm(cone.points - centre, axis=1))


@pytest.mark.parametrize("function", [geodesic_distance, barycentric_distance])
def test_functions_do_not_depend_on_order_and_follow_the_model(function):
    solid = solids.trefoil(around=60, across=8)
    points = solid.points + 0.01 * np.random.default_rng(1).normal(size=solid.points.shape)
    values = function(points, solid.faces)
    order = np.random.default_rng(2).permutation(len(points))
    assert np.array_equal(function(points[order], np.argsort(order)[solid.faces][::-1]), values[order])
    turned = 1e3 * points @ solids.rotation(3).T + 50.0
    assert function(turned, solid.faces) == pytest.approx(1e3 * values, abs=1e-5 * 1e3)


def test_every_shell_has_a_tip_of_its_own():
    solid = SHAPES["rings"]
    values = geodesic_distance(solid.points, solid.faces)
    assert (values == 0).sum() == 2 and (values >= 0).all()
    far = solids.unite(solid, solids.move(solids.torus(), [1000.0, 0, 0]))
    assert geodesic_distance(far.points, far.faces)[: len(values)] == pytest.approx(values, rel=1e-6)


def test_geodesic_distance_on_a_long_bar_is_that_of_its_unfolding():
    """From the tip, on an end, the way is straight on two faces that are laid flat; to 3 % of the longest."""
    solid = solids.subdivide(solids.box(10, 1, 1), 4)
    values = geodesic_distance(solid.points, solid.faces)
    tip = solid.points[values.argmin()]
    assert (
        abs(tip[0]) == 5 and np.abs(tip[1:]).max() < 0.1
    )  # near the middle of an end, farther from a corner than corners
    along, exact = np.abs(solid.points[:, 0] - tip[0]), np.full(len(values), np.inf)
    for k, other in ((1, 2), (2, 1)):
        on_side = np.isclose(np.abs(solid.points[:, k]), 0.5)
        flat = np.hypot(along + np.abs(solid.points[:, k] - tip[k]), solid.points[:, other] - tip[other])
        exact[on_side] = np.minimum(exact, flat)[on_side]
    sides = np.isfinite(exact) & (along < 9.9)
    assert np.abs(values - exact)[sides].max() < 0.03 * exact[sides].max()


# Values that a file carries


def write_ply(path, solid, values, name="heat"):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(solid.points)}"]
    lines += [f"property double {word}" for word in ("x", "y", "z", name)]
    lines += [f"element face {len(solid.faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(repr, (*point, value))) for point, value in zip(solid.points.tolist(), values.tolist())]
    path.write_text("\n".join(lines + ["3 " + " ".join(map(str, face)) for face in solid.faces.tolist()]) + "\n")


def test_values_come_from_ply_and_from_parquet(tmp_path):
    solid = solids.permute(solids.torus(), 3)
    values = np.random.default_rng(1).normal(size=len(solid.points))
    write_ply(tmp_path / "ring.ply", solid, values)
    order = np.random.default_rng(2).permutation(len(values))
    assert np.array_equal(read_vertex_values(tmp_path / "ring.ply", "heat", solid.points[order]), values[order])
    with pytest.raises(MeshFormatError, match=r"no property cold that is one number, but x, y, z, heat"):
        read_vertex_values(tmp_path / "ring.ply", "cold", solid.points)
    told = describe_values(tmp_path / "ring.ply")
    assert told["values"] is None
    pq.write_table(pa.table({"cold": -values}), tmp_path / "ring.values.parquet")
    assert np.array_equal(read_vertex_values(tmp_path / "ring.ply", "cold", solid.points), -values)
    assert describe_values(tmp_path / "ring.ply")["values"] is not None
    with pytest.raises(MeshFormatError, match=r"has no column heat, but cold"):
        read_vertex_values(tmp_path / "ring.ply", "heat", solid.points)
    pq.write_table(pa.table({"cold": values[:-1]}), tmp_path / "ring.values.parquet")
    with pytest.raises(MeshFormatError, match=rf"has {len(values) - 1} rows, but the mesh file {len(values)} vertices"):
        read_vertex_values(tmp_path / "ring.ply", "cold", solid.points)
    pipeline.write_off(tmp_path / "other.off", solid)
    with pytest.raises(MeshFormatError, match=r"write them as a column of other\.values\.parquet"):
        read_vertex_values(tmp_path / "other.off", "heat", solid.points)


def test_values_that_no_vertex_can_have_are_refused(tmp_path):
    solid = solids.torus()
    doubled = replace(solid, points=np.vstack([solid.points, solid.points[:1]]))
    values = np.arange(len(doubled.points)) * 1.0
    write_ply(tmp_path / "seam.ply", doubled, values)
    with pytest.raises(MeshFormatError, match="heat has several values at one place, 0 and"):
        read_vertex_values(tmp_path / "seam.ply", "heat", solid.points)
    with pytest.raises(MeshFormatError, match="1 vertices of the surface are at no vertex of the file"):
        read_vertex_values(tmp_path / "seam.ply", "heat", np.vstack([solid.points[1:], [[0.1, 0.2, 0.3]]]))
    write_ply(
        tmp_path / "near.ply", replace(doubled, points=np.vstack([solid.points, solid.points[:1] + 1e-9])), values
    )
    assert np.array_equal(read_vertex_values(tmp_path / "near.ply", "heat", solid.points), values[:-1])
    with pytest.raises(MeshFormatError, match=rf"several values where vertices are merged, 0 and {len(values) - 1} at"):
        read_vertex_values(tmp_path / "near.ply", "heat", solid.points, tolerance=1e-8)
    values[3] = np.inf
    write_ply(tmp_path / "near.ply", doubled, values)
    with pytest.raises(MeshFormatError, match=r"1 values of heat are not finite; the first is inf in row 3 from 0"):
        read_vertex_values(tmp_path / "near.ply", "heat", solid.points)


# Stages


def test_stages_are_off_by_default_and_on_by_their_keys():
    schema = yaml.safe_load((Path(__file__).parents[1] / "workflow/schemas/config.schema.yaml").read_text())
    stages = {"graph_functions", "trace_centrelines"}
    assert not stages & set(chosen_stages(check_config({}, schema)))
    config = check_config({"functions": ["geodesic"], "centrelines": {"find": True}}, schema)
    assert stages <= set(chosen_stages(config))


def write_knot(folder):
    """Leave a knotted tube with values in a folder, inspected."""
    solid = solids.trefoil(around=60, across=8)
    folder.mkdir(exist_ok=True)
    write_ply(folder / "knot.ply", solid, np.random.default_rng(1).normal(size=len(solid.points)))
    options = pipeline.OPTIONS["inspect"] | {"overlaps": "keep", "unit": None}
    inspect_mesh.main(folder / "knot.ply", folder, options)


@pytest.fixture(scope="module")
def knot(tmp_path_factory):
    """The folder of a knotted tube with values, inspected."""
    folder = tmp_path_factory.mktemp("knot")
    write_knot(folder)
    return folder


def test_graphs_of_functions_are_written_with_their_certificates(knot, tmp_path):
    options = {"functions": ["geodesic", "barycentre", "file:heat", "file:cold"], **describe_values(knot / "knot.ply")}
    graph_functions.main(knot, tmp_path, options)
    told = json.loads((tmp_path / "functions.json").read_text())
    assert told["function_verdicts"] == {
        "geodesic": "exact", "barycentre": "exact", "file:heat": "exact", "file:cold": "rejected",
    }  # fmt: skip
    assert "no property cold" in told["functions"]["file:cold"]["reason"]
    values, nodes, arcs = (
        read_table(tmp_path / f"function_{name}.parquet", f"function_{name}") for name in ("values", "nodes", "arcs")
    )
    graph = nx.read_graphml(tmp_path / "functions.graphml", force_multigraph=True)
    assert len(graph) == len(nodes) and graph.number_of_edges() == len(arcs)
    for name in ("geodesic", "barycentre", "file:heat"):
        part = graph.subgraph(node for node, row in graph.nodes(data=True) if row["function"] == name)
        assert part.number_of_edges() - len(part) + nx.number_connected_components(part) == 1
        assert told["functions"][name]["loops"] == 1
        assert values["function"].to_pylist().count(name) == 480


def test_graphs_along_spread_directions_are_those_of_the_model_turned(knot, tmp_path):
    graph_functions.main(knot, tmp_path, {"functions": ["geodesic", "directions:5"]})
    told = json.loads((tmp_path / "functions.json").read_text())
    assert told["function_verdicts"] == {"geodesic": "exact", "directions": "exact"}
    nodes = read_table(tmp_path / "function_nodes.parquet", "function_nodes").to_pandas()
    points, faces = read_points(knot), read_faces(knot)
    for number in range(5):
        up = np.array(told["functions"][f"height:{number}"]["direction"])
        mesh = height_mesh(points, faces, rotation=rotation_to_vertical(up))
        expected = mesh.vertex[surface_reeb_graph(mesh).nodes]
        found = nodes[nodes["function"] == f"height:{number}"]
        assert found["vertex"].tolist() == expected.tolist()
        np.testing.assert_allclose(found["value"], points[found["vertex"]] @ up, rtol=1e-12)
    values = read_table(tmp_path / "function_values.parquet", "function_values")
    assert set(values["function"].to_pylist()) == {"geodesic"}  # a height is a scalar product with its direction


@pytest.mark.parametrize("number", [1, 2, 8, 32, 100])
def test_directions_are_spread_over_the_half_sphere(number):
    axes = spread_axes(number)
    np.testing.assert_allclose(np.linalg.norm(axes, axis=1), 1)
    assert axes[0].tolist() == [0, 0, 1] and (axes[:, 2] > 0).all()
    if number > 1:  # of axes, which have no sign: no two near each other, and no gap
        nearness = np.abs(axes @ axes.T) - 2 * np.eye(number)
        apart = np.arccos(np.clip(nearness.max(axis=1), 0, 1))
        even = np.sqrt(2 * np.pi / number)  # side of a square of as much of the half sphere as each has
        assert 0.5 * even < apart.min() and apart.max() < 1.5 * even


def test_of_a_function_that_cannot_be_had_the_sentence_is_told(knot, tmp_path):
    with pytest.raises(Rejected, match="no graph of the function file:cold: .* no property cold"):
        graph_functions.main(knot, tmp_path, {"functions": ["file:cold"], **describe_values(knot / "knot.ply")})
