"""The drawing of a graph by height, or by the order of heights: arcs side by side."""

from typing import NamedTuple

import numpy as np

from .canvas import Words, draw_lines, rgb
from .layout import place_graph, trace_arc
from .marks import CASED, INK, SOFT, draw_nodes, mark_size

SHARE = 0.75  # of the steps from event to event that are too small for marks, beyond which the order is drawn


class Panel(NamedTuple):
    """A part of the picture, in pixels."""

    left: float
    top: float
    width: float
    height: float


def draw_flat(canvas, panel, marks, seen, ends):
    """Draw a graph by height, lanes ordered as in the body where nothing else decides.

    Where most events are nearer to the next than their marks are high, as in
    flat parts, they are drawn one above the other in their order instead.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    panel : Panel
    marks : list of dict
        Attributes of the nodes, height among them.
    seen : (k, 2) float64
        Places of the nodes in the body.
    ends : (m, 2) int
        Lower and upper node of every arc.

    Returns
    -------
    places : (k, 2) float64
        Column and row of the nodes.
    words : list of Words
        Those of the axis.
    """
    told = np.array([mark["height"] for mark in marks], float)
    size = mark_size(len(marks))
    in_order = is_crowded(told, size * canvas.unit / panel.height)
    heights = np.unique(told, return_inverse=True)[1].astype(float) if in_order else told
    extent = float(np.ptp(heights)) if len(heights) else 0.0
    extent, low = extent if extent > 0 else 1.0, heights.min() if len(heights) else 0.0
    layout = place_graph(heights, ends[:, 0], ends[:, 1], seen[:, 0], size / 660 * extent)
    across = np.concatenate([layout.nodes, layout.lanes, [0.0]][: 2 if len(marks) else 3])
    middle, half = (across.min() + across.max()) / 2, max(np.ptp(across) * 0.54, 1.6)
    origin = np.array([panel.left + panel.width / 2, panel.top + panel.height * 1.04 / 1.08])
    scale = np.array([panel.width / (2 * half), -panel.height / (1.08 * extent)])

    def place(points):
        return origin + (points - [middle, low]) * scale

    values, texts = list_ranks(told) if in_order else list_ticks(low - 0.04 * extent, low + 1.04 * extent)
    labels = _draw_axis(canvas, panel, place, values, texts, "height, not to scale" if in_order else "height")
    spots = np.column_stack([layout.nodes, heights])
    arcs = zip(ends, layout.lanes, strict=True)
    lines = [place(trace_arc(spots[i], spots[j], lane, 0.03 * extent)) for (i, j), lane in arcs]
    thick = 1.5 if len(lines) <= 60 else 1.0 if len(lines) <= CASED else 0.5
    draw_lines(canvas, lines, rgb(INK), thick, opacity=1.0 if len(lines) <= 2000 else 0.35)
    draw_nodes(canvas, marks, place(spots))
    return place(spots), labels


def is_crowded(heights, step):
    """Tell whether most events are too near to the next to be told apart by their heights.

    Parameters
    ----------
    heights : (n,) float64
    step : float
        How high a mark is, as a part of the range of heights.

    Returns
    -------
    bool
        False of fewer than four heights.
    """
    found = np.unique(heights)
    return len(found) > 3 and float(np.mean(np.diff(found) < step * np.ptp(found))) > SHARE


def list_ranks(heights, most=10):
    """Choose heights for an axis on which they are one above the other, evenly.

    Parameters
    ----------
    heights : (n,) float64
    most : int

    Returns
    -------
    values : (k,) float64
        At most `most` places in the order of different heights, the lowest and the highest among them.
    texts : list of str
        The heights there.
    """
    found = np.unique(heights)
    values = np.unique(np.linspace(0, len(found) - 1, min(most, len(found))).round())
    return values, [f"{found[int(value)]:.4g}".replace("-", "\u2212") for value in values]


def _draw_axis(canvas, panel, place, values, texts, title):
    """The axis of heights on the left of the panel, and a grid; returns its words, a text for each of the values."""
    rows = np.floor(place(np.column_stack([np.zeros(len(values)), values]))[:, 1]) + 0.5
    left, tick, gap = np.floor(panel.left) + 0.5, 3 * canvas.unit, 6 * canvas.unit
    draw_lines(canvas, [np.array([[left, row], [left + panel.width, row]]) for row in rows], rgb("#E8EBEE"), 0.6)
    ticks = [np.array([[left - tick, row], [left, row]]) for row in rows]
    draw_lines(canvas, [np.array([[left, panel.top], [left, panel.top + panel.height]]), *ticks], rgb(SOFT), 0.8)
    labels = [Words(text, (left - gap, row), 8, SOFT, "rm") for text, row in zip(texts, rows, strict=True)]
    lines = title.split(", ")[::-1]
    return labels + [
        Words(line, (left - gap, panel.top - (1.5 + 1.7 * k) * gap), 8, SOFT, "rm") for k, line in enumerate(lines)
    ]


def list_ticks(low, high, most=10):
    """Choose round numbers for an axis.

    Parameters
    ----------
    low, high : float
    most : int

    Returns
    -------
    values : (k,) float64
        At most `most` round numbers from `low` to `high`, ascending.
    texts : list of str
        The same as text, with as many digits as tell them apart.
    """
    least = (high - low) / (most - 1)
    power = np.floor(np.log10(least))
    factor = next(factor for factor in (1, 2, 2.5, 5, 10) if 10.0**power * factor >= least)
    step, digits = factor * 10.0**power, int(-power) + {2.5: 1, 10: -1}.get(factor, 0)
    values = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1) + 0.0
    largest = np.abs(values).max(initial=step)
    if largest < 1e6 and digits < 6:
        texts = [f"{value:.{max(digits, 0)}f}" for value in values]
    else:
        texts = [f"{value:.{max(digits + int(np.floor(np.log10(largest))), 0)}e}" if value else "0" for value in values]
    return values, [text.replace("e+", "e").replace("-", "\u2212") for text in texts]
