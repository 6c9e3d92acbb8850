"""Find the place of every loop of the surface: `loops`, their numbers by kind, and the curves as `loops.vtp`."""

import numpy as np

from corpus.stages import Rejected
from corpus.storage import read_table, write_json, write_table, write_text
from corpus.surfaces import read_faces, read_points, read_rotation, read_shells
from reebslice.errors import TooManyCrossingsError
from reebslice.graphs.loop_tables import count_loops, loops_table, loops_text
from reebslice.graphs.loops import find_loops

OUTPUTS = ("loops.parquet", "loops.json", "loops.vtp")


def main(source, target, options):
    """Find the loops of the model in folder `source`, write them to folder `target`."""
    points, rotation = read_points(source), read_rotation(source)
    height = np.ptp(read_table(source / "critical_points.parquet", "critical_points")["height"].to_numpy())
    distance = options["distance"] * height or None  # of a surface without height any will do
    try:
        loops = find_loops(points, read_faces(source), rotation, distance, read_shells(source, len(points))[1])
    except TooManyCrossingsError as fault:
        raise Rejected(f"no loops were looked for: {fault}. Take a larger loops.distance.") from None
    write_table(
        target / "loops.parquet", "loops", loops_table(loops, read_table(source / "handles.parquet", "handles"))
    )
    write_json(target / "loops.json", count_loops(loops))
    write_text(target / "loops.vtp", loops_text(points, loops))
