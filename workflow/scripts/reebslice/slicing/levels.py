"""Heights to cut at, and the vertices between them."""

import math
from bisect import bisect_right
from typing import NamedTuple

import numpy as np

from ..errors import ReebsliceError, TooManyCrossingsError
from .sampling_rule import MOST_LEVELS


class Levels(NamedTuple):
    """Horizontal cuts in ascending order, K of them.

    Attributes
    ----------
    height : (K,) float64
        Heights of the levels, mesh units.
    below : (K,) int32
        Number of vertices below each level: rank r is above level k iff r >= below[k].
    tie_x, tie_y : (K,) float64
        Where the cut runs inside the vertices at exactly this height; NaN for an ordinary level.
    """

    height: np.ndarray
    below: np.ndarray
    tie_x: np.ndarray
    tie_y: np.ndarray


def vertex_slabs(mesh, levels):
    """Count the levels below every vertex.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    levels : Levels
        The cuts.

    Returns
    -------
    (n,) int32
        The slab of every vertex plus one: 0 is below all levels.
    """
    n = len(mesh.points)
    vertices = np.diff(np.concatenate([[0], np.minimum(levels.below, n), [n]]))
    return np.repeat(np.arange(len(vertices), dtype=np.int32), vertices)


def uniform_heights(low: float, high: float, distance: float) -> np.ndarray:
    """Place equispaced levels, half a spacing inside both ends.

    Parameters
    ----------
    low, high : float
        Lowest and highest height of the surface, mesh units.
    distance : float
        Upper bound of the spacing, mesh units.

    Returns
    -------
    (K,) float64
        Ascending heights. Their spacing is the largest one that divides [low, high] evenly and does
        not exceed `distance`; there is at least one level.

    Raises
    ------
    TooManyCrossingsError
        There would be more than MOST_LEVELS levels; no memory is taken before.
    ReebsliceError
        The distance is no positive number.

    Examples
    --------
    >>> uniform_heights(0.0, 1.0, 0.3).tolist()
    [0.125, 0.375, 0.625, 0.875]
    """
    if not distance > 0:
        raise ReebsliceError(f"The distance between levels is {distance}: it must be a positive number of mesh units.")
    spacings = float(high - low) / float(distance) * (1 - 1e-12)  # infinite for a distance next to zero
    if spacings > MOST_LEVELS:
        raise TooManyCrossingsError(
            f"A distance of {distance:.3g} mesh units makes {spacings:.3g} levels, more than the {MOST_LEVELS} that "
            f"can be held: take at least {1.01 * (high - low) / MOST_LEVELS:.2g} mesh units "
            f"({1.01 / MOST_LEVELS:.2g} of the height)"
        )
    count = max(1, math.ceil(spacings))
    return low + (high - low) * (np.arange(count) + 0.5) / count


def make_levels(mesh, heights):
    """Make ordinary levels, which cut between the heights of vertices.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    heights : (K,) array_like of float
        Ascending heights, mesh units. A vertex is above a level iff it is higher.

    Returns
    -------
    Levels
        One level per height.
    """
    heights = np.asarray(heights, float)
    below = np.searchsorted(mesh.points[:, 2], heights, side="right").astype(np.int32)
    nothing = np.full(len(heights), np.nan)
    return Levels(heights, below, nothing, nothing)


def cut_between(mesh, low, high):
    """Find a level above one vertex and not above another.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    low, high : int
        Ranks of the two vertices, low < high.

    Returns
    -------
    height : float
        Halfway between the heights of the two or, where these are equal, that height.
    below : int
        Number of vertices below the cut; low < below <= high.
    tie_x, tie_y : float
        Where the cut runs inside a flat that holds both vertices: halfway in x, then in y; else NaN.
    """
    p, q = mesh.points[low], mesh.points[high]
    if p[2] < q[2]:
        height = _halfway(p[2], q[2])
        return height, bisect_right(mesh.points[:, 2], height, low + 1, high), np.nan, np.nan
    if p[0] < q[0]:
        tie = (_halfway(p[0], q[0]), float(mesh.points[:, 1].max()))
    else:
        tie = (p[0], _halfway(p[1], q[1]))
    last = low  # the highest rank that is still below the cut
    while last + 1 < high and mesh.points[last + 1, 2] == p[2] and tuple(mesh.points[last + 1, :2]) <= tie:
        last += 1
    return p[2], last + 1, *tie


def _halfway(a, b):
    """A number in [a, b) for a < b."""
    middle = a + (b - a) / 2
    return middle if a <= middle < b else a


def pierce(intervals):
    """Pierce intervals with the fewest cuts: greedy by upper end, which is optimal for intervals.

    Parameters
    ----------
    intervals : iterable of (low, high)
        Intervals of ranks or heights. A cut meets one if low < cut <= high.

    Returns
    -------
    list of (low, high)
        One entry per cut, ascending: what the intervals that this cut meets have in common.
    """
    groups = []
    for low, high in sorted(intervals, key=lambda pair: (pair[1], pair[0])):
        if groups and low < groups[-1][1]:
            groups[-1] = (max(groups[-1][0], low), groups[-1][1])
        else:
            groups.append((low, high))
    return groups
