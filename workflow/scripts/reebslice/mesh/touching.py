"""Separate sheets that touch along a mesh edge: which of its faces belong together.

A sheet is a part of the surface that runs on across its mesh edges, from face
to face. Of the faces around a mesh edge, two belong to one sheet if the
material between them is the same: bodies that meet in a mere mesh edge, or in
a face, then come apart, as they would if the material shrank by next to nothing.
"""

import itertools
from fractions import Fraction
from functools import cmp_to_key

import numpy as np

from ..errors import TouchingSheetsError
from . import copies


def pair_around(points, glued, slack):
    """Pair the faces around each mesh edge: those that are walls of the same material.

    Angles are compared exactly, in whole numbers; but two faces coincide if
    their corners lie within `slack` of each other's planes, because rounding
    alone then tells whether they are a gap or an overlap.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
    glued : closing.Gluing
        Every mesh edge has an even number of faces; no two faces have the same
        corners and the same winding.
    slack : float, mesh units

    Returns
    -------
    order : (3 m,) int64
        Half-edges, those that belong together next to each other.
    loose : int
        Mesh edges around which faces coincide within the slack only.

    Raises
    ------
    TouchingSheetsError
        The faces of parts that touch are not wound consistently, or material
        and void do not alternate around a mesh edge.
    """
    _check_winding(glued)
    order, starts, faces = glued.order, glued.starts, glued.faces
    paired, left = _pair_copies(order, starts, faces)
    loose = 0
    for edge in left.tolist():
        here = slice(starts[edge], starts[edge + 1])
        turn, exact = _pair(points, faces, order[here], slack, edge)
        paired[here] = order[here][turn]
        loose += not exact
    return paired, loose


