"""The workflow as users run it: what runs again after which change, and what it says.

One corpus of tiny meshes is run once; every test works on a copy of it.
"""

import base64
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pyarrow.parquet as pq
import pytest
import yaml

from corpus.code_digest import find_sources, read_outputs
from corpus.configuration import check_config
from corpus.layout import STAGES, chosen_stages, line_behind
from corpus.receipts import receipt_name
from corpus.storage import read_json, read_key

ROOT = Path(__file__).parent.parent
SCRIPTS = ROOT / "workflow" / "scripts"
MISSING = [stage for stage in STAGES if not (SCRIPTS / f"{stage}.py").exists()]
pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"stages that are not written yet: {MISSING}")

OPTIONS = ("levels={distance: 0.2}", "tilt={mode: none}", "nodes={sampler: representative}", "draw={width: 300}")
SCHEMA = yaml.safe_load((ROOT / "workflow/schemas/config.schema.yaml").read_text())
# what the configuration can switch on
EVERYTHING = ("view={pages: true}", "faces={find: true}", "pockets={cut: true}", "loops={draw: true}")
EVERYTHING += ("colours={find: true}", "parts={find: true}", "draw={width: 200, figures: true}", "export={files: true}")
EVERYTHING += ("functions=[geodesic, barycentre]", "centrelines={find: true}", "levels={distance: 0.2, refine: exact}")
OPTIONS += ("view={pages: false}", "faces={find: false}")  # of the stages aside, two
GIVEN = {key: yaml.safe_load(value) for key, value in (option.split("=", 1) for option in OPTIONS)}
CHOSEN = chosen_stages(check_config(GIVEN, SCHEMA))
BOX = [(x, y, z) for x in (0, 2) for y in (0, 3) for z in (0, 5)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
BOX_FACES = [corners for a, b, c, d in QUADS for corners in ((a, b, c), (a, c, d))]


def write_box(path, height=1.0, faces=BOX_FACES):
    """A box as OFF file, slightly sheared so that no two vertices are at one height."""
    points = [(x, y, (z + 0.1 * x + 0.03 * y) * height) for x, y, z in BOX]
    lines = ["OFF", f"{len(points)} {len(faces)} 0"]
    lines += [" ".join(map(str, point)) for point in points] + [f"3 {a} {b} {c}" for a, b, c in faces]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")


def run(folder, *arguments, options=OPTIONS, checkout=ROOT, meshes="meshes", environment=None):
    """Run Snakemake in `folder` with the Snakefile of `checkout`; return (exit code, what it said)."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(checkout / "Snakefile"), "--cores", "2"]
    command += ["--directory", str(folder), *arguments, "--config", f"meshes={meshes}", *options]
    given = {"cwd": folder, "env": os.environ | (environment or {}), "text": True}
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, **given)
    return done.returncode, done.stdout


def planned(folder, *arguments, **keywords):
    """The jobs that Snakemake would run, as {rule: count}; nothing to do is {}."""
    code, said = run(folder, "-n", *arguments, **keywords)
    assert code == 0 and "All models, with reasons" not in said, said  # a dry run tells of no outcome
    if "Nothing to be done" in said:
        return {}
    counts = dict(re.findall(r"^(\w+) +(\d+)$", said.split("Job stats:")[1].split("\n\n")[0], flags=re.MULTILINE))
    return {
        rule: int(count)
        for rule, count in counts.items()
        if rule not in ("all", "total", "collect_models", "report_models")
    }


def models_table(folder):
    rows = pq.read_table(folder / "results/corpus/models.parquet").to_pylist()
    return {row["model"]: row for row in rows}


def stamps(folder, model):
    """When each file of a model was written."""
    return {path.name: path.stat().st_mtime_ns for path in (folder / "results/models" / model).iterdir()}


def stages_from(stage):
    return set(line_behind(stage)).intersection(CHOSEN)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A corpus of two good meshes and an open one, run to its end; and what the run said.

    Their names fall into one batch, to keep the run short.
    """
    folder = tmp_path_factory.mktemp("finished")
    write_box(folder / "meshes/tall.off", 2.0)
    write_box(folder / "meshes/sub/wide box.off")
    write_box(folder / "meshes/torn.off", faces=BOX_FACES[1:])
    code, said = run(folder)
    assert code == 0, said
    return folder, said


@pytest.fixture
def folder(finished, tmp_path):
    """A copy of the finished corpus, with its times."""
    return shutil.copytree(finished[0], tmp_path / "corpus")


@pytest.fixture
def checkout(tmp_path):
    """A copy of the project, to be edited."""
    target = tmp_path / "checkout"
    for name in ("workflow", "config"):
        shutil.copytree(ROOT / name, target / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy2(ROOT / "Snakefile", target)
    return target


def test_odd_names_stop_nothing(tmp_path):
    for name in ("a <b>", "{c}"):
        write_box(tmp_path / "007" / f"{name}.off")
    (tmp_path / "007/gone.off").symlink_to("nowhere.off")
    code, said = run(tmp_path, meshes="007")
    assert code == 0, said
    assert {model: row["status"] for model, row in models_table(tmp_path).items()} == {"a <b>": "ok", "{c}": "ok"}
    assert "1 names in 007 are no meshes that can be read and are left out: 007/gone.off (no file" in said


def test_a_forced_stage_computes(folder):
    levels = folder / "results/models/tall/levels.parquet"
    whole = levels.read_bytes()
    levels.write_bytes(whole[:100])
    code, said = run(folder, "--forcerun", "slice_mesh")
    assert code == 0, said
    assert levels.read_bytes() == whole


def test_a_run_leaves_every_file_and_says_how_it_went(finished):
    folder, said = finished
    rows = models_table(folder)
    assert {model: row["status"] for model, row in rows.items()} == {
        "sub__wide box": "ok",
        "tall": "ok",
        "torn": "rejected",
    }
    assert rows["tall"]["path"] == "meshes/tall.off"
    assert rows["tall"]["verdict"] == "exact" and rows["torn"]["verdict"] == "rejected"
    assert rows["tall"]["genus"] == 0 and "open" in rows["torn"]["reason"].lower()
    for stage in CHOSEN:
        assert rows["tall"][f"seconds_{stage}"] >= 0 and rows["tall"][f"peak_memory_mb_{stage}"] > 1
    for model in ("tall", "sub__wide box"):
        expected = {name for stage in CHOSEN for name in (*read_outputs(SCRIPTS / f"{stage}.py"), receipt_name(stage))}
        assert set(stamps(folder, model)) == expected
        receipt = read_json(folder / "results/models" / model / receipt_name("slice_mesh"))
        assert read_key(folder / "results/models" / model / "levels.parquet") == receipt["key"]
    assert set(stamps(folder, "torn")) == {"inspection.json", receipt_name("inspect_mesh")}
    lines = said.splitlines()
    assert len(lines) < 40
    text = pd.read_csv(folder / "results/corpus/models.csv", keep_default_na=False)
    table = pq.read_table(folder / "results/corpus/models.parquet")
    assert list(text.columns) == table.column_names
    assert (
        text[["model", "status", "reason"]].to_dict("records")
        == table.select(["model", "status", "reason"]).to_pylist()
    )
    end = lines.index("3 models: 2 exact, 1 rejected")
    assert lines[end - 1] == "100%  3 of 3 models done"
    assert lines[end + 1] == "What needs a look:" and lines[end + 2].startswith("  torn: rejected: ")
    assert lines[end + 3] == f"All models, with reasons and figures: {folder / 'results/corpus/models.parquet'}"
    assert lines[end + 4] == f"Open in a browser, for all of it: {folder / 'results/corpus/report.html'}"
    assert lines[end + 5].startswith("Complete log(s): ")
    log = Path(lines[end + 5].partition(": ")[2]).read_text()
    batches = list((folder / "results/status/draw").iterdir())
    assert log.count("\nlocalrule ") == len(CHOSEN) * len(batches) + 3 and lines[end] in log  # every job


def test_cores_batches_hash_seed_locale_and_time_zone_change_no_byte(finished, tmp_path):
    shutil.copytree(finished[0] / "meshes", tmp_path / "meshes")
    write_box(tmp_path / "meshes/another.off", 3.0)  # one more model in the batch
    elsewhere = {"PYTHONHASHSEED": "12345", "LC_ALL": "C", "TZ": "Pacific/Apia"}
    code, said = run(tmp_path, "--cores", "1", options=(*OPTIONS, "batches={size: 100}"), environment=elsewhere)
    assert code == 0, said
    for model in ("tall", "sub__wide box"):
        for name in (name for stage in CHOSEN for name in read_outputs(SCRIPTS / f"{stage}.py")):
            one, other = (folder / "results/models" / model / name for folder in (finished[0], tmp_path))
            assert one.read_bytes() == other.read_bytes(), f"{model}/{name}"


def test_a_second_run_does_nothing(folder):
    code, said = run(folder)
    assert code == 0 and "Nothing to be done" in said
    end = said[said.index("Nothing to be done") :]  # how it went is told all the same
    assert "3 models: 2 exact, 1 rejected" in end and f"{folder}/results/corpus/report.html" in end


@pytest.mark.parametrize(
    "option, first",
    [
        ("inspect={merge_tolerance: 1e-7}", "inspect_mesh"),
        ("tilt={mode: auto}", "select_tilt"),
        ("levels={distance: 0.25}", "slice_mesh"),
        ("nodes={sampler: centroid}", "sample_nodes"),
        ("edges={method: proximity}", "synthesize_edges"),
        ("draw={width: 400}", "draw"),
    ],
)
def test_a_changed_key_runs_its_stages_and_those_behind(folder, option, first):
    section = option.split("=")[0]
    others = tuple(given for given in OPTIONS if not given.startswith(f"{section}="))
    assert set(planned(folder, options=(*others, option))) == stages_from(first)


def test_an_edited_module_runs_the_stages_that_use_it_and_those_behind(folder, checkout):
    assert planned(folder, checkout=checkout) == {}
    module = checkout / "workflow/scripts/reebslice/links/similarity.py"
    users = [stage for stage in CHOSEN if module in find_sources(checkout / f"workflow/scripts/{stage}.py")]
    assert users and users[0] != STAGES[0]
    module.write_text(module.read_text() + "\n# edited\n")
    assert set(planned(folder, checkout=checkout)) == stages_from(users[0])


def test_changed_added_and_removed_meshes_cost_themselves_alone(folder):
    before = stamps(folder, "sub__wide box")
    write_box(folder / "meshes/tall.off", 3.0)
    os.utime(folder / "meshes/tall.off", (1e9, 1e9))  # older than the file that it replaces
    write_box(folder / "meshes/new.off", 0.5)
    (folder / "meshes/torn.off").unlink()
    old = stamps(folder, "tall")
    code, said = run(folder)
    assert code == 0, said
    assert set(models_table(folder)) == {"new", "sub__wide box", "tall"}
    assert stamps(folder, "sub__wide box") == before
    assert all(stamps(folder, "tall")[name] > old[name] for name in old)
    assert "3 models: 3 exact" in said and "rejected" not in said
    assert planned(folder) == {}


def test_a_deleted_result_is_restored_and_nothing_else_computed(folder):
    before = stamps(folder, "tall")
    lost = folder / "results/models/tall/nodes.parquet"
    content = lost.read_bytes()
    lost.unlink()
    assert set(planned(folder)) == stages_from("sample_nodes")
    assert run(folder)[0] == 0
    assert lost.read_bytes() == content
    changed = {name for name, time in stamps(folder, "tall").items() if time != before[name]}
    assert changed == {"nodes.parquet", receipt_name("sample_nodes")}
    assert planned(folder) == {}


def results(folder):
    """Bytes of every file of the models but receipts, which tell seconds."""
    paths = (path for path in (folder / "results/models").rglob("*") if path.is_file() and path.name[0] != ".")
    return {path.relative_to(folder): path.read_bytes() for path in paths}


def test_what_was_altered_is_noticed_and_made_anew(folder):
    """By hand, by another program, by a disk; in files, receipts and tables: all in one run."""
    before, figures = results(folder), models_table(folder)
    tall, wide, torn = (folder / "results/models" / model for model in ("tall", "sub__wide box", "torn"))
    certificate = (tall / "certificate.json").read_text()
    (tall / "certificate.json").write_text(certificate.replace('"verdict": "exact"', '"verdict": "rejected"'))
    shutil.copy2(wide / "vertices.parquet", tall / "vertices.parquet")
    pq.read_table(wide / "levels.parquet").to_pandas().to_parquet(wide / "levels.parquet")
    (wide / "solid.graphml").write_bytes(bytes((wide / "solid.graphml").stat().st_size))
    os.truncate(wide / "picture.png", 100)
    lie = torn / receipt_name("inspect_mesh")
    lie.write_text(lie.read_text().replace('"rejected"', '"ok"'))
    for table in (folder / "results/corpus/models.parquet", *(folder / "results/status/draw").iterdir()):
        os.truncate(table, 1000)
    page = folder / "results/corpus/report.html"
    page.write_text(page.read_text().replace("1 rejected", "0 rejected"))
    code, said = run(folder)
    assert code == 0, said
    assert "1 rejected" in page.read_text() and "0 rejected" not in page.read_text()
    assert results(folder) == before and planned(folder) == {}
    after = models_table(folder)
    assert {model: row["verdict"] for model, row in after.items()} == {m: row["verdict"] for m, row in figures.items()}


def test_a_report_that_was_altered_or_deleted_is_made_anew_alone_and_can_be_switched_off(folder):
    page, table = (folder / "results/corpus" / name for name in ("report.html", "models.parquet"))
    whole, made = page.read_bytes(), table.stat().st_mtime_ns
    for change in (lambda: page.write_bytes(whole.replace(b"rejected", b"accepted")), page.unlink):
        change()
        code, said = run(folder)
        assert code == 0, said
        assert page.read_bytes() == whole and table.stat().st_mtime_ns == made
    page.unlink()
    code, said = run(folder, options=(*OPTIONS, "report={page: false}"))
    assert code == 0 and "Nothing to be done" in said and not page.exists()


def test_the_report_of_snakemake_carries_table_report_and_pictures_and_disturbs_nothing(folder):
    code, said = run(folder, "--report", "snakemake.html")
    assert code == 0, said
    text = (folder / "snakemake.html").read_text()
    carried = set(re.findall(r'"(results/[^"]*)": {"name": "', text))
    assert carried == {"results/corpus/models.parquet", "results/corpus/report.html"} | {
        f"results/models/{model}/picture.png" for model in ("tall", "sub__wide box")
    }
    picture = base64.b64encode((folder / "results/models/tall/picture.png").read_bytes()).decode()
    assert picture in text and '"labels": {"model": "tall", "shows": "picture"}' in text
    for told in (
        "hollow is side B",
        "What needs a look first, why and what to do",
        "Certified Reeb graphs of the meshes",
    ):
        assert told in text  # captions, and what is said of the whole
    assert planned(folder) == {}


def test_a_run_that_digests_everything_notices_what_has_size_and_time_of_before(folder):
    before, picture, mesh = (
        results(folder),
        folder / "results/models/tall/picture.png",
        folder / "meshes/sub/wide box.off",
    )
    for path, change in ((picture, lambda data: data[:-1] + b"?"), (mesh, lambda data: data.replace(b" 5.", b" 6."))):
        stat = path.stat()
        path.write_bytes(change(path.read_bytes()))
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert planned(folder) == {}
    old = stamps(folder, "tall")
    code, said = run(folder, options=(*OPTIONS, "verify=true"))
    assert code == 0, said
    after = results(folder)
    other = {path for path in before if after[path] != before[path]}
    assert {path.parent.name for path in other} == {"sub__wide box"}  # the picture is as it was
    assert {"vertices.parquet", "picture.png", "certificate.json"} <= {path.name for path in other}
    changed = {name for name, time in stamps(folder, "tall").items() if time != old[name]}
    assert changed == {"picture.png", "thumbnail.png", receipt_name("draw")}


def test_a_side_stage_that_is_switched_off_is_not_asked_for_and_its_results_stay_right(folder):
    before, off = results(folder), (*OPTIONS, "loops={find: false}")
    assert planned(folder, options=off) == {}  # what is there stays, and is withdrawn with what it was made of
    write_box(folder / "meshes/tall.off", 2.5)
    code, said = run(folder, options=off)
    assert code == 0, said
    assert {path.name for path in before if not (folder / path).exists()} == set(
        read_outputs(SCRIPTS / "find_loops.py")
    )
    assert "loops_handle" not in pq.read_schema(folder / "results/corpus/models.parquet").names
    assert run(folder)[0] == 0
    assert "loops_handle" in pq.read_schema(folder / "results/corpus/models.parquet").names
    assert {path.parent.name for path in results(folder) if path.name == "loops.parquet"} == {"tall", "sub__wide box"}


def test_a_fault_of_the_program_stops_one_model_is_told_and_tried_again(folder, checkout):
    script = checkout / "workflow/scripts/draw.py"
    fault = '    if "tall" in str(source):\n        raise RuntimeError("no paper")\n'
    whole = script.read_text()
    script.write_text(re.sub(r"^def main\(.*\):\n", lambda head: head[0] + fault, whole, flags=re.MULTILINE))
    code, said = run(folder, checkout=checkout)
    assert code == 1
    assert "1 of the models FAILED" in said and "3 models: 1 exact, 1 rejected, 1 FAILED" in said
    rows = models_table(folder)
    assert rows["tall"]["status"] == "failed" and rows["tall"]["reason"] == "draw: RuntimeError: no paper"
    assert rows["sub__wide box"]["status"] == "ok"
    assert not set(read_outputs(SCRIPTS / "draw.py")) & set(stamps(folder, "tall"))
    assert "Traceback" in "".join(path.read_text() for path in (folder / "results/logs/draw").iterdir())
    assert set(planned(folder, checkout=checkout)) == {"draw"}  # tried again
    script.write_text(whole)
    assert run(folder, checkout=checkout)[0] == 0
    assert models_table(folder)["tall"]["status"] == "ok"


@pytest.mark.parametrize(
    "meshes, options, sentence",
    [
        ("nowhere", (), "there is no folder 'nowhere'"),
        ("meshes", ("levels={distanse: 0.1}",), "levels.distanse is not a key; did you mean levels.distance?"),
    ],
)
def test_what_cannot_run_stops_at_once_with_a_sentence(folder, meshes, options, sentence):
    code, said = run(folder, meshes=meshes, options=options)
    assert code == 1 and sentence in said
    assert "Traceback" not in said
