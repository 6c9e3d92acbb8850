"""A tree of boxes over triangles, and the walk over it that meets every pair of triangles whose boxes meet.

The tree is complete and binary: node i has the children 2 i and 2 i + 1, the
root is 1, and the last half of the nodes are leaves of `LEAF` triangles each,
in the order of a Morton curve (Morton 1966) through their middles.
"""

import numpy as np

from ..arrays.sorting import sort_by_counting
from ..kernels import njit

LEAF = 2  # triangles; faster than 1, 4 and 8
BITS = 16  # of each coordinate, in Morton codes
# From coordinates to single precision: what brings them below its largest number, twice what
# rounding takes off at most, and more than that is where numbers are subnormal.
TO_SINGLE, ROUNDING, LEAST = 2.0**-200, 2.0**-23, 1e-37


def order_along_curve(points, faces):
    """Sort faces along a Morton curve, so that those near one another in space are so in the order.

    Parameters
    ----------
    points : (n, 3) float64
        Finite.
    faces : (m, 3) int32

    Returns
    -------
    (m,) int32
    """
    low, high = points.min(axis=0), points.max(axis=0)
    span = max(float((high - low).max()), np.finfo(float).tiny)
    digits = _find_codes(points, faces, low, (2**BITS - 1) / span)
    order = np.arange(len(faces), dtype=np.int32)
    for digit in digits:
        order = sort_by_counting(digit, order, 2**BITS)[0]
    return order


@njit
def _find_codes(points, faces, low, scale):
    """Morton codes of the faces' middles in digits of 16 bits, the least significant first: (3, m) uint16."""
    digits = np.empty((3, len(faces)), np.uint16)
    cell = np.empty(3, np.uint64)
    for f in range(len(faces)):
        i, j, k = faces[f]
        for axis in range(3):
            middle = (points[i, axis] / 3 + points[j, axis] / 3 + points[k, axis] / 3 - low[axis]) * scale
            cell[axis] = _spread(np.uint64(max(0.0, min(middle, 65535.0))))
        code = cell[0] | cell[1] << np.uint64(1) | cell[2] << np.uint64(2)
        for place in range(3):
            digits[place, f] = np.uint16(code >> np.uint64(16 * place) & np.uint64(0xFFFF))
    return digits


@njit(inline="always")
def _spread(x):
    """The lowest 16 bits of x, two zeros before each."""
    x = (x | x << np.uint64(16)) & np.uint64(0x0000FF0000FF)
    x = (x | x << np.uint64(8)) & np.uint64(0x00F00F00F00F)
    x = (x | x << np.uint64(4)) & np.uint64(0x0C30C30C30C3)
    return (x | x << np.uint64(2)) & np.uint64(0x249249249249)


@njit
def build_tree(points, faces, low):
    """Build the tree of boxes over triangles.

    Boxes are in single precision, rounded outward and measured from `low`, so
    that far from the origin they are no larger than near it.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
        Coordinates below 2^300, as those of `exact_signs.scale_points` are; faces in the order of `order_along_curve`.
    low : (3,) float64
        The lowest coordinates.

    Returns
    -------
    spans : (m, 6) float32
        Lower and upper ends of the box of each triangle, in that order.
    boxes : (2 p, 6) float32
        The same of the boxes of all nodes; p, a power of two, is the first leaf.
        Empty leaves have boxes that meet none.
    """
    first, m = 1, len(faces)
    while first * LEAF < m:
        first *= 2
    spans, boxes = np.empty((m, 6), np.float32), np.empty((2 * first, 6), np.float32)
    boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
    for place in range(m):
        i, j, k = faces[place]
        leaf = first + place // LEAF
        for axis in range(3):
            x, y, z = points[i, axis], points[j, axis], points[k, axis]
            one, other = (min(x, y, z) - low[axis]) * TO_SINGLE, (max(x, y, z) - low[axis]) * TO_SINGLE
            spans[place, axis] = one - ROUNDING * one - LEAST
            spans[place, 3 + axis] = other + ROUNDING * other + LEAST
            boxes[leaf, axis] = min(boxes[leaf, axis], spans[place, axis])
            boxes[leaf, 3 + axis] = max(boxes[leaf, 3 + axis], spans[place, 3 + axis])
    for node in range(first - 1, 0, -1):
        for axis in range(3):
            boxes[node, axis] = min(boxes[2 * node, axis], boxes[2 * node + 1, axis])
            boxes[node, 3 + axis] = max(boxes[2 * node, 3 + axis], boxes[2 * node + 1, 3 + axis])
    return spans, boxes


@njit(inline="always")
def boxes_meet(one, i, other, j):
    """Whether two closed boxes meet: row i of `one` and row j of `other`."""
    return (  # all six at once: the processor would mispredict most branches
        (one[i, 0] <= other[j, 3])
        & (other[j, 0] <= one[i, 3])
        & (one[i, 1] <= other[j, 4])
        & (other[j, 1] <= one[i, 4])
        & (one[i, 2] <= other[j, 5])
        & (other[j, 2] <= one[i, 5])
    )
