"""The page of a model, and the scene that it is made of."""

import base64
import hashlib
import html
import io
import itertools
import json
import re
import shutil
import struct
import subprocess
import zlib
from html.parser import HTMLParser
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
import shapely
import trimesh
import yaml
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import certify
import pipeline
import solids
import view
from corpus.code_digest import digest_code, find_sources
from corpus.configuration import check_config
from corpus.layout import chosen_stages
from corpus.storage import read_blocks, read_table
from reebslice import label_faces
from reebslice.drawing import page_model
from reebslice.drawing.arc_routes import route_arcs
from reebslice.drawing.display_mesh import reduce_faces, split_by_label
from reebslice.drawing.embedded_graphs import EmbeddedGraph
from reebslice.drawing.flat_svg import draw_svg
from reebslice.errors import ReebsliceError, TooManyCrossingsError
from reebslice.formats.glb import POINTS, Part, write_glb
from reebslice.graphs.shown_arcs import spread_over_arcs
from reebslice.slicing.tables import contour_curves

SCHEMA = Path(view.__file__).parents[1] / "schemas" / "config.schema.yaml"
DRAWING = Path(view.__file__).parent / "reebslice" / "drawing"
NASTY = "<img src=x onerror=alert(1)> & 'quoted' \"name\""
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
MODELS = {"plate": solids.plate(2), "upright": solids.torus(upright=True), "voids": solids.ball_in_hollow_ball()}


