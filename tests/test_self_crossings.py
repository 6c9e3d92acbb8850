"""Faces that cross: all of them and no others, against brute force in rational numbers, and what is told of them."""

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import certify
import solids
from crossings_reference import crossing_pairs
from pipeline import OPTIONS, run_stages
from reebslice import inspect_surface, read_mesh
from reebslice.mesh import exact_signs
from reebslice.mesh.crossing_places import describe_crossings, locate_meeting
from reebslice.mesh.self_crossings import find_crossings
from solids import Solid, box, carve, cube, icosphere, move, plate, scale, torus, transform, unite
from test_touching_bodies import pin, washer

SHARED = Path(__file__).parents[2] / "shared"
LEVELS = {"distance": 0.05, "refine": "exact", "feature_size": 0.1}
UNHURRIED = settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))


def pairs_of(solid):
    return set(map(tuple, find_crossings(solid.points, solid.faces).pairs.tolist()))


def counted(solid):
    """Pairs of faces that cross, of one body and of two, as the record of the inspection has them."""
    record = inspect_surface(solid.points, solid.faces)[1]
    assert record["status"] != "rejected", record["reason"]
    return record["self_crossings"], record["body_crossings"]


def agrees(solid):
    assert pairs_of(solid) == crossing_pairs(solid.points, solid.faces)


# --------------------------------------------------------------------------
# Against rational numbers

NUMBERS = st.one_of(
    st.integers(-2, 2).map(float),
    st.integers(-3, 3).map(lambda k: 1 + k * 2.0**-52),
    st.floats(-1e3, 1e3).map(lambda x: x if abs(x) > 1e-100 else 0.0),
    st.sampled_from([1e-30, 1e17, 1 / 3, 0.1]),
)
POINTS = st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=4, max_size=4)


@UNHURRIED
@given(POINTS)
def test_signs_are_those_of_rational_determinants(points):
    a, b, c, d = ([Fraction(x) for x in point] for point in points)
    u, v, w = ([y - x for x, y in zip(a, other)] for other in (b, c, d))
    side = sum(w[k] * (u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2]) for k in range(3))
    turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    scaled, work = exact_signs.scale_points(np.array(points)), np.empty(exact_signs.ROOM)
    assert exact_signs.side_sign(scaled, (0, 1, 2), 3, work) == (side > 0) - (side < 0)
    assert exact_signs.turn_sign(scaled, (0, 1, 2), 2, work) == (turn > 0) - (turn < 0)


@st.composite
def soups(draw):
    """A few tetrahedra with corners on a coarse grid: most contacts are degenerate."""
    corners = st.tuples(*[st.integers(0, 3)] * 3)
    parts = draw(st.lists(st.lists(corners, min_size=4, max_size=4, unique=True), min_size=1, max_size=4))
    return unite(*[Solid(np.array(part, float), solids.tetrahedron().faces) for part in parts])


@UNHURRIED
@given(soups(), st.sampled_from([None, 5, 8]))
def test_soups_of_tetrahedra(solid, turn):
    agrees(solid if turn is None else transform(solid, solids.rotation(turn)))


@st.composite
def perturbed(draw):
    """A closed mesh on a grid, some of its vertices moved."""
    base = draw(st.sampled_from([cube(), cube(1), icosphere(1), torus(2.0, 0.7, 6, 4), plate(1), solids.cup()]))
    random = np.random.default_rng(draw(st.integers(0, 10**6)))
    points = np.round(base.points * draw(st.sampled_from([1, 2, 3])))
    steps = random.integers(-1, 2, points.shape) * (random.random((len(points), 1)) < draw(st.sampled_from([0.1, 0.4])))
    noise = draw(st.sampled_from([0.0, 1e-16, 1e-3]))
    return Solid(points + steps + noise * random.standard_normal(points.shape), base.faces)


@UNHURRIED
@given(perturbed(), st.sampled_from([1.0, 0.1, 1e-25, 1e40]))
def test_perturbed_closed_meshes(solid, factor):
    agrees(scale(solid, factor))


