"""What ends a model, or the process that works on it, and stops no other."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import inspect_mesh
import test_corpus as corpus
from corpus import process, stages
from corpus.batches import describe_meshes
from corpus.companions import digest_mesh
from corpus.discovery import find_models
from corpus.layout import MODELS_FOLDER, STAGES
from corpus.outcome import tell_outcome
from corpus.receipts import receipt_name, write_receipt
from corpus.stages import run_models
from corpus.storage import read_json, write_json, write_parquet
from corpus.workers import Limits, Lost, map_apart
from test_corpus import SCRIPTS, first_rows, models_of, put, run

OUTPUTS = ("text.txt",)


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def act(source, target, options):
    """A stage that does what the mesh file says, and otherwise writes down its process."""
    word = source.read_text()
    if word.startswith("SIG"):
        os.kill(os.getpid(), signal.Signals[word])
    elif word == "exit":
        os._exit(3)
    elif word == "sleep":
        time.sleep(60)
    elif word == "fill":
        np.ones(2**28)  # 2 GB
    elif word == "memory":
        raise MemoryError("Unable to allocate 7.45 GiB")
    elif word == "import":
        raise ImportError("no module for this format")
    elif word == "full":
        raise OSError(errno.ENOSPC, "No space left on device")
    (target / "text.txt").write_text(str(os.getpid()))


def run_apart(rows, main=act, **limits):
    found = run_models(STAGES[0], rows, main, OUTPUTS, {}, "c", digest_mesh, Limits(**limits))
    return {row["model"]: row for row in found}


def process_of(model):
    return (MODELS_FOLDER / model / "text.txt").read_text()


@pytest.mark.parametrize(
    "word, limits, sentence",
    [
        ("SIGKILL", {}, "ended by the signal SIGKILL, most likely because the machine ran out of memory"),
        ("SIGSEGV", {}, "ended by the signal SIGSEGV, which is a fault of the program or of a package"),
        ("SIGABRT", {"memory": 1500}, "ended by the signal SIGABRT, most likely because limits.memory is 1500"),
        ("exit", {}, "ended with exit code 3"),
        ("sleep", {"minutes": 0.01}, "longer than limits.minutes allows, which is 0.01; raise that, or make it null"),
        ("fill", {"memory": 1500}, "memory ran out (Unable to allocate 2.00 GiB"),
        ("memory", {}, "memory ran out (Unable to allocate 7.45 GiB)"),
        ("import", {}, "ImportError: no module for this format"),
        ("full", {}, "the disk is full"),
    ],
)
def test_what_ends_a_model_is_told_and_its_neighbours_finish(word, limits, sentence):
    for _ in range(2):  # in the next run, too
        rows = run_apart(first_rows(a="x", b=word, c="y"), **limits)
        assert [rows[model]["status"] for model in "abc"] == ["ok", "failed", "ok"]
        assert rows["b"]["reason"].startswith("inspect_mesh: ") and sentence in rows["b"]["reason"]
        assert corpus.files("b") == {receipt_name("inspect_mesh")}
        assert read_json(MODELS_FOLDER / "b" / receipt_name("inspect_mesh"))["reason"] == rows["b"]["reason"]
    rows = run_apart(first_rows(a="x", b="z", c="y"))
    assert rows["b"]["status"] == "ok"


def test_models_share_a_process_until_one_fails():
    run_apart(first_rows(a="1", b="2", c="memory", d="3", e="4"))
    assert process_of("a") == process_of("b") != process_of("d") == process_of("e")
    assert str(os.getpid()) not in (process_of("a"), process_of("d"))


def test_what_a_lost_model_had_before_goes():
    run_apart(first_rows(a="x"))
    run(
        corpus.Stage("tilt_"),
        [{"model": "a", "path": "m/a.stl", "status": "ok", "reason": "", "key": "k"}],
        "select_tilt",
    )
    run_apart(first_rows(a="SIGKILL"))
    assert corpus.files("a") == {receipt_name("inspect_mesh")}


def test_the_worker_ends_with_its_job():
    """A job is killed; nothing goes on behind it."""
    script = """
