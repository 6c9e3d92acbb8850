"""The certifier's compiled steps against slow, plain versions of the same questions."""

import networkx as nx
import numpy as np
import pyarrow as pa
import pytest
import shapely
import trimesh

from reebslice.certification.recount.components import find_components
from reebslice.certification.recount.curves import look, measure_curves, read_curves
from reebslice.certification.recount.elders import elder_pairs, essential_points
from reebslice.certification.recount.graph_pairs import graph_pairs
from reebslice.certification.recount.holes import ContourNesting
from reebslice.certification.recount.links import find_arms, find_links, smallest_tilt, whole_points
from reebslice.certification.recount.measures import find_least_rise, measure_shells
from reebslice.certification.recount.regions import build_polygons, find_regions, look_around, share
from reebslice.certification.recount.sides import local_sides
from reebslice.certification.recount.surface import count_links, find_mesh_edges, rank_surface
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
        with pytest.raises(ValueError, match="."):
            find_components(one, two, 3)


def ranked(solid, faces=None):
    faces = solid.faces if faces is None else faces
    return rank_surface(solid.points.T, np.eye(3), np.asarray(faces).T, np.zeros(len(faces)))[0]


@pytest.mark.parametrize("solid", [torus(), plate(2), hollow_ball(), blob(1)])
def test_mesh_edges_lie_between_two_faces(solid):
    surface = ranked(solid)
    sides = find_mesh_edges(surface)
    owners = {}
    for face, (a, b, c) in enumerate(surface.corners.tolist()):
        for place, pair in enumerate(((a, b), (b, c), (a, c))):
            owners.setdefault(pair, []).append((face, place))
    pairs = list(zip(sides.lower.tolist(), sides.upper.tolist()))
    assert sorted(pairs) == sorted(owners) and sides.lower.tolist() == sorted(sides.lower.tolist())
    assert sides.upper[sides.by_upper].tolist() == sorted(sides.upper.tolist())
    for side, pair in enumerate(pairs):
        assert sides.faces[side].tolist() == [face for face, _ in owners[pair]]
        assert all(sides.of_face[place] == side for place in owners[pair])
    assert (count_links(surface, sides) == 1).all()
    rises = surface.points[sides.upper, 2] - surface.points[sides.lower, 2]
    assert find_least_rise(surface.points, sides.lower, sides.upper) == min(rises.tolist())


def test_what_is_no_closed_oriented_surface_has_no_sides():
    faces = torus().faces
    for wrong in (
        faces[1:],
        np.concatenate([faces, faces[:1]]),
        np.concatenate([faces[:1, ::-1], faces[1:]]),
        np.concatenate([faces, faces]),
        np.concatenate([faces, [[0, 0, 1], [0, 1, 0]]]),
    ):
        assert find_mesh_edges(ranked(torus(), wrong)) is None


def test_links_are_counted_at_each_vertex():
    one = trimesh.creation.box()
    points = np.concatenate([one.vertices, one.vertices[1:] + 2 * one.vertices[0] * [-1, -1, -1], [[9, 9, 9]]])
    second = np.where(one.faces == 0, 7, np.where(one.faces == 7, 0, one.faces))
    second = np.where(second == 0, 0, second + 7)  # shares vertex 0 alone; vertex 15 is in no face
    solid = type(torus())(points, np.concatenate([one.faces, second]))
    surface = ranked(solid)
    sides = find_mesh_edges(surface)
    links = np.empty(16, np.int64)
    links[surface.origin] = count_links(surface, sides)
    assert links.tolist() == [2] + [1] * 14 + [0]


@pytest.mark.parametrize("seed", range(6))
def test_elder_pairs_join_the_younger_to_the_older(seed):
    random = np.random.default_rng(seed)
    n, n_contours = 40, 3 * (seed % 2)
    later = random.integers(1, n, 90)
    from_below = random.random(90) < 0.1 * (n_contours > 0)
    earlier = np.where(from_below, n + random.integers(0, 3, 90), random.integers(0, later))
    parts, expected = [{contour} for contour in range(n, n + n_contours)], []

    def age(part):
        return -1 if max(part) >= n else min(part)

    for v in range(n):
        met = [part for part in parts if part & set(earlier[later == v].tolist())]
        expected += [(age(part), v) for part in sorted(met, key=age)[1:] if age(part) >= 0]
        parts = [part for part in parts if part not in met] + [set().union({v}, *met)]
    assert sorted(map(tuple, elder_pairs(earlier, later, n, n_contours).tolist())) == sorted(expected)


