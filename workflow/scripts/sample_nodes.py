"""Place a material point in every region of every level: `nodes`."""

from batches import run_batch
from reebslice.nodes import sample_nodes
from storage import read_table, write_table
from surfaces import read_rotation

OUTPUTS = ("nodes.parquet",)


def main(source, target, options):
    """Sample the regions of the model in folder `source`, write the points to folder `target`."""
    contours, pieces, levels = (
        read_table(source / f"{name}.parquet", name) for name in ("contours", "pieces", "levels")
    )
    nodes = sample_nodes(contours, pieces, levels, read_rotation(source), options["sampler"])
    write_table(target / "nodes.parquet", "nodes", nodes)


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)  # noqa: F821