def make_model(folder, solid, **sections):
    """Run the stages up to the certificate in the folder, which is made; return it."""
    folder.mkdir(exist_ok=True)
    sections = {"tilt": {"mode": "auto"}, **sections}
    pipeline.run_stages(solid, folder, **sections)
    certify.main(folder, folder, pipeline.OPTIONS["levels"] | sections.get("levels", {}))
    return folder


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Of each model its folder, with its page."""
    root = tmp_path_factory.mktemp("pages")
    folders = {name: make_model(root / name, solid) for name, solid in MODELS.items()}
    for folder in folders.values():
        view.main(folder, folder, {"faces": 50000})
    return folders


class Scene:
    """A binary glTF file, read by hand: its JSON, and arrays and extras of its parts by name."""

    def __init__(self, data):
        magic, version, length = struct.unpack("<4sII", data[:12])
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack("<I4s", data[12:20])
        assert kind == b"JSON" and size % 4 == 0
        self.json = json.loads(data[20 : 20 + size])
        rest, kind = struct.unpack("<I4s", data[20 + size : 28 + size])
        assert kind == b"BIN\0" and rest % 4 == 0 and 28 + size + rest == len(data)
        self.data = data[28 + size :]
        root, *nodes = self.json["nodes"]
        assert root["children"] == list(range(1, len(nodes) + 1))
        self.up = np.reshape(root["matrix"], (4, 4)).T[:3, :3]
        self.parts, self.extras = {}, {}
        for node in nodes:
            mesh = self.json["meshes"][node["mesh"]]
            (primitive,) = mesh["primitives"]
            arrays = {name: self.read(number) for name, number in primitive["attributes"].items()}
            arrays["POSITION"] = arrays["POSITION"] + node["translation"]
            arrays["indices"] = self.read(primitive["indices"])
            self.parts[node["name"]], self.extras[node["name"]] = arrays, mesh["extras"]

    def read(self, number):
        accessor = self.json["accessors"][number]
        place = self.json["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
        count = accessor["count"] * (3 if accessor["type"] == "VEC3" else 1)
        values = np.frombuffer(self.data, kind, count, place["byteOffset"])
        return values.reshape(-1, 3).astype(float) if accessor["type"] == "VEC3" else values.astype(int)


def read_surface(folder):
    """Points, faces and rotation of the model in the folder."""
    points, faces = (
        np.column_stack([read_table(folder / f"{name}.parquet", name)[axis].to_numpy() for axis in axes])
        for name, axes in (("vertices", "xyz"), ("faces", "abc"))
    )
    return points, faces, np.array(json.loads((folder / "tilt.json").read_text())["rotation"])


# ---------------------------------------------------------------- the scene


@pytest.mark.parametrize("name", MODELS)
def test_the_surface_of_the_scene_is_that_of_the_model_with_the_arcs_of_its_faces(made, name):
    points, faces, rotation = read_surface(made[name])
    scene = Scene((made[name] / "model.glb").read_bytes())
    part = scene.parts["surface"]
    corners = part["indices"].reshape(-1, 3)
    own = {tuple(sorted(map(tuple, points[face].astype("f4").round(4).tolist()))): k for k, face in enumerate(faces)}
    shown = [own[tuple(sorted(map(tuple, part["POSITION"][face].astype("f4").round(4).tolist())))] for face in corners]
    assert sorted(shown) == list(range(len(faces)))
    arcs = part["_ARC"][corners]
    assert (arcs == arcs[:, :1]).all() and (np.diff(arcs[:, 0]) >= 0).all()
    # of an exact model the arcs of both graphs are the same, by other numbers: those of the events at their ends
    table = [row for row in read_table(made[name] / "arcs.parquet", "arcs").to_pylist() if row["graph"] == "surface"]
    exact = read_table(made[name] / "critical_arcs.parquet", "critical_arcs").to_pylist()
    handle = read_table(made[name] / "critical_points.parquet", "critical_points")["handle"].to_pylist()
    pairs = set(zip(arcs[:, 0].tolist(), label_faces(points, faces, rotation)[shown].tolist()))
    assert len(pairs) == len(table) == len(exact) == len({a for a, _ in pairs}) == len({b for _, b in pairs})
    for mine, other in pairs:
        ends = handle[exact[other]["source"]], handle[exact[other]["target"]]
        assert (table[mine]["source"], table[mine]["target"]) == ends
    assert np.allclose(scene.up @ np.linalg.inv(rotation) @ [0, 0, 1], [0, 1, 0])  # height is y


@pytest.mark.parametrize("name", MODELS)
def test_trimesh_opens_the_scene_with_its_surface_lines_and_points(made, name):
    opened = trimesh.load(made[name] / "model.glb", force="scene")
    points, faces, rotation = read_surface(made[name])
    kinds = {node: type(opened.geometry[opened.graph[node][1]]) for node in opened.graph.nodes_geometry}
    assert kinds["surface"] is trimesh.Trimesh and kinds["contours"] is trimesh.path.Path3D
    assert kinds["solid nodes"] is trimesh.PointCloud and kinds["solid arcs"] is trimesh.path.Path3D
    matrix, geometry = opened.graph["surface"]
    surface = opened.geometry[geometry].copy().apply_transform(matrix)
    surface.merge_vertices()
    heights = points @ rotation[2]
    assert np.allclose(surface.bounds[:, 1], [heights.min(), heights.max()], atol=1e-5)
    whole = trimesh.Trimesh(points, faces)
    assert surface.is_watertight and np.isclose(surface.volume, whole.volume, rtol=1e-4)


@pytest.mark.parametrize("name", MODELS)
def test_contours_of_the_scene_are_those_of_the_table_within_what_the_page_tells(made, name):
    scene, folder = Scene((made[name] / "model.glb").read_bytes()), made[name]
    part, told = scene.parts["contours"], scene.extras["contours"]
    table = read_table(folder / "contours.parquet", "contours", without=("geometry",))
    points, start = contour_curves(table, read_blocks(folder / "contours.parquet", "contours", "geometry"))
    tilted = part["POSITION"] @ read_surface(folder)[2].T
    heights = dict(zip(told["levels"], told["heights"]))
    size = np.ptp(tilted, axis=0).max()
    assert told["contours"] == table["contour"].to_pylist()
    for k, contour in enumerate(told["contours"]):
        own = tilted[part["_CONTOUR"] == contour]
        assert np.allclose(own[:, 2], heights[told["level"][k]], atol=1e-5 * size)
        drawn, whole = shapely.LineString(own[:, :2]), shapely.LineString(points[start[contour] : start[contour + 1]])
        assert drawn.hausdorff_distance(whole) <= 1.1 * size / 3000
        assert (
            bool(told["inner"][k]) == table["inner"][contour].as_py()
            and told["region"][k] == table["region"][contour].as_py()
        )
    ends = part["indices"].reshape(-1, 2)
    assert (part["_CONTOUR"][ends[:, 0]] == part["_CONTOUR"][ends[:, 1]]).all()
    arcs = [row for row in read_table(folder / "arcs.parquet", "arcs").to_pylist() if row["graph"] == "surface"]
    assert {c: row["arc"] for row in arcs for c in row["nodes"]} == dict(zip(told["contours"], told["arc"]))


@pytest.mark.parametrize("name", MODELS)
def test_graphs_of_the_scene_are_those_of_the_files(made, name):
    scene = Scene((made[name] / "model.glb").read_bytes())
    for which in ("solid", "surface", "solid_simplified", "surface_simplified"):
        graph = nx.read_graphml(made[name] / f"{which}.graphml", force_multigraph=True)
        nodes, arcs = scene.extras[f"{which} nodes"]["nodes"], scene.extras[f"{which} arcs"]["arcs"]
        assert {node["name"]: node["height"] for node in nodes} == dict(graph.nodes("height"))
        found = sorted((*sorted(nodes[k]["name"] for k in arc["ends"]), arc["arc"]) for arc in arcs)
        assert found == sorted((*sorted(ends), arc) for *ends, arc in graph.edges(data="arc"))
        assert all(nodes[low]["height"] <= nodes[high]["height"] for low, high in (arc["ends"] for arc in arcs))
        part, spots = scene.parts[f"{which} arcs"], scene.parts[f"{which} nodes"]["POSITION"]
        for k, arc in enumerate(arcs):
            path = part["POSITION"][part["_ARC"] == k]
            assert np.allclose(path[[0, -1]], spots[arc["ends"]], atol=1e-5)
        vertices = scene.parts[f"{which} leaders"]["POSITION"][len(spots) :]
        handles = read_table(made[name] / "handles.parquet", "handles").to_pylist()
        wanted = [[handles[node["handle"]][axis] for axis in "xyz"] for node in nodes]
        assert np.allclose(vertices, wanted, atol=1e-5)
        if which.startswith("solid"):
            assert np.allclose(spots, [[node[axis] for axis in "xyz"] for node in nodes], atol=1e-5)
    rows = {
        row["arc"]: row
        for row in read_table(made[name] / "arcs.parquet", "arcs").to_pylist()
        if row["graph"] == "solid"
    }
    assert all(arc["surface"] == rows[arc["arc"]]["bounds"] for arc in scene.extras["solid arcs"]["arcs"])


def test_loops_and_pockets_have_their_places(made):
    scene = Scene((made["plate"] / "model.glb").read_bytes())
    loops = scene.extras["loop circles"]["loops"]
    assert [loop["kind"] for loop in loops] == ["tunnel", "tunnel"]
    circle = scene.parts["loop circles"]
    for k, loop in enumerate(loops):
        lines = circle["POSITION"][circle["indices"].reshape(-1, 2)]
        own = lines[circle["_LOOP"][circle["indices"][::2]] == k]
        assert np.isclose(np.linalg.norm(own[:, 1] - own[:, 0], axis=1).sum(), loop["perimeter"], rtol=1e-4)
    assert "loop circles" not in Scene((made["voids"] / "model.glb").read_bytes()).parts
    pockets = Scene((made["voids"] / "model.glb").read_bytes())
    (sealed,) = pockets.extras["pockets"]["pockets"]
    assert sealed["kind"] == "sealed"
    part = pockets.parts["pockets"]
    body = trimesh.Trimesh(part["POSITION"], part["indices"].reshape(-1, 3))
    assert np.isclose(body.volume, sealed["volume"], rtol=1e-3)


def test_ids_beyond_single_precision_are_refused():
    part = Part("p", POINTS, np.zeros((2, 3)), [0, 1], {"arc": np.array([0, 1 << 25])}, (0, 0, 0, 1), {})
    with pytest.raises(ReebsliceError, match="33554432 is more than"):
        write_glb([part], np.eye(3), np.zeros(3), {})


# ---------------------------------------------------------------- labels, routes, decimation


@st.composite
def multigraphs(draw):
    count = draw(st.integers(2, 8))
    pair = st.tuples(st.integers(0, count - 1), st.integers(0, count - 1)).filter(lambda ends: ends[0] != ends[1])
    return np.array(draw(st.lists(pair.map(sorted), min_size=1, max_size=14)))


@given(multigraphs(), st.data())
def test_a_label_spreads_to_the_arcs_that_are_nearest(ends, data):
    label = np.array(data.draw(st.lists(st.integers(-1, 3), min_size=len(ends), max_size=len(ends))), np.int32)
    spread = spread_over_arcs(ends, label)
    line = nx.Graph()
    line.add_nodes_from(range(len(ends)))
    line.add_edges_from((a, b) for a in range(len(ends)) for b in range(a) if set(ends[a]) & set(ends[b]))
    for arc in range(len(ends)):
        away = nx.single_source_shortest_path_length(line, arc)
        near = {other: away[other] for other in away if label[other] >= 0}
        least = {label[other] for other in near if near[other] == min(near.values())}
        assert spread[arc] == min(least, default=-1)


@given(multigraphs(), st.data())
def test_routes_rise_where_any_way_does_and_every_arc_has_one_owner(ends, data):
    count = ends.max() + 1
    pairs = np.array([sorted(data.draw(st.permutations(range(count)))[:2]) for _ in range(3)])
    routes, owner = route_arcs(ends, np.ones(len(ends)), pairs)
    rising, plain = nx.MultiDiGraph(ends.tolist()), nx.MultiGraph(ends.tolist())
    for (low, high), route in zip(pairs.tolist(), routes):
        known = low in plain and high in plain
        if not known or not nx.has_path(plain, low, high):
            assert route == []
            continue
        at = low
        for arc in route:
            assert at in ends[arc]
            at = int(ends[arc].sum()) - at
        assert at == high
        if nx.has_path(rising, low, high):
            assert all(ends[a][1] == ends[b][0] for a, b in itertools.pairwise(route))
    reached = {arc for route in routes for arc in route}
    assert all(owner[arc] >= 0 for arc in reached)


def test_two_arcs_of_a_loop_run_on_its_two_sides():
    ends = np.array([[0, 1], [1, 2], [1, 3], [2, 4], [3, 4], [4, 5]])  # a loop from 1 to 4
    routes, owner = route_arcs(ends, np.ones(6), np.array([[0, 1], [1, 4], [1, 4], [4, 5]]))
    assert sorted(map(tuple, routes[1:3])) == [(1, 3), (2, 4)] and len(set(owner)) == 4


def test_a_decimated_surface_keeps_the_arcs_of_its_faces():
    pytest.importorskip("fast_simplification", reason="fast_simplification is not installed")
    mesh = trimesh.creation.torus(3, 1, 200, 100)
    turned = mesh.vertices[:, [0, 2, 1]] * [1, 1, -1]
    labels = label_faces(turned, mesh.faces)
    points, faces, kept = reduce_faces(turned, mesh.faces, labels, 8000)
    assert 7000 < len(faces) <= 8000 and set(kept) == set(labels) == set(range(4))
    middle = points[faces].mean(axis=1)
    reach = 3 * np.linalg.norm(points[faces[:, 0]] - points[faces[:, 1]], axis=1).max()
    for arc in range(4):
        own = turned[mesh.faces[labels == arc]].reshape(-1, 3)
        inside = (middle[kept == arc] > own.min(axis=0) - reach) & (middle[kept == arc] < own.max(axis=0) + reach)
        assert inside.all()
    again = reduce_faces(turned, mesh.faces, labels, 8000)
    assert all(np.array_equal(a, b) for a, b in zip((points, faces, kept), again))


def test_both_walls_of_a_thin_sheet_keep_their_labels():
    pytest.importorskip("fast_simplification", reason="fast_simplification is not installed")
    sheet = trimesh.creation.box([1, 1, 1e-3])
    for _ in range(5):
        sheet = sheet.subdivide()
    normals = trimesh.Trimesh(sheet.vertices, sheet.faces, process=False).face_normals
    labels = np.sign(normals[:, 2]).astype(int) + 1
    points, faces, kept = reduce_faces(np.array(sheet.vertices), np.array(sheet.faces), labels, 2000)
    shown = trimesh.Trimesh(points, faces, process=False).face_normals[:, 2]
    assert (kept[shown > 0.9] == 2).all() and (kept[shown < -0.9] == 0).all()


def test_faces_in_order_of_their_labels_are_the_same_faces():
    points, faces = MODELS["plate"].points, MODELS["plate"].faces
    labels = np.arange(len(faces)) % 3
    spots, corners, label, order = split_by_label(points, faces, labels)
    assert np.array_equal(spots[corners], points[faces[order]]) and (label[corners] == labels[order][:, None]).all()


# ---------------------------------------------------------------- the page


class Reader(HTMLParser):
    """Elements with their attributes, and the text of some."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.texts, self.open = [], {}, []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        self.open.append(tag)

    def handle_endtag(self, tag):
        self.open = self.open[: len(self.open) - self.open[::-1].index(tag) - 1] if tag in self.open else self.open

    def handle_data(self, data):
        self.texts.setdefault(self.open[-1] if self.open else "", []).append(data)


