"""The inspection of surfaces: mathematics, defects made on purpose, and laws."""

import itertools
import json

import networkx as nx
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import make_examples
from make_examples import EXPECTED
from reebslice.formats.meshes import read_mesh
from reebslice.mesh import closing, half_edges, measures, merging, orders, sheets, shells
from reebslice.mesh.inspection import REPAIRS, inspect_surface
from reebslice.mesh.orders import sort_faces


def ball(radius=1.0, at=(0, 0, 0), inward=False, subdivisions=1):
    mesh = trimesh.creation.icosphere(subdivisions, radius=radius)
    faces = np.array(mesh.faces)
    return mesh.vertices + np.array(at, float), faces[:, ::-1] if inward else faces


def torus(sections=12):
    mesh = trimesh.creation.torus(3, 1, major_sections=sections, minor_sections=8)
    return np.array(mesh.vertices), np.array(mesh.faces)


def box(low=(0, 0, 0), high=(1, 1, 1)):
    mesh = trimesh.creation.box(bounds=[low, high])
    return np.array(mesh.vertices), np.array(mesh.faces)


def join(*parts):
    counts = np.cumsum([0] + [len(points) for points, _ in parts])
    faces = [faces + count for (_, faces), count in zip(parts, counts)]
    return np.concatenate([points for points, _ in parts]), np.concatenate(faces)


def soup(points, faces):
    """Every face with corners of its own, as STL has them."""
    return points[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)


def inspected(mesh, **options):
    tables, found = inspect_surface(*mesh, options)
    assert tables is not None, found["reason"]
    check_surface(tables, found)
    return tables, found


def check_surface(tables, found):
    """The promises of the canonical surface, checked from the tables alone."""
    points = np.column_stack([tables["vertices"][axis] for axis in "xyz"])
    faces = np.column_stack([tables["faces"][corner] for corner in "abc"])
    rows = [tuple(row) for row in points]
    assert rows == sorted(rows) and not np.any(np.signbit(points) & (points == 0))
    assert np.all(faces[:, 0] < faces[:, 1:].min(axis=1))
    assert [tuple(row) for row in faces] == sorted(tuple(row) for row in faces)
    halves = {(a, b) for face in faces for a, b in zip(face, np.roll(face, -1))}
    assert len(halves) == 3 * len(faces)
    assert halves == {(b, a) for a, b in halves}
    table = tables["shells"].to_pydict()
    chi = len(points) - len(halves) // 2 + len(faces)
    assert found["euler_characteristic"] == chi == sum(table["euler_characteristic"])
    assert [v < 0 for v in table["volume"]] == table["void"]
    for shell, body in enumerate(table["body"]):
        assert (body == shell) == (not table["void"][shell]) and not table["void"][body]
    corners = points[faces] - points[0]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(found["volume"], rel=1e-6, abs=1e-9)
    json.dumps(found, allow_nan=False)


def same(one, other):
    return all(one[name].equals(other[name]) for name in ("vertices", "faces", "shells"))


# --------------------------------------------------------------------------
# Textbook answers


def test_ball_torus_and_box():
    assert inspected(ball())[1]["genus"] == 0
    assert inspected(torus())[1]["genus"] == 1
    found = inspected(box(high=(1, 2, 3)))[1]
    assert (found["status"], found["area"], found["volume"]) == ("accepted", 22, 6)
    assert found["bounds"] == [[0, 0, 0], [1, 2, 3]]


def test_volume_is_sure_far_from_the_origin():
    found = inspected(box(low=(1e8, 1e8, 1e8), high=(1e8 + 1, 1e8 + 1, 1e8 + 1)))[1]
    assert found["volume"] == pytest.approx(1, rel=1e-12)


def test_exact_volume_decides_what_rounding_cannot():
    points, faces = box(low=(0, 0, 0), high=(1, 1, 1))
    assert measures.sum_volume_exactly(points, faces) == 1
    assert measures.sum_volume_exactly(points * [1, 1, 0], faces) == 0