@settings(UNHURRIED, max_examples=15)
@given(perturbed(), st.integers(0, 99))
def test_numbering_winding_and_units_make_no_difference(solid, seed):
    found = len(pairs_of(solid))
    assert len(pairs_of(solids.permute(solid, seed))) == found
    assert len(pairs_of(carve(solid))) == found
    assert len(pairs_of(scale(solid, 2.0**30))) == found


# --------------------------------------------------------------------------
# What crosses, and what touches

TALL = box(0.5, 0.5, 3, (0.25, 0.25, 0.25))


@pytest.mark.parametrize(
    "solid, body_crosses",
    [
        (unite(box(1, 1, 1), box(1, 1, 1, (1, 0, 0))), False),  # face on face
        (unite(box(1, 1, 1), box(2, 2, 1, (0.25, 0, 1))), False),  # part of a face
        (unite(box(1, 1, 1), box(1, 1, 1, (1, 1, 0))), False),  # along an edge
        (unite(box(1, 1, 1), box(1, 1, 1, (1, 1, 0.3))), False),  # along a part of an edge
        (unite(box(1, 1, 1), box(1, 1, 1, (1, 1, 1))), False),  # in a vertex
        (unite(box(4, 4, 1), move(icosphere(1, 1.0), [0, 0, 0.5 + 1.0])), False),  # a vertex or an edge on a face
        (unite(box(2, 2, 2), carve(box(1, 1, 1)), box(1, 1, 1)), False),  # an insert that fills a void
        (unite(box(3, 1, 1), box(1, 3, 1)), True),  # a cross of flush bars
        (unite(box(1, 1, 1), box(1, 1, 1, (0.5, 0, 0))), True),  # a flush shift
        (unite(box(1, 1, 1), TALL), True),  # through vertices, edges and flush walls
        (unite(box(2, 2, 2), box(1, 1, 1, (0.5, 0.5, 0.5))), True),  # inside, in a corner: flush walls
        (unite(box(2, 2, 2), box(1, 1, 1)), False),  # inside, clear of the walls
        (unite(solids.tetrahedron(), solids.tetrahedron()), True),  # the same twice
    ],
)
def test_bodies_that_touch_do_not_cross(solid, body_crosses):
    agrees(solid)
    both = find_crossings(solid.points, solid.faces).pairs
    assert bool(len(both)) == body_crosses
    for turn in (1, 2):  # what crosses by more than rounding still does
        if body_crosses and len(solid.faces) > 20:
            assert pairs_of(transform(solid, solids.rotation(turn)))


def octahedra(shift):
    """Two octahedra of which one, moved by `shift`, runs through the other along mesh edges only if that is 0.5 z."""
    points = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    faces = np.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])
    return unite(Solid(points, faces), Solid(points * [0.5, 0.5, 2] + shift, faces))


@pytest.mark.parametrize("shift", [(0, 0, 0), (0, 0, 0.5), (0.25, 0, 0), (0, 0, 3), (0, 0, 1.5)])
def test_sheets_that_cross_along_mesh_edges(shift):
    agrees(octahedra(np.array(shift, float)))


def topped(top, faces):
    """A box 4 x 4 x 1 whose top carries the vertices `top` (k, 3), meshed by `faces` over them after its corners."""
    bottom = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]]
    upper = [[0, 0, 1], [4, 0, 1], [4, 4, 1], [0, 4, 1]]
    sides = [(i, j, 4 + j) for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    sides += [(i, 4 + j, 4 + i) for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))]
    return Solid(np.array(bottom + upper + list(top), float), np.array([(0, 2, 1), (0, 3, 2), *sides, *faces]))


FAN = [(4, 5, 8), (5, 6, 8), (6, 7, 8), (7, 4, 8)]  # corners 4 to 7, and a vertex in the middle


def test_folds_in_a_plane_count():
    assert counted(topped([[2, 2, 1]], FAN)) == (0, 0)
    pleat = topped([[2, 5, 1]], FAN)  # the vertex lies beyond the top: a face is turned over, in its plane
    agrees(pleat)
    assert counted(pleat)[0] > 0
    inner = [*FAN[1:], (4, 9, 8), (9, 5, 8), (4, 5, 9)]
    assert counted(topped([[2, 2, 1], [2, 1, 1]], inner)) == (0, 0)
    assert counted(topped([[2, 2, 1], [2, 3, 1]], inner))[0] > 0  # one vertex of it beyond the other


