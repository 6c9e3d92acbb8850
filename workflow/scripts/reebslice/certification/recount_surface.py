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
    corners : (m, 3) int32 ranks, ascending within each face; faces in order of their lowest one, so that whatever
        goes through them finds what it needs close together
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
    """The E mesh edges, in order of their ends: lower and upper end, and the three of each face; all int32.

    of_face : (m, 3), for corners a < b < c the mesh edges ab, bc, ac
    faces : (E, 2) the two faces at each mesh edge
    by_upper : (E,) the mesh edges in order of their upper ends
    """

    lower: np.ndarray
    upper: np.ndarray
    of_face: np.ndarray
    faces: np.ndarray
    by_upper: np.ndarray


def rotate(points, rotation):
    """Points (n, 3) in the tilted frame, summed in the order x, y, z."""
    return _rotate(np.ascontiguousarray(points, float), np.ascontiguousarray(rotation, float))


@njit(cache=True)
def _rotate(points, rotation):
    out = np.empty_like(points)
    for i in range(len(points)):
        for k in range(3):
            out[i, k] = rotation[k, 0] * points[i, 0] + rotation[k, 1] * points[i, 1] + rotation[k, 2] * points[i, 2]
    return out


def rank_surface(points, faces, shell):
    """The :class:`Ranked` surface of tilted `points` (n, 3) and `faces` (m, 3)."""
    x, y, z = points.T
    order = np.argsort(z)
    if (np.diff(z[order]) == 0).any():
        order = np.lexsort((y, x, z))  # stable: what ties altogether stays in order of the vertices
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order))
    return sort_corners(points[order], order, rank, faces, shell)


def sort_corners(points, origin, rank, faces, shell):
    """The :class:`Ranked` surface of `points` in order of rank and oriented `faces` (m, 3), of each corner its rank."""
    rank, faces, shell = (np.ascontiguousarray(values, np.int32) for values in (rank, faces, shell))
    return Ranked(points, origin, *_sort_corners(rank, faces, shell))


@njit(cache=True)
def _sort_corners(rank, faces, shell):
    """Corners, orientation and shell of the faces in order of their lowest corners, and the sign changes."""
    n = len(rank)
    m, first, changes = len(faces), np.zeros(n + 1, np.int64), np.zeros(n, np.int64)
    corners, even, shells = np.empty((m, 3), np.int32), np.empty(m, np.bool_), np.empty(m, np.int32)
    for f in range(m):
        first[min(rank[faces[f, 0]], rank[faces[f, 1]], rank[faces[f, 2]]) + 1] += 1
    first = np.cumsum(first)
    for f in range(m):
        a, b, c = rank[faces[f, 0]], rank[faces[f, 1]], rank[faces[f, 2]]
        swaps = 0
        if a > b:
            a, b, swaps = b, a, swaps + 1
        if b > c:
            b, c, swaps = c, b, swaps + 1
        if a > b:
            a, b, swaps = b, a, swaps + 1
        place = first[a]
        first[a] += 1
        corners[place, 0], corners[place, 1], corners[place, 2] = a, b, c
        even[place], shells[place] = swaps % 2 == 0, shell[f]
        changes[b] += 1
    return corners, even, shells, changes


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
    """Half-edges, three to a face, by their lower and then by their upper ends; twins are then neighbours."""
    first, halves = _sort_halves(corners, n)
    n_sides, m = len(halves) // 2, len(corners)
    lower, upper, faces = np.empty(n_sides, np.int32), np.empty(n_sides, np.int32), np.empty((n_sides, 2), np.int32)
    of_face, risen, closed, k = np.empty((m, 3), np.int32), np.zeros(n + 1, np.int64), True, 0
    for v in range(n):
        closed = closed and (first[v + 1] - first[v]) % 2 == 0
        if not closed:
            break
        for i in range(first[v], first[v + 1], 2):
            high, one, two = halves[i] >> 32, halves[i] & 0xFFFFFFFF, halves[i + 1] & 0xFFFFFFFF
            opposite = (even[one // 3] == (one % 3 < 2)) != (even[two // 3] == (two % 3 < 2))
            again = i > first[v] and high == upper[k - 1]
            closed = closed and high == halves[i + 1] >> 32 and opposite and high != v and not again
            lower[k], upper[k], faces[k, 0], faces[k, 1] = v, high, one // 3, two // 3
            of_face[one // 3, one % 3] = of_face[two // 3, two % 3] = k
            risen[high + 1] += 1
            k += 1
    by_upper, risen = np.empty(n_sides, np.int32), np.cumsum(risen)
    for k in range(n_sides if closed else 0):
        by_upper[risen[upper[k]]] = k
        risen[upper[k]] += 1
    return closed, lower, upper, of_face, faces, by_upper


@njit(cache=True)
def _sort_halves(corners, n):
    """Half-edges as upper end x 2^32 + number, sorted within each lower end, and where each of those begins.

    Number 3 f + k is of face f the side ab, bc or ac for k = 0, 1, 2.
    """
    first = np.zeros(n + 2, np.int64)
    for f in range(len(corners)):
        first[corners[f, 0] + 2] += 2
        first[corners[f, 1] + 2] += 1
    first = np.cumsum(first)
    halves = np.empty(3 * len(corners), np.int64)
    for f in range(len(corners)):
        for k in range(3):
            low, high = corners[f, 1 if k == 1 else 0], np.int64(corners[f, 1 if k == 0 else 2])
            halves[first[low + 1]] = (high << 32) + 3 * f + k
            first[low + 1] += 1
    for v in range(n):
        if first[v + 1] - first[v] > 32:
            halves[first[v] : first[v + 1]].sort()
            continue
        for i in range(first[v] + 1, first[v + 1]):
            half, j = halves[i], i
            while j > first[v] and halves[j - 1] > half:
                halves[j] = halves[j - 1]
                j -= 1
            halves[j] = half
    return first, halves


@njit(cache=True)
def least_rise(points, lower, upper):
    """The smallest difference of height over mesh edges from `lower` to `upper`."""
    least = np.inf
    for k in range(len(lower)):
        least = min(least, points[upper[k], 2] - points[lower[k], 2])
    return least


@njit(cache=True)
def count_links(corners, lower, upper, faces, n):
    """How many link cycles each of n vertices has, (n,) int64: corners joined across the mesh edges at their vertex."""
    parent = np.arange(3 * len(corners)).astype(np.int32)
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
