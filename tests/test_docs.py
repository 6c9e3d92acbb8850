"""What the documentation says: names that are there, and snippets that run."""

import fnmatch
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import trimesh

import certify
import pipeline
import reebslice
import solids
import view
from corpus.storage import read_json
from reebslice.descriptors.neighbours import distance_table

DOCS = Path(__file__).parents[1] / "docs"


@pytest.mark.parametrize("solid", [solids.torus(upright=True), solids.ball_in_hollow_ball()])
def test_every_check_of_a_certificate_is_explained(solid, tmp_path):
    table = (DOCS / "certificate.md").read_text().partition("## The checks")[2].partition("## ")[0]
    rows = [line.split("|")[1] for line in table.splitlines() if line.startswith("| `")]
    patterns = [name.replace("...", "*") for row in rows for name in re.findall("`([^`]+)`", row)]
    pipeline.run_stages(solid, tmp_path)
    certify.main(tmp_path, tmp_path, pipeline.OPTIONS["levels"])
    checks = read_json(tmp_path / "certificate.json")["checks"]
    assert len(checks) > 100
    assert [name for name in checks if not any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)] == []


def test_every_exported_function_and_class_is_on_the_page_of_the_library():
    told = re.findall(r"auto(?:function|class):: (\w+)|`(SCHEMAS)`", (DOCS / "api.md").read_text())
    assert {first or second for first, second in told} == set(reebslice.__all__) - {"__version__", "errors"}


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The folder of the pages, and that of the results which one of the examples in them makes."""
    folder = tmp_path_factory.mktemp("pages")
    options = ("--quiet", "--fail-on-warning", "--keep-going", "-b", "html")
    command = [sys.executable, "-m", "sphinx", *options, DOCS, folder]
    done = subprocess.run(command, cwd=DOCS.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder, DOCS.parent / "build" / "notebook"


def test_pages_are_made_without_a_warning_and_examples_run(built):
    assert (built[0] / "gallery" / "plot_from_results.html").exists()


# What the snippets of a page print, in order. Of DuckDB and PyTorch, which `make test-readers` tries, none is run here.
PRINTED = {
    "README.md": [r"torus_upright +ok +exact.*\n4 events, 4 arcs", r"\['tunnel'\]"],
    "docs/cluster.md": [""],
    "docs/directions.md": [r"\[.*\] \d+ "],
    "docs/centrelines.md": [r"\d+ critical points, \d+ arcs"],
    "docs/how-to.md": ["1\n0\n"],
    "docs/loops.md": [r"(tunnel at \[.*\], \d.*\n){2}"],
    "docs/page.md": [r"^\[[\d. \n]+\]\n$"],
    "docs/parts.md": [r"2 19\.0\n3 18\.0\n"],
    "docs/pockets.md": [r"basin from height 1.00, 1.00 deep, 1.0 in volume"],
    "docs/readers.md": ["", None, None],
    "docs/similarity.md": [r"^model\nvase +0.0\nplate +1.0\nknot +1.0\n", r"\d\.\d+ 0\.\d+"],
    "docs/tutorial.md": [r"vase +exact +\d.*kind +height +inscribed_radius\n.*handle"],
}


@pytest.fixture
def place(built, tmp_path, monkeypatch):
    """A folder with what snippets read: those results, with a page, as one share of a corpus, too; and a mesh."""
    shutil.copytree(built[1] / "results", tmp_path / "results")
    shutil.copytree(tmp_path / "results/corpus", tmp_path / "shares/one/results/corpus")
    folder = tmp_path / "results/models/vase"
    view.main(folder, folder, {"faces": 2000})
    far = np.abs(np.subtract.outer(np.arange(3.0), np.arange(3.0)))
    pq.write_table(distance_table(["plate", "vase", "knot"], far), tmp_path / "results/corpus/distances.parquet")
    block = np.ones((7, 3, 2), bool)
    block[1, 1, :] = block[3, 1, :] = block[5, 1, 1] = False  # two holes through it, and a pocket
    solid = solids.voxels(block)
    trimesh.Trimesh(solid.points, solid.faces).export(tmp_path / "part.stl")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")


def test_snippets_run(place, capsys):
    found = {}
    for path in [DOCS.parent / "README.md", *sorted(DOCS.glob("*.md"))]:
        snippets = re.findall(r"```python\n(.*?)```", path.read_text(), re.DOTALL)
        if snippets:
            found[str(path.relative_to(DOCS.parent))] = snippets
    assert {name: len(snippets) for name, snippets in found.items()} == {name: len(e) for name, e in PRINTED.items()}
    for name, snippets in found.items():
        for snippet, expected in zip(snippets, PRINTED[name]):
            if expected is not None:
                exec(compile(snippet.replace("bracket", "vase"), name, "exec"), {})  # noqa: S102, the project's own
                said = capsys.readouterr().out
                assert re.search(expected, said, re.DOTALL), (name, said)
