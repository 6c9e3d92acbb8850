"""A still picture of loops: circles around and closed paths that shine through the surface, as through glass."""

import itertools

import numpy as np

from .canvas import draw_lines, rgb
from .glass import draw_glass, write_legend, write_numbers
from .views import project_points

# Colours of Okabe and Ito, told apart by the colour-blind.
INKS = {"handle": "#D55E00", "tunnel": "#0072B2", "mixed": "#A3246E"}
MOST_PATHS = 24  # of more, closed paths would hide where the loops are
WORDS = {
    "handle": "a bar: cut there, it is open",
    "tunnel": "a hole: plugged there, it is closed",
    "mixed": "neither the one nor the other",
}


def draw_loops(name, points, faces, loops, options):
    """Draw a surface with its loops.

    Parameters
    ----------
    name : str
        Written at the top.
    points, faces : (n, 3) float64 and (m, 3) int
        The surface in the tilted frame, height up.
    loops : Loops
        Of the surface, in the same frame.
    options : dict
        width (pixels), azimuth (degrees, or None for the largest silhouette) and elevation (degrees, or
        None for what suits the model).

    Returns
    -------
    (height, width, 3) uint8
        The picture is as high as wide. Circles around are thick, closed paths, of no more than `MOST_PATHS` loops,
        thin, nothing hides them. Numbers beside the circles are rows of the table `loops`.
    """
    canvas, view, *_ = draw_glass(points, faces, options)
    inks = np.array([rgb(INKS[kind]) for kind in loops.kind]).reshape(-1, 3)
    start, member = loops.paths
    paths = [points[member[a:b]] for a, b in itertools.pairwise(start)]
    drawn = [(paths, 1.3)] * (len(paths) <= MOST_PATHS) + [(loops.circles, 3.0)]
    for curves, thickness in drawn:
        closed = [project_points(np.vstack([curve, curve[:1]]), view)[:, :2] for curve in curves]
        draw_lines(canvas, closed, inks, thickness)
    note = "" if len(drawn) > 1 else f"; closed paths of more than {MOST_PATHS} are not drawn"
    write_numbers(canvas, view, list(range(len(loops.circles))), loops.circles, note)
    write_legend(canvas, name, loops.kind.tolist(), INKS, WORDS)
    return canvas.image
