"""Guess links from shapes at uniform levels, and hold them against the mesh: `comparison`."""

import numpy as np

from corpus.storage import write_table
from corpus.surfaces import read_faces, read_points, read_shells
from reebslice.links.comparison import compare_rules, model_half
from reebslice.morse.height_mesh import height_mesh
from reebslice.schemas import SCHEMAS
from reebslice.slicing.levels import make_levels, uniform_heights
from reebslice.slicing.slices import cut_surface
from reebslice.slicing.tables import contours_table, pieces_table
from reebslice.table_checks import build_table
from reebslice.tilt.choice import select_tilt

OUTPUTS = ("comparison.parquet",)
SEED = 0  # of the random direction


def main(source, target, options):
    """Compare on the model in folder `source`, write the counts to folder `target`.

    options : `levels`, numbers of levels; `tilts`, of "none", "auto" and
    "random".
    """
    points, faces = read_points(source), read_faces(source)
    rows = []
    for tilt in options["tilts"]:
        rotation = choose_rotation(points, faces, tilt)
        mesh = height_mesh(points, faces, rotation)
        shell, body = (column[mesh.vertex] for column in read_shells(source, len(points)))
        for count in options["levels"]:
            same = {"model": source.name, "half": model_half(source.name), "tilt": tilt, "n_levels": count}
            low, high = mesh.points[[0, -1], 2]
            slices = cut_surface(mesh, make_levels(mesh, uniform_heights(low, high, (high - low) / count)), body)
            tables = contours_table(mesh, slices, shell), pieces_table(mesh, slices, shell)
            rows += [{**same, **row} for row in compare_rules(*tables)]
    columns = {field.name: [row[field.name] for row in rows] for field in SCHEMAS["comparison"]}
    write_table(target / "comparison.parquet", "comparison", build_table("comparison", columns))


def choose_rotation(points, faces, tilt):
    """Rotation to the tilted frame, (3, 3); a random direction is any of the sphere, one for all models."""
    if tilt == "random":
        record = select_tilt(points, faces, "direction", np.random.default_rng(SEED).normal(size=3))
    else:
        record = select_tilt(points, faces, tilt)
    return np.array(record["rotation"])