@pytest.mark.parametrize("name", MODELS)
def test_the_page_loads_nothing_and_runs_only_what_it_brings(made, name):
    text = (made[name] / "view.html").read_text()
    page = Reader(text)
    links = [attrs[key] for _, attrs in page.elements for key in ("src", "href", "data", "action") if key in attrs]
    assert links and all(link.startswith("#") or link == "data:," for link in links)
    assert not [key for _, attrs in page.elements for key in attrs if key.startswith("on") or key == "style"]
    (policy,) = (
        attrs["content"] for tag, attrs in page.elements if attrs.get("http-equiv") == "Content-Security-Policy"
    )
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digests = ["'sha256-" + base64.b64encode(hashlib.sha256(code.encode()).digest()).decode() + "'" for code in scripts]
    assert (
        len(scripts) == 2 and f"script-src {' '.join(digests)};" in policy and policy.startswith("default-src 'none';")
    )
    packed = re.search(r'id="glb">([^<]*)<', text)[1]
    assert zlib.decompress(base64.b64decode(packed)) == (made[name] / "model.glb").read_bytes()
    assert "innerHTML" not in scripts[1] and "eval(" not in scripts[1]


def test_the_library_in_the_page_is_the_pinned_one(made):
    told = (DRAWING / "three.LICENSE.txt").read_text()
    bundled = (DRAWING / "three.min.js").read_bytes()
    assert re.search(r"SHA-256 (\w+)", told)[1] == hashlib.sha256(bundled).hexdigest()
    version = re.search(r"three@([\d.]+)", told)[1]
    assert f'"{version.split(".")[1]}"' in bundled.decode() and bundled.startswith(f"/*! three.js {version}\n".encode())
    page = (made["plate"] / "view.html").read_text()
    assert bundled.decode() in page and told[told.index("The MIT License") :].strip() in page


