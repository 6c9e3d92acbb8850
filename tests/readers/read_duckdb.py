"""Query the tables of many models with DuckDB."""

import json
import math
import sys
from pathlib import Path

import duckdb

nodes, regions = (
    duckdb.read_parquet([f"{folder}/{name}.parquet" for folder in sys.argv[1:]]) for name in ("nodes", "regions")
)
told = dict(nodes.aggregate("model, max(inscribed_radius)").fetchall())
expected = (json.loads(Path(folder, "expected.json").read_text()) for folder in sys.argv[1:])
assert told == {one["model"]: one["radius"] for one in expected}
assert dict(zip(regions.columns, map(str, regions.types)))["geometry"] == "GEOMETRY"
joined = duckdb.sql("SELECT sum(n.area), sum(r.area) FROM nodes AS n JOIN regions AS r USING (model, region)")
assert math.isclose(*joined.fetchall()[0])
print("duckdb", duckdb.__version__)
