"""What the marks of a graph mean, in words, and the scale bar."""

import numpy as np

from .canvas import Words, draw_lines, draw_marks, measure_text, rgb
from .labels import scale_bar
from .marks import INK, LABELLED, SOFT, group_marks, mark_style, ring_style
from .page_words import SIDE_WORDS
from .verdicts import SYMBOLS

# What happens at each operation and side as the height rises.
EVENT_WORDS = {
    ("creation", "A"): "material begins",
    ("creation", "B"): "a pocket or void opens",
    ("union", "A"): "parts merge",
    ("union", "B"): "a ring opens or holes merge",
    ("separation", "A"): "a ring closes or a hole divides",
    ("separation", "B"): "a part splits",
    ("annihilation", "A"): "a void or hole closes",
    ("annihilation", "B"): "material ends",
}
SIZE = 8.0  # points, of its letters
ROW = 12.0  # points from one row to the next


def draw_legend(canvas, marks):
    """Draw at the bottom of a picture one mark per operation and side that occurs, with what it means.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    marks : list of dict
        Attributes of the nodes.

    Returns
    -------
    list of Words
        Those to be written.
    """
    entries = [
        (f"{operation or 'compound'} {side}: {EVENT_WORDS.get((operation, side), 'several events')} ({len(own):,})",
         mark_style(operation, side, 7))
        for (operation, side), own in group_marks(marks)
    ]  # fmt: skip
    several = sum(mark.get("n_handles", 1) > 1 for mark in marks)
    if several:
        entries.append((f"ring: several events that share a node ({several:,})", ring_style(6)))
    if len(marks) <= LABELLED and any("vertex_x" in mark for mark in marks):
        entries.append(("thin line: to the critical vertex of an event", None))
    rows = 2 if len(entries) <= 8 else 3  # beyond what fits in two
    words, unit, left = _explain_sides(canvas, marks, rows), canvas.unit, 0.018 * canvas.image.shape[1]
    for k in range(0, len(entries), rows):
        for row, (text, style) in enumerate(entries[k : k + rows]):
            y = canvas.image.shape[0] - ROW * (rows - row) * unit
            if style:
                draw_marks(canvas, [(left + 6 * unit, y)], **style)
            else:
                draw_lines(canvas, [np.array([[left + 2 * unit, y], [left + 10 * unit, y]])], rgb(SOFT), 0.5)
            words.append(Words(text, (left + 15 * unit, y), SIZE, INK))
        left += 24 * unit + max(measure_text(canvas, text, SIZE) for text, _ in entries[k : k + rows])
    return words


def _explain_sides(canvas, marks, rows):
    """What filled and hollow marks mean, above the rows of the legend."""
    if not marks:
        return []
    y = canvas.image.shape[0] - ROW * (rows + 1) * canvas.unit
    text = f"filled, side A: {SIDE_WORDS['A']}; hollow, side B: {SIDE_WORDS['B'].split(' as ')[0]}"
    return [Words(text, (0.018 * canvas.image.shape[1] + 2 * canvas.unit, y), SIZE, SOFT)]


def draw_scale(canvas, view, corner, unit):
    """Draw a scale bar at the lower right of a view.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    view : View
    corner : (2,) int
        Column and row of the view's upper left corner in the picture.
    unit : str or None
        Of length; None where the file does not tell it.

    Returns
    -------
    list of Words
        Its length.
    """
    length = scale_bar(view)
    right, bottom = corner[0] + 0.98 * view.width, corner[1] + 0.985 * view.height
    left, tick = right - length * view.scale, 2.5 * canvas.unit
    bar = [(left, bottom - tick), (left, bottom), (right, bottom), (right, bottom - tick)]
    draw_lines(canvas, [np.array(bar)], rgb(SOFT), 1.0)
    word = SYMBOLS.get(unit, unit) if unit else "unit of the mesh" if length == 1 else "units of the mesh"
    text = f"{length:g} {word}"
    return [Words(text, ((left + right) / 2, bottom - 7 * canvas.unit), 7.5, SOFT, "mm", halo=0.8)]
