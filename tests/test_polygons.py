"""Polygons cut into triangles: areas and volumes by exact formulas, the same ones from any first corner."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mesh_writers import ORDERS, write_mesh
from reebslice.errors import MeshFormatError
from reebslice.formats import polygons
from reebslice.formats.meshes import read_mesh
from reebslice.formats.polygons import cut_polygons
from reebslice.mesh.inspection import inspect_surface

U = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
KEYHOLE = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]
WITH_COLLINEAR = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (1, 1), (1, 0.5), (0, 0.5), (0, 0.25)]
WITH_REPEATED = [(0, 0), (4, 0), (4, 0), (4, 4), (2, 1), (2, 1), (0, 4)]
SPIKE = [(0, 0), (4, 0), (6, 0), (4, 0), (4, 4), (0, 4)]
SHAPES = {"u": U, "keyhole": KEYHOLE, "collinear": WITH_COLLINEAR, "repeated": WITH_REPEATED, "spike": SPIKE}


def shoelace(outline):
    """The area of a polygon in the plane, Gauss's formula."""
    x, y = np.asarray(outline, float).T
    return (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2


def in_space(outline):
    return np.column_stack([np.asarray(outline, float), np.zeros(len(outline))])


def cut(points, order=None):
    order = np.arange(len(points)) if order is None else order
    return cut_polygons(points, np.asarray(order, np.int32), np.array([len(order)]))


def vector_areas(points, faces):
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def ring(faces):
    """The directed mesh edges that have no opposite."""
    edges = {(int(a), int(b)) for face in faces for a, b in zip(face, np.roll(face, -1), strict=True)}
    return {edge for edge in edges if edge[::-1] not in edges}


def assert_fits(points, order, faces):
    """N - 2 triangles that do not fold, of the polygon's area, with its outline for a rim."""
    assert len(faces) == len(order) - 2
    areas = vector_areas(points, faces)
    normal = vector_areas(points, np.column_stack([np.zeros_like(order), order, np.roll(order, -1)])).sum(axis=0)
    size = np.ptp(points, axis=0).max() ** 2
    assert areas.sum(axis=0) == pytest.approx(normal, abs=1e-9 * size)
    assert (areas @ normal >= -1e-9 * size * np.linalg.norm(normal)).all()
    outline = {(int(a), int(b)) for a, b in zip(order, np.roll(order, -1), strict=True)}
    assert ring(faces) == {edge for edge in outline if edge[::-1] not in outline}


@pytest.mark.parametrize("outline", SHAPES.values(), ids=SHAPES)
def test_triangles_are_the_same_from_any_first_corner_and_of_either_winding(outline):
    points, order = in_space(outline), np.arange(len(outline))
    faces, notes = cut(points)
    assert_fits(points, order, faces)
    assert not notes and vector_areas(points, faces)[:, 2].sum() == pytest.approx(shoelace(outline), abs=1e-12)
    expected = sorted(sorted(face) for face in points[faces].tolist())
    for start in range(len(order)):
        for way in (1, -1):
            turned = np.roll(order, start)[::way]
            again = cut(points, turned)[0]
            assert sorted(sorted(face) for face in points[again].tolist()) == expected
            assert vector_areas(points, again)[:, 2].sum() == pytest.approx(way * shoelace(outline), abs=1e-12)


@pytest.mark.parametrize(
    "outline",
    [[(0, 0), (4, 4), (4, 0), (0, 5)], [(0, 0), (4, 4), (4, 0), (0, 4)], [(0, 0), (4, 4), (4, 0), (0, 4), (-1, 2)]]
    + [[(0, 0), (2, 2), (4, 4), (4, 0), (0, 4)]]
    + [[(np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5)) for k in range(5)]],
    ids=["bow", "even bow", "fish", "even fish", "pentagram"],
)
def test_an_outline_that_crosses_itself_is_refused_by_face(outline):
    points = in_space([(0, 0), (1, 0), (0, 1), *outline])
    corners, sizes = np.r_[0, 1, 2, 3 + np.arange(len(outline))].astype(np.int32), np.array([3, len(outline)])
    with pytest.raises(MeshFormatError, match=r"face 1, a polygon of \d corners, crosses itself"):
        cut_polygons(points, corners, sizes)