def _check_winding(glued):
    """Raise `TouchingSheetsError` if parts that touch are wound inconsistently: they do not tell where material is."""
    tails, width, begin = glued.faces.ravel()[glued.order], np.diff(glued.starts), glued.starts[:-1]
    wrong = np.flatnonzero((width == 2) & (tails[begin] == tails[np.minimum(begin + 1, len(tails) - 1)]))
    if not len(wrong):
        return
    cluster = copies.label_clusters(glued)
    touched = np.zeros(cluster.max() + 1, bool)
    touched[cluster[glued.order[begin[width > 2]] // 3]] = True
    wrong = wrong[touched[cluster[glued.order[begin[wrong]] // 3]]]
    if len(wrong):
        raise TouchingSheetsError(
            "the winding of the faces is not consistent, so that it does not tell where the material is",
            int(wrong[0]),
            "make the winding of those faces consistent (recalculate the normals)",
        )


def _pair_copies(order, starts, faces):
    """Pair the four faces of each mesh edge at which two sheets touch face to face; returns the other edges too.

    Two faces are there, each in both windings: whatever the angle between
    them, each sheet has one of either, and runs both ways along the mesh edge.
    """
    paired, width, begin = order.copy(), np.diff(starts), starts[:-1]
    crowded = np.flatnonzero(width > 2)
    four = crowded[width[crowded] == 4]
    halves = order[begin[four, None] + np.arange(4)]
    run = copies.find_runs(faces)[halves // 3]
    twice = (run[:, 0] == run[:, 1]) & (run[:, 1] != run[:, 2]) & (run[:, 2] == run[:, 3])
    halves, tails = halves[twice], faces.ravel()[halves[twice]]
    same = tails[:, 0] == tails[:, 2]
    places = np.where(same[:, None], [0, 3, 1, 2], [0, 2, 1, 3])
    paired[begin[four[twice], None] + np.arange(4)] = np.take_along_axis(halves, places, axis=1)
    return paired, np.setdiff1d(crowded, four[twice])


def _pair(points, faces, half_edges, slack, edge):
    """Return the places of the half-edges, those that belong together side by side; and whether exactly."""
    corners = [np.roll(faces[h // 3], -(h % 3)) for h in half_edges.tolist()]
    low, high = sorted(corners[0][:2].tolist())
    ends, unit = _scale(points[[low, high, *(corner[2] for corner in corners)]])
    axis, *spokes = [[x - y for x, y in zip(point, ends[0])] for point in ends[1:]]
    # Seen along the axis, counter-clockwise, a face whose half-edge runs against it is where material begins.
    begins = [int(corner[0]) == high for corner in corners]
    groups = _group_by_angle(axis, spokes, int(Fraction(slack) * unit), edge)
    turn = _alternate(groups, begins)
    kinds = [begins[k] for k in turn]
    if any(one == two for one, two in zip(kinds, kinds[1:] + kinds[:1])):
        raise TouchingSheetsError(
            "parts overlap there, so that its faces do not tell which of them belong together",
            edge,
            "unite those parts, or move them apart",
        )
    exact = not any(_turn(axis, spokes[one], spokes[two]) for group in groups for one, two in itertools.pairwise(group))
    first = kinds.index(True)
    return turn[first:] + turn[:first], exact


def _alternate(groups, begins):
    """Put the places of each group in an order in which material and void alternate, if there is one.

    Two faces in one direction are the walls of two bodies where material is on
    both sides, and of a body without thickness where void is; if all faces are
    such pairs, material is taken to be all around.
    """
    single = next((k for k, group in enumerate(groups) if len(group) == 1), 0)
    turn, before = [], True
    for group in groups[single:] + groups[:single]:
        turn += sorted(group, key=lambda k: begins[k] == before)
        before = begins[turn[-1]]
    return turn


def _scale(points):
    """Return the points, exactly, in whole numbers of one common unit, and that unit's number in 1."""
    ratios = [[float(x).as_integer_ratio() for x in point] for point in points]
    unit = max(below for point in ratios for _, below in point)
    return [[above * (unit // below) for above, below in point] for point in ratios], unit


def _group_by_angle(axis, spokes, reach, edge):
    """Return the places of the spokes, counter-clockwise about the axis, grouped by direction."""
    length = _dot(axis, axis)
    breadth = [length * _dot(spoke, spoke) - _dot(axis, spoke) ** 2 for spoke in spokes]  # squares
    if not all(breadth):
        raise TouchingSheetsError(
            "a face without area has no direction there", edge, "delete that face by merging its corners"
        )
    quarter = [_quarter(axis, length, spokes[0], spoke) for spoke in spokes]

    def compare(one, two):
        return quarter[one] - quarter[two] or -_turn(axis, spokes[one], spokes[two])

    def coincide(one, two):
        off = _turn(axis, spokes[one], spokes[two]) ** 2
        near = off <= reach**2 * min(breadth[one], breadth[two])
        return near and _same_way(axis, length, spokes[one], spokes[two])

    ordered = sorted(range(len(spokes)), key=cmp_to_key(compare))
    groups = [[ordered[0]]]
    for one, two in itertools.pairwise(ordered):
        if not coincide(one, two):
            groups.append([])
        groups[-1].append(two)
    if len(groups) > 1 and coincide(groups[-1][-1], groups[0][0]):
        groups[0] = groups.pop() + groups[0]
    return groups


def _quarter(axis, length, first, spoke):
    """Where a spoke points, from the first: 0 along it, 1 left, 2 against it, 3 right."""
    turn = _turn(axis, first, spoke)
    if turn:
        return 1 if turn > 0 else 3
    return 0 if _same_way(axis, length, first, spoke) else 2


def _same_way(axis, length, one, two):
    """Whether two spokes are less than a right angle apart, seen along the axis."""
    return _dot(one, two) * length > _dot(one, axis) * _dot(two, axis)


def _turn(axis, one, two):
    """Positive if it is a left turn, seen along the axis, from one spoke to the other."""
    return _dot(axis, _cross(one, two))


def _cross(one, two):
    (a, b, c), (d, e, f) = one, two
    return b * f - c * e, c * d - a * f, a * e - b * d


def _dot(one, two):
    return sum(x * y for x, y in zip(one, two))


def lie_in_plane(points):
    """Tell whether points lie in one plane, exactly: no rounding is forgiven.

    Parameters
    ----------
    points : (n, 3) float64
        At least one.

    Returns
    -------
    bool
    """
    first, *others = _scale(points)[0]
    spokes = [[x - y for x, y in zip(point, first)] for point in others]
    axis = next((spoke for spoke in spokes if any(spoke)), (0, 0, 0))
    side = next((spoke for spoke in spokes if any(_cross(axis, spoke))), (0, 0, 0))
    normal = _cross(axis, side)
    return not any(_dot(normal, spoke) for spoke in spokes)
