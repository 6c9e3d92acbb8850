"""A few rounds of faults (see faults.py), and what runs say when they cannot go on."""

import os
import shutil

import pytest

from corpus.receipts import receipt_name
from disturbances import fill_disk, kill_group, kill_worker
from faults import play
from small_corpus import CHOSEN, compare, fingerprint, make_corpus, run


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A small corpus, and the fingerprint of its results."""
    folder = tmp_path_factory.mktemp("base")
    make_corpus(folder)
    return folder, fingerprint(folder)


@pytest.fixture
def folder(base, tmp_path):
    return shutil.copytree(base[0], tmp_path / "corpus")


@pytest.mark.parametrize("fault", [kill_worker, kill_group, fill_disk])
def test_results_are_those_of_an_undisturbed_run(base, fault):
    told, differences = play(*base, fault, seed=1, first=len(CHOSEN) - 1)
    assert not differences, told
    assert fault is kill_group or "--" not in told, "of a killed job, or a full disk, nothing is left that takes a hint"


def test_a_fingerprint_tells_what_differs(base, folder):
    path = folder / "results/models/tall/picture.png"
    path.write_bytes(path.read_bytes() + b"x")
    (folder / "results/models/tall/nodes.parquet").unlink()
    (folder / "results/models/tall/.draw.scratch").mkdir()
    names = [
        "results/models/tall/.draw.scratch",
        "results/models/tall/nodes.parquet",
        "results/models/tall/picture.png",
    ]
    assert compare(base[1], fingerprint(folder)) == names


def test_planning_shows_no_traceback_whatever_it_finds(folder):
    models, status = folder / "results/models", folder / "results/status"
    (folder / "meshes/loop.off").symlink_to("loop.off")
    for number, text in enumerate(["", "{}", "[]", '{"key": ', "\0" * 100]):
        (models / "tall" / receipt_name(CHOSEN[number])).write_text(text)
    receipt = models / "round" / receipt_name("draw")
    receipt.unlink()
    receipt.mkdir()
    shutil.rmtree(models / "torn")
    (models / "torn").touch()
    for path in sorted(status.glob("*/*.parquet"))[: len(CHOSEN)]:
        os.truncate(path, 30)
    table = sorted(status.glob("draw/*.parquet"))[0]
    table.unlink()
    table.mkdir()
    (folder / "results/corpus/models.parquet").write_bytes(b"")
    code, said = run(folder, "-n")
    assert code == 0 and "Traceback" not in said and "loop.off (no file: Too many levels of symbolic links)" in said
    shutil.rmtree(folder / "results/logs/draw")
    (folder / "results/logs/draw").touch()
    code, said = run(folder)
    assert code and "Traceback" not in said and "results/logs/draw has to be a folder, but is none: move it" in said