def extruded(outline, cap):
    """A prism of height 1 over an outline in the plane y = 0, its cap meshed by `cap`."""
    n, points = len(outline), np.insert(np.array(outline, float), 1, 0, axis=1)
    i, j, cap = np.arange(n), (np.arange(n) + 1) % n, np.array(cap)
    walls = [np.stack([i, i + n, j + n], 1), np.stack([i, j + n, j], 1)]
    return Solid(np.concatenate([points, points + [0, 1, 0]]), np.concatenate([cap, n + cap[:, ::-1], *walls]))


def test_a_slot_of_no_width_touches_and_a_fin_of_no_thickness_is_folded():
    slot = [[0, 0], [3, 0], [3, 1], [1, 1], [3, 1], [3, 2], [0, 2]]
    slot = extruded(slot, [(0, 1, 2), (0, 2, 3), (0, 3, 6), (3, 4, 5), (3, 5, 6)])
    fin = [[0, 0], [1, 0], [1, 1], [3, 1], [1, 1], [1, 2], [0, 2]]
    fin = extruded(fin, [(0, 1, 2), (0, 2, 6), (2, 3, 4), (2, 4, 6), (4, 5, 6)])
    for solid, counts in ((slot, False), (fin, True)):
        assert find_crossings(solid.points, solid.faces).folded.tolist() == [True]
        for skew in (
            np.eye(3),
            [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
            [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
        ):  # without rounding
            found = describe_crossings(solid.points @ np.array(skew), solid.faces, np.zeros(len(solid.faces), int))
            assert (found["self_crossings"] > 0) == counts


def test_the_search_stops_where_it_is_told_to():
    solid = unite(box(3, 1, 1), box(1, 3, 1))
    assert find_crossings(solid.points, solid.faces).complete
    random = np.random.default_rng(0)
    many = Solid(random.random(icosphere(4).points.shape), icosphere(4).faces)
    found = find_crossings(many.points, many.faces, most=1000)
    assert not found.complete and len(found.pairs) >= 1000
    assert len(find_crossings(np.empty((0, 3)), np.empty((0, 3), int)).pairs) == 0


# --------------------------------------------------------------------------
# What is told


def test_places_are_on_both_faces():
    solid = unite(box(1, 1, 1), box(1, 1, 1, (0.5, 0.3, 0.2)))
    record = inspect_surface(solid.points, solid.faces)[1]
    assert record["crossing_places"] and record["self_crossings"] == 0 < record["body_crossings"]
    assert record["crossings"].startswith(f"{record['body_crossings']} pairs of faces of different bodies")
    for place in record["crossing_places"]:
        assert sorted(place["bodies"]) == [0, 1]
        away = np.abs(np.abs(np.array(place["point"]) - [[0, 0, 0], [0.5, 0.3, 0.2]]).max(axis=1) - 0.5)
        assert away.max() < 1e-12
    flat = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], float)
    assert locate_meeting(flat, flat + [1, 1, 0]) == pytest.approx([5 / 3, 5 / 3, 0])


def certified(solid, folder, told=None):
    run_stages(solid, folder, tilt={"mode": "auto"}, levels=LEVELS)
    record = json.loads((folder / "inspection.json").read_text())
    (folder / "inspection.json").write_text(json.dumps(record | (told or {})))
    certify.main(folder, folder, OPTIONS["levels"] | LEVELS)
    found = json.loads((folder / "certificate.json").read_text())
    assert bool(found["reason"]) == (found["verdict"] == "uncertified")
    return record, found, [name for name, check in found["checks"].items() if not check["holds"]]


def pocketed(end):
    """A box 3 x 3 x 3 with a pocket from its top, whose floor is the unit square from `end` on: ../shared/cases."""
    file = read_mesh(SHARED / "cases" / "pocket_through_wall.off")
    points = file.points.copy()
    points[12:] = points[8:12] + np.subtract(end, points[8])
    return Solid(points, file.faces)