@pytest.mark.parametrize("solid", [torus(), plate(2), hollow_ball(), blob(1)])
def test_essential_points_are_those_that_all_mesh_edges_tell(solid):
    surface = ranked(solid)
    sides, n = find_mesh_edges(surface), len(solid.points)
    upward = elder_pairs(sides.lower, sides.upper, n, 0)
    downward = n - 1 - elder_pairs(n - 1 - sides.upper, n - 1 - sides.lower, n, 0)
    count, pairs = essential_points(surface, sides)
    assert sorted(pairs.tolist()) == sorted([*upward.tolist(), *downward.tolist()])
    assert count.sum() == np.diff(surface.weight)[surface.index >= 0].sum() - 2 * len(pairs)


@pytest.mark.parametrize("solid", [torus(), plate(2), hollow_ball(), blob(1)])
def test_vertices_are_ranked_and_told_by_their_neighbours(solid):
    surface = ranked(solid)
    x, y, z = solid.points.T
    assert surface.origin.tolist() == np.lexsort((y, x, z)).tolist()
    links = [nx.Graph() for _ in solid.points]
    for face in surface.corners.tolist():
        for v in face:
            links[v].add_edge(*(w for w in face if w != v))
    for v, link in enumerate(links):
        above, below = ([w for w in link if (w > v) == up] for up in (True, False))
        wedges = nx.number_connected_components(link.subgraph(above))
        index = 0 if not below else 2 if not above else -1 if wedges == 1 else 1
        assert (surface.index[v], surface.weight[v + 1] - surface.weight[v]) == (index, max(wedges - 1, 1))


def test_shells_are_measured_one_by_one():
    solid = hollow_ball()
    shell = trimesh.Trimesh(solid.points, solid.faces, process=False)
    label = np.zeros(len(solid.faces), np.int64)
    for k, part in enumerate(trimesh.graph.connected_components(shell.face_adjacency)):
        label[part] = k
    area, volume = measure_shells(
        tuple((solid.points + 100.0).T.copy()), tuple(solid.faces.T.copy()), label, label.max() + 1
    )
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


def test_curves_are_read_as_they_were_written():
    lines = np.array([*rings(0, 5)])
    curves, drawn = read_curves([pa.array(shapely.to_wkb(part)) for part in (lines[:2], lines[1:])])
    assert drawn.all() and (curves.points == shapely.get_coordinates(lines[[0, 1, 1, 2, 3, 4]])).all()
    assert shapely.equals_exact(curves.lines([3, 0]), lines[[2, 0]]).all()
    roomy, _ = read_curves([pa.array(shapely.to_wkb(lines))], 1000)
    assert (roomy.points == shapely.get_coordinates(lines)).all()
    sliced, _ = read_curves([pa.array(shapely.to_wkb(lines)).slice(2, 2)])
    assert (sliced.points == shapely.get_coordinates(lines[2:4])).all()


def test_what_is_no_closed_plane_curve_is_not_drawn():
    good = shapely.to_wkb(shapely.linestrings([[0, 0], [1, 0], [0, 1], [0, 0]]))
    lines = ([[0, 0]] * 2, [[0, 0], [1, 0]], [[0, 0, 1], [1, 0, 1], [0, 0, 1]], [[0, 0], [np.nan, 0], [0, 0]])
    with np.errstate(invalid="ignore"):
        blobs = [good, *(shapely.to_wkb(shapely.linestrings(line)) for line in lines)]
    blobs += [b"", good[:-1], good + bytes(16), b"\0" + good[1:], shapely.to_wkb(shapely.Point(0, 0))]
    blobs += [shapely.to_wkb(shapely.linestrings([[0, 0], [np.inf, 0], [0, 0]])), good]
    curves, drawn = read_curves([pa.array(blobs, pa.binary())])
    assert drawn.tolist() == [True, True] + [False] * (len(blobs) - 3) + [True]
    assert curves.first[-1] == len(curves.points)
    assert read_curves([])[1].tolist() == []


