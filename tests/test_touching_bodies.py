"""Bodies that touch, to within rounding or less than it, are certified as touching; surfaces that cross are said to."""

import json
from pathlib import Path

import numpy as np
import pytest

import certify
import solids
from corpus.storage import read_table
from pipeline import OPTIONS, run_mesh, run_stages

CASES = Path(__file__).parents[2] / "shared" / "cases"
LEVELS = {"distance": 0.05, "refine": "exact", "feature_size": 0.1}
TILTS = {"upright": np.eye(3), "turned": solids.rotation(3)}

needs_cases = pytest.mark.skipif(not CASES.is_dir(), reason="the folder ../shared/cases is absent")


def certificate(folder, levels=LEVELS):
    certify.main(folder, folder, OPTIONS["levels"] | levels)
    return json.loads((folder / "certificate.json").read_text())


def failures(found):
    return [name for name, check in found["checks"].items() if not check["holds"]]


def ring(corners, radius, z):
    angle = 0.3 + 2 * np.pi * np.arange(corners) / corners
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(corners, z)], axis=1)


def quad(a, b, c, d, fold):
    return [(a, b, c), (a, c, d)] if fold else [(a, b, d), (b, c, d)]


def washer(corners, outer, bore, bottom, top, fold=True):
    """A prism with a bore, its quads cut along either diagonal."""
    rings = [ring(corners, radius, z) for radius in (outer, bore) for z in (bottom, top)]
    n, faces = corners, []
    for i, j in zip(range(n), (*range(1, n), 0)):
        faces += quad(i, j, n + j, n + i, fold) + quad(2 * n + j, 2 * n + i, 3 * n + i, 3 * n + j, fold)
        faces += quad(n + i, n + j, 3 * n + j, 3 * n + i, fold) + quad(j, i, 2 * n + i, 2 * n + j, fold)
    return solids.Solid(np.concatenate(rings), np.array(faces))


def pin(corners, radius, bottom, top, fold=False):
    n, faces = corners, []
    for i, j in zip(range(n), (*range(1, n), 0)):
        faces += quad(i, j, n + j, n + i, fold)
    faces += [face for i in range(1, n - 1) for face in ((0, i + 1, i), (n, n + i, n + i + 1))]
    return solids.Solid(np.concatenate([ring(n, radius, z) for z in (bottom, top)]), np.array(faces))


def turned(solid, tilt):
    return solids.Solid(solid.points @ TILTS[tilt].T, solid.faces)


@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize("ends", [(0.2, 0.8), (-0.3, 1.3), (0.2, 1.3), (0, 1)])
@pytest.mark.parametrize("gap", [0, 1e-15, 1e-12, 1e-9])
def test_a_plate_is_not_around_the_pin_in_its_bore(gap, ends, tilt, tmp_path):
    solid = solids.unite(washer(5, 1.5, 0.4, 0, 1), pin(5, 0.4 * (1 - gap), *ends))
    run_stages(turned(solid, tilt), tmp_path, levels=LEVELS)
    found = certificate(tmp_path)
    assert failures(found) == [] and found["verdict"] == "exact" and found["reason"] == ""
    assert found["shells"] == 2 and found["genus"] == 1 and found["solid_interpretation"] == ""
    assert read_table(tmp_path / "shells.parquet", "shells")["parent"].to_pylist() == [None, None]


@pytest.mark.parametrize("tilt", TILTS)
def test_a_pin_that_is_too_thick_shares_material(tilt, tmp_path):
    solid = solids.unite(washer(5, 1.5, 0.4, 0, 1), pin(5, 0.4 * (1 + 1e-6), -0.3, 1.3))
    run_stages(turned(solid, tilt), tmp_path, levels=LEVELS)
    found = certificate(tmp_path)
    assert failures(found) == [] and "inside or across" in found["solid_interpretation"]


@pytest.mark.parametrize("tilt", TILTS)
def test_sleeves_in_one_another_and_inserts_in_cavities(tilt, tmp_path):
    sleeves = solids.unite(washer(6, 1.5, 0.5, 0, 1), washer(6, 0.5, 0.25, 0.2, 0.8, False), pin(6, 0.25, -0.1, 0.9))
    cavity, insert = solids.scale(solids.cube(), 0.5), solids.transform(solids.cube(), np.diag([0.5, 0.5, 0.3]))
    inside = solids.move(solids.unite(solids.carve(cavity), insert), [0.25, 0.25, 0.25])
    solid = solids.unite(sleeves, solids.move(solids.unite(solids.cube(), inside), [4, 0, 0]))
    run_stages(turned(solid, tilt), tmp_path, levels=LEVELS)
    found = certificate(tmp_path)
    assert failures(found) == [] and found["verdict"] == "exact" and found["solid_interpretation"] == ""
    assert found["shells"] == 6 and found["genus"] == 2 and found["voids"] == 1


@needs_cases
@pytest.mark.parametrize(
    "name, shells, genus, interpretation",
    [
        ("pin_short_in_bore.obj", 2, 1, ""),
        ("pin_long_in_bore.obj", 2, 1, ""),
        ("small_at_utm.obj", 1, 1, ""),
        ("pocket_through_wall.off", 1, 0, "The surface crosses itself."),
    ],
)
def test_cases(name, shells, genus, interpretation, tmp_path):
    run_mesh(CASES / name, tmp_path, tilt={"mode": "auto"}, levels=LEVELS)
    found = certificate(tmp_path)
    assert failures(found) == [] and found["verdict"] == "exact"
    assert found["shells"] == shells and found["genus"] == genus
    assert found["solid_interpretation"].startswith(interpretation) and bool(interpretation) == bool(
        found["solid_interpretation"]
    )


@needs_cases
def test_the_reason_says_that_the_surface_crosses_itself(tmp_path):
    run_mesh(CASES / "tube_that_turns_over.off", tmp_path, tilt={"mode": "auto"}, levels=LEVELS)
    found = certificate(tmp_path)
    assert found["verdict"] == "uncertified"
    assert found["reason"].startswith("The surface crosses itself") and repr(failures(found)[0]) in found["reason"]


def test_the_reason_says_what_levels_do_not_tell_apart(tmp_path):
    levels = LEVELS | {"distance": 0.5, "refine": "none", "feature_size": 0.01}
    run_stages(solids.torus(upright=True), tmp_path, levels=levels)
    found = certificate(tmp_path, levels)
    assert found["verdict"] == "uncertified" and failures(found) == []
    assert "smaller distance" in found["reason"]
