"""The choice of a tilt: what directions are tried, how they are scored, what is claimed of the one taken."""

import itertools
from fractions import Fraction
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import inspect_mesh
import reference
import solids
from corpus.surfaces import read_faces, read_points
from pipeline import OPTIONS
from reebslice.morse.critical_points import vertex_indices
from reebslice.morse.ordered_mesh import order_by_height, tilt_points
from reebslice.morse.reeb_graph import critical_persistence, surface_reeb_graph
from reebslice.morse.unfolding import unfold_saddles
from reebslice.slicing.levels import pierce
from reebslice.tilt import choice
from reebslice.tilt.choice import (
    ANGLE_COST,
    assess_directions,
    candidate_directions,
    height_rounding,
    rotation_to_vertical,
    select_tilt,
    sos_ranks,
)
from reebslice.tilt.cone import gather_neighbours, survey_surface
from reebslice.tilt.scan import find_critical_points, heights_along
from reebslice.tilt.score import fewest_levels, find_significant
from test_laws import cases

CORPUS = Path(__file__).parents[2] / "shared" / "meshes"
SOLIDS = st.one_of(
    solids.voxel_solids((3, 3, 2)),
    solids.trusses((2, 2, 2)),
    solids.terrains(),
    solids.blobs(),
    solids.nests(),
    solids.machined_parts(),
    solids.wedge_solids(),
)
# Among them some that make ties.
DIRECTIONS = st.one_of(
    st.sampled_from([(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.6, 0.0, 0.8), (0.0, -0.8, 0.6), (0.0, 0.0, -1.0)]),
    solids.SEEDS.map(lambda seed: tuple(solids.rotation(seed)[2].tolist())),
)


def survey(points, faces, directions):
    """The surface, surveyed for the directions."""
    directions = np.array(directions)
    return survey_surface(
        points, np.ascontiguousarray(faces, np.int32), directions, height_rounding(points, directions).max()
    )


def measured(solid, direction):
    """The surface, SoS ranks and heights of a solid along a direction, and its critical points."""
    surface, key = survey(solid.points, solid.faces, [direction]), sos_ranks(solid.points, direction)
    return surface, key, heights_along(solid.points, direction), find_critical_points(surface, key)