@pytest.mark.parametrize("name", MODELS)
def test_words_and_tables_tell_what_the_results_do(made, name):
    certificate = json.loads((made[name] / "certificate.json").read_text())
    text = (made[name] / "view.html").read_text()
    words = " ".join(re.findall(r"<li>(.*?)</li>", text)[:6])
    genus, solid, surface = (certificate[key] for key in ("genus", "loops_solid", "loops_surface"))
    loops = f"{solid} loop{'' if solid == 1 else 's'}"
    told = f"genus {genus} = {loops} of the solid + {surface - solid} that only the surface has"
    assert (told if genus else "genus 0: no loops") in words
    assert f"{certificate['voids'] or 'no'} closed void" in words and certificate["verdict"].replace("_", " ") in text
    for which in ("solid", "surface", "solid_simplified", "surface_simplified"):
        graph = nx.read_graphml(made[name] / f"{which}.graphml", force_multigraph=True)
        table = re.search(f'<div class="arcs" data-graph="{which}">(.*?)</div>', text)[1]
        assert table.count("data-arc=") == len(graph.edges)
        drawing = re.search(f'<svg class="flat" data-graph="{which}".*?</svg>', text)[0]
        assert drawing.count("data-arc=") == len(graph.edges) and drawing.count("data-node=") == len(graph.nodes)


