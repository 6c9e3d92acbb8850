"""check.py says yes to what the stages write, and to nothing else.

The full campaign of altered results is `python tests/mutate_results.py RESULTS 10000` with workflow/scripts on
PYTHONPATH, RESULTS being folders of results as Snakemake leaves them.
"""

import ast
import json
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest

import certify
import pipeline
import solids
from mutate_results import CHECKOUT, check, run


def pockets():
    """A block with two pockets, one wound around the other, and an island on the floor of a third."""
    filled = np.ones((9, 9, 4), bool)
    filled[1:7, 1, 1:] = filled[6, 1:6, 1:] = filled[1:7, 5, 2:] = False
    filled[1:4, 3, 1:] = False
    filled[1:8, 7, 3:] = False
    filled[4, 7, 3] = True
    return solids.voxels(filled)


SLANT = {"mode": "direction", "direction": [0.1, 0.2, 0.97]}
MODELS = {
    "nested": (solids.nested_shells(4), {"tilt": SLANT}),
    "torus": (solids.torus(upright=True), {"tilt": SLANT}),
    "flat": (solids.plate(3, upright=True), {}),
    "multiple_saddle": (solids.wedges([1, -1, 1, 1, -1, 1, -1, -1], 5), {}),
    "pockets": (pockets(), {}),
    "cup": (solids.cup(), {"tilt": SLANT}),
    "noisy": (
        solids.unite(solids.blob(3, 2), solids.move(solids.torus(upright=True), [6, 0, 0.3])),
        {"tilt": SLANT, "levels": {"refine": "feature"}},
    ),
    "apart": (solids.unite(solids.cup(), solids.move(solids.cube(), [0.31, 0.32, 0.33])), {"tilt": SLANT}),
}


def write_model(folder, solid, **sections):
    """Run all stages that check.py reads from."""
    folder.mkdir(parents=True)
    pipeline.write_off(folder / "model.off", solid)
    pipeline.run_mesh(folder / "model.off", folder, **sections)
    certify.main(folder, folder, pipeline.OPTIONS["levels"] | sections.get("levels", {}))


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("check")
    for name, (solid, sections) in MODELS.items():
        write_model(folder / "models" / name, solid, **sections)
    return folder


def test_what_the_stages_write_is_accepted(results, capsys):
    verdicts = {
        path.parent.name: json.loads(path.read_text())["verdict"] for path in results.glob("*/*/certificate.json")
    }
    assert verdicts == dict.fromkeys(MODELS, "exact") | {"noisy": "exact_at_feature_size"}
    assert check.main(results) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:2] for line in lines] == [[name, "yes"] for name in sorted(MODELS)]


def test_one_refusal_is_told_and_ends_in_exit_code_1(results, tmp_path, capsys):
    for name in ("torus", "cup"):
        shutil.copytree(results / "models" / name, tmp_path / "models" / name)
    graphs = [results / "models" / name / "solid.graphml" for name in ("torus", "cup")]
    shutil.copy(graphs[0], tmp_path / "models" / "cup")
    assert check.main(tmp_path) == 1
    one, two = capsys.readouterr().out.splitlines()
    assert one.split()[:2] == ["cup", "NO"]
    assert two.split()[:2] == ["torus", "yes"]


def test_what_claims_nothing_is_neither_accepted_nor_refused(results, tmp_path, capsys):
    folder = tmp_path / "models" / "torus"
    shutil.copytree(results / "models" / "torus", folder)
    told = json.loads((folder / "certificate.json").read_text())
    (folder / "certificate.json").write_text(json.dumps(told | {"verdict": "uncertified"}))
    assert check.main(tmp_path) == 0
    assert capsys.readouterr().out.split()[1:] == ["-", "uncertified:", "it", "makes", "no", "claim"]


def test_a_reader_that_has_enough_ends_it_without_a_traceback(results, tmp_path):
    shutil.copytree(results / "models" / "torus", tmp_path / "models" / "torus")
    command = [sys.executable, str(CHECKOUT / "check.py"), str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        running.stdout.close()  # as `| head` does
        assert running.stderr.read() == b""
    assert running.returncode == -signal.SIGPIPE


def test_no_alteration_is_accepted_that_changes_an_answer(results):
    counts, wrong = run([results / "models" / name for name in sorted(MODELS)], 250, 1)
    assert wrong == []
    ends = {end: sum(times for (_, e, _), times in counts.items() if e == end) for _, end, _ in counts}
    assert ends["refused"] > 100
    assert ends["harmless"] > 20


def test_it_is_one_short_file_that_shares_no_code_with_what_it_checks():
    text = (CHECKOUT / "check.py").read_text()
    assert len(text.splitlines()) <= 300
    nodes = list(ast.walk(ast.parse(text)))
    imported = {alias.name.split(".")[0] for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module.split(".")[0] for node in nodes if isinstance(node, ast.ImportFrom)}
    assert imported - sys.stdlib_module_names == {"numpy", "pyarrow"}
