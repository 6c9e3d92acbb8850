"""Distances to the outlines of regions."""

import numpy as np

from ..kernels import njit


def clearances(outlines, points):
    """Measure the distance of a point to the outline of each region.

    Parameters
    ----------
    outlines : Outlines
        R regions.
    points : (R, 2) array_like of float
        One point for each region.

    Returns
    -------
    (R,) float64
        Negative outside the region; 0 where there is no outline.
    """
    return _clearances(outlines, np.ascontiguousarray(points, float))


@njit(inner=True)
def nearest_point(points, ring, first, end, x, y):
    """Find the point on an outline that is nearest to a point.

    Parameters
    ----------
    points : (N, 2) float64
        Points of closed rings.
    ring : (Q + 1,) int64
        Ring q owns the points ring[q] to ring[q + 1], the last of which is the first.
    first, end : int
        The outline has the rings from `first` up to `end`.
    x, y : float
        The point.

    Returns
    -------
    distance : float
        Negative outside (even-odd rule); 0 if there are no rings.
    foot_x, foot_y : float
        The nearest point on the rings; (x, y) if there are none.
    """
    least, foot_x, foot_y, inside = np.inf, x, y, False
    for q in range(first, end):
        for i in range(ring[q], ring[q + 1] - 1):
            squared, along = square_distance(points, i, x, y)
            if squared < least:
                least = squared
                foot_x = points[i, 0] + along * (points[i + 1, 0] - points[i, 0])
                foot_y = points[i, 1] + along * (points[i + 1, 1] - points[i, 1])
            inside ^= is_crossed(points, i, x, y)
    distance = np.hypot(x - foot_x, y - foot_y) if first < end else 0.0
    return distance if inside else -distance, foot_x, foot_y


@njit(inline="always")
def square_distance(points, i, x, y):
    """Measure the squared distance of a point to a segment.

    Parameters
    ----------
    points : (N, 2) float64
        Points of an outline.
    i : int
        The segment goes from point i to point i + 1.
    x, y : float
        The point.

    Returns
    -------
    squared : float
        The squared distance.
    along : float
        At which share of the segment, from 0 to 1, it is nearest; 0 if it has no length.
    """
    dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
    px, py = x - points[i, 0], y - points[i, 1]
    squared = dx * dx + dy * dy
    along = min(max((px * dx + py * dy) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    px, py = px - along * dx, py - along * dy
    return px * px + py * py, along


@njit(inline="always")
def is_crossed(points, i, x, y):
    """Tell whether the ray from a point to the right crosses a segment.

    Parameters
    ----------
    points, i, x, y
        As for :func:`square_distance`.

    Returns
    -------
    bool
        Of the ends of a segment the lower one counts as on the ray, so that a closed ring is crossed an odd
        number of times around the points inside.
    """
    y0, y1 = points[i, 1], points[i + 1, 1]
    if (y0 > y) == (y1 > y):
        return False
    return x < points[i, 0] + (y - y0) / (y1 - y0) * (points[i + 1, 0] - points[i, 0])


@njit
def _clearances(outlines, places):
    """Kernel of `clearances`."""
    points, ring, start = outlines.points, outlines.ring, outlines.start
    out = np.zeros(len(places))
    for r in range(len(places)):
        out[r] = nearest_point(points, ring, start[r], start[r + 1], places[r, 0], places[r, 1])[0]
    return out
