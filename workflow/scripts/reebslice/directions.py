"""What a direction of height makes of a surface, told without slicing it.

Scoring a tilt takes the critical points, their persistence and the fewest
levels that tell them apart, for many directions. Only critical points are
sorted, and from a saddle the rest of the surface is reached by walking downhill
or uphill, so that most of it is not looked at again.

`key` (n,) float64 is what decides which of two vertices is the higher: their
heights, or their ranks where heights tie; `found` are the
:class:`scanning.CriticalPoints` of `key`.
"""

import numpy as np
from numba import njit

from .pairing import find
from .scanning import head_of, turn_around


def pair_elders(faces, key, found):
    """Extremum and saddle that cancel by the elder rule, (p, 2) int32; shells' ends (s, 2) int32.

    The persistence of the whole surface, as :func:`reeb.surface_reeb_graph` has
    it, each k-fold saddle counted as k simple ones. The lowest and the highest
    vertex of a shell remain, and as many saddles as the surface has loops, twice.
    """
    roots = np.zeros((2, len(key)), np.int32)  # here, because numpy takes zeros that are never touched for nothing
    return _pair_elders(faces, *found.rings, key, found.vertices, found.lowest, found.start, found.around, *roots)


def find_significant(faces, key, height, found, size):
    """Which critical points have at least persistence `size`: ((n,) bool, their number).

    Pairs count by the difference of `height` (n,), a shell's ends by its
    height, and the saddles of loops always. In the number a k-fold saddle
    counts as often as it has such persistence.
    """
    pairs, ends = pair_elders(faces, key, found)
    loops, significant = np.zeros(len(key), np.int32), np.zeros(len(key), bool)
    loops[found.vertices] = np.maximum(-found.index[found.vertices], 0)
    np.subtract.at(loops, pairs[:, 1], 1)
    both = np.concatenate([pairs, ends])
    both = both[np.abs(height[both[:, 0]] - height[both[:, 1]]) >= size]
    significant[found.vertices] = loops[found.vertices] > 0
    significant[both] = True
    return significant, both.size + int(loops[found.vertices].sum())


def fewest_levels(faces, key, found, significant, most=np.iinfo(np.int64).max):
    """The least number of levels after which no piece has two significant critical points.

    With all critical points significant these are the levels that pierce
    every arc of the surface's Reeb graph. Upwards, each level is put as late
    as it can be, which is optimal as a piece's part has no more than the piece.
    significant : (n,) bool; counting stops at `most`.
    """
    walked = np.zeros(len(faces), np.int32)  # here, because numpy takes zeros that are never touched for nothing
    wedges = found.lowest, found.start, found.around
    return _sweep(faces, *found.rings, key, found.index, found.vertices, *wedges, significant, most, walked)


@njit(cache=True)
def _step(faces, leaving, twins, key, way, v):
    """A half-edge from v to a lower neighbour, or with way -1 to a higher one; -1 at such an extremum."""
    first = h = leaving[v]
    while True:
        if way * key[head_of(faces, h)] < way * key[v]:
            return h
        h = turn_around(twins, h)
        if h == first:
            return -1


@njit(cache=True)
def _find_oldest(root, faces, leaving, twins, key, way, v):
    """The extremum at the root of v, to which `root` leads by vertices' numbers plus 1; where it has 0, look it up."""
    top = v
    while root[top] != top + 1:
        if root[top] == 0:
            h = _step(faces, leaving, twins, key, way, top)
            root[top] = 1 + (head_of(faces, h) if h >= 0 else top)
        else:
            top = root[top] - 1
    while root[v] != top + 1:
        met, v = v, root[v] - 1
        root[met] = top + 1
    return top


@njit(cache=True)
def _pair_elders(faces, leaving, twins, key, vertices, lowest, start, around, down, up):
    pairs, ends = np.empty((2 * len(vertices), 2), np.int32), np.empty((len(vertices), 2), np.int32)
    n_pairs = _merge(faces, leaving, twins, key, vertices, start, around, down, 1, pairs, 0)
    n_pairs = _merge(faces, leaving, twins, key, vertices, start, around, up, -1, pairs, n_pairs)
    n_ends = 0
    for i in range(len(vertices)):
        v = vertices[i]
        if lowest[i] and (down[v] == 0 or down[v] == v + 1):
            ends[n_ends, 0], ends[n_ends, 1] = v, _find_oldest(up, faces, leaving, twins, key, -1, v)
            n_ends += 1
    return pairs[:n_pairs].copy(), ends[:n_ends].copy()


@njit(cache=True)
def _merge(faces, leaving, twins, key, vertices, start, around, root, way, pairs, count):
    """Enter into `pairs`, after `count`, each extremum and the saddle at which its component meets an older one.

    way : 1 upwards, -1 downwards. `root` holds a neighbour met before for every
    vertex, plus 1, or 0; roots are extrema, and that of a component is always its oldest.
    Returns the number of pairs.
    """
    for step in range(len(vertices)):
        i = step if way == 1 else len(vertices) - 1 - step
        saddle, oldest = vertices[i], -1
        for j in range(start[i], start[i + 1]):
            w = head_of(faces, around[j])
            if way * key[w] > way * key[saddle]:
                continue
            other = _find_oldest(root, faces, leaving, twins, key, way, w)
            if oldest < 0:
                oldest = other
            elif other != oldest:
                if way * key[other] < way * key[oldest]:
                    oldest, other = other, oldest
                root[other] = oldest + 1
                pairs[count, 0], pairs[count, 1] = other, saddle
                count += 1
    return count


@njit(cache=True)
def _sweep(faces, leaving, twins, key, index, vertices, lowest, start, around, significant, most, walked):
    n, levels, cut, i = len(key), 0, -np.inf, 0
    # Node v is a critical vertex met since the last level, node n + f the
    # contour of that level which was first reached in face f.
    # What is not met is not set either.
    root = np.empty(n + len(faces), np.int32)
    held = np.empty(len(root), np.int32)  # significant points in the piece, at its root
    contour = np.empty(len(faces), np.int32)
    while i < len(vertices) and levels < most:
        v = vertices[i]
        root[v], held[v] = v, 1 if significant[v] else 0
        for j in range(start[i], start[i] + max(1, start[i + 1] - start[i])):
            if lowest[i]:
                continue
            h = _step(faces, leaving, twins, key, 1, v) if index[v] == 1 else around[j]
            w = head_of(faces, h)
            if key[w] >= key[v]:
                continue
            while key[w] >= cut and index[w] == 0:
                h = _step(faces, leaving, twins, key, 1, w)
                w = head_of(faces, h)
            f = h // 3
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
