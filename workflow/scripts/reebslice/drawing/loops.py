"""A still picture of loops: circles around and closed paths that shine through the surface, as through glass."""

import itertools

import numpy as np

from .canvas import Words, draw_lines, draw_marks, measure_text, new_canvas, rgb, write_words
from .marks import INK, SOFT
from .rasters import rasterize_mesh, widest_azimuth
from .shading import shade_layers
from .views import fit_view, project_points

# Colours of Okabe and Ito, told apart by the colour-blind.
INKS = {"handle": "#D55E00", "tunnel": "#0072B2", "mixed": "#A3246E"}
WORDS = {"handle": "fill the circle with material", "tunnel": "fill it with void", "mixed": "neither side fills it"}


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
        width (pixels), azimuth (degrees, or None for the largest silhouette) and elevation (degrees).

    Returns
    -------
    (height, width, 3) uint8
        The picture is as high as wide. Circles around are thick, closed paths thin, nothing hides them.
    """
    width = int(options.get("width", 800))
    canvas = new_canvas(width, width, width / 432)
    azimuth, elevation = options.get("azimuth"), float(options.get("elevation", 15))
    azimuth = widest_azimuth(points, faces, elevation) if azimuth is None else float(azimuth)
    view = fit_view(points, azimuth, elevation, width, width, margin=0.12)
    fine = view._replace(width=2 * width, height=2 * width, scale=2 * view.scale)
    jump = 0.012 * float(np.ptp(points, axis=0).max())
    canvas.image[:] = shade_layers(rasterize_mesh(points, faces, fine), jump, 2)
    inks = np.array([rgb(INKS[kind]) for kind in loops.kind]).reshape(-1, 3)
    start, member = loops.paths
    paths = [points[member[a:b]] for a, b in itertools.pairwise(start)]
    for curves, thickness in ((paths, 1.3), (loops.circles, 3.0)):
        closed = [project_points(np.vstack([curve, curve[:1]]), view)[:, :2] for curve in curves]
        draw_lines(canvas, closed, inks, thickness)
    counts = {kind: loops.kind.tolist().count(kind) for kind in INKS if kind in loops.kind}
    write_words(canvas, [Words(name, (0.04 * width, 0.05 * width), 13, INK, bold=True), *_legend(canvas, counts)])
    return canvas.image


def _legend(canvas, counts):
    """A mark and words for each kind that there is, in a row at the bottom."""
    words, left, y = [], 0.04 * canvas.image.shape[1], canvas.image.shape[0] - 16 * canvas.unit
    for kind, count in counts.items():
        draw_marks(canvas, [(left + 5 * canvas.unit, y)], "s", 8, rgb(INKS[kind]), 0.5, rgb(INKS[kind]))
        text = f"{kind} ({count:,}): {WORDS[kind]}"
        words.append(Words(text, (left + 12 * canvas.unit, y), 8.5, SOFT))
        left += 24 * canvas.unit + measure_text(canvas, text, 8.5)
    return words