def test_curves_are_measured_as_shapely_measures_them():
    lines = np.array([*rings(0, 20), shapely.linestrings([[2, 3]] * 4)])
    curves, _ = read_curves([pa.array(shapely.to_wkb(lines))])
    area, perimeter, centre, boxes = measure_curves(*curves)
    sizes = shapely.area([shapely.Polygon(line.coords) for line in lines])
    assert area == pytest.approx(np.where(shapely.is_ccw(lines), sizes, -sizes), abs=1e-12)
    assert perimeter == pytest.approx(shapely.length(lines), rel=1e-12)
    assert centre == pytest.approx(shapely.get_coordinates(shapely.centroid(lines)), abs=1e-12)
    assert (boxes == shapely.bounds(lines)).all()
    spots = np.random.default_rng(0).uniform(-2, 2, (21, 2))
    far = shapely.distance(lines, shapely.points(spots))
    for reach in (0.0, np.median(far), np.inf):
        inside, near = look(*curves, np.arange(21), spots, reach)
        assert near == pytest.approx(np.minimum(far, reach), rel=1e-12)
        assert inside.tolist() == shapely.contains_xy([shapely.Polygon(line.coords) for line in lines], spots).tolist()


def squares(*boxes, inward=()):
    """A square less others, as a list of rings; those of `inward` are drawn the other way round."""
    return [shapely.box(*box).exterior for box in boxes] + [shapely.box(*box).exterior.reverse() for box in inward]


def hold(regions):
    """Lists of rings, the outer one first, as :class:`regions.Regions`, and shapely's polygons of them."""
    region = np.repeat(np.arange(len(regions)), [len(rings) for rings in regions])
    inner = np.diff(region, prepend=-1) == 0
    lines = np.array([shapely.LineString(ring.coords) for rings in regions for ring in rings])
    curves, _ = read_curves([pa.array(shapely.to_wkb(lines))])
    area, length, *_ = measure_curves(*curves)
    polygons = np.array([shapely.Polygon(rings[0], rings[1:]) for rings in regions])
    return find_regions(curves, area, length, area, region, inner, len(regions)), polygons


def unlike_regions():
    """Regions that cross, touch, coincide or lie in one another, some with holes, one that crosses itself."""
    regions = [[line] for line in rings(3, 12)]
    regions += [squares((0, 0, 3, 2), (1, 1, 2, 1.5)), squares((0, 0, 3, 2), inward=[(1, 1, 2, 1.5)])]
    regions += [squares((1, 1, 2, 1.5)), squares((0, 0, 3, 2)), squares((3, 0, 4, 2)), squares((3, 2, 5, 4))]
    regions += [squares((-1, -1, 6, 6), (0, 0, 3, 2), (3.5, 2.5, 4, 3))]
    regions += [[shapely.LinearRing([(0, 0), (3, 1), (3, 0), (0, 2)])], [shapely.LinearRing([(0, 0), (2, 0), (1, 0)])]]
    star = np.random.default_rng(5).uniform(0.3, 3, 60)[:, None] * np.exp(2j * np.pi * np.arange(60) / 60)[:, None]
    return [*regions, [shapely.LinearRing(np.hstack([star.real, star.imag]))]]


def test_regions_share_the_areas_of_their_intersections():
    regions, polygons = hold(unlike_regions())
    flat, broken = len(polygons) - 2, len(polygons) - 3
    assert regions.broken.tolist() == [k == broken for k in range(len(polygons))]
    polygons[flat], polygons[broken] = shapely.Polygon(), shapely.make_valid(polygons[broken])
    assert regions.area == pytest.approx(shapely.area(polygons), abs=1e-12)
    assert regions.length == pytest.approx(shapely.length(polygons), rel=1e-12)
    one, other = np.indices((len(polygons),) * 2).reshape(2, -1)
    expected = shapely.area(shapely.intersection(polygons[one], polygons[other]))
    assert share(regions, one, other) == pytest.approx(expected, abs=1e-13 * 50)
    rows = np.array([15, 13, flat, broken, 13])
    assert shapely.equals(build_polygons(regions, rows), polygons[rows]).all()


