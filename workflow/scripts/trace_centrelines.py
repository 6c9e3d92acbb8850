"""Trace the centrelines of tubes: points and branches as tables, as poly data, and as a tree in SWC."""

from corpus.stages import Rejected
from corpus.storage import read_json, write_json, write_table, write_text
from corpus.surfaces import read_faces, read_points
from reebslice.errors import ReebsliceError
from reebslice.functions.geodesic import geodesic_distance
from reebslice.graphs.centreline_files import centreline_paths, centreline_tables, centreline_tree, count_centrelines
from reebslice.graphs.centrelines import find_centrelines

OUTPUTS = (
    "centreline_points.parquet",
    "branches.parquet",
    "centrelines.vtp",
    "centrelines.swc",
    "centrelines.json",
)


def main(source, target, options):
    """Trace the centrelines of the model in folder `source`, write them to folder `target`.

    options : `distance` between contours, a part of the greatest geodesic distance; `prune`.
    """
    points, faces = read_points(source), read_faces(source)
    try:
        values = geodesic_distance(points, faces)
        lines = find_centrelines(points, faces, options["distance"] * values.max(), values, options["prune"])
    except ReebsliceError as fault:
        raise Rejected(f"no centrelines: {fault}") from None
    inspection = read_json(source / "inspection.json")
    counts = count_centrelines(lines)
    if counts["loops"] != inspection["genus"]:
        raise ValueError(f"the centrelines have {counts['loops']} loops, not one for each of the genus")
    about = {"model": source.name, "unit": inspection["unit"] or ""}
    for name, table in zip(("centreline_points", "branches"), centreline_tables(lines), strict=True):
        write_table(target / f"{name}.parquet", name, table)
    write_text(target / "centrelines.vtp", centreline_paths(lines, about))
    swc, cuts = centreline_tree(lines, about)
    write_text(target / "centrelines.swc", swc)
    write_json(target / "centrelines.json", {"centrelines": counts, "cuts": cuts})
