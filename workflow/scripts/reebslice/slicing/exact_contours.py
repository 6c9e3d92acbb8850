"""Contours in exact numbers, for the questions that rounding leaves open.

Inside flats, at flats that are flat but for rounding, and between sheets closer
than rounding, contours coincide in floating point though the surface is
embedded. Here a level is a plane tilted by a small fraction instead of an
infinitesimal one, so small that it orders the vertices as their ranks do; its
contours are then those of the level, and everything about them is decided in
rational numbers. It takes some ten microseconds a crossing, so it is meant for the few
contours that need it.
"""

from fractions import Fraction
from functools import cached_property

import numpy as np

from ..kernels import njit
from ..morse.ordered_mesh import next_half_edge

SPOTS = 5  # points of a contour that tell whether another runs around it


def exact_tilt(points):
    """Find a tilt that orders points by one number as (z, x, y) does.

    The whole spread of what comes later in the order has to stay below half of
    the smallest step of what comes first.

    Parameters
    ----------
    points : (n, 3) float64

    Returns
    -------
    Fraction
        A power of 1/2, e: z + e x + e^2 y has the order of (z, x, y).
    """
    x, y, _ = np.ptp(points, axis=0)
    spreads = (_smallest_step(points[:, 2]), x + y), (_smallest_step(points[:, 0]), y)
    room = min([step / spread for step, spread in spreads if spread > 0] + [1.0])
    return Fraction(1, 2 ** (2 - int(np.floor(np.log2(room)))))


def _smallest_step(values):
    """The least difference of two values that differ; infinite if all are equal."""
    return float(np.diff(np.unique(values)).min(initial=np.inf))


