"""The reference itself, on shapes whose Reeb graphs are in every textbook."""

from collections import Counter

import networkx as nx
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings

import reference
import solids

LAX = [HealthCheck.too_slow, HealthCheck.filter_too_much]
SLOW = settings(max_examples=30, deadline=None, derandomize=True, database=None, suppress_health_check=LAX)


def sweep(solid):
    return reference.sweep(reference.as_points(solid.points), solid.faces, check_every_level=True)


def count_changes(graph):
    return Counter(change for _, change in graph.nodes(data="change"))


def test_a_ball_is_an_arc():
    surface, solid = sweep(solids.icosphere(1))
    assert surface.number_of_edges() == solid.number_of_edges() == 1
    assert count_changes(surface) == count_changes(solid) == {"->o": 1, "o->": 1}


@pytest.mark.parametrize("solid", [solids.cube(2), solids.staircase(3), solids.subdivide(solids.tetrahedron(), 2)])
def test_flats_have_no_critical_points_of_their_own(solid):
    surface, _ = sweep(solid)
    assert count_changes(surface) == {"->o": 1, "o->": 1}


def test_upright_torus_has_a_loop_in_both_graphs():
    surface, solid = sweep(solids.torus(upright=True))
    assert count_changes(surface) == {"->o": 1, "o->o,o": 1, "o,o->o": 1, "o->": 1}
    assert reference.count_loops(surface) == reference.count_loops(solid) == 1
    assert sorted(dict(surface.degree()).values()) == [1, 1, 3, 3]


def test_lying_torus_has_a_loop_on_the_surface_only():
    surface, solid = sweep(solids.torus())
    assert count_changes(surface) == {"->o": 1, "o->i,o": 1, "i,o->o": 1, "o->": 1}
    assert (reference.count_loops(surface), reference.count_loops(solid)) == (1, 0)
    assert sorted(dict(solid.degree()).values()) == [1, 1, 2, 2]


@pytest.mark.parametrize("holes", [1, 2, 3])
def test_plates_keep_their_genus(holes):
    for upright in (False, True):
        surface, solid = sweep(solids.plate(holes, upright))
        assert reference.count_loops(surface) == holes
        assert reference.count_loops(solid) == (holes if upright else 0)
        saddles = ["o->o,o", "o,o->o"] if upright else ["o->i,o", "i,o->o"]
        assert count_changes(solid) == {"->o": 1, "o->": 1, saddles[0]: holes, saddles[1]: holes}


def test_hollow_ball_has_two_surface_arcs_and_one_chain_of_material():
    surface, solid = sweep(solids.hollow_ball())
    assert sorted(map(len, nx.connected_components(surface))) == [2, 2]
    assert nx.is_connected(solid) and sorted(dict(solid.degree()).values()) == [1, 1, 2, 2]
    assert count_changes(solid) == {"->o": 1, "->i": 1, "i->": 1, "o->": 1}


def test_a_ball_inside_a_hollow_ball_stays_apart():
    surface, solid = sweep(solids.ball_in_hollow_ball())
    assert sorted(map(len, nx.connected_components(surface))) == [2, 2, 2]
    assert sorted(map(len, nx.connected_components(solid))) == [2, 4]


def test_linked_rings_stay_apart():
    surface, solid = sweep(solids.linked_rings())
    for graph, loops in ((surface, 2), (solid, 1)):
        assert sorted(map(len, nx.connected_components(graph))) == [4, 4]
        assert reference.count_loops(graph) == loops


def test_arch_and_bowl_are_mirror_images():
    assert count_changes(sweep(solids.arch())[1]) == {"->o": 2, "o,o->o": 1, "o->": 1}
    assert count_changes(sweep(solids.bowl_shape())[1]) == {"->o": 1, "o->o,o": 1, "o->": 2}


def test_overhanging_tip_is_joined_from_the_side_of_the_material():
    _, solid = sweep(solids.overhang())
    assert count_changes(solid) == {"->o": 2, "o,o->o": 1, "o->": 1}


def test_a_cup_opens_a_pocket_that_breaks_out_at_its_rim():
    _, solid = sweep(solids.cup())
    assert count_changes(solid) == {"->o": 1, "->i": 1, "i,o->o": 1, "o->": 1}
    assert sorted(dict(solid.degree()).values()) == [1, 1, 2, 2]


