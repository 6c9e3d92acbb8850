"""Directions of height compared."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

import pipeline
import rate_directions
import solids
from corpus.storage import read_table
from reebslice import compare_directions, errors, find_islands, find_pockets
from reebslice.graphs.directions import spread_directions
from reebslice.tilt.choice import rotation_to_vertical
from test_laws import cases

ROOT = Path(__file__).parent.parent
MESHES = ROOT.parent / "shared" / "meshes"
OPTIONS = {"number": 3, "distance": 0.01, "least_depth": 0.001, "overhang": 45}


def box(low, high):
    return trimesh.creation.box(bounds=[low, high])


def rows(found):
    """By direction, rounded, what is said of it."""
    fields = found._asdict()
    ups = [tuple((part.round(6) + 0.0).tolist()) for part in fields.pop("direction")]
    return {up: {name: column[k] for name, column in fields.items()} for k, up in enumerate(ups)}


def test_directions_are_the_axes_and_a_spread_of_unit_vectors():
    ups = spread_directions(1000)
    assert ups[:6].tolist() == [[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
    assert np.allclose(np.linalg.norm(ups, axis=1), 1, rtol=1e-12) and len(spread_directions(0)) == 6
    # evenly: every cap of a tenth of the sphere holds about a tenth of them
    shares = (ups[6:] @ ups.T > 0.8).mean(axis=0)
    assert np.abs(shares - 0.1).max() < 0.01


def test_a_cup_stands_lies_and_hangs():
    cup = trimesh.boolean.difference([box([0, 0, 0], [3, 3, 3]), box([1, 1, 1], [2, 2, 4])])
    found = compare_directions(cup, directions=0, distance=0.3, least_depth=0)
    upright, down, aside = (rows(found)[up] for up in ((0, 0, 1), (0, 0, -1), (1, 0, 0)))
    assert (upright["basins"], upright["bells"], down["basins"], down["bells"]) == (1, 0, 0, 1)
    assert np.isclose(upright["basin_volume"], 2) and np.isclose(down["bell_volume"], 2)
    assert aside["basins"] == aside["bells"] == 0 and np.isclose(aside["overhang_area"], 2)
    assert upright["overhang_area"] == 0 and np.isclose(down["overhang_area"], 1)
    assert {row["layers"] for row in rows(found).values()} == {10}
    assert {row["support_free_height"] for row in rows(found).values()} == {3}
    assert found.direction[0].tolist() == [1, 0, 0]  # no pockets; of the four like it the first given


def test_what_begins_in_the_air_comes_last():
    # a table with one leg that hangs
    table = trimesh.boolean.union([box([0, 0, 0], [1, 1, 3]), box([2, 0, 1], [3, 1, 3]), box([0, 0, 3], [3, 1, 4])])
    found = compare_directions(table, directions=[[0, 0, 1], [0, 0, -2], [0, 5, 0]], distance=1.0)
    assert found.direction.tolist() == [[0, 1, 0], [0, 0, -1], [0, 0, 1]]
    assert found.islands.tolist() == [0, 0, 1] and found.support_free_height.tolist() == [1, 4, 1]
    assert np.isclose(found.island_volume[2], 2) and found.overhang_area.tolist() == [0, 0, 2]
    assert found.layers.tolist() == [1, 4, 4]


def test_an_overhang_is_counted_from_its_angle_on_and_the_plate_is_none():
    wedge = trimesh.convex.convex_hull(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [3, 0, 2], [3, 1, 2], [0, 0, 2], [0, 1, 2]]
    )
    leaning = 2 * np.sqrt(2)  # one face that leans over by 45 degrees
    areas = [
        compare_directions(wedge, directions=[[0, 0, 1]], overhang=angle).overhang_area[0]
        for angle in (0, 44.9, 45, 80)
    ]
    assert np.allclose(areas, [leaning, leaning, 0, 0])


@cases(6)
@given(solids.csgs(balls=False) | solids.terrains(), st.integers(1, 3))
def test_rows_are_those_of_the_functions_and_in_order(solid, number):
    depth = 0.01
    found = compare_directions(solid.points, solid.faces, number, least_depth=depth)
    assert len(found.height) == 6 + number
    keys = list(zip(found.islands, found.basins + found.bells, found.overhang_area, found.layers))
    assert keys == sorted(keys)
    for k, up in enumerate(found.direction):
        pockets = find_pockets(solid.points, solid.faces, rotation_to_vertical(up), depth)
        islands = find_islands(solid.points, solid.faces, rotation_to_vertical(up), None, depth)
        counts = [(pockets.kind == kind).sum() for kind in ("basin", "bell", "sealed")]
        assert [found.basins[k], found.bells[k], found.sealed[k]] == counts and found.islands[k] == len(islands.kind)
        top = np.append(islands.begin_height, (solid.points @ up).max()).min()
        assert np.isclose(found.support_free_height[k], top - (solid.points @ up).min())
    by_up = rows(found)
    for axis in np.eye(3):
        one, other = by_up[tuple(axis)], by_up[tuple(-axis + 0.0)]
        assert (one["basins"], one["bells"]) == (other["bells"], other["basins"])
        assert np.isclose(one["basin_volume"], other["bell_volume"]) and one["sealed"] == other["sealed"]


@cases(4)
@given(solids.csgs(balls=False), st.integers(1, 5))
def test_a_turned_model_has_the_same_rows_in_turned_directions(solid, seed):
    turn = solids.rotation(seed)
    ups = spread_directions(4)[6:]
    one = compare_directions(solid.points, solid.faces, ups)
    turned = compare_directions(solid.points @ turn.T, solid.faces, ups @ turn.T)
    assert one.islands.tolist() == turned.islands.tolist() and one.basins.tolist() == turned.basins.tolist()
    for name in ("island_volume", "basin_volume", "bell_volume", "height", "overhang_area"):
        assert np.allclose(getattr(one, name), getattr(turned, name), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(
    "options, says",
    [
        ({"directions": [[0, 0, 0]]}, "not all 0"),
        ({"directions": [[0, 0, np.nan]]}, "finite"),
        ({"directions": [1, 2]}, "three"),
        ({"directions": -1}, "0 or more"),
        ({"distance": 0}, "distance"),
        ({"least_depth": -1}, "least_depth"),
        ({"overhang": 91}, "overhang"),
    ],
)
def test_what_is_out_of_range_is_refused(options, says):
    with pytest.raises(errors.ReebsliceError, match=says):
        compare_directions(box([0, 0, 0], [1, 1, 1]), **options)


def test_the_stage_writes_the_table_of_a_real_part(tmp_path):
    path = MESHES / "block_stand_voids.stl"
    if not path.exists():
        pytest.skip(f"no {path}")
    pipeline.run_mesh(path, tmp_path, levels={"refine": "none"})
    rate_directions.main(tmp_path, tmp_path, OPTIONS)
    table = read_table(tmp_path / "directions.parquet", "directions").to_pandas()
    assert len(table) == 9 and set(table["sealed"]) == {3} and table["place"].tolist() == list(range(9))
    upright, down = (table[table["z"] == z].iloc[0] for z in (1, -1))
    assert (upright["basins"], upright["bells"], down["basins"], down["bells"]) == (4, 0, 0, 4)
    assert np.isclose(upright["basin_volume"], down["bell_volume"], rtol=1e-6)


def test_the_target_leaves_a_table_over_all_models(tmp_path):
    (tmp_path / "meshes").mkdir()
    for name, solid in (("a", solids.cup()), ("b", solids.arch())):
        pipeline.write_off(tmp_path / "meshes" / f"{name}.off", solid)
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "--directory", str(tmp_path)]
    command += ["--cores", "1", "compare_directions", "--config", "meshes=meshes", "directions={number: 2}"]
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=tmp_path, check=False
    )
    assert done.returncode == 0, done.stdout
    table = read_table(tmp_path / "results/corpus/directions.parquet", "directions").to_pandas()
    assert table["model"].tolist() == ["a"] * 8 + ["b"] * 8 and table["place"].tolist() == list(range(8)) * 2
    assert (tmp_path / "results/models/a/directions.parquet").exists()
    assert not (tmp_path / "results/corpus/models.parquet").exists()
