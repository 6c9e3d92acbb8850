"""The exact graphs that the workflow makes without levels, and their certificate."""

import json
import sys
from collections import Counter
from importlib import import_module
from pathlib import Path

import networkx as nx
import numpy as np
import pyarrow as pa
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import certify_graphs
import slice_mesh
import solids
from corpus import layout, model_table
from corpus.configuration import check_config
from corpus.layout import chosen_stages, line_behind
from corpus.stages import Rejected
from corpus.storage import read_json, read_table, write_json, write_parquet
from mutate_graphs import built, count_refused, load, torus
from pipeline import OPTIONS
from reebslice import exact_graphs
from reebslice.schemas import EXACT_GRAPHS
from test_laws import cases
from test_touching import voxel_soup

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))
check = import_module("check")
SCHEMA = yaml.safe_load((ROOT / "workflow" / "schemas" / "config.schema.yaml").read_text())


def certificate_of(folder):
    certify_graphs.main(folder, folder, {})
    return json.loads((folder / "exact_graphs.json").read_text())


def failed(certificate):
    return [name for name, check in certificate["checks"].items() if not check["holds"]]


# The graphs


def test_a_noisy_mesh_has_exact_graphs_and_a_certificate_from_the_workflow():
    with built(torus(), "auto") as folder:
        certificate = certificate_of(folder)
        assert (certificate["verdict"], failed(certificate), certificate["reason"]) == ("exact", [], "")
        assert [certificate[name] for name in ("genus", "loops_surface", "loops_solid")] == [1, 1, 1]
        points, faces = (
            np.column_stack([read_table(folder / f"{name}.parquet", name)[c] for c in columns])
            for name, columns in (("vertices", "xyz"), ("faces", "abc"))
        )
        expected = exact_graphs(points, faces, read_json(folder / "tilt.json")["rotation"])
        nodes = read_table(folder / "exact_nodes.parquet", "exact_nodes")
        for name, graph in zip(EXACT_GRAPHS, expected):
            read = nx.read_graphml(folder / f"{name}.graphml", force_multigraph=True)
            height = nx.get_node_attributes(read, "height")
            pairs = [sorted((a, b), key=lambda node: int(node[1:])) for a, b in read.edges()]
            vertex = nodes["vertex"].to_numpy()
            found = Counter((vertex[int(a[1:])], vertex[int(b[1:])]) for a, b in pairs)
            assert found == Counter(map(tuple, graph.vertex[graph.arcs].tolist()))
            assert sorted(height.values()) == graph.height.tolist()
        assert len(nodes) > 300  # so many critical points that it is noisy indeed
        with pytest.raises(Rejected, match="no levels with"):
            slice_mesh.main(folder, folder, OPTIONS["levels"] | {"refine": "graphs"})


@cases(25)
@given(st.one_of(solids.any_solids(), solids.flat_solids()))
def test_all_solids_have_exact_certificates(solid):
    with built(solid) as folder:
        certificate = certificate_of(folder)
        assert (certificate["verdict"], failed(certificate)) == ("exact", []), certificate["reason"]


@pytest.mark.parametrize("seed, turned", [(0, False), (4, False), (4, True), (5, False), (13, True), (39, False)])
def test_cavities_that_touch_open_and_close_in_turn(seed, turned):
    solid = voxel_soup(seed)[1]
    with built(
        solids.transform(solid, solids.rotation(seed)) if turned else solid, "none" if turned else "auto"
    ) as folder:
        certificate = certificate_of(folder)
        assert (certificate["verdict"], failed(certificate)) == ("exact", []), certificate["reason"]


def test_bodies_that_overlap_are_each_a_solid_of_its_own():
    one = solids.torus(upright=True)
    with built(solids.unite(one, solids.move(one, [0.7, 0.9, 0.1])), "auto") as folder:
        certificate = certificate_of(folder)
        assert certificate["verdict"] == "exact" and "disjoint union" in certificate["solid_interpretation"]


