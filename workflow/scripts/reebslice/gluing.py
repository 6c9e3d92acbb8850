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
    first, low, middle, high, against = _sort_corners(np.ascontiguousarray(faces, np.int64))
    rows = sort_stably((against, 2), (high, n_vertices), (middle, n_vertices), (low, n_vertices))
    return _turn_corners(rows, first)


@njit(cache=True)
def _sort_corners(faces):
    """Of each face the corner of its smallest id; its three ids, ascending; 1 if it runs 0, 2, 1, else 0."""
    m = len(faces)
    first, against = np.empty(m, np.int64), np.empty(m, np.int64)
    low, middle, high = np.empty(m, np.int64), np.empty(m, np.int64), np.empty(m, np.int64)
    for f in range(m):
        k = 1 if faces[f, 1] < faces[f, 0] else 0
        k = 2 if faces[f, 2] < faces[f, k] else k
        second, third = faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
        first[f], low[f], middle[f], high[f] = k, faces[f, k], min(second, third), max(second, third)
        against[f] = second > third
    return first, low, middle, high, against


@njit(cache=True)
def _turn_corners(rows, first):
    """The corners (m, 3) of the faces `rows`, beginning at their corners `first`."""
    corners = np.empty((len(rows), 3), np.int64)
    for i in range(len(rows)):
        for k in range(3):
            corners[i, k] = 3 * rows[i] + (first[rows[i]] + k) % 3
    return corners


def order_rows(rows, n_vertices):
    """Argsort, stable and lexicographic, of (m, 3) ids below n_vertices."""
    a, b, c = np.ascontiguousarray(rows.T, np.int64)
    return sort_stably((c, n_vertices), (b, n_vertices), (a, n_vertices))


def sort_stably(*keys):
    """Argsort by whole numbers, the most significant last as `np.lexsort` has it; linear in time.

    keys : pairs of an array (m,) int64 and a bound that its numbers, none negative, stay below.
    """
    order = np.arange(len(keys[0][0]))
    for numbers, bound in keys:
        order = _sort_by(numbers, order, bound)
    return order


@njit(cache=True)
def _sort_by(numbers, order, bound):
    """Put `order` in order of numbers[order], by counting, equal ones left as they are."""
    fill = np.zeros(bound + 1, np.int64)
    for number in numbers:
        fill[number + 1] += 1
    for number in range(bound):
        fill[number + 1] += fill[number]
    out = np.empty_like(order)
    for i in order:
        out[fill[numbers[i]]] = i
        fill[numbers[i]] += 1
    return out


def group_half_edges(faces, n_vertices):
    """Group the half-edges by mesh edge.

    Returns `order`, (3m,) half-edges sorted by mesh edge, and `starts`, the
    (e + 1,) offsets in it at which the mesh edges begin and end.
    """
    low, high = _find_ends(np.ascontiguousarray(faces, np.int64))
    order = sort_stably((high, n_vertices), (low, n_vertices))
    return order, _find_starts(low, high, order)


@njit(cache=True)
def _find_ends(faces):
    """The smaller and the larger id on each half-edge, two (3m,)."""
    low, high = np.empty(3 * len(faces), np.int64), np.empty(3 * len(faces), np.int64)
    for h in range(len(low)):
        one, two = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        low[h], high[h] = min(one, two), max(one, two)
    return low, high


@njit(cache=True)
def _find_starts(low, high, order):
    starts, count = np.zeros(len(order) + 1, np.int64), 0
    for i in range(1, len(order) + 1):
        if i == len(order) or low[order[i]] != low[order[i - 1]] or high[order[i]] != high[order[i - 1]]:
            count += 1
            starts[count] = i
    return starts[: count + 1].copy()


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
def label_corners(faces, opposite):
    """Return (3m,) the first corner of each corner's fan of faces.

    Two corners share a vertex of the surface iff a chain of faces, each glued
    to the next along a mesh edge at that vertex, joins them: one label is one
    cycle of the vertex's link.
    """
    n_corners = 3 * len(faces)
    label = np.full(n_corners, -1)
    for first in range(n_corners):
        corner, ahead = first, True  # the fan goes on over the half-edge that begins here, or that ends here
        while label[corner] < 0:
            label[corner] = first
            half_edge = corner if ahead else (corner + 2 if corner % 3 == 0 else corner - 1)
            other = opposite[half_edge]
            ahead = faces[other // 3, other % 3] != faces[corner // 3, corner % 3]
            corner = (other + 1 if other % 3 < 2 else other - 2) if ahead else other
    return label


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
    keys = (component[firsts // 3], component.max(initial=-1) + 1), (vertex[firsts], vertex.max(initial=-1) + 1)
    firsts = firsts[sort_stably(*keys)]
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
