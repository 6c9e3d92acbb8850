"""What a picture shows and says: the graph, labels, scale, elevation, order; and figures as SVG and PDF."""

import re
from xml.etree import ElementTree

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import certify
import draw
import draw_figures
import solids
from corpus.storage import read_blocks, read_table
from pipeline import run_stages
from reebslice.drawing import figures, loops, pockets
from reebslice.drawing.canvas import Words, draw_lines, draw_marks, measure_text, new_canvas, rgb, write_words
from reebslice.drawing.figures import choose_events
from reebslice.drawing.flat import is_crowded, list_ranks
from reebslice.drawing.glass import write_numbers
from reebslice.drawing.labels import scale_bar, spread_labels
from reebslice.drawing.marks import INK, MARKS
from reebslice.drawing.model import READABLE, choose_graph, describe_graph, read_graph
from reebslice.drawing.vectors import encode_vectors
from reebslice.drawing.views import View, choose_elevation, project_points
from reebslice.graphs.loops import find_loops
from test_pictures import NO_POINTS, count_spots, draw_graph, handle

# --------------------------------------------------------------------------
# What is chosen, and words


def test_the_graph_that_can_be_read_is_drawn():
    assert choose_graph("auto", READABLE) == "solid" and choose_graph("auto", READABLE + 1) == "solid_simplified"
    asked = {"solid": "solid", "surface": "surface", "simplified": "solid_simplified"}
    assert {wish: choose_graph(wish, 10**6) for wish in asked} == asked
    told = describe_graph("solid_simplified", 12, 4170, 0.5, "mm")
    assert "simplified" in told and "12 of 4,170 nodes" in told and "0.5\u00a0mm" in told
    assert describe_graph("surface", 12, 4170, 0.5, "mm") == "Reeb graph of the surface, 12 nodes"


@pytest.mark.parametrize("wish", ["solid", "surface", "simplified", "auto"])
def test_each_graph_is_drawn_with_paths_between_its_nodes(wish, tmp_path):
    run_stages(solids.torus(upright=True), tmp_path, levels={"distance": 0.1})
    certify.main(tmp_path, tmp_path, {"distance": 0.1, "units": "relative", "feature_size": 0.2, "refine": "exact"})
    title, body, graph, paths = draw.read_model(tmp_path, wish)
    assert title.graph.split(",")[0] == f"Reeb graph of the {'surface' if wish == 'surface' else 'solid'}"
    assert "genus 1 = 1 loop of the solid + 0 that only the surface has" in title.facts
    assert len(paths) == len(graph.edges) == 4
    for low, high, facts in graph.edges:
        ends = [[graph.nodes[node][axis] for axis in "xyz"] for node in (low, high)]
        path = np.vstack([ends[0], paths[facts["arc"]], ends[1]]) @ body.rotation.T
        assert (np.diff(path[:, 2]) >= -1e-9).all(), "it rises"
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() < 1.5
    if wish != "surface":
        assert any("vertex_x" in node and node["vertex_z"] != node["z"] for node in graph.nodes.values())


@given(st.lists(st.tuples(st.floats(0, 300), st.floats(0, 180)), max_size=60), st.integers(1, 4))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_labels_cover_neither_each_other_nor_marks(spots, digits):
    canvas = new_canvas(300, 180, 1.0)
    words = spread_labels(canvas, ["8" * digits] * len(spots), spots, 6.5, INK)
    half = np.array([measure_text(canvas, "8" * digits, 6.5) / 2, 3.0])
    middles = np.array([line.place for line in words]).reshape(-1, 2)
    apart = np.abs(middles[:, None] - middles[None]) / (2 * half)
    assert (apart.max(axis=2) + 9 * np.eye(len(words)) > 1).all()
    marks = np.array(spots, float).reshape(-1, 2)
    assert ((np.abs(middles[:, None] - marks[None]) / half).max(axis=2) > 1).all()
    assert ((middles - half >= 0) & (middles + half <= [300, 180])).all()
    if len(spots) == 1 and 40 < spots[0][0] < 260 and 30 < spots[0][1] < 150:
        assert len(words) == 1


