"""Discovery, batches, digests of code, and a batch of models that go well and badly."""

import json
import os
import re
import socket
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from corpus import batches, layout, model_table, promises, shares, stages
from corpus.batches import batch_alone, form_batches, set_apart
from corpus.code_digest import digest_code, find_sources, read_outputs
from corpus.companions import digest_mesh
from corpus.discovery import CorpusError, InputFile, find_models, pick_models
from corpus.layout import MODELS_FOLDER, STAGES, STATUS_SCHEMA
from corpus.promises import find_broken_promises, vouch
from corpus.receipts import make_key, receipt_name
from corpus.stages import Rejected, run_models
from corpus.storage import read_json, write_json, write_parquet
from corpus.targets import read_wishes

SCRIPTS = Path(__file__).parent.parent / "workflow" / "scripts"


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def put(*paths):
    for path in map(Path, paths):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("mesh")


# Discovery


def test_every_mesh_is_a_model_named_by_its_path():
    put("m/b c.stl", "m/a/deep/x.y.OBJ", "m/ünï.ply", "m/.hidden.stl", "m/.git/z.off", "m/a/x.mtl", "m/strange.vtk")
    models, others, _ = find_models("m")
    assert list(models) == ["a__deep__x.y", "b c", "ünï"]
    assert models["a__deep__x.y"].path == "m/a/deep/x.y.OBJ"
    assert others == ["m/strange.vtk"]


def test_absolute_folder_gives_absolute_paths(tmp_path):
    put("m/a.stl")
    assert find_models(str(tmp_path / "m"))[0]["a"].path == str(tmp_path / "m" / "a.stl")


def test_results_inside_the_mesh_folder_are_no_meshes():
    put("a.stl", "results/models/a/page.glb")
    assert list(find_models(".")[0]) == ["a"]


def test_links_are_followed_and_loops_left():
    put("m/a.stl", "elsewhere/b.stl")
    os.symlink("../elsewhere", "m/link")
    os.symlink("..", "elsewhere/up")
    assert set(find_models("m")[0]) >= {"a", "link__b"}


def test_each_folder_is_searched_once_in_its_own_place_first():
    folders = "abcdefghi"  # each with a link to every other: as many paths as there are orders of them
    put(*(f"m/{name}/{name}.stl" for name in folders), "elsewhere/x.stl")
    for name in folders:
        for other in folders:
            os.symlink(f"../{other}", f"m/{name}/0{other}")
    os.symlink("../elsewhere", "m/y")
    os.symlink("../elsewhere", "m/z")
    models, others, _ = find_models("m")
    assert list(models) == [*(f"{name}__{name}" for name in folders), "y__x"]
    assert len(others) == 82 and "m/z (a link to a folder that is searched already)" in others


def test_names_of_meshes_that_are_no_files_are_told():
    put("m/a.stl")
    os.mkfifo("m/pipe.stl")
    with socket.socket(socket.AF_UNIX) as one:
        one.bind("m/socket.stl")
    os.symlink("nowhere.stl", "m/gone.stl")
    os.symlink("round.stl", "m/round.stl")
    models, others, _ = find_models("m")
    assert list(models) == ["a"]
    assert [told.partition(" (no file")[0] for told in others] == [
        f"m/{name}.stl" for name in ("gone", "pipe", "round", "socket")
    ]


@pytest.mark.parametrize(
    "paths, message",
    [
        ([], "there is no folder 'm' in .*, and no file; .*--config meshes=FOLDER"),
        (["m/readme.txt"], "holds no mesh; put files there that end in .stl"),
        (["m/a.stl", "m/a.obj", "m/a_obj.off"], "'m/a.obj' and 'm/a_obj.off' would both be the model 'a_obj'; rename"),
        (["m/a__b.stl", "m/a/b.stl"], "would both be the model 'a__b_stl'"),
        (["m/line\nbreak.stl"], "unprintable characters; rename"),
        (["m/" + "x" * 190 + ".stl"], "an id of 190 bytes, more than 180; shorten"),
    ],
)
def test_unusable_folders_and_names_are_refused_with_the_cure(paths, message):
    put(*paths)
    with pytest.raises(CorpusError, match=message):
        find_models("m")


