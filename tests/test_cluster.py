"""What a run needs to go through a cluster; tests/cluster/run_on_slurm.py sends one through."""

import json
import os
import re
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import yaml
from snakemake.cli import get_argument_parser
from snakemake.settings.types import SharedFSUsage, StorageSettings

from compare_results import compare_results
from corpus.batches import form_batches, predict_gathering
from corpus.configuration import ConfigError
from corpus.discovery import find_models
from corpus.layout import ASKED_FOR, STAGES, STATUS_SCHEMA, read_status
from corpus.mesh_list import MESH_LIST, keep_mesh_list, recall_mesh_list
from corpus.shared_files import check_file_sharing
from test_workflow import EVERYTHING, run, write_box

PROFILES = sorted((Path(__file__).parent.parent / "workflow/profiles").iterdir())
# What Snakemake needs to take a storage for usable; nothing of it is ever called.
STORAGE = """
from snakemake_interface_storage_plugins.storage_object import StorageObjectRead, StorageObjectWrite
from snakemake_interface_storage_plugins.storage_provider import StorageProviderBase


class StorageProvider(StorageProviderBase):
    example_queries = rate_limiter_key = default_max_requests_per_second = use_rate_limiter = is_valid_query = None


class StorageObject(StorageObjectRead, StorageObjectWrite):
    pass
"""


def plan(folder, *targets):
    """Plan a run with all stages; return what Snakemake says of every job, {rule: [text]}."""
    code, said = run(folder, "-n", *targets, options=EVERYTHING)
    assert code == 0, said
    jobs = {}
    for rule, text in re.findall(r"^(?:local)?rule (\w+):\n((?:    .*\n)+)", said, flags=re.MULTILINE):
        jobs.setdefault(rule, []).append(text)
    return jobs


def put_gltf(path, uri):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 4}]}))


# What jobs declare


def test_every_job_asks_for_memory_and_time(tmp_path):
    write_box(tmp_path / "meshes/a.off")
    jobs = plan(tmp_path, "all", "compare_methods", "compare_directions")
    corpus = {"collect_models", "compare_shapes", "report_models", "compare_methods", "compare_directions"}
    assert set(jobs) == {*STAGES, *ASKED_FOR, *corpus, "all"}
    for rule in set(jobs) - {"all"}:
        for text in jobs[rule]:
            asked = dict(re.findall(r"(mem_mb|runtime)=(\d+)", text))
            assert int(asked["mem_mb"]) >= 500 and int(asked["runtime"]) >= 5, rule


def test_what_jobs_open_is_declared(tmp_path):
    """Of meshes and what they name the newest, by which Snakemake tells whether any is newer than what was made."""
    write_box(tmp_path / "meshes/a.off")
    put_gltf(tmp_path / "meshes/b.gltf", "b%20b.bin")
    put_gltf(tmp_path / "meshes/c.gltf", "gone.bin")
    for newest, other in (("b b.bin", "a.off"), ("a.off", "b b.bin")):
        (tmp_path / "meshes/b b.bin").write_bytes(b"0000")
        for age, name in enumerate((newest, other, "b.gltf", "c.gltf")):
            os.utime(tmp_path / "meshes" / name, (1e9 - age, 1e9 - age))
        jobs = plan(tmp_path)
        (gathered,), (inspected,) = jobs["collect_models"], jobs["inspect_mesh"]
        assert all(f"results/status/{stage}/batch-" in gathered for stage in STAGES)
        assert f"meshes/{newest}" in inspected and f"meshes/{other}" not in inspected and "gone.bin" not in inspected


def run_job(folder, stage, batch):
    """Run a job as an executor has it run, by a Snakemake that parses the workflow anew; return its rows."""
    job = (
        "--mode",
        "remote",
        "--target-jobs",
        f"{stage}:batch={batch}",
        "--allowed-rules",
        stage,
        "--force",
        "--nolock",
    )
    code, said = run(folder, *job)
    assert code == 0, said
    return {row["model"]: row for row in read_status(folder / f"results/status/{stage}/{batch}.parquet")}


def test_jobs_are_about_the_meshes_that_the_run_found(tmp_path, monkeypatch):
    """Some are added behind its back, so that other batches would be made, and one goes."""
    monkeypatch.chdir(tmp_path)
    for name in "abcd":
        write_box(tmp_path / f"meshes/{name}.off")
    code, said = run(tmp_path, "--until", "inspect_mesh")
    found, numbers = find_models("meshes")[0], {"size": 32, "most": 16}
    (batch,) = form_batches(found, **numbers)
    assert code == 0 and recall_mesh_list() == found, said
    for number in range(60):
        write_box(tmp_path / f"meshes/{number}.off")
    (tmp_path / "meshes/c.off").unlink()
    assert batch not in form_batches(find_models("meshes")[0], **numbers)
    rows = run_job(tmp_path, "inspect_mesh", batch)
    assert list(rows) == list("abcd") and {rows[name]["status"] for name in "abd"} == {"ok"}
    assert "c.off" in rows["c"]["reason"] and rows["c"]["status"] != "ok"
    assert recall_mesh_list() == found  # which is the run's to leave, not its jobs'


