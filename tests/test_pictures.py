"""The still picture: rasteriser, flat layout, strokes and the whole."""

import io

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from scipy.ndimage import label

import certify
import draw
import solids
from pipeline import run_stages
from reebslice.drawing.canvas import SIDES, draw_lines, draw_marks, draw_segments, encode_png, new_canvas
from reebslice.drawing.flat import list_ticks
from reebslice.drawing.lane_orders import count_crossings, order_lanes
from reebslice.drawing.layout import place_graph, trace_arc
from reebslice.drawing.marks import MARKS
from reebslice.drawing.model import read_graph
from reebslice.drawing.normals import corner_normals, find_vertex_normals
from reebslice.drawing.picture import Body, draw_model
from reebslice.drawing.rasters import rasterize_mesh, widest_azimuth
from reebslice.drawing.shading import shade_layers
from reebslice.drawing.titles import Title
from reebslice.drawing.views import fit_view, project_points, view_axes
from reebslice.formats.graphml import Graph


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
    image = shade_layers(layers, 0.1, 2)
    assert image.shape == (100, 100, 3) and image.dtype == np.uint8
    assert (image[0, 0] == 255).all() and (image[50, 50] < 255).all()
    assert (image.min(axis=2) < 255).mean() == pytest.approx(np.pi / 4, abs=0.02)


def slow_corner_normals(points, faces, crease):
    cross = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    area = np.linalg.norm(cross, axis=1)
    normal = cross / np.maximum(area, 1e-300)[:, None]
    corners = np.repeat(normal[:, None], 3, axis=1)
    for f, face in enumerate(faces):
        for i, v in enumerate(face):
            around = np.flatnonzero((faces == v).any(axis=1))
            alike = around[normal[around] @ normal[f] >= np.cos(np.radians(crease))]
            if area[f] > 0 and len(around) <= 64:
                mean = area[alike] @ normal[alike]
                corners[f, i] = mean / np.linalg.norm(mean)
    return corners


@pytest.mark.parametrize("flat", [1.0, 0.3, 0.02])
def test_normals_are_smooth_but_across_creases(flat):
    random = np.random.default_rng(1)
    crumpled = np.round(random.random((60, 3)) * 6), np.array([random.permutation(60)[:3] for _ in range(200)])
    crumpled[1][:70, 0] = 0  # a fan of many faces
    ball, box = solids.icosphere(2), solids.cube()
    for points, faces in (crumpled, (ball.points, ball.faces), (box.points, box.faces)):
        points, faces = points * [1, 1, flat], np.array(faces, np.int32)
        normals = find_vertex_normals(points, faces, 40.0)
        found = [corner_normals(points, faces, f, normals, np.empty((3, 3))) for f in range(len(faces))]
        assert np.array(found) == pytest.approx(slow_corner_normals(points, faces, 40.0), abs=1e-6)


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


def blacken(canvas):
    """How many pixels the black strokes on a white canvas fill, partly filled ones by their parts."""
    return (255 - canvas.image[:, :, 0].astype(float)).sum() / 255


@pytest.mark.parametrize("width, end", [(5.0, (80, 40)), (1.0, (15, 70)), (0.4, (80, 11)), (2.0, (80, 10))])
def test_a_line_fills_what_it_covers(width, end):
    canvas = new_canvas(100, 100, 2.0)
    draw_lines(canvas, [np.array([(10, 10), end], float)], np.zeros(3), width / 2)
    covered = width * np.hypot(end[0] - 10, end[1] - 10) + np.pi * width**2 / 4
    assert blacken(canvas) == pytest.approx(covered, rel=0.08)


def test_crossing_segments_of_a_group_are_drawn_once():
    once, twice = new_canvas(40, 40, 1.0), new_canvas(40, 40, 1.0)
    cross = np.array([[5, 5, 35, 35], [35, 5, 5, 35.0]])
    draw_segments(once, [cross], np.zeros(3), 3.0, opacity=0.5)
    draw_segments(twice, [cross[:1], cross[1:]], np.zeros(3), 3.0, opacity=0.5)
    assert once.image[20, 20, 0] == 128 and twice.image[20, 20, 0] == 64
    assert not once.cover.any()


def test_a_line_may_run_out_of_the_picture():
    canvas = new_canvas(20, 10, 1.0)
    draw_lines(canvas, [np.array([[-30, 5], [50, 5.0]]), np.array([[5, -40], [5, -30.0]])], np.zeros(3), 1.0)
    assert blacken(canvas) == pytest.approx(20, abs=0.2)


@pytest.mark.parametrize("shape, area", {"o": np.pi / 4, "^": 0.5, "v": 0.5, "D": 1, "s": 1}.items())
def test_a_mark_fills_its_shape(shape, area):
    canvas = new_canvas(60, 60, 2.0)
    draw_marks(canvas, [(30.2, 29.7)], shape, 15, np.zeros(3), 0.0, np.zeros(3))
    assert blacken(canvas) == pytest.approx(30**2 * area, rel=0.02)
    tips = np.argwhere(canvas.image[:, :, 0] < 128)[[0, -1], 0]
    upward = np.ptp(np.argwhere(canvas.image[tips[0], :, 0] < 128)) < np.ptp(
        np.argwhere(canvas.image[tips[1], :, 0] < 128)
    )
    assert shape not in "^v" or upward == (shape == "^")
    assert set(SIDES) == {"o", "^", "v", "D", "s"}


