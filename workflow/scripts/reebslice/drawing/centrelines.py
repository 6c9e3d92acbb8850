"""A still picture of centrelines, which shine through the surface as through glass."""

import itertools

import numpy as np

from .canvas import draw_lines, rgb
from .glass import draw_glass, write_legend
from .views import project_points

INKS = {"branch": "#0072B2", "closed": "#D55E00"}
WORDS = {"branch": "a branch", "closed": "a branch that closes"}


def draw_centrelines(name, points, faces, lines, options):
    """Draw a surface with its centrelines.

    Parameters
    ----------
    name : str
        Written at the top.
    points, faces : (n, 3) float64 and (m, 3) int
        The surface, drawn with its third coordinate upward.
    lines : Centrelines
        In the same frame.
    options : dict
        As of :func:`.loops.draw_loops`.

    Returns
    -------
    (height, width, 3) uint8
    """
    canvas, view, *_ = draw_glass(points, faces, options)
    paths = [lines.branches.member[a:b] for a, b in itertools.pairwise(lines.branches.start)]
    kinds = ["closed" if path[0] == path[-1] else "branch" for path in paths]
    inks = np.array([rgb(INKS[kind]) for kind in kinds]).reshape(-1, 3)
    draw_lines(canvas, [project_points(lines.points[path], view)[:, :2] for path in paths], inks, 2.5)
    write_legend(canvas, name, kinds, INKS, WORDS)
    return canvas.image