def test_a_dart_is_cut_inside_and_a_planar_quad_along_its_shorter_diagonal():
    dart = in_space([(0, 0), (2, 0), (0.5, 0.5), (0, 2)])
    assert {frozenset(face) for face in cut(dart)[0].tolist()} == {frozenset({0, 1, 2}), frozenset({0, 2, 3})}
    kite = in_space([(0, 0), (3, -1), (8, 0), (3, 1)])
    assert {frozenset(face) for face in cut(kite)[0].tolist()} == {frozenset({0, 1, 3}), frozenset({1, 2, 3})}


def test_a_quad_with_a_corner_in_a_side_gets_no_flat_triangle():
    points = in_space([(0, 0), (1, 0), (2, 0), (1, 5)])
    for start in range(4):
        faces = cut(points, np.roll(np.arange(4), start))[0]
        assert np.linalg.norm(vector_areas(points, faces), axis=1) == pytest.approx([2.5, 2.5])


def test_polygons_without_area_keep_their_outline():
    points = in_space([(0, 0), (4, 0), (5, 0), (2, 0), (1, 0)])
    for n in (4, 5):
        order = np.arange(n)
        assert ring(cut(points, order)[0]) == {(k, (k + 1) % n) for k in range(n)}


def test_bent_polygons_are_told_with_the_worst_one():
    lift = [0, 1e-5, 0.02, 0.2]
    points = np.vstack(
        [[[x, y, 3 * k + lift[k] * (x * y)] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))] for k in range(4)]
    )
    faces, notes = cut_polygons(points, np.arange(16, dtype=np.int32), np.full(4, 4))
    assert len(faces) == 8 and len(notes) == 1
    assert notes[0].startswith("2 of 4 polygons are bent") and "the first is face 2;" in notes[0]
    # The corners of the last stand 0.05 off their plane, to the cosine of its slope; the box has a diagonal of 1.43.
    bend = 0.05 / np.sqrt(1 + 2 * 0.1**2) / np.sqrt(2 + 0.2**2)
    assert f"at most it is {bend:.2%}, in face 3" in notes[0]