def test_png_holds_the_pixels():
    image = np.random.default_rng(0).integers(0, 256, (7, 11, 3), np.uint8)
    assert (np.asarray(Image.open(io.BytesIO(encode_png(image)))) == image).all()


@given(st.floats(-1e7, 1e7), st.floats(-9, 9))
@settings(max_examples=200, deadline=None, derandomize=True)
def test_ticks_are_round_and_their_texts_tell_them(low, power):
    extent = max(10.0**power, 1e-6 * abs(low))
    values, texts = list_ticks(low, low + extent)
    assert 2 <= len(values) <= 10
    assert low - 1e-6 * extent <= values[0] and values[-1] <= low + 1.000001 * extent
    told = np.array([float(text.replace("\u2212", "-")) for text in texts])
    assert told == pytest.approx(values, abs=1e-6 * extent) and len(set(texts)) == len(texts)


NO_POINTS, NO_FACES = np.zeros((0, 3)), np.zeros((0, 3), int)


def draw_graph(graph, points=NO_POINTS, faces=NO_FACES, width=300):
    graph = Graph(dict(graph.nodes(data=True)), list(graph.edges(data=True)))
    return draw_model(Title("m", ["0 faces"], "exact"), Body(points, faces, np.eye(3), []), graph, {}, {"width": width})


def handle(number, height, operation="creation", side="A"):
    return {"handle": number, "x": 0.0, "y": 0.0, "z": height, "height": height, "operation": operation, "side": side}


def count_spots(mask):
    """Connected parts of a mask in the left and the right half of a picture, above its legend."""
    height, width = mask.shape
    above = mask[: int(0.9 * height)]
    return [label(half, np.ones((3, 3)))[1] for half in (above[:, : width // 2], above[:, width // 2 :])]


def test_the_picture_shows_every_node_and_arc_twice():
    graph = nx.MultiGraph()
    for number, (height, operation) in enumerate([(-0.8, "creation"), (0.0, "separation"), (0.8, "union")]):
        graph.add_node(f"h{number}", **handle(number, height, operation))
    for arc, ends in enumerate([("h0", "h1"), ("h1", "h2"), ("h1", "h2")]):
        graph.add_edge(*ends, arc=arc)
    ball = solids.icosphere(1)
    image = draw_graph(graph, ball.points, ball.faces, width=800)
    for operation in ("creation", "separation", "union"):
        colour = [int(MARKS[operation][1][i : i + 2], 16) for i in (1, 3, 5)]
        assert count_spots((image == colour).all(axis=2)) == [1, 1]
    flat = image[:, 460:].max(axis=2) < 128
    rows = [int((0.13 + 0.765 * (1.04 - part) / 1.08) * 480) for part in (0.25, 0.75)]
    assert [label(flat[row])[1] for row in rows] == [1, 2]


def test_a_node_of_several_handles_is_ringed():
    pictures = []
    for count in (1, 3):
        graph = nx.MultiGraph([("h0", "h1")])
        graph.add_node("h0", **handle(0, 0.0), n_handles=count)
        graph.add_node("h1", **handle(1, 1.0, "annihilation", "B"))
        pictures.append(draw_graph(graph, width=800))
    assert count_spots((pictures[0] != pictures[1]).any(axis=2)) == [1, 1]


@pytest.mark.parametrize("count", [0, 1])
def test_an_empty_or_lonely_graph_is_drawn(count):
    graph = nx.MultiGraph()
    graph.add_nodes_from((f"h{i}", handle(i, float(i))) for i in range(count))
    image = draw_graph(graph)
    assert image.shape == (180, 300, 3) and image.min() < 255


def test_the_stage_writes_the_same_picture_twice(tmp_path):
    run_stages(solids.cup(), tmp_path, levels={"distance": 0.1})
    certify.main(tmp_path, tmp_path, {"distance": 0.1, "units": "relative", "feature_size": 0.2, "refine": "exact"})
    pictures = []
    for _ in range(2):
        draw.main(tmp_path, tmp_path, {"width": 400, "azimuth": -60, "elevation": 15, "graph": "auto"})
        pictures.append((tmp_path / "picture.png").read_bytes())
    assert pictures[0] == pictures[1] and pictures[0][:4] == b"\x89PNG"
    graph = nx.read_graphml(tmp_path / "solid.graphml", force_multigraph=True)
    nodes, edges = read_graph(tmp_path / "solid.graphml")
    wanted = ("handle", "x", "y", "z", "height", "side", "operation", "n_handles")
    assert {node: [data[name] for name in wanted] for node, data in nodes.items()} == {
        node: [data[name] for name in wanted] for node, data in graph.nodes(data=True)
    }
    assert sorted((*sorted(ends), data["arc"]) for *ends, data in edges) == sorted(
        (*sorted(ends), data["arc"]) for *ends, data in graph.edges(data=True)
    )
