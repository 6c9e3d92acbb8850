"""Levels between the copies of one multiple saddle.

A saddle whose link changes sign 2 m times (m > 2) stands for m - 1 simple
ones, and a level may run between two of them. The mesh itself does not say
how the saddle comes apart: any wedge of its link may be split off first, and
each choice is the same surface under another infinitesimal deformation. The
table `unfoldings` says which wedges were: a witness. It is valid if each is a wedge of the
link of its own, and if at every such level the strands that meet at the
vertex do not cross there, so that the surface does not cross itself. Then the
saddle is split likewise in a copy of the mesh, and everything is recounted on
that copy.
"""

from typing import NamedTuple

import numpy as np

from .links import find_arms, find_upper_wedges, follow, order_level_directions, smallest_tilt
from .ranges import expand_ranges
from .surface import copies, oriented_faces, sort_corners


class Witness(NamedTuple):
    """Of each copy that was split off, in order: ranks of its vertex and of the first and last one of its wedge."""

    vertex: np.ndarray
    first: np.ndarray
    last: np.ndarray


def find_folded(surface, below):
    """Find the levels that run between the copies of a vertex.

    Parameters
    ----------
    surface : Ranked
    below : (K,) int
        Vertices below each level, copies counted.

    Returns
    -------
    dict
        {vertex: sorted list of how many of its copies are below such levels}.
    """
    vertex = _plain_below(surface, below)
    rest = below - surface.weight[vertex]
    folded = {}
    for level in np.flatnonzero(rest > 0).tolist():
        folded.setdefault(int(vertex[level]), set()).add(int(rest[level]))
    return {vertex: sorted(cuts) for vertex, cuts in sorted(folded.items())}


def list_copies(surface, folded):
    """List all copies but the highest one of each folded vertex.

    Parameters
    ----------
    surface : Ranked
    folded : dict
        Of :func:`find_folded`.

    Returns
    -------
    vertex, rank : (k,) int
        The vertex of each copy, and its rank, copies counted.
    """
    vertex = np.array(list(folded), np.int64)
    owner, rank = expand_ranges(surface.weight[vertex], surface.weight[vertex + 1] - 1)
    return vertex[owner], rank


def _plain_below(surface, below):
    """Vertices of this surface below each level, (K,); one counts as above if only some of its copies are below."""
    return np.searchsorted(surface.weight[1:], below.astype(np.int32), side="right")


def unfold(surface, below, folded, witness):
    """Split every vertex between whose copies a level runs, as the witness says.

    Parameters
    ----------
    surface, below, folded
        As for :func:`find_folded`, and what it tells.
    witness : Witness
        One row per copy of :func:`list_copies`.

    Returns
    -------
    split : Ranked
        The new surface; `surface` itself if nothing is folded.
    below : (K,) int
        Its vertices below each level.
    odd : list of int
        The vertices whose rows are no wedges of their links, or would make the
        surface cross itself. They are split some other way.
    """
    if not folded:
        return surface, _plain_below(surface, below), []
    faces, shell = oriented_faces(surface).tolist(), surface.shell.tolist()
    origin, turn, odd = list(range(len(surface.points))), [0] * len(surface.points), []
    stars = {vertex: np.flatnonzero((surface.corners == vertex).any(axis=1)).tolist() for vertex in folded}
    tilt = smallest_tilt(surface.points)
    for vertex, cuts in folded.items():
        link = follow(dict(_rotated(faces[f], vertex) for f in stars[vertex]))
        old_link = [origin[w] for w in link]  # neighbours may have come apart before
        arms = find_arms(surface.points, tilt, vertex, old_link)
        wedges, rows = find_upper_wedges(arms), np.flatnonzero(witness.vertex == vertex)
        order = _find_wedges(old_link, wedges, witness.first[rows].tolist(), witness.last[rows].tolist())
        turns = order_level_directions(arms, wedges)
        if order is None or any(_crosses(_matching(len(wedges), order[:n_below]), turns) for n_below in cuts):
            odd.append(vertex)
            order = range(len(wedges) - 2)
        n_faces = len(faces)
        _split(faces, shell, origin, turn, vertex, stars[vertex], link, [wedges[w] for w in order])
        for new in range(n_faces, len(faces)):
            for corner in set(faces[new]) & set(stars):
                stars[corner].append(new)
    place = np.lexsort((turn, origin))
    rank = np.empty(len(place), np.int32)
    rank[place] = np.arange(len(place))
    old = np.array(origin)[place]
    split = sort_corners(surface.points[old], surface.origin[old], rank, np.array(faces).T, np.array(shell))
    return split, _below_of_split(surface, below, old, folded), odd


def _find_wedges(link, wedges, first, last):
    """The number of the wedge of each copy, or None unless all are there and no wedge is taken twice."""
    number = {(link[i], link[j]): w for w, (i, j) in enumerate(wedges)}
    order = [number.get(ends) for ends in zip(first, last)]
    whole = None not in order and len(set(order)) == len(order) == len(wedges) - 2
    return order if whole else None


def _below_of_split(surface, below, old, folded):
    """Vertices of the split surface below each level."""
    weight = np.where(np.isin(np.arange(len(surface.points)), list(folded)), 1, copies(surface))
    return np.searchsorted(np.cumsum(weight[old]), below, side="right")


def _rotated(face, vertex):
    """The two corners after a vertex in a face."""
    k = face.index(vertex)
    return face[(k + 1) % 3], face[(k + 2) % 3]


def _matching(n_wedges, split_off):
    """Which zero directions meet in a strand through the vertex: pairs.

    Directions 2 w and 2 w + 1 bound wedge w. A wedge that was split off lies
    below the level, so its own two directions meet; the others meet across
    what is left of the lower wedges.
    """
    rest = [w for w in range(n_wedges) if w not in split_off]
    across = [(2 * w + 1, 2 * following) for w, following in zip(rest, rest[1:] + rest[:1])]
    return [(2 * w, 2 * w + 1) for w in split_off] + across


def _crosses(matching, turns):
    """Whether two of the strands through the vertex cross there: then the surface would; to touch is not to cross."""
    chords = [sorted((turns[i], turns[j])) for i, j in matching]
    return any(a < c < b < d for a, b in chords for c, d in chords)


def _split(faces, shell, origin, turn, vertex, star, link, wedges):
    """Give the fan over each wedge in turn to a new copy just below what remains."""
    at = {_rotated(faces[f], vertex)[0]: f for f in star}
    cycle = list(link)
    for number, (first, last) in enumerate(wedges):
        new = len(origin)
        origin.append(vertex)
        turn.append(number - len(wedges))  # all copies below the vertex itself, in this order
        start, stop = cycle.index(link[first]), cycle.index(link[last])
        cycle = cycle[start:] + cycle[:start]
        span = (stop - start) % len(cycle)
        before, after = cycle[-1], cycle[span + 1]
        for name in [before] + cycle[: span + 1]:
            p, q = _rotated(faces[at[name]], vertex)
            faces[at.pop(name)] = [new, p, q]
        for face in ([new, after, vertex], [new, vertex, before]):
            faces.append(face)
            shell.append(shell[star[0]])
        # in the link of what remains, the copy stands where the wedge was
        at[before], at[new] = len(faces) - 1, len(faces) - 2
        cycle = [before, new] + cycle[span + 1 : -1]
