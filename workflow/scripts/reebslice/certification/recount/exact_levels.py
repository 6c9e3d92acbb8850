"""Which contour runs around which, in rational numbers, where floats cannot tell.

A level is taken as a plane that is really tilted, by so little that every
vertex stays on its side. Contours are followed from face to face, and a point
is inside one if that winds around it.
"""

from fractions import Fraction

import numpy as np

from .links import smallest_tilt, whole_points

SPOTS = 5  # points of a contour that are looked at


class ExactLevels:
    """Contours of an unfolded `surface` with its `sides`.

    below : (K,) ranks; level : (C,) of each contour; side : (C,) a mesh edge
    that it crosses
    """

    def __init__(self, surface, sides, below, level, side):
        self.surface, self.sides, self.below, self.level, self.side = surface, sides, below, level, side
        self.known, self.tilt = {}, None

    def ring(self, contour):
        """Locate the corners of a contour, in order.

        Parameters
        ----------
        contour : int

        Returns
        -------
        list of [Fraction, Fraction]
        """
        if contour not in self.known:
            self.tilt = self.tilt or smallest_tilt(self.surface.points)
            cut = int(self.below[self.level[contour]])
            self.known[contour] = self._locate(self._follow(int(self.side[contour]), cut), cut)
        return self.known[contour]

    def area(self, contour):
        """Measure the signed area of a contour.

        Parameters
        ----------
        contour : int

        Returns
        -------
        Fraction
        """
        ring = self.ring(contour)
        return sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(ring, ring[1:] + ring[:1])) / 2

    def share_around(self, contour, inside):
        """Tell how much of another contour one winds around.

        Parameters
        ----------
        contour, inside : int
            Of one level.

        Returns
        -------
        float
            The share of SPOTS points of `inside`.
        """
        ring, other = self.ring(contour), self.ring(inside)
        spots = [_middle(other, k * len(other) // SPOTS) for k in range(SPOTS)]
        return sum(_winding(ring, spot) != 0 for spot in spots) / SPOTS

    def _follow(self, start, cut):
        """Mesh edges that the contour through mesh edge `start` crosses in turn, material on the left.

        That is, from the longest side of a face inward where the face is even.
        """
        sides, found, side = self.sides, [], start
        one, two = sides.faces[start].tolist()
        face = one if (sides.of_face[one, 2] == start) == self.surface.even[one] else two
        while not found or side != start:
            found.append(side)
            ab, bc, ac = sides.of_face[face].tolist()
            across = ab if self.surface.corners[face, 1] >= cut else bc
            side = across if side == ac else ac
            face = int(sides.faces[side].sum()) - face
        return found

    def _locate(self, crossed, cut):
        """Where mesh edges meet the tilted plane just below rank `cut`."""
        ends = np.concatenate([[cut - 1, cut], self.sides.lower[crossed], self.sides.upper[crossed]])
        unit, ((_, _, floor), (_, _, roof), *ends) = whole_points(self.surface.points[ends], self.tilt)
        plane, spots = floor + roof, []  # twice its height
        for (px, py, ph), (qx, qy, qh) in zip(ends[: len(crossed)], ends[len(crossed) :]):
            up, down = (plane - 2 * ph, 2 * qh - plane) if ph != qh else (1, 1)
            spots.append([Fraction(p * down + q * up, unit * (up + down)) for p, q in ((px, qx), (py, qy))])
        return spots


def _middle(ring, start):
    """The middle of the first segment from corner `start` on that has a length."""
    for k in range(start, start + len(ring)):
        (px, py), (qx, qy) = ring[k % len(ring)], ring[(k + 1) % len(ring)]
        if (px, py) != (qx, qy):
            break
    return (px + qx) / 2, (py + qy) / 2


def _winding(ring, spot):
    """How often a closed polygon winds around a point off it: signed crossings of the ray upward."""
    x, y = spot
    turns = 0
    for (px, py), (qx, qy) in zip(ring, ring[1:] + ring[:1]):
        if (px <= x) != (qx <= x):
            above = (py - y) * (qx - px) + (qy - py) * (x - px)  # times (qx - px), the height over the point
            if (above > 0) == (qx > px):
                turns += 1 if qx < px else -1
    return turns
