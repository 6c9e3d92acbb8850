"""Closed curves in the plane."""

from typing import NamedTuple

import numpy as np

from ..kernels import njit


class Curves(NamedTuple):
    """C closed curves.

    Attributes
    ----------
    points : (N, 2) float64
        Points, one curve after the other.
    start : (C + 1,) int64
        Curve c owns ``points[start[c]:start[c + 1]]``, of which the last one is the first.
    """

    points: np.ndarray
    start: np.ndarray


def pick_curves(curves, chosen):
    """Pick curves.

    Parameters
    ----------
    curves : Curves
        C curves.
    chosen : (K,) int
        Which of them, in this order.

    Returns
    -------
    Curves
        K curves; the same arrays if all are chosen in their order, else copies.
    """
    if np.array_equal(chosen, np.arange(len(curves.start) - 1)):
        return curves
    start = np.concatenate([[0], np.cumsum(np.diff(curves.start)[chosen])])
    return Curves(_pick(curves, chosen, start), start)


@njit
def _pick(curves, chosen, fill):
    """Points of the chosen curves, which begin at `fill`."""
    points, start = curves.points, curves.start
    picked = np.empty((fill[-1], 2))
    for k in range(len(chosen)):
        for i in range(fill[k + 1] - fill[k]):
            picked[fill[k] + i, 0], picked[fill[k] + i, 1] = points[start[chosen[k]] + i]
    return picked


@njit
def curve_centres(points, start):
    """Find the centroids of curves as lines.

    Parameters
    ----------
    points : (N, 2) float64
        Points of closed curves.
    start : (C + 1,) int64
        As of :class:`Curves`; no curve is empty.

    Returns
    -------
    (C, 2) float64
        Mean of the points of each curve, by length; its first point if it has no length.
    """
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
        centre[c, 0], centre[c, 1] = points[start[c], 0], points[start[c], 1]
        if length > 0.0:
            centre[c, 0], centre[c, 1] = x / length, y / length
    return centre


@njit
def signed_area(points):
    """Measure the signed area that a ring encloses.

    Parameters
    ----------
    points : (N, 2) float64
        A closed ring, whose last point is its first.

    Returns
    -------
    float
        Positive if the ring runs counter-clockwise; shoelace formula relative to one of its points, so that
        nothing cancels.
    """
    x, y, total = points[0, 0], points[0, 1], 0.0
    for i in range(len(points) - 1):
        total += (points[i, 0] - x) * (points[i + 1, 1] - y) - (points[i, 1] - y) * (points[i + 1, 0] - x)
    return 0.5 * total
