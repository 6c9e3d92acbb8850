"""Write docs/tables.md from the declarations of the tables: python docs/make_tables.py [--check].

With --check nothing is written, and the exit code says whether the page is
that of the declarations.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from reebslice.schemas import EVENTS, SCHEMAS, file_schema

PAGE = ROOT / "docs" / "tables.md"
HEAD = """# Tables

Made by `make tables` from `workflow/scripts/reebslice/schemas.py`; the same descriptions are in the metadata of the
Parquet fields. The unit `mesh` is the length unit of the mesh file: `unit` in `inspection.json` names it where the
format has one. Ids are int32, lengths and heights float64. Ids are those of one model: over many models the key of a
row begins with `model`, the first column of every table.

Two frames: `x`, `y`, `z` are always in the frame of the mesh file (the model frame); `geometry` of the contours is in
the tilted frame, in which the height is the third coordinate (`rotation` in `tilt.json` leads there). `height` is the
same in both. Two kinds of ids: `nodes` of an arc are regions for `graph = solid` and contours for `graph = surface`.
"""
TYPES = {"list<item: int32>": "list of int32", "double": "float64"}


def make_page():
    """Return the page as text."""
    lines = [HEAD, "## Events\n", "| change | side | index | outer | inner | regions | operation |"]
    lines.append("| --- | --- | ---: | ---: | ---: | ---: | --- |")
    for change, (side, index, *steps, operation) in EVENTS.items():
        told = " | ".join(f"{step:+d}" if step else "0" for step in steps)
        lines.append(f"| `{change}` | {side} | {index} | {told} | {operation} |")
    for name in SCHEMAS:
        schema = file_schema(name)
        key, says = (schema.metadata[word].decode() for word in (b"reebslice:primary_key", b"description"))
        where = "results/corpus/comparison.parquet" if name == "comparison" else f"{name}.parquet"
        where += "`, and all in `results/corpus/directions.parquet" if name == "directions" else ""
        lines += [f"\n## {name}\n", f"`{where}`. {says} Key: {key}.\n", "| column | type | unit | meaning |"]
        lines.append("| --- | --- | --- | --- |")
        for field in schema:
            kind = TYPES.get(str(field.type), str(field.type)) + (" or null" if field.nullable else "")
            unit = field.metadata.get(b"unit", b"").decode()
            lines.append(f"| `{field.name}` | {kind} | {unit} | {field.metadata[b'description'].decode()} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit(PAGE.read_text(encoding="utf-8") != make_page())
    PAGE.write_text(make_page(), encoding="utf-8")
