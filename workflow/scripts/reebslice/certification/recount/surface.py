"""The surface in order of height: ranks, mesh edges, links, all found anew from points and faces.

A vertex id in the recount is a rank: its place in the order of (height,
tilted x, tilted y), of vertices at one position the maxima first, the minima
last, and the rest by surface vertex.
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
    """The E mesh edges, in order of their lower ends: lower and upper end, and the three of each face; all int32.

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
    x, y, z = points
    turned = [a * x + b * y + c * z for a, b, c in np.asarray(rotation, float)]  # summed in the order x, y, z
    origin = np.argsort(turned[2]).astype(np.int32)
    if (np.diff(turned[2][origin]) == 0).any():
        origin = part_copies(np.lexsort((turned[1], turned[0], turned[2])), turned, faces).astype(np.int32)
    rank = np.empty(len(origin), np.int32)
    rank[origin] = np.arange(len(origin), dtype=np.int32)
    points = np.stack([column[origin] for column in turned], axis=1)
    return sort_corners(points, origin, rank, faces, shell), rank


def part_copies(order, keys, faces):
    """Put vertices that tie in order of what they are: maxima, then what is neither, then minima.

    Parameters
    ----------
    order : (n,) int
        Vertices in ascending order of `keys`, those that tie in that of id.
    keys : sequence of (n,) arrays
    faces : columns a, b, c (m,) of vertices

    Returns
    -------
    (n,) int
    """
    new = np.any([np.diff(key[order]) != 0 for key in keys], axis=0)
    if new.all():
        return order
    place, rank = np.empty(len(order), np.int64), np.empty(len(order), np.int64)
    place[order] = np.concatenate([[0], np.cumsum(new)])  # one for all that tie
    rank[order] = np.arange(len(order))  # mesh edges join some that tie, where rounding has drawn them together
    a, b, c = faces
    tails, heads = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    up = np.bincount(tails[rank[tails] < rank[heads]], minlength=len(order)) > 0
    down = np.bincount(tails[rank[tails] > rank[heads]], minlength=len(order)) > 0
    return np.lexsort((np.arange(len(order)), np.where(up, np.where(down, 1, 2), 0), place))


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
    n = len(rank)
    corners, even, order = _sort_corners(rank, *(np.ascontiguousarray(column, np.int32) for column in faces))
    changes, index = np.bincount(corners[:, 1], minlength=n).astype(np.int32), np.full(n, 2, np.int8)
    index[corners[:, 0]] = 0
    index[changes == 2], index[changes > 2] = -1, 1
    weight = np.cumsum(np.concatenate([[0], np.maximum(changes // 2 - 1, 1)]), dtype=np.int32)
    return Ranked(points, origin, corners, even, shell[order], changes, index, weight)


@njit
def _sort_corners(rank, one, two, three):
    """Corners and orientation of the faces in order of their lowest corners, and that order."""
    m, first = len(one), np.zeros(len(rank) + 1, np.int64)
    corners, even, order = np.empty((m, 3), np.int32), np.empty(m, np.bool_), np.empty(m, np.int32)
    for f in range(m):
        first[min(rank[one[f]], rank[two[f]], rank[three[f]]) + 1] += 1
    for v in range(len(rank)):
        first[v + 1] += first[v]
    for f in range(m):
        a, b, c = rank[one[f]], rank[two[f]], rank[three[f]]
        low, high = min(a, b, c), max(a, b, c)
        place = first[low]
        first[low] += 1
        corners[place, 0], corners[place, 1], corners[place, 2] = low, a + b + c - low - high, high
        even[place], order[place] = (a < b < c) or (b < c < a) or (c < a < b), f
    return corners, even, order


@njit
def _count_sort(keys, n):
    """The order of keys below n, those that are equal as they come."""
    first, order = np.zeros(n + 1, np.int64), np.empty(len(keys), np.int32)
    for key in keys:
        first[key + 1] += 1
    for key in range(n):
        first[key + 1] += first[key]
    for i in range(len(keys)):
        order[first[keys[i]]] = i
        first[keys[i]] += 1
    return order


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
    n, low = len(surface.points), surface.corners[:, [0, 1, 0]].ravel()
    order = _count_sort(low, n)
    closed, *columns = _pair_halves(surface.corners, surface.even, n, low, order)
    return MeshEdges(*columns, _count_sort(columns[1], n)) if closed else None  # else not all ends are filled in


@njit
def _pair_halves(corners, even, n, low, order):
    """Mesh edges from half-edges in order of their lower ends `low`, and whether all have one opposite twin.

    Half-edge 3 f + k is of face f the side ab, bc or ac for k = 0, 1, 2.
    """
    count, k, closed = len(order) // 2, 0, True
    lower, upper, faces = np.empty(count, np.int32), np.empty(count, np.int32), np.empty((count, 2), np.int32)
    of_face, waiting, done = np.empty_like(corners), np.full(n, -1, np.int32), np.full(n, -1, np.int32)
    for half in order:
        f, side, v = half // 3, half % 3, low[half]
        w = corners[f, 1 if side == 0 else 2]
        other = waiting[w]
        if other < 0:
            waiting[w] = half
            continue
        opposite = (even[f] == (side < 2)) != (even[other // 3] == (other % 3 < 2))
        closed = closed and low[other] == v != w and opposite and done[w] != v
        lower[k], upper[k], faces[k, 0], faces[k, 1] = v, w, other // 3, f
        of_face[f, side] = of_face[other // 3, other % 3] = k
        waiting[w], done[w], k = -1, v, k + 1
    return closed and 2 * k == len(order), lower, upper, of_face, faces


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
