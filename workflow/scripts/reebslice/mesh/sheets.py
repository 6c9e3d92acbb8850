"""The sheets of a closed surface: components, winding, and vertices with one fan of faces each.

A sheet runs on across its mesh edges from face to face. Sheets may touch, and
then share positions, but no faces; here each gets vertices of its own.
"""

import itertools

import numpy as np

from ..arrays.components import find, join
from ..arrays.sorting import sort_stably
from ..kernels import njit
from .half_edges import ahead, behind, group_half_edges


@njit
def label_components(faces, opposite):
    """Label the connected components of a closed surface, and find how they are wound.

    Parameters
    ----------
    faces : (m, 3) int32
    opposite : (3 m,) int32
        The other half-edge of each mesh edge.

    Returns
    -------
    component : (m,) int32
        Numbered in order of the first face.
    turned : (m,) bool
        The faces wound against the first face of their component.
    conflict : int
        A half-edge at which no choice of turned faces agrees, so that the
        component is one-sided; or -1.
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


@njit
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
                if other == half_edge:
                    continue
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


def find_conflict(glued):
    """Find where a surface is one-sided, walking across the mesh edges that have exactly two faces.

    Parameters
    ----------
    glued : closing.Gluing
        Not closed.

    Returns
    -------
    int
        A half-edge at which no choice of turned faces agrees, or -1.
    """
    pairs = glued.starts[:-1][np.diff(glued.starts) == 2]
    one, two = glued.order[pairs], glued.order[pairs + 1]
    opposite = np.arange(glued.faces.size, dtype=np.int32)  # itself, where it is not of such a mesh edge
    opposite[one], opposite[two] = two, one
    return int(_walk_components(glued.faces, opposite)[2])


@njit
def label_corners(faces, opposite):
    """Label the corners of a closed surface by vertex.

    Two corners share a vertex of the surface iff a chain of faces, each glued
    to the next along a mesh edge at that vertex, joins them: one label is one
    cycle of the vertex's link.

    Parameters
    ----------
    faces : (m, 3) int32
    opposite : (3 m,) int32

    Returns
    -------
    (3 m,) int32
        The first corner of each corner's fan of faces.
    """
    n_corners = 3 * len(faces)
    label = np.full(n_corners, -1, np.int32)
    for first in range(n_corners):
        corner, forward = first, True  # the fan goes on over the half-edge that begins here, or that ends here
        while label[corner] < 0:
            label[corner] = first
            other = opposite[corner if forward else behind(corner)]
            forward = faces[other // 3, other % 3] != faces[corner // 3, corner % 3]
            corner = ahead(other) if forward else other
    return label


def split_pinches(faces, opposite, component, n_vertices):
    """Give each cycle of a vertex's link a vertex of its own, and none to a vertex without faces.

    Parameters
    ----------
    faces : (m, 3) int32
    opposite : (3 m,) int32
    component : (m,) int32
    n_vertices : int

    Returns
    -------
    faces : (m, 3) int32
        The same faces over the new vertices.
    origin : (n,) int
        The vertex that each new one was. Copies follow each other in the order
        of their component, then of their first corner: of components that
        coincide, it does not matter which of two coinciding faces comes first.
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


@njit
def _has_single_fans(tails, opposite, n):
    """Tell whether each of n vertices has one cycle of corners around it."""
    degree, some = np.zeros(n, np.int32), np.empty(n, np.int32)
    for corner in range(len(tails)):
        degree[tails[corner]] += 1
        some[tails[corner]] = corner
    for v in range(n):
        if degree[v] == 0:
            return False
        corner, forward, left = np.int64(some[v]), True, degree[v]
        while left > 0:  # see `label_corners`
            other = np.int64(opposite[corner if forward else behind(corner)])
            forward = tails[other] != v
            corner = ahead(other) if forward else other
            left -= 1
            if corner == some[v]:
                break
        if left > 0:
            return False
    return True


def split_double_edges(points, faces, opposite):
    """Put a new vertex in the middle of every mesh edge that joins the same two vertices as another one.

    Of all of them, as the middle is rounded: sheets that touch along the edge
    would cross where one bends there and the other does not.

    Parameters
    ----------
    points : (n, 3) float64
        In lexicographic order.
    faces : (m, 3) int32
    opposite : (3 m,) int32

    Returns
    -------
    points, faces : (n', 3) float64 and (m', 3) int32
        No two mesh edges join the same two vertices; the order of the points is kept.
    old : (m',) int64
        The face that each one was, or was a part of.
    """
    order, starts = group_half_edges(faces, len(points))
    middle = np.full(3 * len(faces), -1)
    new = []
    for edge in np.flatnonzero(np.diff(starts) > 2).tolist():
        here = np.sort(order[starts[edge] : starts[edge + 1]])
        firsts = here[here < opposite[here]]
        for half_edge in firsts.tolist():
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
    return [[ring[0], one, two] for one, two in itertools.pairwise(ring[1:])]
