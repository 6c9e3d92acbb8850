"""How the faces of a surface are glued: mesh edges, winding, vertices.

Half-edge `3 * f + k` runs from corner k of face f to the next corner; the
corner it starts from bears the same number.
"""

import numpy as np
from numba import njit


def order_corners(faces, n_vertices):
    """Return (m, 3) corners that put faces and their corners in canonical order.

    `faces.ravel()[corners]` are the same faces, each beginning at its smallest
    id, in lexicographic order of the *unordered* triples: turning faces over
    does not change their order, and faces with the same corners are neighbours.
    """
    first = np.argmin(faces, axis=1)
    turns = (first[:, None] + np.arange(3)) % 3
    rows = order_rows(np.sort(faces, axis=1), n_vertices)
    return 3 * rows[:, None] + turns[rows]


def order_rows(rows, n_vertices):
    """Argsort, stable and lexicographic, of (m, 3) ids below n_vertices."""
    a, b, c = rows.T.astype(np.int64)
    if n_vertices < 2**21:  # three ids fit one key: one sort instead of three
        return np.argsort((a * n_vertices + b) * n_vertices + c, kind="stable")
    return np.lexsort((c, a * n_vertices + b))


def group_half_edges(faces, n_vertices):
    """Group the half-edges by mesh edge.

    Returns `order`, (3m,) half-edges sorted by mesh edge, and `starts`, the
    (e + 1,) offsets in it at which the mesh edges begin and end.
    """
    begin = faces.ravel()
    end = np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(begin, end) * n_vertices + np.maximum(begin, end)
    order = np.argsort(key, kind="stable")
    key = key[order]
    new = np.flatnonzero(key[1:] != key[:-1]) + 1
    starts = np.concatenate([[0], new, [len(key)]]) if len(key) else np.zeros(1, int)
    return order, starts


def pair_half_edges(order, starts):
    """Return (3m,) the other half-edge of each half-edge's mesh edge.

    Every mesh edge must have exactly two faces.
    """
    assert np.all(np.diff(starts) == 2)
    opposite = np.empty(len(order), np.int64)
    opposite[order[0::2]] = order[1::2]
    opposite[order[1::2]] = order[0::2]
    return opposite


@njit(cache=True)
def label_components(faces, opposite):
    """Walk over the faces from neighbour to neighbour.

    Returns `component` (m,), numbered in order of the first face;
    `turned` (m,) bool, the faces wound against the first face of their
    component; and `conflict`, a half-edge at which no choice of turned faces
    agrees (the component is one-sided), or -1.
    """
    n_faces = len(faces)
    component = np.full(n_faces, -1, np.int64)
    turned = np.zeros(n_faces, np.bool_)
    stack = np.empty(n_faces, np.int64)
    conflict = -1
    label = 0
    for seed in range(n_faces):
        if component[seed] >= 0:
            continue
        component[seed] = label
        stack[0] = seed
        height = 1
        while height:
            height -= 1
            face = stack[height]
            for half_edge in range(3 * face, 3 * face + 3):
                other = opposite[half_edge]
                neighbour = other // 3
                against = faces[face, half_edge % 3] == faces[neighbour, other % 3]
                if component[neighbour] < 0:
                    component[neighbour] = label
                    turned[neighbour] = turned[face] ^ against
                    stack[height] = neighbour
                    height += 1
                elif turned[neighbour] != turned[face] ^ against and conflict < 0:
                    conflict = half_edge
        label += 1
    return component, turned, conflict


@njit(cache=True)
def _find(parent, item):
    while parent[item] != item:
        parent[item] = parent[parent[item]]
        item = parent[item]
    return item


@njit(cache=True)
def _unite(parent, one, two):
    one, two = _find(parent, one), _find(parent, two)
    if one < two:
        parent[two] = one
    else:
        parent[one] = two


@njit(cache=True)
def label_corners(faces, opposite):
    """Return (3m,) the first corner of each corner's fan of faces.

    Two corners share a vertex of the surface iff a chain of faces, each glued
    to the next along a mesh edge at that vertex, joins them: one label is one
    cycle of the vertex's link.
    """
    n_corners = 3 * len(faces)
    parent = np.arange(n_corners)
    for corner in range(n_corners):
        other = opposite[corner]
        if other < corner:
            continue
        ahead = corner + 1 if corner % 3 < 2 else corner - 2
        other_ahead = other + 1 if other % 3 < 2 else other - 2
        if faces[corner // 3, corner % 3] == faces[other // 3, other % 3]:
            _unite(parent, corner, other)
            _unite(parent, ahead, other_ahead)
        else:
            _unite(parent, corner, other_ahead)
            _unite(parent, ahead, other)
    for corner in range(n_corners):
        parent[corner] = _find(parent, corner)
    return parent


def split_pinches(faces, opposite, n_vertices):
    """Give each cycle of a vertex's link a vertex of its own.

    Returns `faces` (m, 3) over the new vertices and `origin` (n,), the vertex
    that each of them was. Copies follow each other in the order of their first
    corner, so the result depends on the order of `faces` only.
    """
    fans = label_corners(faces, opposite)
    firsts = np.flatnonzero(fans == np.arange(len(fans)))
    vertex = faces.ravel()
    firsts = firsts[np.argsort(vertex[firsts], kind="stable")]
    number = np.empty(len(fans), np.int64)
    number[firsts] = np.arange(len(firsts))
    return number[fans].reshape(-1, 3), vertex[firsts]
