"""Faces that share all their corners with another one: copies, backs, and sheets that touch face to face.

One answer whether corners are shared in the file or not, in whatever order it is written.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from reebslice.formats.meshes import read_mesh
from reebslice.mesh import closing, copies, merging
from reebslice.mesh.faults import format_point
from reebslice.mesh.inspection import inspect_surface
from solids import move, torus, unite

CASES = Path(__file__).parent / "../../shared/cases"
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
FACES = np.array([[a, *pair] for a, b, c, d in QUADS for pair in ((b, c), (c, d))])


def box(low, high, inward=False):
    return low + CORNERS * (np.array(high, float) - low), FACES[:, ::-1] if inward else FACES


def turn_over(part):
    return part[0], part[1][:, ::-1]


def join(parts):
    counts = np.cumsum([0] + [len(points) for points, _ in parts])
    faces = [faces + count for (_, faces), count in zip(parts, counts)]
    return np.concatenate([points for points, _ in parts]), np.concatenate(faces)


def double(*parts):
    return [*parts, *map(turn_over, parts)]


def halves():
    """A void in a block of 4, filled by two boxes that touch, and the void's wall as theirs."""
    one, two = box((1, 1, 1), (2, 3, 3)), box((2, 1, 1), (3, 3, 3))
    sides = [part[1][~np.all(part[0][part[1]][:, :, 0] == 2, axis=1)] for part in (one, two)]
    points, faces = join([(one[0], sides[0]), (two[0], sides[1])])
    points, number = np.unique(points, axis=0, return_inverse=True)
    return [BLOCK, (points, number.ravel()[faces][:, ::-1]), one, two]


BLOCK, CORE = box((0, 0, 0), (4, 4, 4)), box((1, 1, 1), (3, 3, 3))
MIDDLE = box((0.5, 0.5, 0.5), (3.5, 3.5, 3.5), inward=True)
STEPS = [box((0, 0, 0), (1, 1, 1)), box((1, 1, 0), (2, 2, 1))]
# Parts: bodies, voids, volume.
SCENES = {
    "block": ([BLOCK], 1, 0, 64),
    "twins": ([BLOCK, BLOCK], 1, 0, 64),
    "written from both sides": (double(BLOCK), 1, 0, 64),
    "hollow": ([BLOCK, turn_over(CORE)], 1, 1, 56),
    "hollow, from both sides": (double(BLOCK, CORE), 1, 1, 56),
    "hollow twins": ([BLOCK, turn_over(CORE)] * 2, 1, 1, 56),
    "an insert": ([BLOCK, turn_over(CORE), CORE], 2, 1, 64),
    "an insert, inside out": ([turn_over(BLOCK), CORE, turn_over(CORE)], 2, 1, 64),
    "an insert, all twice": ([BLOCK, turn_over(CORE), CORE] * 2, 2, 1, 64),
    "twin inserts": ([BLOCK, turn_over(CORE), CORE, CORE], 2, 1, 64),
    "two inserts": (halves(), 3, 1, 64),
    "from both sides, in a void": ([BLOCK, MIDDLE, *double(CORE)], 2, 1, 64 - 27 + 8),
    "boxes that share an edge": (STEPS, 2, 0, 2),
    "boxes that share an edge, from both sides": (double(*STEPS), 2, 0, 2),
    "boxes that share a face": ([box((0, 0, 0), (1, 1, 1)), box((1, 0, 0), (2, 1, 1))], 2, 0, 2),
}


