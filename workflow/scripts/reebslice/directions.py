"""What a direction of height makes of a surface, told without slicing it.

Scoring a tilt takes the critical points, their persistence and the fewest
levels that tell them apart, for many directions. All three follow from one
pass over the faces: only critical points are sorted, and from a saddle the
rest of the surface is reached by walking downhill or uphill.

`key` (n,) float64 is what decides which of two vertices is the higher: their
heights, or their ranks where heights tie.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from .pairing import find


class CriticalPoints(NamedTuple):
    """The critical points of a height.

    margin : smallest difference of `key` over all mesh edges
    index : (n,) int32, PL index of every vertex: 1 extremum, 0 regular, -k a k-fold saddle
    down, up : (n,) int32, some lower and some higher neighbour, or the vertex itself
    down_face : (n,) int32, a face that has both the vertex and its lower neighbour
    vertices : (c,) int32, the critical vertices in ascending order
    start, around : around[start[i]:start[i + 1]] are the half-edges that leave vertices[i] in
        the faces in which it is the middle one: one into each lower and each upper wedge of
        a saddle's link, none at an extremum
    """

    margin: float
    index: np.ndarray
    down: np.ndarray
    up: np.ndarray
    down_face: np.ndarray
    vertices: np.ndarray
    start: np.ndarray
    around: np.ndarray


def heights_along(points, directions):
    """Heights (k, n) of (n, 3) points along (k, 3) directions.

    Summed element by element in the order x, y, z, as
    :func:`heightmesh.tilt_points` does: the same floats, to the last bit.
    """
    x, y, z = np.asarray(points, float).T
    a, b, c = np.asarray(directions, float).T[:, :, None]
    return a * x + b * y + c * z


def find_critical_points(faces, key):
    """The :class:`CriticalPoints` of `key` on a closed surface, faces (m, 3) int32.

    Where `key` ties two neighbours or two critical points, their order is
    open: then `vertices` is empty, and ranks must be given instead.
    """
    margin, index, down, up, down_face = _scan(faces, key)
    vertices = np.flatnonzero(index).astype(np.int32)
    vertices = vertices[np.argsort(key[vertices], kind="stable")]
    if margin == 0 or (np.diff(key[vertices]) == 0).any():
        vertices = vertices[:0]
    return CriticalPoints(margin, index, down, up, down_face, vertices, *_wedges(faces, key, index, vertices))


def pair_elders(faces, key, found):
    """Extremum and saddle that cancel by the elder rule, (p, 2) int32; shells' ends (s, 2) int32.

    The persistence of the whole surface, as :func:`reeb.surface_reeb_graph` has
    it, each k-fold saddle counted as k simple ones. The lowest and the highest
    vertex of a shell remain, and as many saddles as the surface has loops, twice.
    """
    down, up = found.down.copy(), found.up.copy()
    pairs = [
        _merge(faces, key, found.vertices, found.start, found.around, down, 1),
        _merge(faces, key, found.vertices, found.start, found.around, up, -1),
    ]
    low = found.vertices[down[found.vertices] == found.vertices]
    high = np.array([find(up, v) for v in low], np.int32)
    return np.concatenate(pairs), np.column_stack([low, high])


def find_significant(faces, key, height, found, size):
    """Which critical points have at least persistence `size`: ((n,) bool, their number).

    Pairs count by the difference of `height` (n,), a shell's ends by its
    height, and the saddles of loops always. In the number a k-fold saddle
    counts as often as it has such persistence.
    """
    pairs, ends = pair_elders(faces, key, found)
    loops = np.maximum(-found.index, 0)
    np.subtract.at(loops, pairs[:, 1], 1)
    both = np.concatenate([pairs, ends])
    both = both[np.abs(height[both[:, 0]] - height[both[:, 1]]) >= size]
    significant = loops > 0
    significant[both] = True
    return significant, both.size + int(loops.sum())


def fewest_levels(faces, twins, key, found, significant, most=np.iinfo(np.int64).max):
    """The least number of levels after which no piece has two significant critical points.

    With all critical points significant these are the levels that pierce
    every arc of the surface's Reeb graph. Upwards, each level is put as late
    as it can be, which is optimal as a piece's part has no more than the piece.
    significant : (n,) bool; twins : (3 m,) of :func:`heightmesh.find_twins`;
    counting stops at `most`.
    """
    return _sweep(faces, twins, key, *found[1:3], *found[4:], significant, most)


@njit(cache=True)
def _scan(faces, key):
    n = len(key)
    index = np.zeros(n, np.int32)  # first the number of faces in which a vertex is the middle one
    down = np.arange(n).astype(np.int32)
    up, down_face = down.copy(), np.full(n, -1, np.int32)
    margin = np.inf
    for f in range(faces.shape[0]):
        low, middle, high = faces[f, 0], faces[f, 1], faces[f, 2]
        if key[low] > key[middle]:
            low, middle = middle, low
        if key[middle] > key[high]:
            middle, high = high, middle
        if key[low] > key[middle]:
            low, middle = middle, low
        margin = min(margin, key[middle] - key[low], key[high] - key[middle])
        index[middle] += 1
        down[middle] = down[high] = low
        down_face[middle] = down_face[high] = f
        up[middle] = up[low] = high
    for v in range(n):
        index[v] = 1 - index[v] // 2
    return margin, index, down, up, down_face


@njit(cache=True)
def _wedges(faces, key, index, vertices):
    place = np.full(len(key), -1, np.int32)
    start = np.zeros(len(vertices) + 1, np.int64)
    for i in range(len(vertices)):
        v = vertices[i]
        start[i + 1] = start[i] + 2 * (1 - index[v])
        if index[v] < 0:
            place[v] = i
    fill, around = start[:-1].copy(), np.empty(start[-1], np.int32)
    for f in range(faces.shape[0]):
        for k in range(3):
            v, w, u = faces[f, k], faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
            if place[v] >= 0 and (key[w] < key[v]) == (key[v] < key[u]):
                around[fill[place[v]]] = 3 * f + k
                fill[place[v]] += 1
    return start, around


@njit(cache=True)
def _merge(faces, key, vertices, start, around, root, way):
    """Pairs (p, 2) of an extremum and the saddle at which its component meets an older one.

    way : 1 upwards, -1 downwards. `root` holds a neighbour met before for every
    vertex; roots are extrema, and that of a component is always its oldest.
    """
    pairs = np.empty((len(vertices), 2), np.int32)
    count = 0
    for step in range(len(vertices)):
        i = step if way == 1 else len(vertices) - 1 - step
        saddle, oldest = vertices[i], -1
        for j in range(start[i], start[i + 1]):
            h = around[j]
            w = faces[h // 3, (h % 3 + 1) % 3]
            if way * key[w] > way * key[saddle]:
                continue
            other = find(root, w)
            if oldest < 0:
                oldest = other
            elif other != oldest:
                if way * key[other] < way * key[oldest]:
                    oldest, other = other, oldest
                root[other] = oldest
                pairs[count, 0], pairs[count, 1] = other, saddle
                count += 1
    return pairs[:count].copy()


@njit(cache=True)
def _sweep(faces, twins, key, index, down, down_face, vertices, start, around, significant, most):
    n, levels, cut, i = len(key), 0, -np.inf, 0
    # Node v is a critical vertex met since the last level, node n + f the
    # contour of that level which was first reached in face f.
    # What is not met is not set either.
    root = np.empty(n + len(faces), np.int32)
    held = np.empty(len(root), np.int32)  # significant points in the piece, at its root
    contour, walked = np.empty(len(faces), np.int32), np.zeros(len(faces), np.int32)
    while i < len(vertices) and levels < most:
        v = vertices[i]
        root[v], held[v] = v, 1 if significant[v] else 0
        for j in range(start[i], start[i] + max(1, start[i + 1] - start[i])):
            if index[v] == 1:
                f, w = down_face[v], down[v]
            else:
                f, w = around[j] // 3, faces[around[j] // 3, (around[j] % 3 + 1) % 3]
            if key[w] >= key[v]:
                continue
            while key[w] >= cut and index[w] == 0:
                f, w = down_face[w], down[w]
            if key[w] < cut:
                if walked[f] < levels:
                    root[n + f], held[n + f] = n + f, 0
                    _walk_contour(faces, twins, key, cut, f, levels, contour, walked)
                w = n + contour[f]
            a, b = find(root, w), find(root, v)
            if a != b:
                root[a] = b
                held[b] += held[a]
        if held[find(root, v)] > 1:  # a level right below v; what is there is met anew
            levels += 1
            cut = key[v]
        else:
            i += 1
    return levels


@njit(cache=True)
def _walk_contour(faces, twins, key, cut, first, level, contour, walked):
    """Enter in all faces along a contour at height `cut` that it was reached in face `first`."""
    h = 3 * first
    while not key[faces[first, h % 3]] < cut <= key[faces[first, (h % 3 + 1) % 3]]:
        h += 1
    f = first
    while True:
        contour[f], walked[f] = first, level
        f, corner = twins[h] // 3, twins[h] % 3  # a half-edge that comes down; go on to the one that rises
        if f == first:
            return
        h = 3 * f + ((corner + 1) % 3 if key[faces[f, (corner + 2) % 3]] >= cut else (corner + 2) % 3)
