"""Regions as arrays of points, as shapely polygons, and the areas that they share."""

from typing import NamedTuple

import numpy as np
import shapely
from numba import njit

from .curves import Curves, pick_curves
from .slicing import share_out

# Points of polygons that are looked at together; with more, time goes into fetching memory.
POINTS_AT_ONCE = 1 << 16
# Steps per segment in which a shared area is sought before it is left to a general overlay.
PATIENCE = 64


class Outlines(NamedTuple):
    """Outlines of R regions as Q closed rings.

    points : (N, 2) float64, the last point of each ring is its first
    ring : (Q + 1,) int64, ring q owns the points ring[q] to ring[q + 1]
    start : (R + 1,) int64, region r owns the rings start[r] to start[r + 1]
    hole : (Q,) bool
    """

    points: np.ndarray
    ring: np.ndarray
    start: np.ndarray
    hole: np.ndarray


def find_outlines(polygons):
    """The :class:`Outlines` of valid polygons, (R,), which may be empty or of several parts."""
    parts, region = shapely.get_parts(polygons, return_index=True)
    rings, part = shapely.get_rings(parts, return_index=True)
    ring, start = np.zeros(len(rings) + 1, np.int64), np.zeros(len(polygons) + 1, np.int64)
    np.cumsum(shapely.get_num_coordinates(rings), out=ring[1:])
    np.cumsum(np.bincount(region[part], minlength=len(polygons)), out=start[1:])
    return Outlines(shapely.get_coordinates(rings), ring, start, np.diff(part, prepend=-1) == 0)


def outline_polygons(outlines):
    """The regions as shapely polygons, (R,): empty where there is no outline, of several parts where there are more."""
    first = np.flatnonzero(~outlines.hole)
    offsets = outlines.ring, np.append(first, len(outlines.hole))
    parts = shapely.from_ragged_array(shapely.GeometryType.POLYGON, outlines.points, offsets)
    place = np.searchsorted(first, outlines.start)
    count, polygons = np.diff(place), np.full(len(outlines.start) - 1, shapely.Polygon(), object)
    polygons[count == 1] = parts[place[:-1][count == 1]]
    for r in np.flatnonzero(count > 1):
        polygons[r] = shapely.multipolygons(parts[place[r] : place[r + 1]])
    return polygons


def mend_outlines(outlines):
    """The outlines made valid as those of polygons.

    Others come of surfaces that cross themselves, and of contours that coincide by rounding.
    """
    broken, mended = [np.zeros(0, int)], []
    for first, end in share_out(outlines.ring[outlines.start], POINTS_AT_ONCE):
        polygons = outline_polygons(_slice_outlines(outlines, first, end))
        wrong = np.flatnonzero(~shapely.is_valid(polygons))
        broken.append(first + wrong)
        mended += shapely.buffer(shapely.make_valid(polygons[wrong]), 0).tolist()
    return _replace_outlines(outlines, np.concatenate(broken), find_outlines(mended)) if mended else outlines


def _slice_outlines(outlines, first, end):
    """Outlines of the regions from `first` up to `end`."""
    points, ring, start, hole = outlines
    rings = slice(start[first], start[end])
    ring = ring[rings.start : rings.stop + 1]
    return Outlines(points[ring[0] : ring[-1]], ring - ring[0], start[first : end + 1] - start[first], hole[rings])


def _replace_outlines(outlines, places, others):
    """The outlines with those of the regions `places`, (P,), replaced by `others`, of P regions."""
    both = Outlines(
        np.concatenate([outlines.points, others.points]),
        np.concatenate([outlines.ring, outlines.ring[-1] + others.ring[1:]]),
        np.concatenate([outlines.start, outlines.start[-1] + others.start[1:]]),
        np.concatenate([outlines.hole, others.hole]),
    )
    chosen = np.arange(len(outlines.start) - 1)
    chosen[places] = len(chosen) + np.arange(len(places))
    return pick_outlines(both, chosen)


