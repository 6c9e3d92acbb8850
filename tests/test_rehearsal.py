"""Compilation ahead of the models: what is rehearsed, that it ends whatever goes wrong, and that it is done once."""

from pathlib import Path

import pytest

from corpus.jobs import ForkServer
from corpus.rehearsal import find_unrehearsed, rehearse, write_solid
from pipeline import OPTIONS
from reebslice.formats.meshes import read_mesh
from reebslice.mesh.inspection import inspect_surface

SCRIPTS = Path(__file__).parent.parent / "workflow" / "scripts"


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_the_solid_has_what_stages_meet():
    write_solid("solid.off")
    mesh = read_mesh("solid.off")
    _, record = inspect_surface(mesh.points, mesh.faces, OPTIONS["inspect"])
    assert record["status"] == "accepted"
    assert record["genus"] == 2 and record["euler_characteristic"] == 4  # of two outer shells with a hole and two voids


def test_every_task_is_done_once_and_a_file_that_is_no_mesh_stops_nothing():
    Path("bad.stl").write_text("nothing")
    write_solid("good.off")
    tasks = find_unrehearsed("compiled", ["inspect_mesh", "select_tilt"], {".stl": "bad.stl", ".off": "good.off"})
    assert list(tasks) == ["inspect_mesh", "select_tilt", ".stl", ".off"]
    tasks |= {".stl": str(Path("bad.stl").absolute()), ".off": str(Path("good.off").absolute())}
    options = {"inspect_mesh": OPTIONS["inspect"], "select_tilt": OPTIONS["tilt"]}
    rehearse(ForkServer(SCRIPTS), "compiled", tasks, options, 2)
    said = "".join(path.read_text() for path in Path("results/logs").glob("rehearsal-*.log"))
    assert [said.count(f"{name}: ") for name in tasks] == [1, 1, 1, 1]
    assert ".stl: " in said and "Rejected" in said
    assert not find_unrehearsed("compiled", ["inspect_mesh", "select_tilt"], {".stl": "", ".off": ""})
    assert list(find_unrehearsed("compiled", ["slice_mesh"], {".stl": ""})) == ["slice_mesh"]


def test_stages_before_are_rehearsed_too_but_are_still_asked_for():
    options = {"inspect_mesh": OPTIONS["inspect"], "select_tilt": OPTIONS["tilt"]}
    rehearse(ForkServer(SCRIPTS), ".", {"select_tilt": None}, options, 1)
    assert not find_unrehearsed(".", ["select_tilt"], {})
    assert find_unrehearsed(".", ["inspect_mesh"], {}) == {"inspect_mesh": None}


def test_where_a_stage_ends_its_process_the_next_run_tries_again(monkeypatch):
    Path("modules").mkdir()
    Path("modules/select_tilt.py").write_text("import os\ndef main(*_):\n    os.kill(os.getpid(), 9)\n")
    server = ForkServer(SCRIPTS, ["inspect_mesh", "preload"])
    Path("modules/preload.py").write_text(f"import sys; sys.path.insert(0, {str(Path('modules').absolute())!r})")
    monkeypatch.setenv("PYTHONPATH", str(Path("modules").absolute()))
    options = {"inspect_mesh": OPTIONS["inspect"], "select_tilt": {}}
    rehearse(server, ".", {"inspect_mesh": None, "select_tilt": None}, options, 2)
    assert find_unrehearsed(".", ["inspect_mesh", "select_tilt"], {}) == {"select_tilt": None}


def test_nothing_is_rehearsed_where_what_is_compiled_would_not_be_kept():
    Path("file").touch()
    assert find_unrehearsed("file", ["inspect_mesh"], {}) is None
    assert find_unrehearsed("file/folder", ["inspect_mesh"], {}) is None
    assert find_unrehearsed("file/folder", [], {".stl": ""}) == {}


def test_nothing_is_rehearsed_where_the_folder_is_for_reading(monkeypatch):
    Path("there").mkdir()
    monkeypatch.setattr("os.access", lambda path, mode: False)  # root may write anywhere
    assert find_unrehearsed("there", ["inspect_mesh"], {}) is None
    Path("there/rehearsed-inspect_mesh").touch()
    assert find_unrehearsed("there", ["inspect_mesh"], {}) == {}
