"""The surface in order of height: ranks, mesh edges, links, all found anew from points and faces.

A vertex id in the recount is a rank: its place in the order of (height,
tilted x, tilted y, surface vertex).
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .components import find_components


class Ranked(NamedTuple):
    """A closed surface whose vertex ids are ranks of height.

    points : (n, 3) tilted frame; origin : (n,) the surface vertex of each rank
    corners : (m, 3) int32 ranks, ascending within each face; faces in order of their lowest one, so that whatever
        goes through them finds what it needs close together
    even : (m,) bool, whether `corners` is counter-clockwise seen from outside
    shell : (m,) the shell of each face
    changes : (n,) int32 sign changes around the link of each vertex: faces with it in the middle
    index : (n,) int8 of each vertex 0, 1, 2, or -1 where it is not critical
    weight : (n + 1,) int32 the simple critical points that the vertices below each rank stand for, at least 1 each
    """

    points: np.ndarray
    origin: np.ndarray
    corners: np.ndarray
    even: np.ndarray
    shell: np.ndarray
    changes: np.ndarray
    index: np.ndarray  # type: ignore[assignment]  # a method of tuples is called so
    weight: np.ndarray


class MeshEdges(NamedTuple):
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


def rank_surface(points, rotation, faces, shell):
    """Put a surface in order of height.

    Parameters
    ----------
    points, faces : columns x, y, z (n,) and a, b, c (m,)
    rotation : (3, 3) float64
        To the tilted frame.
    shell : (m,) int

    Returns
    -------
    surface : Ranked
    rank : (n,) int32
        Of each vertex.
    """
    points = tuple(np.ascontiguousarray(column, float) for column in points)
    frame = np.ascontiguousarray(rotation, float)
    origin = _order(*points, frame)
    rank = np.empty(len(origin), np.int32)
    rank[origin] = np.arange(len(origin), dtype=np.int32)
    return sort_corners(_rotate(*points, frame, origin), origin, rank, faces, shell), rank


def _order(x, y, z, frame):
    """The vertices in order of height; what ties altogether stays in order of the vertices."""
    height = _turn(x, y, z, *frame[2])
    order = np.argsort(height).astype(np.int32)
    if _have_ties(height, order):
        order = np.lexsort((_turn(x, y, z, *frame[1]), _turn(x, y, z, *frame[0]), height)).astype(np.int32)
    return order


@njit
def _turn(x, y, z, a, b, c):
    """The product of points with one direction, summed in the order x, y, z."""
    out = np.empty(len(x))
    for i in range(len(x)):
        out[i] = a * x[i] + b * y[i] + c * z[i]
    return out


@njit
def _have_ties(height, order):
    """Whether two vertices have one height."""
    for i in range(len(order) - 1):  # noqa: SIM110, numba knows no any() of a generator
        if height[order[i]] == height[order[i + 1]]:
            return True
    return False


@njit
def _rotate(x, y, z, frame, order):
    """Points in the tilted frame (n, 3) in the `order` given, summed in the order x, y, z."""
    out = np.empty((len(order), 3))
    for i in range(len(order)):
        p, q, r = x[order[i]], y[order[i]], z[order[i]]
        for k in range(3):
            out[i, k] = frame[k, 0] * p + frame[k, 1] * q + frame[k, 2] * r
    return out


def sort_corners(points, origin, rank, faces, shell):
    """Put the faces of a surface in order.

    Parameters
    ----------
    points, origin : (n, 3) float64, (n,) int
        In order of rank.
    rank : (n,) int
        Of each vertex.
    faces : columns a, b, c (m,) of vertices
        Counter-clockwise seen from outside.
    shell : (m,) int

    Returns
    -------
    Ranked
    """
    rank, a, b, c, shell = (np.ascontiguousarray(values, np.int32) for values in (rank, *faces, shell))
    return Ranked(points, origin, *_sort_corners(rank, a, b, c, shell))


@njit
def _sort_corners(rank, one, two, three, shell):
    """Corners, orientation and shell of the faces in order of their lowest corners, and what that tells of vertices."""
    n = len(rank)
    m, first, changes = len(shell), np.zeros(n + 1, np.int32), np.zeros(n, np.int32)
    corners, even, shells = np.empty((m, 3), np.int32), np.empty(m, np.bool_), np.empty(m, np.int32)
    for f in range(m):
        first[min(rank[one[f]], rank[two[f]], rank[three[f]]) + 1] += 1
    for v in range(n):
        first[v + 1] += first[v]
    for f in range(m):
        a, b, c = rank[one[f]], rank[two[f]], rank[three[f]]
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
    index, weight = np.empty(n, np.int8), np.zeros(n + 1, np.int32)
    for v in range(n):
        lowest = first[v] > (first[v - 1] if v > 0 else 0)  # in some face; `first` now tells where each run ends
        index[v] = 1 if changes[v] > 2 else -1 if changes[v] == 2 else 0 if lowest else 2
        weight[v + 1] = weight[v] + max(changes[v] // 2 - 1, 1)
    return corners, even, shells, changes, index, weight


def oriented_faces(surface, faces=slice(None)):
    """The corners of some faces, counter-clockwise seen from outside, (k, 3)."""
    a, b, c = surface.corners[faces].T
    even = surface.even[faces]
    return np.stack([a, np.where(even, b, c), np.where(even, c, b)], axis=1)


def copies(surface):
    """How many simple critical points each vertex stands for, at least 1."""
    return np.diff(surface.weight)


def find_mesh_edges(surface):
    """The :class:`MeshEdges`, or None unless each lies in two opposite half-edges."""
    closed, *columns = _find_sides(surface.corners, surface.even, len(surface.points))
    return MeshEdges(*columns) if closed else None


@njit
def _find_sides(corners, even, n):
    """Half-edges, three to a face, by their lower and then by their upper ends; twins are then neighbours."""
    first, halves = _sort_halves(corners, n)
    n_sides, m = len(halves) // 2, len(corners)
    lower, upper, faces = np.empty(n_sides, np.int32), np.empty(n_sides, np.int32), np.empty((n_sides, 2), np.int32)
    of_face, risen, closed, k = np.empty((m, 3), np.int32), np.zeros(n + 1, np.int32), True, 0
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
    by_upper = np.empty(n_sides, np.int32)
    for v in range(n):
        risen[v + 1] += risen[v]
    for k in range(n_sides if closed else 0):
        by_upper[risen[upper[k]]] = k
        risen[upper[k]] += 1
    return closed, lower, upper, of_face, faces, by_upper


@njit
def _sort_halves(corners, n):
    """Half-edges as upper end x 2^32 + number, sorted within each lower end, and where each of those begins.

    Number 3 f + k is of face f the side ab, bc or ac for k = 0, 1, 2.
    """
    first = np.zeros(n + 2, np.int32)
    for f in range(len(corners)):
        first[corners[f, 0] + 2] += 2
        first[corners[f, 1] + 2] += 1
    for v in range(n + 1):
        first[v + 1] += first[v]
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


def count_links(surface, sides):
    """Count the link cycles of each vertex: of ends of mesh edges, each joined to the next by a corner of a face.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges

    Returns
    -------
    (n,) int
    """
    count, (ab, bc, ac) = len(sides.lower), sides.of_face.T
    one, other = (np.concatenate(ends) for ends in ((ab, ab + count, bc + count), (ac, bc, ac + count)))
    n_links, link = find_components(one, other, 2 * count)
    vertex = np.empty(n_links, np.int64)
    vertex[link] = np.concatenate([sides.lower, sides.upper])
    return np.bincount(vertex, minlength=len(surface.points))