def test_an_absolute_path_that_is_not_there_is_not_looked_for_in_the_working_directory():
    with pytest.raises(CorpusError, match="there is no folder '/nowhere/m', and no file"):
        find_models("/nowhere/m")


def test_meshes_of_one_name_are_called_after_their_endings():
    put("m/part.stl", "m/part.off", "m/other.STL", "m/sub/part.stl")
    models, _, renamed = find_models("m")
    assert {model: mesh.path for model, mesh in models.items()} == {
        "other": "m/other.STL",
        "part_off": "m/part.off",
        "part_stl": "m/part.stl",
        "sub__part": "m/sub/part.stl",
    }
    assert renamed == ["part_off", "part_stl"]


def test_one_file_is_a_corpus():
    put("m/part.stl", "m/part.off", "m/notes.txt", "top.ply")
    assert {model: mesh.path for model, mesh in find_models("m/part.stl")[0].items()} == {"part": "m/part.stl"}
    assert list(find_models("top.ply")[0]) == ["top"]
    assert find_models(os.path.abspath("m/part.off"))[0]["part"].path == os.path.abspath("m/part.off")
    with pytest.raises(CorpusError, match="the file 'm/notes.txt' is no mesh; its name must end in .stl"):
        find_models("m/notes.txt")


def test_models_are_picked_by_id_and_pattern():
    put(*(f"m/{name}.stl" for name in ("bracket1", "bracket2", "gear", "odd [1]", "odd 1")))
    models = find_models("m")[0]
    assert list(pick_models(models, "bracket*")) == ["bracket1", "bracket2"]
    assert list(pick_models(models, ["gear", "*2", "odd [1]"])) == ["bracket2", "gear", "odd [1]"]
    assert pick_models(models, None) == models
    with pytest.raises(CorpusError, match=r"only: 'braket\*' matches none of 5 models; did you mean 'bracket"):
        pick_models(models, ["gear", "braket*"])
    with pytest.raises(CorpusError, match=r"there are 'bracket1', 'bracket2', 'gear' \.\.\.$"):
        pick_models(models, "xyz")


def test_a_part_of_the_corpus_has_batches_of_its_own():
    models = some_models(100) | {"huge": InputFile("m/huge.stl", batches.LARGE_MESH + 1, 0)}
    whole, some = (set_apart(form_batches(models, 32, 8), only) for only in (None, "m*"))
    shared = [name for name in whole if name in some]
    assert shared == [batch_alone("huge")] and list(some.values()) == list(whole.values())
    assert set_apart({"batch-all": ["a"]}, "x").keys() == set_apart({"batch-all": ["a"]}, ["x"]).keys()


# Targets


OUTPUTS = {stage: (f"{stage}.json", f"{stage}.parquet") for stage in STAGES}


def test_files_of_models_are_asked_for_by_the_tables_of_their_stages():
    asked = ["all", "results/models/a/slice_mesh.json", "./results/models/b/", "results/status/x.parquet"]
    wishes, others = read_wishes(asked, ["a", "b"], OUTPUTS, [*layout.line_to("draw"), "find_loops"])
    assert others == ["all", "results/status/x.parquet"]
    assert [wish.status for wish in wishes] == [
        *(f"results/status/{stage}/{batch_alone('b')}.parquet" for stage in ("draw", "find_loops")),
        f"results/status/slice_mesh/{batch_alone('a')}.parquet",
    ]


@pytest.mark.parametrize(
    "target, sentence",
    [
        ("results/models/torus/certify.json", "there is no model 'torus'; did you mean 'torus_upright'?"),
        ("results/models/cube/certify.jsn", "no stage writes a file 'certify.jsn'; did you mean 'certify.json'"),
    ],
)
def test_files_that_will_never_be_are_refused(target, sentence):
    with pytest.raises(CorpusError, match=re.escape(sentence)):
        read_wishes([target], ["cube", "torus_upright"], OUTPUTS, STAGES)