@pytest.mark.parametrize("name", EXPECTED)
def test_examples(tmp_path_factory, name):
    folder = tmp_path_factory.getbasetemp() / "examples"
    if not folder.exists():
        make_examples.main(folder)
    found = inspected(read_mesh(folder / name)[:2])[1]
    assert (found["genus"], found["voids"], found["components"]) == EXPECTED[name]
    assert found["status"] == "accepted" and 1000 <= found["n_faces"] <= 20000


def test_linked_rings_and_knot_keep_their_distance():
    rings = [make_examples._to_manifold(ring) for ring in make_examples.make_linked_rings()]
    assert min(one.min_gap(two, 9) for one, two in itertools.pairwise(rings)) > 1
    centres = make_examples.make_trefoil().vertices.reshape(240, 32, 3).mean(axis=1)
    apart = np.linalg.norm(centres[:, None] - centres, axis=2)
    steps = np.abs(np.arange(240)[:, None] - np.arange(240))
    assert apart[np.minimum(steps, 240 - steps) > 30].min() > 2 * 5.1


def test_examples_have_the_same_bytes_every_time(tmp_path):
    for folder in "ab":
        make_examples.main(tmp_path / folder)
    for name in EXPECTED:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


# --------------------------------------------------------------------------
# Nesting


def nest(*inward):
    """Balls, each inside the one before; says which face inward."""
    return join(*(ball(2.0**-k, inward=turned) for k, turned in enumerate(inward)))


@pytest.mark.parametrize(
    "inward, voids, status",
    [
        ([False], 0, "accepted"),
        ([True], 0, "repaired"),
        ([False, True], 1, "accepted"),
        ([False, True, False], 1, "accepted"),
        ([False, True, False, True], 2, "accepted"),
        ([True, False], 1, "repaired"),  # a hollow ball turned inside out
        ([True, False, True], 1, "repaired"),
        ([True, True], 1, "repaired"),  # only the outer one is wrong
        ([False, False], 0, "accepted"),  # overlapping bodies stay apart
        ([False, False, True], 1, "accepted"),
        ([False, True, True], 1, "repaired"),  # in a void nothing can be hollow
    ],
)
def test_nested_balls(inward, voids, status):
    found = inspected(nest(*inward))[1]
    assert (found["voids"], found["status"]) == (voids, status)


def test_void_belongs_to_the_smallest_body_that_is_solid_there():
    # Seen from outside: body, body in it, void of the inner one, void of the outer one.
    tables, _ = inspected(nest(False, False, True, True))
    table = tables["shells"].to_pydict()
    assert table["body"] == [0, 1, 1, 0]
    assert table["parent"] == [None, 0, 1, 2]


def test_parts_side_by_side_and_linked():
    ring = torus(24)
    other = ring[0][:, [0, 2, 1]] * [1, -1, 1] + [3, 0, 0]
    found = inspected(join(ring, (other, ring[1][:, ::-1]), ball(at=(9, 9, 9), inward=True)))[1]
    assert (found["components"], found["voids"], found["genus"]) == (3, 0, 2)


def test_shells_that_touch_or_coincide_enclose_nothing():
    assert shells.find_enclosing(*_labelled(ball(), ball())) == [[], []]
    inner, outer = box((0, 0, 0), (1, 1, 1)), box((0, 0, 0), (4, 4, 4))
    assert shells.find_enclosing(*_labelled(inner, outer)) == [[1], []]


def _labelled(*parts):
    points, faces = join(*parts)
    return points, faces, np.repeat(np.arange(len(parts)), [len(f) for _, f in parts]), len(parts)


def test_rays_through_vertices_and_edges():
    points, faces = box((-1, -1, -1), (1, 1, 1))
    grid = np.array([[x, y, z] for x in (-2, -1, 0, 1, 2) for y in (-2, -1, 0, 1) for z in (-3, 0, 3)], float)
    inside, on = shells.cast_rays(points, faces, grid, 1e-12)
    expected = np.all(np.abs(grid) < 1, axis=1)
    surface = np.all(np.abs(grid) <= 1, axis=1) & ~expected
    assert np.array_equal(inside[~on & ~surface], expected[~on & ~surface])
    assert not on[~surface].any()


