"""Classify the Morse events between the levels: `handles`."""

from batches import run_batch
from reebslice.handles import classify_handles
from storage import read_table, write_table
from surfaces import read_height_mesh, read_points

OUTPUTS = ("handles.parquet",)


def main(source, target, options):
    """Classify the events of the model in folder `source`, write them to folder `target`."""
    pieces = read_table(source / "pieces.parquet", "pieces")
    contours = read_table(source / "contours.parquet", "contours")
    handles = classify_handles(read_height_mesh(source), read_points(source), pieces, contours)
    write_table(target / "handles.parquet", "handles", handles)


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)  # noqa: F821
