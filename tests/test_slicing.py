"""Contours, pieces and regions against mathematics."""

import re
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import solids
from corpus.stages import Rejected
from pipeline import run_stages
from reebslice.errors import ReebsliceError, TooManyCrossingsError
from reebslice.morse.critical_points import vertex_indices
from reebslice.morse.height_mesh import height_mesh
from reebslice.slicing.contours import measure_contours, trace_contours
from reebslice.slicing.crowding import crowded_points
from reebslice.slicing.levels import cut_between, make_levels, pierce, uniform_heights
from reebslice.slicing.refinement import feature_scale, slice_surface
from reebslice.slicing.sampling_rule import sampling_rule
from reebslice.slicing.slices import cut_surface
from reebslice.slicing.tables import contours_table


def mesh_of(solid, seed=None):
    rotation = np.eye(3) if seed is None else solids.rotation(seed)
    return height_mesh(solid.points, solid.faces, rotation)


def cut(solid, heights, seed=None, body=None):
    mesh = mesh_of(solid, seed)
    body = np.zeros(len(mesh.points), np.int32) if body is None else body
    return mesh, cut_surface(mesh, make_levels(mesh, heights), body)


def test_contours_of_a_ball_are_near_circles():
    mesh = mesh_of(solids.icosphere(4))
    heights = np.linspace(-0.9, 0.9, 7)
    contours = trace_contours(mesh, make_levels(mesh, heights))
    area, perimeter = measure_contours(contours)
    assert contours.level.tolist() == list(range(7))
    # the mesh is inscribed: never more than the circle, and little less
    circle = np.pi * (1 - heights**2)
    assert (area < circle).all() and (area > 0.96 * circle).all()
    assert (perimeter < 2 * np.sqrt(np.pi * circle)).all()


def test_material_is_on_the_left():
    _mesh, slices = cut(solids.torus(2.0, 0.7, 24, 12), [0.1])
    area = measure_contours(slices.contours)[0]
    assert sorted(np.sign(area)) == [-1, 1] and area.sum() > 0
    assert slices.regions.inner.tolist() == (area < 0).tolist()
    assert slices.regions.of_contour.tolist() == [0, 0]


