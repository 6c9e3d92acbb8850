"""The certifier's compiled steps against slow, plain versions of the same questions."""

import networkx as nx
import numpy as np
import pytest
import shapely
import trimesh

from reebslice.certification.recount_elders import elder_pairs
from reebslice.certification.recount_holes import Nest
from reebslice.certification.recount_joins import find_components
from reebslice.certification.recount_shapes import measure_curves
from reebslice.certification.recount_surface import count_links, find_sides, measure_shells, rank_surface
from solids import blob, hollow_ball, plate, torus


@pytest.mark.parametrize("seed", range(5))
def test_components_are_those_of_the_graph(seed):
    random = np.random.default_rng(seed)
    one, two = random.integers(0, 60, (2, 10 * seed))
    graph = nx.empty_graph(60)
    graph.add_edges_from(zip(one.tolist(), two.tolist()))
    parts = list(nx.connected_components(graph))
    n, part = find_components(one, two, 60)
    assert n == len(parts) and all(len({part[node] for node in nodes}) == 1 for nodes in parts)
    assert part[np.sort(np.unique(part, return_index=True)[1])].tolist() == list(range(n))


def test_links_to_nowhere_are_refused():
    for one, two in (([0], [3]), ([-1], [2])):
        with pytest.raises(ValueError):
            find_components(one, two, 3)


def ranked(solid, faces=None):
    faces = solid.faces if faces is None else faces
    return rank_surface(solid.points, np.asarray(faces, np.int64), np.zeros(len(faces), np.int64))


@pytest.mark.parametrize("solid", [torus(), plate(2), hollow_ball(), blob(1)])
def test_mesh_edges_lie_between_two_faces(solid):
    surface = ranked(solid)
    sides = find_sides(surface)
    owners = {}
    for face, (a, b, c) in enumerate(surface.corners.tolist()):
        for place, pair in enumerate(((a, b), (b, c), (a, c))):
            owners.setdefault(pair, []).append((face, place))
    assert list(zip(sides.lower.tolist(), sides.upper.tolist())) == sorted(owners)
    for side, pair in enumerate(sorted(owners)):
        assert sides.faces[side].tolist() == [face for face, _ in owners[pair]]
        assert all(sides.of_face[place] == side for place in owners[pair])
    assert (count_links(surface.corners, sides.lower, sides.upper, sides.faces, len(solid.points)) == 1).all()


def test_what_is_no_closed_oriented_surface_has_no_sides():
    faces = torus().faces
    for wrong in (
        faces[1:],
        np.concatenate([faces, faces[:1]]),
        np.concatenate([faces[:1, ::-1], faces[1:]]),
        np.concatenate([faces, faces]),
        np.concatenate([faces, [[0, 0, 1], [0, 1, 0]]]),
    ):
        assert find_sides(ranked(torus(), wrong)) is None


def test_links_are_counted_at_each_vertex():
    one = trimesh.creation.box()
    points = np.concatenate([one.vertices, one.vertices[1:] + 2 * one.vertices[0] * [-1, -1, -1], [[9, 9, 9]]])
    second = np.where(one.faces == 0, 7, np.where(one.faces == 7, 0, one.faces))
    second = np.where(second == 0, 0, second + 7)  # shares vertex 0 alone; vertex 15 is in no face
    solid = type(torus())(points, np.concatenate([one.faces, second]))
    surface = ranked(solid)
    sides = find_sides(surface)
    links = np.empty(16, np.int64)
    links[surface.origin] = count_links(surface.corners, sides.lower, sides.upper, sides.faces, 16)
    assert links.tolist() == [2] + [1] * 14 + [0]


@pytest.mark.parametrize("seed", range(6))
def test_elder_pairs_join_the_younger_to_the_older(seed):
    random = np.random.default_rng(seed)
    n, n_contours = 40, 3 * (seed % 2)
    later = random.integers(1, n, 90)
    from_below = random.random(90) < 0.1 * (n_contours > 0)
    earlier = np.where(from_below, n + random.integers(0, 3, 90), random.integers(0, later))
    parts, expected = [{contour} for contour in range(n, n + n_contours)], []
    age = lambda part: -1 if max(part) >= n else min(part)  # noqa: E731
    for v in range(n):
        met = [part for part in parts if part & set(earlier[later == v].tolist())]
        expected += [(age(part), v) for part in sorted(met, key=age)[1:] if age(part) >= 0]
        parts = [part for part in parts if part not in met] + [set().union({v}, *met)]
    assert sorted(map(tuple, elder_pairs(earlier, later, n, n_contours).tolist())) == sorted(expected)


def test_shells_are_measured_one_by_one():
    solid = hollow_ball()
    shell = trimesh.Trimesh(solid.points, solid.faces, process=False)
    label = np.zeros(len(solid.faces), np.int64)
    for k, part in enumerate(trimesh.graph.connected_components(shell.face_adjacency)):
        label[part] = k
    area, volume = measure_shells(solid.points + 100.0, solid.faces.astype(np.int64), label, label.max() + 1)
    for k in range(label.max() + 1):
        part = trimesh.Trimesh(solid.points, solid.faces[label == k], process=False)
        assert (area[k], volume[k]) == pytest.approx((part.area, part.volume), rel=1e-12)


def rings(seed, count):
    """Closed curves, some within others, some across."""
    random = np.random.default_rng(seed)
    turn = np.linspace(0, 2 * np.pi, 20)
    for _ in range(count):
        radius = random.choice([0.2, 0.5, 1.0, 3.0]) * random.uniform(0.9, 1.1)
        radius = radius * (1 + 0.3 * np.sin(random.integers(2, 5) * turn))
        centre = random.integers(-2, 3, 2)
        points = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1) + centre
        points[-1] = points[0]
        yield shapely.linestrings(points if random.random() < 0.5 else points[::-1])


def test_curves_are_measured_as_shapely_measures_them():
    curves = np.array([*rings(0, 20), shapely.linestrings([[2, 3]] * 4)])
    area, perimeter, centre = measure_curves(curves)
    sizes = shapely.area([shapely.Polygon(curve.coords) for curve in curves])
    assert area == pytest.approx(np.where(shapely.is_ccw(curves), sizes, -sizes), abs=1e-12)
    assert perimeter == pytest.approx(shapely.length(curves), rel=1e-12)
    assert centre == pytest.approx(shapely.get_coordinates(shapely.centroid(curves)), abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_contours_around_a_contour(seed):
    curves, level = np.array([*rings(seed, 40)]), np.arange(40) % 3
    area = measure_curves(curves)[0]
    nest = Nest(curves, area, np.full(40, 1e-12), level, 1e-9, None)
    polygons = np.array([shapely.Polygon(curve.coords) for curve in curves])
    for one in range(40):
        larger = np.flatnonzero((level == level[one]) & (np.abs(area) >= abs(area[one]) - 2e-12)).tolist()
        larger.remove(one)
        met = [k for k in larger if shapely.box(*curves[k].bounds).intersects(shapely.box(*curves[one].bounds))]
        assert sorted(nest.near.get(one, [])) == met
        for other in met:
            points = shapely.get_coordinates(curves[one])
            inside = shapely.contains_xy(polygons[other], (points[1:] + points[:-1]) / 2)
            if shapely.distance(curves[one], curves[other]) > 1e-6:
                assert nest.innermost(one, [other]) == (other if inside.all() else -1, False)
            elif 0 < inside.mean() < 1:
                assert nest.innermost(one, [other]) == (-1, True)