def pick_outlines(outlines, chosen):
    """Outlines of the `chosen` regions, (K,) places."""
    points, ring, start, hole = outlines
    count = np.diff(start)[chosen]
    begin = np.concatenate([[0], np.cumsum(count)])
    rings = np.repeat(start[chosen] - begin[:-1], count) + np.arange(begin[-1])
    return Outlines(*pick_curves(Curves(points, ring), rings), begin, hole[rings])


def outline_areas(outlines):
    """Area of every region, (R,) float64, to the last bit that of its polygon in shapely."""
    return _outline_areas(outlines.points, outlines.ring, outlines.start, outlines.hole)


@njit(cache=True)
def _outline_areas(points, ring, start, hole):
    area = np.zeros(len(start) - 1)
    for r in range(len(area)):
        part = 0.0
        for q in range(start[r], start[r + 1]):
            twice, x = 0.0, points[ring[q], 0]
            for i in range(ring[q] + 1, ring[q + 1] - 1):
                twice += (points[i, 0] - x) * (points[i - 1, 1] - points[i + 1, 1])
            if hole[q]:
                part -= abs(twice / 2.0)
            else:
                area[r] += part
                part = abs(twice / 2.0)
        area[r] += part
    return area


def measure_outlines(outlines):
    """Area, length of the outline and larger side of the box of every region, three (R,) float64."""
    return _measure_outlines(outlines.points, outlines.ring, outlines.start, outlines.hole)


@njit(cache=True)
def _measure_outlines(points, ring, start, hole):
    area, length, extent = np.zeros(len(start) - 1), np.zeros(len(start) - 1), np.zeros(len(start) - 1)
    for r in range(len(area)):
        low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
        for q in range(start[r], start[r + 1]):
            size = abs(_signed_area(points[ring[q] : ring[q + 1]]))
            area[r] += -size if hole[q] else size
            for i in range(ring[q], ring[q + 1] - 1):
                length[r] += np.hypot(points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1])
                low_x, high_x = min(low_x, points[i, 0]), max(high_x, points[i, 0])
                low_y, high_y = min(low_y, points[i, 1]), max(high_y, points[i, 1])
        if start[r] < start[r + 1]:
            extent[r] = max(high_x - low_x, high_y - low_y)
    return area, length, extent


def shared_areas(outlines, one, other):
    """Areas that pairs of regions share, (E,) float64; NaN where that would take too long.

    one, other : (E,) places of regions. The material of a region is the sum of
    what lies below the segments of its outline, negative where material is
    above them; so a shared area is the sum, over pairs of segments, of what
    lies below both. Nothing has to be told apart, and the result is exact up
    to rounding wherever segments touch or coincide.
    """
    if len(one) == 0:
        return np.zeros(0)
    begin = (outlines.ring - np.arange(len(outlines.ring)))[outlines.start]  # a ring has one more point than segments
    order, floor = _sort_segments(*outlines, begin)
    return _shared_areas(outlines.points, begin, order, floor, np.asarray(one), np.asarray(other))


@njit(cache=True)
def _sort_segments(points, ring, start, hole, begin):
    """The segments of each region roughly from left to right: order and floor, two (S,) arrays.

    Segment i runs from point i to i + 1 with material on its left, segment ~i
    likewise with material on its right. No segment from some place on in its
    region has a point left of the floor there: such an order takes no comparisons.
    """
    order, floor = np.empty(begin[-1], np.int32), np.empty(begin[-1])
    stretch, first = np.empty(np.diff(begin).max(), np.int64), np.empty(np.diff(begin).max() + 1, np.int64)
    for r in range(len(start) - 1):
        n, low, high = begin[r + 1] - begin[r], np.inf, -np.inf
        for i in range(ring[start[r]], ring[start[r + 1]]):
            low, high = min(low, points[i, 0]), max(high, points[i, 0])
        width = (high - low) / n if n > 0 and high > low else 1.0
        first[: n + 1] = 0
        k = 0
        for q in range(start[r], start[r + 1]):
            for i in range(ring[q], ring[q + 1] - 1):
                stretch[k] = min(int((min(points[i, 0], points[i + 1, 0]) - low) / width), n - 1)
                first[stretch[k] + 1] += 1
                k += 1
        first[: n + 1] = np.cumsum(first[: n + 1])
        k = 0
        for q in range(start[r], start[r + 1]):
            turned = (_signed_area(points[ring[q] : ring[q + 1]]) < 0.0) != hole[q]
            for i in range(ring[q], ring[q + 1] - 1):
                place = begin[r] + first[stretch[k]]
                order[place], floor[place] = ~i if turned else i, low + stretch[k] * width
                first[stretch[k]] += 1
                k += 1
    return order, floor


