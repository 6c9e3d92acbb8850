"""Nodes, similarity, links and graphs against mathematics."""

import networkx as nx
import numpy as np
import pyarrow as pa
import pytest
import shapely

import reference
import solids
from pipeline import run_stages
from reebslice.arrays.components import connected_items
from reebslice.errors import ReebsliceError
from reebslice.formats.wkb import pack_curves, unpack_curves
from reebslice.graphs.arcs import trace_arcs
from reebslice.graphs.nodes import inscribed_points
from reebslice.graphs.parts import GraphParts, linked_parts
from reebslice.graphs.smooth_paths import STEADY, smooth_points, walk_steadily
from reebslice.links.similarity import boolean_similarity, link_by_proximity, link_by_similarity
from reebslice.planar.circles import largest_circles
from reebslice.planar.curves import curve_centres
from reebslice.planar.distances import clearances
from reebslice.planar.outlines import find_outlines, mend_outlines, outline_areas, outline_polygons
from reebslice.planar.shared_areas import shared_areas


def box(x, y, width, depth=1.0):
    return shapely.box(x, y, x + width, y + depth)


def test_inscribed_points_of_known_shapes():
    ring = shapely.Point(0, 0).buffer(2, 64).difference(shapely.Point(0, 0).buffer(1, 64))
    points, radius = inscribed_points(find_outlines([box(0, 0, 2, 2), box(0, 0, 10, 1), ring, shapely.Polygon()]))
    assert points[0] == pytest.approx([1, 1], abs=0.1)
    assert points[1, 1] == pytest.approx(0.5, abs=0.05)
    assert np.hypot(*points[2]) == pytest.approx(1.5, abs=0.05)
    assert np.isnan(points[3]).all()
    assert radius == pytest.approx([1, 0.5, 0.5, 0], abs=0.05)


def test_circles_are_as_large_as_those_of_a_general_search():
    random = np.random.default_rng(7)
    star = [shapely.LineString(random.uniform(-3, 3, (12, 2))).buffer(0.1 + random.random(), 4) for _ in range(30)]
    comb = shapely.union_all([box(0, 0, 9, 0.5), *(box(k, 0, 0.4, 3) for k in range(9))])
    two = shapely.MultiPolygon([box(0, 0, 1), box(3, 0, 2, 2)])
    shapes = np.array([*star, comb, two, shapely.Polygon(), box(0, 0, 9, 1e-4)])
    shapes = np.append(shapes, shapely.segmentize(shapes, 0.01))
    outlines, tolerance = find_outlines(shapes), np.full(len(shapes), 0.01)
    points, radius = largest_circles(outlines, tolerance)
    some = ~shapely.is_empty(shapes)
    general = np.zeros(len(shapes))
    general[some] = shapely.length(shapely.maximum_inscribed_circle(shapes[some], tolerance[some] / 4))
    assert (general - 1.0001 * tolerance <= radius).all() and (radius <= general + tolerance / 4).all()
    places = shapely.points(np.nan_to_num(points))
    assert shapely.contains(shapes[some], places[some]).all()
    assert radius[some] == pytest.approx(shapely.distance(shapely.boundary(shapes), places)[some], abs=1e-12)
    signed = clearances(outlines, np.tile([0.2, 0.1], (len(shapes), 1)))
    sign = np.where(shapely.contains_xy(shapes, 0.2, 0.1), 1, -1)
    distance = shapely.distance(shapely.boundary(shapes), shapely.Point(0.2, 0.1))
    assert signed[some] == pytest.approx((sign * distance)[some])


def steady_points(shapes, points, radius, neighbour):
    """The walk upward through regions."""
    return walk_steadily((shapes.points, shapes.ring, shapes.start), points, radius, neighbour, np.arange(len(points)))


def test_steady_points_stay_where_the_circle_is_as_large():
    shapes = find_outlines([box(0, 0, 10), box(0, 0, 10), box(0, 0, 3)])
    points = np.array([[2.0, 0.5], [8.0, 0.5], [1.0, 0.5]])
    moved = steady_points(shapes, points, np.full(3, 0.5), np.array([-1, 0, 1]))
    assert moved[:, 0].tolist() == [2.0, 2.0, 2.0]
    wedge = find_outlines([box(0, 0, 10), shapely.Polygon([(0, 0), (10, 0), (10, 3)])])
    at = np.array([[2.0, 0.5], [8.7, 1.2]])
    assert steady_points(wedge, at, clearances(wedge, at), np.array([-1, 0]))[1, 0] > 6


