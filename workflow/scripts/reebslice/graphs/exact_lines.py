"""Plumb lines in rational numbers, where floats leave open what they meet first.

Lines run beside their vertex, as in :mod:`.plumb_lines`. As in
:mod:`..slicing.exact_contours`, the infinitesimal tilt of a level is taken as a
small fraction, and the level lies halfway between the two vertices next to it.
"""

from fractions import Fraction

import numpy as np

from ..slicing.exact_contours import walk_crossings
from .plumb_lines import list_faces

# Direction of rays in levels: parallel to no line through few points of a lattice.
FORWARD = Fraction(0.8765432101234567), Fraction(0.4813349876543211)

AT_FACE = -2


def settle_hits(mesh, scaled, body_of_vertex, lines, hits):
    """Decide which face is first on the lines for which that is doubtful.

    Parameters
    ----------
    mesh : HeightMesh
    scaled : (n, 3) float64
        Its points as of :func:`.exact_signs.scale_points`.
    body_of_vertex : (n,) int32
    lines : (Q,) int64 and (Q,) bool
        Where the lines begin, and which run up.
    hits : LineHits
        Of these lines.

    Returns
    -------
    LineHits or None
        None where two faces in one plane are first.
    """
    doubtful = np.flatnonzero(hits.doubtful)
    if not len(doubtful):
        return hits
    face, rises = hits.face.copy(), hits.rises.copy()
    vertices, upward = (column[doubtful] for column in lines)
    met = list_faces(scaled, mesh.faces, body_of_vertex, vertices, upward)
    for k, v, up, faces in zip(doubtful.tolist(), vertices.tolist(), upward.tolist(), met):
        height = {f: _height_beside(mesh, f, v) for f in faces}
        first = (min if up else max)(faces, key=height.get)
        if list(height.values()).count(height[first]) > 1:
            return None
        face[k], rises[k] = first, _turns_upward(mesh, first)
    return hits._replace(face=face, rises=rises, doubtful=np.zeros(len(face), bool))


def _normal(mesh, face):
    """A corner of a face and its normal, of any length, each three fractions."""
    a, b, c = (list(map(Fraction, mesh.points[v].tolist())) for v in mesh.faces[face])
    u, v = ([end - begin for end, begin in zip(corner, a)] for corner in (b, c))
    return a, (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def _turns_upward(mesh, face):
    """Whether a face looks upward."""
    return _normal(mesh, face)[1][2] > 0


def _height_beside(mesh, face, v):
    """Height of the plane of a face, which is not upright, at a vertex's place, and its slopes along x and y."""
    corner, normal = _normal(mesh, face)
    x, y = map(Fraction, mesh.points[v, :2].tolist())
    slopes = -normal[0] / normal[2], -normal[1] / normal[2]
    return corner[2] + slopes[0] * (x - corner[0]) + slopes[1] * (y - corner[1]), *slopes


def exact_end(mesh, cut, body_of_vertex, line, ends, tilt):
    """Find where one plumb line comes to a level, unless it meets a face before.

    Parameters
    ----------
    mesh : HeightMesh
    cut : LoopCut
    body_of_vertex : (n,) int32
    line : int and bool
        The rank where it begins, and whether it runs up.
    ends : int and int
        The first face that it meets, and the level that it comes to next.
    tilt : Fraction
        What :func:`.exact_contours.exact_tilt` returns.

    Returns
    -------
    int
        The region, or AT_FACE where it meets the face first, or -1 where it comes to the level outside of all
        regions, or where contours touch.
    """
    (v, up), (face, level) = line, ends
    plane = _Level(mesh, int(cut.levels.below[level]), tilt)
    low, high = mesh.faces[face].min(), mesh.faces[face].max()
    if low < plane.cut <= high:
        x, y = map(Fraction, mesh.points[v, :2].tolist())
        height = _height_beside(mesh, face, v)[0] + tilt * x + tilt * tilt * y
        if height < plane.level if up else height > plane.level:
            return AT_FACE
    contours = cut.contours
    first, end = np.searchsorted(contours.level, np.array([level, level + 1], contours.level.dtype))
    hits = []
    for contour in range(first, end):
        if body_of_vertex[contours.lower[contour]] == body_of_vertex[v]:
            region = int(cut.regions.of_contour[contour])
            hits += [
                (distance, region, leaves) for distance, leaves in plane.cross_ray(int(contours.first[contour]), v)
            ]
    if not hits:
        return -1
    distance = min(hits)[0]
    found = {region for far, region, _ in hits if far == distance}
    leaves = any(leaves for far, _, leaves in hits if far == distance)
    return found.pop() if len(found) == 1 and leaves else -1


class _Level:
    """The tilted plane of a level, in exact numbers."""

    def __init__(self, mesh, cut, tilt):
        self.mesh, self.cut, self.tilt = mesh, cut, tilt
        self.level = (self.height(cut - 1) + self.height(cut)) / 2

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

    def cross_ray(self, crossing, v):
        """How far away a contour crosses the ray from the line beside a vertex, and whether the ray leaves there.

        crossing : first half-edge of the contour. Where the ray meets a corner, or starts on a contour, the
        infinitesimals decide by which the line runs beside the vertex.
        """
        low, high = walk_crossings(self.mesh.faces, self.mesh.twins, crossing, self.cut)
        near = self._near_ray(low, high, v)
        start, places, found = tuple(map(Fraction, self.mesh.points[v, :2].tolist())), {}, []
        for k in np.flatnonzero(near | np.roll(near, 1)).tolist():
            for j in (k - 1, k):
                if j not in places:
                    x, y = (a - b for a, b in zip(self.cross(int(low[j]), int(high[j])), start))
                    places[j] = x, y, FORWARD[0] * x + FORWARD[1] * y, FORWARD[0] * y - FORWARD[1] * x
            (px, py, pt, ps), (qx, qy, qt, qs) = places[k - 1], places[k]
            if (ps >= 0) == (
                qs >= 0
            ):  # what is on the line is to its left, as the line runs by the right of the vertex
                continue
            distance = (pt * qs - ps * qt) / (qs - ps)
            ahead = (px - qx if py == qy else qy - py) * (1 if qs < ps else -1) if distance == 0 else distance
            if ahead > 0:
                found.append((distance, qs > ps))
        return found

    def _near_ray(self, low, high, v):
        """Which segments, each from the crossing at its place to the next, may cross the ray's line, by floats."""
        x, y = self.mesh.points[:, 0], self.mesh.points[:, 1]
        aside = float(FORWARD[0]) * (y - y[v]) - float(FORWARD[1]) * (x - x[v])
        least, most = np.minimum(aside[low], aside[high]), np.maximum(aside[low], aside[high])
        margin = 1e-12 * np.abs(self.mesh.points).max()
        return (np.minimum(least, np.roll(least, -1)) <= margin) & (np.maximum(most, np.roll(most, -1)) >= -margin)
