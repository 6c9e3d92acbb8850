"""Draw every model with its loops, circles around and closed paths: `loops.png`."""

import numpy as np

from corpus.storage import read_table
from corpus.surfaces import read_faces, read_points, read_rotation
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.loops import draw_loops
from reebslice.graphs.loop_tables import loops_of_table

OUTPUTS = ("loops.png",)


def main(source, target, options):
    """Draw the loops of the model in folder `source` into folder `target`.

    options : those of `draw`.
    """
    points, turn = read_points(source), np.transpose(read_rotation(source))
    loops = loops_of_table(read_table(source / "loops.parquet", "loops"))
    loops = loops._replace(centre=loops.centre @ turn, circles=[circle @ turn for circle in loops.circles])
    image = draw_loops(source.name, points @ turn, read_faces(source), loops, options)
    (target / "loops.png").write_bytes(encode_png(image))
