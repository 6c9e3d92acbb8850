"""A small picture of a model, for lists of many."""

import io

import numpy as np
from PIL import Image

from .canvas import new_canvas
from .picture import draw_in_body
from .rasters import choose_angles
from .views import fit_view

WIDTH, HEIGHT = 192, 144  # pixels
UNIT = 0.8  # pixels in a point: lines and marks are finer than their share, and still seen
COLOURS = 64  # of a thumbnail, a third of the bytes that all of them would take


def draw_thumbnail(body, graph, paths, options):
    """Draw a model with its graph inside, small and without words.

    Parameters
    ----------
    body, graph, paths, options
        As for :func:`picture.draw_model`; `width` does not count.

    Returns
    -------
    bytes
        A PNG file of 192 x 144 pixels.
    """
    canvas = new_canvas(WIDTH, HEIGHT, UNIT)
    view = fit_view(body.points, **choose_angles(body.points, body.faces, options), width=WIDTH, height=HEIGHT)
    draw_in_body(canvas, np.zeros(2, int), view, body, graph, paths)
    file = io.BytesIO()
    Image.fromarray(canvas.image).quantize(COLOURS, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
    return file.getvalue()