class ExactContours:
    """The contours of a sliced surface, each located when it is first asked for."""

    def __init__(self, mesh, levels, contours):
        self.mesh, self.levels, self.contours = mesh, levels, contours
        self.known, self.boxes = {}, {}

    @cached_property
    def tilt(self):
        """The infinitesimal tilt as a number small enough, a fraction."""
        return exact_tilt(self.mesh.points)

    def corners(self, contour):
        """Corners [(x, y)] of a contour, fractions in its tilted plane; neighbours differ."""
        if contour not in self.known:
            cut = self.levels.below[self.contours.level[contour]]
            first = int(self.contours.first[contour])
            low, high = walk_crossings(self.mesh.faces, self.mesh.twins, first, cut)
            self.known[contour] = locate_corners(self.mesh.points, low.tolist(), high.tolist(), cut, self.tilt)
        return self.known[contour]

    def is_hole(self, contour):
        """Whether a contour runs clockwise."""
        return turns_clockwise(self.corners(contour))

    def around(self, contour, others, inner):
        """Those of `others`, contours of the same level, that run around a contour, innermost first.

        inner : (C,) bool, which contours are holes; it tells where two
        contours coincide within rounding, as those of walls that touch
        """
        found = [other for other in others if other != contour and self._runs_around(other, contour, inner)]
        depth = {o: sum(p != o and self._runs_around(p, o, inner) for p in found) for o in found}
        return sorted(found, key=depth.get, reverse=True)

    def _runs_around(self, outside, contour, inner):
        """Whether a contour runs around another, by `SPOTS` points of that.

        If those disagree, the surfaces touch, and what is between them is
        taken as a gap: the outer contour lies in the hole. Of two outer
        contours or two holes, the one of the larger number is inside.
        """
        corners = self.corners(contour)
        spots = [_middle(corners, k * len(corners) // SPOTS) for k in range(min(SPOTS, len(corners)))]
        low_x, low_y, high_x, high_y = self._box(outside)
        if not any(low_x <= x <= high_x and low_y <= y <= high_y for x, y in spots):
            return False
        votes = [encloses(self.corners(outside), spot) for spot in spots]
        if any(votes) and not all(votes):
            return contour > outside if inner[contour] == inner[outside] else bool(inner[outside])
        return votes[0]

    def _box(self, contour):
        if contour not in self.boxes:
            x, y = zip(*self.corners(contour))
            self.boxes[contour] = min(x), min(y), max(x), max(y)
        return self.boxes[contour]


@njit
def walk_crossings(faces, twins, start, cut):
    """Walk along a contour.

    Parameters
    ----------
    faces, twins : arrays
        Of a :class:`HeightMesh`.
    start : int
        A half-edge of the contour that runs upward.
    cut : int
        Ranks from `cut` on are above the level.

    Returns
    -------
    low, high : (X,) int32
        Ranks of the lower and the upper ends of the mesh edges that the contour crosses in turn.
    """
    low, high, h = [faces[0, 0] for _ in range(0)], [faces[0, 0] for _ in range(0)], start
    while True:
        low.append(faces[h // 3, h % 3])
        high.append(faces[h // 3, (h % 3 + 1) % 3])
        h = next_half_edge(faces, twins, h, cut)
        if h == start:
            return np.array(low), np.array(high)


def locate_corners(points, low, high, cut, tilt):
    """Locate the corners of a contour in its tilted plane.

    Parameters
    ----------
    points : (n, 3) float64
        Of a :class:`HeightMesh`.
    low, high : list of int
        What :func:`walk_crossings` returns.
    cut : int
        Ranks from `cut` on are above the plane, which lies halfway between `cut` and the rank before.
    tilt : Fraction
        What :func:`exact_tilt` returns.

    Returns
    -------
    list of (x, y)
        Fractions; of neighbours that coincide there is one. A contour all in one point has that one.
    """
    known = {v: tuple(map(Fraction, points[v].tolist())) for v in {cut - 1, cut, *low, *high}}
    height = {v: z + tilt * x + tilt * tilt * y for v, (x, y, z) in known.items()}
    level = (height[cut - 1] + height[cut]) / 2
    corners = []
    for p, q in zip(low, high):
        rise = height[q] - height[p]
        share = (level - height[p]) / rise if rise else Fraction(1, 2)
        (px, py, _), (qx, qy, _) = known[p], known[q]
        corners.append((px + share * (qx - px), py + share * (qy - py)))
    return [corner for k, corner in enumerate(corners) if corner != corners[k - 1]] or corners[:1]


def turns_clockwise(corners):
    """Tell whether a closed polygon runs clockwise.

    The turn at the leftmost corner (of these the lowest) is that of the whole,
    and so on for the other three extreme corners; a corner that is visited
    twice is passed over.

    Parameters
    ----------
    corners : list of (x, y)
        Of a simple polygon, which may touch itself in one point. Exact numbers.

    Returns
    -------
    bool
        False if all corners are in one line.
    """
    for key in (
        lambda p: (p[0], p[1]), lambda p: (-p[0], -p[1]), lambda p: (p[1], -p[0]), lambda p: (-p[1], p[0]),
    ):  # fmt: skip
        extreme = min(corners, key=key)
        if corners.count(extreme) > 1:
            continue
        k = corners.index(extreme)
        (ax, ay), (bx, by) = corners[k - 1], corners[(k + 1) % len(corners)]
        turn = (extreme[0] - ax) * (by - ay) - (extreme[1] - ay) * (bx - ax)
        if turn:
            return turn < 0
    return False


def _middle(corners, k):
    """The middle of the segment of a closed polygon that ends in its corner k."""
    (ax, ay), (bx, by) = corners[k], corners[k - 1]
    return (ax + bx) / 2, (ay + by) / 2


def encloses(corners, point):
    """Tell whether a closed polygon runs around a point, by the even-odd rule.

    Parameters
    ----------
    corners : list of (x, y)
        Of the polygon. Exact numbers.
    point : (x, y)
        Not on the polygon.

    Returns
    -------
    bool
        Whether it is inside.
    """
    x, y = point
    inside = False
    px, py = corners[-1]
    for qx, qy in corners:
        if (py > y) != (qy > y) and ((qx - px) * (y - py) > (x - px) * (qy - py)) == (qy > py):
            inside = not inside
        px, py = qx, qy
    return inside
