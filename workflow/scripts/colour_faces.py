"""Colour the surface by the arcs that it lies on, cut where they end: `arcs.ply`."""

from corpus.stages import Rejected
from corpus.surfaces import read_arc_tables, read_faces, read_points, read_rotation, read_shells
from corpus.whole_files import place_whole
from reebslice.drawing.arc_colours import coloured_ply
from reebslice.errors import TooManyCrossingsError
from reebslice.graphs.arc_labels import slice_arcs
from reebslice.graphs.face_labels import list_face_arcs
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph

OUTPUTS = ("arcs.ply",)


def main(source, target, options):
    """Colour the model in folder `source`, write the file to folder `target`.

    options : `by`, the graph whose arcs have colours; `method`, that of `edges`.
    """
    if options["method"] != "exact":
        raise Rejected("no colours: they take edges: {method: exact}, since guessed links tell of no faces.")
    surface, rotation = (read_points(source), read_faces(source)), read_rotation(source)
    mesh = height_mesh(*surface, rotation)
    graph, body = surface_reeb_graph(mesh), read_shells(source, len(surface[0]))[1]
    try:
        labels = slice_arcs(mesh, graph, body[mesh.vertex], *read_arc_tables(source))
    except TooManyCrossingsError as fault:
        raise Rejected(f"no colours: {fault}. Take levels: {{refine: feature}}.") from None
    table, labelled = list_face_arcs(mesh, graph, labels, surface, rotation, True)
    with place_whole(target / "arcs.ply") as scratch:
        scratch.write_bytes(coloured_ply(labelled, table, options["by"]))