@given(st.floats(1e-6, 1e6))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_a_scale_bar_is_round_and_fits(scale):
    view = View(np.eye(3), np.zeros(2), scale, 400, 300)
    length = scale_bar(view)
    assert 40 <= length * scale <= 100 * (1 + 1e-9)
    assert f"{length:e}"[0] in "125" and float(f"{length:e}"[1:].split("e")[0]) == 0


def test_flat_parts_are_seen_from_above_and_their_events_in_order():
    assert choose_elevation(np.diag([2.0, 1.0, 1.0])) == 15 and choose_elevation(np.diag([1.0, 2.0, 0.1])) == 60
    assert 15 < choose_elevation(np.diag([1.0, 1.0, 0.3])) < 60 and choose_elevation(NO_POINTS) == 15
    plate = np.array([0, 1e-4, 2e-4, 3e-4, 1 - 2e-4, 1 - 1e-4, 1])
    assert is_crowded(plate, 0.02) and not is_crowded(np.linspace(0, 1, 7), 0.02) and not is_crowded(plate[:3], 0.02)
    values, texts = list_ranks(np.repeat(plate, 2))
    assert values.tolist() == list(range(7)) and texts[1] == "0.0001"
    values, texts = list_ranks(np.arange(100.0))
    assert len(values) == 10 and texts[0] == "0" and texts[-1] == "99"
    graph = nx.MultiGraph()
    for number, height in enumerate(plate):
        graph.add_node(f"h{number}", **handle(number, height, "separation" if number % 2 else "union"))
    graph.add_edges_from((f"h{k}", f"h{k + 1}", {"arc": k}) for k in range(6))
    image = draw_graph(graph, width=800)
    colour = [int(MARKS["union"][1][i : i + 2], 16) for i in (1, 3, 5)]
    assert count_spots((image == colour).all(axis=2))[1] == 4, "of marks at almost one height each can be seen"


# --------------------------------------------------------------------------
# Figures as SVG and PDF


def test_figures_are_drawn_the_same_twice_and_tell_what_the_tables_hold(tmp_path, monkeypatch):
    run_stages(solids.torus(upright=True), tmp_path, levels={"distance": 0.1})
    certify.main(tmp_path, tmp_path, {"distance": 0.1, "units": "relative", "feature_size": 0.2, "refine": "exact"})
    options, drawn = {"width": 400, "azimuth": -60, "elevation": None, "graph": "auto"}, []
    for _ in range(2):
        draw_figures.main(tmp_path, tmp_path, options)
        drawn.append({name: (tmp_path / name).read_bytes() for name in draw_figures.OUTPUTS})
    assert drawn[0] == drawn[1]
    for name, data in drawn[0].items():
        assert data[:5] == b"%PDF-" if name.endswith("pdf") else data[:5] == b"<?xml"
        assert b"matplotlib v" not in data.lower() and str(tmp_path).encode() not in data
    words = {
        name: {node.text.strip() for node in ElementTree.fromstring(data).iter("{http://www.w3.org/2000/svg}text")}
        for name, data in drawn[0].items()
        if name.endswith("svg")
    }
    handles = read_table(tmp_path / "handles.parquet", "handles").to_pylist()
    for row in handles:
        assert f"{row['handle']}  {row['operation']}: {row['index']}-handle" in words["figure_levels.svg"]
    nodes = read_table(tmp_path / "nodes.parquet", "nodes")["critical"].to_pylist()
    assert f"v: {sum(nodes)} material points next to an event" in words["figure_links.svg"]
    assert "Reeb graph of the solid, 4 nodes" in words["figure_graph.svg"]
    contours = read_table(tmp_path / "contours.parquet", "contours", without=("geometry",))
    geometry = read_blocks(tmp_path / "contours.parquet", "contours", "geometry")
    events, count = choose_events(
        read_table(tmp_path / "handles.parquet", "handles"), read_graph(tmp_path / "solid.graphml"), contours, geometry
    )
    assert len(events) == count == len(handles)
    told = "Critical level sets, right below and above each of "
    assert f"{told}{count} events" in words["figure_levels.svg"]
    monkeypatch.setattr(figures, "MOST", 2)
    draw_figures.main(tmp_path, tmp_path, options)
    assert f"{told}the 2 most persistent of {count} events" in (tmp_path / "figure_levels.svg").read_text()
    for row, curves in events:
        assert len(curves) == len(row["contours_below"]) + len(row["contours_above"])
        assert all(abs(curve[0, 2] - row["height"]) < 0.3 * 5.4 for curve in curves)