def slow_indices(faces, key):
    """Of each critical vertex the PL index, by its lower and its higher neighbours: {vertex: index}."""
    middle = dict.fromkeys(range(len(key)), 0)
    for face in faces.tolist():
        middle[sorted(face, key=key.__getitem__)[1]] += 1
    return {v: 1 - count // 2 for v, count in middle.items() if count != 2}


def slow_fewest_levels(graph, significant):
    """Cuts after which no piece has two of the `significant` vertices, the best of all ways to cut the graph."""
    order = sorted(graph, key=lambda v: graph.nodes[v]["rank"])

    def holds(first, last):  # the slab of the critical vertices first, ..., last - 1
        slab = graph.subgraph(order[first:last])
        return all(len(significant & piece) < 2 for piece in nx.connected_components(slab))

    slabs = [0]  # the fewest that hold so many vertices
    for last in range(1, len(order) + 1):
        # a slab of which a part does not hold does not hold either
        possible = itertools.takewhile(lambda first: holds(first, last), reversed(range(last)))
        slabs.append(1 + min(slabs[first] for first in possible))
    return slabs[-1] - 1


@cases(40)
@given(SOLIDS, DIRECTIONS)
def test_heights_are_those_of_the_tilted_frame(solid, direction):
    rotation = rotation_to_vertical(direction)
    assert heights_along(solid.points, direction).tobytes() == (
        np.ascontiguousarray(tilt_points(solid.points, rotation)[:, 2]).tobytes()
    )


@cases(30)
@given(SOLIDS)
def test_gathered_vertices_are_the_same_surface(solid):
    points, faces = gather_neighbours(solid.points, solid.faces)
    seen = [
        sorted(min(tuple(map(tuple, np.roll(face, turn, axis=0))) for turn in range(3)) for face in corners.tolist())
        for corners in (points[faces], solid.points[solid.faces])
    ]
    assert seen[0] == seen[1]


def test_gathered_vertices_keep_the_order_of_those_that_coincide():
    blob = solids.blob(2, 1, 0.3)
    twice = np.concatenate([blob.points, blob.points])
    points, faces = gather_neighbours(twice, np.concatenate([blob.faces, blob.faces[:, ::-1] + len(blob.points)]))
    height = heights_along(points, [0.0, 0.0, 1.0])
    outward = np.zeros(len(points), bool)  # faces of the first copy, which keep their winding
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    outward[faces[(normals * points[faces].mean(axis=1)).sum(axis=1) > 0]] = True
    order = np.lexsort(points.T)
    assert len(np.unique(height)) == len(blob.points) and outward[order].tolist() == [True, False] * len(blob.points)


@cases(40)
@given(SOLIDS, st.sampled_from([0.0, 5.0, 15.0, 50.0, 120.0]), solids.SEEDS)
def test_what_is_sure_holds_along_all_directions(solid, cone, seed):
    directions = candidate_directions(6, cone, seed) @ solids.rotation(seed)
    surface = survey(solid.points, solid.faces, directions)
    sides = np.vstack([solid.faces[:, [k, k - 1]] for k in range(3)])
    for direction in directions:
        height = heights_along(solid.points, direction)
        for end, way in ((surface.doubtful[surface.downhill], 1), (surface.doubtful[surface.uphill], -1)):
            assert ((way * height[end] < way * height) | (end == np.arange(len(end)))).all()
        margin = np.abs(height[sides[:, 0]] - height[sides[:, 1]]).min()
        assert find_critical_points(surface, height).margin == margin
        ranks = sos_ranks(solid.points, direction)
        found = find_critical_points(surface, ranks)
        assert dict(zip(found.vertices.tolist(), found.index.tolist())) == slow_indices(solid.faces, ranks)
        assert found.vertices.tolist() == surface.doubtful[found.spots].tolist()
        assert (np.diff(ranks[found.vertices]) > 0).all()


def test_of_a_smooth_surface_little_is_doubtful_in_a_narrow_cone():
    ball = solids.icosphere(4)
    surface = survey(ball.points, ball.faces, candidate_directions(9, 5.0, seed=1))
    assert len(surface.doubtful) < 0.05 * len(ball.points) and len(surface.level) < 0.3 * 1.5 * len(ball.faces)


@cases(35)
@given(SOLIDS, DIRECTIONS, solids.SEEDS)
def test_fewest_levels_are_the_best_of_all_ways_to_cut(solid, direction, seed):
    points = tilt_points(solid.points, rotation_to_vertical(direction))
    graph, _ = reference.sweep(points.tolist(), solid.faces)
    random = np.random.default_rng(seed)
    chosen = {v for v in graph if random.random() < 0.7}
    surface, key, _, found = measured(solid, direction)
    significant = np.isin(found.vertices, list(chosen))
    assert found.vertices.tolist() == sorted(graph, key=lambda v: graph.nodes[v]["rank"])
    assert fewest_levels(surface, key, found, significant) == slow_fewest_levels(graph, chosen)


@cases(60)
@given(SOLIDS, DIRECTIONS)
def test_levels_for_all_critical_points_pierce_all_arcs(solid, direction):
    mesh = unfold_saddles(order_by_height(solid.points, solid.faces, rotation_to_vertical(direction)))
    graph, key = surface_reeb_graph(mesh), np.arange(len(mesh.points), dtype=float)
    surface = survey(mesh.points, mesh.faces, [(0.0, 0.0, 1.0)])
    found = find_critical_points(surface, key)
    assert found.vertices.tolist() == graph.nodes.tolist()
    arcs = list(map(tuple, graph.nodes[graph.arcs].tolist()))
    assert fewest_levels(surface, key, found, found.index != 0) == len(pierce(arcs))


@cases(60)
@given(SOLIDS, DIRECTIONS, st.sampled_from([0.0, 0.02, 0.1, 0.3]))
def test_significant_points_are_those_of_the_unfolded_surface(solid, direction, share):
    surface, key, height, found = measured(solid, direction)
    size = share * np.ptp(height)
    significant, count = find_significant(surface, key, height, found, size)
    mesh = unfold_saddles(order_by_height(solid.points, solid.faces, rotation_to_vertical(direction)))
    graph, expected = surface_reeb_graph(mesh), np.zeros(len(mesh.points), bool)
    saddle = vertex_indices(mesh)[graph.nodes] < 0
    loop = saddle & saddle[graph.partner]
    expected[graph.nodes] = loop | (critical_persistence(mesh, graph)[graph.nodes] >= size)
    assert count == expected.sum()
    assert set(found.vertices[significant]) == set(mesh.vertex[expected])


@cases(30)
@given(SOLIDS, DIRECTIONS)
def test_heights_serve_as_ranks_where_nothing_ties(solid, direction):
    (record,) = assess_directions(solid.points, solid.faces, [direction])
    surface, key, height, found = measured(solid, direction)
    significant, count = find_significant(surface, key, height, found, choice.SIGNIFICANT_SHARE * np.ptp(height))
    assert record["persistent"] == count
    assert record["fewest_levels"] == fewest_levels(surface, key, found, significant)
    assert record["fewest_levels_exact"] == fewest_levels(surface, key, found, found.index != 0)
    euler = len(solid.points) - len(solid.faces) // 2
    assert euler == record["critical"]["minima"] - record["critical"]["saddles"] + record["critical"]["maxima"]


@cases(20)
@given(SOLIDS, st.sampled_from([5.0, 15.0, 90.0]))
def test_the_choice_is_the_best_of_the_recorded_candidates(solid, cone):
    record = select_tilt(solid.points, solid.faces, "auto", cone=cone, candidates=12, seed=7)
    tried = record["candidates"]
    drawn = candidate_directions(len(tried), record["cone"], record["seed"])
    assert [candidate["direction"] for candidate in tried] == drawn.tolist() and len(tried) == 12
    chosen = {name: record[name] for name in tried[0]}
    assert chosen in tried and record["angle"] <= cone + 1e-9
    levels = (record["fewest_levels"] * record["fewest_levels_exact"]) ** 0.5
    assert record["cost"] == pytest.approx(levels + ANGLE_COST * record["angle"])
    rivals = [c for c in tried if c["morse"] == "proven"] if record["morse"] == "proven" else tried
    assert record["cost"] == min(candidate["cost"] for candidate in rivals)
    assert record["morse"] == "proven" or not any(c["morse"] == "proven" for c in tried)


@cases(20)
@given(SOLIDS, solids.SEEDS)
def test_the_order_of_vertices_and_faces_changes_nothing(solid, seed):
    shuffled = solids.permute(solid, seed)
    for options in ({"mode": "none"}, {"mode": "auto", "candidates": 8, "seed": seed}):
        assert select_tilt(shuffled.points, shuffled.faces, **options) == select_tilt(
            solid.points, solid.faces, **options
        )


@cases(20)
@given(SOLIDS)
def test_a_proven_margin_holds_in_exact_arithmetic(solid):
    record = select_tilt(solid.points, solid.faces, "auto", candidates=8)
    direction = [Fraction(x) for x in record["direction"]]
    exact = [sum(Fraction(a) * b for a, b in zip(point, direction)) for point in solid.points.tolist()]
    floats = heights_along(solid.points, record["direction"]).tolist()
    assert max(abs(Fraction(f) - e) for f, e in zip(floats, exact)) <= Fraction(record["rounding"]) / 2
    sides = {tuple(sorted((face[k], face[k - 1]))) for face in solid.faces.tolist() for k in range(3)}
    assert record["margin"] == min(abs(floats[a] - floats[b]) for a, b in sides)
    assert record["morse"] == "proven"
    assert all((exact[a] - exact[b]) * (floats[a] > floats[b] or -1) > 0 for a, b in sides)


def test_where_heights_tie_ranks_are_asked_for():
    blob = solids.blob(1, 1, 0.3)
    twins = solids.unite(blob, solids.move(blob, [4, 0, 0]))
    for solid, tie in ((blob, False), (twins, True), (solids.cube(1), True)):
        surface, _, height, found = measured(solid, (0.0, 0.0, 1.0))
        assert len(found.vertices) > 0
        assert (len(find_critical_points(surface, height).vertices) == 0) == tie


def test_more_candidates_contain_the_fewer_and_never_cost_more():
    part = solids.machined(3)
    few, many = (select_tilt(part.points, part.faces, "auto", candidates=k) for k in (10, 40))
    assert many["candidates"][:10] == few["candidates"]
    assert many["cost"] <= few["cost"]


def test_directions_assessed_together_are_assessed_as_each_alone():
    part = solids.machined(5)
    directions = candidate_directions(19, 15.0, seed=0)
    together = assess_directions(part.points, part.faces, directions)
    assert together == [assess_directions(part.points, part.faces, [one])[0] for one in directions]


def test_a_flat_box_is_told_apart_by_one_level_however_fine_its_flats():
    cube = solids.cube(subdivisions=3)
    upright = select_tilt(cube.points, cube.faces, "none")
    assert (upright["morse"], upright["margin"]) == ("by_sos", 0.0)
    assert upright["critical"] == {"minima": 1, "saddles": 0, "maxima": 1}
    assert (upright["persistent"], upright["fewest_levels"]) == (2, 1)
    assert "seed" not in upright and len(upright["candidates"]) == 1


def test_shells_and_loops_count_whatever_their_size():
    torus = solids.torus(2.0, 0.7, 32, 16, upright=True)
    pair = solids.unite(torus, solids.move(solids.icosphere(1, 0.01), [9, 0, 0]))
    for solid, persistent in ((torus, 4), (pair, 4)):
        record = select_tilt(solid.points, solid.faces, "none")
        assert (record["persistent"], record["fewest_levels"]) == (persistent, 3)


@pytest.mark.parametrize("name", ["couplingdown.off", "anchor_dense.off", "abc8.stl", "three_torus.off"])
def test_auto_takes_no_more_levels_than_random_directions(name, tmp_path):
    if not (CORPUS / name).is_file():
        pytest.skip("the corpus ../shared/meshes is absent")
    inspect_mesh.main(CORPUS / name, tmp_path, OPTIONS["inspect"])
    points, faces = read_points(tmp_path), read_faces(tmp_path)
    chosen = select_tilt(points, faces, "auto")
    others = assess_directions(points, faces, candidate_directions(11, 15.0, seed=2026)[1:])
    for count in ("fewest_levels", "fewest_levels_exact"):
        assert chosen[count] <= np.median([other[count] for other in others])
