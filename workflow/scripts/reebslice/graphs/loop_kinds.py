"""Handle or tunnel: on which side of the surface a contour bounds.

A contour c is the rim of a disc D in its plane, which the contours strictly
inside c part into regions of material and of void. The rim of all that is
material in D bounds in the material, and that of all that is void bounds in the
void. Let M be the sum of the contours strictly inside c, all with material on
their left. Each of them is the rim of one region of either sort. So, up to
signs, an outer contour c is the rim c + M of the material in D less the rim M
of the void: it bounds in the material if M is zero in the homology of the
surface, and in the void if c + M is. Of an inner contour it is the other way
round.

*And only if.* The first homology of a closed surface in space is the direct sum
of those of its two sides (the sequence of Mayer and Vietoris, as space has none
itself). So what bounds in the material and what bounds in the void have only
zero in common, and c comes apart in one way only into the one and the other.

*Zero.* A contour is a point of an arc of the surface's Reeb graph. A sum of
contours is zero in the homology of the surface if and only if every cycle of
the graph passes as many of them upward as downward, that is, if the nodes can
be given whole numbers that rise by one along an arc at each of these contours,
and nowhere else.

References
----------
T. K. Dey, F. Fan and Y. Wang, An efficient computation of handle and tunnel
loops via Reeb graphs, ACM Transactions on Graphics 32 (2013),
doi:10.1145/2461912.2462017
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit

KINDS = ("handle", "tunnel", "mixed")


class Nesting(NamedTuple):
    """C contours, and what is inside what.

    Attributes
    ----------
    level : (C,) int32
        Ascending.
    arc : (C,) int64
        The arc of the surface's Reeb graph that each is a point of.
    parent : (C,) int32
        The smallest contour around each one, of the same body, -1 for none.
    inner : (C,) bool
        Whether each bounds a hole.
    area, perimeter : (C,) float64
        Area without its sign, and length.
    """

    level: np.ndarray
    arc: np.ndarray
    parent: np.ndarray
    inner: np.ndarray
    area: np.ndarray
    perimeter: np.ndarray


def count_inside(nesting, counted):
    """Count the contours inside each one.

    Parameters
    ----------
    nesting : Nesting
        Of C contours.
    counted : (C,) bool
        Which of them count.

    Returns
    -------
    (C,) int64
    """
    return _count_inside(nesting.parent, counted)


@njit
def _count_inside(parent, counted):
    """Kernel of `count_inside`."""
    inside = np.zeros(len(parent), np.int64)
    for c in range(len(parent)):
        around = parent[c] if counted[c] else -1
        while around >= 0:
            inside[around] += 1
            around = parent[around]
    return inside


def find_kinds(core, nesting, chosen):
    """Tell on which side contours bound.

    Parameters
    ----------
    core : Core
        Of the surface's Reeb graph.
    nesting : Nesting
        All contours of some levels.
    chosen : (K,) int
        Contours on arcs of the core.

    Returns
    -------
    kind : (K,) int64
        Places in `KINDS`. handle: bounds in the material; tunnel: in the void; mixed: in neither. That is
        exact if no shell crosses itself or another one of its body. It is the same for all contours of an
        arc, and of a chain. A contour that cuts no loop, as of an arc between two loops, bounds in both
        and counts as the one or the other.
    own : (K,) bool
        Whether it bounds on the side that is immediately inside it.
    """
    inside = count_inside(nesting, core.chain[nesting.arc] >= 0)
    own, other = np.ones(len(chosen), bool), np.zeros(len(chosen), bool)
    doubtful = np.flatnonzero(inside[chosen] > 0)
    order, up = _span(core.arcs, core.incident)
    tested = _test(core.arcs, core.kept, (order, up), nesting, np.asarray(chosen, np.int64)[doubtful])
    own[doubtful], other[doubtful] = tested[0], tested[1]
    material = np.where(nesting.inner[chosen], other, own)
    return np.where(~own & ~other, 2, np.where(material, 0, 1)), own


@njit
def _span(arcs, incident):
    """Nodes, those of a spanning forest before what hangs on them, and the arc to the node before, -1 for none."""
    start, member, n = incident.start, incident.member, len(incident.start) - 1
    order, up, seen, count = np.empty(n, np.int64), np.full(n, -1, np.int64), np.zeros(n, np.bool_), 0
    for first in range(n):
        if seen[first] or start[first] == start[first + 1]:
            continue
        seen[first], order[count], taken = True, first, count
        count += 1
        while taken < count:
            here = order[taken]
            taken += 1
            for arc in member[start[here] : start[here + 1]]:
                other = arcs[arc, 0] + arcs[arc, 1] - here
                if not seen[other]:
                    seen[other], up[other], order[count] = True, arc, other
                    count += 1
    return order[:count], up


@njit
def _test(arcs, kept, forest, nesting, chosen):
    """Of each contour, whether those strictly inside it sum to zero, and whether they do with it: (2, K) bool."""
    level, parent, arc_of = nesting.level, nesting.parent, nesting.arc
    steps, height = np.zeros(len(arcs), np.int64), np.zeros(len(forest[1]), np.int64)
    zero = np.zeros((2, len(chosen)), np.bool_)
    for k in range(len(chosen)):
        c = chosen[k]
        first, end = np.searchsorted(level, level[c]), np.searchsorted(level, level[c], side="right")
        for d in range(first, end):
            around = parent[d]
            while around >= 0 and around != c:
                around = parent[around]
            if around == c:
                steps[arc_of[d]] += 1
        zero[0, k] = _is_zero(arcs, kept, forest, steps, height)
        steps[arc_of[c]] += 1
        zero[1, k] = _is_zero(arcs, kept, forest, steps, height)
        steps[arc_of[first:end]] = 0
    return zero


@njit(inner=True)
def _is_zero(arcs, kept, forest, steps, height):
    """Whether the nodes have heights, which are filled in, with differences along the arcs of `steps` (A,)."""
    order, up = forest
    for node in order:
        arc = up[node]
        if arc < 0:
            height[node] = 0
        else:
            low, high = arcs[arc]
            height[node] = height[low] + steps[arc] if node == high else height[high] - steps[arc]
    rises = True
    for arc in kept:
        rises &= height[arcs[arc, 1]] - height[arcs[arc, 0]] == steps[arc]
    return rises
