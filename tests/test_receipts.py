"""What is on disk is what was written: files, receipts and status tables that were altered, swapped, cut or lost."""

import json
import os
import random
import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from corpus import receipts, stages, whole_files
from corpus.jobs import Job
from corpus.layout import MODELS_FOLDER, MODELS_TABLE, MODELS_TEXT, STAGES, STATUS_FOLDER, STATUS_SCHEMA
from corpus.promises import KEPT, find_broken_promises
from corpus.receipts import read_receipt, receipt_name, seal_table, write_receipt
from corpus.stages import Rejected
from corpus.storage import (
    AlteredFileError,
    content_key,
    read_json,
    read_table,
    write_json,
    write_parquet,
    write_table,
    write_text,
)  # fmt: skip
from corpus.surfaces import read_faces
from reebslice.schemas import SCHEMAS
from reebslice.table_checks import REFERENCES, ROW_IDS, build_table, check_ids

THREE = STAGES[:3]
OUTPUTS = {
    "inspect_mesh": ("inspection.json", "vertices.parquet"),
    "select_tilt": ("tilt.json",),
    "slice_mesh": ("unfoldings.parquet", "note.txt"),
}
MODELS = ("a", "b", "c")


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(stages, "trim_startup", lambda: None)


# Three stages over three models, as jobs of Snakemake. What a stage writes tells
# what it has read, so that nothing stale goes unseen.


def vertices(*heights):
    return build_table("vertices", {axis: list(heights) for axis in "xyz"})


def inspect(source, target, options):
    heights = [float(word) for word in source.read_text().split()]
    write_json(target / "inspection.json", {"count": len(heights)})
    if not heights:
        raise Rejected("There is nothing in it.")
    write_table(target / "vertices.parquet", "vertices", vertices(*heights))


def tilt(source, target, options):
    write_json(target / "tilt.json", {"x": read_table(source / "vertices.parquet", "vertices")["x"].to_pylist()})


def cut(source, target, options):
    columns = {name: [0] for name in SCHEMAS["unfoldings"].names}
    write_table(target / "unfoldings.parquet", "unfoldings", build_table("unfoldings", columns))
    told = read_json(source / "tilt.json"), read_table(source / "vertices.parquet", "vertices")["z"].to_pylist()
    write_text(target / "note.txt", json.dumps(told))


MAINS = dict(zip(THREE, (inspect, tilt, cut), strict=True))


def put_meshes(**heights):
    for model, text in heights.items():
        Path("m").mkdir(exist_ok=True)
        Path(f"m/{model}.stl").write_text(text)


def status_table(stage):
    return STATUS_FOLDER / stage / "batch-all.parquet"


def run_job(stage, main=None):
    """One job, as Snakemake runs it; the rows of its status table."""
    before = {} if stage == THREE[0] else {"status": status_table(THREE[THREE.index(stage) - 1])}
    status_table(stage).unlink(missing_ok=True)
    parameters = {"options": {}, "code": "c", "models": list(MODELS), "paths": [f"m/{model}.stl" for model in MODELS]}
    limits = {"memory": None, "minutes": None}
    job = Job.describe(before, {"status": status_table(stage)}, parameters, "log", limits)
    stages.run_batch(job, main or MAINS[stage], OUTPUTS[stage])
    return {row["model"]: row for row in pq.read_table(status_table(stage)).to_pylist()}


def broken(**keywords):
    return find_broken_promises({"batch-all": list(MODELS)}, OUTPUTS, **keywords)


def run_all(**keywords):
    """A run of the workflow: what is broken is withdrawn; jobs run whose table is gone, and those behind them."""
    for table in broken(**keywords):
        Path(table).unlink(missing_ok=True)
    due, rows = False, {}
    for stage in THREE:
        due = due or not status_table(stage).exists()
        if due:
            rows = run_job(stage)
    if due or not MODELS_TABLE.exists():
        write_parquet(MODELS_TABLE, pa.table({"model": MODELS}))
        MODELS_TEXT.write_text("model\n")
        seal_table(MODELS_TABLE, MODELS_TEXT)
    return rows


