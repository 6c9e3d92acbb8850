"""Material points: one inside every region of every level."""

import numpy as np
import shapely

from ..planar.circles import largest_circles
from ..planar.distances import clearances
from ..planar.outlines import measure_outlines, outline_polygons
from ..slicing.tables import block_regions, region_levels, region_outlines
from ..table_checks import build_table
from .smooth_paths import smooth_points

SAMPLERS = ("inscribed", "representative", "centroid")

# Of the search for the largest circle, whose time grows as its inverse.
PRECISION = 0.05


def sample_nodes(contours, curves, pieces, levels, rotation, sampler="inscribed"):
    """Put a material point into every region of every level.

    Parameters
    ----------
    contours : pyarrow.Table
        The table `contours`, without `geometry`.
    curves : Curves
        Its curves, tilted frame (:func:`tables.contour_curves`).
    pieces, levels : pyarrow.Table
    rotation : (3, 3) float64
        From the model frame to the tilted frame.
    sampler : {"inscribed", "representative", "centroid"}
        Centres of circles nearly as large as any in their regions, which lead
        along the medial axis, chosen together so that paths are short
        (:mod:`.smooth_paths`); some point inside; the centre of area, or some
        point inside where that is outside.

    Returns
    -------
    pyarrow.Table
        The table `nodes`, points in the model frame. A region too thin to hold a
        point in floating point gets a point of its outer contour and radius 0.
    """
    outlines, level = region_outlines(contours, curves), region_levels(contours)
    count = len(level)
    height, spare = levels["height"].to_numpy()[level], _first_points(contours, curves, count)
    if sampler == "inscribed":
        points, radius = inscribed_points(outlines)
        points = np.where(np.isnan(points), spare, points)
        points = smooth_points(outlines, points, radius, height, *block_regions(pieces, contours))
    else:
        points = points_inside(outline_polygons(outlines), sampler)
        points = np.where(np.isnan(points), spare, points)
    tilted = np.column_stack([points, height])
    return build_table(
        "nodes",
        {
            "node": np.arange(count),
            "level": level,
            "region": np.arange(count),
            "height": height,
            **dict(zip("xyz", (tilted @ np.asarray(rotation)).T)),
            "critical": critical_regions(contours, pieces, count),
            "area": np.bincount(contours["region"].to_numpy(), contours["signed_area"].to_numpy(), count),
            "inscribed_radius": np.maximum(clearances(outlines, points), 0.0),
            "n_holes": np.bincount(contours["region"].to_numpy(), minlength=count) - 1,
        },
    )


def points_inside(regions, sampler):
    """Find a point inside each polygon.

    Parameters
    ----------
    regions : (R,) array of shapely.Polygon
    sampler : {"representative", "centroid"}
        Some point inside; the centre of area, or some point where that is outside.

    Returns
    -------
    (R, 2) float64
        NaN for empty polygons.
    """
    points = shapely.point_on_surface(regions)
    if sampler == "centroid":
        centre = shapely.centroid(regions)
        points = np.where(shapely.contains(regions, centre), centre, points)
    places, there = np.full((len(regions), 2), np.nan), ~shapely.is_empty(points)
    places[there] = shapely.get_coordinates(points[there])
    return places


def inscribed_points(outlines):
    """Find the largest circle inside each region.

    Parameters
    ----------
    outlines : Outlines
        Of R regions.

    Returns
    -------
    points : (R, 2) float64
        Centres; NaN where there is no outline.
    radius : (R,) float64
        Largest up to `PRECISION` times twice the area over the perimeter, which
        is the radius of a disk and the width of a strip; 0 without outline.
    """
    area, length, extent = measure_outlines(outlines)
    scale = np.divide(2 * area, length, out=np.zeros_like(area), where=length > 0)
    return largest_circles(outlines, np.maximum(PRECISION * scale, 1e-6 * extent))


def critical_regions(contours, pieces, count):
    """Find the regions next to a block that holds an event, the paper's set V.

    Parameters
    ----------
    contours, pieces : pyarrow.Table
    count : int
        Number R of regions.

    Returns
    -------
    (R,) bool
    """
    eventful = {b for b, ranks in zip(pieces["block"].to_pylist(), pieces["critical_ranks"].to_pylist()) if ranks}
    critical = np.zeros(count, bool)
    for block, (below, above) in enumerate(zip(*block_regions(pieces, contours))):
        if block in eventful:
            critical[below + above] = True
    return critical


def _first_points(contours, curves, count):
    """The first point of each region's first contour, for regions without room: (R, 2)."""
    first = np.empty((count, 2))
    first[contours["region"].to_numpy()[::-1]] = curves.points[curves.start[:-1]][::-1]
    return first
