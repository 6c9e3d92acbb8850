"""Figures of a model as in the paper: critical level sets with their handles, and the links between levels.

They go with figures 3 and 4 of Pareja-Corcho et al.; its figure 6 is :mod:`.picture`.
"""

import numpy as np

from .canvas import Words, draw_lines, draw_marks, rgb, write_words
from .legend import EVENT_WORDS, draw_scale
from .marks import INK, MARKS, SOFT, mark_style
from .model import unpack_contours
from .page_words import format_figure
from .picture import arrange, draw_body
from .titles import write_title
from .views import project_points

GREY = "#9AA3AE"
MOST = 16  # events in the figure of the critical level sets, whose words are one below the other


def choose_events(handles, graph, contours, geometry):
    """Choose the events whose level sets are drawn: of the nodes of a graph the most persistent.

    Parameters
    ----------
    handles : pyarrow.Table
    graph : Graph
    contours : pyarrow.Table
        Without `geometry`.
    geometry : iterable of pyarrow.Array
        That column, in blocks.

    Returns
    -------
    events : list of (dict, list of (k, 3) float64)
        At most `MOST` rows of the table, upward, each with the contours right below and above it, tilted frame.
    count : int
        How many there are to choose from.
    """
    shown = {data["handle"] for data in graph.nodes.values()}
    found = [row for row in handles.to_pylist() if row["handle"] in shown]
    rows = sorted(sorted(found, key=lambda row: -row["persistence"])[:MOST], key=lambda row: row["handle"])
    wanted = sorted({contour for row in rows for contour in row["contours_below"] + row["contours_above"]})
    curves = dict(zip(wanted, unpack_contours(contours, geometry, np.array(wanted, int))))
    return [(row, [curves[c] for c in row["contours_below"] + row["contours_above"]]) for row in rows], len(found)


def paint_levels(canvas, title, body, chosen, options):
    """Draw the contours that each event changes, and what it does.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    title : Title
    body : Body
    chosen : (list of (dict, list of (k, 3) float64), int)
        As :func:`choose_events` returns them.
    options : dict
        As for :func:`.picture.draw_model`.

    Returns
    -------
    Canvas
        The same.
    """
    (height, width), unit = canvas.image.shape[:2], canvas.unit
    view, corner, panel = arrange(width, height, body, options)
    draw_body(canvas, corner, view, body)
    words = write_title(title, width, height)
    events, count = chosen
    some = f"{count} events" if len(events) == count else f"the {len(events)} most persistent of {count} events"
    told = f"Critical level sets, right below and above each of {some}"
    words.append(Words(told, (panel.left, panel.top - 12 * unit), 8.5, INK))
    rows = np.linspace(panel.top + panel.height, panel.top, len(events) + 2)[1:-1]
    for (handle, curves), row in zip(events, rows):
        ink = rgb(MARKS[handle["operation"]][1])
        seen = [project_points(curve, view)[:, :2] + corner for curve in curves]
        draw_lines(canvas, seen, ink, 1.4)
        spot = project_points(np.array([[handle[axis] for axis in "xyz"]]) @ body.rotation.T, view)[0, :2] + corner
        ends = np.concatenate([*seen, spot[None]])
        start, stop = ends[np.argmax(ends[:, 0])], np.array([panel.left, row])
        draw_lines(canvas, [np.array([start, stop])], rgb(GREY), 0.5)
        draw_marks(canvas, [spot], **mark_style(handle["operation"], handle["side"], 7))
        words += _tell_event(handle, panel.left, row, unit, title.unit)
    words += draw_scale(canvas, view, corner, title.unit)
    write_words(canvas, words)
    return canvas


def _tell_event(handle, left, row, unit, length):
    """A line of words about an event, and a smaller one below it."""
    operation, side = handle["operation"], handle["side"]
    first = f"{handle['handle']}  {operation}: {handle['index']}-handle"
    ends = [end or "nothing" for end in (handle["change"] or "").split("->")]
    change = " \u2192 ".join(ends) if len(ends) > 1 else "several contours"
    happens = EVENT_WORDS.get((operation, side), "")
    height = format_figure(handle["height"], length)
    second = f"{happens} (side {side}), {change}, at height {height}"
    return [
        Words(first, (left + 5 * unit, row - 4.5 * unit), 9, MARKS[operation][1], bold=True),
        Words(second, (left + 5 * unit, row + 5.5 * unit), 7.5, SOFT),
    ]


def paint_links(canvas, title, body, links, options):
    """Draw the material points of all levels and the links between them.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    title : Title
    body : Body
    links : dict
        Of the tables: `points` (R, 3) float64, model frame, `critical` (R,) bool, `pairs` (E, 2) int, `operations`
        (E,) of the edges.
    options : dict
        As for :func:`.picture.draw_model`.

    Returns
    -------
    Canvas
        The same.
    """
    (height, width), unit = canvas.image.shape[:2], canvas.unit
    view, corner, panel = arrange(width, height, body, options)
    draw_body(canvas, corner, view, body)
    seen = project_points(links["points"] @ body.rotation.T, view)[:, :2] + corner
    operations, pairs = np.array(links["operations"], object), np.reshape(links["pairs"], (-1, 2))
    kinds = [("continuation", INK), *((name, MARKS[name][1]) for name in MARKS if name)]
    words, row = write_title(title, width, height), panel.top + 0.2 * panel.height
    words.append(Words("Links between levels", (panel.left, panel.top - 12 * unit), 8.5, INK))
    for name, ink in kinds:
        own = pairs[operations == name]
        draw_lines(canvas, [seen[pair] for pair in own], rgb(ink), 1.0 if name == "continuation" else 2.4)
        if len(own):
            draw_lines(canvas, [np.array([[panel.left, row], [panel.left + 18 * unit, row]])], rgb(ink), 2.0)
            words.append(Words(_tell_edges(name, len(own)), (panel.left + 24 * unit, row), 9, INK))
            row += 16 * unit
    critical = np.asarray(links["critical"], bool)
    for chosen, size, face in ((~critical, 1.6, SOFT), (critical, 4.0, "#FFFFFF")):
        draw_marks(canvas, seen[chosen], "o", size, rgb(INK), 0.6, rgb(face))
    for text, size, face in (
        (f"v: {critical.sum():,} material points next to an event", 6.0, "#FFFFFF"),
        (f"p: {(~critical).sum():,} material points of other levels", 2.4, SOFT),
    ):
        row += 16 * unit
        draw_marks(canvas, [(panel.left + 9 * unit, row)], "o", size, rgb(INK), 0.6, rgb(face))
        words.append(Words(text, (panel.left + 24 * unit, row), 9, INK))
    words += draw_scale(canvas, view, corner, title.unit)
    write_words(canvas, words)
    return canvas


def _tell_edges(operation, count):
    """What edges of an operation are, in words."""
    if operation == "continuation":
        return f"{count:,} edges: nothing happens in between"
    index = {"creation": "0-handle", "annihilation": "2-handle"}.get(operation, "1-handle")
    return f"{count:,} edges of a {index}: {operation}"
