"""The outline of one region in runs of consecutive segments, so that far ones can be passed over together."""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from .distances import is_crossed

# Runs into which an outline is divided, about.
RUNS = 128


class DividedOutline(NamedTuple):
    """The outline of one region in B runs of consecutive segments.

    Attributes
    ----------
    points : (N, 2) float64
        Of all regions.
    runs : (B, 2) int64
        First and last point of each run.
    box : (B, 3) float64
        The box around each run: its middle, x and y, and half its diagonal.
    longest : (B,) float64
        Length of the longest segment.
    """

    points: np.ndarray
    runs: np.ndarray
    box: np.ndarray
    longest: np.ndarray


class Square(NamedTuple):
    """A square cell: its middle (x, y), and half its width."""

    x: float
    y: float
    half: float


@njit(inner=True)
def divide_outline(points, ring, first, end):
    """Divide an outline into runs.

    Parameters
    ----------
    points : (N, 2) float64
        Points of closed rings.
    ring : (Q + 1,) int64
        Ring q owns the points ring[q] to ring[q + 1], the last of which is the first.
    first, end : int
        The outline has the rings from `first` up to `end`, at least one.

    Returns
    -------
    outline : DividedOutline
        A run goes from one point to another, the larger the outline the longer. Boxes and longest segments are
        a little too large rather than too small by rounding.
    square : Square
        Around the outline.
    """
    size = 1 + (ring[end] - ring[first]) // RUNS
    runs, box, n = np.empty((RUNS + end - first + 1, 2), np.int64), np.empty((RUNS + end - first + 1, 3)), 0
    longest = np.empty(len(box))
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for q in range(first, end):
        for i in range(ring[q], ring[q + 1] - 1, size):
            stop = min(i + size, ring[q + 1] - 1)
            low_x, low_y, high_x, high_y = points[i, 0], points[i, 1], points[i, 0], points[i, 1]
            longest[n] = 0.0
            for k in range(i + 1, stop + 1):
                dx, dy = points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1]
                longest[n] = max(longest[n], dx * dx + dy * dy)
                low_x, high_x = min(low_x, points[k, 0]), max(high_x, points[k, 0])
                low_y, high_y = min(low_y, points[k, 1]), max(high_y, points[k, 1])
            left, right, bottom, top = min(left, low_x), max(right, high_x), min(bottom, low_y), max(top, high_y)
            runs[n, 0], runs[n, 1] = i, stop
            box[n, 0], box[n, 1] = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
            box[n, 2] = 0.5 * np.hypot(high_x - low_x, high_y - low_y)
            n += 1
    for k in range(n):  # of rounding nothing may fall out
        box[k, 2] *= 1.0 + 1e-9
        longest[k] = np.sqrt(longest[k]) * (1.0 + 1e-9)
    square = Square(0.5 * (left + right), 0.5 * (bottom + top), 0.5 * max(right - left, top - bottom))
    return DividedOutline(points, runs[:n], box[:n], longest[:n]), square


@njit
def is_inside(outline, x, y):
    """Tell whether a point is inside an outline.

    Parameters
    ----------
    outline : DividedOutline
        Closed rings.
    x, y : float
        The point.

    Returns
    -------
    bool
        By the even-odd rule; either for a point on the outline.
    """
    points, runs, box = outline.points, outline.runs, outline.box
    inside = False
    for b in range(len(runs)):
        if abs(y - box[b, 1]) > box[b, 2] or x > box[b, 0] + box[b, 2]:
            continue
        if x < box[b, 0] - box[b, 2]:  # all is to the right: only its ends count
            inside ^= (points[runs[b, 0], 1] > y) != (points[runs[b, 1], 1] > y)
        else:
            for i in range(runs[b, 0], runs[b, 1]):
                inside ^= is_crossed(points, i, x, y)
    return inside
