"""The area that two regions share.

The plane is cut into columns. A strand is what one stretch of an outline that
turns nowhere in x has in one column; most strands of two outlines are above or
below each other as a whole, and only the others have to be walked along.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import Groups, group_items
from ..kernels import njit
from .curves import signed_area

# Segments of an outline per column, about.
PER_COLUMN = 32
# Steps per segment in which a shared area is sought before it is left to a general overlay.
PATIENCE = 64
# Of what is added up: regions that share no more are told to share nothing.
ROUNDING = 64 * np.finfo(float).eps


class Strands(NamedTuple):
    """The strands of an outline in the columns that the plane is cut into.

    Attributes
    ----------
    reach : (S, 5) float64
        Least and largest x of each strand, least and largest y, area below it.
    way : (S, 3) int64
        The point at the left end of its first segment; 1 or -1 as the points go to the right or not; the ring.
    of_column : Groups
        The strands in each column. There may be more rows than strands.
    """

    reach: np.ndarray
    way: np.ndarray
    of_column: Groups


class Walk(NamedTuple):
    """A walk along a stretch of an outline to the right: where it stands, and what it passed in one column.

    Attributes
    ----------
    i : int
        The point at the left end of the segment that it stands on.
    x, y : float
        The place on that segment.
    low, high : float
        Least and largest y passed.
    below : float
        Twice the area below what was passed.
    """

    i: int
    x: float
    y: float
    low: float
    high: float
    below: float


def shared_areas(outlines, one, other):
    """Measure the areas that pairs of regions share.

    The material of a region is the sum of what lies below the segments of its
    outline, negative where material is above them; so a shared area is the
    sum, over pairs of segments, of what lies below both. Nothing has to be
    told apart, and the result is exact up to rounding wherever segments touch
    or coincide.

    Parameters
    ----------
    outlines : Outlines
        R regions.
    one, other : (E,) int
        The two regions of every pair.

    Returns
    -------
    (E,) float64
        Shared areas; 0 where there is no more than rounding, NaN where it would take too long.
    """
    return _shared_areas(outlines, np.asarray(one, np.int64), np.asarray(other, np.int64))


@njit
def _shared_areas(outlines, one, other):
    """Kernel of `shared_areas`."""
    points, ring, start, hole = outlines.points, outlines.ring, outlines.start, outlines.hole
    area, sign = np.empty(len(one)), np.empty(len(hole))
    for q in range(len(hole)):  # of segments that run to the right
        sign[q] = 1.0 if (signed_area(points[ring[q] : ring[q + 1]]) < 0.0) != hole[q] else -1.0
    box, first, second = _region_widths(points, ring, start), _no_strands(), _no_strands()
    for pair in range(len(one)):
        a, b = one[pair], other[pair]
        left, right = max(box[a, 0], box[b, 0]), min(box[a, 1], box[b, 1])
        area[pair] = 0.0
        if left < right:
            size = min(ring[start[a + 1]] - ring[start[a]], ring[start[b + 1]] - ring[start[b]])
            columns = _divide_columns(left, right, size)
            first = _cut_strands(points, ring, start[a], start[a + 1], columns, first)
            second = _cut_strands(points, ring, start[b], start[b + 1], columns, second)
            patience = PATIENCE * (ring[start[a + 1]] - ring[start[a]] + ring[start[b + 1]] - ring[start[b]])
            area[pair] = _shared_area(points, sign, first, second, patience)
    return area


@njit(inner=True)
def _shared_area(points, sign, one, other, patience):
    """The area that two regions share, from their strands; NaN if it takes more than so many steps."""
    reach, way, first, order = one.reach, one.way, one.of_column.start, one.of_column.member
    reaches, ways, firsts, orders = other.reach, other.way, other.of_column.start, other.of_column.member
    total = size = 0.0
    for column in range(len(first) - 1):
        patience -= (first[column + 1] - first[column]) * (firsts[column + 1] - firsts[column])
        if patience < 0:
            return np.nan
        for k in range(first[column], first[column + 1]):
            s = order[k]
            sum_of_s = 0.0
            for m in range(firsts[column], firsts[column + 1]):
                t = orders[m]
                low, high = max(reach[s, 0], reaches[t, 0]), min(reach[s, 1], reaches[t, 1])
                if low >= high:
                    continue
                whole = reach[s, 0] == reaches[t, 0] and reach[s, 1] == reaches[t, 1]
                if whole and reach[s, 3] <= reaches[t, 2]:
                    below = reach[s, 4]
                elif whole and reaches[t, 3] <= reach[s, 2]:
                    below = reaches[t, 4]
                else:
                    below, steps = _walk_along(points, way[s, 0], way[s, 1], ways[t, 0], ways[t, 1], low, high)
                    patience -= steps
                size += abs(below)
                sum_of_s += below * (sign[ways[t, 2]] * ways[t, 1])
            total += sum_of_s * (sign[way[s, 2]] * way[s, 1])
    return total if abs(total) > ROUNDING * size else 0.0


@njit(inner=True)
def _region_widths(points, ring, start):
    """Least and largest x of every region, (R, 2)."""
    box = np.empty((len(start) - 1, 2))
    for r in range(len(box)):
        low, high = np.inf, -np.inf
        for i in range(ring[start[r]], ring[start[r + 1]]):
            low, high = min(low, points[i, 0]), max(high, points[i, 0])
        box[r, 0], box[r, 1] = low, high
    return box


@njit(inner=True)
def _divide_columns(left, right, size):
    """Where the columns from `left` to `right` begin and end, ascending."""
    count = max(1, size // PER_COLUMN)
    columns = left + (right - left) * (np.arange(count + 1) / count)
    columns[count] = right
    for c in range(count):
        if not columns[c] < columns[c + 1]:
            return np.array([left, right])
    return columns


@njit(inner=True)
def _no_strands():
    """Room for strands."""
    nothing = Groups(np.zeros(1, np.int64), np.empty(0, np.int64))
    return Strands(np.empty((256, 5)), np.empty((256, 3), np.int64), nothing)


@njit(inner=True)
def _cut_strands(points, ring, first, end, columns, room):
    """The strands of the rings `first` to `end`, written to where other strands had `room`."""
    n, last, reach, way = 0, len(columns) - 1, room.reach, room.way
    column = np.empty(len(reach), np.int64)
    for q in range(first, end):
        begin = ring[q]
        while begin < ring[q + 1] - 1:
            stop = _end_of_stretch(points, begin, ring[q + 1] - 1)
            i, goal, step = (begin, stop, 1) if points[stop, 0] > points[begin, 0] else (stop, begin, -1)
            begin = stop
            # nothing is below an upright segment
            if points[i, 0] == points[goal, 0] or points[goal, 0] <= columns[0] or points[i, 0] >= columns[last]:
                continue
            walk = _enter_columns(points, i, step, columns[0])
            c = _column_of(walk.x, columns)
            while walk.i != goal and c < last:
                if n == len(reach):
                    reach, way = np.concatenate((reach, reach)), np.concatenate((way, way))
                    column = np.concatenate((column, column))
                column[n], way[n, 0], way[n, 1], way[n, 2] = c, walk.i, step, q
                reach[n, 0] = walk.x
                walk = _cross_column(points, walk, goal, step, columns[c + 1])
                reach[n, 1], reach[n, 2], reach[n, 3], reach[n, 4] = walk.x, walk.low, walk.high, 0.5 * walk.below
                n, c = n + 1, c + 1
    return Strands(reach, way, group_items(column[:n], last))


@njit(inline="always")
def _end_of_stretch(points, begin, last):
    """The last point of the stretch from `begin` on that goes one way in x, or of one upright segment."""
    to_right, stop = points[begin + 1, 0] > points[begin, 0], begin + 1
    if points[stop, 0] == points[begin, 0]:
        return stop
    while stop < last and (
        points[stop + 1, 0] > points[stop, 0] if to_right else points[stop + 1, 0] < points[stop, 0]
    ):
        stop += 1
    return stop


@njit(inline="always")
def _enter_columns(points, i, step, left):
    """Begin a walk from point i, or from where the stretch passes x = left."""
    while points[i + step, 0] <= left:
        i += step
    x, y = points[i, 0], points[i, 1]
    if x < left:
        share = (left - x) / (points[i + step, 0] - x)
        x, y = left, y + share * (points[i + step, 1] - y)
    return Walk(i, x, y, y, y, 0.0)


@njit(inline="always")
def _column_of(x, columns):
    """The column that x is in."""
    last = len(columns) - 1
    scale = last / (columns[last] - columns[0])
    c = min(int((x - columns[0]) * scale), last - 1)
    while x < columns[c]:
        c -= 1
    while x >= columns[c + 1]:
        c += 1
    return c


@njit(inline="always")
def _cross_column(points, walk, goal, step, limit):
    """Go on to x = limit, the right end of a column, or to the point `goal`."""
    i, x, y = walk.i, walk.x, walk.y
    low, high, below = y, y, 0.0
    while i != goal and x < limit:
        next_x, next_y = points[i + step, 0], points[i + step, 1]
        if next_x <= limit:
            i += step
        else:
            share = (limit - points[i, 0]) / (next_x - points[i, 0])
            next_x, next_y = limit, points[i, 1] + share * (next_y - points[i, 1])
        below += (next_x - x) * (y + next_y)
        x, y = next_x, next_y
        low, high = min(low, y), max(high, y)
    return Walk(i, x, y, low, high, below)


@njit(inner=True)
def _walk_along(points, i, di, j, dj, low, high):
    """The area below both of two strands from x = low to high, and the number of steps to it.

    i, j : points at the left ends of their first segments, or of earlier ones;
    di, dj : 1 or -1, the way to the right
    """
    while points[i + di, 0] <= low:
        i += di
    while points[j + dj, 0] <= low:
        j += dj
    slope = (points[i + di, 1] - points[i, 1]) / (points[i + di, 0] - points[i, 0])
    other = (points[j + dj, 1] - points[j, 1]) / (points[j + dj, 0] - points[j, 0])
    a, b = points[i, 1] + (low - points[i, 0]) * slope, points[j, 1] + (low - points[j, 0]) * other
    x, total, steps = low, 0.0, 0
    while True:
        end, other_end = points[i + di, 0], points[j + dj, 0]
        stop = min(high, end, other_end)
        c, d = points[i, 1] + (stop - points[i, 0]) * slope, points[j, 1] + (stop - points[j, 0]) * other
        gap, end_gap = a - b, c - d
        apart = abs(gap) + abs(end_gap)  # twice the mean distance, unless they cross
        if gap * end_gap < 0.0:
            apart = (gap * gap + end_gap * end_gap) / apart
        total += (stop - x) * (a + b + c + d - apart)
        steps += 1
        if stop == high:
            return 0.25 * total, steps
        x, a, b = stop, c, d
        if stop == end:
            i += di
            slope = (points[i + di, 1] - points[i, 1]) / (points[i + di, 0] - points[i, 0])
        if stop == other_end:
            j += dj
            other = (points[j + dj, 1] - points[j, 1]) / (points[j + dj, 0] - points[j, 0])