def test_what_is_not_there_is_told():
    put("m/a.stl")
    os.symlink("gone.stl", "m/b.stl")
    models, others, _ = find_models("m")
    assert list(models) == ["a"] and others == ["m/b.stl (no file: a link to nothing, or a device)"]


def test_names_that_mean_something_to_snakemake_are_models_like_others():
    put("m/a <b>.stl", "m/{c}.stl")
    assert list(find_models("m")[0]) == ["a <b>", "{c}"]


def put_gltf(path, uri):
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 4}]}))


def test_a_mesh_is_another_when_a_file_that_it_names_is():
    put_gltf("m/a.gltf", "my%20part.bin")
    stamps, keys = [], []
    for content in (None, b"0000", b"1111"):
        if content:
            Path("m/my part.bin").write_bytes(content)
        stamps.append(batches.describe_meshes(find_models("m")[0], ["a"]))
        keys.append(digest_mesh("m/a.gltf"))
    assert len(set(stamps)) == len(set(keys)) == 3


def test_the_key_of_the_inspection_covers_every_reader():
    others = (
        "glb",
        "graphml",
        "ply_bytes",
        "swc",
        "vertex_values",
        "vtp",
        "wkb",
    )  # those that write, and one of values
    formats = {path for path in (SCRIPTS / "reebslice/formats").glob("*.py") if path.stem not in others}
    assert formats <= set(find_sources(SCRIPTS / "inspect_mesh.py"))


def test_a_mesh_is_another_when_its_ending_is():
    put("m/a.stl", "m/b.obj", "m/c.STL")
    assert digest_mesh("m/a.stl") == digest_mesh("m/c.STL") != digest_mesh("m/b.obj")


# Batches


def some_models(count, size=100):
    return {f"model{i:05d}": InputFile(f"m/model{i:05d}.stl", size, 0) for i in range(count)}


def work_of(models, members):
    return sum(1 + models[model].size / batches.SMALL_MESH for model in members)


@pytest.mark.parametrize(
    "count, size, fewest, most", [(1, 32, 1, 1), (9, 32, 2, 4), (100, 32, 4, 14), (100, 4, 25, 50)]
)
def test_a_small_corpus_is_spread_over_some_batches(count, size, fewest, most):
    assert fewest <= len(form_batches(some_models(count), size, 32)) <= most


def test_a_large_corpus_makes_larger_batches():
    assert 16 <= len(form_batches(some_models(10_000), 32, 32)) <= 48
    assert 128 <= len(form_batches(some_models(10_000), 32, 256)) <= 384


@settings(deadline=None, max_examples=60)
@given(
    sizes=st.lists(st.integers(0, 200 * 2**20), min_size=1, max_size=80),
    size=st.integers(1, 50),
    most=st.integers(1, 40),
)
def test_batches_deal_out_every_model_once_and_share_the_work(sizes, size, most):
    models = {f"model{i:03d}": InputFile(f"m/{i}.stl", number, 0) for i, number in enumerate(sizes)}
    dealt = form_batches(models, size, most)
    assert sorted(model for members in dealt.values() for model in members) == list(models)
    limit = batches._find_limit(models, size, most)
    for name, members in dealt.items():
        alone = len(members) == 1 and (models[members[0]].size > batches.LARGE_MESH or work_of(models, members) > limit)
        assert alone == name.startswith("alone-")
        assert alone or work_of(models, members) <= limit


def test_one_mesh_more_or_less_changes_one_batch():
    models = some_models(1000)
    before = form_batches(models, 32, 64)
    for model in list(models)[::25]:
        after = form_batches({other: models[other] for other in models if other != model}, 32, 64)
        changed = [members for members in before.values() if members not in after.values()]
        assert 1 <= len(changed) <= 2  # two that have become one
        assert model in changed[0] + changed[-1]


