"""The solid taken apart at its events, and faces with their arcs."""

import io
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

import colour_faces
import decompose_solid
import label_faces
import pipeline
import solids
from corpus.stages import Rejected
from corpus.storage import read_table
from reebslice import decompose, errors, exact_graphs
from reebslice.graphs.arcs import trace_arcs
from reebslice.graphs.parts import surface_parts
from reebslice.handles.classification import classify_handles
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph
from reebslice.slicing.levels import make_levels
from reebslice.slicing.slices import cut_surface
from reebslice.slicing.tables import contours_table, pieces_table
from test_laws import cases

MESHES = Path(__file__).parent.parent.parent / "shared" / "meshes"
SHAPES = solids.any_solids() | solids.flat_solids() | solids.machined_parts()
EXACT = {"levels": {"refine": "exact", "distance": 0.1}}


def volume(points, faces):
    """Six times the sum of determinants, over six, about a corner."""
    return np.linalg.det((points - points[0])[faces]).sum() / 6


def is_closed_manifold(faces):
    """Whether every mesh edge is in two faces that run along it in opposite directions."""
    tails, heads = (ends.ravel().astype(np.int64) for ends in (faces, np.roll(faces, -1, axis=1)))
    along, back = tails * (faces.max() + 1) + heads, heads * (faces.max() + 1) + tails
    return len(np.unique(along)) == len(along) and np.array_equal(np.sort(along), np.sort(back))


def box(low, high):
    return trimesh.creation.box(bounds=[low, high])


# The solid taken apart


@cases(40)
@given(SHAPES, st.integers(0, 5))
def test_parts_are_closed_lie_between_their_events_and_have_the_volume_of_the_solid(solid, seed):
    rotation = solids.rotation(seed) if seed else np.eye(3)
    bodies = decompose(solid.points, solid.faces, rotation)
    graph = exact_graphs(solid.points, solid.faces, rotation)[1]
    low, high = graph.height[graph.arcs].T
    assert bodies.label.tolist() == np.flatnonzero(low < high).tolist()
    volumes = [volume(*body) for body in zip(bodies.points, bodies.faces)]
    size = np.abs(solid.points).max()
    assert min(volumes) > -1e-12 * size**3
    whole = volume(solid.points, solid.faces)
    assert abs(sum(volumes) - whole) <= 1e-9 * abs(whole)
    for arc, points, faces in zip(bodies.label, bodies.points, bodies.faces):
        assert is_closed_manifold(faces)
        heights = points @ rotation[2]
        assert np.allclose([heights.min(), heights.max()], [low[arc], high[arc]], rtol=0, atol=1e-12 * size)