def test_steady_points_go_across_a_ring_that_widens_and_not_around():
    rings = [shapely.Point(0, 0).buffer(r + 1, 64).difference(shapely.Point(0, 0).buffer(r, 64)) for r in (3, 5)]
    points = np.array([[3.5, 0.0], [-5.5, 0.0]])
    moved = steady_points(find_outlines(rings), points, np.full(2, 0.5), np.array([-1, 0]))
    assert moved[1] == pytest.approx([5.5, 0], abs=0.1)


def test_steady_points_start_from_a_region_without_room(tmp_path):
    # the level at 0 runs through the lowest vertex of the pit, where the hole is but a point
    pit = solids.terrain([[0, 1, 0], [1, 0, 1], [0, 1, 0]])
    upside_down = {"mode": "direction", "direction": [0, 0, -1]}
    for tilt in ({"mode": "none"}, upside_down):
        nodes = run_stages(pit, tmp_path, tilt=tilt, levels={"distance": 0.25}, nodes={"sampler": "inscribed"}).nodes
        assert all(np.isfinite([row["x"], row["y"], row["z"]]).all() for row in nodes)
    shapes = find_outlines([shapely.Polygon(), box(0, 0, 2)])
    points = np.array([[0.5, 0.5], [1.5, 0.5]])
    assert steady_points(shapes, points, np.array([0.0, 0.5]), np.array([-1, 0]))[:, 0].tolist() == [0.5, 0.5]


def chain(count):
    """Regions below and above each block of a chain of regions."""
    return [[], *([k] for k in range(count))], [*([k] for k in range(count)), []]


def path_length(points, height):
    return np.linalg.norm(np.diff(np.column_stack([points, height]), axis=0), axis=1).sum()


def test_paths_are_straight_where_they_can_be():
    # in a leaning bar all largest circles lie on ridges, and the search finds any of them
    height = np.linspace(0, 10, 41)
    shapes = find_outlines([box(0.3 * h, 0, 6, 2) for h in height])
    centre, radius = inscribed_points(shapes)
    points = smooth_points(shapes, centre, radius, height, *chain(len(height)))
    assert (clearances(shapes, points) >= STEADY * radius).all()
    straight = path_length(points[[0, -1]], height[[0, -1]])
    assert path_length(points, height) < 1.002 * straight
    walked = steady_points(shapes, centre, radius, np.arange(-1, len(height) - 1))
    assert path_length(walked, height) > 1.01 * path_length(points, height)


@pytest.mark.parametrize("seed", range(4))
def test_paths_are_no_longer_than_walks_up_or_down_or_through_the_centres(seed):
    random = np.random.default_rng(seed)
    height = np.cumsum(random.uniform(0.01, 0.3, 60))
    steps = np.cumsum(random.normal(0, 0.2, (60, 2)), axis=0)
    blobs = [
        shapely.LineString([(x, y), (x + 2, y + 1)]).buffer(w) for (x, y), w in zip(steps, random.uniform(0.4, 1, 60))
    ]
    shapes = find_outlines(blobs)
    centre, radius = inscribed_points(shapes)
    points = smooth_points(shapes, centre, radius, height, *chain(60))
    assert (clearances(shapes, points) >= STEADY * radius).all()
    rings, here = (shapes.points, shapes.ring, shapes.start), np.arange(60)
    walks = [walk_steadily(rings, centre, radius, here - 1, here)]
    walks.append(walk_steadily(rings, centre, radius, np.append(here[1:], -1), here[::-1]))
    assert path_length(points, height) <= min(path_length(other, height) for other in (*walks, centre)) + 1e-9
    again = smooth_points(shapes, centre, radius, height, *chain(60))
    assert np.array_equal(points, again)


