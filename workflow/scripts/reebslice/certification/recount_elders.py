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
        inside, n_contours = np.ones(len(sides.lower), bool), 0
        enters = leaves = np.full(len(sides.lower), -1)
    else:
        enters, leaves, n_contours = recount.enters, recount.leaves, len(recount.anchored)
        inside = enters < 0
    up = np.where(inside, sides.lower, n + enters), sides.upper
    down = np.where(inside, sides.upper, n + leaves), sides.lower
    # Downward, heights are counted from the top; contours keep their numbers.
    mirrored = np.where(down[0] < n, n - 1 - down[0], down[0]), n - 1 - down[1]
    pairs = [elder_pairs(*up, n, n_contours), n - 1 - elder_pairs(*mirrored, n, n_contours)]
    pairs = np.concatenate(pairs)
    changes = surface.changes
    count = np.where(changes == 2, 0, np.where(changes == 0, 1, copies(surface)))
    count -= np.bincount(pairs.ravel(), minlength=n)
    return count, pairs


def elder_pairs(earlier, later, n, n_contours):
    """Elder pairs (extremum, saddle) of a sweep in ascending order of vertex.

    earlier : vertex, or n + contour for what comes in through a level; later :
    vertex. Contours are older than every vertex and are never paired.
    """
    return _elder_pairs(np.ascontiguousarray(earlier), np.ascontiguousarray(later), n, n_contours)


@njit(cache=True)
def _elder_pairs(earlier, later, n, n_contours):
    parent = np.arange(n + n_contours)
    born = np.concatenate((np.arange(n), np.full(n_contours, -1)))
    pairs, count = np.empty((len(later), 2), np.int64), 0
    for k in _sort_by_vertex(later, n):
        v = later[k]
        a, b = find_root(parent, v), find_root(parent, earlier[k])
        if a == b:
            continue
        if born[a] < born[b]:
            a, b = b, a
        if born[a] >= 0 and born[a] != v:
            pairs[count, 0], pairs[count, 1] = born[a], v
            count += 1
        parent[a] = b
    return pairs[:count].copy()


@njit(cache=True)
def _sort_by_vertex(vertex, n):
    """Places of `vertex` (k,), each below n, in ascending order: a counting sort."""
    first = np.zeros(n + 1, np.int64)
    for v in vertex:
        first[v + 1] += 1
    first = np.cumsum(first)
    order = np.empty(len(vertex), np.int64)
    for k in range(len(vertex)):
        order[first[vertex[k]]] = k
        first[vertex[k]] += 1
    return order
