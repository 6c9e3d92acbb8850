"""Choose the direction of the height: `tilt.json`."""

from batches import run_batch
from reebslice.tilts import select_tilt
from storage import write_json
from surfaces import read_faces, read_points

OUTPUTS = ("tilt.json",)


def main(source, target, options):
    """Choose the tilt of the model in folder `source`, write it to folder `target`."""
    record = select_tilt(read_points(source), read_faces(source), **options)
    write_json(target / "tilt.json", record)


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)  # noqa: F821
