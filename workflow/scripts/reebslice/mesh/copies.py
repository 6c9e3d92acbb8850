"""Faces that have their corners in common with another face, and what they mean.

Faces are compared by the positions of their corners. Two with the same corners
and the same winding state one thing twice: one of them is a copy. Two with
opposite windings are two sheets that touch, back to back: the walls of two
bodies, or of a body and what fills a void in it. Only if no material is on one
side of both, as in a file in which every face is written from both sides, the
one that faces inward is the back of the other and states nothing of its own.
"""

import numpy as np

from ..arrays.components import connected_items
from . import half_edges


def find_runs(faces):
    """Number the faces by their three corners.

    Parameters
    ----------
    faces : (m, 3) int32
        In canonical order, see `orders.order_corners`: faces with the same
        corners are neighbours.

    Returns
    -------
    (m,) int64
        From 0 on; equal where faces have the same three corners.
    """
    ordered = np.sort(faces, axis=1)
    return np.cumsum(np.r_[False, np.any(ordered[1:] != ordered[:-1], axis=1)][: len(faces)])


def drop_repeats(faces):
    """Keep one of the faces with the same corners and the same winding.

    Parameters
    ----------
    faces : (m, 3) int32
        In canonical order.

    Returns
    -------
    kept, dropped : (m', 3), (m - m', 3) int32
    """
    repeats = np.zeros(len(faces), bool)
    repeats[1:] = np.all(faces[1:] == faces[:-1], axis=1)
    return faces[~repeats], faces[repeats]


def drop_opposites(faces, chosen=None):
    """Keep one of the faces with the same corners, whatever its winding.

    Parameters
    ----------
    faces : (m, 3) int32
        In canonical order.
    chosen : (m,) bool, optional
        The faces that may be dropped; all of them if not given.

    Returns
    -------
    kept, dropped : (m', 3), (m - m', 3) int32
    """
    repeats = np.diff(find_runs(faces), prepend=-1) == 0
    if chosen is not None:
        repeats &= chosen
    return faces[~repeats], faces[repeats]


def find_odd_clusters(glued):
    """Tell which faces are joined, over mesh edges, to one with an odd number of faces.

    There, opposite windings cannot be two sheets everywhere.

    Parameters
    ----------
    glued : closing.Gluing
        Not closed.

    Returns
    -------
    (m,) bool
    """
    odd = np.diff(glued.starts) % 2 == 1
    if not odd.any():
        return np.zeros(len(glued.faces), bool)
    cluster = label_clusters(glued)
    marked = np.zeros(cluster.max() + 1, bool)
    marked[cluster[glued.order[glued.starts[:-1][odd]] // 3]] = True
    return marked[cluster]


def label_clusters(glued):
    """Number the connected components of the faces over all their mesh edges, however many faces share one.

    Parameters
    ----------
    glued : closing.Gluing
        Not closed.

    Returns
    -------
    (m,) int64
    """
    face = glued.order // 3
    inner = np.ones(len(face), bool)
    inner[glued.starts[1:] - 1] = False  # not from the last face of a mesh edge to the first of the next
    links = np.flatnonzero(inner)
    return connected_items(face[links], face[links + 1], len(glued.faces))


def drop_flaps(faces, n_vertices):
    """Drop flaps: pairs of coinciding faces that have a mesh edge to themselves, and so enclose nothing.

    Where a flap goes, its neighbour may become one.

    Parameters
    ----------
    faces : (m, 3) int32
        In canonical order.
    n_vertices : int

    Returns
    -------
    (m', 3) int32
    """
    while True:
        order, starts = half_edges.group_half_edges(faces, n_vertices)
        pair = np.flatnonzero(np.diff(find_runs(faces)) == 0)
        width = np.empty(len(order), np.int64)
        width[order] = np.repeat(np.diff(starts), np.diff(starts))
        pair = pair[(width.reshape(-1, 3)[pair] == 2).any(axis=1)]
        if not len(pair):
            return faces
        faces = np.delete(faces, np.concatenate([pair, pair + 1]), axis=0)


def find_covered(faces, component, n_components):
    """Tell which closed components coincide, face by face, with other ones.

    Parameters
    ----------
    faces : (m, 3) int32
        In canonical order.
    component : (m,) int
    n_components : int

    Returns
    -------
    covered : (c,) bool
        Every face has its corners in common with one of another component.
    again : (c,) bool
        The same faces, with the same windings, are another component with a lower number.
    mirrored : (c,) bool
        The same faces, with the opposite windings, are another component.
    """
    run = find_runs(faces)
    covered, again, mirrored = np.zeros((3, n_components), bool)
    if not len(run) or run[-1] == len(run) - 1:
        return covered, again, mirrored
    lowest, highest = np.full(run[-1] + 1, n_components), np.full(run[-1] + 1, -1)
    np.minimum.at(lowest, run, component)
    np.maximum.at(highest, run, component)
    bare = np.unique(component[(lowest == highest)[run]])
    covered[:] = True
    covered[bare] = False
    order = np.argsort(component, kind="stable")
    ends = np.searchsorted(component[order], np.arange(n_components + 1))
    first = {}
    for one in np.flatnonzero(covered):
        part = faces[order[ends[one] : ends[one + 1]]]
        again[one] = first.setdefault(part.tobytes(), one) != one
        if (other := first.get(part[:, [0, 2, 1]].tobytes(), one)) != one:  # canonical too: order minds no winding
            mirrored[[one, other]] = True
    return covered, again, mirrored


def find_backs(enclosing, signs, covered):
    """Find the components that are the backs of other ones, and state nothing of their own.

    From the outside inward: a covered component that faces inward is a back
    unless it lies in material, whose void it then is. If all around it is
    covered too, sheets are written from both sides throughout, so that a
    component that faces outward, in material, is the back of a void.

    Parameters
    ----------
    enclosing : list of lists
        The components around each component, see `shells.find_enclosing`.
    signs : (c,) int
        +1 or -1 as the components face outward or inward, 0 if they enclose nothing.
    covered : (c,) bool
        Of `find_covered`.

    Returns
    -------
    (c,) bool
    """
    signs, depth = np.array(signs), np.array([len(around) for around in enclosing])
    back = np.zeros(len(signs), bool)
    for one in np.lexsort((signs, depth)):
        around = [other for other in enclosing[one] if not back[other]]
        material = sum(signs[other] for other in around) > 0
        double = all(covered[other] for other in around)
        back[one] = covered[one] and (material and double if signs[one] > 0 else signs[one] < 0 and not material)
        if signs[one] < 0 and not material:
            signs[one] = 1  # it will be turned over
    return back