@pytest.mark.parametrize("mode", ["none", "auto"])
def test_of_bodies_that_share_a_face_it_is_told_that_contours_touch(mode):
    box = solids.voxels(np.ones((1, 1, 1), bool))
    with built(solids.unite(box, solids.move(box, [1.0, 0.0, 0.0])), mode) as folder:
        certificate = certificate_of(folder)
        assert certificate["surface_verdict"] == "exact" and failed(certificate) == []
        assert certificate["verdict"] == "exact" or "Contours touch" in certificate["reason"]


def test_of_a_surface_that_crosses_itself_the_graph_of_the_surface_alone_is_certified():
    points = torus().points.copy()
    points[:, 0] *= np.sign(points[:, 1])  # two halves turned over each other
    with built(solids.Solid(points, torus().faces)) as folder:
        assert read_json(folder / "inspection.json")["self_crossings"]
        certificate = certificate_of(folder)
        assert (certificate["verdict"], certificate["surface_verdict"]) == ("uncertified", "exact")
        assert "crosses itself" in certificate["reason"]


# The workflow


def test_stages_without_levels_are_those_of_exact_and_graphs():
    chosen = {refine: set(chosen_stages(check_config({"levels": {"refine": refine}}, SCHEMA))) for refine in
              ("feature", "exact", "none", "graphs")}  # fmt: skip
    pair = {"build_graphs", "certify_graphs"}
    assert not pair & chosen["feature"] and chosen["none"] == chosen["feature"]
    assert chosen["exact"] == chosen["feature"] | pair
    assert chosen["graphs"] == chosen["exact"] - set(line_behind("slice_mesh"))


@pytest.mark.parametrize("sliced", ["ok", "rejected"])
def test_a_mesh_too_noisy_for_levels_is_no_longer_rejected(sliced, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    row = {"model": "a", "path": "m/a.stl", "seconds": 0.5, "peak_memory_mb": 10.0, "key": "k", "stamp": "s"}
    tables = {}
    for stage in layout.STAGES:
        status, reason = "ok", ""
        if sliced == "rejected" and stage in line_behind("slice_mesh"):
            status, reason = ("rejected" if stage == "slice_mesh" else "skipped"), "too many crossings"
        tables[stage] = [layout.STATUS_FOLDER / stage / "x.parquet"]
        write_parquet(tables[stage][0], pa.Table.from_pylist([row | {"status": status, "reason": reason}],
                                                             schema=layout.STATUS_SCHEMA))  # fmt: skip
    folder = layout.MODELS_FOLDER / "a"
    write_json(folder / "exact_graphs.json", {"exact_verdict": "exact", "verdict": "exact", "reason": "", "genus": 7})
    if sliced == "ok":
        write_json(folder / "certificate.json", {"verdict": "exact_at_feature_size", "reason": "", "genus": 7})
    (found,) = model_table.make_model_table(tables).to_pylist()
    told = "" if sliced == "ok" else "Exact graphs alone, without levels: too many crossings"
    assert (found["status"], found["reason"], found["exact_verdict"], found["genus"]) == ("ok", told, "exact", 7)
    assert found["verdict"] == ("exact_at_feature_size" if sliced == "ok" else "exact")


def test_the_checker_claims_nothing_of_graphs_without_levels(tmp_path, capsys):
    (tmp_path / "models" / "a").mkdir(parents=True)
    (tmp_path / "models" / "a" / "tilt.json").write_text("{}")
    assert check.main(tmp_path) == 0
    assert capsys.readouterr().out.split() == ["a", "-", "no", "certificate.json:", *"it makes no claim".split()]


# The certificate against alterations


@pytest.mark.parametrize("solid", [torus(20, 14, 0.5), solids.csg(3), solids.machined(5)], ids=["torus", "csg", "part"])
def test_altered_graphs_are_refused(solid):
    with built(solid) as folder:
        assert count_refused(load(folder), 25, 1) == (25, {})