# --------------------------------------------------------------------------
# Defects and repairs


def test_open_surface_is_located_and_cured():
    points, faces = torus()
    tables, found = inspect_surface(points, faces[2:])
    assert tables is None and found["status"] == "rejected"
    assert "mesh edges have only one face, the first from (" in found["reason"]
    assert "fill the holes" in found["reason"] and found["closed"] is False


def test_noise_needs_the_smallest_tolerance_that_closes():
    points, faces = soup(*torus())
    rng = np.random.default_rng(1)
    noisy = points + rng.uniform(-1, 1, points.shape) * 8 * 2e-10
    _tables, found = inspected((noisy, faces))
    assert found["tolerance"] in (1e-10, 1e-9) and found["genus"] == 1
    assert "open mesh edges" in found["repairs"][0]
    assert inspect_surface(noisy, faces, {"merge_tolerance": 1e-11})[1]["status"] == "rejected"
    found = inspect_surface(noisy, faces, {"repair": ["split"]})[1]
    assert "add merge to inspect.repair" in found["reason"]


def test_exactly_closed_surface_is_never_merged_by_tolerance():
    points, faces = ball(subdivisions=2)
    tiny = points * 1e-9 + [0, 0, 2]  # vanishes at a tolerance of 1e-6
    found = inspected(join((points, faces), (tiny, faces)))[1]
    assert (found["status"], found["components"]) == ("accepted", 2)


def test_merge_that_would_swallow_a_part_is_refused():
    rng = np.random.default_rng(2)
    points, faces = soup(*ball())
    dust = points * 1e-8 + [0, 0, 2] + rng.uniform(-1, 1, points.shape) * 8e-9
    assert inspect_surface(*join(ball(), (dust, faces)))[1]["status"] == "rejected"


def test_merging_does_not_chain():
    line = np.column_stack([np.arange(20.0), np.zeros((20, 2))])
    assert merging.merge_nearby(line, np.arange(20), 1.0) is None
    assert merging.merge_nearby(line, np.array([3, 4, 9]), 1.0).tolist()[:5] == [0, 1, 2, 3, 3]
    assert merging.list_tolerances(0) == []


def test_minus_zero_is_zero():
    points, faces = box((-1, -1, 0), (1, 1, 1))
    points, faces = soup(points, faces)
    points[::2] *= np.where(points[::2] == 0, -1.0, 1.0)
    assert np.signbit(points[points == 0]).any()
    assert inspected((points, faces))[1]["status"] == "accepted"


def test_duplicates_are_dropped_only_if_that_closes_the_surface():
    points, faces = torus()
    found = inspected((points, np.concatenate([faces, faces[3:5], faces[4:5, ::-1]])))[1]
    assert found["duplicate_faces_removed"] == 3 and found["genus"] == 1
    mesh = points, np.concatenate([faces, faces[:1]])
    assert "add duplicates to" in inspect_surface(*mesh, {"repair": ["merge"]})[1]["reason"]


def test_degenerate_faces_go_and_collinear_faces_stay():
    points, faces = box()
    # Put a vertex into the middle of a mesh edge on one side only, and fill with a flat face.
    a, b, c = faces[0]
    middle = (points[a] + points[b]) / 2
    points = np.concatenate([points, [middle]])
    split = [[a, 8, c], [8, b, c], [a, b, 8], [a, a, b]]
    _tables, found = inspected((points, np.concatenate([faces[1:], split])))
    assert found["collinear_faces"] == 1 and found["degenerate_faces_removed"] == 1
    assert (found["genus"], found["n_faces"]) == (0, 14)
    assert found["volume"] == pytest.approx(1)


def test_pinched_vertex_is_split():
    one, two = box((0, 0, 0), (1, 1, 1)), box((1, 1, 1), (2, 2, 2))
    _tables, found = inspected(join(one, two))
    assert (found["components"], found["pinch_vertices_split"]) == (2, 1)
    assert found["n_vertices"] == 16
    reason = inspect_surface(*join(one, two), {"repair": ["orient"]})[1]["reason"]
    assert "add split to" in reason and "(1, 1, 1)" in reason


