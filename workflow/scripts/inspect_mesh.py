"""Read one mesh file, clean its surface, and accept or reject it.

Writes the record `inspection.json`, also of a rejected mesh, and the surface
that every later stage works on: `vertices`, `faces` and `shells`. Of the file
the record tells the length `unit` of its coordinates, null where neither its
format nor the configuration names one, and `notes`, sentences on what it holds
besides this surface.
"""

from pathlib import Path

from corpus.stages import Rejected
from corpus.storage import write_json, write_table
from reebslice.errors import MeshFormatError
from reebslice.formats.meshes import read_mesh
from reebslice.mesh.inspection import blank_record, inspect_surface

OUTPUTS = ("inspection.json", "vertices.parquet", "faces.parquet", "shells.parquet")


def main(source, target, options):
    """Inspect the mesh file `source`; leave `OUTPUTS` in the folder `target`."""
    target, unit = Path(target), options.get("unit")
    options = {key: value for key, value in options.items() if key != "unit"}
    try:
        mesh = read_mesh(source)
    except MeshFormatError as error:
        tables, inspection = None, {**blank_record(str(error)), "unit": unit, "notes": []}
    else:
        tables, inspection = inspect_surface(mesh.points, mesh.faces, options)
        inspection |= {"unit": unit or mesh.unit, "notes": [*mesh.notes, *_contradict(unit, mesh.unit)]}
    write_json(target / "inspection.json", inspection)
    if tables is None:
        raise Rejected(inspection["reason"])
    for name, table in tables.items():
        write_table(target / f"{name}.parquet", name, table)


def _contradict(unit, told):
    """Return a sentence where the file says another unit than the configuration, in a list."""
    if unit in (None, told) or told is None:
        return []
    return [f"The file says {told}; the configuration, which counts, says {unit}."]