def test_nodes_of_the_flat_graph_stand_at_their_heights_and_arcs_end_at_them(made):
    text = (made["upright"] / "view.html").read_text()
    scene = Scene((made["upright"] / "model.glb").read_bytes())
    drawing = re.search('<svg class="flat" data-graph="surface".*?</svg>', text)[0]
    low, high, top, bottom = (
        float(re.search(f'data-{key}="([^"]*)"', drawing)[1]) for key in ("low", "high", "top", "bottom")
    )
    spots = {}
    for spot, number in re.findall(r'transform="translate\(([-\d. ]+)\)[^"]*" data-node="(\d+)"', drawing):
        spots[int(number)] = np.array(spot.split(), float)
    for k, node in enumerate(scene.extras["surface nodes"]["nodes"]):
        assert np.isclose(spots[k][1], bottom - (node["height"] - low) / (high - low) * (bottom - top), atol=0.06)
    for k, arc in enumerate(scene.extras["surface arcs"]["arcs"]):
        path = re.search(f'data-arc="{k}" d="M([-\\d.]+) ([-\\d.]+).*?([-\\d.]+)"', drawing)
        assert np.allclose([float(path[1]), float(path[2])], spots[arc["ends"][0]], atol=0.06)
        assert np.isclose(float(path[3]), spots[arc["ends"][1]][1], atol=0.06)


def test_the_name_of_a_model_is_text_whatever_it_is(made, tmp_path):
    folder = shutil.copytree(made["upright"], tmp_path / NASTY.replace("/", ""))
    view.main(folder, folder, {"faces": 50000})
    page, plain = (Reader((place / "view.html").read_text()) for place in (folder, made["upright"]))
    assert [tag for tag, _ in page.elements] == [tag for tag, _ in plain.elements]
    assert page.texts["h1"][0].strip() == folder.name and page.texts["title"][0].startswith(folder.name)


