"""A few rounds of faults (see faults.py), and what runs say when they cannot go on."""

import os
import shutil

import faults
import pytest

from corpus.layout import STAGES
from corpus.receipts import receipt_name


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    """A small corpus, and the fingerprint of its results."""
    folder = tmp_path_factory.mktemp("base")
    faults.make_corpus(folder)
    return folder, faults.fingerprint(folder)


@pytest.fixture
def folder(base, tmp_path):
    return shutil.copytree(base[0], tmp_path / "corpus")


@pytest.mark.parametrize("fault", [faults.kill_worker, faults.kill_group, faults.fill_disk])
def test_results_are_those_of_an_undisturbed_run(base, fault, monkeypatch):
    monkeypatch.setattr(faults.Round, "first", property(lambda self: len(STAGES) - 2, lambda self, value: None), raising=False)
    told, differences = faults.play(*base, fault, seed=1)
    assert not differences, told


def test_a_fingerprint_tells_what_differs(base, folder):
    path = folder / "results/models/tall/picture.png"
    path.write_bytes(path.read_bytes() + b"x")
    (folder / "results/models/tall/nodes.parquet").unlink()
    (folder / "results/models/tall/.draw.scratch").mkdir()
    names = ["results/models/tall/.draw.scratch", "results/models/tall/nodes.parquet", "results/models/tall/picture.png"]
    assert faults.compare(base[1], faults.fingerprint(folder)) == names


def test_planning_shows_no_traceback_whatever_it_finds(base, folder):
    models, status = folder / "results/models", folder / "results/status"
    (folder / "meshes/loop.off").symlink_to("loop.off")
    for number, text in enumerate(["", "{}", "[]", '{"key": ', "\0" * 100]):
        (models / "tall" / receipt_name(STAGES[number])).write_text(text)
    receipt = models / "round" / receipt_name("draw")
    receipt.unlink()
    receipt.mkdir()
    shutil.rmtree(models / "torn")
    (models / "torn").touch()
    for stage, path in zip(STAGES, sorted(status.glob("*/*.parquet")), strict=False):
        os.truncate(path, 30)
    table = sorted(status.glob("draw/*.parquet"))[0]
    table.unlink()
    table.mkdir()
    (folder / "results/corpus/models.parquet").write_bytes(b"")
    code, said = faults.run(folder, "-n")
    assert code == 0 and "Traceback" not in said and "loop.off (no file: Too many levels of symbolic links)" in said
    faults.run(folder)
    (models / "torn").unlink()
    assert faults.settle(folder) == 1
    assert faults.compare(base[1], faults.fingerprint(folder)) == []
