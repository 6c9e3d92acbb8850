"""Cyclic sequences of mesh edges in splay trees: the contours of a level that moves.

Each sequence is a tree, in-order from its first member to its last; where it is
a contour, the first follows the last. What a tree is called stands at its root,
and goes with the root as the tree is turned.

References
----------
D. D. Sleator and R. E. Tarjan, Self-adjusting binary search trees, Journal of
the ACM 32 (1985), doi:10.1145/3828.3835
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit


class Rings(NamedTuple):
    """Trees over E members: parent, left and right child (E,), -1 for none, and at each root the label of its tree."""

    parent: np.ndarray
    left: np.ndarray
    right: np.ndarray
    label: np.ndarray


def no_rings(count):
    """Make :class:`Rings` of `count` members that are in none."""
    return Rings(*(np.full(count, -1, np.int32) for _ in range(4)))


@njit
def _turn(rings, x):
    """Turn a member above its parent."""
    parent, left, right = rings.parent, rings.left, rings.right
    y = parent[x]
    z = parent[y]
    if left[y] == x:
        child = right[x]
        left[y], right[x] = child, y
    else:
        child = left[x]
        right[y], left[x] = child, y
    if child >= 0:
        parent[child] = y
    parent[y], parent[x] = x, z
    if z >= 0:
        if left[z] == y:
            left[z] = x
        else:
            right[z] = x


@njit(inner=True)
def raise_member(rings, x):
    """Make a member the root of its tree."""
    parent, left, label = rings.parent, rings.left, rings.label
    while parent[x] >= 0:
        y = parent[x]
        z = parent[y]
        if z < 0:
            label[x] = label[y]
        else:
            if parent[z] < 0:
                label[x] = label[z]
            _turn(rings, y if (left[y] == x) == (left[z] == y) else x)
        _turn(rings, x)


@njit(inner=True)
def label_of(rings, x):
    """Tell the label of the tree of a member, which becomes its root."""
    raise_member(rings, x)
    return rings.label[x]


@njit(inner=True)
def _raise_last(rings, x):
    """Make the last member of the tree below root x its root; return it."""
    while rings.right[x] >= 0:
        x = rings.right[x]
    raise_member(rings, x)
    return x


@njit(inner=True)
def begin_ring(rings, x):
    """Make a member a sequence of its own."""
    rings.parent[x] = rings.left[x] = rings.right[x] = rings.label[x] = -1


@njit(inner=True)
def insert_after(rings, place, x):
    """Put a new member right after another."""
    parent, left, right = rings.parent, rings.left, rings.right
    raise_member(rings, place)
    after = right[place]
    parent[x], left[x], right[x], rings.label[x] = -1, place, after, rings.label[place]
    parent[place], right[place] = x, -1
    if after >= 0:
        parent[after] = x


@njit
def replace(rings, old, new):
    """Put a new member in the place of another."""
    parent, left, right = rings.parent, rings.left, rings.right
    above, one, two = parent[old], left[old], right[old]
    parent[new], left[new], right[new], rings.label[new] = above, one, two, rings.label[old]
    if one >= 0:
        parent[one] = new
    if two >= 0:
        parent[two] = new
    if above >= 0:
        if left[above] == old:
            left[above] = new
        else:
            right[above] = new


@njit
def remove(rings, x):
    """Take a member out."""
    parent, left, right, label = rings.parent, rings.left, rings.right, rings.label
    raise_member(rings, x)
    one, two = left[x], right[x]
    if one >= 0:
        parent[one] = -1
    if two >= 0:
        parent[two] = -1
    if one >= 0 and two >= 0:
        one = _raise_last(rings, one)
        right[one], parent[two] = two, one
    root = one if one >= 0 else two
    if root >= 0:
        label[root] = label[x]


@njit(inner=True)
def cut_after(rings, x, closed):
    """Open a contour right after a member, or, where it is open already, cut it in two there."""
    parent, right = rings.parent, rings.right
    raise_member(rings, x)
    after = right[x]
    if after >= 0:
        right[x], parent[after] = -1, -1
        if closed:
            last = _raise_last(rings, after)
            rings.label[last] = rings.label[x]
            right[last], parent[x] = x, last


@njit
def join(rings, one, two):
    """Append the sequence of a member to that of another, unless they are the same, which closes it."""
    raise_member(rings, one)
    raise_member(rings, two)
    if rings.parent[one] >= 0 or one == two:
        return
    last = _raise_last(rings, one)
    rings.right[last], rings.parent[two] = two, last
