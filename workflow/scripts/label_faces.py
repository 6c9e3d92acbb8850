"""Tell on which arcs each face lies: `face_arcs`."""

from typing import NamedTuple

from corpus.stages import Rejected
from corpus.storage import write_table
from corpus.surfaces import read_arc_tables, read_faces, read_points, read_rotation, read_shells
from reebslice.errors import TooManyCrossingsError
from reebslice.graphs.arc_labels import slice_arcs
from reebslice.graphs.face_labels import list_face_arcs
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph

OUTPUTS = ("face_arcs.parquet",)


class LabelledModel(NamedTuple):
    """A model with its arcs: its mesh in order of height, graph and arc labels of that; points and faces; rotation."""

    mesh: object
    graph: object
    labels: object
    surface: tuple
    rotation: object


def label_model(source, method, refused):
    """Return the model in folder `source` as a :class:`LabelledModel`.

    `method` is that of `edges`. Where it tells of no faces, or there are too
    many arcs, the model is rejected; the sentence begins with `refused`.
    """
    if method != "exact":
        raise Rejected(f"{refused}: arcs of faces take edges: {{method: exact}}, since guessed links tell of no faces.")
    surface, rotation = (read_points(source), read_faces(source)), read_rotation(source)
    mesh = height_mesh(*surface, rotation)
    graph, body = surface_reeb_graph(mesh), read_shells(source, len(surface[0]))[1]
    try:
        labels = slice_arcs(mesh, graph, body[mesh.vertex], *read_arc_tables(source))
    except TooManyCrossingsError as fault:
        raise Rejected(f"{refused}: {fault}. Take levels: {{refine: feature}}.") from None
    return LabelledModel(mesh, graph, labels, surface, rotation)


def main(source, target, options):
    """Label the faces of the model in folder `source`, write the table to folder `target`.

    options : `cut`, whether faces are cut where arcs end; `method`, that of `edges`.
    """
    model = label_model(source, options["method"], "no arcs of faces")
    table, _ = list_face_arcs(*model[:3], model.surface, model.rotation, options["cut"])
    write_table(target / "face_arcs.parquet", "face_arcs", table)
