"""Connect the levels: `edges`, `arcs` and the Reeb graphs as GraphML.

The graphs tell model, direction and unit. The verdict is that of `certificate.json`, which is about these files as
they are and so cannot be in them.
"""

import numpy as np

from corpus.storage import read_blocks, read_json, read_table, write_table, write_text
from reebslice.formats.graphml import graphml_text
from reebslice.graphs.reeb_graphs import describe_graph
from reebslice.graphs.synthesis import synthesize
from reebslice.schemas import GRAPHS
from reebslice.slicing.refinement import feature_scale
from reebslice.slicing.tables import contour_curves

OUTPUTS = (
    "edges.parquet",
    "arcs.parquet",
    "solid.graphml",
    "surface.graphml",
    "void.graphml",
    "augmented.graphml",
    "solid_simplified.graphml",
    "surface_simplified.graphml",
)


def main(source, target, options):
    """Connect the levels of the model in folder `source`, write the graphs to folder `target`.

    options : those of `edges`, and `levels`, those of `levels`.
    """
    pieces, handles, nodes = (read_table(source / f"{name}.parquet", name) for name in ("pieces", "handles", "nodes"))
    contours = read_table(source / "contours.parquet", "contours", without=("geometry",))
    curves = contour_curves(contours, read_blocks(source / "contours.parquet", "contours", "geometry"))
    # the lowest and the highest vertex are handles
    size = feature_scale(np.ptp(handles["height"].to_numpy()), **options["levels"])[1]
    tilt, unit = read_json(source / "tilt.json"), read_json(source / "inspection.json")["unit"]
    result = synthesize(contours, curves, pieces, handles, nodes, np.array(tilt["rotation"]), size, options["method"])
    write_table(target / "edges.parquet", "edges", result.edges)
    write_table(target / "arcs.parquet", "arcs", result.arcs)
    for name in GRAPHS:
        about = describe_graph(name, source.name, tilt["direction"], unit)
        write_text(target / f"{name}.graphml", graphml_text(getattr(result, name), name, about))
