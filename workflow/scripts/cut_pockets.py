"""Cut pockets and islands out as closed bodies: `pockets.glb`, and a picture of them, `pockets.png`."""

import numpy as np

from corpus.stages import Rejected
from corpus.storage import read_json, read_table
from corpus.surfaces import read_faces, read_points, read_rotation
from corpus.whole_files import place_whole
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.pockets import draw_pockets, pockets_scene
from reebslice.errors import ReebsliceError
from reebslice.graphs.bodies import pocket_bodies
from reebslice.graphs.pocket_tables import pockets_of_table

OUTPUTS = ("pockets.glb", "pockets.png")


def main(source, target, options):
    """Cut the pockets of the model in folder `source` out, write them to folder `target`.

    options : those of `draw`.
    """
    points, faces, rotation = read_points(source), read_faces(source), read_rotation(source)
    bodies, kinds, ids = [], [], []
    for name in ("pockets", "islands"):
        found = pockets_of_table(read_table(source / f"{name}.parquet", name))
        try:
            bodies += pocket_bodies(points, faces, found, rotation)
        except ReebsliceError as fault:
            raise Rejected(f"{name} were not cut out: {fault}") from None
        kinds += found.kind.tolist()
        ids += range(len(found.kind))
    with place_whole(target / "pockets.glb") as scratch:
        scratch.write_bytes(pockets_scene(bodies, kinds, ids))
    upright = [(spots @ np.transpose(rotation), corners) for spots, corners in bodies]
    told = read_json(source / "inspection.json")
    crosses = told["self_crossings"] or told["body_crossings"]
    title = f"{source.name}: not certain, the surface crosses itself" if crosses else source.name
    image = draw_pockets(title, points @ np.transpose(rotation), faces, upright, kinds, options)
    (target / "pockets.png").write_bytes(encode_png(image))