def test_shared_areas_are_those_of_overlays():
    random = np.random.default_rng(3)
    shapes = [shapely.LineString(random.uniform(-3, 3, (6, 2))).buffer(0.1 + random.random(), 3) for _ in range(25)]
    # edges in common, upright edges, one inside the other, parts, nothing
    shapes += [box(0, 0, 2), box(1, 0, 2), box(0, 0, 4, 4), box(1, 1, 1).reverse(), shapely.Polygon()]
    shapes += [box(0, 0, 4, 4).difference(box(1, 1, 1)), shapely.MultiPolygon([box(0, 0, 1), box(3, 0, 2, 2)])]
    shapes = np.array(shapes)
    low, high = (places.ravel() for places in np.indices((len(shapes),) * 2))
    expected = shapely.area(shapely.intersection(shapes[low], shapes[high]))
    assert shared_areas(find_outlines(shapes), low, high) == pytest.approx(expected, abs=1e-12)
    rings = [shapely.Point(x, 7.3).buffer(y, 30) for x, y in ((0.1, 0.3), (0.2, 0.2), (0.3, 0.05))]
    apart = np.array([*rings, *shapely.transform(np.array(rings), lambda points: points + [0, 1.1])])
    assert (shared_areas(find_outlines(apart), *np.indices((3, 3)).reshape(2, -1) + [[0], [3]]) == 0).all()
    # what takes too long is left to the general overlay
    teeth = [box(0, k, 9, 0.5) for k in range(200)]
    combs = np.array([shapely.union_all([*teeth, box(x, 0, 0.1, 200)]) for x in (0, 1)])
    assert np.isnan(shared_areas(find_outlines(combs), [0], [1])).all()
    measured = boolean_similarity(find_outlines(combs), np.array([0]), np.array([1]))["area_intersection"]
    assert measured == pytest.approx(shapely.area(shapely.intersection(*combs)))


def test_outlines_are_those_of_polygons_and_become_valid_as_they_do():
    hole, two = box(0, 0, 4, 4).difference(box(1, 1, 1)), shapely.MultiPolygon([box(0, 0, 1), box(3, 0, 2, 2)])
    bow = shapely.Polygon([(0, 0), (2, 2), (2, 0), (0, 2)])
    holes = [(1, 1), (5, 1), (5, 5), (1, 5)], [(3, 3), (8, 3), (8, 8)]
    eight = shapely.Polygon([(0, 0), (9, 0), (9, 9), (0, 9)], holes)
    shapes = np.array([shapely.Point(1.1, 0.3).buffer(0.7, 9), bow, hole, shapely.Polygon(), eight, two, box(0, 0, 1)])
    outlines = find_outlines(shapes)
    assert (shapely.to_wkb(outline_polygons(outlines)) == shapely.to_wkb(shapes)).all()
    valid = np.flatnonzero(shapely.is_valid(shapes))
    assert (outline_areas(outlines)[valid] == shapely.area(shapes)[valid]).all()
    mended = mend_outlines(outlines)
    wrong = np.flatnonzero(~shapely.is_valid(shapes))
    shapes[wrong] = shapely.buffer(shapely.make_valid(shapes[wrong]), 0)
    assert wrong.tolist() == [1, 4] and (shapely.to_wkb(outline_polygons(mended)) == shapely.to_wkb(shapes)).all()
    assert (outline_areas(mended) == shapely.area(shapes)).all()


def test_boolean_similarity_of_boxes():
    shapes = np.array([box(0, 0, 2), box(0, 0, 1), box(1, 0, 2), box(5, 0, 1)])
    measured = boolean_similarity(find_outlines(shapes), np.array([0, 1]), np.array([2, 3]))
    assert measured["similarity"] == pytest.approx([1 / 3, 0])
    assert measured["area_union"] == pytest.approx([3, 2])
    assert (measured["area_source"] + measured["area_target"]) == pytest.approx(
        measured["area_union"] + measured["area_intersection"]
    )


def stack(*levels, distance=1.0):
    """Level, height and shape of every region of a stack of lists of polygons."""
    level = np.repeat(np.arange(len(levels)), [len(shapes) for shapes in levels])
    return level, distance * level, np.array([shape for shapes in levels for shape in shapes], object)


def test_similarity_links_pairs_joins_and_splits():
    assert link_by_similarity(*stack([box(0, 0, 1), box(5, 0, 1)], [box(0.2, 0, 1), box(5.2, 0, 1)])) == [
        (0, 2),
        (1, 3),
    ]
    assert link_by_similarity(*stack([box(0, 0, 1), box(1.1, 0, 1)], [box(0, 0, 2.1)])) == [(0, 2), (1, 2)]
    assert link_by_similarity(*stack([box(0, 0, 2.1)], [box(0, 0, 1), box(1.1, 0, 1)])) == [(0, 1), (0, 2)]
    assert (
        link_by_similarity(*stack([box(0, 0, 1)], [box(3, 0, 1)])) == link_by_similarity(*stack([box(0, 0, 1)])) == []
    )


