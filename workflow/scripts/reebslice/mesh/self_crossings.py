"""Faces of a surface that cross: all pairs, found exactly.

The pairs whose boxes meet are thinned out in floating point, and what is left
is judged by the exact signs of determinants, see `face_pairs`.
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from . import face_pairs
from .exact_signs import ROOM, scale_points
from .half_edges import find_twins
from .meeting_faces import plant_tree, thin_out, walk_on

MOST = 1_000_000  # pairs of faces that are counted
AT_ONCE = 1 << 16  # pairs of faces that are looked at together: as many as stay in the processor's cache


class Crossings(NamedTuple):
    """Pairs of faces that cross.

    Attributes
    ----------
    pairs : (c, 2) int32
        Faces, the lower number first; in lexicographic order.
    folded : (c,) bool
        Whether they are neighbours that lie on one another, in one plane.
    complete : bool
        Whether they are all; if not, at least `most` were found.
    """

    pairs: np.ndarray
    folded: np.ndarray
    complete: bool


def find_crossings(points, faces, most=MOST):
    """Find the pairs of faces at which a surface crosses itself or lies folded in a plane.

    What counts as crossing, and what as touching, is told in `face_pairs`. The
    answer is exact, whatever the coordinates; but those below 2^-600 of the
    largest one are taken as 0, and faces without area are passed over.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
        Finite.
    faces : (m, 3) int
        Of a closed and oriented surface; the faces of each vertex are one fan,
        and no two mesh edges join the same two vertices.
    most : int, optional
        With so many the search stops.

    Returns
    -------
    Crossings

    References
    ----------
    Guigue and Devillers 2003, doi:10.1080/10867651.2003.10487580; Shewchuk 1997, doi:10.1007/PL00009321.
    """
    points, faces = scale_points(np.asarray(points, np.float64)), np.ascontiguousarray(faces, np.int32)
    if not len(faces):
        return Crossings(np.empty((0, 2), np.int32), np.empty(0, bool), True)
    tree = plant_tree(points, faces)
    stack, height = np.ones((4 * len(tree.boxes).bit_length(), 2), np.int32), 1
    room, twins, found, kinds, total = np.empty((AT_ONCE, 2), np.int32), None, [], [], 0
    while height and total < most:
        height, count = walk_on(tree, stack, height, room)
        pairs = thin_out(tree, room[:count])
        verdicts = _judge(tree.points, tree.faces, pairs)
        along = np.flatnonzero(verdicts == face_pairs.ALONG_SIDE)
        if len(along):
            twins = find_twins(tree.faces, len(tree.points)) if twins is None else twins
            verdicts[along] = _judge_along(tree.points, tree.faces, twins, pairs[along])
        found.append(tree.order[pairs[verdicts > 0]])
        kinds.append(verdicts[verdicts > 0])
        total += len(found[-1])
    pairs, folded = np.concatenate(found), np.concatenate(kinds) == face_pairs.FOLD
    order = np.lexsort(pairs.T[::-1])
    return Crossings(pairs[order], folded[order], not height)


@njit
def _judge(points, faces, pairs):
    """Judge pairs of faces, see `face_pairs.judge_pair`: (c,) int8."""
    verdicts, work = np.empty(len(pairs), np.int8), np.empty(ROOM)
    for k in range(len(pairs)):
        verdicts[k] = face_pairs.judge_pair(points, faces[pairs[k, 0]], faces[pairs[k, 1]], work)
    return verdicts


@njit
def _judge_along(points, faces, twins, pairs):
    """Judge pairs of faces, see `face_pairs.judge_along_side`: (c,) bool."""
    verdicts, work = np.empty(len(pairs), np.bool_), np.empty(ROOM)
    for k in range(len(pairs)):
        verdicts[k] = face_pairs.judge_along_side(points, faces, twins, (pairs[k, 0], pairs[k, 1]), work)
    return verdicts