needs_cases = pytest.mark.skipif(not (SHARED / "cases").is_dir(), reason="the folder ../shared/cases is absent")


@needs_cases
@pytest.mark.parametrize("shift, crosses", [(0.9, False), (1.0, False), (1.001, True), (1.1, True), (2.5, True)])
def test_a_pocket_that_leaves_through_a_wall_by_little_is_told(shift, crosses, tmp_path):
    record, found, failed = certified(pocketed((1 + shift, 1, 1)), tmp_path)
    assert failed == [] and found["verdict"] == "exact"
    assert bool(record["self_crossings"]) == crosses
    assert ("crosses itself" in found["solid_interpretation"]) == crosses
    assert not crosses or f"{record['self_crossings']} pairs" in found["solid_interpretation"]


@needs_cases
def test_a_hole_that_lies_in_no_contour_has_its_reason(tmp_path):
    record, found, _ = certified(pocketed((1, 1, -1)), tmp_path)  # below the box there is nothing but the hole
    assert record["self_crossings"] > 0 and found["verdict"] == "uncertified"
    assert found["reason"].startswith("The surface crosses itself")


@needs_cases
def test_a_count_of_zero_is_held_against_the_contours(tmp_path):
    _, found, failed = certified(pocketed((5, 1, 1)), tmp_path, {"self_crossings": 0})
    assert failed == ["crossings_of_a_body_are_told"] and found["verdict"] == "uncertified"


@pytest.mark.parametrize("seed, size", [(0, 1e-8), (1, 1e-8), (2, 1e-7), (3, 3e-7), (4, 1e-6), (5, 1e-5)])
def test_walls_that_run_through_one_another_within_rounding(seed, size, tmp_path):
    loose = pin(4, 0.4, 0.2, 0.8)
    steps = size * np.random.default_rng(seed).standard_normal((len(loose.points), 1)) * [1, 1, 0]
    solid = unite(washer(4, 1.5, 0.4, 0, 1), Solid(loose.points * (1 + steps), loose.faces))
    record, found, failed = certified(solid, tmp_path)
    assert record["body_crossings"] > 0 == record["self_crossings"]
    assert failed == [] and found["verdict"] == "exact" and found["betti_solid"] == [2, 1, 0]


@pytest.mark.parametrize("seed", range(3))
def test_an_insert_within_rounding_of_its_void(seed, tmp_path):
    steps = 1e-12 * np.random.default_rng(seed).standard_normal((12, 3))
    insert = pin(6, 0.4, 0, 1, True)
    solid = unite(pin(6, 1, -0.5, 1.5), carve(pin(6, 0.4, 0, 1)), Solid(insert.points + steps, insert.faces))
    record, found, failed = certified(solid, tmp_path)
    assert failed == [] and found["verdict"] == "exact" and found["betti_solid"] == [2, 0, 1]
    assert record["self_crossings"] == 0


# --------------------------------------------------------------------------
# Real meshes: pairs of one body and of two, confirmed by CGAL's exact kernel and, pair by pair, in rational numbers

REAL = {
    "abc8.stl": (0, 0), "bones26.off": (0, 366), "box_assembly.STL": (0, 1135), "conrod_nm.stl": (13, 0),
    "cow_pinch.off": (89, 0), "fingertip_void.obj": (9, 0), "gear_small_factory.obj": (6, 0), "gears7.stl": (47, 0),
    "human_man.obj": (76, 0), "mendel90_voids.ply": (0, 0), "octopus_33k.obj": (75, 0), "rings3.obj": (0, 0),
    "self_intersectA.obj": (338, 0), "two_hollow_squares.obj": (0, 0), "xyz_cube_20mm.stl": (0, 0),
}  # fmt: skip


@pytest.mark.skipif(not (SHARED / "meshes").is_dir(), reason="the corpus ../shared/meshes is absent")
@pytest.mark.parametrize("name", REAL)
def test_real_meshes(name):
    file = read_mesh(SHARED / "meshes" / name)
    assert counted(file) == REAL[name]
