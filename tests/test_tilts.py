"""The choice of a tilt: which directions are tried, which one is taken, what is claimed of it."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import inspect_mesh
import solids
from corpus.surfaces import read_faces, read_points
from pipeline import OPTIONS
from reebslice.errors import ReebsliceError
from reebslice.morse.critical_points import count_critical_points, morse_indices, vertex_indices
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.ordered_mesh import tilt_points
from reebslice.tilt.choice import (
    FRAMES,
    LEAST_ANGLE,
    MARGIN,
    assess_direction,
    candidate_directions,
    height_rounding,
    rotation_to_vertical,
    select_tilt,
)
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


def sides(solid):
    """Both ends of every side of every face, (3 m, 2)."""
    return np.vstack([solid.faces[:, [k, k - 1]] for k in range(3)])


def is_sure(figures):
    return figures["certainty"] >= MARGIN


# --------------------------------------------------------------------------
# Directions


@pytest.mark.parametrize("direction", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.6, 0, 0.8), (-0.48, 0.6, -0.64)])
def test_rotation_takes_the_direction_to_vertical(direction):
    rotation = rotation_to_vertical(np.array(direction, float))
    assert rotation[2].tolist() == list(direction)
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(rotation) == pytest.approx(1)


@pytest.mark.parametrize("up", FRAMES)
def test_an_axis_that_points_up_is_taken_as_z_is(up):
    frame = FRAMES[up]
    assert np.linalg.det(frame) == 1 and (frame @ frame.T == np.eye(3)).all()
    assert frame[2].tolist() == [(-1 if up[0] == "-" else 1) * (axis == up[-1]) for axis in "xyz"]
    solid = solids.box(1.0, 2.0, 3.0)
    for mode in ("auto", "none"):
        here = select_tilt(solid.points, solid.faces, mode, up=up)
        there = select_tilt(solid.points @ frame.T, solid.faces, mode)
        assert here["up"] == up and len(here["candidates"]) == len(there["candidates"])
        assert np.array(here["direction"]) @ frame.T == pytest.approx(there["direction"], abs=1e-15)
        assert (here["margin"], here["morse"]) == (pytest.approx(there["margin"]), there["morse"])
    with pytest.raises(ReebsliceError, match="up is 'w': give one of 'x', 'y', 'z'"):
        select_tilt(solid.points, solid.faces, up="w")


def test_candidates_are_z_and_directions_ever_farther_from_it():
    directions = candidate_directions()
    assert directions[0].tolist() == [0, 0, 1]
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1, abs=1e-15)
    angles = np.degrees(np.arcsin(np.hypot(*directions[1:, :2].T)))
    assert angles == pytest.approx(LEAST_ANGLE * 2.0 ** np.arange(len(angles))) and 10 < angles[-1] < 11
    turns = np.sort(np.arctan2(directions[1:, 1], directions[1:, 0]) / (2 * np.pi) % 1)
    assert np.diff(np.append(turns, turns[0] + 1)).min() > 0.5 / len(turns)  # no two azimuths are near each other
    # nor is one near an edge of a regular polygon: none is farther from simple fractions of a turn
    sides = np.arange(1, 1001)
    first = np.arctan2(directions[1, 1], directions[1, 0]) / (2 * np.pi) % 1
    assert (np.abs(first * sides - np.rint(first * sides)) > 1 / (2.62 * sides)).all()


def test_a_given_direction_is_taken_whatever_its_length():
    ball = solids.icosphere(1)
    record = select_tilt(ball.points, ball.faces, "direction", direction=[0, 3, 4])
    assert record["direction"] == [0, 0.6, 0.8] and record["mode"] == "direction"
    assert [one["direction"] for one in record["candidates"]] == [record["direction"]]
    down = select_tilt(ball.points, ball.faces, "direction", direction=[0, 0, -7])
    assert (down["rounding"], down["angle"]) == (0, 180)


# --------------------------------------------------------------------------
# What is said of a direction


@cases(60)
@given(SOLIDS, DIRECTIONS)
def test_the_margin_is_the_smallest_rise_in_the_tilted_frame(solid, direction):
    height = tilt_points(solid.points, rotation_to_vertical(direction))[:, 2]
    low, high = sides(solid).T
    assert assess_direction(solid.points, solid.faces, direction)["margin"] == np.abs(height[low] - height[high]).min()


@cases(60)
@given(SOLIDS, DIRECTIONS)
def test_critical_points_are_counted_as_on_the_ordered_mesh(solid, direction):
    rotation = rotation_to_vertical(direction)
    found = count_critical_points(tilt_points(solid.points, rotation), solid.faces)
    mesh = height_mesh(solid.points, solid.faces, rotation)
    critical = np.flatnonzero(vertex_indices(mesh))
    counts = np.bincount(morse_indices(mesh, critical), minlength=3).tolist()
    assert list(found.values()) == counts and list(found) == ["minima", "saddles", "maxima"]
    assert counts[0] - counts[1] + counts[2] == len(solid.points) - len(solid.faces) // 2


@cases(20)
@given(SOLIDS)
def test_a_proven_margin_holds_in_exact_arithmetic(solid):
    record = select_tilt(solid.points, solid.faces, "auto")
    direction = [Fraction(x) for x in record["direction"]]
    exact = [sum(Fraction(a) * b for a, b in zip(point, direction)) for point in solid.points.tolist()]
    floats = tilt_points(solid.points, record["rotation"])[:, 2].tolist()
    assert max(abs(Fraction(f) - e) for f, e in zip(floats, exact)) <= Fraction(record["rounding"]) / 2
    assert record["morse"] == "proven"
    assert all((exact[a] - exact[b]) * (floats[a] > floats[b] or -1) > 0 for a, b in sides(solid).tolist())


def test_along_an_axis_nothing_is_rounded_yet_a_margin_is_asked_for():
    cube = solids.cube(subdivisions=1)
    rough = cube.points.copy()
    rough[:, 2] += 2.0**-50 * np.random.default_rng(0).permutation(len(rough))
    upright = assess_direction(rough, cube.faces, (0.0, 0.0, 1.0))
    assert (upright["morse"], upright["rounding"]) == ("proven", 0) and 0 < upright["certainty"] < MARGIN
    assert upright["certainty"] == upright["margin"] / height_rounding(rough, (0.0, 0.0, 1.0))
    assert select_tilt(rough, cube.faces, "none")["critical"] != {"minima": 1, "saddles": 0, "maxima": 1}
    tilted = select_tilt(rough, cube.faces, "auto")
    assert tilted["angle"] == pytest.approx(LEAST_ANGLE)
    assert tilted["critical"] == {"minima": 1, "saddles": 0, "maxima": 1}


# --------------------------------------------------------------------------
# The choice


@cases(40)
@given(SOLIDS)
def test_the_first_direction_that_is_morse_beyond_rounding_is_taken(solid):
    record = select_tilt(solid.points, solid.faces, "auto")
    tried = record["candidates"]
    assert [one["direction"] for one in tried] == candidate_directions()[: len(tried)].tolist()
    assert [is_sure(one) for one in tried] == [False] * (len(tried) - 1) + [True]
    assert {name: record[name] for name in tried[-1]} == tried[-1]
    assert np.ptp(solid.points[sides(solid), 2], axis=1).min() > 0 or len(tried) > 1


@cases(20)
@given(SOLIDS, solids.SEEDS)
def test_the_order_of_vertices_and_faces_changes_nothing(solid, seed):
    shuffled = solids.permute(solid, seed)
    for mode in ("none", "auto"):
        assert select_tilt(shuffled.points, shuffled.faces, mode) == select_tilt(solid.points, solid.faces, mode)


def test_a_box_is_morse_by_sos_upright_and_proven_once_tilted():
    cube = solids.cube(subdivisions=3)
    upright = select_tilt(cube.points, cube.faces, "none")
    assert (upright["morse"], upright["margin"], upright["angle"]) == ("by_sos", 0.0, 0.0)
    assert upright["critical"] == {"minima": 1, "saddles": 0, "maxima": 1}
    tilted = select_tilt(cube.points, cube.faces, "auto")
    assert tilted["morse"] == "proven" and tilted["angle"] == pytest.approx(LEAST_ANGLE)
    assert tilted["margin"] > MARGIN * tilted["rounding"] > 0
    assert tilted["critical"] == upright["critical"]


def test_z_is_kept_where_nothing_is_horizontal():
    ball = solids.move(solids.icosphere(2), [0.1, 0.2, 0.3])
    turned = solids.Solid(ball.points @ solids.rotation(5).T, ball.faces)
    record = select_tilt(turned.points, turned.faces, "auto")
    assert (record["direction"], record["angle"], record["morse"]) == ([0, 0, 1], 0, "proven")
    assert len(record["candidates"]) == 1 and record["rotation"] == np.eye(3).tolist()


@pytest.mark.parametrize("height, morse", [(2.0**43, "proven"), (2.0**52, "by_sos")])
def test_where_no_margin_is_to_be_had_the_surest_is_taken_or_z(height, morse):
    cube = solids.move(solids.cube(subdivisions=1), [0, 0, height])
    record = select_tilt(cube.points, cube.faces, "auto")
    tried = record["candidates"]
    assert len(tried) == len(candidate_directions()) and not any(map(is_sure, tried))
    assert record["morse"] == morse and (record["angle"] == 0) == (morse == "by_sos")
    proven = [one["certainty"] for one in tried if one["morse"] == "proven"]
    assert record["certainty"] == max(proven, default=tried[0]["certainty"])


@pytest.mark.parametrize(
    "name, tilted",
    [("abc8.stl", True), ("three_torus.off", False), ("anchor_dense.off", True), ("hand_cgal.off", False)],
)
def test_real_models_keep_z_or_share_the_least_tilt(name, tilted, tmp_path):
    if not (CORPUS / name).is_file():
        pytest.skip("the corpus ../shared/meshes is absent")
    inspect_mesh.main(CORPUS / name, tmp_path, OPTIONS["inspect"])
    record = select_tilt(read_points(tmp_path), read_faces(tmp_path), "auto")
    assert record["direction"] == candidate_directions()[int(tilted)].tolist() and record["morse"] == "proven"
