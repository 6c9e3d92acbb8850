"""Pairs of faces that may cross: all whose boxes meet, but for those that a few floats show to be apart."""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from .box_tree import LEAF, boxes_meet, build_tree, order_along_curve
from .embedded_stars import face_outward, find_embedded
from .exact_signs import PLANE_BOUND, UNDERFLOW, bounded_turn


class FaceTree(NamedTuple):
    """Faces in a tree of boxes, with what tells quickly that two of them are apart.

    Faces are in the order of a curve through space, by places, and vertices as
    these name them first, so that what is near in space is so in memory.

    Attributes
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
        By place.
    facing : (m,) int8
        Of `embedded_stars.face_outward`, by place.
    embedded : (n,) bool
        Of `embedded_stars.find_embedded`.
    order : (m,) int32
        The face in each place.
    spans, boxes : (m, 6) and (2 p, 6) float32
        Of `box_tree.build_tree`, by place.
    """

    points: np.ndarray
    faces: np.ndarray
    facing: np.ndarray
    embedded: np.ndarray
    order: np.ndarray
    spans: np.ndarray
    boxes: np.ndarray


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
    order = order_along_curve(points, faces)
    points, faces = _lay_out(points, faces, order)
    seen, facing = face_outward(points, faces)
    embedded = find_embedded(points, faces, seen)
    return FaceTree(points, faces, facing, embedded, order, *build_tree(points, faces, points.min(axis=0)))


@njit
def _lay_out(points, faces, order):
    """The faces in the order given, and their vertices in the order in which these name them first."""
    place, names = np.full(len(points), np.int32(-1)), np.empty((len(order), 3), np.int32)
    laid, count = np.empty_like(points), 0
    for f in range(len(order)):
        for k in range(3):
            v = faces[order[f], k]
            if place[v] < 0:
                place[v] = count
                laid[count, 0], laid[count, 1], laid[count, 2] = points[v, 0], points[v, 1], points[v, 2]
                count += 1
            names[f, k] = place[v]
    return laid[:count], names


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
    spans, boxes, last = tree.spans, tree.boxes, len(tree.order) - 1
    first, count = len(boxes) // 2, 0
    while height > 0 and count + LEAF * LEAF < len(pairs):
        height -= 1
        a, b = stack[height]
        # All four first, and each is written: one that does not meet is overwritten by the next, since a branch would
        # be mispredicted every other time.
        if a < first:
            a, b = 2 * a, 2 * b
            meet = boxes_meet(boxes, a, boxes, b), boxes_meet(boxes, a, boxes, b + 1)
            more = (a != b) & boxes_meet(boxes, a + 1, boxes, b), boxes_meet(boxes, a + 1, boxes, b + 1)
            height += _put(stack, height, a, b, meet[0])
            height += _put(stack, height, a, b + 1, meet[1])
            height += _put(stack, height, a + 1, b, more[0])
            height += _put(stack, height, a + 1, b + 1, more[1])
        else:
            a, b = LEAF * (a - first), LEAF * (b - first)
            c, d = min(a + 1, last), min(b + 1, last)  # of the last leaf there may be but one
            meet = (a < b) & boxes_meet(spans, a, spans, b), (b < d) & boxes_meet(spans, a, spans, d)
            more = (c < b) & boxes_meet(spans, c, spans, b), (c < d) & (b < d) & boxes_meet(spans, c, spans, d)
            count += _put(pairs, count, a, b, meet[0])
            count += _put(pairs, count, a, d, meet[1])
            count += _put(pairs, count, c, b, more[0])
            count += _put(pairs, count, c, d, more[1])
    return height, count


@njit(inline="always")
def _put(pairs, row, one, other, there):
    """Write a pair; return whether it is there to stay."""
    pairs[row, 0], pairs[row, 1] = one, other
    return there


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
        The places of the pairs that are left, that of the face of the lower number first.
    """
    count, left = 0, 0
    for f, g in pairs:
        count += _put(pairs, count, f, g, not _are_known(tree.faces, tree.embedded, f, g))
    for f, g in pairs[:count]:
        if _may_meet(tree.points, tree.faces, tree.facing, f, g):
            swapped = tree.order[f] > tree.order[g]
            pairs[left, 0], pairs[left, 1] = (g if swapped else f), (f if swapped else g)
            left += 1
    return pairs[:left]


@njit(inline="always")
def _are_known(faces, embedded, f, g):
    """Whether two faces have a vertex in common around which all is embedded."""
    p, q, r, found = faces[g, 0], faces[g, 1], faces[g, 2], False
    for k in range(3):
        v = faces[f, k]
        found |= ((v == p) | (v == q) | (v == r)) & embedded[v]
    return found


@njit(inner=True)
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
    found = False
    for i, j in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0])):
        beyond = True
        for v in g:  # all nine: the processor would mispredict most branches
            turn = bounded_turn(points[i, x], points[i, y], points[j, x], points[j, y], points[v, x], points[v, y])
            beyond &= (v == i) | (v == j) | (turn * facing < 0)
        found |= beyond
    return found


@njit(inline="always")
def _is_off(points, f, g):
    """Whether g is surely on one side of the plane of f, but for common vertices."""
    i, j, k = f
    ax, ay, az = points[i, 0], points[i, 1], points[i, 2]
    ux, uy, uz = points[j, 0] - ax, points[j, 1] - ay, points[j, 2] - az
    vx, vy, vz = points[k, 0] - ax, points[k, 1] - ay, points[k, 2] - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    sx, sy, sz = abs(uy * vz) + abs(uz * vy), abs(uz * vx) + abs(ux * vz), abs(ux * vy) + abs(uy * vx)
    above, below, some = True, True, False
    for v in g:  # without branches, likewise
        wx, wy, wz = points[v, 0] - ax, points[v, 1] - ay, points[v, 2] - az
        side = wx * nx + wy * ny + wz * nz
        open_until = PLANE_BOUND * (abs(wx) * sx + abs(wy) * sy + abs(wz) * sz) + UNDERFLOW
        common = (v == i) | (v == j) | (v == k)
        above &= common | (side > open_until)
        below &= common | (side < -open_until)
        some |= not common
    return (above | below) & some
