"""Blocks and regions as later stages see them: from the tables of the slices."""

import numpy as np
import shapely

from .curves import unpack_curves


def block_regions(pieces, contours):
    """Regions below and above every block: two lists of ascending id lists."""
    region, block = contours["region"].to_numpy(), pieces["block"].to_numpy().astype(np.int64)
    count = max(count_regions(contours), 1)
    ends = []
    for side in ("below", "above"):
        bounding = pieces[side].combine_chunks()
        owner = np.repeat(block, np.diff(bounding.offsets.to_numpy()))
        pairs = np.unique(owner * count + region[bounding.flatten().to_numpy()])
        members, cuts = (pairs % count).tolist(), np.searchsorted(pairs, count * np.arange(block.max() + 2)).tolist()
        ends.append([members[a:b] for a, b in zip(cuts[:-1], cuts[1:])])
    return ends


def count_regions(contours):
    """The number of regions; none where all levels pass between the parts of a model."""
    return int(contours["region"].to_numpy().max(initial=-1)) + 1


def region_levels(contours):
    """The level of every region, (R,) int32."""
    region = contours["region"].to_numpy()
    level = np.empty(count_regions(contours), np.int32)
    level[region] = contours["level"].to_numpy()
    return level


def contour_points(contours):
    """The contours as closed curves: points (N, 2), tilted frame, and start (C + 1,)."""
    return unpack_curves(contours["geometry"].to_numpy(zero_copy_only=False))


def contour_rings(contours):
    """The contours as shapely linear rings, (C,).

    None where one is too small to span a triangle in floating point.
    """
    points, start = contour_points(contours)
    length = np.diff(start)
    usable = (length >= 4) & (contours["signed_area"].to_numpy() != 0)
    of_ring, ring = np.repeat(usable, length), np.repeat(np.arange(usable.sum()), length[usable])
    rings = np.full(len(length), None, object)
    rings[usable] = shapely.linearrings(points[of_ring], indices=ring)
    return rings


def region_polygons(contours):
    """The regions as shapely polygons with holes, (R,), tilted frame, all valid.

    Contours without a ring are left out; a region whose outer contour is one
    of them becomes an empty polygon.
    """
    region, inner = contours["region"].to_numpy(), contours["inner"].to_numpy(zero_copy_only=False)
    rings, count = contour_rings(contours), count_regions(contours)
    usable = ~shapely.is_missing(rings)
    has_outer = np.zeros(count, bool)
    has_outer[region[usable & ~inner]] = True
    order = np.flatnonzero(usable & has_outer[region])
    order = order[np.lexsort((inner[order], region[order]))]  # the outer contour first
    polygons = np.full(count, shapely.Polygon(), object)
    present, place = np.unique(region[order], return_inverse=True)
    polygons[present] = shapely.polygons(rings[order], indices=place)
    return mend(polygons)


def mend(polygons):
    """Polygons made valid; others come of surfaces that cross themselves, and of contours that coincide by rounding."""
    broken = ~shapely.is_valid(polygons)
    polygons[broken] = shapely.buffer(shapely.make_valid(polygons[broken]), 0)
    return polygons
