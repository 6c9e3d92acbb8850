"""Material points: one inside every region of every level."""

import numpy as np
import shapely

from .blocks import block_regions, contour_curves, region_levels, region_polygons
from .schemas import build_table

SAMPLERS = ("inscribed", "representative", "centroid")

# The point of the level below, or the best one near it, is taken while the
# circle around it has at least this share of the largest radius, so that paths
# do not jump about in regions where many circles are nearly largest.
STEADY = 0.9
# Steps of the search for that best one, each at most half as long as a radius.
STEPS = 8
# Of the search for the largest circle, whose time grows as its inverse.
PRECISION = 0.05


def sample_nodes(contours, pieces, levels, rotation, sampler="inscribed"):
    """The table `nodes`: a material point per region per level.

    sampler : "inscribed", centre of the largest inscribed circle, which leads
        along the medial axis; "representative", some point inside;
        "centroid", the centre of area; where that is outside the material,
        some point inside.
    rotation : (3, 3) to the tilted frame; nodes are given in the model frame.

    A region too thin to hold a point in floating point gets a point of its
    outer contour and the radius 0.
    """
    regions = region_polygons(contours)
    level = region_levels(contours)
    points = inscribed_points(regions) if sampler == "inscribed" else shapely.point_on_surface(regions)
    if sampler == "centroid":
        centre = shapely.centroid(regions)
        points = np.where(shapely.contains(regions, centre), centre, points)
    points = np.where(shapely.is_empty(points), _first_points(contours, len(regions)), points)
    if sampler == "inscribed":
        points = steady_points(regions, points, level, single_predecessors(contours, pieces, len(regions)))
    height = levels["height"].to_numpy()[level]
    tilted = np.column_stack([shapely.get_coordinates(points), height])
    return build_table(
        "nodes",
        {
            "node": np.arange(len(regions)),
            "level": level,
            "region": np.arange(len(regions)),
            "height": height,
            **dict(zip("xyz", (tilted @ np.asarray(rotation)).T)),
            "critical": critical_regions(contours, pieces, len(regions)),
            "area": np.bincount(contours["region"].to_numpy(), contours["signed_area"].to_numpy(), len(regions)),
            "inscribed_radius": np.maximum(_clearance(regions, points), 0.0),
            "n_holes": np.bincount(contours["region"].to_numpy(), minlength=len(regions)) - 1,
        },
    )


def inscribed_points(regions):
    """Centres of the largest inscribed circles, (R,) points.

    Their radius is the largest up to PRECISION times twice the area over the
    perimeter, which is the radius of a disk and the width of a strip.
    """
    box = shapely.bounds(regions)
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = 2 * shapely.area(regions) / shapely.length(regions)
    extent = np.nan_to_num(np.maximum(box[:, 2] - box[:, 0], box[:, 3] - box[:, 1]))
    tolerance = np.maximum(PRECISION * np.nan_to_num(scale), 1e-6 * extent)
    searchable = shapely.area(regions) > 0
    points = shapely.point_on_surface(regions)
    circles = shapely.maximum_inscribed_circle(regions[searchable], tolerance[searchable])
    points[searchable] = shapely.get_point(circles, 0)
    return points


def steady_points(regions, points, level, predecessor):
    """Points moved to the one below, or near it, where a circle there is nearly as large.

    points : (R,) shapely points, none empty; level : (R,) ascending;
    predecessor : (R,) the only region below in the same block, or -1.
    """
    points = points.copy()
    radius = _clearance(regions, points)
    for height in np.unique(level):
        here = np.flatnonzero((level == height) & (predecessor >= 0) & (radius > 0))
        near = climb(regions[here], points[predecessor[here]], radius[here])
        keep = _clearance(regions[here], near) >= STEADY * radius[here]
        points[here[keep]] = near[keep]
    return points


def climb(regions, points, radius):
    """Walk away from the boundary until the clearance is no less than STEADY x radius, or STEPS are done.

    regions, points : (k,) shapely; radius : (k,) of the largest circles. The
    walk stays near where it starts: in a ring it goes across, not around.
    """
    points, stride = points.copy(), 0.5 * radius
    gain = _clearance(regions, points)
    for _ in range(STEPS):
        active = np.flatnonzero(gain < STEADY * radius)
        if len(active) == 0:
            break
        lines = shapely.shortest_line(shapely.boundary(regions[active]), points[active])
        foot, place = shapely.get_coordinates(lines).reshape(-1, 2, 2).transpose(1, 0, 2)
        away = (place - foot) * np.where(gain[active] >= 0, 1, -1)[:, None]
        length = np.linalg.norm(away, axis=1, keepdims=True)
        away = np.divide(away, length, out=np.zeros_like(away), where=length > 0)
        tried = shapely.points(place + stride[active, None] * away)
        better = _clearance(regions[active], tried)
        wins = better > gain[active]
        points[active[wins]], gain[active[wins]] = tried[wins], better[wins]
        stride[active[~wins]] /= 2
    return points


def _clearance(regions, points):
    """Distance to the boundary, negative outside, 0 where there is no region."""
    distance = np.nan_to_num(shapely.distance(shapely.boundary(regions), points))
    return np.where(shapely.contains(regions, points), distance, -distance)


def single_predecessors(contours, pieces, count):
    """For each region the one region below it in its block, else -1: (R,) int32."""
    found = np.full(count, -1, np.int32)
    for below, above in zip(*block_regions(pieces, contours)):
        if len(below) == 1:
            found[above] = below[0]
    return found


def critical_regions(contours, pieces, count):
    """Regions next to a block that holds an event, (R,) bool: the paper's V."""
    eventful = {b for b, ranks in zip(pieces["block"].to_pylist(), pieces["critical_ranks"].to_pylist()) if ranks}
    critical = np.zeros(count, bool)
    for block, (below, above) in enumerate(zip(*block_regions(pieces, contours))):
        if block in eventful:
            critical[below + above] = True
    return critical


def _first_points(contours, count):
    """The first point of each region's first contour, for regions without room."""
    first = np.empty(count, object)
    first[contours["region"].to_numpy()[::-1]] = shapely.get_point(contour_curves(contours), 0)[::-1]
    return first
