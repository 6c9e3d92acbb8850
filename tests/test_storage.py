"""Files that the stages hand on: whole, declared, keyed, readable elsewhere."""

import json
import subprocess
import sys
from pathlib import Path

import geopandas
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import shapely

from corpus.storage import (
    AlteredFileError,
    content_key,
    read_json,
    read_key,
    read_table,
    write_json,
    write_parquet,
    write_table,
)
from reebslice.schemas import FORMAT_VERSION, SCHEMAS
from reebslice.table_checks import build_table

TRIANGLE = shapely.LineString([(0, 0), (1, 0), (0, 1), (0, 0)])


def nodes_table():
    columns = {"node": [0, 1], "level": [0, 1], "region": [0, 1], "height": [0.1, 0.2], "critical": [True, False]}
    columns |= {"x": [0.0, 1.0], "y": [0.0, 1.0], "z": [0.1, 0.2], "area": [1.0, 2.0], "inscribed_radius": [0.5, 0.6]}
    return build_table("nodes", columns | {"n_holes": [0, 0]})


def contours_table():
    columns = {
        "level": [0],
        "contour": [0],
        "height": [0.0],
        "shell": [0],
        "region": [0],
        "inner": [False],
        "parent": [None],
    }
    columns |= {"signed_area": [0.5], "perimeter": [3.4], "n_points": [3], "lower_vertex": [0], "upper_vertex": [1]}
    return build_table("contours", columns | {"geometry": [shapely.to_wkb(TRIANGLE)]})


def test_table_comes_back_equal_with_key_and_units(tmp_path):
    with content_key("abc"):
        write_table(tmp_path / "nodes.parquet", "nodes", nodes_table())
    assert read_table(tmp_path / "nodes.parquet", "nodes").equals(nodes_table())
    schema = pq.read_schema(tmp_path / "nodes.parquet")
    assert read_key(tmp_path / "nodes.parquet") == "abc"
    assert schema.metadata[b"reebslice:table"] == b"nodes"
    assert schema.metadata[b"reebslice:format_version"] == FORMAT_VERSION.encode()
    assert schema.field("x").metadata[b"unit"] == b"mesh"


def test_tables_of_many_models_are_put_together_and_told_apart(tmp_path):
    for model in ("a", "b"):
        with content_key("k", model=model):
            write_table(tmp_path / f"{model}.parquet", "nodes", nodes_table())
    whole = pd.concat(pd.read_parquet(tmp_path / f"{model}.parquet") for model in "ab")
    assert list(whole.columns) == ["model", *SCHEMAS["nodes"].names]
    assert whole["model"].tolist() == ["a", "a", "b", "b"] and whole["node"].tolist() == [0, 1, 0, 1]
    assert pq.read_schema(tmp_path / "a.parquet").metadata[b"reebslice:primary_key"] == b"model, node"
    with content_key("new", model="a"):
        assert read_table(tmp_path / "a.parquet", "nodes").equals(nodes_table())
        with pytest.raises(AlteredFileError, match="another model than 'a'"):
            read_table(tmp_path / "b.parquet", "nodes")
    table = pq.read_table(tmp_path / "a.parquet")
    pq.write_table(table.drop_columns("model"), tmp_path / "a.parquet")
    with pytest.raises(AlteredFileError, match="first column is not model"):
        read_table(tmp_path / "a.parquet", "nodes")


@pytest.mark.parametrize("rows", [0, 1, 2**20, 2**20 + 3])
def test_every_row_tells_the_model(tmp_path, rows):
    columns = dict.fromkeys("xyz", np.arange(rows, dtype=float))
    with content_key("k", model="a & ü"):
        write_table(tmp_path / "vertices.parquet", "vertices", build_table("vertices", columns))
        assert len(read_table(tmp_path / "vertices.parquet", "vertices")) == rows
    found = pq.read_table(tmp_path / "vertices.parquet")["model"]
    assert len(found) == rows and set(found.unique().to_pylist()) == ({"a & ü"} if rows else set())


def test_units_survive_operations_that_drop_them(tmp_path):
    bare = pa.table({name: nodes_table()[name] for name in SCHEMAS["nodes"].names})
    bare = bare.cast(pa.schema([field.remove_metadata() for field in SCHEMAS["nodes"]]))
    write_table(tmp_path / "nodes.parquet", "nodes", bare)
    assert pq.read_schema(tmp_path / "nodes.parquet").field("x").metadata[b"unit"] == b"mesh"


def test_key_given_directly_wins(tmp_path):
    with content_key("outer"):
        write_table(tmp_path / "nodes.parquet", "nodes", nodes_table(), key="inner")
    assert read_key(tmp_path / "nodes.parquet") == "inner"


def test_wrong_table_is_refused_and_leaves_nothing(tmp_path):
    with pytest.raises(ValueError, match="table nodes does not match"):
        write_table(tmp_path / "nodes.parquet", "nodes", nodes_table().drop_columns(["area"]))
    assert list(tmp_path.iterdir()) == []


def test_reading_refuses_another_table_and_a_foreign_file(tmp_path):
    write_table(tmp_path / "nodes.parquet", "nodes", nodes_table())
    with pytest.raises(ValueError, match="holds table 'nodes'.*expected 'edges'.*run the workflow again"):
        read_table(tmp_path / "nodes.parquet", "edges")
    write_parquet(tmp_path / "foreign.parquet", nodes_table().replace_schema_metadata(None))
    with pytest.raises(ValueError, match="holds table ''"):
        read_table(tmp_path / "foreign.parquet", "nodes")


def test_contours_are_geoparquet(tmp_path):
    write_table(tmp_path / "contours.parquet", "contours", contours_table())
    frame = geopandas.read_parquet(tmp_path / "contours.parquet")
    assert frame.crs is None
    assert frame.geometry[0].equals(TRIANGLE)
    assert frame.geometry[0].is_ring
    assert json.loads(pq.read_schema(tmp_path / "contours.parquet").metadata[b"geo"])["version"] == "1.1.0"


def test_json_takes_numpy_and_sorts_keys(tmp_path):
    write_json(tmp_path / "facts.json", {"b": np.float64(1.5), "a": np.arange(2), "c": np.bool_(True), "d": None})
    assert read_json(tmp_path / "facts.json") == {"a": [0, 1], "b": 1.5, "c": True, "d": None}
    assert list(read_json(tmp_path / "facts.json")) == ["a", "b", "c", "d"]


@pytest.mark.parametrize("bad", [float("nan"), np.float32("inf"), [1.0, np.array([0.0, np.nan])]])
def test_json_refuses_what_is_not_finite_and_says_where(tmp_path, bad):
    write_json(tmp_path / "facts.json", {"old": 1})
    with pytest.raises(ValueError, match=r"margin.*not a finite number; write None"):
        write_json(tmp_path / "facts.json", {"tilt": {"margin": bad}})
    assert read_json(tmp_path / "facts.json") == {"old": 1}
    assert [path.name for path in tmp_path.iterdir()] == ["facts.json"]


def test_every_column_says_what_it_is_and_the_page_of_tables_says_the_same():
    for name, schema in SCHEMAS.items():
        assert schema.metadata[b"description"].endswith(b"."), name
        assert all(field.metadata[b"description"].endswith(b".") for field in schema), name
    script = Path(__file__).parents[1] / "docs" / "make_tables.py"
    assert subprocess.run([sys.executable, script, "--check"], check=False).returncode == 0, "run make tables"
