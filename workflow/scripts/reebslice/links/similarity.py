"""Boolean 2D shape similarity of regions, and links guessed from it.

The heuristics are for levels whose surface cannot be trusted, and for
comparison; links read off the mesh are in :mod:`reebslice.slicing.pieces`. Every rule
takes the shapes of all levels at once: `level` (R,) ascending, `height` (R,)
and `shapes` (R,) polygons, and returns links as a sorted list of pairs of
places in these arrays, the lower first.
"""

from typing import NamedTuple

import numpy as np
import shapely

from ..arrays.components import connected_items
from ..planar.outlines import find_outlines, outline_areas, outline_polygons, pick_outlines
from ..planar.shared_areas import shared_areas

# Tuned on half of a corpus, see docs/connectivity.md. Of the smaller of two
# shapes this share must lie in the other.
LEAST_SHARE = 0.1
# Shapes without a partner that do not even overlap are one part if they are
# no further apart than this many times the distance of their levels.
FARTHEST = 0.7


def boolean_similarity(outlines, low, high):
    """Measure what pairs of regions have in common.

    Parameters
    ----------
    outlines : Outlines
        Valid, of R regions.
    low, high : (E,) int
        The two regions of every pair.

    Returns
    -------
    dict of str to (E,) float64
        `similarity`: intersection over union (Ruiz and Cadavid 2001), 0 where both regions are empty;
        `area_source`, `area_target` : areas of the regions `low` and `high`; `area_intersection`, `area_union`.
    """
    area, shared = outline_areas(outlines), shared_areas(outlines, low, high)
    slow = np.isnan(shared)
    one, other = (outline_polygons(pick_outlines(outlines, end[slow])) for end in (low, high))
    shared[slow] = shapely.area(shapely.intersection(one, other))
    intersection = np.clip(shared, 0.0, np.minimum(area[low], area[high]))  # rounding may lead beyond
    union = area[low] + area[high] - intersection
    return {
        "similarity": np.divide(intersection, union, out=np.zeros_like(union), where=union > 0),
        "area_source": area[low],
        "area_target": area[high],
        "area_intersection": intersection,
        "area_union": union,
    }


class Pairs(NamedTuple):
    """Shapes of consecutive levels that lie near each other, E pairs.

    Attributes
    ----------
    low, high : (E,) int
        Places in the arrays of shapes.
    similarity, overlap : (E,) float64
        Intersection over union, and area of the intersection.
    share : (E,) float64
        The part of the smaller shape that lies in the other.
    """

    low: np.ndarray
    high: np.ndarray
    similarity: np.ndarray
    overlap: np.ndarray
    share: np.ndarray


def near_pairs(level, height, shapes):
    """Find the pairs of shapes of which a rule may link some.

    Parameters
    ----------
    level : (R,) int
        Ascending.
    height : (R,) float64
        Mesh units.
    shapes : (R,) array of shapely polygons
        Valid ones.

    Returns
    -------
    Pairs
        Shapes that overlap are among them, and those no further apart than FARTHEST times their levels, by boxes.
    """
    low, high = neighbours(level, height, shapes, FARTHEST)
    measured = boolean_similarity(find_outlines(shapes), low, high)
    smaller = np.minimum(measured["area_source"], measured["area_target"])
    overlap = measured["area_intersection"]
    share = np.divide(overlap, smaller, out=np.zeros_like(smaller), where=smaller > 0)
    return Pairs(low, high, measured["similarity"], overlap, share)


def link_by_similarity(level, height, shapes, pairs=None):
    """Link the shapes of consecutive levels that are most similar.

    1. A shape belongs with the one across from it that is most similar to it,
       if at least LEAST_SHARE of the smaller lies in the other. Several that
       choose one and the same are a join or a split.
    2. Shapes left without a partner on both sides: those that overlap at all
       are paired, most similar first, else those that lie nearest to each
       other, up to FARTHEST times the distance of their levels.
    3. Shapes that links hold together are one part of the solid, all of whose
       shapes below are linked to all above, as the links of the mesh are.

    Parameters
    ----------
    level, height, shapes
        As for :func:`near_pairs`.
    pairs : Pairs, optional
        Theirs, if they are at hand.

    Returns
    -------
    list of (low, high)
        Sorted.
    """
    low, high, similarity, _, share = pairs = pairs or near_pairs(level, height, shapes)
    linked = (share >= LEAST_SHARE) & (_is_best(low, similarity) | _is_best(high, similarity))
    rest = np.flatnonzero(~np.isin(low, low[linked]) & ~np.isin(high, high[linked]))
    linked[rest[_pair_rest(height, shapes, Pairs(*(column[rest] for column in pairs)))]] = True
    return complete_links(low[linked], high[linked])


