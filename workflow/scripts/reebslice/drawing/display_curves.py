"""Contours as they are shown on a page: of few enough levels, with few enough points."""

from typing import NamedTuple

import numpy as np
import shapely

from ..planar.curves import pick_curves

FINEST = 1 / 3000  # of the extent: what is simplified away at least
LEAST = 6  # points of a contour on average, below which levels are left out


class ShownCurves(NamedTuple):
    """Some contours.

    Attributes
    ----------
    points : (n, 2) float64
        Of closed curves, one after the other; the last point of each is its first.
    curve : (n,) int64
        Contour of each point, ascending.
    every : int
        So many levels apart are the levels whose contours these are.
    tolerance : float
        The curves are within it of the contours, mesh units.
    """

    points: np.ndarray
    curve: np.ndarray
    every: int
    tolerance: float


def simplify_curves(curves, level, extent, most):
    """Simplify contours until there are few enough points (Douglas-Peucker).

    Parameters
    ----------
    curves : Curves
        C contours.
    level : (C,) int
        Of each, ascending.
    extent : float
        Of the model, mesh units.
    most : int
        About so many points are left.

    Returns
    -------
    ShownCurves
    """
    every = 1
    while len(chosen := np.flatnonzero(level % every == 0)) * LEAST > most and every <= level.max(initial=0):
        every += 1
    shown = pick_curves(curves, chosen)
    numbers = np.repeat(np.arange(len(chosen)), np.diff(shown.start))
    lines = shapely.linestrings(shown.points, indices=numbers) if len(chosen) else np.empty(0, object)
    tolerance = FINEST * extent
    points, curve = _simplify(lines, tolerance)
    while len(points) > most and tolerance < extent / 100:
        tolerance *= 1.5
        points, curve = _simplify(lines, tolerance)
    return ShownCurves(points, chosen[curve], every, tolerance)


def _simplify(lines, tolerance):
    """Points (n, 2) of the simplified lines, and the line of each."""
    return shapely.get_coordinates(shapely.simplify(lines, tolerance, preserve_topology=False), return_index=True)


def list_segments(curve):
    """Pairs (k, 2) of neighbours among points that have the same, ascending number in `curve` (n,)."""
    first = np.flatnonzero(np.diff(curve) == 0)
    return np.column_stack([first, first + 1])
