"""How the faces of a surface are glued: mesh edges, winding, vertices.

Half-edge `3 * f + k` runs from corner k of face f to the next corner; the
corner it starts from bears the same number.
"""

import numpy as np
from numba import njit

from ..arrays.components import find, join
from ..arrays.sorting import sort_stably
from .half_edges import _ahead, group_half_edges


@njit(cache=True)
def label_components(faces, opposite):
    """Tell the components of a closed surface (m, 3) apart, and how they are wound.

    Returns `component` (m,) int32, numbered in order of the first face;
    `turned` (m,) bool, the faces wound against the first face of their
    component; and `conflict`, a half-edge at which no choice of turned faces
    agrees (the component is one-sided), or -1.
    """
    root, tails = np.arange(len(faces)).astype(np.int32), faces.ravel()
    for h in range(len(tails)):
        if opposite[h] < h:
            if tails[h] == tails[opposite[h]]:
                return _walk_components(faces, opposite)
            join(root, np.int32(h // 3), np.int32(opposite[h] // 3))
    component, label = np.empty(len(faces), np.int32), 0
    for f in range(len(faces)):
        first = find(root, f)
        component[f] = label if first == f else component[first]
        label += first == f
    return component, np.zeros(len(faces), np.bool_), -1


@njit(cache=True)
def _walk_components(faces, opposite):
    """The same, walking over the faces from neighbour to neighbour, whichever way they are wound."""
    n_faces = len(faces)
    component = np.full(n_faces, -1, np.int32)
    turned = np.zeros(n_faces, np.bool_)
    stack = np.empty(n_faces, np.int32)
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
    label = np.full(n_corners, -1, np.int32)
    for first in range(n_corners):
        corner, ahead = first, True  # the fan goes on over the half-edge that begins here, or that ends here
        while label[corner] < 0:
            label[corner] = first
            half_edge = corner if ahead else (corner + 2 if corner % 3 == 0 else corner - 1)
            other = opposite[half_edge]
            ahead = faces[other // 3, other % 3] != faces[corner // 3, corner % 3]
            corner = (other + 1 if other % 3 < 2 else other - 2) if ahead else other
    return label


def split_pinches(faces, opposite, component, n_vertices):
    """Give each cycle of a vertex's link a vertex of its own, and none to a vertex without faces.

    Returns `faces` (m, 3) over the new vertices and `origin` (n,), the vertex
    that each of them was. Copies follow each other in the order of their
    component, then of their first corner: of components that coincide, it does
    not matter which of two coinciding faces comes first.
    """
    if _has_single_fans(faces.ravel(), opposite, n_vertices):
        return faces, np.arange(n_vertices)
    fans = label_corners(faces, opposite)
    firsts = np.flatnonzero(fans == np.arange(len(fans)))
    vertex = faces.ravel()
    keys = (component[firsts // 3], component.max(initial=-1) + 1), (vertex[firsts], vertex.max(initial=-1) + 1)
    firsts = firsts[sort_stably(*keys)]
    number = np.empty(len(fans), np.int32)
    number[firsts] = np.arange(len(firsts))
    return number[fans].reshape(-1, 3), vertex[firsts]


@njit(cache=True)
def _has_single_fans(tails, opposite, n):
    """Tell whether each of n vertices has one cycle of corners around it."""
    degree, some = np.zeros(n, np.int32), np.empty(n, np.int32)
    for corner in range(len(tails)):
        degree[tails[corner]] += 1
        some[tails[corner]] = corner
    for v in range(n):
        if degree[v] == 0:
            return False
        corner, ahead, left = np.int64(some[v]), True, degree[v]
        while left > 0:  # see `label_corners`
            other = np.int64(opposite[corner if ahead else corner - 1 + 3 * (corner % 3 == 0)])
            ahead = tails[other] != v
            corner = _ahead(other) if ahead else other
            left -= 1
            if corner == some[v]:
                break
        if left > 0:
            return False
    return True


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
    return points[order], np.argsort(order).astype(np.int32)[faces], old


def _fan_out(face, middles):
    """Return the triangles of one face with new vertices in the middle of some of its sides."""
    ring = [vertex for pair in zip(face, middles) for vertex in pair if vertex >= 0]
    first = next(k for k, vertex in enumerate(ring) if vertex in middles)
    ring = ring[first:] + ring[:first]
    return [[ring[0], one, two] for one, two in zip(ring[1:], ring[2:])]
