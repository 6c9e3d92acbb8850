"""Faces cut along the contours at which the arc changes: a mesh that is closed as the surface is.

A cut meets a mesh edge in one point, named by the edge and the level, and both
faces beside the edge use that point; one that lies at an end of the edge is that vertex. So
the cut mesh has no gaps, by construction.
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from ..morse.ordered_mesh import next_half_edge
from ..slicing.levels import vertex_slabs


class FaceParts(NamedTuple):
    """Q parts of faces, each between two levels or cut on one side or none, in order of faces and upward.

    Attributes
    ----------
    face : (Q,) int32
        Face of the height mesh.
    label : (Q,) int64
        Label of the pieces that it is part of.
    low, high : (Q,) int32
        The levels at which it is cut below and above; -1 for none.
    """

    face: np.ndarray
    label: np.ndarray
    low: np.ndarray
    high: np.ndarray


class CutMesh(NamedTuple):
    """A surface of n vertices, cut: T triangles and what else runs through its points.

    Attributes
    ----------
    points : (X, 3) float64
        Points on mesh edges, tilted frame; they are numbered from n on.
    triangles : (T, 3) int64
        Vertices of the surface, or points from n on; counter-clockwise seen from outside.
    part : (T,) int64
        The part of a face that each is of. A part that is no more than a line has none.
    rings : list of (k,) int64
        Of each contour that was asked for the points along it, material on the left.
    """

    points: np.ndarray
    triangles: np.ndarray
    part: np.ndarray
    rings: list


def middle_pieces(mesh, slices):
    """Find the piece of each face in which its middle lies.

    Parameters
    ----------
    mesh : HeightMesh
        Of m faces.
    slices : EventSlices

    Returns
    -------
    (m,) int32
        The piece of the middle corner or, where that is at the height of a cut, that right below or right above it, on
        whichever side more of the face lies.
    """
    return _middle_pieces(mesh, vertex_slabs(mesh, slices.levels), slices.levels.height, *_of_slices(slices))


def _of_slices(slices):
    """What tells the piece of a face in a slab."""
    return slices.crossings, slices.pieces.piece_above, slices.surfaces.of_vertex


@njit(inline="always")
def _piece_at(f, s, lowest, crossings, piece_above, of_vertex, corner):
    """The piece of face f in slab s, where `lowest` is the slab of its lowest corner."""
    if s == lowest:
        return of_vertex[corner]
    return piece_above[crossings.label[crossings.offset[f] + s - 1 - lowest]]


@njit
def _middle_pieces(mesh, slab, height, crossings, piece_above, of_vertex):
    """Kernel of `middle_pieces`; height : of the levels."""
    points, faces = mesh.points, mesh.faces
    found = np.empty(len(faces), np.int32)
    for f in range(len(faces)):
        a, b, c = faces[f]
        middle, top = min(b, c), max(b, c)
        s, z = slab[middle], points[middle, 2]
        below = z - points[a, 2] >= points[top, 2] - z
        while below and s > slab[a] and height[s - 1] == z:
            s -= 1
        while not below and s < slab[top] and height[s] == z:
            s += 1
        found[f] = _piece_at(f, s, slab[a], crossings, piece_above, of_vertex, a)
    return found


def part_faces(mesh, slices, label):
    """Part faces where the label of the surface changes.

    Parameters
    ----------
    mesh : HeightMesh
    slices : EventSlices
        Of P pieces.
    label : (P,) int
        Of pieces; where it is the same on both sides of a level, nothing is cut.

    Returns
    -------
    FaceParts
        Of every face at least one.
    """
    slab = vertex_slabs(mesh, slices.levels)
    label, known = np.asarray(label, np.int64), _of_slices(slices)
    count = _list_parts(mesh.faces, slab, *known, label, FaceParts(*np.empty((4, 0), np.int64)))
    parts = FaceParts(*(np.empty(count, kind) for kind in (np.int64, np.int64, np.int64, np.int64)))
    _list_parts(mesh.faces, slab, *known, label, parts)
    return parts


@njit
def _list_parts(faces, slab, crossings, piece_above, of_vertex, label, parts):
    """Count the parts of all faces and list as many as there is room for."""
    place, room = 0, len(parts.face)
    for f in range(len(faces)):
        a, top = faces[f, 0], max(faces[f, 1], faces[f, 2])
        low, here = -1, label[of_vertex[a]]
        for s in range(slab[a], slab[top] + 1):
            following = np.int64(-2)
            if s < slab[top]:
                following = label[_piece_at(f, s + 1, slab[a], crossings, piece_above, of_vertex, a)]
            if following != here:
                if place < room:
                    parts.face[place], parts.label[place], parts.low[place] = f, here, low
                    parts.high[place] = s if s < slab[top] else -1
                place += 1
                low, here = s, following
    return place


def cut_mesh(mesh, slices, parts, count, contours=()):
    """Cut faces into triangles.

    Parameters
    ----------
    mesh : HeightMesh
    slices : EventSlices
    parts : FaceParts
        Of :func:`part_faces`.
    count : int
        Number n of vertices of the surface, of which `mesh.vertex` tells.
    contours : (k,) int
        Contours whose points are asked for, at levels at which the faces are cut.

    Returns
    -------
    CutMesh
        Faces without area that unfolding made are left out.
    """
    below = slices.levels.below
    corners = _list_corners(mesh.faces, below, parts).reshape(-1, 3)
    contours = np.asarray(contours, np.int64)
    length, ends = _walk_rings(mesh, below, slices.contours.level, slices.contours.first, contours)
    points, name = _name_points(mesh, slices.levels, np.concatenate([corners, ends]), count)
    outlines, rings = name[: len(corners)].reshape(-1, 5), np.split(name[len(corners) :], np.cumsum(length)[:-1])
    triangles, part = _cut_fans(outlines)
    return CutMesh(points, triangles, part, [_drop_repeats(ring) for ring in rings] if len(contours) else [])


@njit
def _list_corners(faces, below, parts):
    """Corners of parts of faces, five or less of each: lower and upper rank of a mesh edge, and level; else -1."""
    found = np.full((len(parts.face), 5, 3), -1)
    for p in range(len(parts.face)):
        f, low, high, place = parts.face[p], parts.low[p], parts.high[p], 0
        for k in range(3):
            v, w = faces[f, k], faces[f, (k + 1) % 3]
            if (low < 0 or v >= below[low]) and (high < 0 or v < below[high]):
                found[p, place, 0] = found[p, place, 1] = v
                place += 1
            one, two = (low, high) if v < w else (high, low)
            for level in (one, two):
                if level >= 0 and (v < below[level]) != (w < below[level]):
                    found[p, place, 0], found[p, place, 1], found[p, place, 2] = min(v, w), max(v, w), level
                    place += 1
    return found


@njit
def _walk_rings(mesh, below, level, first, contours):
    """Numbers of points of contours, and of each point lower and upper rank of its mesh edge, and level."""
    faces, twins = mesh.faces, mesh.twins
    length = np.zeros(len(contours), np.int64)
    for i in range(len(contours)):
        h = start = np.int64(first[contours[i]])
        while length[i] == 0 or h != start:
            length[i] += 1
            h = np.int64(next_half_edge(faces, twins, h, below[level[contours[i]]]))
    ends, place = np.empty((length.sum(), 3), np.int64), 0
    for i in range(len(contours)):
        h = np.int64(first[contours[i]])
        for _ in range(length[i]):
            ends[place, 0], ends[place, 1] = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
            ends[place, 2] = level[contours[i]]
            place += 1
            h = np.int64(next_half_edge(faces, twins, h, below[level[contours[i]]]))
    return length, ends


def _name_points(mesh, levels, corners, count):
    """Points (X, 3) on mesh edges, and the name of each corner: a vertex, or from `count` on a point; -1 for none."""
    share = _find_shares(mesh.points, levels, corners)
    name = np.where(corners[:, 0] >= 0, mesh.vertex[np.where(share < 1, corners[:, 0], corners[:, 1])], -1).astype(int)
    inside = np.flatnonzero((share > 0) & (share < 1))
    low, high, level = corners[inside].T
    keys = np.column_stack([mesh.vertex[low], mesh.vertex[high], level])
    order = np.lexsort(keys.T[::-1])
    is_new = np.ones(len(order), bool)
    is_new[1:] = (keys[order][1:] != keys[order][:-1]).any(axis=1)
    name[inside[order]] = count + np.cumsum(is_new) - 1
    one = order[is_new]
    start, end, t = mesh.points[low[one]], mesh.points[high[one]], share[inside[one], None]
    points = start + t * (end - start)
    rising = start[:, 2] < end[:, 2]
    points[rising, 2] = levels.height[level[one][rising]]
    return points, name


@njit
def _find_shares(points, levels, corners):
    """Where between the ends of its mesh edge each corner lies: 0 is the lower end, a vertex itself is at 0."""
    share = np.zeros(len(corners))
    for i in range(len(corners)):
        low, high, level = corners[i]
        if level < 0:
            continue
        a, b, t = points[low], points[high], 0.0  # the copies of a saddle are one point
        if a[2] < b[2]:
            t = (levels.height[level] - a[2]) / (b[2] - a[2])
        elif a[0] < b[0]:
            t = (levels.tie_x[level] - a[0]) / (b[0] - a[0])
        elif a[1] < b[1]:
            t = (levels.tie_y[level] - a[1]) / (b[1] - a[1])
        share[i] = min(max(t, 0.0), 1.0)
    return share


@njit
def _cut_fans(outlines):
    """Triangles of convex polygons, each from its first corner, and their polygons; -1 and repeats are no corners."""
    room = 3 * len(outlines)
    triangles, part, count = np.empty((room, 3), np.int64), np.empty(room, np.int64), 0
    kept = np.empty(5, np.int64)
    for p in range(len(outlines)):
        size = 0
        for k in range(5):
            if outlines[p, k] >= 0 and (size == 0 or outlines[p, k] != kept[size - 1]):
                kept[size] = outlines[p, k]
                size += 1
        for k in range(2, size):
            a, b, c = kept[0], kept[k - 1], kept[k]
            if a != b and b != c and c != a:
                triangles[count, 0], triangles[count, 1], triangles[count, 2] = a, b, c
                part[count] = p
                count += 1
    return triangles[:count].copy(), part[:count].copy()


def _drop_repeats(ring):
    """A closed ring without points that repeat the one before."""
    return ring[ring != np.roll(ring, 1)]