def test_a_large_mesh_is_alone():
    models = some_models(10) | {"huge": InputFile("m/huge.stl", batches.LARGE_MESH + 1, 0)}
    alone = [members for name, members in form_batches(models, 32, 32).items() if name.startswith("alone-")]
    assert alone == [["huge"]]


def test_predicted_resources_grow_with_the_meshes():
    models = some_models(10) | {"huge": InputFile("m/huge.stl", 50 * 2**20, 0)}
    assert batches.predict_memory(models, ["huge"]) > 2 * batches.predict_memory(models, ["model00000", "model00001"])
    few, many = (batches.predict_minutes(some_models(count), some_models(count)) for count in (1, 1000))
    assert few < 15 and many > 30


def test_the_work_of_batches_adds_up():
    models = some_models(9, size=batches.SMALL_MESH)
    assert batches.predict_work(models, models) == 18
    assert batches.predict_work(models, list(models)[:4]) + batches.predict_work(models, list(models)[4:]) == 18


def test_a_mesh_replaced_by_an_older_file_is_noticed():
    old, new = {"a": InputFile("a.stl", 10, 5)}, {"a": InputFile("a.stl", 10, 4)}
    assert batches.describe_meshes(old, ["a"]) != batches.describe_meshes(new, ["a"])


# Code


def test_sources_are_followed_through_every_form_of_import():
    put("s/pack/__init__.py", "s/pack/f.py", "s/pack/unused.py", "s/other.py")
    Path("s/stage.py").write_text("import numpy\nfrom pack import a\nimport pack.b as c\n")
    Path("s/pack/a.py").write_text("from . import d\n")
    Path("s/pack/b.py").write_text("def late():\n    from .sub.e import x\n")
    Path("s/pack/d.py").write_text("import pack.a\n")
    put("s/pack/sub/__init__.py")
    Path("s/pack/sub/e.py").write_text("from ..f import x\n")
    for name in ("pack/__init__.py", "pack/f.py", "pack/sub/__init__.py"):
        Path("s", name).write_text("")
    names = [path.relative_to("s").as_posix() for path in find_sources("s/stage.py")]
    assert names == sorted(
        ["pack/__init__.py", "pack/a.py", "pack/b.py", "pack/d.py", "pack/f.py"]
        + ["pack/sub/__init__.py", "pack/sub/e.py", "stage.py"]
    )
    before = digest_code("s/stage.py")
    Path("s/pack/unused.py").write_text("1")
    assert digest_code("s/stage.py") == before
    Path("s/pack/f.py").write_text("1")
    assert digest_code("s/stage.py") != before


@pytest.mark.parametrize("stage", [stage for stage in STAGES if (SCRIPTS / f"{stage}.py").exists()])
def test_every_stage_declares_outputs_and_depends_on_what_runs_it(stage):
    assert read_outputs(SCRIPTS / f"{stage}.py")
    names = {path.name for path in find_sources(SCRIPTS / f"{stage}.py", SCRIPTS / "corpus/stages.py")}
    assert {"stages.py", "storage.py", "schemas.py"} <= names
    assert not {"discovery.py", "code_digest.py"} & names


# One stage over a batch


class Stage:
    """A stage whose models do what their mesh file says, and which counts its calls."""

    outputs = ("note.json", "text.txt")

    def __init__(self, prefix=""):
        self.ran = []
        self.prefix = prefix
        self.outputs = tuple(prefix + name for name in Stage.outputs)

    def __call__(self, source, target, options):
        self.ran.append(source.stem)
        word = Path("m", f"{source.stem}.stl").read_text()
        write_json(target / self.outputs[0], {"word": word})
        if word == "reject":
            raise Rejected("It is open.\nClose it.")
        if word == "fail":
            raise ZeroDivisionError("a bug\nin two lines")
        if word != "forget":
            (target / self.outputs[1]).write_text(word)


def first_rows(**words):
    """Rows for the first stage, of meshes that say these words."""
    for model, word in words.items():
        put(f"m/{model}.stl")
        Path(f"m/{model}.stl").write_text(word)
    return stages._first_rows(list(words), [f"m/{model}.stl" for model in words], digest_mesh)


