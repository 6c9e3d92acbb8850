"""The still picture: rasteriser, flat layout and figure."""

import networkx as nx
import numpy as np
import pytest
import solids
from hypothesis import given, settings
from hypothesis import strategies as st
from pipeline import run_stages

import certify
import draw
from reebslice.layouts import count_crossings, place_graph, trace_arc
from reebslice.pictures import draw_model
from reebslice.shading import fit_view, project_points, rasterize_mesh, shade_layers, shrink_image, view_axes


@pytest.mark.parametrize("azimuth, elevation", [(0, 0), (-60, 15), (123, -40), (0, 90)])
def test_the_view_is_a_rotation_with_height_up(azimuth, elevation):
    axes = view_axes(azimuth, elevation)
    assert axes @ axes.T == pytest.approx(np.eye(3)) and np.linalg.det(axes) == pytest.approx(1)
    assert axes[0, 2] == 0 and axes[1, 2] >= 0


def test_a_square_covers_its_pixels_at_its_depth():
    points = np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1.0]]) + [3, 0, 0]
    view = fit_view(points, 0, 0, 100, 100, margin=0.1)
    layers = rasterize_mesh(points, np.array([[0, 1, 2], [0, 2, 3]]), view)
    seen = layers.depth > -np.inf
    assert seen.sum() == 80 * 80 and seen[10:90, 10:90].all()
    assert layers.depth[seen] == pytest.approx(3) and (layers.winding[seen] == 1).all()


@given(solids.any_solids(), st.floats(-180, 180), st.floats(-80, 80))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_a_closed_surface_has_as_many_fronts_as_backs_everywhere(solid, azimuth, elevation):
    layers = rasterize_mesh(solid.points, solid.faces, fit_view(solid.points, azimuth, elevation, 80, 60))
    assert (layers.winding == 0).all()


def test_a_ball_is_nearest_in_the_middle_and_covers_a_disk():
    ball = solids.icosphere(4)
    layers = rasterize_mesh(ball.points, ball.faces, fit_view(ball.points, 30, 20, 200, 200, margin=0))
    assert layers.depth[100, 100] == pytest.approx(1, abs=0.01)
    assert (layers.depth > -np.inf).mean() == pytest.approx(np.pi / 4, abs=0.01)
    image = shade_layers(layers, 0.1)
    assert (image[0, 0] == 1).all() and (image[100, 100] < 1).all()
    assert shrink_image(image, 2).shape == (100, 100, 3)


def test_projection_puts_what_is_higher_higher():
    points = np.array([[0, 0, 0], [0, 0, 1.0]])
    column, row, _ = project_points(points, fit_view(points, -60, 15, 100, 100)).T
    assert column[0] == pytest.approx(column[1]) and row[1] < row[0]


@given(st.integers(2, 12), st.data())
@settings(max_examples=60, deadline=None, derandomize=True)
def test_the_flat_layout_keeps_lanes_and_nodes_apart(n, data):
    heights = np.array(data.draw(st.lists(st.integers(0, 20), min_size=n, max_size=n, unique=True)), float)
    pairs = data.draw(st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=14))
    ends = np.array([pair for pair in pairs if pair[0] != pair[1]], int).reshape(-1, 2)
    layout = place_graph(heights, ends[:, 0], ends[:, 1], np.zeros(n))
    low, high = np.sort(heights[ends], axis=1).T
    for i in range(len(ends)):
        for j in range(i):
            overlap = min(high[i], high[j]) - max(low[i], low[j])
            if overlap > 0 and not set(ends[i]) & set(ends[j]):
                assert abs(layout.lanes[i] - layout.lanes[j]) >= 1 - 1e-6


def test_arcs_between_the_same_nodes_are_bowed_apart():
    layout = place_graph([0, 1], [0, 0, 0], [1, 1, 1], [0, 0])
    assert np.diff(np.sort(layout.lanes)).min() >= 1 - 1e-9 and layout.crossings == 0
    assert count_crossings(np.arange(3), np.array([[0, 1]] * 3), np.arange(2)) == 0


def test_an_arc_runs_from_node_to_node_on_its_lane():
    curve = trace_arc((0, 0), (4, 10), 2.0, 1.0)
    assert curve[0].tolist() == [0, 0] and curve[-1].tolist() == [4, 10]
    assert (np.diff(curve[:, 1]) >= 0).all()
    assert (curve[(curve[:, 1] >= 1) & (curve[:, 1] <= 9), 0] == 2).all()


def draw_graph(graph, points=np.zeros((0, 3)), faces=np.zeros((0, 3), int)):
    return draw_model("m", ["0 faces"], "exact", points, faces, np.eye(3), graph, {}, [], {"width": 300})


def handle(number, height, operation="creation", side="A"):
    return {"handle": number, "x": 0.0, "y": 0.0, "z": height, "height": height, "operation": operation, "side": side}


def test_the_figure_shows_every_node_and_arc_twice():
    graph = nx.MultiGraph()
    for number, (height, operation) in enumerate([(0.0, "creation"), (1.0, "separation"), (2.0, "union")]):
        graph.add_node(f"h{number}", **handle(number, height, operation))
    for arc, ends in enumerate([("h0", "h1"), ("h1", "h2"), ("h1", "h2")]):
        graph.add_edge(*ends, arc=arc)
    ball = solids.icosphere(1)
    figure = draw_graph(graph, ball.points, ball.faces)
    body, flat = figure.axes
    marks = [line for line in flat.lines if line.get_gid()]
    assert sorted(y for line in marks for y in line.get_ydata()) == [0, 1, 2]
    assert len([line for line in body.lines if line.get_gid() == "arc"]) == 3
    assert len(flat.collections[0].get_segments()) == 3


@pytest.mark.parametrize("count", [0, 1])
def test_an_empty_or_lonely_graph_is_drawn(count):
    graph = nx.MultiGraph()
    graph.add_nodes_from((f"h{i}", handle(i, float(i))) for i in range(count))
    assert len(draw_graph(graph).axes) == 2


def test_the_stage_writes_the_same_picture_twice(tmp_path):
    run_stages(solids.cup(), tmp_path, levels={"distance": 0.1})
    certify.main(tmp_path, tmp_path, {"distance": 0.1, "units": "relative", "feature_size": 0.2, "refine": "exact"})
    pictures = []
    for _ in range(2):
        draw.main(tmp_path, tmp_path, {"width": 400, "azimuth": -60, "elevation": 15})
        pictures.append((tmp_path / "picture.png").read_bytes())
    assert pictures[0] == pictures[1] and pictures[0][:4] == b"\x89PNG"