@pytest.mark.parametrize("petals", [3, 4, 5])
def test_a_monkey_saddle_is_one_node_of_many_arcs(petals):
    surface, solid = sweep(solids.monkey_saddle(petals))
    for graph in (surface, solid):
        assert graph.nodes[0]["change"] is None and graph.nodes[0]["changes"] == 2 * petals
        assert graph.degree(0) == petals + 1
    assert surface.nodes[0]["hidden"] == 0


def test_contours_of_a_square_ring():
    plate = solids.plate(1)
    above = {v for v, point in enumerate(plate.points) if point[2] > 0.5}
    points, faces = reference.as_points(plate.points), plate.faces.tolist()
    walked = reference.walk_contours(faces, above)
    heights = [point[2] for point in points]
    areas = sorted(reference.measure_area(reference.locate_contour(c, heights, 0.5, points)) for c in walked)
    assert areas == [-1, 9]
    assert [len(region) for region in reference.find_regions(points, faces, above, 0.5)] == [2]


def test_pieces_of_an_upright_torus():
    torus = solids.torus(upright=True)
    z = torus.points[:, 2]
    kinds = []
    for levels in ([-2, 0, 2], [-2, 2], [0], []):
        aboves = [set(np.flatnonzero(z > level)) for level in levels]
        pieces = reference.find_pieces(torus.faces.tolist(), aboves)
        assert sum(piece.euler_characteristic for piece in pieces) == 0
        kinds.append(sorted((piece.kind, piece.genus) for piece in pieces))
    assert kinds[0] == [("birth", 0), ("death", 0), ("join", 0), ("split", 0)]
    assert kinds[1] == [("birth", 0), ("compound", 1), ("death", 0)]
    assert kinds[2] == [("compound", 0), ("compound", 0)]
    assert kinds[3] == [("unseen", 1)]


def test_comparison_tells_what_differs():
    one, _ = sweep(solids.torus(upright=True))
    two, _ = sweep(solids.torus())
    assert reference.compare_graphs(one, one, surface=True) == []
    assert reference.compare_graphs(one, two, surface=True)
    doubled = one.copy()
    doubled.add_edge(*next(iter(one.edges())))
    assert len(reference.compare_graphs(doubled, one, surface=True)) == 1


def test_comparison_forgives_how_a_multiple_saddle_is_unfolded():
    whole, _ = sweep(solids.monkey_saddle())
    split = whole.copy()
    split.nodes[0].update(outer=1)
    split.add_node("copy", **whole.nodes[0] | {"outer": 1})
    split.add_edge(0, "copy")
    (end,) = [v for v in whole[0] if whole.nodes[v]["index"] == 2][:1]
    split.remove_edge(0, end)
    split.add_edge("copy", end)
    assert reference.compare_graphs(split, whole, surface=True) == []
    split.add_edge(0, "copy")
    assert reference.compare_graphs(split, whole, surface=True) != []


@SLOW
@given(solids.any_solids())
def test_the_genus_is_all_in_the_loops(solid):
    try:
        surface, material = sweep(solid)
    except reference.Ambiguous:
        assume(False)
    hidden = reference.count_hidden(surface)
    chi = sum(1 - data["changes"] // 2 for _, data in surface.nodes(data=True))
    assert chi == len(solid.points) - len(solid.faces) // 2
    assert reference.count_loops(surface) + hidden == nx.number_connected_components(surface) - chi // 2
    if solid.genus is not None:
        assert reference.count_loops(surface) + hidden == solid.genus
    assert reference.count_loops(material) <= reference.count_loops(surface) + hidden
    if solid.shells is not None:
        assert nx.number_connected_components(surface) == solid.shells
        assert nx.number_connected_components(material) == solid.shells - solid.voids


@SLOW
@given(solids.any_solids())
def test_upside_down_swaps_what_it_should(solid):
    mirrored = solids.transform(solid, -np.eye(3))
    try:
        there, back = sweep(solid), sweep(mirrored)
    except reference.Ambiguous:
        assume(False)
    for surface, upright, turned in zip((True, False), there, back):
        assert reference.reverse_summary(reference.summarize_graph(upright, surface)) == reference.summarize_graph(
            turned, surface
        )