import os, sys, time
from corpus.workers import Limits, map_apart
def work(item):
    print(os.getpid(), flush=True)
    time.sleep(60)
list(map_apart(work, [1], Limits()))
"""
    environment = os.environ | {"PYTHONPATH": str(SCRIPTS)}
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=environment) as job:
        worker = int(job.stdout.readline())
        job.kill()
    deadline = time.time() + 20
    while time.time() < deadline and Path(f"/proc/{worker}").exists() and _state(worker) != "Z":
        time.sleep(0.05)
    assert not Path(f"/proc/{worker}").exists() or _state(worker) == "Z"


def _state(number):
    try:
        return Path(f"/proc/{number}/stat").read_text().rsplit(")")[-1].split()[0]
    except OSError:
        return "Z"


def test_a_result_half_told_is_lost():
    def work(item):
        os.kill(os.getpid(), signal.SIGKILL) if item == 2 else None
        return item, True

    told = list(map_apart(work, [1, 2, 3], Limits()))
    assert told[0] == 1 and isinstance(told[1], Lost) and told[2] == 3


# Files that cannot be read or written


def unreadable(path):
    raise PermissionError(errno.EACCES, "Permission denied", str(path))


def test_a_mesh_that_cannot_be_read_stops_no_other():
    put("m/a.stl", "m/c.stl")
    Path("m/b.stl").mkdir()
    rows = stages._first_rows(list("abcd"), [f"m/{model}.stl" for model in "abcd"], digest_mesh)  # d is gone
    done = run_apart(rows)
    assert [done[model]["status"] for model in "abcd"] == ["ok", "failed", "ok", "failed"]
    assert "the mesh file cannot be read (IsADirectoryError" in done["b"]["reason"]
    assert "m/d.stl" in done["d"]["reason"]
    assert all(done[model]["reason"].startswith("inspect_mesh: ") for model in "bd")


@pytest.mark.parametrize("make", [Path.touch, lambda path: path.symlink_to(path.name)])
def test_a_folder_that_is_none_stops_no_other(make):
    MODELS_FOLDER.mkdir(parents=True)
    make(MODELS_FOLDER / "b")
    rows = run_apart(first_rows(a="x", b="y", c="z"))
    assert [rows[model]["status"] for model in "abc"] == ["ok", "failed", "ok"]
    assert "results/models/b" in rows["b"]["reason"]
    after = run(corpus.Stage("tilt_"), rows.values(), "select_tilt")
    assert [after[model]["status"] for model in "abc"] == ["ok", "skipped", "ok"]


def test_a_receipt_that_cannot_be_written_fails_its_model(monkeypatch):
    def refuse(folder, stage, receipt):
        if folder.name == "b":
            raise OSError(errno.EROFS, "Read-only file system", str(folder))
        write_receipt(folder, stage, receipt)

    monkeypatch.setattr(stages, "write_receipt", refuse)
    rows = run_apart(first_rows(a="x", b="y", c="z"))
    assert [rows[model]["status"] for model in "abc"] == ["ok", "failed", "ok"]
    assert "Read-only file system" in rows["b"]["reason"]


@pytest.mark.parametrize("fault", [MemoryError("3 GB"), ImportError("cascadio"), PermissionError(13, "denied")])
def test_a_fault_of_the_run_is_no_bad_mesh(monkeypatch, fault):
    """Wherever it comes up while a mesh is read and inspected."""

    def fail(*arguments):
        raise fault

    first_rows(a="x")
    for name in ("read_mesh", "inspect_surface"):
        with monkeypatch.context() as patch:
            if name == "inspect_surface":
                patch.setattr(inspect_mesh, "read_mesh", lambda source: type("Mesh", (), {"points": 0, "faces": 0}))
            patch.setattr(inspect_mesh, name, fail)
            row = run_apart(first_rows(a="x"), inspect_mesh.main)["a"]
        assert row["status"] == "failed" and "export" not in row["reason"]


# The table of models


@pytest.mark.parametrize("text", ["", "[1]", '{"genus": ', "3", '"x"', "null", "[" * 100_000])
def test_a_broken_certificate_is_one_row_with_a_sentence(text):
    for model in "abc":
        write_json(MODELS_FOLDER / model / "certificate.json", {"genus": 1, "verdict": "exact", "reason": ""})
        write_json(MODELS_FOLDER / model / receipt_name("certify"), {})
    (MODELS_FOLDER / "b" / "certificate.json").write_text(text)
    table = models_of(("x", "abc"))
    rows = {row["model"]: row for row in table.to_pylist()}
    assert [rows[model]["status"] for model in "abc"] == ["ok", "failed", "ok"]
    assert "results/models/b/certificate.json cannot be read" in rows["b"]["reason"]
    assert "the next run makes it again" in rows["b"]["reason"]
    assert rows["b"]["verdict"] is None and rows["c"]["genus"] == 1
    assert not (MODELS_FOLDER / "b" / receipt_name("certify")).exists()
    write_parquet("models.parquet", table)
    lines, failed = tell_outcome(Path("models.parquet"))
    assert failed == 1 and lines[0] == "3 models: 2 exact, 1 FAILED"
    assert lines[2].startswith("  b: FAILED: results/models/b/certificate.json cannot be read")


# Planning


def test_planning_takes_what_it_finds(monkeypatch):
    put("m/a.stl")
    os.symlink("b.stl", "m/b.stl")
    os.symlink("loop", "m/loop")
    os.mkfifo("m/c.stl")
    put("m/d.gltf")
    monkeypatch.setattr("corpus.discovery.stamp_companions", lambda path: unreadable(path) if "gltf" in path else ())
    models, others, _ = find_models("m")
    assert list(models) == ["a", "d"]
    assert [name.split(" ")[0] for name in others] == ["m/b.stl", "m/c.stl", "m/loop"]
    assert "Too many levels of symbolic links" in others[0]
    assert describe_meshes(models, list(models))


def test_a_folder_that_cannot_be_read_is_told(monkeypatch):
    put("m/a.stl", "m/sub/b.stl")
    scan = os.scandir
    monkeypatch.setattr(os, "scandir", lambda path: unreadable(path) if "sub" in str(path) else scan(path))
    models, others, _ = find_models("m")
    assert list(models) == ["a"] and others == ["m/sub/ (a folder that cannot be read: Permission denied)"]


# The end of a job


def end_job(command, log="logs/a.log"):
    script = f"from corpus.process import print_into\nprint_into({log!r})\nprint('at work')\n{command}"
    environment = os.environ | {"PYTHONPATH": str(SCRIPTS)}
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, env=environment, check=False)


def test_a_job_says_why_it_ended_in_its_log_and_on_the_terminal():
    begun = time.time() - 1
    done = end_job("import errno\nraise OSError(errno.ENOSPC, 'No space left on device', 'results/x')")
    assert done.returncode == 1
    assert done.stderr.startswith(
        "logs/a.log: This job ended: the disk is full, or a quota used up (OSError: [Errno 28]"
    )
    log = Path("logs/a.log").read_text()
    assert log.startswith("at work") and "Traceback" in log
    words = process.find_last_words("logs", begun)
    assert words == {"logs/a.log": done.stderr.split("This job ended: ")[1].strip()}
    assert process.find_last_words("logs", time.time() + 60) == {}
    end_job("")
    assert process.find_last_words("logs", begun) == {}


def test_a_log_that_cannot_be_written_leaves_the_terminal():
    Path("logs").touch()
    done = end_job("")
    assert done.returncode == 1 and "logs/a.log: This job ended: " in done.stderr


def test_a_full_disk_is_told(monkeypatch):
    class Disk:
        f_bavail, f_frsize, f_files, f_favail = 512, 4096, 1000, 10

    monkeypatch.setattr(os, "statvfs", lambda folder: Disk)
    here = os.path.realpath(".")
    assert process.find_full_disks([".", here]) == [
        f"the disk that holds {here} has 2.0 MB left: free space before you start again"
    ]
    Disk.f_bavail = 10**9
    assert process.find_full_disks(["."]) == []
    Disk.f_favail = 0
    assert "no names for files left" in process.find_full_disks(["."])[0]