def run(stage, rows, name="inspect_mesh", options=None, code="c"):
    return {row["model"]: row for row in run_models(name, rows, stage, stage.outputs, options or {}, code)}


def files(model):
    return {path.name for path in (MODELS_FOLDER / model).iterdir()}


def test_models_end_each_for_itself(capfd):
    rows = run(Stage(), first_rows(good="x", bad="reject", ugly="fail", lost="forget"))
    assert {model: row["status"] for model, row in rows.items()} == {
        "good": "ok",
        "bad": "rejected",
        "ugly": "failed",
        "lost": "failed",
    }
    assert rows["bad"]["reason"] == "It is open. Close it."
    assert rows["ugly"]["reason"] == "inspect_mesh: ZeroDivisionError: a bug in two lines"
    assert "did not write text.txt" in rows["lost"]["reason"]
    receipt = receipt_name("inspect_mesh")
    assert files("good") == {receipt, "note.json", "text.txt"}
    assert files("bad") == {receipt, "note.json"}
    assert files("ugly") == files("lost") == {receipt}
    assert read_json(MODELS_FOLDER / "good" / receipt)["key"] == rows["good"]["key"]
    assert rows["good"]["seconds"] >= 0 and rows["good"]["peak_memory_mb"] > 1
    assert "Traceback" in capfd.readouterr().err


def test_only_what_changed_is_computed_again():
    rows = first_rows(a="x", b="y", c="reject", d="fail")
    before = run(Stage(), rows)
    again = Stage()
    after = run(again, first_rows(a="x", b="z", c="reject", d="fail"))
    assert again.ran == ["b", "d"]  # a failure is tried again
    assert after["a"] == before["a"] and after["c"] == before["c"]
    for changed in ({"options": {"size": 2}}, {"code": "other"}):
        again = Stage()
        run(again, first_rows(a="x"), **changed)
        assert again.ran == ["a"]


def test_a_missing_output_is_restored_and_the_later_ones_stay():
    inspect, tilt = Stage(), Stage("tilt_")
    rows = run(inspect, first_rows(a="x"))
    run(tilt, rows.values(), "select_tilt")
    (MODELS_FOLDER / "a" / "text.txt").unlink()
    restored = run(inspect, first_rows(a="x"))
    assert inspect.ran == ["a", "a"]
    assert restored["a"]["key"] == rows["a"]["key"]
    assert "text.txt" in files("a")
    run(tilt, rows.values(), "select_tilt")
    assert tilt.ran == ["a"]


@pytest.mark.parametrize("word", ["reject", "fail", "other"])
def test_what_later_stages_made_of_the_old_content_goes(word):
    rows = run(Stage(), first_rows(a="x"))
    run(Stage("tilt_"), rows.values(), "select_tilt")
    assert "tilt_text.txt" in files("a")
    rows = run(Stage(), first_rows(a=word))
    assert not any("tilt" in name for name in files("a"))
    after = run(Stage("tilt_"), rows.values(), "select_tilt")["a"]
    if word == "other":
        assert after["status"] == "ok"
    else:
        assert after["status"] == "skipped" and after["key"] == "" and after["seconds"] is None
        assert run(Stage(), [after], "slice_mesh")["a"]["reason"] == after["reason"]


def test_key_depends_on_all_of_its_parts_and_not_on_the_order_of_options():
    key = make_key("before", {"a": 1, "b": 2}, "code")
    assert key == make_key("before", {"b": 2, "a": 1}, "code")
    assert len({key, make_key("x", {"a": 1, "b": 2}, "code"), make_key("before", {"a": 1}, "code")}) == 3


# Promises


def promised(rows, stage, outputs):
    """The status table of one batch, as Snakemake would track it."""
    path = layout.STATUS_FOLDER / stage / "batch-all.parquet"
    write_parquet(path, pa.Table.from_pylist(vouch(stage, list(rows), outputs), schema=layout.STATUS_SCHEMA))
    return str(path)


