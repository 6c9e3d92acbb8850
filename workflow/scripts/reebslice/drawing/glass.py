"""What still pictures share that show something inside a surface, as through glass."""

from typing import NamedTuple

import numpy as np

from .canvas import Canvas, Words, draw_marks, measure_text, new_canvas, rgb, write_words
from .labels import spread_labels
from .marks import INK, SOFT
from .rasters import choose_angles, rasterize_mesh
from .shading import shade_layers
from .views import View, fit_view, project_points

FEW = 60  # numbers, beyond which they are written smaller


class Glass(NamedTuple):
    """A picture of a translucent surface, as high as wide.

    Attributes
    ----------
    canvas : Canvas
        With the surface on it.
    view : View
    fine : View
        The same, twice as fine.
    jump : float
        Step of depth that is outlined, mesh units.
    """

    canvas: Canvas
    view: View
    fine: View
    jump: float


def draw_glass(points, faces, options):
    """Draw a translucent surface.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
        The surface in the tilted frame, height up.
    options : dict
        width (pixels), azimuth (degrees, or None for the largest silhouette) and elevation (degrees, or None for
        what suits the model).

    Returns
    -------
    Glass
    """
    width = int(options.get("width", 800))
    canvas = new_canvas(width, width, width / 432)
    view = fit_view(points, **choose_angles(points, faces, options), width=width, height=width, margin=0.12)
    fine = view._replace(width=2 * width, height=2 * width, scale=2 * view.scale)
    jump = 0.012 * float(np.ptp(points, axis=0).max())
    canvas.image[:] = shade_layers(rasterize_mesh(points, faces, fine), jump, 2)
    return Glass(canvas, view, fine, jump)


def write_numbers(canvas, view, numbers, curves, note=""):
    """Write numbers beside what they tell, as far as they cover nothing; say how many there is no room for.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    view : View
    numbers : list of int
        Rows of a table.
    curves : list of (k, 3) float64
        Points of each, in the tilted frame.
    note : str
        Said besides.
    """
    middles = np.array([curve.mean(axis=0) for curve in curves]).reshape(-1, 3)
    spots = project_points(middles, view)[:, :2]
    size = 7.5 if len(numbers) <= FEW else 6.0
    words = spread_labels(canvas, [str(number) for number in numbers], spots, size, INK, 0.55 * size)
    width = canvas.image.shape[1]
    left = len(curves) - len(words)
    told = "numbers are rows of the table" + (f"; no room for {left:,}" if left else "") + note
    words += [Words(told, (0.04 * width, 0.085 * width), 8.5, SOFT)] if len(curves) else []
    write_words(canvas, words)


def write_legend(canvas, name, kinds, inks, words):
    """Write a name at the top, and at the bottom a mark and words for each kind that there is.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    name : str
    kinds : list of str
        Of everything that is shown.
    inks, words : dict of str to str
        Colour, and what is said of a kind, in the order of the legend.
    """
    width = canvas.image.shape[1]
    lines, left, y = (
        [Words(name, (0.04 * width, 0.05 * width), 13, INK, bold=True)],
        0.04 * width,
        width - 16 * canvas.unit,
    )
    for kind in [kind for kind in inks if kind in kinds]:
        draw_marks(canvas, [(left + 5 * canvas.unit, y)], "s", 8, rgb(inks[kind]), 0.5, rgb(inks[kind]))
        text = f"{kind} ({list(kinds).count(kind):,}): {words[kind]}"
        lines.append(Words(text, (left + 12 * canvas.unit, y), 8.5, SOFT))
        left += 24 * canvas.unit + measure_text(canvas, text, 8.5)
    write_words(canvas, lines)
