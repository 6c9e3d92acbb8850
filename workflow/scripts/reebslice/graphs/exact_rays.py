"""Rays in rational numbers, where floats leave open around which contours an event of a hole lies.

As in :mod:`..slicing.exact_contours`, the infinitesimal tilt of the level is
taken as a small fraction. The ray goes the way of those in floats; what ends
exactly on its line counts as to the right of it.
"""

from fractions import Fraction

import numpy as np

from ..slicing.exact_contours import walk_crossings
from .ray_hosts import ROUNDING, TURN

FORWARD = tuple(map(Fraction, TURN))


def exact_host(mesh, graph, inner, place, crossed, tilt):
    """Find the outer contour around one event of a hole.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's.
    inner : (A,) bool
        Whether each arc is a hole.
    place : int
        Of the event, in `graph.nodes`.
    crossed : (F,) int64 and (F,) int64
        The faces that the level right below the event crosses, and the arc of the contour in each.
    tilt : Fraction
        What :func:`.exact_contours.exact_tilt` returns.

    Returns
    -------
    int or None
        The arc. None where the contours around the event fit no solid, one passes through the start of the ray, or
        the ray leaves two of them at one place, as where sheets touch.
    """
    plane = _Plane(mesh, int(graph.nodes[place]), tilt)
    own = graph.arcs[crossed[1], 1] == place
    start = plane.find_start(crossed[0][own])
    if start is None:
        return None
    faces, arcs = (column[~own] for column in crossed)
    near = _near_line(mesh, faces, start)
    winding, last = {}, {}
    for face, arc in zip(faces[near].tolist(), arcs[near].tolist()):
        sign, distance = plane.cross_ray(face, start)
        if sign is None:
            return None
        if sign:
            winding[arc] = winding.get(arc, 0) + sign
            last[arc] = max(last.get(arc, distance), distance)
    around = {arc: turns for arc, turns in winding.items() if turns}
    if sum(around.values()) != 1 or any(turns != (-1 if inner[arc] else 1) for arc, turns in around.items()):
        return None
    first, *others = sorted((arc for arc, turns in around.items() if turns > 0), key=last.get)
    return None if others and last[others[0]] == last[first] else first


def _near_line(mesh, faces, start):
    """Which faces the line of the ray may cross, by floats; a margin takes in what rounding might leave out."""
    offset = TURN[0] * mesh.points[:, 1] - TURN[1] * mesh.points[:, 0]
    margin = 4 * ROUNDING * np.abs(mesh.points).max()
    corners, aside = offset[mesh.faces[faces]], float(FORWARD[0] * start[1] - FORWARD[1] * start[0])
    return (corners.min(axis=1) <= aside + margin) & (corners.max(axis=1) >= aside - margin)


class _Plane:
    """The tilted plane right below an event, in exact numbers; through the event itself, where that has one copy."""

    def __init__(self, mesh, v, tilt):
        self.mesh, self.v, self.tilt = mesh, v, tilt
        self.unfolded = bool((mesh.vertex[max(v - 1, 0) : v + 2] == mesh.vertex[v]).sum() > 1)
        below, here = self.height(v - 1), self.height(v)
        self.level = (below + here) / 2 if self.unfolded else here

    def height(self, v):
        """Height over the tilted plane."""
        x, y, z = map(Fraction, self.mesh.points[v].tolist())
        return z + self.tilt * x + self.tilt * self.tilt * y

    def cross(self, low, high):
        """Where the mesh edge between two ranks crosses the plane: x, y."""
        bottom, top = self.height(low), self.height(high)
        share = (self.level - bottom) / (top - bottom) if top > bottom else Fraction(1, 2)
        (px, py), (qx, qy) = (tuple(map(Fraction, self.mesh.points[v, :2].tolist())) for v in (low, high))
        return px + share * (qx - px), py + share * (qy - py)

    def find_start(self, own):
        """The vertex or, of an unfolded saddle, amid a segment of its contour that is off it; own : faces there."""
        if not self.unfolded:
            return tuple(map(Fraction, self.mesh.points[self.v, :2].tolist()))
        _, gate = self._sides(int(own[0]))
        ends = np.column_stack(walk_crossings(self.mesh.faces, self.mesh.twins, gate, self.v))
        off = (self.mesh.vertex[ends] != self.mesh.vertex[self.v]).all(axis=1).tolist()
        ends = ends.tolist()
        for k in range(len(ends)):
            if off[k - 1] and off[k]:
                one, other = self.cross(*ends[k - 1]), self.cross(*ends[k])
                if one != other:
                    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2
        return None

    def _sides(self, face):
        """Half-edges through which the contour comes into a face and leaves it, each as its number."""
        up = [rank >= self.v for rank in self.mesh.faces[face].tolist()]
        turns = list(zip(up, up[1:] + up[:1]))
        return 3 * face + turns.index((True, False)), 3 * face + turns.index((False, True))

    def cross_ray(self, face, start):
        """How the contour in a face crosses the ray: 1 to the left, -1 to the right, 0 not at all; and how far away.

        None if it passes through the start.
        """
        ends = []
        for h in self._sides(face):
            ranks = sorted((int(self.mesh.faces[face, h % 3]), int(self.mesh.faces[face, (h % 3 + 1) % 3])))
            x, y = (end - from_ for end, from_ in zip(self.cross(*ranks), start))
            ends.append((FORWARD[0] * x + FORWARD[1] * y, FORWARD[0] * y - FORWARD[1] * x))
        (pt, ps), (qt, qs) = ends
        if (ps > 0) == (qs > 0):
            touches = ps == qs == 0 and min(pt, qt) <= 0 <= max(pt, qt)
            return (None if touches or (0, 0) in ends else 0), None
        distance = (pt * qs - ps * qt) / (qs - ps)
        if distance == 0:
            return None, None
        return (0 if distance < 0 else 1 if qs > 0 else -1), distance
