"""Essential critical points and persistence, counted again from the mesh.

The elder rule needs only the order in which components meet, and a minimum
spanning tree of the mesh edges, each weighted by its later end, holds just
that (Kruskal); the tables come from a vertex by vertex sweep instead.
"""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree

from .recount import copies, sign_changes


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
    changes = sign_changes(surface)
    count = np.where(changes == 2, 0, np.where(changes == 0, 1, copies(surface)))
    count -= np.bincount(pairs.ravel(), minlength=n)
    return count, pairs


def elder_pairs(earlier, later, n, n_contours):
    """Elder pairs (extremum, saddle) of a sweep in ascending order of vertex.

    earlier : vertex, or n + contour for what comes in through a level; later :
    vertex. Contours are older than every vertex and are never paired.
    """
    total = n + n_contours
    keys = np.sort(later * total + earlier)
    keys = keys[np.append(True, keys[1:] != keys[:-1])[: len(keys)]]
    earlier, later = keys % total, keys // total
    tree = minimum_spanning_tree(coo_array((later + 1.0, (earlier, later)), shape=(total, total)).tocsr()).tocoo()
    low, high, weight = tree.row, tree.col, tree.data
    order = np.argsort(weight, kind="stable")
    # of each meeting take the ends that were there before the vertex itself
    vertex = weight[order].astype(np.int64) - 1
    other = np.where(high[order] == vertex, low[order], high[order])
    root, born = list(range(total)), list(range(n)) + [-1] * n_contours
    pairs = []
    for v, w in zip(vertex.tolist(), other.tolist()):
        a, b = _find(root, v), _find(root, w)
        if born[a] < born[b]:
            a, b = b, a
        if born[a] >= 0 and born[a] != v:
            pairs.append((born[a], v))
        root[a] = b
    return np.array(pairs, np.int64).reshape(-1, 2)


def _find(root, i):
    while root[i] != i:
        root[i] = root[root[i]]
        i = root[i]
    return i
