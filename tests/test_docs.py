"""What the documentation says: names that are there, and snippets that run."""

import fnmatch
import re
import subprocess
import sys
from pathlib import Path

import pytest

import certify
import pipeline
import reebslice
import solids
from corpus.storage import read_json
from test_door import run_python

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


def test_snippets_run():
    page = (DOCS / "how-to.md").read_text()
    snippets = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert len(snippets) == 1
    assert run_python(snippets[0]).split() == ["1", "0"]


def test_pages_are_made_without_a_warning_and_examples_run(tmp_path):
    options = ("--quiet", "--fail-on-warning", "--keep-going", "-b", "html")
    command = [sys.executable, "-m", "sphinx", *options, DOCS, tmp_path]
    done = subprocess.run(command, cwd=DOCS.parent, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "gallery" / "plot_from_results.html").exists()