def test_similarity_prefers_the_most_similar():
    # neighbours that both drift: each overlaps what the other becomes, by a little or by a lot
    assert link_by_similarity(*stack([box(0, 0, 1), box(1, 0, 1)], [box(0.3, 0, 1), box(1.3, 0, 1)])) == [
        (0, 2),
        (1, 3),
    ]
    # bodies that overlap one another go on separately
    big, small = box(0, 0, 4, 4), box(3, 3, 2, 2)
    assert link_by_similarity(*stack([big, small], [big, small])) == [(0, 2), (1, 3)]


def test_similarity_links_all_of_what_hangs_together():
    # the left one goes on and gives off most of what the right one joins
    low = [box(0, 0, 3), box(5, 0, 0.5)]
    high = [box(0, 0, 1.8), box(2, 0, 4)]
    assert link_by_similarity(*stack(low, high)) == [(0, 2), (0, 3), (1, 2), (1, 3)]


def test_similarity_pairs_slivers_by_distance_and_never_large_neighbours():
    lean = [box(0, 0, 0.1)], [box(0.5, 0, 0.1)]
    assert link_by_similarity(*stack(*lean, distance=1.0)) == [(0, 1)]
    assert link_by_similarity(*stack(*lean, distance=0.5)) == []
    # the nearer of two without a partner; one that has a partner is not asked
    assert link_by_similarity(*stack([box(0, 0, 0.1), box(0.3, 0, 0.1)], [box(0.7, 0, 0.1)])) == [(1, 2)]
    assert link_by_similarity(*stack([box(0, 0, 1)], [box(0, 0, 1), box(1.1, 0, 1)])) == [(0, 1)]


@pytest.mark.parametrize("rule", [link_by_similarity, link_by_proximity])
def test_links_do_not_depend_on_place_scale_or_what_is_up(rule):
    random = np.random.default_rng(5)
    shapes = [[box(*random.uniform(0, 10, 2), *random.uniform(0.2, 3, 2)) for _ in range(6)] for _ in range(8)]
    level, height, flat = stack(*shapes, distance=0.4)
    links = rule(level, height, flat)
    assert len(links) > 10
    moved = shapely.transform(flat, lambda xy: 8 * xy + [64, -32])
    assert rule(level, 8 * height + 16, moved) == links
    turned = rule(level[::-1].max() - level[::-1], -height[::-1], flat[::-1])
    assert sorted((len(level) - 1 - high, len(level) - 1 - low) for low, high in turned) == links
    # a slab's links are its own affair
    for k in range(7):
        alone = rule(*stack(shapes[k], shapes[k + 1], distance=0.4))
        assert [(low + 6 * k, high + 6 * k) for low, high in alone] == [pair for pair in links if level[pair[0]] == k]


@pytest.mark.parametrize("rule", [link_by_similarity, link_by_proximity])
def test_rules_pass_over_empty_shapes_and_levels(rule):
    level, height, shapes = stack([box(0, 0, 1), shapely.Polygon()], [shapely.Polygon(), box(0, 0, 1)], [box(0, 0, 1)])
    assert rule(level, height, shapes) == [(0, 3), (3, 4)]
    assert rule(np.where(level == 2, 3, level), height, shapes) == [(0, 3)]
    assert rule(level[:2], height[:2], np.full(2, shapely.Polygon(), object)) == []
    assert rule(level[:0], height[:0], shapes[:0]) == []


def test_proximity_links_the_nearest_centroid_whatever_its_shape():
    assert link_by_proximity(*stack([box(0, 0, 1)], [box(3, 0, 1)])) == [(0, 1)]
    assert link_by_proximity(*stack([box(0, 0, 1), box(4, 0, 1)], [box(0.5, 0, 1), box(4, 0, 1)])) == [(0, 2), (1, 3)]


def test_linked_parts_of_a_fork():
    # one item at level 0, two at level 1, one of which ends
    parts = linked_parts([0, 1, 1, 2], [(0, 1), (0, 2), (1, 3)])
    assert [(below, above) for below, above in zip(parts.below, parts.above)] == [
        ([], [0]),
        ([0], [1, 2]),
        ([1], [3]),
        ([2], []),
        ([3], []),
    ]
    assert parts.joints == [[0], [1], [], [2], [3]]


