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
    spans, boxes : (m, 6) and (2 p, 6) float64
        Of `box_tree.build_tree`.
    order : (m,) int32
        The face in each place of the tree.
    corners : (m, 9) float64
        Coordinates, by place.
    ids : (m, 3) int32
        Vertices, by place.
    facing : (m,) int8
        Of `embedded_stars.face_outward`, by place.
    embedded : (n,) bool
        Of `embedded_stars.find_embedded`, by vertex.
    """

    spans: np.ndarray
    boxes: np.ndarray
    order: np.ndarray
    corners: np.ndarray
    ids: np.ndarray
    facing: np.ndarray
    embedded: np.ndarray


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
    corners, ids = _gather(points, faces, order)
    return FaceTree(*build_tree(corners), order, corners, ids, facing[order], embedded)


@njit
def _gather(points, faces, order):
    """Coordinates and ids of the corners of the faces, in the order given."""
    corners, ids = np.empty((len(order), 9)), np.empty((len(order), 3), np.int32)
    for place in range(len(order)):
        for k in range(3):
            v = ids[place, k] = faces[order[place], k]
            for axis in range(3):
                corners[place, 3 * k + axis] = points[v, axis]
    return corners, ids


@njit
def walk_on(tree, stack, height, pairs):
    """Walk over the pairs of nodes on the stack, and those below them, until they or the room for pairs run out.

    Parameters
    ----------
    tree : FaceTree
    stack : (s, 2) int64
        Pairs of nodes; at least 4 per level of the tree. Overwritten; it begins with (1, 1).
    height : int
        How many are on it.
    pairs : (c, 2) int32
        Room for pairs of faces; at least LEAF * LEAF.

    Returns
    -------
    height : int
        How many pairs of nodes are left on the stack.
    count : int
        How many pairs of faces have been entered, the lower number first.
    """
    first, count = len(tree.boxes) // 2, 0
    while height > 0 and count + LEAF * LEAF <= len(pairs):
        height -= 1
        a, b = stack[height]
        if a >= first:
            count = _meet_leaves(tree, a, b, pairs, count)
            continue
        for one in (2 * a, 2 * a + 1):
            for two in (2 * b, 2 * b + 1):
                if one <= two and boxes_meet(tree.boxes, one, tree.boxes, two):
                    stack[height, 0], stack[height, 1] = one, two
                    height += 1
    return height, count


@njit(inline="always")
def _meet_leaves(tree, a, b, pairs, count):
    """Enter the pairs of a face in one leaf and one in another, or of two in one leaf, that may meet."""
    first, m = len(tree.boxes) // 2, len(tree.order)
    begin, end = LEAF * (b - first), min(LEAF * (b - first + 1), m)
    for f in range(LEAF * (a - first), min(LEAF * (a - first + 1), m)):
        if a != b and not boxes_meet(tree.spans, f, tree.boxes, b):
            continue
        for g in range(f + 1 if a == b else begin, end):
            if (
                boxes_meet(tree.spans, f, tree.spans, g)
                and not _are_known(tree.ids, tree.embedded, f, g)
                and _may_meet(tree, f, g)
            ):
                one, two = tree.order[f], tree.order[g]
                pairs[count, 0], pairs[count, 1] = min(one, two), max(one, two)
                count += 1
    return count


@njit(inline="always")
def _are_known(ids, embedded, f, g):
    """Whether two faces have a vertex in common around which all is embedded."""
    p, q, r, found = ids[g, 0], ids[g, 1], ids[g, 2], False
    for k in range(3):
        v = ids[f, k]
        found |= ((v == p) | (v == q) | (v == r)) and embedded[v]
    return found


@njit
def _may_meet(tree, f, g):
    """Whether two faces may meet in more than a common vertex or mesh edge."""
    for one, two in ((f, g), (g, f)):
        if tree.facing[one] != 0:
            for k in range(3):
                if _is_beyond(tree, one, two, k):
                    return False
    return not (_is_off(tree, f, g) or _is_off(tree, g, f))


@njit(inline="always")
def _is_beyond(tree, f, g, k):
    """Whether g is surely beyond side k of f, seen along an axis, but for vertices at the ends of that side."""
    corners, ids, facing = tree.corners, tree.ids, tree.facing[f]
    axis, after = abs(facing) - 1, (k + 1) % 3
    x, y = (axis + 1) % 3, (axis + 2) % 3
    for c in range(3):
        if ids[g, c] != ids[f, k] and ids[g, c] != ids[f, after]:
            turn = bounded_turn(
                corners[f, 3 * k + x],
                corners[f, 3 * k + y],
                corners[f, 3 * after + x],
                corners[f, 3 * after + y],
                corners[g, 3 * c + x],
                corners[g, 3 * c + y],
            )
            if turn * facing >= 0:
                return False
    return True


@njit(inline="always")
def _is_off(tree, f, g):
    """Whether g is surely on one side of the plane of f, but for common vertices."""
    corners, ids = tree.corners, tree.ids
    ax, ay, az = corners[f, 0], corners[f, 1], corners[f, 2]
    ux, uy, uz = corners[f, 3] - ax, corners[f, 4] - ay, corners[f, 5] - az
    vx, vy, vz = corners[f, 6] - ax, corners[f, 7] - ay, corners[f, 8] - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    sx, sy, sz = abs(uy * vz) + abs(uz * vy), abs(uz * vx) + abs(ux * vz), abs(ux * vy) + abs(uy * vx)
    before = 0.0
    for c in range(3):
        if ids[g, c] == ids[f, 0] or ids[g, c] == ids[f, 1] or ids[g, c] == ids[f, 2]:
            continue
        wx, wy, wz = corners[g, 3 * c] - ax, corners[g, 3 * c + 1] - ay, corners[g, 3 * c + 2] - az
        side = wx * nx + wy * ny + wz * nz
        terms = abs(wx) * sx + abs(wy) * sy + abs(wz) * sz
        if abs(side) <= PLANE_BOUND * terms + UNDERFLOW or side * before < 0:
            return False
        before = 1.0 if side > 0 else -1.0
    return before != 0