@cases(20)
@given(SHAPES, st.integers(0, 5))
def test_cuts_are_level_each_is_in_two_parts_and_the_rest_is_the_surface(solid, seed):
    rotation = solids.rotation(seed) if seed else np.eye(3)
    bodies, size = decompose(solid.points, solid.faces, rotation), np.abs(solid.points).max()
    surface = cuts = 0.0
    for points, faces, is_cut in zip(bodies.points, bodies.faces, bodies.is_cut):
        normal = np.cross(*(points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))) / 2
        surface = surface + np.linalg.norm(normal[~is_cut], axis=1).sum()
        cuts = cuts + (normal[is_cut] @ rotation[2]).sum()
        assert (
            np.abs((points @ rotation[2])[faces[is_cut]] - (points @ rotation[2])[faces[is_cut]][:, :1]).max(initial=0)
            <= 1e-12 * size
        )
    corners = solid.points[solid.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    # a flat between two cuts is closed from both sides by what it looks at
    flat = (np.ptp((solid.points @ rotation[2])[solid.faces], axis=1) == 0).any()
    assert surface <= area * (1 + 1e-9) and (flat or surface >= area * (1 - 1e-9))
    assert flat or abs(cuts) <= 1e-9 * area


@pytest.mark.parametrize(
    "boxes, holes, expected",
    [
        # two legs under a bar: they meet at one height
        ([([0, 0, 0], [1, 1, 3]), ([2, 0, 0], [3, 1, 3]), ([0, 0, 3], [3, 1, 4])], [], [3, 3, 3]),
        # a bar under two horns
        ([([0, 0, 0], [3, 1, 1]), ([0, 0, 1], [1, 1, 4]), ([2, 0, 1], [3, 1, 4])], [], [3, 3, 3]),
        # a sealed void, as high as a hole is
        ([([0, 0, 0], [4, 4, 4])], [([1, 1, 1], [3, 3, 3])], [16, 24, 16]),
        # a cup
        ([([0, 0, 0], [3, 3, 3])], [([1, 1, 1], [2, 2, 4])], [9, 16]),
        # a window through: two ways around
        ([([0, 0, 0], [3, 1, 3])], [([1, -1, 1], [2, 2, 2])], [1, 1, 3, 3]),
        # two bodies, one inside a void of the other
        ([([0, 0, 0], [5, 5, 5])], [([1, 1, 1], [4, 4, 4])], [25, 48, 25]),
    ],
)
def test_parts_of_boxes(boxes, holes, expected):
    solid = trimesh.boolean.union([box(*each) for each in boxes])
    if holes:
        solid = trimesh.boolean.difference([solid, *(box(*each) for each in holes)])
    bodies = decompose(solid)
    found = [volume(*body) for body in zip(bodies.points, bodies.faces)]
    assert np.allclose(np.sort(found), np.sort(expected), rtol=0, atol=1e-9)


def test_bodies_that_overlap_are_taken_apart_one_by_one():
    one, two = solids.box(4, 4, 4), solids.box(1, 1, 6)
    both = solids.unite(one, two)
    body = np.repeat([0, 1], [len(one.points), len(two.points)])
    bodies = decompose(both.points, both.faces, body_of_vertex=body)
    assert np.allclose(sorted(volume(*each) for each in zip(bodies.points, bodies.faces)), [6, 64])


def test_a_part_of_many_vertices_is_closed():
    ring = solids.torus(around=500, across=300)  # more vertices than the root of what fits in 32 bits
    bodies = decompose(ring.points, ring.faces, [[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    assert len(bodies.label) == 4 and max(map(len, bodies.points)) > 46341
    assert all(is_closed_manifold(faces) for faces in bodies.faces)
    assert np.isclose(
        sum(volume(*body) for body in zip(bodies.points, bodies.faces)), volume(ring.points, ring.faces), rtol=1e-9
    )


def test_points_in_no_face_and_other_vertices_change_nothing():
    solid = solids.arch()
    more = np.concatenate([solid.points[:1] + 9, solid.points])
    plain, moved = decompose(solid.points, solid.faces), decompose(more, solid.faces + 1)
    assert all(np.array_equal(a, b) for a, b in zip(plain.points, moved.points))


def test_a_surface_that_is_none_is_refused():
    with pytest.raises(errors.NotASolidError):
        decompose(solids.cube().points, solids.cube().faces[1:])


# Faces and their arcs


def run(solid, folder, **options):
    """Tables of a solid, of faces whole and cut, and files."""
    result = pipeline.run_stages(solid, folder, **{**EXACT, **options})
    tables = []
    for cut in (False, True):
        label_faces.main(folder, folder, {"cut": cut, "method": "exact"})
        tables.append(read_table(folder / "face_arcs.parquet", "face_arcs").to_pandas())
    return result, tables


def face_areas(result):
    points, faces = np.array(result.points), np.array(result.faces)
    return np.linalg.norm(np.cross(*(points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))), axis=1) / 2


@cases(8)
@given(SHAPES)
def test_areas_of_faces_and_of_their_parts_are_those_of_the_surface(solid):
    with tempfile.TemporaryDirectory() as folder:
        result, (whole, parts) = run(solid, Path(folder))
    areas = face_areas(result)
    assert whole["face"].tolist() == list(range(len(areas)))
    assert np.allclose(whole["area"], areas, rtol=1e-9, atol=1e-15)
    assert np.allclose(parts.groupby("face")["area"].sum(), areas, rtol=1e-9, atol=1e-12 * areas.max())
    assert (np.diff(parts["face"]) >= 0).all() and (parts["area"] >= 0).all()
    assert whole[["surface_arc", "solid_arc"]].notna().all(axis=None)
    spanning = set(parts["face"][parts["face"].duplicated()])
    same = whole[~whole["face"].isin(spanning)].merge(parts, on="face")
    assert (same["surface_arc_x"] == same["surface_arc_y"]).all() and (same["solid_arc_x"] == same["solid_arc_y"]).all()


@cases(15)
@given(solids.any_solids())
def test_arcs_of_faces_are_those_of_the_exact_graph_found_by_a_sweep(solid):
    """Of resolved events arcs are those of the exact graph, and a face is on that which the sweep says."""
    with tempfile.TemporaryDirectory() as folder:
        result, (whole, _) = run(solid, Path(folder), tilt={"mode": "auto"})
    surface = [row for row in result.arcs if row["graph"] == "surface"]
    handle = [row["handle"] for row in result.critical_points]
    if len(surface) < len(result.critical_arcs) or None in handle:
        return  # events share a piece
    rises = np.array([row["lower"] < row["upper"] for row in result.critical_arcs])
    whole = whole[rises[whole["critical_arc"]]]  # what lies between copies of a saddle goes elsewhere
    arcs = dict(zip(whole["critical_arc"], whole["surface_arc"]))
    assert len(set(zip(whole["critical_arc"], whole["surface_arc"]))) == len(arcs) == len(set(arcs.values()))
    for critical, arc in arcs.items():
        ends = result.critical_arcs[critical]["source"], result.critical_arcs[critical]["target"]
        assert tuple(handle[end] for end in ends) == (surface[int(arc)]["source"], surface[int(arc)]["target"])


@cases(8)
@given(solids.any_solids())
def test_a_face_is_on_a_solid_arc_that_its_surface_arc_bounds(solid):
    with tempfile.TemporaryDirectory() as folder:
        result, (_, parts) = run(solid, Path(folder), tilt={"mode": "auto"})
    bounds = {row["arc"]: row["bounds"] for row in result.arcs if row["graph"] == "surface"}
    if all(row["resolved"] for row in result.handles):
        assert all(solid in bounds[surface] for surface, solid in zip(parts["surface_arc"], parts["solid_arc"]))
    heights = {row["arc"]: (row["lower"], row["upper"]) for row in result.arcs if row["graph"] == "solid"}
    z = np.array(result.points)[:, 2][np.array(result.faces)][parts["face"]]
    low, high = np.array([heights[arc] for arc in parts["solid_arc"]]).T
    assert (z.min(axis=1) <= high + 1e-12).all() and (z.max(axis=1) >= low - 1e-12).all()


def sliced_at_events(solid, rotation):
    """Areas of surface arcs, by the vertices at their ends, from pieces between levels right beside all events."""
    mesh = height_mesh(solid.points, solid.faces, rotation)
    graph = surface_reeb_graph(mesh)
    heights = np.unique(mesh.points[graph.nodes, 2])[1:-1]
    levels = make_levels(mesh, np.sort(np.concatenate([heights, np.nextafter(heights, -np.inf)])))
    slices = cut_surface(mesh, levels, np.zeros(len(mesh.points), np.int32))
    shell = solids.connected_vertices(mesh)
    pieces, contours = pieces_table(mesh, slices, shell), contours_table(mesh, slices, shell)
    handles = classify_handles(mesh, graph, solid.points, pieces, contours)
    vertex = handles["vertex"].to_pylist()
    arcs = trace_arcs(surface_parts(pieces, handles))
    return sorted((vertex[arc["source"]], vertex[arc["target"]], arc["measure"]) for arc in arcs)


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", ["torus", "tunnel", "linked_rings", "trefoil", "cup", "hollow_ball"])
def test_areas_of_cut_faces_are_those_between_levels_right_beside_the_events(tmp_path, name, seed):
    """Independent of the cuts: arcs whose pieces at events have no height have exactly their own area."""
    solid = solids.transform(getattr(solids, name)(), solids.rotation(seed))
    result, (_, parts) = run(solid, tmp_path)
    area = parts.groupby("surface_arc")["area"].sum()
    where = {tuple(row[axis] for axis in "xyz"): k for k, row in enumerate(result.vertices)}
    number = np.array([where[tuple(point)] for point in solid.points.tolist()])
    vertex = [row["vertex"] for row in result.handles]
    found = sorted(
        (vertex[row["source"]], vertex[row["target"]], area[row["arc"]])
        for row in result.arcs if row["graph"] == "surface"
    )  # fmt: skip
    expected = sorted((number[low], number[high], measure) for low, high, measure in sliced_at_events(solid, np.eye(3)))
    assert [row[:2] for row in found] == [row[:2] for row in expected]
    assert np.allclose([row[2] for row in found], [row[2] for row in expected], rtol=1e-9, atol=0)


def test_what_arcs_have_in_common_is_shared_by_halves_in_the_table_of_arcs_and_not_here(tmp_path):
    """A bar on two legs: the area of a leg is known, whatever the levels."""
    solid = trimesh.boolean.union([box([0, 0, 0], [1, 1, 3]), box([2, 0, 0], [3, 1, 3]), box([0, 0, 3], [3, 1, 4])])
    _, (_, parts) = run(solids.Solid(np.array(solid.vertices), np.array(solid.faces)), tmp_path)
    areas = parts.groupby("solid_arc")["area"].sum()
    assert np.allclose(sorted(areas), [2 * 3 + 2 * 1 + 3 + 1, 13, 13])


@pytest.mark.parametrize("refine", ["none", "feature"])
def test_every_face_has_arcs_and_every_part_is_closed_whatever_the_levels_hide(tmp_path, refine):
    solid = solids.blob(3, subdivisions=3, roughness=0.6)
    levels = {"refine": refine, "distance": 0.2, "feature_size": 0.4}
    result, (whole, parts) = run(solid, tmp_path, levels=levels)
    assert whole.notna().all(axis=None) and np.isclose(parts["area"].sum(), whole["area"].sum(), rtol=1e-12)
    decompose_solid.main(tmp_path, tmp_path, {"method": "exact"})
    table = read_table(tmp_path / "parts.parquet", "parts").to_pandas()
    assert np.isclose(table["volume"].sum(), volume(np.array(result.points), np.array(result.faces)), rtol=1e-9)


def test_a_body_wholly_between_two_levels_has_no_arc_and_its_volume_is_told(tmp_path):
    solid = solids.unite(solids.box(1, 1, 10), solids.move(solids.icosphere(1, 0.1), (3, 0, 0.4)))
    levels = {"refine": "none", "distance": 0.1}
    result, (whole, _) = run(solid, tmp_path, levels=levels)
    small = np.array([row["shell"] for row in result.tables["faces"]])
    sizes = Counter(small.tolist())
    shell = max(sizes, key=sizes.get)
    assert whole["solid_arc"].isna().tolist() == whole["surface_arc"].isna().tolist() == (small == shell).tolist()
    decompose_solid.main(tmp_path, tmp_path, {"method": "exact"})
    table = read_table(tmp_path / "parts.parquet", "parts").to_pylist()
    assert [row["solid_arc"] for row in table] == [None, 0]
    assert np.isclose(table[1]["volume"], 10) and 0.003 < table[0]["volume"] < 4.2e-3


# Files for other programs


@pytest.fixture(scope="module")
def window(tmp_path_factory):
    """The folder of a frame, and what the stages wrote of it."""
    folder = tmp_path_factory.mktemp("window")
    solid = solids.transform(solids.tunnel(), solids.rotation(4))
    pipeline.run_stages(solids.move(solid, (1e4, 0, 0)), folder, **EXACT)
    label_faces.main(folder, folder, {"cut": True, "method": "exact"})
    for by in ("surface", "solid"):
        colour_faces.main(folder, folder, {"by": by, "method": "exact"})
    decompose_solid.main(folder, folder, {"method": "exact"})
    return folder


def test_the_coloured_file_has_the_arcs_and_areas_of_the_table(window):
    table = read_table(window / "face_arcs.parquet", "face_arcs").to_pandas()
    raw = trimesh.exchange.ply.load_ply(io.BytesIO((window / "arcs.ply").read_bytes()))["metadata"]["_ply_raw"]
    vertex, face = raw["vertex"]["data"], raw["face"]["data"]
    points = np.column_stack([vertex[axis] for axis in "xyz"])
    corners = points[face["vertex_indices"]["f1"]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    for arc in ("solid_arc", "surface_arc"):
        numbers, expected = np.asarray(face[arc]).ravel(), table.groupby(arc)["area"].sum()
        assert np.allclose(np.bincount(numbers, area), expected, rtol=1e-9)
        assert (np.asarray(vertex[arc]).ravel()[face["vertex_indices"]["f1"]] == numbers[:, None]).all()
    colours = {
        arc: {
            tuple(int(face[c].ravel()[k]) for c in ("red", "green", "blue"))
            for k in np.flatnonzero(face["solid_arc"].ravel() == arc)
        }
        for arc in set(table["solid_arc"])
    }
    assert all(len(found) == 1 for found in colours.values())
    assert len(set.union(*colours.values())) == len(colours) == 4


def test_the_scene_has_a_closed_node_per_arc_in_its_place(window):
    scene = trimesh.load(window / "parts.glb")
    table = read_table(window / "parts.parquet", "parts").to_pandas()
    arcs = read_table(window / "arcs.parquet", "arcs").to_pandas()
    assert {f"s{arc}" for arc in table["solid_arc"]} == set(scene.graph.nodes_geometry)
    assert set(table["solid_arc"]) == set(arcs["arc"][arcs["graph"] == "solid"])
    bodies = {
        name: scene.geometry[scene.graph[name][1]].copy().apply_transform(scene.graph[name][0])
        for name in scene.graph.nodes_geometry
    }
    for row in table.to_dict("records"):
        body = bodies[f"s{int(row['solid_arc'])}"]
        assert body.is_watertight and np.isclose(body.volume, row["volume"], rtol=1e-6)
        assert np.isclose(body.area, row["area"] + row["cut_area"], rtol=1e-6) and len(body.faces) == row["n_faces"]
        assert np.allclose(body.bounds[:, 2], (row["lower"], row["upper"]), atol=1e-6)
    assert np.isclose(table["volume"].sum(), 8.0 * 2, rtol=1e-9)


def test_files_are_the_same_bytes_again(window, tmp_path):
    for name in ("arcs.ply", "parts.glb"):
        stage, options = (colour_faces, {"by": "solid"}) if name == "arcs.ply" else (decompose_solid, {})
        stage.main(window, tmp_path, {**options, "method": "exact"})
        assert (tmp_path / name).read_bytes() == (window / name).read_bytes()


@pytest.mark.parametrize("stage", [label_faces, colour_faces, decompose_solid])
def test_guessed_links_have_no_faces(stage, window, tmp_path):
    with pytest.raises(Rejected, match=r"edges: \{method: exact\}"):
        stage.main(window, tmp_path, {"method": "proximity"})


# Real meshes


@pytest.mark.parametrize(
    "name, mode",
    [
        ("eight_g2.off", "none"),
        ("plate_holes.STL", "auto"),
        ("plate_holes.STL", "none"),
        ("block_stand_voids.stl", "auto"),
        ("elephant_toy.obj", "auto"),
        ("gears7.stl", "none"),
    ],
)
def test_real_parts(name, mode, tmp_path):
    if not (MESHES / name).exists():
        pytest.skip(f"no {MESHES / name}")
    pipeline.run_mesh(MESHES / name, tmp_path, tilt={"mode": mode}, levels={"refine": "exact", "distance": 0.02})
    for stage in (label_faces, decompose_solid):
        stage.main(tmp_path, tmp_path, {"cut": True, "method": "exact"})
    tables = {
        name: read_table(tmp_path / f"{name}.parquet", name).to_pandas()
        for name in ("arcs", "face_arcs", "parts", "shells")
    }
    arcs = tables["arcs"][tables["arcs"]["graph"] == "solid"].set_index("arc")
    parts = tables["parts"].set_index("solid_arc")
    assert np.isclose(parts["volume"].sum(), tables["shells"]["volume"].sum(), rtol=1e-9)
    assert np.isclose(tables["face_arcs"]["area"].sum(), tables["shells"]["area"].sum(), rtol=1e-9)
    height = np.ptp(arcs[["lower", "upper"]].to_numpy())
    assert set(parts.index) == set(arcs.index[arcs["upper"] - arcs["lower"] > 1e-12 * height])
    same = arcs.loc[parts.index]
    assert np.allclose(parts[["lower", "upper"]], same[["lower", "upper"]], rtol=0, atol=1e-9 * height)
    areas = tables["face_arcs"].groupby("solid_arc")["area"].sum()
    assert np.allclose(parts["area"], areas.reindex(parts.index, fill_value=0), rtol=1e-6, atol=1e-9 * areas.sum())
