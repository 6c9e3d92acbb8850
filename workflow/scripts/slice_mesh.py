"""Cut the surface into level sets and slab pieces: `levels`, `contours`, `unfoldings`, `pieces`."""

import numpy as np

from corpus.stages import Rejected
from corpus.storage import write_blocks, write_table
from corpus.surfaces import read_faces, read_points, read_rotation, read_shells
from reebslice.errors import TooManyCrossingsError
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.unfolding import unfoldings_table
from reebslice.slicing.refinement import feature_scale, slice_surface
from reebslice.slicing.tables import contours_blocks, levels_table, pieces_table

OUTPUTS = ("levels.parquet", "contours.parquet", "unfoldings.parquet", "pieces.parquet")


def main(source, target, options):
    """Slice the model in folder `source`, write its tables to folder `target`."""
    if options["refine"] == "graphs":
        raise Rejected("There are no levels with levels: {refine: graphs}. Take refine: feature for tables of levels.")
    points = read_points(source)
    mesh = height_mesh(points, read_faces(source), read_rotation(source))
    shell, body = (column[mesh.vertex] for column in read_shells(source, len(points)))
    distance, feature_size = feature_scale(np.ptp(mesh.points[:, 2]), **options)
    try:
        slices, refined = slice_surface(mesh, body, distance, options["refine"], feature_size)
    except TooManyCrossingsError as fault:
        raise Rejected(
            f"{fault}. Take a larger distance between levels, or, if the mesh is noisy, levels: {{refine: feature}}, "
            "which does not tell all of the noise apart, or {refine: graphs}, which does, without levels."
        ) from None
    write_table(target / "levels.parquet", "levels", levels_table(slices, refined))
    write_blocks(target / "contours.parquet", "contours", contours_blocks(mesh, slices, shell))
    write_table(target / "unfoldings.parquet", "unfoldings", unfoldings_table(mesh, slices.levels.below))
    write_table(target / "pieces.parquet", "pieces", pieces_table(mesh, slices, shell))
