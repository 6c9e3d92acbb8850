"""Compare directions of height on one model: `directions`."""

import numpy as np

from corpus.stages import Rejected
from corpus.storage import write_table
from corpus.surfaces import read_faces, read_points, read_shells
from reebslice.errors import TooManyCrossingsError
from reebslice.graphs.directions import compare_directions, directions_table

OUTPUTS = ("directions.parquet",)


def main(source, target, options):
    """Compare directions on the model in folder `source`, write the table to folder `target`.

    options : `number`, of directions beside the six axes; `distance` and `least_depth`, as parts of the diagonal of the
    box around the model; `overhang`, in degrees.
    """
    points, faces = read_points(source), read_faces(source)
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    lengths = (options[name] * diagonal for name in ("distance", "least_depth"))
    body = read_shells(source, len(points))[1]
    try:
        found = compare_directions(points, faces, options["number"], *lengths, options["overhang"], body)
    except TooManyCrossingsError as fault:
        raise Rejected(f"no directions compared: {fault}.") from None
    write_table(target / "directions.parquet", "directions", directions_table(source.name, found))
