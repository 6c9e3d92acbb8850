"""A few rounds of faults (see faults.py), and what runs say when they cannot go on."""

import os
import shutil
import signal
from pathlib import Path

import faults
import pytest

from corpus.layout import STAGES
from corpus.storage import read_json


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
