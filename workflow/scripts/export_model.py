"""Write a model for other programs.

Regions as polygons; the solid's graph, the contours and the surface for
ParaView; the solid's graph as a tree in SWC, with the edges that it cuts
beside it; and both graphs as arrays. What they say of the model has its
verdict, which is known by now.
"""

import numpy as np

from corpus.storage import read_blocks, read_json, read_table, write_json, write_table, write_text
from corpus.surfaces import read_arc_tables
from corpus.whole_files import place_whole
from label_faces import label_model
from reebslice.drawing.model import read_graph
from reebslice.graphs.face_labels import list_face_arcs
from reebslice.graphs.graph_arrays import graph_arrays
from reebslice.graphs.model_files import contour_lines, graph_lines, graph_tree, surface_triangles
from reebslice.slicing.region_tables import regions_table
from reebslice.slicing.tables import contour_curves

OUTPUTS = (
    "regions.parquet",
    "solid.vtp",
    "contours.vtp",
    "surface.vtp",
    "solid.swc",
    "solid_cuts.json",
    "solid.npz",
    "surface.npz",
)


def main(source, target, options):
    """Write the model in folder `source` to folder `target`.

    options : `method`, that of `edges`.
    """
    model = label_model(source, options["method"], "not exported")
    tilt, certificate = read_json(source / "tilt.json"), read_json(source / "certificate.json")
    about = {"model": source.name, "verdict": certificate["verdict"]}
    about |= {"unit": read_json(source / "inspection.json")["unit"] or ""}
    _, contours, _, arcs = read_arc_tables(source)
    curves = contour_curves(contours, read_blocks(source / "contours.parquet", "contours", "geometry"))
    write_table(target / "regions.parquet", "regions", regions_table(contours, curves))
    write_text(target / "contours.vtp", contour_lines(contours, curves, model.rotation, about))
    write_text(target / "surface.vtp", _write_surface(model, about))
    graphs = {name: read_graph(source / f"{name}.graphml") for name in ("solid", "surface", "augmented")}
    nodes = read_table(source / "nodes.parquet", "nodes")
    write_text(target / "solid.vtp", graph_lines(graphs["solid"], arcs, nodes, about))
    swc, cuts = graph_tree(graphs["augmented"], about)
    write_text(target / "solid.swc", swc)
    write_json(target / "solid_cuts.json", {"model": source.name, "cuts": cuts})
    about |= {"direction": tilt["direction"]}
    for name in ("solid", "surface"):
        with place_whole(target / f"{name}.npz") as scratch, open(scratch, "wb") as file:
            np.savez(file, **graph_arrays(graphs[name], about | {"graph": name}))


def _write_surface(model, about):
    """The surface with the arcs that its faces lie on, as poly data."""
    points, faces = model.surface
    table, _ = list_face_arcs(*model[:3], model.surface, model.rotation, False)
    return surface_triangles(points, faces, table, points @ model.rotation[2], about)


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)