def test_spots_are_seen_inside_and_near_as_shapely_sees_them():
    regions, polygons = hold(unlike_regions())
    broken = regions.broken.argmax()
    polygons[broken] = shapely.make_valid(polygons[broken])
    for seed in range(20):
        spots = np.random.default_rng(seed).uniform(-1, 4, (len(polygons), 2))
        inside, near, edge = look_around(regions, spots)
        usable = np.arange(len(polygons)) != len(polygons) - 2
        assert (inside == (shapely.contains_xy(polygons, spots) & usable)).all()
        far = shapely.distance(shapely.boundary(polygons), shapely.points(spots))
        assert edge[usable] == pytest.approx(far[usable]) and np.isinf(edge[~usable]).all()
        assert np.delete(near, broken) == pytest.approx(np.delete(far, broken))


@pytest.mark.parametrize("seed", range(3))
def test_contours_around_a_contour(seed):
    curves, level = np.array([*rings(seed, 40)]), np.arange(40) % 3
    read, _ = read_curves([pa.array(shapely.to_wkb(curves))])
    area, *_, boxes = measure_curves(*read)
    nest = ContourNesting(read, boxes, area, np.full(40, 1e-12), level, 1e-9, None)
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
                assert nest.innermost(one, [other]) == (other if inside.all() else -1, False, False)
            elif 0 < inside.mean() < 1:
                assert nest.innermost(one, [other]) == (-1, True, False)


@pytest.mark.parametrize("seed", range(6))
def test_loops_of_a_graph_end_where_no_way_stays_higher(seed):
    random, n = np.random.default_rng(seed), 30
    ends = [sorted(random.choice(n, 2, replace=False).tolist()) for _ in range(n + 4 * seed)]
    ends = sorted(ends + ends[:2], key=lambda pair: pair[1])  # two of them twice
    seen, loops = nx.Graph(), []
    seen.add_nodes_from(range(n))
    for low, high in ends:
        if nx.has_path(seen, low, high):
            above = (seen.subgraph(range(floor, n)) for floor in range(low, -1, -1))
            loops.append((next(min(part) for part in above if nx.has_path(part, low, high)), high))
        seen.add_edge(low, high)
    assert graph_pairs(n, ends)[2] == sorted(loops)


@pytest.mark.parametrize("solid", [torus(upright=True), plate(3, upright=True), hollow_ball(), blob(1)])
def test_sides_change_when_material_and_void_do(solid):
    surface, turned = ranked(solid), ranked(solid, solid.faces[:, ::-1])
    critical = np.flatnonzero(surface.index >= 0).tolist()
    sides, others = local_sides(surface, critical), local_sides(turned, critical)
    assert [{"A": "B", "B": "A", "": ""}[side] for side in sides] == others
    extrema = [side for vertex, side in zip(critical, sides) if surface.index[vertex] != 1]
    assert "" not in extrema and set(sides) >= {"A", "B"}
    assert (sides[0], sides[-1]) == ("A", "B")  # material begins at the lowest point and ends at the highest


@pytest.mark.parametrize("solid", [torus(upright=True), plate(3, upright=True), blob(1)])
def test_links_are_cycles_of_neighbours_seen_in_whole_numbers(solid):
    surface = ranked(solid)
    around, tilt = nx.Graph(), smallest_tilt(surface.points)
    for face in surface.corners.tolist():
        around.add_edges_from([face[:2], face[1:], face[::2]])
    for vertex, link in find_links(surface, list(range(0, len(solid.points), 3))).items():
        assert sorted(link) == sorted(around[vertex])
        assert all(around.has_edge(*pair) for pair in zip(link, link[1:] + link[:1]))
        heights = [h for _, _, h in find_arms(surface.points, tilt, vertex, link)]
        assert [h > 0 for h in heights] == [other > vertex for other in link] and 0 not in heights
    unit, whole = whole_points(surface.points[:5], tilt)
    assert [[x / unit, y / unit] for x, y, _ in whole] == surface.points[:5, :2].tolist()
