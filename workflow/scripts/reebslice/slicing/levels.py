"""Heights to cut at, and the vertices between them."""

import math
from bisect import bisect_right
from typing import NamedTuple

import numpy as np


class Levels(NamedTuple):
    """Horizontal cuts in ascending order, K of them.

    height : (K,) float64
    below : (K,) int32, vertices below: rank r is above level k iff r >= below[k]
    tie_x, tie_y : (K,) float64; where, inside the vertices at exactly this
        height, the cut runs; NaN for an ordinary level
    """

    height: np.ndarray
    below: np.ndarray
    tie_x: np.ndarray
    tie_y: np.ndarray


def vertex_slabs(mesh, levels):
    """Number of levels below every vertex, (n,) int32: 0 is below them all."""
    n = len(mesh.points)
    vertices = np.diff(np.concatenate([[0], np.minimum(levels.below, n), [n]]))
    return np.repeat(np.arange(len(vertices), dtype=np.int32), vertices)


def uniform_heights(low, high, distance):
    """Heights of equispaced levels, half a spacing inside both ends.

    The spacing is the largest one that divides [low, high] evenly and does
    not exceed `distance` (> 0, mesh units).
    """
    count = max(1, math.ceil((high - low) / distance * (1 - 1e-12)))
    return low + (high - low) * (np.arange(count) + 0.5) / count


def make_levels(mesh, heights):
    """Ordinary :class:`Levels` at ascending heights: what is higher is above."""
    heights = np.asarray(heights, float)
    below = np.searchsorted(mesh.points[:, 2], heights, side="right").astype(np.int32)
    nothing = np.full(len(heights), np.nan)
    return Levels(heights, below, nothing, nothing)


def cut_between(mesh, low, high):
    """A level above vertex `low` and not above vertex `high`, low < high in rank.

    Halfway between their heights or, where these are equal, inside the flat
    that holds both: halfway in x, then in y. Returns (height, below, tie_x, tie_y).
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
    """The fewest cuts that meet all intervals (k, 2) of ranks, low < cut <= high.

    Greedy by upper end, which is optimal for intervals. Returns (low, high)
    of what each group of intervals has in common.
    """
    groups = []
    for low, high in sorted(intervals, key=lambda pair: (pair[1], pair[0])):
        if groups and low < groups[-1][1]:
            groups[-1] = (max(groups[-1][0], low), groups[-1][1])
        else:
            groups.append((low, high))
    return groups
