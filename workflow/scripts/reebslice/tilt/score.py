"""What a direction of height makes of a surface, told without slicing it.

Scoring a tilt takes the critical points, their persistence and the fewest
levels that tell them apart, for many directions. Only critical points are
sorted, and from a saddle the rest of the surface is reached by walking downhill
or uphill, so that most of it is not looked at again.

`key` (n,) float64 is what decides which of two vertices is the higher: their
heights, or their ranks where heights tie; `found` are the
:class:`scan.CriticalPoints` of `key` on the :class:`cone.ConeSurface`.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..arrays.components import find
from ..mesh.half_edges import ahead, behind, head_of, turn_around


class WalkBuffers(NamedTuple):
    """Room for what walks leave behind, held from one direction to the next: memory not yet touched is slow.

    down, up : (d,) int32, see `_merge`
    place : (n,) int32, 1 + the place of a critical vertex among them, else 0
    contour : (m + 1,) int32, the number of the last contour that was walked in each face, and of any
    """

    down: np.ndarray
    up: np.ndarray
    place: np.ndarray
    contour: np.ndarray


def blank_buffers(surface):
    """The :class:`WalkBuffers` before the first walk on `surface`."""
    roots, faces = np.zeros((2, len(surface.doubtful)), np.int32), len(surface.corners) // 3
    return WalkBuffers(*roots, np.zeros(len(surface.falling), np.int32), np.zeros(faces + 1, np.int32))


def pair_elders(surface, key, found, trails=None):
    """Extremum and saddle that cancel by the elder rule, (p, 2) int32; shells' ends (s, 2) int32.

    The persistence of the whole surface, as :func:`reeb_graph.surface_reeb_graph` has
    it, each k-fold saddle counted as k simple ones. The lowest and the highest
    vertex of a shell remain, and as many saddles as the surface has loops, twice.
    All are told by their places in found.vertices.
    """
    trails = trails or blank_buffers(surface)
    trails.down[:] = trails.up[:] = 0
    ground = surface.doubtful, surface.start, surface.ring
    ways = surface.downhill, surface.uphill, trails.down, trails.up
    return _pair_elders(surface.corners, *ground, *ways, key, *found[1:3], *found[4:], trails.place)


def find_significant(surface, key, height, found, size, trails=None):
    """Which critical points have at least persistence `size`: ((c,) bool, their number).

    Pairs count by the difference of `height` (n,), a shell's ends by its
    height, and the saddles of loops always. In the number a k-fold saddle
    counts as often as it has such persistence.
    """
    pairs, ends = pair_elders(surface, key, found, trails)
    loops, height = np.maximum(-found.index, 0), height[found.vertices]
    np.subtract.at(loops, pairs[:, 1], 1)
    both = np.concatenate([pairs, ends])
    both = both[np.abs(height[both[:, 0]] - height[both[:, 1]]) >= size]
    significant = loops > 0
    significant[both] = True
    return significant, both.size + int(loops.sum())


def fewest_levels(surface, key, found, significant, most=np.iinfo(np.int64).max, trails=None):
    """The least number of levels after which no piece has two significant critical points.

    With all critical points significant these are the levels that pierce
    every arc of the surface's Reeb graph. Upwards, each level is put as late
    as it can be, which is optimal as a piece's part has no more than the piece.
    significant : (c,) bool; counting stops at `most`.
    """
    trails = trails or blank_buffers(surface)
    if trails.contour[-1] > MOST_CONTOURS:
        trails.contour[:] = 0
    return _sweep(*surface[:3], key, *found[2:], significant, most, trails.place, trails.contour)


MOST_CONTOURS = 1 << 30  # before their numbers leave int32


@njit(cache=True, inline="always")
def _step_down(corners, twins, falling, key, v):
    """A half-edge from v to a lower neighbour; there is one."""
    h = falling[v]
    while key[head_of(corners, h)] >= key[v]:
        h = turn_around(twins, h)
    return h


@njit(cache=True)
def _find_oldest(root, doubtful, start, ring, hill, key, way, spot):
    """The extremum at the root of a spot, to which `root` leads by spots plus 1; where it has 0, look it up."""
    top = spot
    while root[top] != top + 1:
        if root[top] == 0:
            root[top] = top + 1
            for j in range(start[top], start[top + 1]):
                if way * key[ring[j]] < way * key[doubtful[top]]:
                    root[top] = hill[ring[j]] + 1
                    break
        else:
            top = root[top] - 1
    while root[spot] != top + 1:
        met, spot = spot, root[spot] - 1
        root[met] = top + 1
    return top


@njit(cache=True)
def _pair_elders(
    corners, doubtful, first, ring, downhill, uphill, down, up, key, spots, vertices, lowest, start, around, place
):
    pairs, ends = np.empty((2 * len(vertices), 2), np.int32), np.empty((len(vertices), 2), np.int32)
    walk, saddles = (doubtful, first, ring), (vertices, start, around)
    n_pairs = _merge(corners, down, walk, downhill, key, 1, saddles, pairs, 0)
    n_pairs = _merge(corners, up, walk, uphill, key, -1, saddles, pairs, n_pairs)
    n_ends = 0
    for i in range(len(vertices)):
        place[vertices[i]] = i
        if lowest[i] and (down[spots[i]] == 0 or down[spots[i]] == spots[i] + 1):
            ends[n_ends, 0] = i
            ends[n_ends, 1] = _find_oldest(up, doubtful, first, ring, uphill, key, -1, uphill[vertices[i]])
            n_ends += 1
    for i in range(n_pairs):
        pairs[i, 0] = place[doubtful[pairs[i, 0]]]
    for i in range(n_ends):
        ends[i, 1] = place[doubtful[ends[i, 1]]]
    place[vertices] = 0
    return pairs[:n_pairs].copy(), ends[:n_ends].copy()


@njit(cache=True)
def _merge(corners, root, walk, hill, key, way, saddles, pairs, count):
    """Enter into `pairs`, after `count`, each extremum and the saddle at which its component meets an older one.

    The extremum by its spot, its place in `doubtful`; the saddle by its place
    among the critical vertices. way : 1 upwards, -1 downwards. `root` holds for every spot another
    one met before, plus 1, or 0; roots are extrema, and that of a component is always its oldest.
    Returns the number of pairs.
    """
    doubtful, first, ring = walk
    vertices, start, around = saddles
    for step in range(len(vertices)):
        i = step if way == 1 else len(vertices) - 1 - step
        oldest = -1
        for j in range(start[i], start[i + 1]):
            w = head_of(corners, around[j])
            if way * key[w] > way * key[vertices[i]]:
                continue
            other = _find_oldest(root, doubtful, first, ring, hill, key, way, hill[w])
            if oldest < 0:
                oldest = other
            elif other != oldest:
                if way * key[doubtful[other]] < way * key[doubtful[oldest]]:
                    oldest, other = other, oldest
                root[other] = oldest + 1
                pairs[count, 0], pairs[count, 1] = other, i
                count += 1
    return count


@njit(cache=True)
def _sweep(corners, twins, falling, key, vertices, index, lowest, start, around, significant, most, place, contour):
    c, levels, cut, linked, count = len(vertices), 0, -np.inf, 0, 0
    # Node i is a critical vertex met since the last level, node c + k the contour number base + k of that level. In
    # `contour` they are left by number; those up to `base` are of other levels. What is not met is not set either.
    newest = base = contour[-1]
    root = np.empty(2 * c + start[-1] + 1, np.int32)
    held = np.empty(len(root), np.int32)  # significant points in the piece, at its root
    surface, wedges = (corners, twins, falling, place, contour), (vertices, index, lowest, start, around)
    for j in range(c):
        place[vertices[j]] = j + 1
    for i in range(c):
        root[i], held[i] = i, significant[i]
        count += significant[i]
        if count < 2:
            continue  # no piece can have two of them, whatever the others that are met lead to
        first, linked = linked, i + 1
        for k in range(i + 1 - first):  # the lowest, the highest, then the others, which may be spared
            j = first + k - 1 if k > 1 else i if k == 1 else first
            newest = _link(surface, wedges, key, j, cut, base, newest, root, held)
            if held[find(root, j)] > 1:  # a level right below i; what is there is met anew
                levels, cut, base, linked, count = levels + 1, key[vertices[i]], newest, i, significant[i]
                root[i], held[i] = i, significant[i]
                break
        if levels >= most:
            break
    place[vertices] = 0
    contour[-1] = newest
    return levels


@njit(cache=True, inline="always")
def _link(surface, wedges, key, i, cut, base, newest, root, held):
    """Unite the piece of critical vertex i with those that its paths downhill meet down to the level at `cut`.

    Returns the number of the newest contour of that level, all beyond `base`.
    """
    corners, twins, falling, place, contour = surface
    vertices, index, lowest, start, around = wedges
    c, v = len(vertices), vertices[i]
    for j in range(start[i], start[i] + (0 if lowest[i] else max(1, start[i + 1] - start[i]))):
        h = _step_down(corners, twins, falling, key, v) if index[i] == 1 else around[j]
        w = head_of(corners, h)
        if key[w] >= key[v]:
            continue
        while key[w] >= cut and place[w] == 0:
            h = _step_down(corners, twins, falling, key, w)
            w = head_of(corners, h)
        a = place[w] - 1
        if key[w] < cut:
            if newest == base:
                newest, root[c + 1] = newest + 1, i
            if contour[h // 3] <= base:
                if newest == base + 1 and find(root, c + 1) == find(root, i):
                    contour[h // 3] = newest  # all that is met is in one piece, on one contour or on several
                else:
                    newest += 1
                    root[c + newest - base], held[c + newest - base] = c + newest - base, 0
                    met = _walk_contour(corners, twins, key, cut, h // 3, base, newest, contour)
                    root[c + newest - base] = c + met - base
            a = c + contour[h // 3] - base
        a, b = find(root, a), find(root, i)
        if a != b:
            root[a] = b
            held[b] += held[a]
    return newest


@njit(cache=True)
def _walk_contour(corners, twins, key, cut, face, base, number, contour):
    """Enter the `number` of a contour at height `cut` in its faces, from `face` on, until it is known which one it is.

    Returns the number under which it was met before on this level, or `number`.
    Two walks set out, one either way: while one waits for memory, the other does.
    """
    contour[face] = number
    rising, sinking = np.int64(3 * face), np.int64(3 * face)  # the half-edges of a face that pass the height
    while not key[corners[rising]] < cut <= key[head_of(corners, rising)]:
        rising += 1
    while not key[corners[sinking]] >= cut > key[head_of(corners, sinking)]:
        sinking += 1
    while True:
        one, other = np.int64(twins[rising]), np.int64(twins[sinking])
        if contour[one // 3] > base:
            return contour[one // 3]
        contour[one // 3] = number
        if contour[other // 3] > base:
            return contour[other // 3]
        contour[other // 3] = number
        rising = ahead(one) if key[corners[behind(one)]] >= cut else behind(one)
        sinking = behind(other) if key[corners[behind(other)]] >= cut else ahead(other)
