"""Draw every model's still picture: its solid Reeb graph in the body, and flat by height; and a small one for lists.

After figure 6 of Pareja-Corcho et al. (see reebslice.drawing.picture). The bytes of
the picture depend on the results alone: no dates, no program versions.
"""

import numpy as np

from corpus.stages import run_batch
from corpus.storage import read_blocks, read_json, read_table
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.model import list_facts, pick_curves, read_graph, stack_columns, trace_solid_arcs
from reebslice.drawing.picture import Body, Title, draw_model
from reebslice.drawing.thumbnail import draw_thumbnail

OUTPUTS = ("picture.png", "thumbnail.png")


def main(source, target, options):
    """Write `picture.png` and `thumbnail.png` of the model in the folder `source` into `target`."""
    rotation = np.array(read_json(source / "tilt.json")["rotation"], float)
    certificate = read_json(source / "certificate.json")
    vertices, faces, levels, contours, arcs, material = (
        read_table(source / f"{name}.parquet", name, without=("geometry", "shell"))
        for name in ("vertices", "faces", "levels", "contours", "arcs", "nodes")
    )
    geometry = read_blocks(source / "contours.parquet", "contours", "geometry")
    title = Title(source.name, list_facts(certificate, faces.num_rows, levels.num_rows), certificate["verdict"])
    points = stack_columns(vertices, "xyz") @ rotation.T
    body = Body(points, stack_columns(faces, "abc"), rotation, pick_curves(levels, contours, geometry))
    graph, paths = read_graph(source / "solid.graphml"), trace_solid_arcs(arcs, material)
    (target / "picture.png").write_bytes(encode_png(draw_model(title, body, graph, paths, options)))
    (target / "thumbnail.png").write_bytes(draw_thumbnail(body, graph, paths, options))


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)
