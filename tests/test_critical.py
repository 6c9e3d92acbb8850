"""Critical points, their unfolding and their cancellation."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import solids
from reebslice.handles.sides import link_areas, saddle_contours
from reebslice.mesh.half_edges import find_twins
from reebslice.morse.critical_points import morse_indices, vertex_indices
from reebslice.morse.ordered_mesh import cross_at, order_by_height
from reebslice.morse.reeb_graph import critical_persistence, surface_reeb_graph
from reebslice.morse.unfolding import unfold_saddles


def ordered_mesh(solid, seed=None):
    rotation = np.eye(3) if seed is None else solids.rotation(seed)
    return order_by_height(solid.points, solid.faces, rotation)


def euler_characteristic(solid):
    return len(solid.points) - len(solid.faces) // 2


def test_a_flat_subdivided_box_has_two_critical_points():
    index = vertex_indices(ordered_mesh(solids.cube(subdivisions=3)))
    assert sorted(index[index != 0]) == [1, 1]


def test_twins_run_back_along_the_same_edge():
    mesh = ordered_mesh(solids.torus(), seed=1)
    tail = mesh.faces.ravel()
    head = np.roll(mesh.faces, -1, axis=1).ravel()
    assert (tail[mesh.twins] == head).all() and (mesh.twins[mesh.twins] == np.arange(len(tail))).all()


@pytest.mark.parametrize("faces", [[[0, 1, 2]], [[0, 1, 2], [0, 1, 2]], [[0, 1, 2], [0, 2, 1], [0, 1, 3]]])
def test_twins_refuse_what_is_not_closed_and_oriented(faces):
    with pytest.raises(ValueError, match="not closed and oriented"):
        find_twins(np.array(faces), 4)


@given(solids.any_solids(), st.integers(0, 3))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_indices_sum_to_the_euler_characteristic(solid, seed):
    mesh = ordered_mesh(solid, seed)
    unfolded = unfold_saddles(mesh)
    assert vertex_indices(mesh).sum() == vertex_indices(unfolded).sum() == euler_characteristic(solid)
    assert vertex_indices(unfolded).min() >= -1


@pytest.mark.parametrize("petals", [3, 4, 6])
def test_a_multiple_saddle_unfolds_in_place(petals):
    solid = solids.monkey_saddle(petals)
    mesh = ordered_mesh(solid)
    assert vertex_indices(mesh).min() == 1 - petals
    unfolded = unfold_saddles(mesh)
    copies = np.flatnonzero(np.bincount(unfolded.vertex) == petals - 1)
    assert len(copies) == 1 and len(unfolded.points) == len(mesh.points) + petals - 2
    ranks = np.flatnonzero(unfolded.vertex == copies[0])
    assert (np.diff(ranks) == 1).all() and (np.diff(unfolded.points[ranks], axis=0) == 0).all()
    assert (vertex_indices(unfolded)[ranks] == -1).all()


def test_upright_torus_has_the_four_textbook_points():
    mesh = ordered_mesh(solids.torus(upright=True, around=16, across=8), seed=0)
    critical = np.flatnonzero(vertex_indices(mesh))
    assert morse_indices(mesh, critical).tolist() == [0, 1, 1, 2]
    graph = surface_reeb_graph(mesh)
    assert graph.nodes.tolist() == critical.tolist()
    persistence = critical_persistence(mesh, graph)[critical]
    height = mesh.points[critical, 2]
    whole, hole = height[3] - height[0], height[2] - height[1]
    assert persistence.tolist() == [whole, hole, hole, whole]


def test_the_lower_of_two_feet_pairs_with_nothing():
    # An arch on two feet of different length: the shorter foot ends where they meet.
    arch = solids.arch()
    mesh = ordered_mesh(solids.Solid(arch.points + 0.1 * arch.points[:, [2, 2, 0]] * [0, 0, 1], arch.faces))
    graph, index = surface_reeb_graph(mesh), vertex_indices(mesh)
    low, high = graph.nodes, graph.nodes[graph.partner]
    feet = (index[low] == 1) & (index[high] == -1)
    assert feet.sum() == 1, "the longer foot goes with the top of the arch"
    expected = mesh.points[high[feet], 2] - mesh.points[low[feet], 2]
    assert critical_persistence(mesh, graph)[high[feet]] == pytest.approx(expected, rel=1e-15)
    assert mesh.points[low[feet], 2] > mesh.points[0, 2]


def test_areas_at_an_extremum_tell_material_from_void():
    ball, void = ordered_mesh(solids.icosphere(2), 3), ordered_mesh(solids.carve(solids.icosphere(2)), 3)
    ends = np.array([0, len(ball.points) - 1])
    # seen from above, the lowest link of a ball runs clockwise
    assert np.sign(link_areas(ball, ends)).tolist() == [-1, 1]
    assert np.sign(link_areas(void, ends)).tolist() == [1, -1]


def test_contours_at_the_saddles_of_a_torus():
    mesh = ordered_mesh(solids.torus(upright=True, around=24, across=12), seed=0)
    saddles = np.flatnonzero(vertex_indices(mesh) == -1)
    below, above = saddle_contours(mesh, saddles)
    # the lower saddle parts the disk in two, the upper one joins them again
    assert np.isnan(below).tolist() == [[False, True], [False, False]]
    assert np.isnan(above).tolist() == [[False, False], [False, True]]
    assert (below[~np.isnan(below)] > 0).all() and (above[~np.isnan(above)] > 0).all()
    assert below[0, 0] == pytest.approx(above[0].sum()) and above[1, 0] == pytest.approx(below[1].sum())


def test_components_are_numbered_by_their_lowest_vertex():
    mesh = ordered_mesh(solids.linked_rings())
    shell = solids.connected_vertices(mesh)
    assert shell.max() == 1 and shell[0] == 0


def test_crossings_inside_a_flat_follow_x_then_y():
    low, high = np.array([0.0, 0.0, 1.0]), np.array([2.0, 4.0, 1.0])
    assert cross_at(low, high, 1.0, 0.5, 9.0) == (0.5, 1.0)
    assert cross_at(np.array([2.0, 0.0, 1.0]), high, 1.0, 2.0, 1.0) == (2.0, 1.0)
    assert cross_at(low, low, 1.0, 0.0, 0.0) == (0.0, 0.0)
