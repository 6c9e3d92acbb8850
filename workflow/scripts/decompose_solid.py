"""Take the solid apart at its events: `parts`, and the closed meshes as `parts.glb`."""

from corpus.storage import write_table
from corpus.whole_files import place_whole
from label_faces import label_model
from reebslice.drawing.arc_colours import coloured_scene
from reebslice.graphs.decomposition import labelled_bodies, parts_table

OUTPUTS = ("parts.parquet", "parts.glb")


def main(source, target, options):
    """Take the model in folder `source` apart, write the parts to folder `target`.

    options : `method`, that of `edges`.
    """
    model = label_model(source, options["method"], "no parts")
    bodies = labelled_bodies(model.mesh, model.labels, model.surface[0], model.rotation)
    write_table(target / "parts.parquet", "parts", parts_table(bodies, model.rotation))
    with place_whole(target / "parts.glb") as scratch:
        scratch.write_bytes(coloured_scene(bodies))
