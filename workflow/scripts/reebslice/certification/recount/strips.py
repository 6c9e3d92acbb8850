"""The faces that a level crosses, by strips of the second coordinate, and lines along the first through them."""

from typing import NamedTuple

import numpy as np

from ...kernels import njit

MOST_STRIPS = 8192
ROUNDING = 64 * np.finfo(float).eps


class Mesh(NamedTuple):
    """What levels and lines need of a surface: of `Ranked` and `MeshEdges`, and the `body` of each face, (m,) int32."""

    points: np.ndarray
    corners: np.ndarray
    even: np.ndarray
    of_face: np.ndarray
    faces: np.ndarray
    body: np.ndarray


class Strips(NamedTuple):
    """Strips of equal width, each with room for the faces that reach into it.

    low, width : where they begin, and how wide they are; a length each
    first : (m, 2) the first and the last strip of each face
    start : (S + 1,) where the room of each strip begins; count : (S,) faces that are in it at present
    member : the faces, place : of each face and strip, where it is among these; at : (m + 1,) where those of a face are
    """

    low: float
    width: float
    first: np.ndarray
    start: np.ndarray
    count: np.ndarray  # type: ignore[assignment]  # a method of tuples is called so
    member: np.ndarray
    place: np.ndarray
    at: np.ndarray


def lay_strips(surface):
    """Lay strips over a surface, about as wide as its faces.

    Parameters
    ----------
    surface : Ranked

    Returns
    -------
    Strips
        All empty.
    """
    y = surface.points[:, 1][surface.corners]
    low, high = y.min(axis=1), y.max(axis=1)
    bottom, extent = low.min(), high.max() - low.min()
    number = int(min(MOST_STRIPS, max(1, extent / max((high - low).mean(), 1e-300))))
    width = max(extent / number, 1e-300)
    first = (np.column_stack([low, high]) - bottom) / width
    first = np.clip(first, 0, number - 1).astype(np.int32)
    size = first[:, 1] - first[:, 0] + 1
    at = np.concatenate([[0], np.cumsum(size)])
    rise = np.bincount(first[:, 0], minlength=number + 1) - np.bincount(first[:, 1] + 1, minlength=number + 1)
    start = np.concatenate([[0], np.cumsum(np.cumsum(rise)[:number])])
    room = (np.empty(at[-1], np.int32) for _ in range(2))
    return Strips(float(bottom), float(width), first, start, np.zeros(number, np.int64), *room, at)


@njit(inner=True)
def enter_face(strips, face):
    """Put a face into its strips."""
    for k in range(strips.first[face, 0], strips.first[face, 1] + 1):
        place = strips.start[k] + strips.count[k]
        strips.member[place] = face
        strips.place[strips.at[face] + k - strips.first[face, 0]] = strips.count[k]
        strips.count[k] += 1


@njit(inner=True)
def leave_face(strips, face):
    """Take a face out of its strips."""
    for k in range(strips.first[face, 0], strips.first[face, 1] + 1):
        strips.count[k] -= 1
        hole = strips.place[strips.at[face] + k - strips.first[face, 0]]
        last = strips.member[strips.start[k] + strips.count[k]]
        strips.member[strips.start[k] + hole] = last
        strips.place[strips.at[last] + k - strips.first[last, 0]] = hole


@njit(inner=True)
def strip_of(strips, y):
    """Find the strip that holds a second coordinate."""
    return min(max(int((y - strips.low) / strips.width), 0), len(strips.count) - 1)


@njit(inner=True)
def cross_face(mesh, face, cut, height):
    """Find the segment in which a face meets a plane.

    Parameters
    ----------
    mesh : Mesh
    face, cut : int
        Ranks from `cut` on are above the plane, which the face crosses.
    height : float
        Of the plane, between those of the vertices.

    Returns
    -------
    four float
        x and y where it begins, x and y where it ends; material is on its left. What rounding moves them by is within
        `ROUNDING` of the largest coordinate: the plane is the one at that very float.
    """
    points, corners, even = mesh.points, mesh.corners, mesh.even
    a, b, c = corners[face]
    ends = np.empty((2, 2))
    for k in range(2):
        low, high = (a, c) if k == 0 else ((a, b) if b >= cut else (b, c))
        part = (height - points[low, 2]) / (points[high, 2] - points[low, 2])
        for axis in range(2):
            ends[k, axis] = points[low, axis] + part * (points[high, axis] - points[low, axis])
    k = 0 if even[face] else 1
    return ends[k, 0], ends[k, 1], ends[1 - k, 0], ends[1 - k, 1]
