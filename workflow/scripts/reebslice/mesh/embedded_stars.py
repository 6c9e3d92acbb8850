"""Vertices around which a surface is seen not to cross itself: some projection of their faces has no folds.

If all faces around a vertex are counter-clockwise seen from one direction, and
go around it once, then they meet in nothing but their common vertices and mesh
edges. This settles almost all pairs of neighbouring faces at once.
"""

import numpy as np

from ..kernels import njit

# Directions of projection, and for each two vectors at right angles to it, by
# which the vertices of a link are on one side or the other of the middle one.
DIRECTIONS = np.array([
    [1, 0, 0], [0, 1, 0], [0, 0, 1],
    [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1],
    [1, 1, 1], [1, 1, -1], [1, -1, 1], [-1, 1, 1],
], np.float64)  # fmt: skip
FIRST = np.array([
    [0, 1, 0], [0, 0, 1], [1, 0, 0],
    [0, 0, 1], [0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [1, 0, 0],
    [1, -1, 0], [1, -1, 0], [1, 1, 0], [1, 1, 0],
], np.float64)  # fmt: skip
SECOND = np.array([
    [0, 0, 1], [1, 0, 0], [0, 1, 0],
    [1, -1, 0], [1, 1, 0], [1, 0, -1], [1, 0, 1], [0, 1, -1], [0, 1, 1],
    [0, 1, -1], [0, 1, 1], [0, 1, 1], [0, 1, -1],
], np.float64)  # fmt: skip
NORMAL_BOUND = 1e-15  # of the absolute terms: nine roundings of 2^-53, where there are no more than seven
UNDERFLOW = 1e-280


@njit
def face_outward(points, faces):
    """Tell from which directions each face is seen counter-clockwise or clockwise beyond rounding.

    Parameters
    ----------
    points : (n, 3) float64
        Of `exact_signs.scale_points`.
    faces : (m, 3) int32

    Returns
    -------
    seen : (m,) uint32
        Bit 2 d is set if it is counter-clockwise from `DIRECTIONS` d, bit 2 d + 1 if clockwise.
    facing : (m,) int8
        1, 2 or 3 for the axis along which it is largest, negative if it is
        clockwise from there; 0 if no axis tells.
    """
    seen, facing = np.zeros(len(faces), np.uint32), np.zeros(len(faces), np.int8)
    normal = np.empty(3)
    for f in range(len(faces)):
        i, j, k = faces[f]
        terms = UNDERFLOW
        for axis in range(3):
            y, z = (axis + 1) % 3, (axis + 2) % 3
            one = (points[j, y] - points[i, y]) * (points[k, z] - points[i, z])
            two = (points[j, z] - points[i, z]) * (points[k, y] - points[i, y])
            normal[axis] = one - two
            terms += NORMAL_BOUND * (abs(one) + abs(two))
        bits = np.uint32(0)
        for d in range(len(DIRECTIONS)):
            rise = DIRECTIONS[d, 0] * normal[0] + DIRECTIONS[d, 1] * normal[1] + DIRECTIONS[d, 2] * normal[2]
            bits |= np.uint32(rise > terms) << np.uint32(2 * d) | np.uint32(rise < -terms) << np.uint32(2 * d + 1)
        seen[f] = bits
        x, y, z = abs(normal[0]), abs(normal[1]), abs(normal[2])
        axis = 0 if x >= y and x >= z else (1 if y >= z else 2)
        if abs(normal[axis]) > terms:
            facing[f] = axis + 1 if normal[axis] > 0 else -axis - 1
    return seen, facing


@njit
def find_embedded(points, faces, seen):
    """Find vertices whose faces surely meet in nothing but their common vertices and mesh edges.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
        The faces of each vertex are one fan.
    seen : (m,) uint32
        Of `face_outward`.

    Returns
    -------
    (n,) bool
        False also where no direction tells.
    """
    common = np.full(len(points), np.uint32(0xFFFFFFFF))
    for f in range(len(faces)):
        for v in faces[f]:
            common[v] &= seen[f]
    direction, turns = np.full(len(points), np.int8(-1)), np.zeros(len(points), np.int32)
    for v in range(len(points)):
        for d in range(len(DIRECTIONS)):
            if common[v] >> np.uint32(2 * d) & np.uint32(3):
                direction[v] = d
                break
    for f in range(len(faces)):
        for k in range(3):
            v, p, q = faces[f, k], faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
            if direction[v] >= 0:
                one, two = _compare(points, direction[v], v, p), _compare(points, direction[v], v, q)
                turns[v] += one != two if one != 0 and two != 0 else 4
    return turns == 2


@njit(inline="always")
def _compare(points, d, v, w):
    """On which side of v the vertex w is, +1 or -1; 0 if rounding leaves it open.

    A rounded difference of two coordinates is never on the wrong side of another.
    """
    for vectors in (FIRST, SECOND):
        a, b, c = vectors[d, 0], vectors[d, 1], vectors[d, 2]
        here = a * points[v, 0] + b * points[v, 1] + c * points[v, 2]
        there = a * points[w, 0] + b * points[w, 1] + c * points[w, 2]
        if here != there:
            return 1 if there > here else -1
        if abs(a) + abs(b) + abs(c) > 1:
            return 0
    return 0
