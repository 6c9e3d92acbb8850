"""Pictures as SVG and PDF: the shaded body as pixels, lines, marks and words as such."""

import io
import itertools

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

ALIGNED = {"l": "left", "m": "center", "r": "right"}
RAISED = {"m": "center", "s": "baseline"}


def encode_vectors(canvas, form):
    """Encode a canvas whose strokes were kept.

    Parameters
    ----------
    canvas : Canvas
        With `strokes`.
    form : {"svg", "pdf"}

    Returns
    -------
    bytes
        As large as the picture in points. Nothing in them but the picture: no dates and no versions of programs.
        Words stay words, in DejaVu Sans, in PDF embedded.
    """
    height, width, _ = canvas.image.shape
    figure = Figure(figsize=(width / canvas.unit / 72, height / canvas.unit / 72))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(height, 0))
    axes.set_axis_off()
    axes.imshow(canvas.image, extent=(0, width, height, 0), interpolation="none", aspect="auto", zorder=0)
    draw = {"segments": _draw_segments, "marks": _draw_marks, "words": _draw_words}
    for order, (what, arguments) in enumerate(canvas.strokes):
        draw[what](axes, order + 1, arguments)
    data, nothing = io.BytesIO(), {"svg": ("Creator", "Date"), "pdf": ("Creator", "Producer", "CreationDate")}
    settings = {"svg.hashsalt": "reebslice", "svg.fonttype": "none", "pdf.fonttype": 42, "font.family": "DejaVu Sans"}
    with matplotlib.rc_context(settings):
        figure.savefig(data, format=form, metadata=dict.fromkeys(nothing[form]), dpi=72 * canvas.unit)
    return data.getvalue()


def _draw_segments(axes, order, arguments):
    """Groups of segments (k, 4), one over the other; neighbours that look the same go together."""
    groups, colours, widths, opacity = arguments
    inks = np.broadcast_to(np.asarray(colours, float) / 255, (len(groups), 3)).tolist()
    thick = np.broadcast_to(np.asarray(widths, float), len(groups)).tolist()
    for (ink, width), run in itertools.groupby(zip(groups, inks, thick), key=lambda drawn: drawn[1:]):
        lines = LineCollection(
            [line for group, *_ in run for line in _join_segments(group)],
            colors=[(*ink, opacity)], linewidths=width, capstyle="round", joinstyle="round", zorder=order,
        )  # fmt: skip
        axes.add_collection(lines, autolim=False)


def _join_segments(group):
    """Lines (k, 2) of a group of segments: one where each begins at the end of that before."""
    pairs = np.reshape(group, (-1, 2, 2))
    chained = len(pairs) > 0 and (pairs[1:, 0] == pairs[:-1, 1]).all()
    return [np.vstack([pairs[:1, 0], pairs[:, 1]])] if chained else list(pairs)


def _draw_marks(axes, order, arguments):
    """Marks of one shape."""
    places, shape, size, edge, edge_width, face = arguments
    x, y = np.reshape(np.asarray(places, float), (-1, 2)).T
    filled = "none" if face is None else tuple(face / 255)
    axes.plot(x, y, shape, ms=size, mec=tuple(edge / 255), mew=edge_width, mfc=filled, zorder=order)


def _draw_words(axes, order, words):
    """Lines of text."""
    for line in words:
        halo = [withStroke(linewidth=2 * line.halo, foreground="white")] if line.halo else []
        axes.text(
            *line.place,
            line.text,
            size=line.size,
            color=line.colour,
            ha=ALIGNED[line.anchor[0]],
            va=RAISED[line.anchor[1]],
            weight="bold" if line.bold else "normal",
            path_effects=halo,
            zorder=order,
            parse_math=False,
        )
