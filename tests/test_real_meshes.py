"""The whole pipeline on real meshes that nobody here made: certified, with the known invariants."""

import csv
import json
from pathlib import Path

import pytest

import certify
from pipeline import run_mesh

CORPUS = Path(__file__).parents[2] / "shared" / "meshes"
LARGEST = 60_000  # faces; the larger ones take most of the time and show nothing else

pytestmark = pytest.mark.skipif(not (CORPUS / "MANIFEST.csv").is_file(), reason="the corpus ../shared/meshes is absent")

DEFAULT = {
    "tilt": {"mode": "auto"},
    "levels": {"distance": 0.01, "units": "relative", "refine": "feature", "feature_size": 0.02},
    "nodes": {"sampler": "inscribed"},
}


def accepted():
    """Rows of the manifest whose mesh is, or becomes, a closed surface."""
    path = CORPUS / "MANIFEST.csv"
    if not path.is_file():
        return [{"file": "none"}]
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["status"].startswith(("closed", "huge"))]
    rows = [row for row in rows if row["file"] != "greatwhite_w.stl"]  # one of its parts is one-sided
    return [row for row in rows if int(row["faces"]) <= LARGEST]


def run(row, folder, **sections):
    """The certificate of a mesh; `sections` alter the default options."""
    options = {name: section | sections.get(name, {}) for name, section in DEFAULT.items()}
    run_mesh(CORPUS / row["file"], folder, **options)
    certify.main(folder, folder, options["levels"])
    certificate = json.loads((folder / "certificate.json").read_text())
    failed = {name: check for name, check in certificate["checks"].items() if not check["holds"]}
    assert (failed == {}) == (certificate["verdict"] != "uncertified")
    assert certificate["genus"] == int(row["genus"])
    assert certificate["voids"] == int(row["void_shells"] or 0)
    assert certificate["genus"] == certificate["loops_surface"] + certificate["hidden_genus"]
    index = certificate["handles"]
    assert certificate["euler_characteristic"] == index["0"] - index["1"] + index["2"]
    return certificate


@pytest.mark.parametrize("row", accepted(), ids=lambda row: row["file"])
def test_the_default_config_certifies(row, tmp_path):
    assert run(row, tmp_path)["verdict"] in ("exact", "exact_at_feature_size")


@pytest.mark.parametrize("row", accepted(), ids=lambda row: row["file"])
def test_exact_refinement_resolves_everything(row, tmp_path):
    certificate = run(row, tmp_path, levels={"refine": "exact"})
    assert certificate["verdict"] == "exact"
    assert certificate["hidden_genus"] == certificate["compound"] == certificate["unseen"] == 0


@pytest.mark.parametrize("row", [r for r in accepted() if "cad" in r.get("kind", "")], ids=lambda row: row["file"])
def test_flats_and_ties_are_exact_without_a_tilt(row, tmp_path):
    certificate = run(row, tmp_path, levels={"refine": "exact"}, tilt={"mode": "none"})
    assert certificate["verdict"] == "exact"