def write(parts, random, form):
    """The parts as a file may have them: corners apart, shared by position, or as the parts number them; shuffled."""
    points, faces = join(parts)
    if form == "apart":
        points, faces = points[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    if form == "shared":
        points, number = np.unique(points, axis=0, return_inverse=True)
        faces = number.ravel()[faces]
    order = random.permutation(len(points))
    faces = np.argsort(order)[faces][random.permutation(len(faces))]
    turns = (np.arange(3) + random.integers(0, 3, len(faces))[:, None]) % 3
    return points[order], np.take_along_axis(faces, turns, axis=1)


def check(parts, bodies, voids, volume, seed):
    """The figures, and that every way of writing the parts gives the same tables and the same record."""
    random, seen = np.random.default_rng(seed), []
    for form in ("apart", "shared", "as numbered", "as numbered"):
        seen.append(inspect_surface(*write(parts, random, form)))
        found = seen[-1][1]
        assert found["status"] != "rejected", found["reason"]
        assert (found["components"] - found["voids"], found["voids"]) == (bodies, voids)
        assert found["volume"] == pytest.approx(volume)
    for tables, found in seen[1:]:
        assert found == seen[0][1] and all(tables[name].equals(seen[0][0][name]) for name in tables)
    return seen[0][1]


@pytest.mark.parametrize("name", SCENES)
def test_scenes_are_what_is_stated_in_every_form(name):
    check(*SCENES[name], seed=len(name))


@pytest.mark.parametrize("seed", range(12))
def test_scenes_side_by_side_do_not_change_each_other(seed):
    random = np.random.default_rng(seed)
    parts, figures = [], np.zeros(3)
    for place in range(3):
        solid, *one = SCENES[random.choice(sorted(SCENES))]
        parts += [(points + [10 * place, 0, 0], faces) for points, faces in solid]
        figures += one
    check(parts, *figures, seed)


def test_what_was_dropped_is_told_with_its_place():
    twins = check(*SCENES["twins"], seed=0)
    assert twins["repairs"] == [
        "dropped 12 copies of faces whose corners another face has too, the first at (0, 0, 0), (0, 0, 4), (0, 4, 4)"
    ]
    backs = check(*SCENES["written from both sides"], seed=0)
    assert backs["repairs"][0].startswith("dropped 12 faces on the back of sheets that are written from both sides")
    assert backs["duplicate_faces_removed"] == twins["duplicate_faces_removed"] == 12
    insert = check(*SCENES["an insert"], seed=0)
    assert insert["duplicate_faces_removed"] == 0 and "took apart 18 mesh edges" in insert["repairs"][0]


def test_shared_cases():
    if not CASES.is_dir():
        pytest.skip("../shared/cases is not there")
    expected = json.loads((CASES / "expected.json").read_text())["insert_in_cavity.stl"]
    found = inspect_surface(*read_mesh(CASES / "insert_in_cavity.stl")[:2])[1]
    assert {key: found[key] for key in expected} == {**expected, "volume": pytest.approx(expected["volume"])}
    found = inspect_surface(*read_mesh(CASES / "double_sided.obj")[:2])[1]
    assert (found["status"], found["components"], found["volume"]) == ("repaired", 1, pytest.approx(48))


def test_numbers_decide_only_where_positions_do_not():
    parts = [box((0, 0, 0), (1, 1, 1)), box((0, 0, 0), (1, 1, 2))]  # which overlap, with mesh edges in common
    found = inspect_surface(*join(parts))[1]
    assert found["components"] == 2 and found["volume"] == pytest.approx(3)
    assert found["repairs"] == [
        "kept apart parts that touch along 5 mesh edges, the first from (0, 0, 0) to (0, 1, 0), as the file numbers"
        " its vertices"
    ]
    twin = inspect_surface(*join([*parts, parts[0]]))[1]
    assert (twin["components"], twin["duplicate_faces_removed"]) == (2, 12)
    cubes = [box(np.array(low), np.array(low) + 1) for low in np.ndindex(3, 3, 3)]
    mixed = [*cubes[:13], *map(turn_over, cubes[13:])]  # all around the one in the middle others face inward too
    found = inspect_surface(*join(mixed))[1]
    assert (found["components"], found["volume"]) == (27, pytest.approx(27))
    points, faces = join(mixed)
    told = inspect_surface(points[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3))[1]["reason"]
    assert "wound the same way" in told and told.endswith("turn over those that face inward.")
    strict = inspect_surface(*join(STEPS), {"repair": []})[1]
    assert strict["components"] == 2 and "as the file numbers" in strict["repairs"][0]


def test_flaps_go_whichever_way_they_are_wound():
    flap = np.array([[0, 0, 0], [0, 0, 4], [-1, -1, 2]], float)
    for faces in ([[0, 1, 2], [0, 2, 1]], [[0, 1, 2], [0, 1, 2]]):
        found = inspect_surface(*join([BLOCK, (flap, np.array(faces))]))[1]
        assert found["n_faces"] == 12 and found["duplicate_faces_removed"] == 2
        assert "1 flaps" in found["repairs"][0]


def test_the_four_faces_of_sheets_back_to_back_are_paired_without_angles():
    points, faces = merging.merge_exactly(*join([CORE, turn_over(CORE)]))
    glued = closing.glue(faces, len(points))
    found = closing.separate_sheets(points, closing.Closing(glued, glued, 0, faces[:0]), 0.0)
    tails = found.glued.faces.ravel()
    assert found.apart and np.all(tails != tails[found.glued.opposite])
    assert np.all(copies.find_runs(found.glued.faces)[found.glued.opposite // 3] != np.repeat(np.arange(12), 6))


# --------------------------------------------------------------------------
# Sentences: what, where, and a cure that works


def reason(*parts, **options):
    return inspect_surface(*join(parts), options)[1]["reason"]


def test_an_inner_wall_is_not_a_hole():
    wall = (np.array([[0, 0, 0], [0, 4, 0], [4, 4, 4], [4, 0, 4]], float), np.array([[0, 1, 2], [0, 2, 3]]))
    told = reason(BLOCK, wall)
    assert "4 mesh edges have three or more faces, the first from (0, 0, 0) to (0, 4, 0)" in told
    assert told.endswith("In a mesh editor, delete the inner walls or stray faces that meet the surface there.")
    told = reason((BLOCK[0], BLOCK[1][1:]), (wall[0], wall[1][1:]))
    assert "delete the inner walls" in told and "fill the holes" in told and "separate" not in told


def test_all_faces_in_one_place_are_counted():
    opened = BLOCK[0], BLOCK[1][2:]
    told = reason(opened, opened)
    assert "20 faces lie in 10 places" in told and "delete the copies" in told and "separate" not in told


def test_one_sided_surfaces_are_called_so():
    k = 12
    angle = 2 * np.pi * np.arange(k) / k
    rim = [
        np.column_stack(
            [
                (3 + s * np.cos(angle / 2)) * np.cos(angle),
                (3 + s * np.cos(angle / 2)) * np.sin(angle),
                s * np.sin(angle / 2),
            ]
        )
        for s in (-1, 1)
    ]
    low, high = np.arange(k), k + np.arange(k)
    after = np.r_[low[1:], high[0]], np.r_[high[1:], low[0]]
    strip = (
        np.concatenate(rim),
        np.concatenate([np.stack([low, after[0], high], 1), np.stack([after[0], after[1], high], 1)]),
    )
    told = reason(strip)
    assert "only one face" in told and "it is one-sided (like a Moebius strip)" in told


def test_coordinates_can_be_found_again():
    assert format_point((4785273.2, 0.1, -1e-9)) == "(4785273.2, 0.1, -1e-09)"
    points = np.random.default_rng(0).normal(size=(200, 3)) * 5e6
    assert all(tuple(map(float, format_point(point)[1:-1].split(","))) == tuple(point) for point in points)
    far = torus(around=8, across=6)
    told = inspect_surface(far.points + [4785273.2, 5e6, 0], far.faces[1:])[1]["reason"]
    numbers = told.split("the first from (")[1].split(")")[0].split(",")
    assert any(
        np.allclose(far.points[v] + [4785273.2, 5e6, 0], [float(x) for x in numbers], rtol=0, atol=1e-9)
        for v in far.faces[0]
    )


def test_union_tells_vertices_and_faces():
    solid = unite(torus(), move(torus(), [1, 0, 0]))
    found = inspect_surface(solid.points, solid.faces, {"overlaps": "union"})[1]
    told = next(one for one in found["repairs"] if one.startswith("united"))
    assert f"became {found['n_vertices']} and their faces" in told and told.endswith("vertices stay apart")
