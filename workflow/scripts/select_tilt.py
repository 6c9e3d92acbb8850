"""Choose the direction of the height: `tilt.json`."""

from corpus.storage import write_json
from corpus.surfaces import read_faces, read_points
from reebslice.tilt.choice import select_tilt

OUTPUTS = ("tilt.json",)


def main(source, target, options):
    """Choose the tilt of the model in folder `source`, write it to folder `target`."""
    record = select_tilt(read_points(source), read_faces(source), **options)
    write_json(target / "tilt.json", record)
