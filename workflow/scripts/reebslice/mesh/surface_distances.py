"""Distance from points in space to a surface."""

import numpy as np
from scipy.spatial import cKDTree

from ..arrays.grouping import Groups
from ..kernels import njit


def distance_to_surface(spots, points, faces):
    """Measure how far points are from the nearest point of a surface.

    Parameters
    ----------
    spots : (k, 3) float64
    points, faces : (n, 3) float64 and (m, 3) int
        The surface; every point is in some face.

    Returns
    -------
    (k,) float64
        The radius of the largest ball around each spot that the surface does not enter.

    References
    ----------
    C. Ericson, Real-Time Collision Detection, Morgan Kaufmann 2005, section 5.1.5, on the point of a triangle that is
    nearest to one
    """
    best = cKDTree(points).query(spots)[0] if len(spots) else np.zeros(0)
    corners = points[faces]
    middle = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    size = np.frexp(reach)[1]
    for order in np.unique(size):  # so that a few large faces make no candidates of all small ones
        chosen = np.flatnonzero(size == order)
        near = cKDTree(middle[chosen]).query_ball_point(spots, best * (1 + 1e-12) + reach[chosen].max())
        start = np.cumsum([0, *map(len, near)])
        member = chosen[np.concatenate([np.zeros(0, np.int64), *near]).astype(np.int64)]
        _shorten(best, np.ascontiguousarray(spots), corners, Groups(start, member))
    return best


@njit
def _shorten(best, spots, corners, near):
    """Take the distance of spots to faces near them where it is smaller, in place."""
    for k in range(len(spots)):
        for f in near.member[near.start[k] : near.start[k + 1]]:
            best[k] = min(best[k], _distance(spots[k], corners[f, 0], corners[f, 1], corners[f, 2]))


@njit
def _distance(p, a, b, c):
    """Distance of a point from a triangle."""
    ab, ac = b - a, c - a
    normal = np.array([ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]])
    size = (normal * normal).sum()
    if size > 0:
        ap = p - a
        # of the foot of the perpendicular, in parts of the whole
        v = _triple(ap, ac, normal) / size
        w = _triple(ab, ap, normal) / size
        if v >= 0 and w >= 0 and v + w <= 1:
            return abs((ap * normal).sum()) / np.sqrt(size)
    return min(_to_segment(p, a, b), _to_segment(p, b, c), _to_segment(p, c, a))


@njit(inner=True)
def _triple(u, v, n):
    """The determinant of three vectors."""
    return (u[1] * v[2] - u[2] * v[1]) * n[0] + (u[2] * v[0] - u[0] * v[2]) * n[1] + (u[0] * v[1] - u[1] * v[0]) * n[2]


@njit(inner=True)
def _to_segment(p, a, b):
    """Distance of a point from a segment."""
    step = b - a
    size = (step * step).sum()
    t = min(max(((p - a) * step).sum() / size, 0.0), 1.0) if size > 0 else 0.0
    return np.sqrt(((p - a - t * step) ** 2).sum())
