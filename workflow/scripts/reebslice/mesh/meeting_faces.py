"""Pairs of faces that may cross: all whose boxes meet, but for those that a few floats show to be apart."""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from .box_tree import LEAF, boxes_meet, build_tree, order_along_curve
from .embedded_stars import face_outward, find_embedded
from .exact_signs import PLANE_BOUND, UNDERFLOW, bounded_turn


class FaceTree(NamedTuple):
    """Faces in a tree of boxes, with what tells quickly that two of them are apart.

    Attributes
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
        Of `exact_signs.scale_points`.
    facing : (m,) int8
        Of `embedded_stars.face_outward`.
    order : (m,) int32
        The face in each place of the tree.
    spans, boxes : (m, 6) and (2 p, 6) float32
        Of `box_tree.build_tree`, by place.
    marks : (m, 3) int64
        Of each corner twice the vertex, and 1 more if it is one of `embedded_stars.find_embedded`; by place.
    """

    points: np.ndarray
    faces: np.ndarray
    facing: np.ndarray
    order: np.ndarray
    spans: np.ndarray
    boxes: np.ndarray
    marks: np.ndarray


def plant_tree(points, faces):
    """Put the faces of a surface into a tree.

    Parameters
    ----------
    points : (n, 3) float64
        Of `exact_signs.scale_points`.
    faces : (m, 3) int32
        Of a closed surface; the faces of each vertex are one fan.

    Returns
    -------
    FaceTree
    """
    seen, facing = face_outward(points, faces)
    embedded = find_embedded(points, faces, seen)
    order = order_along_curve(points, faces)
    spans, boxes = build_tree(points, faces, order, points.min(axis=0))
    return FaceTree(points, faces, facing, order, spans, boxes, _mark(faces, order, embedded))


@njit
def _mark(faces, order, embedded):
    """The marks of the corners of the faces, in the order given."""
    marks = np.empty((len(order), 3), np.int64)
    for place in range(len(order)):
        for k in range(3):
            v = faces[order[place], k]
            marks[place, k] = 2 * v + embedded[v]
    return marks


@njit
def walk_on(tree, stack, height, pairs):
    """Walk over the pairs of nodes on the stack, and those below them, until they or the room for pairs run out.

    Parameters
    ----------
    tree : FaceTree
    stack : (s, 2) int32
        Pairs of nodes; at least 4 per level of the tree, and 4 more. Overwritten; it begins with (1, 1).
    height : int
        How many are on it.
    pairs : (c, 2) int32
        Room for pairs; at least LEAF * LEAF + 1.

    Returns
    -------
    height : int
        How many pairs of nodes are left on the stack.
    count : int
        How many pairs of places have been entered whose boxes meet.
    """
    spans, boxes, m = tree.spans, tree.boxes, len(tree.order)
    first, count = len(boxes) // 2, 0
    while height > 0 and count + LEAF * LEAF < len(pairs):
        height -= 1
        a, b = stack[height]
        # What is written beyond the count is overwritten: a branch would be mispredicted every other time.
        if a < first:
            for one in (2 * a, 2 * a + 1):
                for two in (2 * b, 2 * b + 1):
                    stack[height, 0], stack[height, 1] = one, two
                    height += (one <= two) & boxes_meet(boxes, one, boxes, two)
            continue
        a, b = LEAF * (a - first), LEAF * (b - first)
        for f in range(a, min(a + LEAF, m)):
            for g in range(b, min(b + LEAF, m)):
                pairs[count, 0], pairs[count, 1] = f, g
                count += (f < g) & boxes_meet(spans, f, spans, g)
    return height, count


@njit
def thin_out(tree, pairs):
    """Leave out the pairs of faces that surely meet in no more than a common vertex or mesh edge.

    Parameters
    ----------
    tree : FaceTree
    pairs : (c, 2) int32
        Places, of `walk_on`. Overwritten.

    Returns
    -------
    (c', 2) int32
        The faces of the pairs that are left, the lower number first.
    """
    count = 0
    for f, g in pairs:
        if _are_known(tree.marks, f, g):
            continue
        one, two = tree.order[f], tree.order[g]
        if _may_meet(tree.points, tree.faces, tree.facing, one, two):
            pairs[count, 0], pairs[count, 1] = min(one, two), max(one, two)
            count += 1
    return pairs[:count]


@njit(inline="always")
def _are_known(marks, f, g):
    """Whether two faces have a vertex in common around which all is embedded."""
    p, q, r, found = marks[g, 0], marks[g, 1], marks[g, 2], False
    for k in range(3):
        mark = marks[f, k]
        found |= ((mark == p) | (mark == q) | (mark == r)) & (mark % 2 == 1)
    return found


@njit
def _may_meet(points, faces, facing, f, g):
    """Whether two faces may meet in more than a common vertex or mesh edge."""
    a, b = (faces[f, 0], faces[f, 1], faces[f, 2]), (faces[g, 0], faces[g, 1], faces[g, 2])
    for one, two, way in ((a, b, facing[f]), (b, a, facing[g])):
        if way != 0 and _is_beyond(points, one, two, way):
            return False
    return not (_is_off(points, a, b) or _is_off(points, b, a))


@njit(inline="always")
def _is_beyond(points, f, g, facing):
    """Whether g is surely beyond some side of f, seen along an axis, but for vertices at the ends of that side."""
    axis = abs(facing) - 1
    x, y = (1, 2) if axis == 0 else ((2, 0) if axis == 1 else (0, 1))
    for i, j in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0])):
        beyond = True
        for v in g:
            if v != i and v != j:
                turn = bounded_turn(points[i, x], points[i, y], points[j, x], points[j, y], points[v, x], points[v, y])
                if turn * facing >= 0:
                    beyond = False
                    break
        if beyond:
            return True
    return False


@njit(inline="always")
def _is_off(points, f, g):
    """Whether g is surely on one side of the plane of f, but for common vertices."""
    i, j, k = f
    ax, ay, az = points[i, 0], points[i, 1], points[i, 2]
    ux, uy, uz = points[j, 0] - ax, points[j, 1] - ay, points[j, 2] - az
    vx, vy, vz = points[k, 0] - ax, points[k, 1] - ay, points[k, 2] - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    sx, sy, sz = abs(uy * vz) + abs(uz * vy), abs(uz * vx) + abs(ux * vz), abs(ux * vy) + abs(uy * vx)
    before = 0.0
    for v in g:
        if v in (i, j, k):
            continue
        wx, wy, wz = points[v, 0] - ax, points[v, 1] - ay, points[v, 2] - az
        side = wx * nx + wy * ny + wz * nz
        terms = abs(wx) * sx + abs(wy) * sy + abs(wz) * sz
        if abs(side) <= PLANE_BOUND * terms + UNDERFLOW or side * before < 0:
            return False
        before = 1.0 if side > 0 else -1.0
    return before != 0
