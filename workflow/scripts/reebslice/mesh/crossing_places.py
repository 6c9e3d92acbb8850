"""What the record of an inspection says of faces that cross: how many pairs, and where the first of them meet."""

import numpy as np

from .faults import format_point
from .self_crossings import MOST, find_crossings
from .shells import cast_rays

LISTED = 8  # pairs whose faces and place are told, of one body and of two

CLEAR = 1e-5  # of a face's height, how far beyond a fold the material around is looked at


def describe_crossings(points, faces, body):
    """Find the faces that cross, and tell of them.

    Parameters
    ----------
    points, faces : (n, 3) float64, mesh units, and (m, 3) int
        As `self_crossings.find_crossings` wants them.
    body : (m,) int
        The body that each face bounds.

    Returns
    -------
    dict
        The fields `self_crossings`, `body_crossings`, `crossing_places` and
        `crossings` of `record.Inspection`.
    """
    found = find_crossings(points, faces)
    pairs = np.delete(found.pairs, _find_slots(points, faces, body, found), axis=0)
    one, two = body[pairs].T
    groups = pairs[one == two], pairs[one != two]
    listed = [pair for group in groups for pair in group[:LISTED]]
    places = [
        {
            "faces": pair.tolist(),
            "bodies": body[pair].tolist(),
            "point": locate_meeting(*points[faces[pair]]).tolist(),
        }
        for pair in listed
    ]
    told = [
        _tell(len(group), whose, next(place for place in places if (place["bodies"][0] == place["bodies"][1]) == same))
        for group, whose, same in zip(groups, ("one body", "different bodies"), (True, False))
        if len(group)
    ]
    if not found.complete:
        told.append(f"the search stopped at {MOST}, and there are more")
    return {
        "self_crossings": len(groups[0]),
        "body_crossings": len(groups[1]),
        "crossing_places": places,
        "crossings": "; ".join(told),
    }


def _find_slots(points, faces, body, found):
    """Which of the pairs are the sides of a slot of no width: folds with material of their own body all around.

    Just beyond the mesh edge that they share, a point is inside, where that of
    a fin of no thickness is outside. Folds of faces that cross others besides, as those of pleats do, are none.
    """
    crossed = np.isin(found.pairs, found.pairs[~found.folded]).any(axis=1)
    folds = np.flatnonzero(found.folded & ~crossed)
    if not len(folds):
        return folds
    beyond = np.array([_look_beyond(points, *faces[pair]) for pair in found.pairs[folds]])
    owner, slot = body[found.pairs[folds, 0]], np.zeros(len(folds), bool)
    margin = 1e-14 * np.abs(points).max()
    for one in np.unique(owner):
        here = np.flatnonzero(owner == one)
        here = here[np.argsort(beyond[here, 0], kind="stable")]
        inside, on = cast_rays(points, faces[body == one], beyond[here], margin)
        slot[here] = inside & ~on
    return folds[slot]


def _look_beyond(points, f, g):
    """A point beyond the middle of the mesh edge that two faces share, by a little of the height of the first."""
    shared = np.isin(f, g)
    middle = points[f[shared]].mean(axis=0)
    return middle + CLEAR * (middle - points[f[~shared][0]])


def _tell(count, whose, first):
    pairs = "1 pair of faces" if count == 1 else f"{count} pairs of faces"
    faces = " and ".join(map(str, first["faces"]))
    return f"{pairs} of {whose} cross or lie folded, the first, {faces}, at {format_point(np.array(first['point']))}"


def locate_meeting(f, g):
    """Locate a point in the middle of where two triangles meet, to within rounding.

    Parameters
    ----------
    f, g : (3, 3) float64, mesh units
        Corners of each.

    Returns
    -------
    (3,) float64
    """
    unit = np.abs(np.concatenate([f, g])).max()
    f, g = f / unit, g / unit
    normal = _normal(g)
    heights = (f - g[0]) @ normal
    shape = f if np.abs(heights).max() < 1e-12 else _cut(f, heights)
    for k in range(3):
        inward = np.cross(normal, g[(k + 1) % 3] - g[k])
        clipped = _clip(shape, (shape - g[k]) @ inward)
        shape = clipped if len(clipped) else shape
    return shape.mean(axis=0) * unit


def _normal(f):
    normal = np.cross(f[1] - f[0], f[2] - f[0])
    return normal / max(np.linalg.norm(normal), np.finfo(float).tiny)


def _cut(f, heights):
    """The points in which a triangle meets the plane over which its corners have these heights."""
    ends = [f[k] for k in range(3) if heights[k] == 0]
    for i, j in ((0, 1), (1, 2), (2, 0)):
        if heights[i] * heights[j] < 0:
            ends.append(f[i] + (f[j] - f[i]) * (heights[i] / (heights[i] - heights[j])))
    return np.array(ends) if ends else f


def _clip(shape, rise):
    """The part of a convex polygon whose corners rise above a line (Sutherland and Hodgman 1974)."""
    kept = []
    for k in range(len(shape)):
        if rise[k] >= 0:
            kept.append(shape[k])
        if rise[k - 1] * rise[k] < 0:
            kept.append(shape[k - 1] + (shape[k] - shape[k - 1]) * (rise[k - 1] / (rise[k - 1] - rise[k])))
    return np.array(kept)
