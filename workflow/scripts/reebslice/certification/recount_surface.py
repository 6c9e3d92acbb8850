"""The surface in order of height: ranks, mesh edges, links, all found anew from points and faces.

A vertex id in the recount is a rank: its place in the order of (height,
tilted x, tilted y, surface vertex).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .recount_joins import join


class Ranked(NamedTuple):
    """A closed surface whose vertex ids are ranks of height.

    points : (n, 3) tilted frame; origin : (n,) the surface vertex of each rank
    corners : (m, 3) ranks, ascending within each face
    even : (m,) bool, whether `corners` is counter-clockwise seen from outside
    shell : (m,) the shell of each face
    changes : (n,) sign changes around the link of each vertex: faces with it in the middle
    """

    points: np.ndarray
    origin: np.ndarray
    corners: np.ndarray
    even: np.ndarray
    shell: np.ndarray
    changes: np.ndarray


class Sides(NamedTuple):
    """The E mesh edges, in order of their ends: lower and upper end, and the three of each face.

    of_face : (m, 3), for corners a < b < c the mesh edges ab, bc, ac
    faces : (E, 2) the two faces at each mesh edge
    """

    lower: np.ndarray
    upper: np.ndarray
    of_face: np.ndarray
    faces: np.ndarray


def rotate(points, rotation):
    """Points (n, 3) in the tilted frame, summed in the order x, y, z."""
    x, y, z = np.asarray(points, float).T
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in np.asarray(rotation, float)], axis=1)


def rank_surface(points, faces, shell):
    """The :class:`Ranked` surface of tilted `points` (n, 3) and `faces` (m, 3)."""
    x, y, z = points.T
    order = np.argsort(z, kind="stable")
    if (np.diff(z[order]) == 0).any():
        order = np.lexsort((y, x, z))  # stable: what ties altogether stays in order of the vertices
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return sort_corners(points[order], order, rank[faces], shell)


def sort_corners(points, origin, faces, shell):
    """The :class:`Ranked` surface of `points` in order of rank and oriented `faces` (m, 3) of ranks."""
    corners, even = _sort_corners(np.ascontiguousarray(faces, np.int64))
    changes = np.bincount(corners[:, 1], minlength=len(points))
    return Ranked(points, origin, corners, even, np.asarray(shell), changes)


@njit(cache=True)
def _sort_corners(faces):
    corners, even = np.empty_like(faces), np.empty(len(faces), np.bool_)
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        swaps = 0
        if a > b:
            a, b, swaps = b, a, swaps + 1
        if b > c:
            b, c, swaps = c, b, swaps + 1
        if a > b:
            a, b, swaps = b, a, swaps + 1
        corners[f, 0], corners[f, 1], corners[f, 2] = a, b, c
        even[f] = swaps % 2 == 0
    return corners, even


def oriented_faces(surface):
    """The faces (m, 3), counter-clockwise seen from outside."""
    a, b, c = surface.corners.T
    return np.stack([a, np.where(surface.even, b, c), np.where(surface.even, c, b)], axis=1)


def copies(surface):
    """How many simple critical points each vertex stands for, at least 1."""
    return np.maximum(surface.changes // 2 - 1, 1)


def find_sides(surface):
    """The :class:`Sides`, or None unless each lies in two opposite half-edges."""
    closed, *columns = _find_sides(surface.corners, surface.even, len(surface.points))
    return Sides(*columns) if closed else None


@njit(cache=True)
def _find_sides(corners, even, n):
    """Half-edges, three to a face, sorted by their upper and then by their lower end; twins are then neighbours."""
    m = 3 * len(corners)
    order = _sort_by_end(corners, _sort_by_end(corners, np.arange(m), n, True), n, False)
    lower, upper = np.empty(m // 2, np.int64), np.empty(m // 2, np.int64)
    of_face, faces = np.empty((len(corners), 3), np.int64), np.empty((m // 2, 2), np.int64)
    closed = m % 2 == 0
    for k in range(m // 2):
        one, two = order[2 * k], order[2 * k + 1]
        low, high = _end(corners, one, False), _end(corners, one, True)
        twins = low == _end(corners, two, False) and high == _end(corners, two, True)
        opposite = (even[one // 3] == (one % 3 < 2)) != (even[two // 3] == (two % 3 < 2))
        again = k > 0 and low == lower[k - 1] and high == upper[k - 1]
        closed = closed and twins and opposite and low != high and not again
        lower[k], upper[k], faces[k, 0], faces[k, 1] = low, high, one // 3, two // 3
        of_face[one // 3, one % 3] = of_face[two // 3, two % 3] = k
    return closed, lower, upper, of_face, faces


@njit(cache=True)
def _end(corners, half, upper):
    """The lower or upper end of half-edge `half`: of face half // 3 the side ab, bc or ac."""
    place = half % 3
    if upper:
        return corners[half // 3, 1 if place == 0 else 2]
    return corners[half // 3, 1 if place == 1 else 0]


@njit(cache=True)
def _sort_by_end(corners, halves, n, upper):
    """Half-edges in order of their lower or upper ends, otherwise as they were: a counting sort."""
    first = np.zeros(n + 1, np.int64)
    for half in halves:
        first[_end(corners, half, upper) + 1] += 1
    first = np.cumsum(first)
    out = np.empty_like(halves)
    for half in halves:
        end = _end(corners, half, upper)
        out[first[end]] = half
        first[end] += 1
    return out


@njit(cache=True)
def count_links(corners, lower, upper, faces, n):
    """How many link cycles each of n vertices has, (n,) int64: corners joined across the mesh edges at their vertex."""
    parent = np.arange(3 * len(corners))
    for side in range(len(lower)):
        one, two = faces[side, 0], faces[side, 1]
        for vertex in (lower[side], upper[side]):
            join(parent, 3 * one + _place(corners, one, vertex), 3 * two + _place(corners, two, vertex))
    links = np.zeros(n, np.int64)
    for corner in range(len(parent)):
        if parent[corner] == corner:
            links[corners[corner // 3, corner % 3]] += 1
    return links


@njit(cache=True)
def _place(corners, face, vertex):
    return 0 if corners[face, 0] == vertex else 1 if corners[face, 1] == vertex else 2


@njit(cache=True)
def measure_shells(points, faces, shell, n):
    """Area and, by divergence around the middle of its vertices, volume of each of n shells: two (n,) float64."""
    middle, weight = np.zeros((n, 3)), np.zeros(n)
    for f in range(len(faces)):
        weight[shell[f]] += 1
        for k in range(3):
            middle[shell[f], k] += points[faces[f, 0], k]
    middle /= np.maximum(weight, 1).reshape(-1, 1)
    area, volume = np.zeros(n), np.zeros(n)
    for f in range(len(faces)):
        ax, ay, az = _point_around(points, faces[f, 0], middle, shell[f])
        bx, by, bz = _point_around(points, faces[f, 1], middle, shell[f])
        cx, cy, cz = _point_around(points, faces[f, 2], middle, shell[f])
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area[shell[f]] += np.sqrt(x * x + y * y + z * z) / 2
        volume[shell[f]] += (ax * x + az * z + ay * y) / 6
    return area, volume


@njit(cache=True)
def _point_around(points, vertex, middle, shell):
    """A point as seen from the middle of its shell, a tuple."""
    x, y, z = points[vertex, 0], points[vertex, 1], points[vertex, 2]
    return x - middle[shell, 0], y - middle[shell, 1], z - middle[shell, 2]
