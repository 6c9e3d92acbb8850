"""Hold the finished model against theory and against its own mesh: `certificate.json`.

Everything is read back from the files, graphs included, so that what is
certified is what users get.
"""

from pathlib import Path

from corpus.storage import read_blocks, read_json, read_table, write_json
from reebslice.certification.certificate import certify
from reebslice.certification.graphml import parse_graph
from reebslice.certification.lengths import mesh_lengths
from reebslice.certification.recount.curves import POINT, read_curves
from reebslice.schemas import GRAPHS, MODEL_TABLES

OUTPUTS = ("certificate.json",)


def main(source, target, options):
    """Certify the model in folder `source`; write the certificate to folder `target`."""
    source = Path(source)
    # of the contours the curves, by far the most, are not kept as the file has them
    apart = {"contours": ("geometry",)}
    tables = {name: read_table(source / f"{name}.parquet", name, apart.get(name, ())) for name in MODEL_TABLES}
    drawn = source / "contours.parquet"
    curves = read_curves(read_blocks(drawn, "contours", "geometry"), drawn.stat().st_size // POINT)
    tilt = read_json(source / "tilt.json")
    graphs = {name: parse_graph((source / f"{name}.graphml").read_bytes()) for name in GRAPHS}
    size, distance = mesh_lengths(tables["vertices"], tilt, options)
    told = read_json(source / "inspection.json"), source.name
    write_json(Path(target) / "certificate.json", certify(tables, tilt, graphs, size, distance, curves, *told))
