"""Centrelines of tubes: against known ones, on real meshes, and as files."""

import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial import cKDTree

import solids
import trace_centrelines
from corpus.storage import read_table
from reebslice import find_centrelines, geodesic_distance
from reebslice.certification.functions import certify_function
from reebslice.errors import ReebsliceError
from reebslice.graphs.centreline_files import centreline_tree, count_centrelines
from reebslice.graphs.centrelines import branch_figures
from reebslice.graphs.function_graphs import graph_function
from reebslice.mesh.surface_distances import distance_to_surface
from test_functions import GENUS, SHAPES, write_knot

MESHES = Path(__file__).parents[2] / "shared" / "meshes"


def curve_of_knot(t):
    return np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)


def test_the_centreline_of_a_knotted_tube_is_its_curve():
    solid = solids.trefoil(around=240, across=24)
    lines = find_centrelines(solid.points, solid.faces)
    assert count_centrelines(lines) | {"length": 0} == {
        "branches": 1, "length": 0, "ends": 0, "branch_points": 0, "parts": 1, "loops": 1,
    }  # fmt: skip
    curve = curve_of_knot(np.linspace(0, 2 * np.pi, 20000))
    off = cKDTree(curve).query(lines.points)[0] / 0.4
    assert off.mean() < 0.06 and off.max() < 0.3
    length = np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
    figures = branch_figures(lines)
    assert figures["length"] == pytest.approx([length], rel=0.03)
    assert figures["mean_radius"] == pytest.approx([0.4], rel=0.1)
    assert figures["volume"] == pytest.approx([np.pi * 0.16 * length], rel=0.05)
    assert np.isnan(figures["tortuosity"]).all()


def test_a_straight_bar_has_a_straight_line():
    solid = solids.subdivide(solids.box(10, 1, 1), 4)
    lines = find_centrelines(solid.points, solid.faces)
    assert len(lines.branches.start) == 2
    assert np.abs(lines.points[:, 1:] - solid.points[:, 1:].mean(axis=0)).max() < 0.1
    assert branch_figures(lines)["tortuosity"] == pytest.approx([1], abs=0.01)
    assert lines.section == pytest.approx(np.ones(len(lines.section)), rel=0.05)
    assert lines.area.sum() == pytest.approx(42)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("prune", [0.0, 1.5, 100.0])
def test_loops_and_parts_are_kept_whatever_is_pruned(name, prune):
    solid = SHAPES[name]
    lines = find_centrelines(solid.points, solid.faces, prune=prune)
    counts = count_centrelines(lines)
    assert counts["loops"] == GENUS[name] and counts["parts"] == solids.connected_vertices(solid).max() + 1
    a, b, c = (solid.points[solid.faces[:, k]] for k in range(3))
    assert lines.area.sum() == pytest.approx(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    swc, cuts = centreline_tree(lines, {})
    rows = np.array([line.split() for line in swc.splitlines() if not line.startswith("#")], float)
    assert len(rows) == len(lines.points) and (rows[:, 6] < rows[:, 0]).all()
    assert (rows[:, 6] == -1).sum() == counts["parts"] and len(cuts) == counts["loops"]
    assert all(len(set(cut["numbers"])) == 2 for cut in cuts)


@pytest.mark.parametrize("name, genus", [("fertility_25k.obj", 4), ("femur_g2.off", 2), ("octopus_33k.obj", 0)])
def test_real_meshes_keep_their_loops(name, genus):
    trimesh = pytest.importorskip("trimesh")
    if not (MESHES / name).is_file():
        pytest.skip("needs the meshes of the project's shared folder")
    mesh = trimesh.load_mesh(MESHES / name)
    mesh.merge_vertices()
    points, faces = np.array(mesh.vertices), np.array(mesh.faces)
    faces = faces if mesh.volume > 0 else faces[:, ::-1]
    values = geodesic_distance(points, faces)
    nodes, arcs = graph_function("geodesic", values, points, faces)
    assert certify_function(points, faces, values, nodes, arcs)["verdict"] == "exact"
    assert count_centrelines(find_centrelines(points, faces, values=values))["loops"] == genus


def test_a_constant_function_has_no_centrelines():
    solid = solids.torus()
    with pytest.raises(ReebsliceError, match="the function is constant"):
        find_centrelines(solid.points, solid.faces, values=np.ones(len(solid.points)))


def test_distance_to_a_surface_is_that_to_its_nearest_point():
    """Inside and outside a box of few large and many small faces: the distance to a box is known."""
    solid = solids.unite(solids.box(4, 4, 4), solids.move(solids.icosphere(2, 0.2), [9.0, 0, 0]))
    spots = np.random.default_rng(1).uniform(-4, 4, (200, 3))
    outside = np.linalg.norm(np.maximum(np.abs(spots) - 2, 0), axis=1)
    inside = np.maximum(2 - np.abs(spots).max(axis=1), 0)
    expected = np.minimum(outside + inside, np.linalg.norm(spots - [9, 0, 0], axis=1) - 0.2)
    assert distance_to_surface(spots, solid.points, solid.faces) == pytest.approx(expected, abs=1e-9)


def test_centrelines_are_written_for_other_programs(tmp_path):
    knot = tmp_path / "knot"
    write_knot(knot)
    trace_centrelines.main(knot, tmp_path, {"distance": 0.005, "prune": 1.5})
    points = read_table(tmp_path / "centreline_points.parquet", "centreline_points")
    (branch,) = read_table(tmp_path / "branches.parquet", "branches").to_pylist()
    assert branch["source"] == branch["target"] and branch["tortuosity"] is None
    assert len(branch["points"]) == len(branch["distance"]) == len(branch["volumes"]) == len(points) + 1
    assert branch["distance"][-1] == branch["length"] and branch["volumes"][-1] == branch["volume"]
    counts = json.loads((tmp_path / "centrelines.json").read_text())
    assert counts["centrelines"]["loops"] == 1 and len(counts["cuts"]) == 1
    names = {part.get("Name") for part in ElementTree.parse(tmp_path / "centrelines.vtp").getroot().iter("DataArray")}
    assert {"MaximumInscribedSphereRadius", "section", "length", "mean_radius"} <= names
    again = tmp_path / "again"
    again.mkdir()
    trace_centrelines.main(knot, again, {"distance": 0.005, "prune": 1.5})
    for path in again.iterdir():
        assert path.read_bytes() == (tmp_path / path.name).read_bytes()


@pytest.mark.parametrize("scale", [1e-150, 1e100])
def test_a_mesh_in_a_unit_that_floats_have_no_volumes_in_is_refused(scale):
    solid = solids.torus()
    with pytest.raises(ReebsliceError, match="volumes are no floats: take another unit"):
        find_centrelines(solid.points * scale, solid.faces)
