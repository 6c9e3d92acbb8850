"""The comparison with peers, on meshes of a few hundred faces and with no peer installed."""

import importlib
import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parent.parent


@pytest.fixture
def benchmark(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    return importlib.import_module


@pytest.mark.parametrize("tilt", ["lying", "upright"])
def test_bumpy_torus_is_a_torus_of_the_size_asked_for(benchmark, tilt):
    meshes = benchmark("bumpy_meshes")
    points, faces = meshes.bumpy_torus(5000, bumps=3, tilt=tilt, height=0.01)
    edges = {tuple(edge) for face in faces for edge in zip(face, np.roll(face, -1))}
    assert abs(len(faces) - 5000) < 100 and 2 * len(points) == len(faces)
    assert len(edges) == 3 * len(faces) and all((b, a) in edges for a, b in edges)
    a, b, c = points[faces.T]
    volume = np.einsum("ij,ij", a, np.cross(b, c)) / 6
    assert volume == pytest.approx(2 * np.pi**2 * meshes.MAJOR * meshes.MINOR**2, rel=0.02)


def test_no_level_is_at_a_vertex(benchmark):
    heights = benchmark("bumpy_meshes").level_heights(np.array([[0, 0, 0], [0, 0, 0.5], [0, 0, 1.0]]), 1)
    assert heights == [np.nextafter(0.5, 1)]


def test_figures_of_rings(benchmark):
    square = np.array([(0, 0), (2, 0), (2, 2), (0, 2.0)])
    hole = square[::-1] / 2 + 0.5
    figures = benchmark("answer_figures").region_figures([[square, hole]])
    assert figures == {"contours": 2, "points": 8, "area": 3.0, "absolute_area": 5.0, "regions": 1}


def test_comparison_runs_and_writes_its_page(benchmark, monkeypatch, tmp_path):
    compare, page = benchmark("compare_peers"), benchmark("benchmark_page")
    monkeypatch.setattr(compare, "find_version", lambda one: None if one.package else "")
    cell = compare.Cell(("surface graph",), "upright", 600)
    table = compare.measure_cells([cell], 1, 60, ["reebslice", "VTK"])
    ours, theirs = table.itertuples()
    assert ours.status == "ok" and ours.raw > ours.prepare > 0 and ours.warm > 0
    assert ours.loops == 1 and ours.nodes % 2 == 0 and theirs.status == "not installed"
    text = (ROOT / "docs" / "benchmarks.md").read_text()
    empty = re.sub(r"(<!-- [\w ]+ begins -->\n).*?(?=<!--)", r"\1", text, flags=re.DOTALL)
    (tmp_path / "benchmarks.md").write_text(empty)
    page.write_page(tmp_path / "benchmarks.md", table)
    page.draw_growth(tmp_path / "growth.svg", table)
    written = (tmp_path / "benchmarks.md").read_text()
    assert re.search(r"graphs begins -->\n.*\n.*\n\| upright, 12 bumps \| 600 \| \d+ \| 1 \|.* not installed", written)
    # two tables are those of measure_crossings and measure_questions
    assert {*page.TABLES, "crossings", "questions"} == set(re.findall(r"<!-- ([\w ]+) begins -->", text))
    assert (tmp_path / "growth.svg").stat().st_size > 10_000


# --------------------------------------------------------------------------
# CAD models beside what OpenCascade says of their files


SOUND = {
    "solids": 1,
    "shells_told": 2,
    "genus_told": 3,
    "odd": 0,
    "irregular": 0,
    "pinched": 0,
    "untrimmed": 0,
    "loose": 0,
}
EQUAL = {"outcome": "exact", "genus": 3, "shells": 2, "bodies": 1, **SOUND}


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({}, "agrees"),
        ({"genus": 4}, "genus: unexplained"),
        ({"shells": 1, "bodies": 0}, "shells, bodies: unexplained"),
        ({"genus": 4, "irregular": 2}, "genus: edges of one, three or more faces"),
        ({"shells": 1, "duplicate_faces_removed": 12}, "shells: duplicate_faces_removed"),
        ({"outcome": "rejected", "loose": 5}, "no graph; the file: faces outside of solids"),
        ({"outcome": "rejected"}, "no graph; the file: sound"),
        (dict.fromkeys(SOUND, float("nan")), "genus, shells, bodies: OpenCascade's bindings cannot read it"),
    ],
)
def test_cad_models_that_differ_from_their_files_are_told_by_kind(benchmark, changes, kind):
    assert benchmark("score_cad").tell_kind(EQUAL | changes) == kind


def test_cad_files_are_picked_by_a_rule_and_dealt_out_to_shards(benchmark, tmp_path):
    for number in range(10):
        (tmp_path / "in").mkdir(exist_ok=True)
        (tmp_path / f"in/{number}.STEP").write_bytes(bytes(1_100_000 if number == 6 else 10))
    (tmp_path / "in/0.stl").touch()
    score = benchmark("score_cad")
    paths = score.pick_files(tmp_path / "in", 3, 1.0)
    assert [path.name for path in paths] == ["0.STEP", "3.STEP", "9.STEP"]
    score.link_files(tmp_path / "in", paths[0::2], tmp_path / "out")
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["0.STEP", "9.STEP"]


def test_topology_of_shapes_of_known_genus(benchmark):
    pytest.importorskip("OCP", reason="cadquery-ocp is of the benchmarks' environment")
    assert len(benchmark("cad_topology").check_known_shapes()) > 9
