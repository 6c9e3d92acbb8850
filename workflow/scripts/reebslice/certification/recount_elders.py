"""Essential critical points and persistence, counted again from the mesh.

The elder rule needs only the order in which components meet. Mesh edges are
taken in order of their later ends, as Kruskal takes them for a minimum
spanning tree; the tables come from a vertex by vertex sweep instead.
"""

import numpy as np
from numba import njit

from .recount_joins import find_root
from .recount_surface import copies


def essential_points(surface, sides, recount=None):
    """How many essential critical points each vertex stands for, and its partner.

    Inside each piece if a `recount` is given, otherwise on the whole surface.
    Returns `count` (n,) int: the simple critical points at the vertex that
    the elder rule leaves unpaired; `pairs` (k, 2): extremum and saddle of
    every pair.
    """
    n = len(surface.points)
    if recount is None:
        n_contours, enters = 0, np.full(len(sides.lower), -1, np.int32)
        leaves = enters
    else:
        enters, leaves, n_contours = recount.enters, recount.leaves, len(recount.anchored)
    ends = sides.lower, sides.upper
    pairs = [_elder_pairs(*ends, enters, sides.by_upper, n, n_contours, True)]
    # mesh edges are in order of their lower ends
    downward = np.arange(len(sides.lower), dtype=np.int32)[::-1].copy()
    pairs = np.concatenate([*pairs, _elder_pairs(*ends[::-1], leaves, downward, n, n_contours, False)])
    changes = surface.changes
    count = np.where(changes == 2, 0, np.where(changes == 0, 1, copies(surface)))
    count -= np.bincount(pairs.ravel(), minlength=n)
    return count, pairs


def elder_pairs(earlier, later, n, n_contours):
    """Elder pairs (extremum, saddle) of a sweep in ascending order of vertex.

    earlier : vertex, or n + contour for what comes in through a level; later :
    vertex. Contours are older than every vertex and are never paired.
    """
    earlier, later = np.asarray(earlier, np.int32), np.asarray(later, np.int32)
    gate, order = np.where(earlier >= n, earlier - n, -1), np.argsort(later, kind="stable").astype(np.int32)
    return _elder_pairs(np.ascontiguousarray(earlier), later.copy(), gate, order, n, n_contours, True)


@njit(cache=True)
def _elder_pairs(earlier, later, gate, order, n, n_contours, upward):
    """The same of links in the `order` of the sweep, upward or down; gate : contour that a link comes in by, or -1.

    Younger roots are joined to older ones, so that a root is the oldest of its tree.
    """
    parent = np.arange(n + n_contours).astype(np.int32)
    pairs, count = np.empty((len(later), 2), np.int64), 0
    for k in order:
        v = later[k]
        a, b = find_root(parent, v), find_root(parent, n + gate[k] if gate[k] >= 0 else earlier[k])
        if a == b:
            continue
        if a >= n or (b < n and (a < b) == upward):
            a, b = b, a
        if a < n and a != v:
            pairs[count, 0], pairs[count, 1] = a, v
            count += 1
        parent[a] = b
    return pairs[:count].copy()
