"""How people come to the workflow: a configuration and a sheet of their own, one model, use as a module."""

import shutil
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import yaml

from corpus.code_digest import read_outputs
from corpus.configuration import describe_sources
from corpus.layout import STAGES
from corpus.storage import read_json
from test_workflow import CHOSEN, EVERYTHING, GIVEN, models_table, planned, run, stages_from, stamps, write_box

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A corpus with a configuration of its own, run to its end; and what the run said."""
    folder = tmp_path_factory.mktemp("finished")
    write_box(folder / "meshes/tall.off", 2.0)
    write_box(folder / "meshes/wide.off", 0.5)
    write_config(folder, GIVEN | {"batches": {"size": 100, "most": 1}})
    code, said = run(folder, options=())
    assert code == 0, said
    return folder, said


@pytest.fixture
def folder(finished, tmp_path):
    """A copy of the finished corpus, with its times."""
    return shutil.copytree(finished[0], tmp_path / "corpus")


def write_config(folder, config):
    path = folder / "config/config.yaml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(yaml.safe_dump(config))


# The configuration of the working directory


def test_the_run_says_which_files_it_took(finished):
    folder, said = finished
    taken = f"{ROOT / 'config/config.yaml'}, then {folder / 'config/config.yaml'}, then --config meshes"
    assert [line for line in said.splitlines() if line.startswith("Configuration: ")] == [f"Configuration: {taken}"]
    told = describe_sources(["a.yaml"], ["b.yaml"], {"meshes": 1, "draw": {}})
    assert told == "a.yaml, then --configfile b.yaml, then --config meshes draw"


def test_the_configuration_of_the_working_directory_counts_and_the_command_line_wins(folder):
    write_config(folder, GIVEN | {"draw": {"width": 400}})  # other keys keep what was given, or their defaults
    assert set(planned(folder, options=())) == {"draw"}
    (folder / "more.yaml").write_text("draw: {width: 300}\n")
    assert planned(folder, "--configfile", "more.yaml", options=()) == {}
    wins = ("nodes={sampler: centroid}", "draw={width: 400}")
    assert set(planned(folder, "--configfile", "more.yaml", options=wins)) == stages_from("sample_nodes")


def test_every_stage_runs_where_it_is_asked_for(folder):
    """Those that are off by default, or that other tests go without."""
    code, said = run(folder, options=EVERYTHING)
    assert code == 0, said
    assert f"Open in a browser, for all of it: {folder / 'results/corpus/report.html'}" in said
    for model in ("tall", "wide"):
        for stage in STAGES:
            assert set(read_outputs(ROOT / f"workflow/scripts/{stage}.py")) <= set(stamps(folder, model)), stage


def test_a_fault_in_it_is_told_with_the_files(folder):
    write_config(folder, {"levls": {}})
    code, said = run(folder, options=())
    assert code == 1 and "levls is not a key; did you mean levels?" in said
    assert f"It was taken from {ROOT / 'config/config.yaml'}, then {folder / 'config/config.yaml'}, then --conf" in said


def test_the_library_beside_the_workflow_counts_though_another_is_installed(folder, tmp_path):
    other = tmp_path / "elsewhere/reebslice/__init__.py"
    other.parent.mkdir(parents=True)
    other.write_text("raise ImportError('the other one')\n")
    write_box(folder / "meshes/new.off", 0.7)
    environment = {"PYTHONPATH": str(tmp_path / "elsewhere")}
    code, said = run(folder, "results/models/new/tilt.json", options=(), environment=environment)
    assert code == 0, said


# One model, some models


def test_a_file_that_is_asked_for_is_made_alone(folder):
    file = "results/models/new/tilt.json"
    write_box(folder / "meshes/new.off", 0.7)
    (folder / "meshes/torn.off").write_text("OFF\n")
    before = {model: stamps(folder, model) for model in ("tall", "wide")}
    table = (folder / "results/corpus/models.parquet").read_bytes()
    assert planned(folder, file, options=()) == {"inspect_mesh": 1, "select_tilt": 1}
    code, said = run(folder, file, "results/models/torn/tilt.json", options=())
    assert code == 1, said
    assert "1 of 2 files asked for were not made:" in said and "results/models/torn/tilt.json: rejected" in said
    made = stamps(folder, "new")
    assert set(made) - {"tilt.json"} == {name for name in made if "inspect" in name or "select" in name} | {
        f"{name}.parquet" for name in ("vertices", "faces", "shells")
    }
    assert {model: stamps(folder, model) for model in before} == before
    assert (folder / "results/corpus/models.parquet").read_bytes() == table
    assert planned(folder, file, options=()) == {}
    (folder / file).unlink()
    assert planned(folder, file, options=()) == {"select_tilt": 1}
    assert run(folder, "--until", "inspect_mesh", options=())[0] == 0  # of the whole corpus
    assert stamps(folder, "new") == {name: time for name, time in made.items() if name != "tilt.json"}


def test_a_run_over_some_models_leaves_those_of_the_whole_corpus_as_they_are(folder):
    before = {model: stamps(folder, model) for model in ("tall", "wide")}
    code, said = run(folder, "--until", "select_tilt", options=("only=*ll",))
    assert code == 0 and "Only 1 of 2 models" in said, said
    assert {model: stamps(folder, model) for model in before} == before
    assert planned(folder, options=()) == {}


# A sheet of models


def test_a_row_of_the_sheet_computes_its_models_and_no_other(folder):
    wide = stamps(folder, "wide")
    sheet = folder / "config/models.tsv"
    sheet.write_text("model\tup\tdistance\tunit\ntall\ty\t0.25\tinch\n")
    assert set(planned(folder, options=())) == set(CHOSEN)
    targets = [f"results/models/{model}/levels.parquet" for model in ("tall", "wide")]
    code, said = run(folder, *targets, options=())
    assert code == 0 and "config/models.tsv says what is another for 1 of 2 models" in said, said
    assert stamps(folder, "wide") == wide
    assert read_json(folder / "results/models/tall/inspection.json")["unit"] == "inch"
    assert read_json(folder / "results/models/tall/tilt.json")["direction"] == [0.0, 1.0, 0.0]
    heights = pq.read_table(folder / targets[0])["height"].to_numpy()
    assert heights.tolist() == [0.375, 1.125, 1.875, 2.625]  # of a box from y = 0 to y = 3
    sheet.write_text("modle\tup\ntal\ty\n")
    code, said = run(folder, options=())
    assert code == 1 and "config/models.tsv cannot be used" in said and "'modle' is not a column" in said


def test_what_is_not_there_to_be_made_is_told(folder):
    code, said = run(folder, "results/models/tal/tilt.json", options=())
    assert code == 1 and "there is no model 'tal'; did you mean 'tall'?" in said


# As a module of another workflow

OTHERS = """
configfile: "config/config.yaml"

