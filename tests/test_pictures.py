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
from reebslice.lane_orders import count_crossings, order_lanes
from reebslice.layouts import place_graph, trace_arc
from reebslice.pictures import draw_model
from reebslice.shading import (
    fit_view,
    project_points,
    rasterize_mesh,
    shade_layers,
    shrink_image,
    view_axes,
    widest_azimuth,
)


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


@pytest.mark.parametrize("turn", [0, 45, 90])
def test_a_plate_is_seen_from_its_broad_side(turn):
    plate = np.array([[0, -2, -1], [0, 2, -1], [0, 2, 1], [0, -2, 1.0]]) @ view_axes(turn, 0)[[2, 0, 1]]
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    assert widest_azimuth(plate, faces, 0) % 180 == turn
    assert widest_azimuth(plate, faces[:0], 0) == 0


@st.composite
def graphs(draw):
    """Heights (n,), all different, and the ends (m, 2) of arcs, several between the same nodes at times."""
    n = draw(st.integers(1, 12))
    heights = np.array(draw(st.lists(st.integers(0, 30), min_size=n, max_size=n, unique=True)), float)
    pairs = draw(st.lists(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)), max_size=14))
    ends = np.array([pair for pair in pairs if pair[0] != pair[1]], int).reshape(-1, 2)
    return heights, np.take_along_axis(ends, np.argsort(heights[ends], axis=1), axis=1)


@given(graphs(), st.sampled_from([0.0, 0.8, 2.5]))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_the_flat_layout_keeps_lanes_and_nodes_apart(graph, margin):
    heights, ends = graph
    layout = place_graph(heights, ends[:, 0], ends[:, 1], np.cos(7 * heights), margin)
    long = np.flatnonzero(heights[ends[:, 1]] - heights[ends[:, 0]] >= max(2 * margin, 1e-9))
    for i in long:
        low, high = heights[ends[i]]
        for j in long[long < i]:
            if min(high, heights[ends[j, 1]]) > max(low, heights[ends[j, 0]]):
                assert abs(layout.lanes[i] - layout.lanes[j]) >= 1 - 1e-6
        for node in np.flatnonzero((heights > low - margin) & (heights < high + margin)):
            assert node in ends[i] or abs(layout.nodes[node] - layout.lanes[i]) >= 0.7 - 1e-6
    close = np.abs(heights[:, None] - heights) < max(2 * margin, 1e-9)
    apart = np.abs(layout.nodes[:, None] - layout.nodes)
    assert (apart[close & ~np.eye(len(heights), dtype=bool)] >= 0.7 - 1e-6).all()


@given(graphs())
@settings(max_examples=60, deadline=None, derandomize=True)
def test_a_leaf_stands_on_the_lane_of_its_arc(graph):
    heights, ends = graph
    layout = place_graph(heights, ends[:, 0], ends[:, 1], heights)
    for leaf in np.flatnonzero(np.bincount(ends.ravel(), minlength=len(heights)) == 1):
        assert layout.nodes[leaf] == layout.lanes[(ends == leaf).any(axis=1)][0]


@given(graphs())
@settings(max_examples=60, deadline=None, derandomize=True)
def test_no_single_lane_has_a_better_place(graph):
    heights, ends = graph
    rank = np.argsort(np.argsort(heights))
    order = order_lanes(ends, rank, heights, np.zeros(len(ends), bool)).tolist()
    assert sorted(order) == list(range(len(ends)))
    least = count_crossings(order, ends, rank)
    for lane in range(len(order)):
        rest = [other for other in order if other != lane]
        for place in range(len(order)):
            assert count_crossings(rest[:place] + [lane] + rest[place:], ends, rank) >= least


def test_a_comb_is_drawn_without_crossings():
    teeth = 9  # a spine upward, and at each of its nodes a leg from the bottom
    spine = np.arange(teeth)
    heights = np.r_[10.0 + spine, -1.0 * spine]
    ends = np.r_[np.column_stack([spine[:-1], spine[1:]]), np.column_stack([teeth + spine, spine])]
    rank = np.argsort(np.argsort(heights))
    order = order_lanes(ends, rank, np.cos(5 * np.arange(2 * teeth)), np.zeros(len(ends), bool))
    assert count_crossings(order, ends, rank) == 0


def test_crossings_are_counted_where_a_bend_runs_over_a_lane():
    # Node 1 joins lanes 0 and 2 at height 1, and lane 1 passes there.
    ends, rank = np.array([[0, 1], [2, 3], [1, 4]]), np.array([0, 2, 1, 4, 3])
    assert [count_crossings(order, ends, rank) for order in ([0, 1, 2], [1, 0, 2], [2, 1, 0])] == [1, 0, 1]


def test_arcs_between_the_same_nodes_are_bowed_apart():
    layout = place_graph([0, 1], [0, 0, 0], [1, 1, 1], [0, 0])
    assert np.diff(np.sort(layout.lanes)).min() >= 1 - 1e-9
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


def test_a_node_of_several_handles_is_ringed():
    graph = nx.MultiGraph([("h0", "h1")])
    graph.add_node("h0", **handle(0, 0.0), n_handles=3)
    graph.add_node("h1", **handle(1, 1.0, "annihilation", "B"))
    for axes in draw_graph(graph).axes:
        rings = [line for line in axes.lines if line.get_gid() == "several"]
        assert [len(ring.get_xdata()) for ring in rings] == [1]


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
