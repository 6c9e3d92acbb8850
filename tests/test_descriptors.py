"""Descriptors against shapes whose numbers are known, and the scores of retrieval against lists made by hand."""

import importlib
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.special import eval_legendre

from reebslice.descriptors.arcs import LENGTHS, RADII, VOLUMES, describe_arcs
from reebslice.descriptors.comparison import COMPARED, compare_descriptors, rank_by_neighbourhood
from reebslice.descriptors.persistence import (
    KINDS,
    persistence_images,
    pool_persistences,
    rank_persistences,
    take_pairs,
    turn_pairs,
)
from reebslice.descriptors.surface import describe_surface
from reebslice.descriptors.surface_points import (
    DEGREES,
    STEPS,
    betti_numbers,
    normal_powers,
    relate_pairs,
    sample_surface,
)
from reebslice.descriptors.thickness import describe_thickness, touching_balls
from reebslice.functions.barycentre import barycentric_distance
from reebslice.functions.geodesic import geodesic_distance
from reebslice.functions.heights import directional_height, spread_axes
from reebslice.graphs.function_graphs import graph_function
from reebslice.table_checks import build_table

ROOT = Path(__file__).parent.parent
TURN = Rotation.random(random_state=3).as_matrix()


@pytest.fixture
def benchmark(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    return importlib.import_module


def arrays(mesh):
    return np.array(mesh.vertices), np.array(mesh.faces)


def torus(major=1.0, minor=0.3):
    return arrays(trimesh.creation.torus(major, minor, 48, 24))


def graphs_of(points, faces, directions=6):
    values = {"geodesic": geodesic_distance(points, faces), "barycentre": barycentric_distance(points, faces)}
    values |= {f"height:{k}": directional_height(points, up) for k, up in enumerate(spread_axes(directions))}
    return {name: (value, *graph_function(name, value, points, faces)) for name, value in values.items()}


def describe(points, faces, directions=6):
    return describe_surface(points, faces, graphs_of(points, faces, directions))


def rows(columns):
    return {key: np.array(v) for *key, v in zip(*columns.values()) for key in [tuple(key)]}


def test_betti_numbers_of_shells_with_handles():
    points, faces = torus()
    ball = arrays(trimesh.creation.icosphere(1))
    assert betti_numbers(points, faces).tolist() == [1, 2, 1]
    both = np.concatenate([points, ball[0] + 5, [[9.0, 9, 9]]]), np.concatenate([faces, ball[1] + len(points)])
    assert betti_numbers(*both).tolist() == [2, 2, 2]
    found = describe_surface(*both, {})
    sizes = dict(zip(found["descriptor"], found["values"]))
    assert sizes["volume"] == pytest.approx([trimesh.Trimesh(*both).volume])
    assert sizes["area"] == pytest.approx([trimesh.Trimesh(*both).area])


def test_pairs_on_a_sphere_are_spread_as_chords_are():
    places, normals = sample_surface(*arrays(trimesh.creation.icosphere(5)))
    found = relate_pairs(places, normals).reshape(STEPS)
    assert found.sum() == pytest.approx(1)
    # chords of a unit sphere are at most d long with probability d^2 / 4; the mean is 4/3
    ends = np.minimum(np.linspace(0, 2.4, STEPS[0] + 1) * 4 / 3, 2)
    assert np.abs(found.sum(axis=(1, 2)) - np.diff(ends**2) / 4).max() < 0.01
    assert found[:, STEPS[1] // 2 + 1 :].sum() < 0.01  # n1.u - n2.u = -d


def test_powers_of_normals_are_those_of_the_addition_theorem():
    points, faces = arrays(trimesh.creation.box([1, 2, 3]))
    cross = trimesh.Trimesh(points, faces)
    share, cosines = cross.area_faces / cross.area, np.clip(cross.face_normals @ cross.face_normals.T, -1, 1)
    known = [np.sqrt((2 * n + 1) / (4 * np.pi) * max(share @ eval_legendre(n, cosines) @ share, 0)) for n in DEGREES]
    assert normal_powers(points @ TURN.T, faces) == pytest.approx(known, abs=1e-7)


def test_touching_balls_are_the_largest_ones_without_a_point_inside():
    places, normals = sample_surface(*torus(1.0, 0.3))
    radius = touching_balls(places, normals, 5.0)
    for one in range(0, len(places), 200):
        step = places[one] - np.delete(places, one, axis=0)
        above = step @ normals[one]
        through = (step[above > 0] ** 2).sum(axis=1) / (2 * above[above > 0])
        assert radius[one] >= through.min() * (1 - 1e-9)
        middle = places[one] - radius[one] * normals[one]
        assert np.linalg.norm(np.delete(places, one, axis=0) - middle, axis=1).min() >= radius[one] * (1 - 1.1e-3)
    area = trimesh.Trimesh(*torus(1.0, 0.3)).area
    found = describe_thickness(places, normals, area).reshape(10, 8).sum(axis=1)
    assert found.argmax() == int(np.log(0.29 / area**0.5 / 0.01) / np.log(40) * 10) and found.sum() == pytest.approx(1)


def test_persistences_of_a_torus_on_its_rim():
    points, faces = torus(1.0, 0.3)
    nodes, _ = graph_function("height", points[:, 0], points, faces)
    ranks = rank_persistences(*take_pairs(nodes))
    assert ranks[KINDS.index("extended"), 0] == pytest.approx(2.6, abs=0.01)
    assert ranks[KINDS.index("loop"), 0] == pytest.approx(1.4, abs=0.01)
    assert np.count_nonzero(ranks > 1e-9) == 2


def test_pooled_persistences_do_not_know_up_from_down():
    points, faces = torus()
    points = points + 0.1 * np.sin(5 * points[:, [1, 2, 0]])
    up, down = (
        take_pairs(graph_function("h", sign * points @ [0.6, 0.48, 0.64], points, faces)[0]) for sign in (1, -1)
    )
    assert np.allclose(np.sort(turn_pairs(*up)[0]), np.sort(down[0]))
    first, second = (pool_persistences(rank_persistences(*pairs)[None]) for pairs in (up, down))
    assert np.allclose(first, second)


def test_images_hold_every_kind_where_the_formula_says():
    low, high, kind = np.array([0.2, 0.1, 0.5]), np.array([0.7, 0.9, 0.6]), np.array([2, 1, 2])
    images = persistence_images(low, high, kind).reshape(4, 16, 16)
    pixel = (np.arange(16) + 0.5) / 16
    expected = np.zeros((4, 16, 16))
    for a, b, k in zip(low, high, kind):
        around = np.exp(-((pixel - a) ** 2 + (pixel[:, None] - (b - a)) ** 2) / (2 * 0.08**2)) / (2 * np.pi * 0.08**2)
        expected[k] += np.sqrt(b - a) * around
    centre = [np.unravel_index(images[k].argmax(), (16, 16)) for k in (1, 2)]
    assert centre == [np.unravel_index(expected[k].argmax(), (16, 16)) for k in (1, 2)]
    # gudhi puts its pixels from end to end of the range, not in the middle of sixteenths
    assert images[1:3].sum() == pytest.approx(expected[1:3].sum(), rel=0.15)
    assert not images[[0, 3]].any()


def test_arcs_of_a_tube_have_its_length_radius_and_volume():
    points, faces = arrays(trimesh.creation.cylinder(0.1, 4, sections=48).subdivide_to_size(0.2))
    _, arcs = graph_function("z", points[:, 2], points, faces)
    area = trimesh.Trimesh(points, faces).area
    found = describe_arcs(points[:, 2], arcs, points, faces)
    known = 4 / area**0.5, area / (2 * np.pi * 4) / area**0.5, area**2 / (4 * np.pi * 4) / area**1.5
    for numbers, size, (low, high) in zip(found, known, (LENGTHS, RADII, VOLUMES)):
        assert numbers.argmax() == int((np.log10(size) - low) / (high - low) * 16)
        assert numbers.sum() == pytest.approx(1)


def test_a_model_of_another_size_and_place_has_the_same_descriptors_but_for_its_sizes():
    points, faces = torus()
    first, second = rows(describe(points, faces)), rows(describe(4 * points, faces))
    assert second["area", ""] == 16 * first["area", ""] and second["volume", ""] == pytest.approx(
        64 * first["volume", ""]
    )
    for key in first:
        if key[0] not in ("area", "volume"):
            assert np.allclose(first[key], second[key], rtol=1e-6, atol=1e-6), key


def test_rotation_changes_what_it_may_only():
    points, faces = arrays(trimesh.creation.box([1, 2, 3.5]).subdivide_loop(3))
    points = points + 0.2 * np.sin(2 * points[:, [1, 2, 0]])
    first, second = (rows(describe(p, faces, 32)) for p in (points, points @ TURN.T))
    assert (first["betti_numbers", ""] == second["betti_numbers", ""]).all()
    for key in first:
        change = np.linalg.norm(np.sqrt(np.abs(first[key])) - np.sqrt(np.abs(second[key])))
        size = np.linalg.norm(np.sqrt(np.abs(first[key])))
        assert change <= size * (0.2 if key[1] == "height" else 0.05), key
    assert list(first) == list(second)


def test_the_table_takes_the_columns_and_same_input_gives_same_numbers():
    points, faces = torus()
    table = build_table("descriptors", describe(points, faces, 2))
    assert table == build_table("descriptors", describe(points, faces, 2))
    assert set(COMPARED) <= {row[0] for row in rows(table.to_pydict())}
    assert {
        (d, f)
        for d in ("persistences", "persistence_images", "events", "arc_radii")
        for f in ("geodesic", "barycentre", "height")
    } < set(rows(table.to_pydict()))
    assert [row[0] for row in rows(describe_surface(points, faces, {}))] == [
        "betti_numbers", "area", "volume", "normals", "pairs", "thickness",
    ]  # fmt: skip


def columns_of(values, **others):
    keys = {("pairs", ""): values} | {("persistences", name): v for name, v in others.items()}
    return {"descriptor": [k[0] for k in keys], "function": [k[1] for k in keys], "values": list(keys.values())}


def test_distances_are_those_of_square_roots_over_their_median():
    found = compare_descriptors([columns_of(v) for v in ([1.0, 0], [0, 1.0], [0.5, 0.5])])
    near = np.sqrt(2 - np.sqrt(2))
    assert found == pytest.approx(np.array([[0, np.sqrt(2), near], [np.sqrt(2), 0, near], [near, near, 0]]) / near)


def test_a_list_that_one_model_lacks_counts_between_the_others():
    found = compare_descriptors([columns_of([1.0, 0], h=[4.0]), columns_of([1.0, 0], h=[1.0]), columns_of([0, 1.0])])
    assert found[0, 1] == pytest.approx(0.5) and found[0, 2] == found[1, 2] == pytest.approx(1)
    assert compare_descriptors([]).shape == (0, 0) and compare_descriptors([columns_of([1.0])]).tolist() == [[0]]


@given(st.integers(2, 12), st.randoms(use_true_random=False))
def test_distances_and_ranks_are_symmetric_and_follow_the_models(count, random):
    tables = [columns_of([random.random() for _ in range(4)]) for _ in range(count)]
    order = random.sample(range(count), count)
    for measure in (compare_descriptors, lambda tables: rank_by_neighbourhood(compare_descriptors(tables))):
        found = measure(tables)
        assert (found == found.T).all() and not found.diagonal().any() and np.isfinite(found).all()
        assert np.allclose(measure([tables[k] for k in order]), found[np.ix_(order, order)], atol=1e-9)


def test_ways_over_neighbours_join_a_chain():
    places = np.array([0, 1, 2, 3, 4, 5, 6, 7.0, 8])
    far = np.abs(places[:, None] - places)
    far = np.block([[far, far.T * 0 + 6], [far * 0 + 6, far]])  # two chains, whose ends are nearer to the other chain
    far[np.arange(9), np.arange(9)] = 0
    ranked = rank_by_neighbourhood(far, 2)
    assert far[0, 8] > far[0, 9] and ranked[0, 8] < ranked[0, 9] == 1


def test_models_find_those_of_their_kind():
    kinds = {
        "ball": [trimesh.creation.icosphere(3, r) for r in (1, 2)],
        "ring": [trimesh.creation.torus(1, r, 32, 16) for r in (0.3, 0.35)],
        "bar": [trimesh.creation.box([1, 1, z]).subdivide_to_size(0.3) for z in (5, 6)],
    }
    tables = [describe(*arrays(mesh), 3) for meshes in kinds.values() for mesh in meshes]
    found = compare_descriptors(tables)
    np.fill_diagonal(found, np.inf)
    assert found.argmin(axis=1).tolist() == [1, 0, 3, 2, 5, 4]


def test_scores_of_a_list_made_by_hand(benchmark):
    # the query 0 of a class of three finds: right, wrong, wrong, right, wrong
    distances = np.full((6, 6), 9.0)
    distances[0] = [0, 1, 4, 2, 3, 5]
    scores = benchmark("retrieval_scores").score_queries(distances, [0, 0, 0, 1, 1, 1])[0]
    assert scores == pytest.approx([100, 50, 100, 100 * (1 + 1 / np.log2(4)) / (1 + 1 / np.log2(2))])


def test_perfect_distances_score_everything(benchmark):
    classes = np.repeat(np.arange(3), 4)
    perfect = (classes[:, None] != classes).astype(float)
    assert (benchmark("retrieval_scores").score_queries(perfect, classes) == 100).all()