def _pair_rest(height, shapes, rest):
    """Which pairs of shapes without a partner belong together, step 2 of :func:`link_by_similarity`."""
    distance = shapely.distance(shapes[rest.low], shapes[rest.high])
    closeness = np.where(rest.overlap > 0, rest.similarity, -distance)
    near = distance <= FARTHEST * (height[rest.high] - height[rest.low])
    closeness[~near & (rest.overlap <= 0)] = -np.inf
    return np.isfinite(closeness) & _is_best(rest.low, closeness) & _is_best(rest.high, closeness)


def link_by_proximity(level, height, shapes):
    """Link every shape to that with the nearest centroid, at the level above and at the level below.

    Parameters
    ----------
    level, height, shapes
        As for :func:`near_pairs`; `height` is not used.

    Returns
    -------
    list of (low, high)
        Sorted. An empty shape has no centroid and is linked to none.
    """
    from scipy.spatial import cKDTree  # takes long to load, and only this rule needs it

    present = np.flatnonzero(~shapely.is_empty(shapes))
    centroid = shapely.get_coordinates(shapely.centroid(shapes[present]))
    if len(present) == 0:
        return []
    # a third coordinate keeps levels further apart than any centroids of one level
    spread = 2 * np.hypot(*np.ptp(centroid, axis=0)) or 1.0
    floor = level[present]
    tree = cKDTree(np.column_stack([centroid, floor * spread]))
    pairs = set()
    for step in (1, -1):
        nearest = tree.query(np.column_stack([centroid, (floor + step) * spread]))[1]
        found = np.flatnonzero(floor[nearest] == floor + step)
        ends = present[found], present[nearest[found]]
        pairs |= set(zip(*(end.tolist() for end in ends[::step])))
    return sorted(pairs)


def neighbours(level, height, shapes, reach=0.0):
    """Find pairs of shapes of consecutive levels whose boxes come near each other.

    Parameters
    ----------
    level, height, shapes
        As for :func:`near_pairs`.
    reach : float
        How near, as a multiple of the distance of their levels.

    Returns
    -------
    low, high : (E,) int
        Places of the shapes.
    """
    present = np.flatnonzero(~shapely.is_empty(shapes))
    box, floor = shapely.bounds(shapes[present]), level[present]
    if len(present) == 0:
        return present, present
    height_of_level = np.full(level[-1] + 2, -np.inf)
    height_of_level[level] = height
    margin = reach * np.maximum(height_of_level[floor + 1] - height[present], 0.0)
    # one tree for all slabs: they lie side by side in x, out of each other's reach
    stride = 2 * (np.ptp(box[:, [0, 2]]) + margin.max()) or 1.0
    grown = _boxes(box + np.outer(margin, [-1, -1, 1, 1]), (floor + 1) * stride)
    low, high = shapely.STRtree(_boxes(box, floor * stride)).query(grown)
    return present[low], present[high]


def complete_links(low, high):
    """Link all shapes below to all above in each connected set of links.

    Parameters
    ----------
    low, high : (E,) int
        The links.

    Returns
    -------
    list of (low, high)
        Sorted.
    """
    if len(low) == 0:
        return []
    lower, i = np.unique(low, return_inverse=True)
    upper, j = np.unique(high, return_inverse=True)
    count = len(lower) + len(upper)
    part = connected_items(i, len(lower) + j, count)
    below, above = part[: len(lower)], part[len(lower) :]
    order = np.argsort(above, kind="stable")
    first, last = (np.searchsorted(above[order], below, side=side) for side in ("left", "right"))
    source = np.repeat(np.arange(len(lower)), last - first)
    place = np.arange(len(source)) - np.repeat(np.cumsum(last - first) - last, last - first)
    return sorted(zip(lower[source].tolist(), upper[order[place]].tolist()))


def _is_best(end, score):
    """Whether each pair has the highest score among those with the same end, (E,) bool."""
    highest = np.full(end.max(initial=-1) + 1, -np.inf)
    np.maximum.at(highest, end, score)
    return score == highest[end]


def _boxes(bounds, shift):
    """Rectangles from bounds (n, 4), moved in x."""
    return shapely.box(bounds[:, 0] + shift, bounds[:, 1], bounds[:, 2] + shift, bounds[:, 3])
