"""Which critical points cancel, by the elder rule.

An upward sweep pairs each minimum with the saddle at which its component
meets an older one; a downward sweep pairs maxima likewise (Edelsbrunner,
Letscher and Zomorodian 2002, doi:10.1007/s00454-002-2885-2). Inside slabs,
whatever enters through a level is older than anything that begins in the slab.
"""

import numpy as np
from numba import njit

from .slicing import vertex_slabs


def pair_in_slabs(mesh, levels, contours):
    """Partner of every vertex inside its slab, (n,) int32, -1 for none.

    What stays unpaired among the critical points is essential: a cylinder has
    none, an elementary piece one, and their alternating sum over a piece is
    its Euler characteristic.
    """
    slab = vertex_slabs(mesh, levels)
    return _pair(mesh, slab, contours.offset, contours.label, len(contours.level))


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


def _pair(mesh, slab, offset, label, n_contours):
    n = len(mesh.points)
    partner = np.full(n, -1, np.int32)
    for upward in (True, False):
        start, earlier = _earlier_neighbours(mesh.faces, slab, offset, label, n, upward)
        order = np.arange(n, dtype=np.int32) if upward else np.arange(n, dtype=np.int32)[::-1].copy()
        _sweep(order, start, earlier, n_contours, partner)
    return partner


@njit(cache=True)
def _earlier_neighbours(faces, slab, offset, label, n, upward):
    """Per vertex, what a sweep has met before it next to it.

    Node v < n is a vertex, node n + c the contour c through which the mesh
    edge leaves the slab.
    """
    start = np.zeros(n + 1, np.int64)
    for f in range(faces.shape[0]):
        for k in range(3):
            low, high = faces[f, k], faces[f, (k + 1) % 3]
            if low < high:
                start[(high if upward else low) + 1] += 1
    for v in range(n):
        start[v + 1] += start[v]
    fill = start[:-1].copy()
    earlier = np.empty(start[n], np.int64)
    for f in range(faces.shape[0]):
        for k in range(3):
            low, high = faces[f, k], faces[f, (k + 1) % 3]
            if low >= high:
                continue
            v, node = (high, np.int64(low)) if upward else (low, np.int64(high))
            if slab[low] != slab[high]:
                h = 3 * f + k
                node = n + label[offset[h + 1] - 1 if upward else offset[h]]
            earlier[fill[v]] = node
            fill[v] += 1
    return start, earlier


@njit(cache=True)
def _sweep(order, start, earlier, n_contours, partner):
    n = len(order)
    root = np.arange(n + n_contours)
    age = np.empty(n + n_contours, np.int64)  # of a component's oldest member
    birth = np.full(n + n_contours, -1, np.int64)  # -1: it came in through a level
    age[n:] = -1
    for time in range(n):
        v = order[time]
        age[v], birth[v] = time, v
        for i in range(start[v], start[v + 1]):
            a, b = find(root, v), find(root, earlier[i])
            if a == b:
                continue
            if age[a] < age[b]:
                a, b = b, a
            # a is the younger; it ends here unless it is v itself or came in
            if birth[a] >= 0 and birth[a] != v:
                partner[birth[a]], partner[v] = v, birth[a]
            root[a] = b


@njit(cache=True, inline="always")
def find(root, i):
    """The representative of i in a union-find forest, with path halving."""
    while root[i] != i:
        root[i] = root[root[i]]
        i = root[i]
    return i


@njit(cache=True, inline="always")
def join(root, i, j):
    """Unite the sets of i and j; the smaller representative remains."""
    i, j = find(root, i), find(root, j)
    if i < j:
        root[j] = i
    elif j < i:
        root[i] = j