def contents():
    """What the stages left, but for receipts, which tell seconds: bytes by path."""
    found = (path for path in MODELS_FOLDER.rglob("*") if path.is_file() and not path.name.startswith("."))
    return {path: path.read_bytes() for path in found}


@pytest.fixture
def finished():
    """Two models that are done and one that is rejected."""
    put_meshes(a="1 2 3", b="5 6 7", c="")
    run_all()
    assert broken() == [] and len(contents()) == 11
    return contents()


def file(model, name):
    return MODELS_FOLDER / model / name


def keeping_times(path, change):
    stat = path.stat()
    change(path)
    os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


# What is altered is noticed at the next run, and made anew


def append(path):
    path.write_bytes(path.read_bytes() + b" ")


def truncate(path):
    os.truncate(path, path.stat().st_size // 2)


def zero(path):
    path.write_bytes(bytes(path.stat().st_size))


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def become_a_folder(path):
    path.unlink()
    (path / "inside").mkdir(parents=True)


def take_anothers(path):
    shutil.copy2(MODELS_FOLDER / "b" / path.name, path)


def empty_object(path):
    path.write_text("{}")


def empty_list(path):
    path.write_text("[]")


def nest(path):
    path.write_text("[" * 100_000)


@pytest.mark.parametrize("change", [append, truncate, zero, flip, become_a_folder, take_anothers])
@pytest.mark.parametrize("name", [name for names in OUTPUTS.values() for name in names])
def test_an_altered_file_is_noticed_and_made_anew(finished, name, change):
    if change is take_anothers and file("a", name).read_bytes() == file("b", name).read_bytes():
        pytest.skip("the two are the same")
    change(file("a", name))
    stage = next(stage for stage in THREE if name in OUTPUTS[stage])
    assert broken() == [str(status_table(stage))]
    run_all()
    assert contents() == finished and broken() == []


@pytest.mark.parametrize(
    "change", [append, truncate, zero, become_a_folder, take_anothers, empty_object, empty_list, nest]
)
@pytest.mark.parametrize("stage", THREE)
def test_an_altered_receipt_is_noticed_and_made_anew(finished, stage, change):
    change(file("a", receipt_name(stage)))
    assert broken() == [str(status_table(stage))]
    run_all()
    assert contents() == finished and broken() == []
    assert read_receipt(MODELS_FOLDER / "a", stage)["status"] == "ok"


@pytest.mark.parametrize("change", [append, truncate, zero])
@pytest.mark.parametrize("number", range(3))
def test_an_altered_status_table_is_noticed_and_made_anew(finished, number, change):
    change(status_table(THREE[number]))
    assert broken() == [str(status_table(THREE[number]))]
    run_all()
    assert contents() == finished and broken() == []


@pytest.mark.parametrize("changed", [{"key": "0"}, {"status": "rejected"}, {"model": "d"}, {"stamp": ""}])
def test_a_status_table_with_other_rows_is_noticed(finished, changed):
    rows = pq.read_table(status_table("slice_mesh")).to_pylist()
    rows[0] |= changed
    write_parquet(status_table("slice_mesh"), pa.Table.from_pylist(rows, schema=STATUS_SCHEMA))
    assert broken() == [str(status_table("slice_mesh"))]


@pytest.mark.parametrize("change", [append, truncate, zero, flip])
def test_an_altered_table_of_models_is_noticed(finished, change):
    keeping_times(MODELS_TABLE, change)
    assert broken() == [str(MODELS_TABLE)]


def test_the_text_of_the_table_of_models_is_held_as_well(finished):
    assert broken() == []
    MODELS_TEXT.write_text("model\na\n")
    assert broken() == [str(MODELS_TABLE)]


def test_a_file_that_returns_to_a_rejected_model_is_taken_away(finished):
    shutil.copy2(file("a", "tilt.json"), file("c", "tilt.json"))
    assert broken() == [str(status_table("select_tilt"))]
    run_all()
    assert contents() == finished


def test_results_copied_without_their_times_are_digested_and_taken_over(finished):
    receipts_before = {stage: file("a", receipt_name(stage)).read_bytes() for stage in THREE}
    for path in MODELS_FOLDER.rglob("*.*"):
        os.utime(path, ns=(1, 1))
    assert broken() == [str(status_table("inspect_mesh"))]
    run_all()
    assert contents() == finished and broken() == []
    assert receipts_before == {stage: file("a", receipt_name(stage)).read_bytes() for stage in THREE}


def test_the_same_size_and_time_is_noticed_by_a_run_that_digests(finished):
    keeping_times(file("a", "vertices.parquet"), flip)
    assert broken() == []  # as the docs say
    assert broken(verify=True) == [str(status_table("inspect_mesh"))]
    run_all(verify=True)
    assert contents() == finished
    keeping_times(Path("m/a.stl"), lambda path: path.write_text("1 2 4"))
    assert broken() == []
    run_all(verify=True)
    assert read_json(file("a", "tilt.json")) == {"x": [1, 2, 4]}
    put_meshes(a="1 2 3")
    run_all(verify=True)
    assert contents() == finished


def test_a_job_takes_over_by_size_and_time_what_the_last_table_stands_for_and_digests_the_rest(finished):
    keeping_times(file("a", "vertices.parquet"), flip)
    forged = contents()
    status_table("inspect_mesh").unlink()
    run_all()
    assert contents() == forged and broken() == []
    kept = KEPT / "inspect_mesh" / "batch-all.parquet"
    for change in (flip, truncate, Path.unlink):
        change(kept)
        status_table("inspect_mesh").unlink()
        run_all()
        assert contents() == finished and broken() == []
        keeping_times(file("a", "vertices.parquet"), flip)


def test_what_lies_where_tables_are_to_be_kept_stops_nothing(finished):
    shutil.rmtree(KEPT)
    KEPT.write_text("in the way")
    status_table("inspect_mesh").unlink()
    run_all()
    assert contents() == finished and broken() == [] and KEPT.read_text() == "in the way"


def test_a_job_computes_what_another_configuration_or_mesh_asks_for_and_keeps_the_other_rows(finished):
    before = {row["model"]: row for row in pq.read_table(status_table("slice_mesh")).to_pylist()}
    put_meshes(a="1 2 4")
    status_table("inspect_mesh").unlink()
    after = run_all()
    assert read_json(file("a", "tilt.json")) == {"x": [1, 2, 4]}
    assert {model for model in MODELS if after[model] != before[model]} == {"a"} and broken() == []


def test_what_was_made_of_an_altered_file_goes_with_it(finished):
    """The tilt is that of a file which was altered unseen; the receipt of the tilt is in order."""
    forged = file("a", "vertices.parquet")
    key = read_receipt(MODELS_FOLDER / "a", "inspect_mesh")["key"]
    size = forged.stat().st_size
    with content_key(key, model="a"):
        keeping_times(forged, lambda path: write_table(path, "vertices", vertices(7.0, 8.0, 9.0)))
    assert forged.stat().st_size == size
    receipts.forget_stage(["a"], "select_tilt")
    run_all()
    assert read_json(file("a", "tilt.json")) == {"x": [7, 8, 9]}
    run_all(verify=True)
    assert contents() == finished


# What a receipt says is held against the files and the chain


@pytest.mark.parametrize(
    "lie", [{"status": "rejected"}, {"key": "0"}, {"before": "0"}, {"reason": "x"}, {"outputs": {}}, {"more": 1}]
)
def test_a_receipt_that_was_edited_is_none(finished, lie):
    path = file("a", receipt_name("select_tilt"))
    path.write_text(json.dumps(read_json(path) | lie))
    assert read_receipt(MODELS_FOLDER / "a", "select_tilt") is None


def test_a_receipt_of_another_model_is_none(finished):
    shutil.copytree(MODELS_FOLDER / "a", MODELS_FOLDER / "d")
    assert all(read_receipt(MODELS_FOLDER / "d", stage) is None for stage in THREE)


@pytest.mark.parametrize("name", ["../../../kept", "/kept", "..", ".", "", "x/../../../../kept", "a\0b", 7, None])
def test_a_receipt_may_name_nothing_outside_the_folder(finished, tmp_path, name):
    Path("kept").write_text("mine")
    place = str(tmp_path / "kept") if name == "/kept" else name
    lie = read_receipt(MODELS_FOLDER / "a", "slice_mesh")
    for outputs in ([place], {place: [4, 0, "0"]}):
        try:
            write_receipt(MODELS_FOLDER / "a", "slice_mesh", lie | {"outputs": outputs})  # even if it is sealed
        except TypeError:
            continue
        put_meshes(a="3 2 1" if isinstance(outputs, list) else "1 2 3")
        status_table("inspect_mesh").unlink()
        run_all()
        assert Path("kept").read_text() == "mine" and MODELS_FOLDER.is_dir()
    assert contents() == finished


def test_a_receipt_that_never_ends_is_not_waited_for(finished):
    path = file("a", receipt_name("select_tilt"))
    path.unlink()
    os.mkfifo(path)
    run_all()
    assert contents() == finished and broken() == []


# What a stage reads is what was written


def altering(stage, change):
    """The stage, which alters a file of model a before, or after, it reads."""

    def main(source, target, options):
        if source.name.startswith("a"):
            change(source)
        MAINS[stage](source, target, options)

    return main


def test_a_file_altered_between_two_jobs_fails_that_model_and_is_made_anew(finished):
    put_meshes(a="3 4 5")
    run_job("inspect_mesh")
    flip(file("a", "vertices.parquet"))
    rows = run_job("select_tilt")
    assert [rows[model]["status"] for model in MODELS] == ["failed", "ok", "skipped"]
    assert rows["a"]["reason"].startswith("results/models/a/vertices.parquet: is not the file that inspect_mesh wrote")
    run_job("slice_mesh")
    assert broken() == [str(status_table("inspect_mesh"))]
    run_all()
    assert read_json(file("a", "tilt.json")) == {"x": [3, 4, 5]}


@pytest.mark.parametrize("change", [append, truncate, flip])
def test_a_file_altered_while_it_is_read_fails_that_model(finished, change):
    main = altering("slice_mesh", lambda source: change(source / "vertices.parquet"))
    receipts.forget_stage(MODELS, "slice_mesh")
    rows = run_job("slice_mesh", main)
    assert [rows[model]["status"] for model in MODELS] == ["failed", "ok", "skipped"]
    run_all()
    assert contents() == finished


def test_a_table_of_another_model_with_size_and_time_of_this_one_is_refused(finished):
    mine, other = (file(model, "vertices.parquet") for model in "ab")
    assert mine.stat().st_size == other.stat().st_size
    keeping_times(mine, lambda path: path.write_bytes(other.read_bytes()))
    receipts.forget_stage(["a"], "select_tilt")
    rows = run_job("select_tilt")
    assert rows["a"]["status"] == "failed" and "carries the content key" in rows["a"]["reason"]
    assert "results/models/a/vertices.parquet" in rows["a"]["reason"]
    run_job("slice_mesh")
    run_all()
    assert contents() == finished


def test_the_certifier_digests_what_it_reads(finished):
    flip_seen = file("a", "note.txt")
    keeping_times(flip_seen, flip)
    row = {"model": "a", "key": read_receipt(MODELS_FOLDER / "a", "slice_mesh")["key"]}
    with receipts.unchanged_inputs("classify_handles", row):
        pass
    wrong = pytest.raises(AlteredFileError, match=r"note.txt: is not the file that slice_mesh wrote")
    with wrong, receipts.unchanged_inputs("certify", row):
        pass


def test_receipts_of_two_runs_are_no_chain(finished):
    folder = MODELS_FOLDER / "a"
    receipt = read_receipt(folder, "select_tilt")
    write_receipt(folder, "select_tilt", receipt | {"before": "0"})
    with pytest.raises(AlteredFileError, match=r"\.select_tilt\.json: vouches for what was made of other files"):
        receipts.trace_inputs(folder, "select_tilt", receipt["key"])
    file("a", receipt_name("select_tilt")).unlink()
    with pytest.raises(AlteredFileError, match=r"\.select_tilt\.json: is missing, or was altered"):
        receipts.trace_inputs(folder, "select_tilt", receipt["key"])
    with pytest.raises(AlteredFileError, match=r"slice_mesh\.json: is not the receipt of the status table"):
        receipts.trace_inputs(MODELS_FOLDER / "b", "slice_mesh", "0")


@pytest.mark.parametrize("text", ["9 9 9", ""])
@pytest.mark.parametrize("replace", [Path.write_text, lambda path, text: path.unlink()])
def test_a_mesh_that_is_replaced_while_it_is_read_fails_and_is_read_again(replace, text):
    """Whatever came of it, a rejection too, was made of neither of the two."""
    put_meshes(a="1 2 3", b="1", c="")
    rows = run_job("inspect_mesh", altering("inspect_mesh", lambda source: replace(source, text)))
    assert [rows[model]["status"] for model in MODELS] == ["failed", "ok", "rejected"]
    assert rows["a"]["reason"] == "m/a.stl: was replaced while it was read; the next run reads it again"
    put_meshes(a="7 8 9")
    run_job("select_tilt")
    assert broken() == [str(status_table("inspect_mesh"))]
    run_all()
    assert read_json(file("a", "tilt.json")) == {"x": [7, 8, 9]}


# Ids are those of rows that are there


def table_with(name, column=None, value=0):
    """A table of one row of zeros, but for one value."""
    columns = {}
    for field in SCHEMAS[name]:
        zero = False if pa.types.is_boolean(field.type) else "" if pa.types.is_string(field.type) else 0
        zero = b"" if pa.types.is_binary(field.type) else zero
        zero = value if field.name == column else zero
        columns[field.name] = [[zero] if pa.types.is_list(field.type) else zero]
    return build_table(name, columns)


@pytest.mark.parametrize(
    "name, column, target", [(name, *pair) for name, pairs in REFERENCES.items() for pair in pairs]
)
def test_ids_that_are_out_of_range_are_refused(tmp_path, name, column, target):
    write_table(tmp_path / f"{target}.parquet", target, table_with(target))
    lowest = -1 if column == "slab" else 0
    # `region` of `regions` is a row's own number too
    fault = "does not count its rows" if (name, column) == ("regions", "region") else f"names a row that table {target}"
    for value in (lowest, 0):
        write_table(tmp_path / f"{name}.parquet", name, table_with(name, column, value))
        read_table(tmp_path / f"{name}.parquet", name)
    for value in (lowest - 1, 1, 2**31 - 1, -(2**31)):
        write_table(tmp_path / f"{name}.parquet", name, table_with(name, column, value))
        with pytest.raises(AlteredFileError, match=f"Column {column} of table {name} {fault}"):
            read_table(tmp_path / f"{name}.parquet", name)


def test_nulls_and_empty_lists_name_nothing():
    check_ids("contours", table_with("contours", "parent", None), {"contours": 1})
    check_ids("pieces", table_with("pieces").slice(0, 0), {"pieces": 0, "contours": 0})
    pieces = table_with("pieces").to_pylist()
    check_ids("pieces", pa.Table.from_pylist([pieces[0] | {"below": []}], schema=SCHEMAS["pieces"]), {"contours": 1})
    with pytest.raises(ValueError, match="Column below of table pieces"):
        check_ids("pieces", pa.Table.from_pylist(pieces, schema=SCHEMAS["pieces"]), {"contours": 0})


@pytest.mark.parametrize("name", ROW_IDS)
def test_ids_that_do_not_count_rows_are_refused(name):
    with pytest.raises(ValueError, match=f"Column {ROW_IDS[name]} of table {name} does not count its rows"):
        check_ids(name, table_with(name, ROW_IDS[name], 1), {})


def test_a_face_that_names_no_vertex_never_reaches_compiled_code(tmp_path):
    write_table(tmp_path / "vertices.parquet", "vertices", vertices(0.0, 1.0, 2.0))
    faces = build_table("faces", {"a": [0], "b": [1], "c": [2**30], "shell": [0]})
    write_table(tmp_path / "faces.parquet", "faces", faces)
    with pytest.raises(AlteredFileError, match=r"faces.parquet: Column c of table faces.*run the workflow again"):
        read_faces(tmp_path)


@pytest.mark.parametrize("change", [truncate, zero, become_a_folder, empty_object])
def test_what_is_no_table_is_refused_with_its_name(tmp_path, change):
    path = tmp_path / "vertices.parquet"
    write_table(path, "vertices", vertices(*np.arange(1000.0)))
    change(path)
    with pytest.raises(AlteredFileError, match=r"vertices.parquet: .*run the workflow again"):
        read_table(path, "vertices")


def test_only_keys_that_are_expected_are_compared(tmp_path):
    path = tmp_path / "vertices.parquet"
    write_table(path, "vertices", vertices(1.0), key="k")
    for inputs in (None, {}, {"faces.parquet": "x"}, {"vertices.parquet": "k"}):
        with content_key("new", inputs):
            assert read_table(path, "vertices").num_rows == 1
    with content_key("new", {"vertices.parquet": "x"}), pytest.raises(AlteredFileError, match="of other results"):
        read_table(path, "vertices")


# A power cut


class PowerCut(BaseException):
    pass


class Disk:
    """A disk of which only that outlasts a power cut which was waited for. It is cut at the given wait."""

    def __init__(self, monkeypatch, waits):
        self.waits, self.safe = waits, {}
        self.keep_all()
        monkeypatch.setattr(whole_files.os, "fsync", self.wait_for_one)
        monkeypatch.setattr(whole_files, "_sync_file_system", self.wait_for_all)

    def count(self):
        self.waits -= 1
        if self.waits < 0:
            raise PowerCut

    def wait_for_one(self, place):
        self.count()
        path = Path(os.readlink(f"/proc/self/fd/{place}"))
        if path.is_file():
            self.safe[path.stat().st_ino] = path.read_bytes()

    def wait_for_all(self, place):
        self.count()
        self.keep_all()

    def keep_all(self):
        for path in Path("results").rglob("*"):
            if path.is_file():
                self.safe[path.stat().st_ino] = path.read_bytes()

    def lose(self, choice):
        """Zeros, in size and time as before, in place of some or all of what was not waited for."""
        for path in sorted(Path("results").rglob("*")):
            if path.is_file() and self.safe.get(path.stat().st_ino) != path.read_bytes() and choice.random() < 0.7:
                keeping_times(path, zero)


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="needs /proc to tell which file is waited for")
@pytest.mark.parametrize("first", ["1 2 3", "3 4 5"])
def test_a_power_cut_at_any_time_leaves_no_promise_without_its_files(first, tmp_path, monkeypatch):
    """The first run is whole, and may be on other meshes; the second is cut; the third is as good as a single one."""
    choice, cut_at, finished = random.Random(first), 0, None
    for cut_at in range(100):
        folder = tmp_path / str(cut_at)
        folder.mkdir()
        monkeypatch.chdir(folder)
        put_meshes(a=first, b="5 6 7", c="")
        run_all()
        put_meshes(a="1 2 3", b="5 6 7")
        status_table("inspect_mesh").unlink()
        with monkeypatch.context() as patch:
            disk, whole = Disk(patch, cut_at), False
            try:
                run_all()
                whole = True
            except PowerCut:
                disk.lose(choice)
        run_all()
        assert broken() == []
        for model in "ab":
            assert read_receipt(MODELS_FOLDER / model, "slice_mesh")
        finished = finished or contents()
        assert contents() == finished
        if whole:
            break
    assert cut_at > 8