@njit(cache=True)
def _signed_area(points):
    """Of a closed ring, relative to one of its points: no cancellation."""
    x, y, total = points[0, 0], points[0, 1], 0.0
    for i in range(len(points) - 1):
        total += (points[i, 0] - x) * (points[i + 1, 1] - y) - (points[i, 1] - y) * (points[i + 1, 0] - x)
    return 0.5 * total


@njit(cache=True)
def _shared_areas(points, begin, order, floor, one, other):
    area, longest = np.empty(len(one)), 0
    for r in range(len(begin) - 1):
        longest = max(longest, begin[r + 1] - begin[r])
    opened, n = np.empty((2, longest, 5)), np.zeros(2, np.int64)
    for pair in range(len(one)):
        i, end_i, j, end_j = begin[one[pair]], begin[one[pair] + 1], begin[other[pair]], begin[other[pair] + 1]
        patience, total = PATIENCE * (end_i - i + end_j - j), 0.0
        n[:] = 0
        while (i < end_i or j < end_j) and patience >= 0:
            if j == end_j or (i < end_i and floor[i] <= floor[j]):
                side, k = 0, i
                i += 1
            else:
                side, k = 1, j
                j += 1
            patience -= n[1 - side]
            total += _meet(points, order[k], floor[k], opened, n, side)
        area[pair] = total if patience >= 0 else np.nan
    return area


@njit(cache=True)
def _meet(points, segment, floor, opened, n, side):
    """Signed area below both a segment of region `side` and each open one of the other.

    Opens the segment among the n[side] of its own region, and closes those of
    the other that end left of the floor.
    """
    i = segment if segment >= 0 else ~segment
    left = i if points[i, 0] < points[i + 1, 0] else i + 1
    right = 2 * i + 1 - left
    x0, y0, x1 = points[left, 0], points[left, 1], points[right, 0]
    if x0 == x1:
        return 0.0
    slope, sign = (points[right, 1] - y0) / (x1 - x0), 1.0 if (left == i) != (segment >= 0) else -1.0
    total, k, m, others = 0.0, 0, n[1 - side], opened[1 - side]
    while k < m:
        if others[k, 2] <= floor:
            m -= 1
            for column in range(5):
                others[k, column] = others[m, column]
            continue
        low, high = max(x0, others[k, 0]), min(x1, others[k, 2])
        if low < high:
            a, b = y0 + (low - x0) * slope, others[k, 1] + (low - others[k, 0]) * others[k, 3]
            gap, end_gap = a - b, a - b + (high - low) * (slope - others[k, 3])
            apart = abs(gap) + abs(end_gap)  # twice the mean distance, unless they cross
            if gap * end_gap < 0.0:
                apart = (gap * gap + end_gap * end_gap) / apart
            both = a + b + 0.5 * (high - low) * (slope + others[k, 3])  # twice the mean height
            total += others[k, 4] * (high - low) * (both - 0.5 * apart)
        k += 1
    own = opened[side]
    own[n[side], 0], own[n[side], 1], own[n[side], 2], own[n[side], 3], own[n[side], 4] = x0, y0, x1, slope, sign
    n[1 - side] = m
    n[side] += 1
    return 0.5 * sign * total