def test_parts_that_touch_along_an_edge_come_apart():
    touching = join(box((0, 0, 0), (1, 1, 1)), box((1, 1, 0), (2, 2, 1)))
    tables, found = inspected(touching)
    assert found["components"] == 2 and found["manifold"]
    assert "took apart 1 mesh edges" in found["repairs"][0] and "(1, 1, 0) to (1, 1, 1)" in found["repairs"][0]
    again, record = inspected(soup(*touching))
    assert same(again, tables) and record == found
    fin = soup(*join(touching, (np.array([[1, 1, 0], [1, 1, 1], [3, 0, 0.0]]), np.array([[0, 1, 2]]))))
    found = inspect_surface(*fin)[1]
    assert "1 mesh edges have three or more faces" in found["reason"] and found["manifold"] is False


def test_shuffled_winding_is_made_consistent():
    rng = np.random.default_rng(3)
    mesh = points, faces = nest(False, True, False)
    turned = np.where(rng.random(len(faces))[:, None] < 0.3, faces[:, ::-1], faces)
    tables, found = inspected((points, turned))
    assert same(tables, inspected(mesh)[0])
    assert found["voids"] == 1 and "winding of 3 of 3 shells" in found["repairs"][0]
    reason = inspect_surface(points, turned, {"repair": ["merge"]})[1]["reason"]
    assert "add orient to" in reason


def test_inward_mesh_gives_the_same_surface():
    mesh = points, faces = join(torus(), ball(at=(20, 0, 0)))
    tables, found = inspected((points, faces[:, ::-1]))
    assert same(tables, inspected(mesh)[0]) and "2 of 2 shells that faced inward" in found["repairs"][0]


def test_klein_bottle_is_rejected():
    i, j = np.meshgrid(np.arange(12), np.arange(12), indexing="ij")

    def number(i, j):
        return np.where(i >= 12, 0, i) * 12 + np.where(i >= 12, -j, j) % 12

    a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    points = np.random.default_rng(4).random((144, 3))
    found = inspect_surface(points, faces)[1]
    assert "one-sided" in found["reason"] and found["closed"] and found["oriented"] is False


def test_flat_part_is_rejected():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    found = inspect_surface(points, np.array([[0, 1, 2], [2, 1, 0]]))[1]
    assert "enclose no volume" in found["reason"]


@pytest.mark.parametrize(
    "points, faces, words",
    [
        (np.zeros((0, 3)), np.zeros((0, 3), int), "no faces"),
        (np.eye(3), [[0, 1, 3]], "vertex 3, but there are 3"),
        (np.eye(3), [[0, 1, -1]], "vertex -1, but there are 3"),
        (np.eye(3) * [1, 1, np.nan], [[0, 1, 2]], "not finite"),
        (np.eye(3) * 1e90, [[0, 1, 2]], "scale"),
        (np.eye(3) * 1e-90, [[0, 1, 2]], "scale"),
        (np.eye(3), [[0, 0, 1]], "two equal corners"),
    ],
)
def test_unusable_numbers(points, faces, words):
    tables, found = inspect_surface(points, np.asarray(faces))
    assert tables is None and words in found["reason"] and found["status"] == "rejected"


def test_largest_floats_of_single_precision_are_fine():
    low, high = np.full(3, -3.4e38), np.full(3, 3.4e38)
    assert inspected(box(low, high))[1]["volume"] == pytest.approx(6.8e38**3)


@pytest.mark.parametrize(
    "options, words", [({"repair": ["weld"]}, "weld"), ({"merge_tolerance": -1}, "merge_tolerance")]
)
def test_unknown_options(options, words):
    with pytest.raises(ValueError, match=words):
        inspect_surface(*ball(), options)


def test_no_repair_is_needed_by_a_clean_mesh():
    assert inspected(soup(*torus()), repair=[])[1]["status"] == "accepted"


# --------------------------------------------------------------------------
# Laws

