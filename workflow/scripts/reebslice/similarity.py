"""Boolean 2D shape similarity of regions, and links guessed from it.

The heuristics are for levels whose surface cannot be trusted, and for
comparison; links read off the mesh are in :mod:`reebslice.pieces`.
"""

import numpy as np
import shapely

# Shares above which two shapes of consecutive levels are taken for one part:
# of the smaller shape that lies in the other, for single pairs, and of the
# larger of single shape and union of a group, for joins and splits.
PAIR_SHARE = 0.3
GROUP_SHARE = 0.5


def boolean_similarity(lower, upper):
    """Areas of two sequences of polygons, pair by pair: dict of (E,) float64.

    `similarity` is intersection over union (Ruiz and Cadavid 2001), 0 where
    both are empty.
    """
    area_source, area_target = shapely.area(lower), shapely.area(upper)
    intersection = shapely.area(shapely.intersection(lower, upper))
    union = np.maximum(area_source + area_target - intersection, 0.0)
    return {
        "similarity": np.divide(intersection, union, out=np.zeros_like(union), where=union > 0),
        "area_source": area_source,
        "area_target": area_target,
        "area_intersection": intersection,
        "area_union": union,
    }


def link_by_similarity(lower, upper):
    """Links between the shapes of two consecutive levels: sorted (i, j) pairs.

    lower, upper : sequences of shapely polygons. First the pairs of which one
    shape holds PAIR_SHARE of the smaller; then groups: a shape joins those
    across from it that overlap it if their union fits it better than the
    best of them alone, by GROUP_SHARE of the larger area.
    """
    lower, upper = np.asarray(lower, object), np.asarray(upper, object)
    if len(lower) == 0 or len(upper) == 0:
        return []
    i, j = shapely.STRtree(upper).query(lower, predicate="intersects")
    overlap = shapely.area(shapely.intersection(lower[i], upper[j]))
    smaller = np.minimum(shapely.area(lower[i]), shapely.area(upper[j]))
    links = {
        (int(a), int(b))
        for a, b, part, size in zip(i, j, overlap, smaller)
        if size > 0 and part > PAIR_SHARE * size
    }
    for single, group, area, other, swap in (
        (i, j, shapely.area(lower), upper, False),
        (j, i, shapely.area(upper), lower, True),
    ):
        for shape in np.unique(single).tolist():
            members = group[single == shape]
            if len(members) < 2:
                continue
            union = float(shapely.area(shapely.union_all(other[members])))
            covered = float(overlap[single == shape].sum())
            if covered > GROUP_SHARE * max(union, float(area[shape])):
                links |= {(m, shape) if swap else (shape, m) for m in members.tolist()}
    return sorted(links)


def link_by_proximity(lower, upper):
    """Links to the nearest centroid, both ways: sorted (i, j) pairs."""
    lower, upper = np.asarray(lower, object), np.asarray(upper, object)
    if len(lower) == 0 or len(upper) == 0:
        return []
    p, q = shapely.centroid(lower), shapely.centroid(upper)
    # an empty shape has no centroid and is nearest to nothing
    distance = np.nan_to_num(shapely.distance(p[:, None], q[None]), nan=np.inf)
    upward = {(a, int(b)) for a, b in enumerate(distance.argmin(axis=1))}
    downward = {(int(a), b) for b, a in enumerate(distance.argmin(axis=0))}
    return sorted(upward | downward)
