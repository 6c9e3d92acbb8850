"""Colour the surface by the arcs that it lies on, cut where they end: `arcs.ply`."""

from corpus.whole_files import place_whole
from label_faces import label_model
from reebslice.drawing.arc_colours import coloured_ply
from reebslice.graphs.face_labels import list_face_arcs

OUTPUTS = ("arcs.ply",)


def main(source, target, options):
    """Colour the model in folder `source`, write the file to folder `target`.

    options : `by`, the graph whose arcs have colours; `method`, that of `edges`.
    """
    model = label_model(source, options["method"], "no colours")
    table, labelled = list_face_arcs(*model[:3], model.surface, model.rotation, True)
    with place_whole(target / "arcs.ply") as scratch:
        scratch.write_bytes(coloured_ply(labelled, table, options["by"]))
