"""Find where liquid stays, where air is caught and what begins in the air: `pockets`, `islands`, and their sums."""

import numpy as np

from corpus.stages import Rejected
from corpus.storage import read_table, write_json, write_table
from corpus.surfaces import read_faces, read_points, read_rotation, read_shells
from reebslice.errors import TooManyCrossingsError
from reebslice.graphs.pocket_tables import pockets_table, sum_pockets
from reebslice.graphs.pockets import find_islands, find_pockets
from reebslice.morse.height_mesh import height_mesh

OUTPUTS = ("pockets.parquet", "islands.parquet", "pockets.json")


def main(source, target, options):
    """Find pockets and islands of the model in folder `source`, write them to folder `target`."""
    points = read_points(source)
    mesh = height_mesh(points, read_faces(source), read_rotation(source))
    shell, body = read_shells(source, len(points))
    handles = read_table(source / "handles.parquet", "handles")
    height = np.ptp(read_table(source / "critical_points.parquet", "critical_points")["height"].to_numpy())
    depth = options["least_depth"] * float(np.linalg.norm(np.ptp(points, axis=0)))
    distance = options["distance"] * height or None
    try:
        pockets = find_pockets(mesh, least_depth=depth, distance=distance)
        islands = find_islands(mesh, body_of_vertex=body, least_depth=depth, distance=distance)
    except TooManyCrossingsError as fault:
        raise Rejected(
            f"no pockets were looked for: {fault}. Take a larger pockets.distance or pockets.least_depth."
        ) from None
    write_table(target / "pockets.parquet", "pockets", pockets_table("pockets", pockets, handles, points, shell))
    write_table(target / "islands.parquet", "islands", pockets_table("islands", islands, handles, points, shell))
    write_json(target / "pockets.json", sum_pockets(pockets, islands))