@pytest.fixture
def corpus_of_two_stages():
    """One good and one rejected model, computed by two stages; with their outputs."""
    inspect, tilt = Stage(), Stage("tilt_")
    rows = run(inspect, first_rows(a="x", b="reject"))
    first = promised(rows.values(), STAGES[0], inspect.outputs)
    second = promised(run(tilt, rows.values(), "select_tilt").values(), STAGES[1], tilt.outputs)
    return first, second, {STAGES[0]: inspect.outputs, STAGES[1]: tilt.outputs}


def test_kept_promises_are_left_alone(corpus_of_two_stages):
    *_, outputs = corpus_of_two_stages
    assert find_broken_promises({"batch-all": ["a", "b"]}, outputs) == []


@pytest.mark.parametrize(
    "lost, number",
    [("a/text.txt", 0), ("a/.inspect_mesh.json", 0), ("a/tilt_note.json", 1), ("b/note.json", 0)],
)
def test_a_table_that_promises_a_file_that_is_gone_is_found(corpus_of_two_stages, lost, number):
    *tables, outputs = corpus_of_two_stages
    (MODELS_FOLDER / lost).unlink()
    assert find_broken_promises({"batch-all": ["a", "b"]}, outputs) == [tables[number]]


def test_a_table_that_is_missing_before_others_is_found(corpus_of_two_stages):
    first, second, outputs = corpus_of_two_stages
    Path(first).unlink()
    assert find_broken_promises({"batch-all": ["a", "b"]}, outputs) == [first]
    Path(second).unlink()
    assert find_broken_promises({"batch-all": ["a", "b"]}, outputs) == []  # never ran: nothing is promised


@pytest.mark.parametrize("lost", ["a/text.txt", "b/note.json", "a/.inspect_mesh.json"])
def test_processes_that_share_the_look_find_what_one_finds(corpus_of_two_stages, lost, monkeypatch):
    *tables, outputs = corpus_of_two_stages
    named = {batch: ["a", "b"] for batch in ("batch-all", "batch-x", "batch-y")}
    for table in map(Path, tables):
        for name in named:
            (table.parent / f"{name}.parquet").write_bytes(table.read_bytes())
    (MODELS_FOLDER / lost).unlink()
    found = find_broken_promises(named, outputs)
    monkeypatch.setattr(promises, "MANY", 0)
    assert find_broken_promises(named, outputs) == found and len(found) == 3


def test_work_is_shared_over_processes_in_order(monkeypatch):
    words = [f"w{number}" for number in range(7)]
    assert shares.map_shared(str.upper, words, 3) == [word.upper() for word in words]
    assert shares.map_shared(str.upper, [], 3) == []
    monkeypatch.setattr(shares, "START", "raise SystemExit(1)")  # what a process leaves undone is made up for
    assert shares.map_shared(str.upper, words, 3) == [word.upper() for word in words]
    with pytest.raises(TypeError):
        shares.map_shared(str.upper, [1, 2], 2)


def test_a_failure_is_tried_again(corpus_of_two_stages):
    first, _, outputs = corpus_of_two_stages
    run(Stage(), first_rows(a="fail", b="reject"))
    assert find_broken_promises({"batch-all": ["a", "b"]}, outputs) == [first]


# The tree of stages


def test_every_stage_goes_on_from_one_that_comes_before_it():
    assert [stage for stage, before in layout.BEFORE.items() if before is None] == [STAGES[0]]
    for stage in layout.BEFORE:
        line = layout.line_to(stage)
        assert line[0] == STAGES[0] and line[-1] == stage
        assert all(layout.BEFORE[later] == earlier for earlier, later in pairwise(line))
        assert all(stage in layout.line_to(behind) for behind in layout.line_behind(stage))