@pytest.mark.parametrize("shape", ["disc", "gear", "rectangle"])
def test_polygons_of_many_corners(shape):
    n = 4_000 if shape == "rectangle" else 70_000  # mapbox-earcut is slow where nearly all corners lie in line
    angle = np.arange(n) * 2 * np.pi / n
    outline = np.column_stack([np.cos(angle), np.sin(angle)])
    if shape == "gear":
        outline *= 1 + 0.1 * np.sin(50 * angle)[:, None]
    elif shape == "rectangle":
        side = np.arange(n // 4) / (n // 4)
        zero = np.zeros(n // 4)
        ahead = [(side, zero), (zero + 1, side), (1 - side, zero + 1), (zero, 1 - side)]
        outline = np.vstack([np.column_stack(pair) for pair in ahead])
    assert len(outline) == n
    points = in_space(outline)
    faces, _ = cut(points)
    areas = vector_areas(points, faces)[:, 2]
    assert len(faces) == n - 2 and areas.min() >= -1e-12
    assert areas.sum() == pytest.approx(shoelace(outline), rel=1e-12)


@pytest.mark.parametrize("outline", SHAPES.values(), ids=SHAPES)
def test_either_library_alone_gives_the_same_area_or_nothing(outline, monkeypatch):
    """What mapbox-earcut does not cut whole is left to manifold3d, which cuts all of these."""
    points, order = in_space(outline), np.arange(len(outline))
    monkeypatch.setattr(polygons, "_clip_ears", lambda places: np.zeros((0, 3), np.int64))
    assert_fits(points, order, cut(points)[0])


# --------------------------------------------------------------------------
# Random prisms through all formats


@st.composite
def outlines(draw):
    """A simple polygon, counter-clockwise: star-shaped, a comb or a spiral."""
    kind, n = draw(st.sampled_from(["star", "comb", "spiral"])), draw(st.integers(4, 12))
    numbers = draw(st.lists(st.integers(1, 16), min_size=n, max_size=n))
    heights = np.array(numbers) / 4
    if kind == "star":
        angle = 2 * np.pi * np.arange(n) / n
        return np.column_stack([heights * np.cos(angle), heights * np.sin(angle)])
    if kind == "comb":
        teeth = np.column_stack([np.arange(n), np.where(np.arange(n) % 2, 1 + heights, 0.5)])
        return np.vstack([teeth, [[n - 1, 0], [0, 0]]])[::-1]
    angle = np.arange(4 * n) / 2
    inner = np.column_stack([(1 + angle) * np.cos(angle), (1 + angle) * np.sin(angle)])
    return np.vstack([inner, 1.2 * inner[::-1]])[::-1]


def prism(outline, height, start):
    """Points and polygons of a prism whose caps begin at corner `start`."""
    n = len(outline)
    points = np.vstack([np.column_stack([outline, np.full(n, z)]) for z in (0, height)])
    ahead = np.roll(np.arange(n), -1)
    sides = np.column_stack([np.arange(n), ahead, n + ahead, n + np.arange(n)])
    caps = [np.roll(np.arange(n), start)[::-1], np.roll(n + np.arange(n), start)]
    return points, [one.tolist() for one in [*sides, *caps]]


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(outline=outlines(), height=st.sampled_from([0.5, 1, 7]), start=st.integers(0, 50), seed=st.integers(0, 2**20))
def test_random_prisms_have_their_area_and_volume_in_every_format(tmp_path, outline, height, start, seed):
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points, faces = prism(outline, height, start)
    points = points @ turn.T
    area = shoelace(outline)
    around = np.linalg.norm(outline - np.roll(outline, 1, axis=0), axis=1).sum()
    read = {}
    for end in ("obj", "off", *ORDERS):
        mesh = read_mesh(write_mesh(tmp_path / f"prism.{end}", points, faces))
        assert mesh.notes == ()
        read[end] = mesh.points[mesh.faces]
        assert (read[end] == read["obj"]).all()
    found = inspect_surface(*mesh[:2])[1]
    assert (found["status"], found["components"], found["genus"]) == ("accepted", 1, 0)
    assert found["volume"] == pytest.approx(area * height, rel=1e-9)
    assert found["area"] == pytest.approx(2 * area + around * height, rel=1e-9)
    for end in ("stl", "ascii.stl"):
        mesh = read_mesh(write_mesh(tmp_path / f"prism.{end}", mesh.points, mesh.faces.tolist()))
        assert mesh.points[mesh.faces] == pytest.approx(read["obj"], rel=1e-6, abs=1e-5)


def test_a_bent_quad_is_cut_and_told_although_it_folds_as_seen_along_its_normal():
    points = np.array([[0, 0, 0], [1, 1, 0.6], [1, 0, 0], [0.1, 1, -0.6]])
    faces, notes = cut_polygons(points, np.arange(4, dtype=np.int32), np.array([4]))
    assert len(faces) == 2 and "bent" in notes[0]
    with pytest.raises(MeshFormatError, match="crosses itself"):  # the same, flat
        cut_polygons(points * [1, 1, 0], np.arange(4, dtype=np.int32), np.array([4]))


def test_an_outline_that_covers_itself_without_folding_is_refused():
    turns = np.linspace(0, 2.6 * np.pi, 13)  # a strip of a ring that goes around more than once
    ring = [np.column_stack([r * np.cos(turns), r * np.sin(turns)]) for r in (2, 3)]
    outline = np.vstack([ring[1], ring[0][::-1]])
    points = np.column_stack([outline, np.zeros(len(outline))])
    with pytest.raises(MeshFormatError, match="crosses itself"):
        cut_polygons(points, np.arange(len(points), dtype=np.int32), np.array([len(points)]))