MESHES = {
    "torus": torus(6),
    "nest": nest(False, True, False),
    "inverted": nest(True, False),
    "pinched": join(box(), box((1, 1, 1), (2, 2, 2)), box((-1, -1, 1), (0, 0, 2))),
    "bodies": join(ball(), ball(0.7, (0.6, 0, 0)), ball(0.2, (5, 0, 0), inward=True)),
}


def disturb(mesh, rng, apart, jitter=0.0):
    """The same faces in another order, from other corners, over other points."""
    points, faces = mesh
    if apart:
        points, faces = soup(points, faces)
    extra = rng.integers(0, len(points), len(points))
    points = np.concatenate([points, points[extra]])
    doubles = {one: k + len(points) - len(extra) for k, one in enumerate(extra)}
    swap = rng.random(faces.shape) < 0.5
    faces = np.where(swap, np.vectorize(lambda v: doubles.get(v, v))(faces), faces)
    order = rng.permutation(len(points))
    place = np.argsort(order)
    faces = place[faces][rng.permutation(len(faces))]
    turns = (np.arange(3) + rng.integers(0, 3, len(faces))[:, None]) % 3
    return points[order], np.take_along_axis(faces, turns, axis=1)


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(sorted(MESHES)), st.integers(0, 2**32 - 1), st.booleans())
def test_order_and_repetition_of_corners_change_nothing(name, seed, apart):
    expected, record = inspected(MESHES[name])
    tables, found = inspect_surface(*disturb(MESHES[name], np.random.default_rng(seed), apart))
    assert same(tables, expected) and found == record


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_order_changes_nothing_when_corners_are_merged_by_tolerance(seed):
    rng = np.random.default_rng(7)
    points, faces = soup(*torus(6))
    noisy = points + rng.uniform(-1, 1, points.shape) * 1e-9
    expected, record = inspected((noisy, faces))
    tables, found = inspect_surface(*disturb((noisy, faces), np.random.default_rng(seed), False))
    assert record["tolerance"] > 0 and same(tables, expected) and found == record


@settings(max_examples=20, deadline=None)
@given(st.sampled_from(sorted(MESHES)), st.integers(0, 2**32 - 1))
def test_turning_the_axes_changes_no_number(name, seed):
    points, faces = MESHES[name]
    turn = trimesh.transformations.random_rotation_matrix(np.random.default_rng(seed).random(3))
    before, after = inspected((points, faces))[1], inspected((points @ turn[:3, :3].T, faces))[1]
    for key in ("components", "genus", "voids", "euler_characteristic", "n_vertices", "n_faces"):
        assert after[key] == before[key]
    assert after["volume"] == pytest.approx(before["volume"])


def test_result_is_a_fixed_point():
    for mesh in MESHES.values():
        tables, _ = inspected(mesh)
        points = np.column_stack([tables["vertices"][axis] for axis in "xyz"])
        faces = np.column_stack([tables["faces"][corner] for corner in "abc"]).astype(np.int64)
        again, _ = inspected((points, faces))
        assert same(again, tables)


def test_fans_are_the_link_cycles():
    points, faces = merging.merge_exactly(*MESHES["pinched"])
    glued = closing.glue(faces, len(points))
    assert len(np.unique(sheets.label_corners(glued.faces, glued.opposite))) == 24
    component = sheets.label_components(glued.faces, glued.opposite)[0]
    split, origin = sheets.split_pinches(glued.faces, glued.opposite, component, len(points))
    assert len(origin) == 24 and np.array_equal(origin[split], glued.faces)


