"""Essential critical points and persistence, counted again from the mesh.

The elder rule needs only the order in which components meet. Mesh edges are
taken in order of their later ends, as Kruskal takes them for a minimum
spanning tree; the tables come from a vertex by vertex sweep instead.
"""

import numpy as np

from ...kernels import njit
from .components import find_root, first_parents
from .surface import copies


def essential_points(surface, sides, recount=None):
    """Find which critical points the elder rule pairs.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
    recount : Recount, optional
        If given, points are paired inside each piece, otherwise on the whole surface.

    Returns
    -------
    count : (n,) int
        The simple critical points at each vertex that are left unpaired.
    pairs : (k, 2) int
        Extremum and saddle of every pair.
    """
    n = len(surface.points)
    if recount is None:
        n_contours, enters, leaves = 0, np.empty(0, np.int32), np.empty(0, np.int32)
    else:
        enters, leaves, n_contours = recount.enters, recount.leaves, len(recount.anchored)
    ends, plain = (sides.lower, sides.upper), surface.index < 0
    pairs = _elder_pairs(*ends, enters, sides.by_upper, plain, n_contours, True)
    # mesh edges are in order of their lower ends
    pairs = np.concatenate([pairs, _elder_pairs(*ends[::-1], leaves, sides.by_upper[:0], plain, n_contours, False)])
    count = np.where(surface.index < 0, 0, copies(surface))
    count -= np.bincount(pairs.ravel(), minlength=n)
    return count, pairs


def elder_pairs(earlier, later, n, n_contours):
    """Pair extrema and saddles in a sweep in ascending order of vertex.

    Parameters
    ----------
    earlier, later : (k,) int
        The ends of links; the earlier one is a vertex, or n + contour for what
        comes in through a level.
    n, n_contours : int
        Contours are older than every vertex and are never paired.

    Returns
    -------
    (p, 2) int64
        Extremum and saddle of each pair.
    """
    earlier, later = np.asarray(earlier, np.int32), np.asarray(later, np.int32)
    gate, order = np.where(earlier >= n, earlier - n, -1), np.argsort(later, kind="stable").astype(np.int32)
    return _elder_pairs(np.ascontiguousarray(earlier), later.copy(), gate, order, np.zeros(n, bool), n_contours, True)


@njit
def _elder_pairs(earlier, later, gate, order, plain, n_contours, upward):
    """The same of links in the `order` of the sweep, or where that is empty from last to first, upward or down.

    gate : contour that a link comes in by, or -1, empty for none; plain : (n,) vertices whose links to earlier ones
    all lead to one component, so that one of them tells, as round a vertex that is not critical.
    Younger roots are joined to older ones, so that a root is the oldest of its tree.
    """
    n = len(plain)
    parent = first_parents(n + n_contours)
    pairs, count = np.empty((len(later), 2), np.int64), 0
    for i in range(len(later)):
        k = order[i] if len(order) else len(later) - 1 - i
        v = later[k]
        if plain[v] and parent[v] != v:
            continue
        a, b = find_root(parent, v), find_root(parent, n + gate[k] if len(gate) and gate[k] >= 0 else earlier[k])
        if a == b:
            continue
        if a >= n or (b < n and (a < b) == upward):
            a, b = b, a
        if a < n and a != v:
            pairs[count, 0], pairs[count, 1] = a, v
            count += 1
        parent[a] = b
    return pairs[:count].copy()
