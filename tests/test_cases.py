"""Small valid files of kinds that were once misread or certified wrongly, each with its right answer.

`expected.json` beside the files says per file what is right: counts and
measures in the file's own units, and what a refusal has to name.
"""

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import certify
from corpus.storage import read_json
from pipeline import OPTIONS, run_mesh
from reebslice import exact_graphs, inspect_surface, read_mesh
from reebslice.errors import MeshFormatError

CASES = Path(__file__).parents[2] / "shared" / "cases"
EXPECTED = json.loads((CASES / "expected.json").read_text()) if CASES.is_dir() else {}
pytestmark = pytest.mark.skipif(not EXPECTED, reason="the folder of cases is not beside the checkout")

# What the reason of a refusal has to name.
NAMED = {
    "3mf_required_unknown.3mf": "beam lattice",
    "gltf_draco.glb": "KHR_draco_mesh_compression",
    "gltf_meshopt.glb": "meshopt",
    "lfs_pointer.stl": "Git LFS pointer",
}
# Heights of the nodes, and arcs with the lower end first: of `solid_graph`, z up.
FORKS = {"ngon_u": ([0, 1, 3, 3], 3), "concave_dart": (None, 3)}
CERTIFIED = ("pin_long_in_bore.obj", "pin_short_in_bore.obj", "small_at_utm.obj", "insert_in_cavity.stl")
CROSSING = ("pocket_through_wall.off", "tube_that_turns_over.off")


def read_and_inspect(name):
    """The tables and the record of an accepted file, or the reason of a refusal."""
    try:
        file = read_mesh(CASES / name)
    except MeshFormatError as error:
        return None, None, str(error)
    tables, record = inspect_surface(file.points, file.faces, OPTIONS["inspect"])
    return tables, record, record["reason"]


@pytest.mark.parametrize("name", EXPECTED)
def test_a_file_is_read_as_its_format_says_or_refused_by_name(name):
    expected = EXPECTED[name]
    tables, record, reason = read_and_inspect(name)
    if tables is None:
        assert expected.get("status") == "rejected" or "or_reason" in expected, reason
        assert NAMED.get(name, expected.get("or_reason", "")).lower() in reason.lower() and reason
        return
    assert expected.get("status", "accepted") != "rejected"
    for figure in ("components", "genus", "voids"):
        assert record[figure] == expected.get(figure, record[figure]), figure
    for figure in ("area", "volume"):
        assert record[figure] == pytest.approx(expected.get(figure, record[figure]), rel=2e-6), (
            figure
        )  # told in six digits
    assert np.array(record["bounds"]) == pytest.approx(np.array(expected.get("bounds", record["bounds"])), abs=1e-6)


@pytest.mark.parametrize("name", [name for name in EXPECTED if name.startswith(("ngon_u", "concave_dart"))])
def test_a_concave_polygon_gives_the_graph_of_its_solid(name):
    tables, _, _ = read_and_inspect(name)
    points = np.column_stack([tables["vertices"][axis] for axis in "xyz"])
    solid = exact_graphs(points, np.column_stack([tables["faces"][corner] for corner in "abc"]))[1]
    ends = Counter(solid.arcs.ravel().tolist())
    minima, maxima = (
        np.setdiff1d(range(len(solid.vertex)), solid.arcs[:, 1]),
        np.setdiff1d(range(len(solid.vertex)), solid.arcs[:, 0]),
    )
    if name.startswith("ngon_u"):
        assert solid.height.tolist() == [0, 1, 3, 3] and len(minima) == 1 and len(maxima) == 2
    else:
        assert len(minima) == 2 and len(maxima) == 1
    assert len(solid.arcs) == 3 and sorted(ends.values()) == [1, 1, 1, 3]


def test_units_are_told_and_coordinates_never_scaled():
    file = read_mesh(CASES / "3mf_inch.3mf")
    assert file.unit == "inch" and np.ptp(file.points, axis=0).tolist() == [1, 1, 1]
    assert read_mesh(CASES / "gltf_sparse.glb").unit == "metre"
    assert read_mesh(CASES / "far_box_1km.step").unit == "millimetre"
    assert read_mesh(CASES / "ngon_u.obj").unit is None


def test_double_sided_faces_are_one_body_whatever_the_format():
    _, record, _ = read_and_inspect("double_sided.obj")
    assert (record["components"], record["voids"]) == (1, 0) and record["volume"] == pytest.approx(48)


def certificate_of(name, folder):
    run_mesh(CASES / name, folder, levels={"refine": "exact"})
    certify.main(folder, folder, OPTIONS["levels"])
    return read_json(folder / "certificate.json")


@pytest.mark.parametrize("name", CERTIFIED)
def test_bodies_that_touch_and_parts_far_from_the_origin_are_certified(name, tmp_path):
    found = certificate_of(name, tmp_path)
    assert found["verdict"] == "exact", [check for check, sides in found["checks"].items() if not sides["holds"]]


@pytest.mark.parametrize("name", CROSSING)
def test_a_surface_that_crosses_itself_is_said_to(name, tmp_path):
    found = certificate_of(name, tmp_path)
    assert "crosses itself" in found["solid_interpretation"] + found["reason"]
    failed = [check for check, sides in found["checks"].items() if not sides["holds"]]
    assert found["verdict"] == "uncertified" or not failed
    assert name != "pocket_through_wall.off" or not any("parent" in check for check in failed)
    assert found["verdict"] != "uncertified" or found["reason"]
