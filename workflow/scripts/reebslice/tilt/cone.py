"""What is sure of a surface along all directions of a cone.

Most vertices are regular along every one of them, most mesh edges slope far
more than the least sloping one, and from most vertices a path is known that
falls whatever the direction. What remains is looked at for each direction.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..arrays.sorting import sort_stably
from ..mesh.half_edges import find_twins, head_of, turn_around
from ..mesh.orders import canonical_faces


class ConeSurface(NamedTuple):
    """A closed surface, on which the faces around each vertex are one fan, and what is sure along some directions.

    Half-edge h runs from corners[h] to the next corner of its face.
    corners : (3 m,) int32, vertex ids, face after face
    twins : (3 m,) int32, of :func:`half_edges.find_twins`
    falling : (n,) int32, a half-edge that leaves each vertex, to its lowest neighbour along the directions' mean
    doubtful : (d,) int32, ascending: the vertices that may be critical; all others are regular
    start, ring : ring[start[i]:start[i + 1]] are the neighbours of doubtful[i] in order
    downhill, uphill : (n,) int32, the place in `doubtful` of a vertex to which a path from each vertex falls or rises
        along all the directions; it has no neighbour that is sure to be lower, or higher
    level : (e, 2) int32, ends of the mesh edges whose difference of height may be less than `least`
    """

    corners: np.ndarray
    twins: np.ndarray
    falling: np.ndarray
    doubtful: np.ndarray
    start: np.ndarray
    ring: np.ndarray
    downhill: np.ndarray
    uphill: np.ndarray
    level: np.ndarray
    least: float


def gather_neighbours(points, faces):
    """The same surface, numbered so that what is near in space is near in memory: points (n, 3), faces (m, 3) int32.

    Vertices follow each other by cubes of a grid in Morton's order; those of
    one cube, such as coinciding ones, stay in the order in which they were.
    """
    order = sort_stably((_number_cubes(points), CUBES**3))
    rank = np.empty(len(points), np.int32)
    rank[order] = np.arange(len(points), dtype=np.int32)
    return np.take(points, order, axis=0), canonical_faces(faces, rank)


CUBES = 64  # along each axis


@njit(cache=True)
def _number_cubes(points):
    """The cube of every point, its number interleaved from the bits of its places along the axes."""
    low, high, cubes = np.full(3, np.inf), np.full(3, -np.inf), np.zeros(len(points), np.int64)
    for i in range(len(points)):
        for axis in range(3):
            low[axis], high[axis] = min(low[axis], points[i, axis]), max(high[axis], points[i, axis])
    scale = CUBES / (high - low).max()
    for i in range(len(points)):
        for axis in range(3):
            place = min(int(scale * (points[i, axis] - low[axis])), CUBES - 1)
            place = (place | place << 8) & 0x300F  # bits 0 to 5 move to 0, 3, .., 15
            place = (place | place << 4) & 0x30C3
            cubes[i] |= ((place | place << 2) & 0x9249) << axis
    return cubes


def survey_surface(points, faces, directions, rounding):
    """The :class:`ConeSurface` of (n, 3) points and (m, 3) int32 faces, closed and oriented, for directions (k, 3).

    rounding : what it can change in the difference of two heights, at most.
    """
    axis = np.sum(directions, axis=0)
    axis /= max(np.sqrt(axis @ axis), 1e-9)
    cosine = float((directions @ axis).min()) - 1e-9  # of a cone that holds the directions, and a little more
    cosine = cosine if cosine > 1e-6 else 0.0  # in a cone of 90 degrees nothing is sure
    twins = find_twins(faces, len(points))
    cone = axis, cosine, np.sqrt(1 - cosine * cosine)
    return ConeSurface(faces.ravel(), twins, *_survey(points, faces.ravel(), twins, *cone, 2 * rounding + 1e-150))


@njit(cache=True)
def _survey(points, corners, twins, axis, cosine, sine, slack):
    """All but the first two of a :class:`ConeSurface`.

    An edge that is `along` the axis and `across` it makes a difference of
    height of at least |along| cosine - |across| sine. A vertex is regular if
    its neighbours change once from sure to be above it to sure to be below it
    and once back, with at most one neighbour in between at either place.
    """
    n, n_doubtful, n_level, least = len(points), 0, 0, np.inf
    falling, doubtful = np.empty(n, np.int32), np.empty(n, np.int32)
    downhill, uphill = np.empty(n, np.int32), np.empty(n, np.int32)  # at first a neighbour, or -1 less the place
    start, ring, level = np.zeros(n + 1, np.int32), np.empty_like(corners), np.empty((len(corners) // 2, 2), np.int32)
    for h in range(len(corners)):
        falling[corners[h]] = h
    for v in range(n):
        first = h = falling[v]
        lowest, low, high, changes, before, side, fill = np.inf, 0.0, 0.0, 0, 0, 0, start[n_doubtful]
        while True:
            w = head_of(corners, h)
            x, y, z = points[w, 0] - points[v, 0], points[w, 1] - points[v, 1], points[w, 2] - points[v, 2]
            along, square = axis[0] * x + axis[1] * y + axis[2] * z, x * x + y * y + z * z
            across = np.sqrt(max(square - along * along + 1e-14 * square, 0.0))
            sure = abs(along) * cosine - across * sine - slack
            side = 0 if sure <= 0 else 1 if along > 0 else -1
            if along < lowest:
                lowest, falling[v] = along, h
            if side < 0 and along < low:
                low, downhill[v] = along, w
            if side > 0 and along > high:
                high, uphill[v] = along, w
            if v < w:
                least = min(least, SHARE * np.sqrt(square))
                if sure <= least:
                    level[n_level, 0], level[n_level, 1] = v, w
                    n_level += 1
            if fill == start[n_doubtful]:
                opening = side
            else:
                changes += abs(side - before) if side or before else 4
            ring[fill] = w
            before, fill, h = side, fill + 1, turn_around(twins, h)
            if h == first:
                break
        changes += abs(opening - side) if side or opening else 4
        if low == 0:
            downhill[v] = -1 - n_doubtful
        if high == 0:
            uphill[v] = -1 - n_doubtful
        if changes != 4 or low == 0 or high == 0:  # a neighbour in between counts for half a change twice
            doubtful[n_doubtful] = v
            n_doubtful += 1
            start[n_doubtful] = fill
    _go_to_end(downhill)
    _go_to_end(uphill)
    doubtful, start, ring = doubtful[:n_doubtful], start[: n_doubtful + 1], ring[: start[n_doubtful]]
    return falling, doubtful, start, ring, downhill, uphill, level[:n_level], least


SHARE = 1 / 16  # of the shortest mesh edge; along hardly a direction is there no difference of height below it


@njit(cache=True)
def _go_to_end(way):
    """Where each vertex has the number of another, or -1 less the place at which paths end, enter the place for all."""
    for v in range(len(way)):
        end = v
        while way[end] >= 0:
            end = way[end]
        end = way[end]
        while way[v] >= 0:
            met, v = v, way[v]
            way[met] = end
    for v in range(len(way)):
        way[v] = -1 - way[v]
