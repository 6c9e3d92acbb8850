"""Levels between the copies of one multiple saddle.

A saddle whose link changes sign 2 m times (m > 2) stands for m - 1 simple
ones, and a level may run between two of them. The mesh itself does not say
how the saddle comes apart: any wedge of its link may be split off first, and
each choice is the same surface under another infinitesimal deformation. So
the certifier accepts whatever unfolding the contours of the table show, if
there is one: it reads off the table which strands around the saddle belong to
one contour, looks for wedges that join them so, splits the saddle likewise in
a copy of the mesh and then recounts everything on that copy.
"""

from itertools import combinations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .recount import _sort_corners, copies, cross, oriented_faces

TRIES = 500


def find_folded(surface, below):
    """Which levels run between the copies of a vertex: {vertex: [(level, copies below)]}."""
    total = np.cumsum(copies(surface))
    vertex = np.searchsorted(total, below, side="right")
    rest = below - np.concatenate([[0], total])[vertex]
    folded = {}
    for level in np.flatnonzero(rest > 0).tolist():
        folded.setdefault(int(vertex[level]), []).append((level, int(rest[level])))
    return folded


def plain_below(surface, below):
    """Vertices of this surface below each level, which counts copies: (K,).

    A vertex counts as above if only some of its copies are below.
    """
    return np.searchsorted(np.cumsum(copies(surface)), below, side="right")


def unfold(surface, sides, below, rings_at):
    """Split every vertex between whose copies a level runs.

    rings_at : function of a level, its contours as (points (k, 2), ring (k,)).
    Returns the new :class:`Ranked` surface, the levels' counts of its vertices
    below, and the vertices for which no unfolding fits the table.
    """
    folded = find_folded(surface, below)
    if not folded:
        return surface, plain_below(surface, below), []
    faces, shell = oriented_faces(surface).tolist(), surface.shell.tolist()
    origin, turn, odd = list(range(len(surface.points))), [0] * len(surface.points), []
    stars = {vertex: _star(surface, vertex) for vertex in folded}
    for vertex, cuts in sorted(folded.items()):
        link = _cycle([_rotated(faces[f], vertex) for f in stars[vertex]])
        old_link = [origin[w] for w in link]  # neighbours may have come apart before
        wedges = _upper_wedges(old_link, vertex)
        order = _fit(surface, sides, vertex, old_link, wedges, cuts, rings_at)
        if order is None:
            odd.append(vertex)
            order = list(range(len(wedges)))
        n_faces = len(faces)
        _split(faces, shell, origin, turn, vertex, stars[vertex], link, [wedges[w] for w in order[: len(wedges) - 2]])
        for new in range(n_faces, len(faces)):
            for corner in set(faces[new]) & set(stars):
                stars[corner].append(new)
    place = np.lexsort((turn, origin))
    rank = np.empty(len(place), np.int64)
    rank[place] = np.arange(len(place))
    old = np.array(origin)[place]
    split = _sort_corners(surface.points[old], surface.origin[old], rank[np.array(faces)], np.array(shell))
    return split, _below_of_split(surface, below, old, folded), odd


def _below_of_split(surface, below, old, folded):
    """Vertices of the split surface below each level."""
    weight = np.where(np.isin(np.arange(len(surface.points)), list(folded)), 1, copies(surface))
    return np.searchsorted(np.cumsum(weight[old]), below, side="right")


def _star(surface, vertex):
    return np.flatnonzero((surface.corners == vertex).any(axis=1)).tolist()


def _rotated(face, vertex):
    k = face.index(vertex)
    return face[(k + 1) % 3], face[(k + 2) % 3]


def _cycle(pairs):
    after = dict(pairs)
    cycle = [pairs[0][0]]
    while after[cycle[-1]] != cycle[0]:
        cycle.append(after[cycle[-1]])
    return cycle