def test_other_halves_of_mesh_edges_are_those_of_the_groups():
    for name, (points, faces) in MESHES.items():
        positions, merged = merging.merge_exactly(points, faces)
        merged = merged[closing.find_distinct(merged)]
        for chosen in (merged, merged[1:], merged[np.r_[0, 0, 0 : len(merged)]], merged[::2]):
            opposite = half_edges.match_half_edges(chosen, len(positions))
            order, starts = half_edges.group_half_edges(chosen, len(positions))
            assert (opposite is None) == bool((np.diff(starts) != 2).any()), name
            if opposite is not None:
                assert opposite.tolist() == half_edges.pair_half_edges(order).tolist()


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_components_are_those_of_a_graph(share):
    random = np.random.default_rng(0)
    for mesh in MESHES.values():
        points, faces = merging.merge_exactly(*mesh)
        faces = np.where(random.random((len(faces), 1)) < share, faces[:, ::-1], faces)
        glued = closing.glue(faces, len(points))
        if not closing.is_closed(glued):
            continue
        component, turned, conflict = sheets.label_components(glued.faces, glued.opposite)
        graph = nx.Graph(zip(np.arange(3 * len(faces)) // 3, glued.opposite // 3))
        parts = sorted(nx.connected_components(graph), key=min)
        assert [set(np.flatnonzero(component == k)) for k in range(len(parts))] == parts
        tails, turns = glued.faces.ravel(), np.repeat(turned, 3)
        assert conflict < 0 and not turned[[min(part) for part in parts]].any()
        assert np.array_equal(tails == tails[glued.opposite], turns != turns[glued.opposite])


@pytest.mark.parametrize("stray", [2**32 + 1, -(2**32), 12])
def test_ids_of_no_vertex_are_told_however_large(stray):
    points, faces = ball(subdivisions=0)
    faces = faces.astype(np.int64)
    faces[3, 1] = stray
    reason = inspect_surface(points, faces)[1]["reason"]
    assert f"the first is in face 3: vertex {stray}, but there are 12 vertices" in reason


def test_repairs_are_the_documented_ones():
    assert set(REPAIRS) == {"merge", "duplicates", "split", "orient"}


def test_equal_corners_get_one_place_in_lexicographic_order():
    random = np.random.default_rng(0)
    points = random.integers(-1, 2, (400, 3)) * random.choice([1.0, -0.0, 0.25], (400, 3))
    faces = random.integers(0, 400, (90, 3))
    positions, merged = merging.merge_exactly(points, faces)
    assert positions.tolist() == np.unique(points[np.unique(faces)] + 0.0, axis=0).tolist()
    assert not np.signbit(positions[positions == 0]).any()
    assert positions[merged].tolist() == points[faces].tolist()
    scattered = random.random((300, 3))  # more positions than faces
    assert len(merging.merge_exactly(scattered, np.arange(300).reshape(-1, 3))[0]) == 300


def test_orders_of_faces_and_half_edges_are_those_of_slow_sorts():
    random = np.random.default_rng(0)
    faces = np.array([random.permutation(12)[:3] for _ in range(300)])
    corners = orders.order_corners(faces, 12)
    turned = faces.ravel()[corners].tolist()
    first = [int(np.argmin(face)) for face in faces]
    keys = [(sorted(face), list(np.roll(face, -k)) != sorted(face), i) for i, (face, k) in enumerate(zip(faces, first))]
    assert turned == [np.roll(faces[i], -first[i]).tolist() for *_, i in sorted(keys)]
    single = list({tuple(face[:2]): face for face in faces.tolist()}.values())
    assert sort_faces(np.array(single, np.int32), 12).tolist() == sorted(single)
    order, starts = half_edges.group_half_edges(faces, 12)
    ends = [tuple(sorted((faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]))) for h in range(900)]
    assert order.tolist() == sorted(range(900), key=lambda h: ends[h])
    grouped = [{ends[h] for h in order[begin:end]} for begin, end in itertools.pairwise(starts)]
    assert all(len(group) == 1 for group in grouped) and len(grouped) == len(set(ends))


def test_measures_are_those_of_numpy():
    random = np.random.default_rng(0)
    points, faces, shell = random.random((50, 3)), random.integers(0, 50, (200, 3)), random.integers(0, 4, 200)
    shell[:4] = range(4)
    areas, volumes = measures.measure_shells(points, faces, shell, 4)
    a, b, c = (points[faces[:, k]] for k in range(3))
    assert areas == pytest.approx(np.bincount(shell, np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2))
    a, b, c = (corner - points[faces[[np.argmax(shell == s) for s in range(4)], 0]][shell] for corner in (a, b, c))
    assert volumes == pytest.approx(np.bincount(shell, np.einsum("ij,ij->i", a, np.cross(b, c)) / 6))
