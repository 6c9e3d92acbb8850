"""Take the solid apart at its events: `parts`, and the closed meshes as `parts.glb`."""

from corpus.stages import Rejected
from corpus.storage import write_table
from corpus.surfaces import read_arc_tables, read_faces, read_points, read_rotation, read_shells
from corpus.whole_files import place_whole
from reebslice.drawing.arc_colours import coloured_scene
from reebslice.errors import TooManyCrossingsError
from reebslice.graphs.arc_labels import slice_arcs
from reebslice.graphs.decomposition import labelled_bodies, parts_table
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph

OUTPUTS = ("parts.parquet", "parts.glb")


def main(source, target, options):
    """Take the model in folder `source` apart, write the parts to folder `target`.

    options : `method`, that of `edges`.
    """
    if options["method"] != "exact":
        raise Rejected("no parts: they take edges: {method: exact}, since guessed links tell of no faces.")
    points, faces, rotation = read_points(source), read_faces(source), read_rotation(source)
    mesh = height_mesh(points, faces, rotation)
    graph, body = surface_reeb_graph(mesh), read_shells(source, len(points))[1]
    try:
        labels = slice_arcs(mesh, graph, body[mesh.vertex], *read_arc_tables(source))
    except TooManyCrossingsError as fault:
        raise Rejected(f"no parts: {fault}. Take levels: {{refine: feature}}.") from None
    bodies = labelled_bodies(mesh, labels, points, rotation)
    write_table(target / "parts.parquet", "parts", parts_table(bodies, rotation))
    with place_whole(target / "parts.glb") as scratch:
        scratch.write_bytes(coloured_scene(bodies))