def _upper_wedges(link, vertex):
    """Places (first, last) of each run of upper neighbours in the link cycle."""
    k, wedges = len(link), []
    for i in range(k):
        if link[i] > vertex and link[i - 1] < vertex:
            j = i
            while link[(j + 1) % k] > vertex:
                j += 1
            wedges.append((i, j % k))
    return wedges


def _fit(surface, sides, vertex, link, wedges, cuts, rings_at):
    """The order in which to split off wedges so that all cuts look as in the table."""
    chosen = []
    for level, n_below in sorted(cuts, key=lambda cut: cut[1]):
        wanted = _strands(surface, sides, vertex, link, wedges, rings_at(level))
        rest = [w for w in range(len(wedges)) if w not in chosen]
        for tried, extra in enumerate(combinations(rest, n_below - len(chosen))):
            if tried > TRIES:
                return None
            if wanted is not None and _joined_as(wanted, _matching(len(wedges), chosen + list(extra))):
                chosen += extra
                break
        else:
            return None
    return chosen + [w for w in range(len(wedges)) if w not in chosen]


def _matching(n_wedges, split_off):
    """Which zero directions meet in a strand through the vertex: pairs.

    Directions 2 w and 2 w + 1 bound wedge w. A wedge that was split off lies
    below the level, so its own two directions meet; the others meet across
    what is left of the lower wedges.
    """
    rest = [w for w in range(n_wedges) if w not in split_off]
    return [(2 * w, 2 * w + 1) for w in split_off] + [
        (2 * w + 1, 2 * rest[(i + 1) % len(rest)]) for i, w in enumerate(rest)
    ]


def _joined_as(wanted, matching):
    """Whether strands outside the vertex and a matching inside give the wanted contours."""
    partner, ring = wanted
    links = np.array(list(partner.items()) + matching)
    n = len(ring)
    _, part = connected_components(coo_array((np.ones(len(links)), links.T), shape=(n, n)), directed=False)
    return len(set(zip(part.tolist(), ring))) == len(set(part.tolist())) == len(set(ring))


def _strands(surface, sides, vertex, link, wedges, rings):
    """Follow the level set away from the vertex: (partner of each direction, its ring)."""
    points, ring = rings
    if len(points) == 0:
        return None
    # The level runs through the vertex: what does not touch it decides by rank.
    low, high = sides.lower < vertex, sides.upper > vertex
    crossed = np.flatnonzero(low & high)
    a, b, c = surface.corners.T
    face = np.flatnonzero((a < vertex) & (c > vertex) & (b != vertex))
    number = np.full(len(sides.lower), -1)
    number[crossed] = np.arange(len(crossed))
    long = number[sides.of_face[face, 2]]
    short = number[np.where(b[face] > vertex, sides.of_face[face, 0], sides.of_face[face, 1])]
    _, part = connected_components(
        coo_array((np.ones(len(face)), (long, short)), shape=(len(crossed),) * 2), directed=False
    )
    keys = sides.lower[crossed] * len(surface.points) + sides.upper[crossed]
    by_part, found, size = {}, [], len(link)
    for first, last in wedges:
        for p, q in ((link[first - 1], link[first]), (link[(last + 1) % size], link[last])):
            place = int(np.searchsorted(keys, min(p, q) * len(surface.points) + max(p, q)))
            by_part.setdefault(int(part[place]), []).append(len(found))
            found.append(place)
    if any(len(pair) != 2 for pair in by_part.values()):
        return None
    z, x, y = surface.points[vertex, 2], *surface.points[vertex, :2]
    spots = cross(surface, sides.lower[crossed], sides.upper[crossed], z, x, y)
    ring_of = {}
    for strand, pair in by_part.items():
        spot = spots[np.flatnonzero(part == strand)]
        spot = spot[np.argmax(np.hypot(*(spot - (x, y)).T))]
        near = int(ring[np.argmin(np.hypot(*(points - spot).T))])
        ring_of |= {direction: near for direction in pair}
    return {pair[0]: pair[1] for pair in by_part.values()}, [ring_of[d] for d in range(2 * len(wedges))]


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