@pytest.mark.parametrize(
    "lost, found",
    [("select_tilt", [1]), ("slice_mesh", [2]), ("compare_links", [3]), ("slice_mesh compare_links", [2, 3])],
)
def test_what_is_lost_on_one_branch_withdraws_nothing_of_another(lost, found):
    """Three stages in a line, and one that goes on from the first of them."""
    stages = ("inspect_mesh", "select_tilt", "slice_mesh", "compare_links")
    made = {stage: Stage(stage) for stage in stages}
    rows = {"": first_rows(a="x")}
    tables, outputs = [], {stage: made[stage].outputs for stage in stages}
    for stage in stages:
        before = layout.BEFORE[stage] or ""
        done = run(made[stage], rows[before], stage) if before else run(made[stage], rows[before])
        rows[stage] = done.values()
        tables.append(promised(rows[stage], stage, outputs[stage]))
    for stage in lost.split():
        (MODELS_FOLDER / "a" / outputs[stage][0]).unlink()
    assert find_broken_promises({"batch-all": ["a"]}, outputs) == [tables[number] for number in found]


# The table of all models


def models_of(*batches, code=None, **stamps):
    """The table of models whose ids are the letters of the batches, each with its name; of some with a stamp."""
    row = {"status": "ok", "reason": "", "seconds": 0.5, "peak_memory_mb": 10.0, "key": "k"}
    for name, models in batches:
        rows = [row | {"model": model, "path": f"m/{model}.stl", "stamp": stamps.get(model, "s")} for model in models]
        for stage in STAGES:
            table = pa.Table.from_pylist(rows, schema=STATUS_SCHEMA)
            write_parquet(layout.STATUS_FOLDER / stage / f"{name}.parquet", table)
    tables = {stage: [layout.STATUS_FOLDER / stage / f"{name}.parquet" for name, _ in batches] for stage in STAGES}
    return model_table.make_model_table(tables, code).combine_chunks()


def test_of_the_table_of_models_only_the_batches_that_changed_are_read_again(monkeypatch):
    for model in "abc":
        write_json(MODELS_FOLDER / model / "certificate.json", {"genus": ord(model), "open": model == "c", "x": None})
    batches, asked, read = (("x", "ab"), ("y", "c")), [], model_table.read_json
    monkeypatch.setattr(model_table, "read_json", lambda path: asked.append(path.parent.name) or read(path))
    whole = models_of(*batches)
    asked.clear()
    assert models_of(*batches, code="1").equals(whole) and set(asked) == set("abc")
    asked.clear()
    again = models_of(*batches, code="1")
    write_parquet(Path("whole.parquet"), whole)
    write_parquet(Path("again.parquet"), again)
    assert not asked and Path("again.parquet").read_bytes() == Path("whole.parquet").read_bytes()
    write_json(MODELS_FOLDER / "c" / "certificate.json", {"genus": 1.5})
    assert models_of(*batches, code="1", c="another")["genus"].to_pylist() == [97.0, 98.0, 1.5]
    assert set(asked) == {"c"}
    assert models_of(*batches, code="2", c="another").equals(models_of(*batches, c="another"))


@pytest.mark.parametrize("change", [lambda data: data[:-9], lambda data: data[:40] + b"?" + data[41:]])
def test_a_part_of_the_table_of_models_that_is_damaged_is_made_anew(change):
    write_json(MODELS_FOLDER / "a" / "certificate.json", {"genus": 1})
    whole, path = models_of(("x", "a"), code="1"), model_table.PARTS / "x.parquet"
    path.write_bytes(change(path.read_bytes()))
    assert models_of(("x", "a"), code="1").equals(whole)


def test_what_lies_where_parts_of_the_table_of_models_are_to_be_kept_stops_nothing():
    write_json(MODELS_FOLDER / "a" / "certificate.json", {"genus": 1})
    whole = models_of(("x", "a"))
    model_table.PARTS.parent.mkdir(exist_ok=True)
    model_table.PARTS.write_text("in the way")
    assert models_of(("x", "a"), code="1").equals(whole)


def test_a_part_of_the_table_of_models_is_not_kept_where_figures_could_not_be_read():
    path = MODELS_FOLDER / "a" / "certificate.json"
    path.parent.mkdir(parents=True)
    path.write_text("{")
    assert models_of(("x", "a"), code="1")["status"].to_pylist() == ["failed"]
    write_json(path, {"genus": 1})
    assert models_of(("x", "a"), code="1")["genus"].to_pylist() == [1]


