"""A graph by height as SVG: every node at its height, arcs side by side."""

from html import escape

import numpy as np

from .flat import list_ticks
from .layout import place_graph
from .marks import MARKS

TOP, BOTTOM, LEFT, RIGHT, TALL = 26, 14, 58, 18, 620  # margins and height, pixels
ROOM, WIDEST, NARROWEST = 400, 46, 9  # for the lanes together, and for one
WIDE = 16  # pixels of a lane, below which marks are smaller, and handles are not numbered
BEND = 0.03  # of the height: over which an arc turns from its node onto its lane
# Marks around (0, 0), of which a page defines each once.
SHAPES = {
    "creation": "M0-6 6 5H-6Z",
    "union": "M-5.2 0a5.2 5.2 0 1 0 10.4 0a5.2 5.2 0 1 0-10.4 0Z",
    "separation": "M0-6.4 6.4 0 0 6.4-6.4 0Z",
    "annihilation": "M0 6 6-5H-6Z",
    "": "M-5-5H5V5H-5Z",
}


def draw_svg(name, graph, hints):
    """Draw a graph by height.

    Parameters
    ----------
    name : str
        Of the graph, which the element is labelled with.
    graph : EmbeddedGraph
    hints : (K,) float64
        Of every node a position across toward which it is drawn.

    Returns
    -------
    str
        An `svg` element. Arc 3 has the attribute ``data-arc="3"``, by its place in the graph, a node ``data-node``,
        and the element tells in ``data-low``, ``data-high`` (heights), ``data-top`` and ``data-bottom`` (pixels)
        how heights lie on it.
    """
    heights = np.array([node["height"] for node in graph.nodes], float)
    low, high = (float(heights.min()), float(heights.max())) if len(heights) else (0.0, 1.0)
    extent = high - low if high > low else 1.0
    tall = TALL - TOP - BOTTOM
    layout = place_graph(heights, graph.ends[:, 0], graph.ends[:, 1], hints, 8 / tall * extent)
    across = np.concatenate([layout.nodes, layout.lanes, [0.0]][: 2 if len(heights) else 3])
    step = float(np.clip(ROOM / (np.ptp(across) + 1), NARROWEST, WIDEST))
    width = LEFT + RIGHT + step * (np.ptp(across) + 1)
    left = LEFT + step / 2 - step * across.min()
    column, lane = left + step * layout.nodes, left + step * layout.lanes
    row = TOP + tall * (high - heights) / extent
    body = _draw_axis(low, high, extent, width)
    body += [_draw_arc(k, column, row, lane[k], pair) for k, pair in enumerate(graph.ends.tolist())]
    scale = min(step / WIDE, 1.0)
    kind = "flat wide" if width > LEFT + RIGHT + ROOM + WIDEST else "flat"
    body += [_draw_node(k, node, column[k], row[k], scale) for k, node in enumerate(graph.nodes)]
    return (
        f'<svg class="{kind}" data-graph="{name}" role="img" aria-label="{name.replace("_", ", ")} graph by height: '
        f'{len(heights)} nodes, {len(graph.ends)} arcs" width="{width:.0f}" height="{TALL}" '
        f'viewBox="0 0 {width:.0f} {TALL}" data-low="{low!r}" data-high="{high!r}" data-top="{TOP}" '
        f'data-bottom="{TALL - BOTTOM}">{"".join(body)}</svg>'
    )


def define_marks():
    """Define the marks of nodes, once per page: an `svg` element that shows nothing."""
    shapes = "".join(f'<path id="mark-{name or "other"}" d="{path}"/>' for name, path in SHAPES.items())
    return f'<svg width="0" height="0" class="unseen" aria-hidden="true"><defs>{shapes}</defs></svg>'


def draw_mark(operation, side, place="", more=""):
    """Draw the mark of an operation and side: a `use` element; `place` and `more` are attributes of it."""
    name = operation if operation in MARKS else ""
    side = "B" if side == "B" else "A"
    return f'<use href="#mark-{name or "other"}" class="mark {name or "other"} {side}"{place}{more}/>'


def _draw_axis(low, high, extent, width):
    """Grid lines with heights, and the line of the level that is shown."""
    values, texts = list_ticks(low - 0.01 * extent, low + 1.01 * extent)
    rows = TOP + (TALL - TOP - BOTTOM) * (low + extent - values) / extent
    lines = [
        f'<path class="grid" d="M{LEFT - 4} {y:.1f}H{width:.0f}"/><text x="{LEFT - 8}" y="{y + 3.5:.1f}">{text}</text>'
        for y, text in zip(rows.tolist(), texts)
    ]
    return [*lines, f'<path class="level" d="M{LEFT - 4} {TOP}H{width:.0f}"/>']


def _draw_arc(number, column, row, lane, pair):
    """One arc: from its lower node in a quarter of an ellipse onto its lane, up, and off it to its upper node."""
    (x0, x1), (y0, y1) = column[pair].tolist(), row[pair].tolist()
    reach = min(BEND * TALL, 0.5 * (y0 - y1))
    path = f"M{x0:.1f} {y0:.1f}"
    if abs(lane - x0) < 0.05 and abs(lane - x1) < 0.05:
        path += f"V{y1:.1f}"
    else:
        on, off = f"{int(lane < x0)} {lane:.1f} {y0 - reach:.1f}", f"{int(x1 > lane)} {x1:.1f} {y1:.1f}"
        path += (
            f"A{abs(lane - x0):.1f} {reach:.1f} 0 0 {on}V{y1 + reach:.1f}A{abs(lane - x1):.1f} {reach:.1f} 0 0 {off}"
        )
    return f'<path class="arc" data-arc="{number}" d="{path}"/>'


def _draw_node(number, node, x, y, scale):
    """The mark of one node, a ring around it if it stands for several handles, and its number where there is room."""
    place = f' transform="translate({x:.1f} {y:.1f})' + (f' scale({scale:.2f})"' if scale < 1 else '"')
    mark = draw_mark(node.get("operation") or "", node.get("side"), place, f' data-node="{number}"')
    if node.get("n_handles", 1) > 1:
        mark = f'<circle class="ring" cx="{x:.1f}" cy="{y:.1f}" r="{9 * scale:.1f}"/>' + mark
    if scale == 1:
        mark += f'<text class="number" x="{x + 8:.1f}" y="{y - 6:.1f}">{escape(str(node.get("handle", "")))}</text>'
    return mark
