"""Place a material point in every region of every level: `nodes`."""

from corpus.storage import read_blocks, read_table, write_table
from corpus.surfaces import read_rotation
from reebslice.graphs.nodes import sample_nodes
from reebslice.slicing.tables import contour_curves

OUTPUTS = ("nodes.parquet",)


def main(source, target, options):
    """Sample the regions of the model in folder `source`, write the points to folder `target`."""
    pieces, levels = (read_table(source / f"{name}.parquet", name) for name in ("pieces", "levels"))
    contours = read_table(source / "contours.parquet", "contours", without=("geometry",))
    curves = contour_curves(contours, read_blocks(source / "contours.parquet", "contours", "geometry"))
    nodes = sample_nodes(contours, curves, pieces, levels, read_rotation(source), options["sampler"])
    write_table(target / "nodes.parquet", "nodes", nodes)
