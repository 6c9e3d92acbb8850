"""Draw every model's still picture: its Reeb graph in the body, and flat by height; and a small one for lists.

After figure 6 of Pareja-Corcho et al. (see reebslice.drawing.picture). The bytes of
the picture depend on the results alone: no dates, no program versions.
"""

import numpy as np

from corpus.storage import read_blocks, read_json, read_table
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.model import (
    choose_graph,
    describe_graph,
    list_facts,
    pick_curves,
    place_arcs,
    read_graph,
    stack_columns,
)
from reebslice.drawing.picture import Body, draw_model
from reebslice.drawing.rasters import choose_angles
from reebslice.drawing.thumbnail import draw_thumbnail
from reebslice.drawing.titles import Title
from reebslice.slicing.tables import contour_curves

OUTPUTS = ("picture.png", "thumbnail.png")
TABLES = ("vertices", "faces", "levels", "contours", "arcs", "nodes")


def main(source, target, options):
    """Write `picture.png` and `thumbnail.png` of the model in the folder `source` into `target`.

    options : width, azimuth, elevation and graph of `draw`.
    """
    title, body, graph, paths = read_model(source, options["graph"])
    options = options | choose_angles(body.points, body.faces, options)
    (target / "picture.png").write_bytes(encode_png(draw_model(title, body, graph, paths, options)))
    (target / "thumbnail.png").write_bytes(draw_thumbnail(body, graph, paths, options))


def read_model(source, wish):
    """Read what a picture shows of the model in the folder `source`: title, body, graph and paths of its arcs."""
    rotation = np.array(read_json(source / "tilt.json")["rotation"], float)
    certificate, unit = read_json(source / "certificate.json"), read_json(source / "inspection.json").get("unit")
    tables = {name: read_table(source / f"{name}.parquet", name, without=("geometry", "shell")) for name in TABLES}
    faces, levels, contours = (tables[name] for name in ("faces", "levels", "contours"))
    solid = read_graph(source / "solid.graphml")
    name = choose_graph(wish, len(solid.nodes))
    graph = solid if name == "solid" else read_graph(source / f"{name}.graphml")
    said = describe_graph(name, len(graph.nodes), len(solid.nodes), certificate.get("feature_size"), unit)
    title = Title(
        source.name, list_facts(certificate, faces.num_rows, levels.num_rows), certificate["verdict"], said, unit
    )
    curves = pick_curves(levels, contours, read_geometry(source))
    body = Body(stack_columns(tables["vertices"], "xyz") @ rotation.T, stack_columns(faces, "abc"), rotation, curves)
    placed = place_arcs(name, graph, tables, lambda: contour_curves(contours, read_geometry(source)), rotation)
    return title, body, *placed


def read_geometry(source):
    """Read the curves of the contours of the model in the folder `source`, in blocks."""
    return read_blocks(source / "contours.parquet", "contours", "geometry")
