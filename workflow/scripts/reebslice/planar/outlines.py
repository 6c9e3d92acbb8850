"""Regions as arrays of points and as shapely polygons."""

from typing import NamedTuple

import numpy as np
import shapely

from ..arrays.grouping import split_into_blocks
from ..kernels import njit
from .curves import Curves, pick_curves, signed_area

# Points of polygons that are looked at together; with more, time goes into fetching memory.
POINTS_AT_ONCE = 1 << 16


class Outlines(NamedTuple):
    """Outlines of R regions as Q closed rings.

    Attributes
    ----------
    points : (N, 2) float64
        Points, one ring after the other; the last point of each ring is its first.
    ring : (Q + 1,) int64
        Ring q owns ``points[ring[q]:ring[q + 1]]``.
    start : (R + 1,) int64
        Region r owns the rings from start[r] up to start[r + 1]; of each of its parts the outer ring comes first.
    hole : (Q,) bool
        Whether a ring bounds a hole.
    """

    points: np.ndarray
    ring: np.ndarray
    start: np.ndarray
    hole: np.ndarray


def find_outlines(polygons):
    """Convert polygons to outlines.

    Parameters
    ----------
    polygons : (R,) array of shapely polygons
        Valid ones, which may be empty or of several parts.

    Returns
    -------
    Outlines
        Of R regions.
    """
    parts, region = shapely.get_parts(polygons, return_index=True)
    rings, part = shapely.get_rings(parts, return_index=True)
    ring, start = np.zeros(len(rings) + 1, np.int64), np.zeros(len(polygons) + 1, np.int64)
    np.cumsum(shapely.get_num_coordinates(rings), out=ring[1:])
    np.cumsum(np.bincount(region[part], minlength=len(polygons)), out=start[1:])
    return Outlines(shapely.get_coordinates(rings), ring, start, np.diff(part, prepend=-1) == 0)


def outline_polygons(outlines):
    """Convert outlines to polygons.

    Parameters
    ----------
    outlines : Outlines
        R regions.

    Returns
    -------
    (R,) array of shapely polygons
        Empty where there is no outline, of several parts where there is more than one outer ring.
    """
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
    """Make outlines valid as those of polygons.

    Invalid ones come of surfaces that cross themselves, and of contours that coincide by rounding.

    Parameters
    ----------
    outlines : Outlines
        R regions.

    Returns
    -------
    Outlines
        The same arrays if all are valid. A region whose outline is not gets that of `shapely.make_valid`.
    """
    broken, mended = [np.zeros(0, int)], []
    for first, end in split_into_blocks(outlines.ring[outlines.start], POINTS_AT_ONCE):
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
    """Pick the outlines of regions.

    Parameters
    ----------
    outlines : Outlines
        R regions.
    chosen : (K,) int
        Which of them, in this order.

    Returns
    -------
    Outlines
        Of K regions.
    """
    points, ring, start, hole = outlines
    count = np.diff(start)[chosen]
    begin = np.concatenate([[0], np.cumsum(count)])
    rings = np.repeat(start[chosen] - begin[:-1], count) + np.arange(begin[-1])
    return Outlines(*pick_curves(Curves(points, ring), rings), begin, hole[rings])


def outline_areas(outlines):
    """Measure the area of every region.

    Parameters
    ----------
    outlines : Outlines
        R regions.

    Returns
    -------
    (R,) float64
        To the last bit the areas of their polygons in shapely.
    """
    return _outline_areas(outlines)


@njit
def _outline_areas(outlines):
    """Kernel of `outline_areas`."""
    points, ring, start, hole = outlines.points, outlines.ring, outlines.start, outlines.hole
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
    """Measure the regions and their outlines.

    Parameters
    ----------
    outlines : Outlines
        R regions.

    Returns
    -------
    area, length, extent : (R,) float64
        Area of the region, length of its outline and the larger side of its box; 0 where there is no outline.
    """
    return _measure_outlines(outlines)


@njit
def _measure_outlines(outlines):
    """Kernel of `measure_outlines`."""
    points, ring, start, hole = outlines.points, outlines.ring, outlines.start, outlines.hole
    area, length, extent = np.zeros(len(start) - 1), np.zeros(len(start) - 1), np.zeros(len(start) - 1)
    for r in range(len(area)):
        low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
        for q in range(start[r], start[r + 1]):
            size = abs(signed_area(points[ring[q] : ring[q + 1]]))
            area[r] += -size if hole[q] else size
            for i in range(ring[q], ring[q + 1] - 1):
                dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
                length[r] += np.sqrt(dx * dx + dy * dy)
                low_x, high_x = min(low_x, points[i, 0]), max(high_x, points[i, 0])
                low_y, high_y = min(low_y, points[i, 1]), max(high_y, points[i, 1])
        if start[r] < start[r + 1]:
            extent[r] = max(high_x - low_x, high_y - low_y)
    return area, length, extent