def test_what_a_stage_aside_refuses_leaves_the_model_its_verdict_and_is_told():
    row = {"model": "a", "path": "m/a.stl", "seconds": 0.5, "peak_memory_mb": 10.0, "key": "k", "stamp": "s"}
    refused = {"find_pockets": ("rejected", "too many"), "cut_pockets": ("skipped", "rejected earlier: too many")}
    tables = {}
    for stage in STAGES:
        status, reason = refused.get(stage, ("ok", ""))
        tables[stage] = [layout.STATUS_FOLDER / stage / "x.parquet"]
        rows = [row | {"status": status, "reason": reason}]
        write_parquet(tables[stage][0], pa.Table.from_pylist(rows, schema=STATUS_SCHEMA))
    write_json(MODELS_FOLDER / "a" / "certificate.json", {"verdict": "exact"})
    (found,) = model_table.make_model_table(tables).to_pylist()
    assert (found["status"], found["verdict"], found["reason"]) == ("ok", "exact", "too many")
    write_json(MODELS_FOLDER / "a" / "certificate.json", {"verdict": "uncertified", "reason": "Links are guessed."})
    (found,) = model_table.make_model_table(tables).to_pylist()
    assert found["reason"] == "Links are guessed. too many"


def test_the_table_of_models_does_not_depend_on_the_batches():
    facts = {
        "a": {"genus": 0, "size": 1, "open": True, "note": None},
        "b": {"genus": 2, "size": 1.5, "group": {"x": 1}, "note": None},
        "c": {"genus": 1, "mixed": 3},
        "d": {"mixed": "much", "open": False},
    }
    for model, known in facts.items():
        write_json(MODELS_FOLDER / model / "certificate.json", known)
    one, other = (models_of(*batches) for batches in ((("x", "ab"), ("y", "dc")), (("z", "bdac"),)))
    assert one.equals(other)
    assert one["model"].to_pylist() == list("abcd")
    assert one["size"].to_pylist() == [1.0, 1.5, None, None]
    assert one["group_x"].to_pylist() == [None, 1, None, None]
    assert one["mixed"].to_pylist() == [None, None, "3", "much"]
    assert one["open"].to_pylist() == [True, None, None, False]
    assert one["note"].to_pylist() == [None] * 4


def test_the_table_of_models_says_why_one_is_uncertified():
    write_json(
        MODELS_FOLDER / "a" / "certificate.json", {"verdict": "uncertified", "reason": "The surface crosses itself."}
    )
    write_json(MODELS_FOLDER / "b" / "certificate.json", {"verdict": "exact", "reason": ""})
    assert models_of(("x", "ab"))["reason"].to_pylist() == ["The surface crosses itself.", ""]


def test_long_groups_and_lists_of_figures_are_left_out():
    facts = {"short": list(range(8)), "long": list(range(9)), "many": dict.fromkeys("abcdefghi", 1), "nested": [[1]]}
    write_json(MODELS_FOLDER / "a" / "certificate.json", facts)
    names = models_of(("x", "a")).column_names
    assert [name for name in names if name.startswith(("short", "long", "many", "nested"))] == [
        f"short_{number}" for number in range(8)
    ]


# What a job asks of its process


def test_a_light_process_makes_tables_without_pandas_and_can_still_load_it():
    """In a process of its own: pyarrow asks once for pandas, and keeps to what it finds."""
    script = """
import sys
import numpy as np, pyarrow as pa
from corpus.process import trim_startup
trim_startup()
table = pa.table({"a": pa.array(np.arange(3)), "b": pa.array(["x", None, "z"])})
assert table["a"].to_numpy().tolist() == [0, 1, 2] and table.to_pylist()[1] == {"a": 1, "b": None}
assert "pandas" not in sys.modules
import pandas
"""
    subprocess.run([sys.executable, "-c", script], check=True, env=os.environ | {"PYTHONPATH": str(SCRIPTS)})