def test_the_same_results_make_the_same_bytes(made, tmp_path):
    view.main(made["voids"], tmp_path, {"faces": 50000})
    for name in view.OUTPUTS:
        assert (tmp_path / name).read_bytes() == (made["voids"] / name).read_bytes()


@pytest.mark.parametrize("method", ["similarity", "proximity"])
def test_guessed_graphs_have_pages_too_which_say_that_nothing_is_proven(tmp_path, method):
    folder = make_model(tmp_path / method, solids.cup(), edges={"method": method})
    view.main(folder, folder, {"faces": 50000})
    text = (folder / "view.html").read_text()
    assert (
        re.search(r"<p>Not proven: [^<]*Links by a heuristic are not certified", text) and text.count("data-node=") > 4
    )


def test_what_cannot_be_found_is_told_and_the_rest_is_shown(made, tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise TooManyCrossingsError("there are too many")

    for name in ("find_loops", "find_pockets"):
        monkeypatch.setattr(page_model, name, refuse)
    view.main(made["plate"], tmp_path, {"faces": 50000})
    text = (tmp_path / "view.html").read_text()
    assert "No loops are shown: there are too many" in text and "No pockets are shown: there are too many" in text
    assert set(Scene((made["plate"] / "model.glb").read_bytes()).parts) - {"loop circles", "loop paths"} == set(
        Scene((tmp_path / "model.glb").read_bytes()).parts
    )


def test_a_surface_of_more_faces_is_decimated_and_the_page_says_so(made, tmp_path):
    pytest.importorskip("fast_simplification", reason="fast_simplification is not installed")
    folder = make_model(tmp_path / "ball", solids.icosphere(4), levels={"distance": 0.2, "feature_size": 0.4})
    view.main(folder, folder, {"faces": 1000})
    text, scene = (folder / "view.html").read_text(), Scene((folder / "model.glb").read_bytes())
    shown = len(scene.parts["surface"]["indices"]) // 3
    assert 900 < shown <= 1000 and scene.extras["surface"] == {"faces": 5120, "faces_shown": shown}
    assert f"The surface has 5,120 faces; for display only, it is decimated to {shown:,}." in text
    assert "decimated" not in (made["plate"] / "view.html").read_text()


# ---------------------------------------------------------------- the stage


def test_a_changed_template_is_other_code(tmp_path):
    sources = {path.name for path in find_sources(Path(view.__file__))}
    assert {"frame.html", "page.html", "page.css", "page.js", "page_view.js", "three.min.js", "page.py"} <= sources
    assert sources.isdisjoint({"three.LICENSE.txt", "three.entry.js"})  # which the page does not read
    (tmp_path / "stage.py").write_text("import room.words\n")
    (tmp_path / "room").mkdir()
    (tmp_path / "room/words.py").write_text('TEXT = "words.txt"\n')
    digests = set()
    for text in ("a", "b"):
        (tmp_path / "room/words.txt").write_text(text)
        digests.add(digest_code(tmp_path / "stage.py"))
        (tmp_path / "room/other.txt").write_text(text)  # is not named
        digests.add(digest_code(tmp_path / "stage.py"))
    assert len(digests) == 2


def test_pages_can_be_switched_off():
    for pages in (True, False):
        config = check_config({"view": {"pages": pages}}, yaml.safe_load(SCHEMA.read_text()))
        assert ("view" in chosen_stages(config)) == pages


# ---------------------------------------------------------------- in a browser


def browse(*arguments):
    """Run a headless browser on a page: its standard output, and what the page's console says."""
    command = [BROWSER, "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-logging=stderr"]
    done = subprocess.run(
        [*command, "--virtual-time-budget=20000", *arguments], capture_output=True, text=True, check=True, timeout=180
    )
    return done.stdout, re.findall(r"CONSOLE\S*\] (.*)", done.stderr)


SOFTWARE = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_a_browser_shows_the_model_in_space(made, tmp_path):
    page = (made["upright"] / "view.html").as_uri()
    dom, console = browse(*SOFTWARE, "--dump-dom", page)
    assert 'data-ready="yes"' in dom and "<canvas" in dom and console == []
    assert re.search(r'<output id="height">[^<]*contour', dom) and '<p id="nothing" hidden="">' in dom
    browse(*SOFTWARE, "--window-size=1200,900", f"--screenshot={tmp_path / 'page.png'}", page)
    picture = np.asarray(Image.open(io.BytesIO((tmp_path / "page.png").read_bytes())).convert("RGB")).astype(int)
    stage = picture[150:600, 40:600]
    assert (np.ptp(stage, axis=2) > 8).mean() > 0.05  # the surface, bluish, and the slice
    assert (stage.max(axis=2) < 60).sum() > 100  # the arcs


USER = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const lit = () =>
  all("svg.flat:not([hidden]) .lit, .arcs:not([hidden]) tr.lit").map((one) => one.dataset.arc ?? one.dataset.node);
(async () => {
  while (!document.body.dataset.ready) await wait(50);
  const seen = {};
  const note = (name) => { seen[name] = { lit: lit(), told: document.querySelector("#told").innerText }; };
  const drawn = document.querySelector("svg.flat:not([hidden])");
  note("start");
  drawn.querySelector('.hit[data-arc="1"]').dispatchEvent(new PointerEvent("pointerenter"));
  note("flat arc");
  drawn.querySelector('.hit[data-arc="1"]').dispatchEvent(new PointerEvent("pointerleave"));
  note("left");
  document.querySelector('.arcs:not([hidden]) tr[data-arc="2"]').focus();
  note("row");
  drawn.querySelector('[data-node="0"]').dispatchEvent(new MouseEvent("click", { bubbles: true }));
  while (!/copied/.test(document.querySelector("#told").innerText)) await wait(50);
  note("click");
  const canvas = document.querySelector("canvas");
  const box = canvas.getBoundingClientRect();
  const found = {};
  for (let x = 4; x < box.width; x += 10) for (let y = 4; y < box.height; y += 10) {
    canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + x, clientY: box.top + y }));
    found[document.querySelector("#told h3").textContent] = lit();
  }
  seen.space = found;
  document.querySelector("#graph").value = "surface";
  document.querySelector("#graph").dispatchEvent(new Event("change"));
  document.querySelector('svg.flat:not([hidden]) .hit[data-arc="2"]').dispatchEvent(new PointerEvent("pointerenter"));
  note("surface arc");
  drawn.dispatchEvent(new MouseEvent("click", { clientY: drawn.getBoundingClientRect().top + 1 }));
  const slider = document.querySelector("#level");
  slider.value = 0;
  slider.dispatchEvent(new Event("input"));
  seen.level = document.querySelector("#height").value;
  const report = document.createElement("pre");
  report.id = "seen";
  report.textContent = JSON.stringify(seen);
  document.body.append(report);
})();
"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_what_is_pointed_at_is_lit_everywhere_and_a_click_copies(made, tmp_path):
    text = (made["upright"] / "view.html").read_text()
    digest = base64.b64encode(hashlib.sha256(USER.encode()).digest()).decode()
    text = text.replace("script-src ", f"script-src 'sha256-{digest}' ").replace(
        "</body>", f"<script>{USER}</script></body>"
    )
    (tmp_path / "used.html").write_text(text)
    dom, console = browse(*SOFTWARE, "--virtual-time-budget=90000", "--dump-dom", (tmp_path / "used.html").as_uri())
    assert console == []
    seen = json.loads(html.unescape(re.search(r'<pre id="seen">(.*?)</pre>', dom)[1]))
    assert seen["start"]["lit"] == seen["left"]["lit"] == [] and seen["start"]["told"].startswith("Point at")
    assert seen["flat arc"]["lit"] == ["1", "1"] and seen["flat arc"]["told"].startswith("Arc 1 of the solid graph")
    assert seen["row"]["lit"] == ["2", "2"]  # the arc in the drawing, and its row
    scene = Scene((made["upright"] / "model.glb").read_bytes())
    node, arc = scene.extras["solid nodes"]["nodes"][0], scene.extras["surface arcs"]["arcs"][2]
    assert seen["click"]["lit"] == ["0"] and "A: material appears as the height rises" in seen["click"]["told"]
    copied = re.search(r"Vertex(?:, to be)? copied(?: by hand)?: (.*)", seen["click"]["told"])[1]
    assert list(map(float, copied.split())) == [node[axis] for axis in "xyz"]
    arcs = {f"Arc {k} of the solid graph": [str(k)] * 2 for k in range(len(scene.extras["solid arcs"]["arcs"]))}
    assert arcs == {
        name: lit for name, lit in seen["space"].items() if name.startswith("Arc")
    }  # every arc is found in space, and lit in drawing and table
    told = seen["surface arc"]["told"]
    assert told.startswith("Arc 2 of the surface graph") and f"{arc['area']:.5g}"[:5] in told
    assert seen["level"].endswith("1 contour, 1 region")


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_without_webgl_the_page_says_so_and_the_rest_works(made):
    dom, _ = browse("--disable-gpu", "--disable-3d-apis", "--dump-dom", (made["plate"] / "view.html").as_uri())
    assert 'data-ready="yes"' in dom and '<p id="nothing">The model cannot be shown in space here, all else' in dom
    assert re.search(r'<output id="height">[^<]*contour', dom) and dom.count('class="hit"') > 3