module reebslice:
    snakefile: {snakefile!r}
    config: config["reebslice"]

use rule * from reebslice as graphs_*

rule count:
    default_target: True
    input:
        "results/corpus/models.parquet",
    output:
        "count.txt",
    shell:
        "echo {{config[said]}} > {{output}}"

onstart:
    reebslice.onstart()

onsuccess:
    reebslice.onsuccess()
"""


def test_another_workflow_uses_this_one_as_a_module(tmp_path):
    write_box(tmp_path / "meshes/wide.off")
    write_config(tmp_path, {"said": "hello", "reebslice": GIVEN | {"meshes": "meshes"}})
    (tmp_path / "Snakefile").write_text(OTHERS.format(snakefile=str(ROOT / "workflow" / "Snakefile")))
    command = [sys.executable, "-m", "snakemake", "--cores", "2"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "count.txt").read_text() == "hello\n"
    assert models_table(tmp_path)["wide"]["verdict"] == "exact"
    assert "1 model: 1 exact" in done.stderr  # by its own word, handed on by the other's handlers
    again = subprocess.run([*command, "-n"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "Nothing to be done" in again.stdout + again.stderr
    (tmp_path / "Snakefile").write_text(
        OTHERS.format(snakefile=f"{ROOT}/workflow/Snakefile").replace("    config:", '    prefix: "x"\n    config:')
    )
    refused = subprocess.run([*command, "-n"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert refused.returncode == 1 and "cannot be used as a module with prefix:" in refused.stdout + refused.stderr