def test_a_list_of_meshes_holds_all_that_was_found(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_box(tmp_path / "meshes/a.off")
    put_gltf(tmp_path / "meshes/sub/b.gltf", "b.bin")
    write_box(tmp_path / "meshes/caf\u00e9.off")
    assert recall_mesh_list() is None
    found = find_models("meshes")[0]
    keep_mesh_list(found)
    assert recall_mesh_list() == found and len(found) == 3 and found["sub__b"].companions
    MESH_LIST.write_text("[")
    assert recall_mesh_list() is None


def test_gathering_more_models_takes_more():
    assert all(more > less for more, less in zip(predict_gathering(1_000_000), predict_gathering(100)))


# Storage


def test_what_would_leave_files_behind_is_refused():
    check_file_sharing(StorageSettings())
    with pytest.raises(
        ConfigError, match="--default-storage-provider s3 cannot be used.*on a file system that all jobs"
    ):
        check_file_sharing(StorageSettings(default_storage_provider="s3"))
    with pytest.raises(ConfigError, match="--shared-fs-usage without input-output cannot be used"):
        check_file_sharing(StorageSettings(shared_fs_usage=frozenset({SharedFSUsage.PERSISTENCE})))


def test_a_run_with_a_storage_stops_at_once(tmp_path, monkeypatch):
    write_box(tmp_path / "meshes/a.off")
    plugin = tmp_path / "plugins/snakemake_storage_plugin_elsewhere/__init__.py"
    plugin.parent.mkdir(parents=True)
    plugin.write_text(STORAGE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "plugins"))
    code, said = run(tmp_path, "--default-storage-provider", "elsewhere", "--default-storage-prefix", "there")
    assert code == 1 and "Traceback" not in said
    assert "--default-storage-provider elsewhere cannot be used" in said
    assert not (tmp_path / "results").exists()


# Profiles


@pytest.mark.parametrize("profile", PROFILES, ids=[profile.name for profile in PROFILES])
def test_profiles_say_what_snakemake_knows(profile):
    settings = yaml.safe_load((profile / "config.yaml").read_text())
    known = {option.lstrip("-") for option in get_argument_parser()._option_string_actions}
    assert {name for name in settings if not name.startswith("slurm-")} <= known
    assert settings["keep-going"] and settings["rerun-incomplete"] and settings["retries"] >= 1
    assert "configfile" not in settings or (profile / settings["configfile"]).is_file()
    for key in {"groups", "set-resources"} & set(settings):
        assert set(settings[key]) == {*STAGES, *ASKED_FOR}


def test_profiles_are_taken_up_when_asked_for(tmp_path):
    """Snakemake takes up one called `default` by itself."""
    assert PROFILES and "default" not in {profile.name for profile in PROFILES}
    write_box(tmp_path / "meshes/a.off")
    long = next(profile for profile in PROFILES if profile.name == "long")
    for arguments in ((), ("--workflow-profile", str(long))):
        code, said = run(tmp_path, "-n", *arguments)
        assert code == 0 and (f"Using workflow specific profile {long}" in said) == bool(arguments)
        assert said.count("workflow specific profile") == bool(arguments)


# Comparing runs


def lay_out_results(folder, nodes=b"1", seconds=1.0, status="ok", batch="batch-all"):
    receipt = {"key": "k", "seconds": seconds, "seal": str(seconds), "outputs": {"nodes.parquet": [1, seconds, "d"]}}
    files = {"results/models/a/nodes.parquet": nodes}
    files["results/models/a/.sample_nodes.json"] = json.dumps(receipt).encode()
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    row = {"model": "a", "path": "a.stl", "status": status, "reason": "", "seconds": seconds}
    for name, extra in (
        (f"status/sample_nodes/{batch}", {"key": "k", "peak_memory_mb": seconds, "stamp": str(seconds)}),
        ("corpus/models", {"peak_memory_mb_draw": seconds, "seconds_draw": seconds}),
    ):
        path = folder / f"results/{name}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        schema = STATUS_SCHEMA if name.startswith("status") else None
        pq.write_table(pa.Table.from_pylist([row | extra], schema=schema), path)
    return folder


@pytest.mark.parametrize(
    "changed, differing",
    [
        ({"seconds": 2.0, "batch": "batch-1"}, []),
        ({"nodes": b"2"}, ["a/nodes.parquet"]),
        ({"status": "failed"}, ["models.parquet", "sample_nodes"]),
    ],
)
def test_results_are_compared_but_for_seconds_and_memory(tmp_path, changed, differing):
    one, other = lay_out_results(tmp_path / "one"), lay_out_results(tmp_path / "other", **changed)
    assert compare_results(one, other) == (3, differing)


PAGE = (
    '<figure class="chart" data-figure="seconds">{0}</figure><figure class="chart" data-figure="genus">{1}</figure>'
    '<script id="data">{{"figures": [{{"name": "seconds", "of": [{0}]}}, {{"name": "genus", "of": [{1}]}}]}}</script>'
)


@pytest.mark.parametrize("seconds, genus, differing", [(2, 1, []), (1, 2, ["report.html"])])
def test_reports_are_compared_but_for_seconds(tmp_path, seconds, genus, differing):
    one, other = lay_out_results(tmp_path / "one"), lay_out_results(tmp_path / "other")
    (one / "results/corpus/report.html").write_text(PAGE.format(1, 1))
    (other / "results/corpus/report.html").write_text(PAGE.format(seconds, genus))
    assert compare_results(one, other) == (4, differing)


def test_a_file_on_one_side_only_is_a_difference(tmp_path):
    one, other = lay_out_results(tmp_path / "one"), lay_out_results(tmp_path / "other")
    (other / "results/models/a/edges.parquet").write_bytes(b"")
    assert compare_results(one, other)[1] == compare_results(other, one)[1] == ["a/edges.parquet"]