@pytest.mark.parametrize("lanes, wide", [(2, False), (40, False), (90, True)])
def test_a_flat_graph_of_many_lanes_is_not_shrunk(lanes, wide):
    nodes = [{"height": 0.0, "operation": "union", "side": "A", "handle": 0}]
    nodes += [{"height": 1.0, "operation": "annihilation", "side": "B", "handle": k} for k in range(1, lanes + 1)]
    ends = np.array([[0, k] for k in range(1, lanes + 1)])
    drawing = draw_svg(
        "solid", EmbeddedGraph(nodes, ends, [], np.zeros((lanes + 1, 3)), [], []), np.arange(lanes + 1.0)
    )
    assert drawing.startswith('<svg class="flat wide"' if wide else '<svg class="flat"')


NARROW = """
(async () => {
  while (!document.body.dataset.ready) await new Promise((done) => setTimeout(done, 50));
  const across = document.documentElement.scrollWidth - innerWidth;
  const seen = { choices: [], flat: find("#flat").scrollLeft, across };
  const choice = find("#graph");
  for (const option of [...choice.options]) {
    choice.value = option.value;
    choice.dispatchEvent(new Event("change"));
    const words = element("span", option.textContent, document.body);
    words.style.font = getComputedStyle(choice).font;
    seen.choices.push([words.getBoundingClientRect().width, choice.clientWidth, find("#graph-words").textContent]);
    words.remove();
  }
  const drawing = all("svg.flat").find((one) => !one.hasAttribute("hidden"));
  find("#flat").style.width = "120px"; // as if the graph had many lanes
  const box = drawing.getBoundingClientRect();
  seen.drawing = [box.width, find("#flat").clientWidth];
  const { top, bottom } = drawing.dataset;
  const share = box.height / drawing.viewBox.baseVal.height;
  for (const row of [+top, +bottom]) { // a click at either end goes to the level there
    const place = { clientX: box.left + 1, clientY: box.top + share * row, bubbles: true };
    drawing.dispatchEvent(new MouseEvent("click", place));
    seen.choices.at(-1).push(Number(find("#level").value));
  }
  seen.last = Number(find("#level").max);
  const [slider, told] = ["#level", "#height"].map((name) => find(name).getBoundingClientRect());
  parent.postMessage(JSON.stringify({ ...seen, slider: [slider.width, slider.bottom, told.top] }), "*");
})();
"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_on_a_phone_choices_are_read_whole_and_nothing_opens_scrolled(made, tmp_path):
    digest = base64.b64encode(hashlib.sha256(NARROW.encode()).digest()).decode()
    text = (made["upright"] / "view.html").read_text().replace("script-src ", f"script-src 'sha256-{digest}' ", 1)
    (tmp_path / "page.html").write_text(text.replace("</body>", f"<script>{NARROW}</script></body>"))
    told = "<script>onmessage = (event) => (document.title = event.data)</script>"
    frame = '<iframe src="page.html" width="390" height="1800" frameborder="0"></iframe>'  # no window is as narrow
    (tmp_path / "phone.html").write_text(f"<title></title>{told}{frame}")
    dom, console = browse(*SOFTWARE, "--dump-dom", (tmp_path / "phone.html").as_uri())
    assert console == []
    seen = json.loads(html.unescape(re.search("<title>(.*?)</title>", dom)[1]))
    assert seen["flat"] == 0 and seen["across"] <= 0
    assert len({choice[2] for choice in seen["choices"]}) == 4
    assert all(wide + 40 < room for wide, room, *_ in seen["choices"])  # with the arrow of the list
    assert seen["choices"][-1][3:] == [seen["last"], 0]
    assert seen["drawing"][0] <= seen["drawing"][1]
    wide, below, above = seen["slider"]
    assert wide > 0.6 * 370 and below <= above  # on a line of its own