@given(solids.any_solids(), st.integers(0, 3), st.integers(1, 12))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_pieces_share_out_area_volume_and_euler_characteristic(solid, seed, count):
    mesh = mesh_of(solid, seed)
    heights = uniform_heights(mesh.points[0, 2], mesh.points[-1, 2], np.ptp(mesh.points[:, 2]) / count)
    slices = cut_surface(mesh, make_levels(mesh, heights), solids.connected_vertices(mesh))
    corners = solid.points[solid.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert slices.surfaces.area.sum() == pytest.approx(np.linalg.norm(normal, axis=1).sum() / 2)
    volume = np.einsum("ij,ij->", corners[:, 0], normal) / 6
    assert slices.surfaces.flux.sum() == pytest.approx(volume)
    assert slices.pieces.euler_characteristic.sum() == len(solid.points) - len(solid.faces) // 2
    assert (slices.pieces.genus >= 0).all()


def test_volume_of_a_block_is_that_of_the_slab():
    cube = solids.cube()
    low, high = cube.points[:, 2].min(), cube.points[:, 2].max()
    _, slices = cut(cube, [low + 0.25 * (high - low), low + 0.75 * (high - low)])
    volume = np.prod(np.ptp(cube.points, axis=0))
    assert slices.surfaces.flux == pytest.approx(volume * np.array([0.25, 0.5, 0.25]))


def test_a_tunnel_between_two_levels_is_hidden_genus():
    solid = solids.torus(2.0, 0.5, 12, 7)  # lies flat: all of it between the two levels
    _mesh, slices = cut(solid, [-0.6, 0.6])
    assert len(slices.contours.level) == 0
    assert slices.pieces.kinds() == ["unseen"] and slices.pieces.genus.tolist() == [1]


def test_a_void_between_two_levels_belongs_to_the_block_around_it():
    centre = solids.cube().points.mean(axis=0)
    solid = solids.unite(solids.cube(), solids.carve(solids.move(solids.scale(solids.icosphere(1), 0.05), centre)))
    _mesh, slices = cut(solid, [centre[2] - 0.2, centre[2] + 0.2])
    unseen = slices.pieces.kinds().index("unseen")
    wall = [p for p, slab in enumerate(slices.pieces.slab) if slab == slices.pieces.slab[unseen] and p != unseen]
    assert slices.surfaces.flux[unseen] < 0
    assert slices.block_of_piece[wall].tolist() == [slices.block_of_piece[unseen]]


def test_bodies_that_nest_without_a_void_stay_apart():
    small = solids.scale(solids.icosphere(1), 0.5)
    mesh = mesh_of(solids.unite(solids.icosphere(2), small))
    slices = cut_surface(mesh, make_levels(mesh, [0.05]), solids.connected_vertices(mesh))
    assert slices.regions.inner.tolist() == [False, False]
    assert len(slices.regions.level) == 2 and sorted(slices.regions.parent >= 0) == [False, True]


def test_nesting_to_any_depth():
    mesh = mesh_of(solids.nested_shells(4))
    shell = solids.connected_vertices(mesh)
    slices = cut_surface(mesh, make_levels(mesh, [0.01]), shell // 2)
    size = np.argsort(-np.abs(measure_contours(slices.contours)[0]))
    assert slices.regions.parent[size].tolist() == [-1, *size[:-1]]
    assert slices.regions.inner[size].tolist() == [False, True, False, True]


def test_uniform_heights_divide_evenly():
    heights = uniform_heights(1.0, 3.0, 0.3)
    assert len(heights) == 7
    assert np.diff(heights) == pytest.approx(2 / 7) and heights[0] - 1 == pytest.approx(1 / 7)
    assert uniform_heights(0.0, 1.0, 0.01).shape == (100,), "1 / 0.01 is a hair over 100 in floats"
    assert uniform_heights(0.0, 1.0, 5.0).tolist() == [0.5]


def test_features_of_a_size_need_half_the_distance():
    assert sampling_rule(0.01, None) == (0.01, 0.02)
    assert sampling_rule(None, 0.5) == (0.25, 0.5)
    assert sampling_rule(0.1, 0.7) == (0.1, 0.7)
    assert feature_scale(20.0, 0.01, 0.02, "relative") == (0.2, 0.4)
    assert feature_scale(20.0, 0.1, 0.7, "absolute", refine="exact") == (0.1, 0.7)


@pytest.mark.parametrize("share", [1e-7, 1e-9, 1e-300, 5e-324])
def test_absurd_distances_are_refused_before_memory_is_taken(share):
    mesh = mesh_of(solids.scale(solids.icosphere(1), 50.0))
    height, body = np.ptp(mesh.points[:, 2]), np.zeros(len(mesh.points), np.int32)
    tracemalloc.start()
    with pytest.raises(
        TooManyCrossingsError, match=r"levels, more than the 1000000 .*: take at least (\S+) mesh"
    ) as error:
        slice_surface(mesh, body, share * height)
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()
    cure = float(re.search(r"at least (\S+) mesh", str(error.value))[1])
    assert 0.99e6 / 1.1 < len(uniform_heights(mesh.points[0, 2], mesh.points[-1, 2], cure)) <= 1e6


@pytest.mark.parametrize("distance", [0.0, -1.0, np.nan])
def test_distances_that_are_none_are_refused(distance):
    with pytest.raises(ReebsliceError, match=f"distance between levels is {distance}"):
        uniform_heights(0.0, 1.0, distance)


def test_crossings_are_counted_before_memory_is_taken_for_them(monkeypatch):
    monkeypatch.setattr("reebslice.slicing.contours.MOST_CROSSINGS", 1000)
    mesh = mesh_of(solids.icosphere(2))
    with pytest.raises(TooManyCrossingsError, match=r"100000 levels cross .* 1000 .*: take fewer, by a factor of \d+"):
        slice_surface(mesh, np.zeros(len(mesh.points), np.int32), np.ptp(mesh.points[:, 2]) / 1e5)


@given(solids.terrains(), st.data())
@settings(max_examples=60, deadline=None, derandomize=True)
def test_a_cut_separates_any_two_ranks(solid, data):
    mesh = mesh_of(solid)
    low = data.draw(st.integers(0, len(mesh.points) - 2))
    high = data.draw(st.integers(low + 1, len(mesh.points) - 1))
    height, below, tie_x, tie_y = cut_between(mesh, low, high)
    assert low < below <= high
    above = [
        (z, x, y) > ((height, tie_x, tie_y) if tie_x == tie_x else (height, np.inf, np.inf)) for x, y, z in mesh.points
    ]
    assert above == [rank >= below for rank in range(len(mesh.points))]


@given(st.lists(st.tuples(st.integers(0, 12), st.integers(1, 6)), min_size=1, max_size=8))
@settings(deadline=None, derandomize=True)
def test_pierce_meets_all_intervals_with_the_fewest_cuts(spans):
    intervals = [(low, low + length) for low, length in spans]
    groups = pierce(intervals)
    cuts = [high for _, high in groups]
    assert all(any(low < cut <= high for cut in cuts) for low, high in intervals)
    assert all(low < high for low, high in groups)
    # optimal: there are as many intervals, disjoint in pairs, as there are cuts
    disjoint, last = 0, -1
    for low, high in sorted(intervals, key=lambda pair: pair[1]):
        if low >= last:
            disjoint, last = disjoint + 1, high
    assert len(groups) == disjoint


@given(solids.any_solids(), st.integers(0, 3))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_exact_refinement_leaves_nothing_open(solid, seed):
    mesh = mesh_of(solid, seed if seed else None)
    slices, refined = slice_surface(mesh, solids.connected_vertices(mesh), np.ptp(mesh.points[:, 2]) / 3, "exact")
    assert not {"compound", "unseen"} & set(slices.pieces.kinds())
    assert not crowded_points(slices)[1].any()
    assert (~refined).sum() == 3


def test_exact_refinement_leaves_one_critical_point_a_piece():
    mesh = mesh_of(solids.blob(5, subdivisions=3, roughness=0.5))
    slices, _ = slice_surface(mesh, solids.connected_vertices(mesh), np.ptp(mesh.points[:, 2]), "exact")
    critical = np.flatnonzero(vertex_indices(mesh))
    assert len(critical) > 10
    assert np.bincount(slices.surfaces.of_vertex[critical]).max() == 1


def test_refinement_by_feature_leaves_small_things_alone():
    # a slab 5 high and 2 deep under two towers, 4 high
    towers = solids.terrain(np.array([[5, 5, 5, 5, 5], [5, 9, 5, 9, 5], [5, 5, 5, 5, 5]]))
    mesh = mesh_of(towers)

    def cut_by(feature_size):
        slices, refined = slice_surface(mesh, solids.connected_vertices(mesh), 100.0, "feature", feature_size)
        return sorted(slices.pieces.kinds()), int(refined.sum())

    assert cut_by(4.5) == (["birth", "death"], 0)
    assert cut_by(3.5)[1] > 0 and cut_by(3.5)[0].count("death") == 2


def test_the_tables_do_not_depend_on_the_order_of_the_input():
    solid = solids.csg(3)
    tables = []
    for variant in (solid, solids.permute(solid, 5)):
        mesh = mesh_of(variant)
        slices, _ = slice_surface(mesh, solids.connected_vertices(mesh), 0.1)
        tables.append(
            contours_table(mesh, slices, solids.connected_vertices(mesh)).drop(["lower_vertex", "upper_vertex"])
        )
    assert tables[0].equals(tables[1])


def test_more_crossings_than_memory_are_refused_with_a_cure(monkeypatch, tmp_path):
    monkeypatch.setattr("reebslice.slicing.contours.MOST_CROSSINGS", 1000)
    with pytest.raises(Rejected, match=r"levels cross the mesh edges .* \{refine: feature\}"):
        run_stages(solids.icosphere(2), tmp_path, levels={"distance": 0.001})
    assert not list(tmp_path.glob("contours*"))
