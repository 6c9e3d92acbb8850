"""Which critical points cancel, by the elder rule.

An upward sweep pairs each minimum with the saddle at which its component
meets an older one; a downward sweep pairs maxima likewise (Edelsbrunner,
Letscher and Zomorodian 2002, doi:10.1007/s00454-002-2885-2). Inside slabs,
whatever enters through a level is older than anything that begins in the slab.
"""

import numpy as np
from numba import njit

from ..arrays.components import find, join
from .levels import vertex_slabs


def pair_in_slabs(mesh, levels, contours, crossings):
    """Partner of every vertex inside its slab, (n,) int32, -1 for none, and what is in one piece, (n + 2 C,) int32.

    What stays unpaired among the critical points is essential: a cylinder has
    none, an elementary piece one, and their alternating sum over a piece is
    its Euler characteristic. The second tells of every vertex, then of every
    contour seen from below, then of every contour seen from above the first
    of all these in its piece: what a sweep has joined when it leaves a slab.
    """
    slab, n, c = vertex_slabs(mesh, levels), len(mesh.points), len(contours.level)
    start, wedge = _wedges(mesh.faces, n)
    partner = np.full(n, -1, np.int32)
    _sweep(mesh.faces, slab, *crossings, start, wedge, c, False, partner)
    root = _sweep(mesh.faces, slab, *crossings, start, wedge, c, True, partner)
    return partner, _first_members(root, mesh.faces, slab, *crossings, contours.level, contours.first)


def connected_vertices(mesh):
    """Component of every vertex, (n,) int32, numbered by lowest vertex."""
    return _components(mesh.faces, len(mesh.points))


@njit(cache=True)
def _components(faces, n):
    root = np.arange(n)
    for f in range(faces.shape[0]):
        join(root, faces[f, 0], faces[f, 1])
        join(root, faces[f, 1], faces[f, 2])
    name, out, count = np.full(n, -1, np.int32), np.empty(n, np.int32), 0
    for v in range(n):
        r = find(root, v)
        if name[r] < 0:
            name[r] = count
            count += 1
        out[v] = name[r]
    return out


@njit(cache=True)
def _wedges(faces, n):
    """Faces of each vertex v, wedge[start[v]:start[v + 1]], that lead to all that is above and below it.

    One face per upper wedge of its link and one per lower one, the same: where
    v is the middle corner, such a wedge begins. An extremum has any one face.
    """
    start = np.zeros(n + 1, np.int32)
    for f in range(faces.shape[0]):
        if faces[f, 1] < faces[f, 2]:
            start[faces[f, 1] + 1] += 1
    extreme = start[1:] == 0
    for v in range(n):
        start[v + 1] += start[v] + extreme[v]
    fill, wedge = start[:-1].copy(), np.empty(start[n], np.int32)
    for f in range(faces.shape[0]):
        low, middle, high = faces[f, 0], min(faces[f, 1], faces[f, 2]), max(faces[f, 1], faces[f, 2])
        if middle == faces[f, 1]:
            wedge[fill[middle]] = f
            fill[middle] += 1
        if extreme[low]:
            wedge[start[low]] = f
        if extreme[high]:
            wedge[start[high]] = f
    return start, wedge


@njit(cache=True, inline="always")
def _beside(faces, slab, offset, label, f, v, c, upward):
    """What face f connects vertex v to inside its slab, below it if `upward`, else above it: a node of `_sweep`."""
    low, high = faces[f, 0], max(faces[f, 1], faces[f, 2])
    end = low if upward else high
    if slab[end] == slab[v]:
        return np.int64(c + end if upward else c + len(slab) - 1 - end)
    return np.int64(label[offset[f] + slab[v] - slab[low] - (1 if upward else 0)])


@njit(cache=True)
def _sweep(faces, slab, offset, label, start, wedge, c, upward, partner):
    """Pair what ends in a sweep with what it is that ends; returns what each node hangs on, (c + n,) int32.

    Nodes are the contours, which come in through a level, then the vertices
    in the order of the sweep, so that the root of a component is its oldest.
    What the faces of one wedge lead to is connected without the vertex.
    """
    n = len(slab)
    root = np.arange(c + n).astype(np.int32)
    for time in range(n):
        v = time if upward else n - 1 - time
        for i in range(start[v], start[v + 1]):
            a, b = find(root, c + time), find(root, _beside(faces, slab, offset, label, wedge[i], v, c, upward))
            old, young = min(a, b), max(a, b)
            if c <= young < c + time and young != old:
                ended = young - c if upward else n - 1 - (young - c)
                partner[ended], partner[v] = v, ended
            root[young] = old
    return root


@njit(cache=True)
def _first_members(root, faces, slab, offset, label, level, first):
    """The first of each piece: see `pair_in_slabs`. root : of an upward sweep."""
    n, c = len(slab), len(level)
    lowest, out = np.full(c + n, -1, np.int32), np.empty(n + 2 * c, np.int32)
    for node in range(c + n):
        root[node] = root[root[node]]  # which is older, and a root by now
    for i in range(n + 2 * c):
        node = c + i if i < n else i - n - c
        if n <= i < n + c:  # a contour bounds what its first face comes from
            k, f = level[i - n], first[i - n] // 3
            low = faces[f, 0]
            node = c + low if slab[low] == k else label[offset[f] + k - 1 - slab[low]]
        if lowest[root[node]] < 0:
            lowest[root[node]] = i
        out[i] = lowest[root[node]]
    return out
