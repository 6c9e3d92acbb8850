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
    does not change their order, and faces with the same corners are neighbours;
    of those, the ones that run 0, 1, 2 come before the ones that run 0, 2, 1.
    """
    first = np.argmin(faces, axis=1)
    turns = (first[:, None] + np.arange(3)) % 3
    _, second, third = np.take_along_axis(faces, turns, axis=1).T
    runs = np.argsort(second > third, kind="stable")
    rows = runs[order_rows(np.sort(faces, axis=1)[runs], n_vertices)]
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


def split_pinches(faces, opposite, component):
    """Give each cycle of a vertex's link a vertex of its own.

    Returns `faces` (m, 3) over the new vertices and `origin` (n,), the vertex
    that each of them was. Copies follow each other in the order of their
    component, then of their first corner: of components that coincide, it does
    not matter which of two coinciding faces comes first.
    """
    fans = label_corners(faces, opposite)
    firsts = np.flatnonzero(fans == np.arange(len(fans)))
    vertex = faces.ravel()
    firsts = firsts[np.lexsort((component[firsts // 3], vertex[firsts]))]
    number = np.empty(len(fans), np.int64)
    number[firsts] = np.arange(len(firsts))
    return number[fans].reshape(-1, 3), vertex[firsts]


def split_double_edges(points, faces, opposite):
    """Give each mesh edge two vertices of its own, by a new one in the middle of what is double.

    points (n, 3), faces (m, 3) and opposite (3m,) of a closed surface, in
    which two mesh edges may join the same two vertices. Returns points, sorted
    as they were and with the new ones among them; faces over them; and the old
    face that each one was, or was a part of.
    """
    order, starts = group_half_edges(faces, len(points))
    middle = np.full(3 * len(faces), -1)
    new = []
    for edge in np.flatnonzero(np.diff(starts) > 2).tolist():
        here = np.sort(order[starts[edge] : starts[edge + 1]])
        firsts = here[here < opposite[here]]
        for half_edge in firsts[1:].tolist():
            middle[[half_edge, opposite[half_edge]]] = len(points) + len(new)
            new.append(points[faces[half_edge // 3, [half_edge % 3, half_edge % 3 - 2]]].mean(axis=0))
    if not new:
        return points, faces, np.arange(len(faces))
    cut = np.flatnonzero((middle.reshape(-1, 3) >= 0).any(axis=1))
    fans = [_fan_out(faces[face].tolist(), middle[3 * face : 3 * face + 3].tolist()) for face in cut.tolist()]
    old = np.concatenate([np.delete(np.arange(len(faces)), cut), np.repeat(cut, [len(fan) for fan in fans])])
    faces = np.concatenate([np.delete(faces, cut, axis=0), *fans])
    points = np.concatenate([points, new])
    order = np.lexsort(points.T[::-1])
    return points[order], np.argsort(order)[faces], old


def _fan_out(face, middles):
    """Return the triangles of one face with new vertices in the middle of some of its sides."""
    ring = [vertex for pair in zip(face, middles) for vertex in pair if vertex >= 0]
    first = next(k for k, vertex in enumerate(ring) if vertex in middles)
    ring = ring[first:] + ring[:first]
    return [[ring[0], one, two] for one, two in zip(ring[1:], ring[2:])]