def test_a_canvas_that_keeps_strokes_draws_none():
    canvas = new_canvas(60, 40, 1.0)._replace(strokes=[])
    draw_lines(canvas, [np.array([[1.0, 1.0], [50.0, 30.0]])], rgb(INK), 2.0)
    draw_marks(canvas, [(20.0, 20.0)], "o", 8, rgb(INK), 1.0)
    write_words(canvas, [Words("word & <sign>", (5, 5), 8, INK)])
    assert (canvas.image == 255).all() and [what for what, _ in canvas.strokes] == ["segments", "marks", "words"]
    assert b"word &amp; &lt;sign&gt;" in encode_vectors(canvas, "svg")


# --------------------------------------------------------------------------
# Numbers in pictures of loops and pockets


def test_numbers_stand_beside_what_they_tell():
    canvas, view = new_canvas(400, 400, 1.0)._replace(strokes=[]), View(np.eye(3), np.zeros(2), 40.0, 400, 400)
    turns = np.linspace(0, 2 * np.pi, 7)[:-1]
    ring = 0.1 * np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
    middles = np.array([[-3, 2, 0], [0, -2.5, 1], [3, 3, 0], [2, -1, 0.5]], float)
    write_numbers(canvas, view, [7, 3, 12, 0], [ring + middle for middle in middles])
    (_, words), spots = canvas.strokes[0], project_points(middles, view)[:, :2]
    assert [line.text for line in words[:4]] == ["7", "3", "12", "0"]
    for line, spot in zip(words, spots):
        distance = np.linalg.norm(spots - line.place, axis=1)
        assert distance.min() == np.linalg.norm(spot - line.place) < 20
    assert words[4].text == "numbers are rows of the table"
    write_numbers(canvas, view, list(range(500)), [ring] * 500)
    assert re.search(r"; no room for 4\d\d$", canvas.strokes[1][1][-1].text)


def test_pockets_and_islands_are_numbered_as_their_tables_are(monkeypatch):
    ball, told = solids.icosphere(1), []
    monkeypatch.setattr(pockets, "write_numbers", lambda canvas, view, numbers, curves: told.append(numbers))
    kinds = ["basin", "bell", "island", "sealed", "island"]
    bodies = [(0.1 * ball.points + [0.3 * k, 0, 0], ball.faces) for k in range(5)]
    pockets.draw_pockets("m", ball.points, ball.faces, bodies, kinds, {"width": 200})
    assert told == [[0, 1, 0, 2, 1]]


def test_paths_of_many_loops_are_not_drawn(monkeypatch):
    ring, notes = solids.torus(), []
    monkeypatch.setattr(loops, "write_numbers", lambda *arguments: notes.append(arguments[-1]))
    found, drawn = find_loops(ring.points, ring.faces), []
    for count in (1, loops.MOST_PATHS + 1):
        many = found._replace(
            kind=np.repeat(found.kind[:1], count),
            circles=[found.circles[0]] * count,
            paths=found.paths._replace(
                start=np.arange(count + 1) * (found.paths.start[1]), member=np.tile(found.paths.member, count)
            ),
        )
        drawn.append(loops.draw_loops("m", ring.points, ring.faces, many, {"width": 200}))
    assert notes[0] == "" and notes[1].endswith("are not drawn") and (drawn[0] != drawn[1]).any()
