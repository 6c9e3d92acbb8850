"""The marks of a graph's nodes: one shape and one colour per operation, hollow on side B."""

import numpy as np

from .canvas import draw_marks, rgb

MARKS = {
    "creation": ("^", "#009E73"),
    "union": ("o", "#0072B2"),
    "separation": ("D", "#D55E00"),
    "annihilation": ("v", "#A3246E"),
    "": ("s", "#6B7280"),
}
INK, SOFT, FAR = "#1B1F24", "#5B6470", "#707885"
LABELLED = 60  # nodes, beyond which they have no numbers, and no lines to their vertices
CASED = 400  # arcs, beyond which lines cross without a white casing


def mark_size(count):
    """Points across a mark, falling with the number of nodes."""
    return float(np.clip(26 / max(count, 1) ** 0.36, 1.6, 8.0))


def draw_nodes(canvas, marks, spots):
    """Draw the nodes, dicts with operation, side and maybe n_handles, at `spots` (k, 2), over their rings."""
    size = mark_size(len(marks))
    several = [i for i, mark in enumerate(marks) if mark.get("n_handles", 1) > 1]
    draw_marks(canvas, spots[several], **ring_style(size))
    for style, own in group_marks(marks):
        draw_marks(canvas, spots[own], **mark_style(*style, size))


def group_marks(marks):
    """The operations and sides that occur, in the order of the legend, and the numbers of their marks."""
    own = {(operation, side): [] for operation in MARKS for side in "AB"}
    for i, mark in enumerate(marks):
        operation = mark.get("operation") or ""
        own[operation if operation in MARKS else "", "B" if mark.get("side") == "B" else "A"].append(i)
    return [(style, numbers) for style, numbers in own.items() if numbers]


def mark_style(operation, side, size):
    """Return the keywords of :func:`canvas.draw_marks` for a node of an operation and side."""
    shape, colour = MARKS[operation]
    size, colour, white = size * {"D": 0.82, "s": 0.9}.get(shape, 1.0), rgb(colour), np.full(3, 255.0)
    hollow = {"face": white, "edge": colour, "edge_width": max(0.19 * size, 0.5)}
    filled = {"face": colour, "edge": white, "edge_width": 0.09 * size}
    return {"shape": shape, "size": size, **(filled if side == "A" else hollow)}


def ring_style(size):
    """Return the keywords of :func:`canvas.draw_marks` for the ring around a node that stands for several handles."""
    return {"shape": "o", "size": 1.9 * size, "edge": rgb(INK), "edge_width": max(0.1 * size, 0.4)}
