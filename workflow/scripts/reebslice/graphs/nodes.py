"""Material points: one inside every region of every level."""

import numpy as np
import shapely

from ..kernels import njit
from ..planar.circles import largest_circles
from ..planar.distances import clearances, nearest_point
from ..planar.outlines import measure_outlines, outline_polygons
from ..slicing.tables import block_regions, region_levels, region_outlines
from ..table_checks import build_table

SAMPLERS = ("inscribed", "representative", "centroid")

# The point of the level below, or the best one near it, is taken while the
# circle around it has at least this share of the largest radius, so that paths
# do not jump about in regions where many circles are nearly largest.
STEADY = 0.9
# Steps of the search for that best one, each at most half as long as a radius.
STEPS = 8
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
        The centre of the largest inscribed circle, which leads along the medial
        axis, or a point near the one below where its circle is nearly as large;
        some point inside; the centre of area, or some point inside where that is
        outside.

    Returns
    -------
    pyarrow.Table
        The table `nodes`, points in the model frame. A region too thin to hold a
        point in floating point gets a point of its outer contour and radius 0.
    """
    outlines, level = region_outlines(contours, curves), region_levels(contours)
    count = len(level)
    if sampler == "inscribed":
        below = single_predecessors(contours, pieces, count)
        points = steady_points(outlines, *inscribed_points(outlines), below)
    else:
        points = points_inside(outline_polygons(outlines), sampler)
    points = np.where(np.isnan(points), _first_points(contours, curves, count), points)
    height = levels["height"].to_numpy()[level]
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


def steady_points(outlines, points, radius, predecessor):
    """Move points to the one below, or near it, where a circle there is nearly as large.

    Parameters
    ----------
    outlines : Outlines
        Of R regions, in ascending order of level.
    points, radius : (R, 2), (R,) float64
        Centres and radii of their largest circles.
    predecessor : (R,) int32
        The only region below in the same block, or -1.

    Returns
    -------
    (R, 2) float64
        Whose clearance is at least `STEADY` times the largest, or the centre.
    """
    return _steady_points(outlines.points, outlines.ring, outlines.start, points, radius, predecessor)


@njit
def _steady_points(outline, ring, start, points, radius, predecessor):
    """As :func:`steady_points`, over the arrays of the outlines."""
    points = points.copy()
    for r in range(len(points)):
        if predecessor[r] >= 0 and radius[r] > 0.0:
            x, y = points[predecessor[r]]
            x, y, gain = _climb(outline, ring, start[r], start[r + 1], x, y, radius[r])
            if gain >= STEADY * radius[r]:
                points[r, 0], points[r, 1] = x, y
    return points


@njit
def _climb(outline, ring, first, end, x, y, radius):
    """Walk away from the outline until the clearance is no less than STEADY x radius, or STEPS are done.

    Returns x, y and the clearance there. The walk stays near where it
    starts: in a ring it goes across, not around.
    """
    stride = 0.5 * radius
    gain, foot_x, foot_y = nearest_point(outline, ring, first, end, x, y)
    for _ in range(STEPS):
        length = np.hypot(x - foot_x, y - foot_y)
        if gain >= STEADY * radius or length == 0.0:
            break
        step = stride / length if gain >= 0.0 else -stride / length
        tried_x, tried_y = x + step * (x - foot_x), y + step * (y - foot_y)
        better, new_x, new_y = nearest_point(outline, ring, first, end, tried_x, tried_y)
        if better > gain:
            x, y, gain, foot_x, foot_y = tried_x, tried_y, better, new_x, new_y
        else:
            stride /= 2
    return x, y, gain


def single_predecessors(contours, pieces, count):
    """Find the regions that are alone below others in their block.

    Parameters
    ----------
    contours, pieces : pyarrow.Table
    count : int
        Number R of regions.

    Returns
    -------
    (R,) int32
        The one region below each region in its block, -1 if there is none or more.
    """
    found = np.full(count, -1, np.int32)
    for below, above in zip(*block_regions(pieces, contours)):
        if len(below) == 1:
            found[above] = below[0]
    return found


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
