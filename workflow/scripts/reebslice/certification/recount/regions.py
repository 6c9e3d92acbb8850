"""Regions of the solid as rings of curves: what they are like, what they share, and polygons where those are needed."""

from typing import NamedTuple

import numpy as np
import shapely

from .curves import Curves, look
from .ranges import expand_ranges
from .shared_areas import find_chains, share_areas

POINTS_AT_ONCE = 100_000


class Regions(NamedTuple):
    """R regions, bounded by `curves`.

    contour : (C,) the contours by region, the outer ones first; begin :
    (R + 1,) where those of each region begin. Of each `contour`: `turn`, +1 an
    outer one drawn counter-clockwise or a hole drawn clockwise, -1 otherwise,
    0 one that bounds nothing: a curve that does not span a triangle, or a hole
    without an outer one. Of each region: `area`, `length` of its outline,
    `broken`, whether that crosses or touches itself; what has become of those
    regions then is in `mended`, {region: polygon}.
    """

    curves: Curves
    contour: np.ndarray
    begin: np.ndarray
    turn: np.ndarray
    area: np.ndarray
    length: np.ndarray
    broken: np.ndarray
    mended: dict


def find_regions(curves, drawn, length, mesh_area, region, inner, n_regions):
    """Put the regions of the solid together from their curves.

    Parameters
    ----------
    curves : Curves
    drawn, length : (C,) float64
        Signed area and length of each curve as it is drawn.
    mesh_area : (C,) float64
        Signed area by the mesh.
    region : (C,) int
        Of each curve.
    inner : (C,) bool
    n_regions : int

    Returns
    -------
    Regions
    """
    usable = (np.diff(curves.first) >= 4) & (mesh_area != 0)
    whole = np.bincount(region[usable & ~inner], minlength=n_regions) > 0
    order = np.lexsort((inner, region))
    turn = np.where(usable & whole[region], np.where(inner, -1, 1) * np.where(drawn < 0, -1, 1), 0)
    sums = [np.bincount(region, values, n_regions) for values in (turn * drawn, np.abs(turn) * length)]
    begin = np.concatenate([[0], np.cumsum(np.bincount(region, minlength=n_regions))])
    found = Regions(curves, order, begin, turn[order], *sums, np.zeros(n_regions, bool), {})
    points = np.concatenate([[0], np.cumsum(np.diff(curves.first)[order])])[begin[:-1]]
    for run in np.split(np.arange(n_regions), np.flatnonzero(np.diff(points // POINTS_AT_ONCE)) + 1):
        _mend(found, run)
    return found


def _mend(regions, run):
    """Give those of a run of regions that cross or touch themselves a valid polygon."""
    polygons = build_polygons(regions, run)
    wrong = ~shapely.is_valid(polygons)
    mended = shapely.buffer(shapely.make_valid(polygons[wrong]), 0)
    regions.mended.update(zip(run[wrong].tolist(), mended))
    regions.broken[run[wrong]] = True
    regions.area[run[wrong]], regions.length[run[wrong]] = shapely.area(mended), shapely.length(mended)


def build_polygons(regions, rows):
    """Make polygons of some of the regions.

    Parameters
    ----------
    regions : Regions
    rows : (k,) int
        Which.

    Returns
    -------
    (k,) shapely.Polygon
        Mended ones as they are now, empty ones without an outer curve.
    """
    index, place = expand_ranges(regions.begin[rows], regions.begin[rows + 1])
    index, place = index[regions.turn[place] != 0], place[regions.turn[place] != 0]
    out = np.full(len(rows), shapely.Polygon(), object)
    if len(index):
        coordinates, ring = regions.curves.pick(regions.contour[place])
        rings = shapely.linearrings(coordinates, indices=ring)
        shapely.polygons(rings, indices=index, out=out)
    for k in np.flatnonzero(regions.broken[rows]).tolist():
        out[k] = regions.mended[int(rows[k])]
    return out


def share(regions, one, other):
    """Measure the areas that pairs of regions share, by chains, or by polygons where one has been mended.

    Parameters
    ----------
    regions : Regions
    one, other : (E,) int

    Returns
    -------
    (E,) float64
    """
    bounds = regions.turn != 0
    region = np.repeat(np.arange(len(regions.area)), np.diff(regions.begin))[bounds]
    rings = regions.contour[bounds], region, regions.turn[bounds]
    points = regions.curves.points
    shared = share_areas(points, find_chains(points, regions.curves.first, *rings, len(regions.area)), one, other)
    mended = np.flatnonzero(regions.broken[one] | regions.broken[other])
    polygons = (build_polygons(regions, ends[mended]) for ends in (one, other))
    shared[mended] = shapely.area(shapely.intersection(*polygons))
    return shared


def look_around(regions, spots):
    """Look around a spot in each region.

    Parameters
    ----------
    regions : Regions
    spots : (R, 2) float64

    Returns
    -------
    inside : (R,) bool
    near, edge : (R,) float64
        Distance to the region's contours, and to its outline, which is without those that bound nothing.
    """
    bounds, begin = regions.turn != 0, regions.begin[:-1]
    region = np.repeat(np.arange(len(spots)), np.diff(regions.begin))
    within, far = look(*regions.curves, regions.contour, spots[region], np.inf)
    inside = np.bincount(region, within & bounds, len(spots)) % 2 == 1
    near, edge = (np.minimum.reduceat(distance, begin) for distance in (far, np.where(bounds, far, np.inf)))
    broken = np.flatnonzero(regions.broken)
    polygons = build_polygons(regions, broken)
    inside[broken] = shapely.contains_xy(polygons, spots[broken])
    edge[broken] = np.nan_to_num(shapely.distance(shapely.boundary(polygons), shapely.points(spots[broken])))
    return inside, near, edge
