"""Closed curves in the plane, and how they are stored: WKB line strings, one after another."""

from typing import NamedTuple

import numpy as np
from numba import njit


class Curves(NamedTuple):
    """C closed curves: curve c owns points[start[c]:start[c + 1]], of which the last one is the first.

    points : (N, 2) float64; start : (C + 1,) int64
    """

    points: np.ndarray
    start: np.ndarray


def pick_curves(curves, chosen):
    """Those curves that are `chosen`, (K,) ids, one after another: :class:`Curves`."""
    if np.array_equal(chosen, np.arange(len(curves.start) - 1)):
        return curves
    start = np.concatenate([[0], np.cumsum(np.diff(curves.start)[chosen])])
    return Curves(_pick(*curves, chosen, start), start)


@njit(cache=True)
def _pick(points, start, chosen, fill):
    picked = np.empty((fill[-1], 2))
    for k in range(len(chosen)):
        for i in range(fill[k + 1] - fill[k]):
            picked[fill[k] + i, 0], picked[fill[k] + i, 1] = points[start[chosen[k]] + i]
    return picked


@njit(cache=True)
def curve_centres(points, start):
    """Centroids of the curves as lines, (C, 2); points : (N, 2) of closed curves; start : (C + 1,)."""
    centre = np.empty((len(start) - 1, 2))
    for c in range(len(centre)):
        length, x, y = 0.0, 0.0, 0.0
        for i in range(start[c], start[c + 1] - 1):
            dx, dy = points[i, 0] - points[i + 1, 0], points[i, 1] - points[i + 1, 1]
            step = np.sqrt(dx * dx + dy * dy)
            if step == 0.0:
                continue
            length += step
            x += step * ((points[i, 0] + points[i + 1, 0]) / 2)
            y += step * ((points[i, 1] + points[i + 1, 1]) / 2)
        centre[c] = points[start[c]]
        if length > 0.0:
            centre[c, 0], centre[c, 1] = x / length, y / length
    return centre


@njit(cache=True)
def signed_area(points):
    """Of a closed ring, relative to one of its points: no cancellation."""
    x, y, total = points[0, 0], points[0, 1], 0.0
    for i in range(len(points) - 1):
        total += (points[i, 0] - x) * (points[i + 1, 1] - y) - (points[i, 1] - y) * (points[i + 1, 0] - x)
    return 0.5 * total
