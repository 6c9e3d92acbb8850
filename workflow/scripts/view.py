"""Make every model's page: `view.html`, one file that loads nothing, and `model.glb`, the scene that it shows."""

from corpus.storage import read_blocks, read_json, read_table, write_text
from corpus.surfaces import read_rotation, read_shells
from reebslice.drawing.embedded_graphs import SHOWN
from reebslice.drawing.model import read_graph
from reebslice.drawing.page import Told, make_page
from reebslice.drawing.page_model import gather_model
from reebslice.slicing.tables import contour_curves

OUTPUTS = ("model.glb", "view.html")
TABLES = ("vertices", "faces", "levels", "contours", "nodes", "arcs")


def main(source, target, options):
    """Write `model.glb` and `view.html` of the model in the folder `source` into `target`.

    options : faces, beyond which a surface is decimated for display.
    """
    tables = {name: read_table(source / f"{name}.parquet", name, without=("geometry",)) for name in TABLES}
    curves = contour_curves(tables["contours"], read_blocks(source / "contours.parquet", "contours", "geometry"))
    graphs = {name: read_graph(source / f"{name}.graphml") for name in SHOWN}
    certificate = read_json(source / "certificate.json")
    rotation = read_rotation(source)
    body = read_shells(source, tables["vertices"].num_rows)[1]
    model, notes = gather_model(tables, body, curves, graphs, rotation, certificate.get("feature_size") or 0.0)
    told = Told(source.name, read_json(source / "inspection.json"), certificate)
    glb, html = make_page(told, model, options["faces"], notes)
    (target / "model.glb").write_bytes(glb)
    write_text(target / "view.html", html)