def test_arcs_share_out_what_their_ends_hold():
    parts = GraphParts([[], [0], [1, 2]], [[0], [1, 2], []], [[0], [1], [2]], np.array([1.0, 6.0, 4.0]))
    arcs = trace_arcs(parts)
    assert [(arc["source"], arc["target"], arc["nodes"]) for arc in arcs] == [(0, 1, [0]), (1, 2, [1]), (1, 2, [2])]
    assert [arc["measure"] for arc in arcs] == [1 + 2, 2 + 2, 2 + 2]


def test_a_chain_of_events_is_a_chain_of_nodes():
    arcs = trace_arcs(GraphParts([[], [0], [1]], [[0], [1], []], [[0], [1, 2], [3]], np.ones(3)))
    assert [(arc["source"], arc["target"], arc["nodes"]) for arc in arcs] == [(0, 1, [0]), (1, 2, []), (2, 3, [1])]
    assert sum(arc["measure"] for arc in arcs) == pytest.approx(3)


@pytest.mark.parametrize("method", ["similarity", "proximity"])
def test_methods_without_the_mesh_still_see_an_upright_torus(tmp_path, method):
    torus = solids.torus(2.0, 0.7, 32, 16, upright=True)
    result = run_stages(torus, tmp_path, levels={"distance": 0.02}, edges={"method": method})
    assert reference.count_loops(result.graphs["solid"]) == reference.count_loops(result.graphs["surface"]) == 1
    assert {row["method"] for row in result.edges} == {method}
    missed = [row for row in result.edges if not row["linked"]]
    assert missed == []


def test_the_augmented_graph_subdivides_the_solid_graph(tmp_path):
    result = run_stages(solids.cup(), tmp_path, levels={"distance": 0.05})
    solid, augmented = result.graphs["solid"], result.graphs["augmented"]
    points = [n for n, kind in augmented.nodes(data="kind") if kind == "point"]
    assert len(points) == len(result.nodes)
    assert set(augmented) - set(points) == set(solid)
    assert all(augmented.degree(point) == 2 for point in points)
    assert reference.count_loops(augmented) == reference.count_loops(solid)
    assert nx.number_connected_components(augmented) == nx.number_connected_components(solid)


def test_curves_are_packed_as_well_known_binary():
    points = np.array([[0, 0], [0, 0], [1, 0], [1, 1], [0, 0], [5, 5], [5, 5]], float)
    packed = pack_curves(points, np.array([0, 5, 7]))
    curves = shapely.from_wkb(packed.to_pylist())
    assert shapely.to_wkt(curves[0], rounding_precision=0) == "LINESTRING (1 0, 1 1, 0 0, 1 0)"
    assert shapely.get_num_points(curves).tolist() == [4, 2]
    assert shapely.is_closed(curves).all()
    assert shapely.to_wkb(curves).tolist() == packed.to_pylist()
    blocks = [packed.slice(0, 1), packed.slice(1, 0), packed.slice(1, 1)]
    for unpacked in (unpack_curves([packed], 9), unpack_curves(blocks, 6)):
        assert unpacked.start.tolist() == [0, 4, 6]
        assert (unpacked.points == shapely.get_coordinates(curves)).all()
        assert (curve_centres(*unpacked) == shapely.get_coordinates(shapely.centroid(curves))).all()
    assert len(unpack_curves([pack_curves(np.empty((0, 2)), np.zeros(1, int))], 0).start) == 1


def test_connected_items_are_numbered_by_the_lowest():
    assert connected_items(np.array([5, 1, 2]), np.array([1, 3, 2]), 7).tolist() == [0, 1, 2, 1, 3, 1, 4]


@pytest.mark.parametrize("sizes", [[8], [9], [26, 24], [25, 41, 25]])
def test_curves_of_other_lengths_than_told_are_refused(sizes):
    """Compiled code would write beyond the points, of which there are three."""
    with pytest.raises(ReebsliceError, match="not the line strings that their rows tell of"):
        unpack_curves([pa.array([bytes(size) for size in sizes])], 3)
    assert unpack_curves([pa.array([bytes(25), bytes(41)])], 3).start.tolist() == [0, 1, 3]
