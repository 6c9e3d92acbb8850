"""Levels between the copies of one multiple saddle.

A saddle whose link changes sign 2 m times (m > 2) stands for m - 1 simple
ones, and a level may run between two of them. The mesh itself does not say
how the saddle comes apart: any wedge of its link may be split off first, and
each choice is the same surface under another infinitesimal deformation. So
the certifier accepts whatever unfolding the contours of the table show, if
there is one under which the surface does not cross itself: it reads off the
table which strands around the saddle belong to one contour, looks for wedges
that join them so, splits the saddle likewise in a copy of the mesh and then
recounts everything on that copy.
"""

from fractions import Fraction
from functools import cmp_to_key
from itertools import combinations
from typing import NamedTuple

import numpy as np
import shapely

from .components import find_components
from .crossings import cross
from .exact_levels import smallest_tilt
from .surface import copies, oriented_faces, sort_corners

TRIES = 500


def find_folded(surface, below):
    """Which levels run between the copies of a vertex: {vertex: [(level, copies below)]}."""
    vertex = plain_below(surface, below)
    rest = below - surface.weight[vertex]
    folded = {}
    for level in np.flatnonzero(rest > 0).tolist():
        folded.setdefault(int(vertex[level]), []).append((level, int(rest[level])))
    return folded


def plain_below(surface, below):
    """Vertices of this surface below each level, which counts copies: (K,).

    A vertex counts as above if only some of its copies are below.
    """
    return np.searchsorted(surface.weight[1:], below.astype(np.int32), side="right")


def unfold(surface, sides, below, rings_at, noise):
    """Split every vertex between whose copies a level runs.

    rings_at : function of a level, its contours as (closed curves (k,), list
        of k anchors), an anchor being the ranks of a mesh edge's ends
    noise : how far a curve may be from its contour
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
        order = _fit(surface, sides, vertex, old_link, wedges, cuts, rings_at, noise)
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
    split = sort_corners(surface.points[old], surface.origin[old], rank, np.array(faces).T, np.array(shell))
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


def _fit(surface, sides, vertex, link, wedges, cuts, rings_at, noise):
    """The order in which to split off wedges so that all cuts look as in the table."""
    chosen = []
    turns, strands = _order_directions(surface, vertex, link, wedges), _strands(surface, sides, vertex, link, wedges)
    for level, n_below in sorted(cuts, key=lambda cut: cut[1]):
        rings = rings_at(level)
        rest = [w for w in range(len(wedges)) if w not in chosen]
        for tried, extra in enumerate(combinations(rest, n_below - len(chosen))):
            if tried > TRIES:
                return None
            matching = _matching(len(wedges), chosen + list(extra))
            if not _crosses(matching, turns) and _joined_as(strands, matching, rings, noise):
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


def _gates(link, wedges):
    """The link's edges, (from, to), over which the zero directions lie, two to a wedge."""
    for first, last in wedges:
        yield link[first - 1], link[first]
        yield link[(last + 1) % len(link)], link[last]


def _order_directions(surface, vertex, link, wedges):
    """Place of each zero direction among all, counter-clockwise, in rational numbers."""
    tilt = smallest_tilt(surface.points)

    def arm(other):
        ends = surface.points[other].tolist(), surface.points[vertex].tolist()
        x, y, z = (Fraction(p) - Fraction(q) for p, q in zip(*ends))
        return x, y, z + tilt * (x + tilt * y)

    directions = []
    for low, high in _gates(link, wedges):
        (px, py, ph), (qx, qy, qh) = arm(low), arm(high)
        directions.append((px * qh - qx * ph, py * qh - qy * ph))  # times qh - ph > 0

    def compare(p, q):
        halves = [y < 0 or (y == 0 and x < 0) for x, y in (p, q)]
        return halves[0] - halves[1] if halves[0] != halves[1] else p[1] * q[0] - p[0] * q[1]

    around = sorted(range(len(directions)), key=cmp_to_key(lambda i, j: compare(directions[i], directions[j])))
    return np.argsort(around)


def _crosses(matching, turns):
    """Whether two of the strands through the vertex cross there: then the surface would."""
    chords = [sorted((turns[i], turns[j])) for i, j in matching]
    return any(a < c < b < d for a, b in chords for c, d in chords)


def _joined_as(strands, matching, rings, noise):
    """Whether strands outside the vertex and a matching inside give contours of the table.

    Each group of strands that hang together has to be a ring of its own: one
    as long, that passes all points of the strands, and whose anchor lies on
    no strand of another group.
    """
    curves, anchors = rings
    links = np.array([strand.ends for strand in strands] + matching)
    _, part = find_components(*links.T, 2 * len(strands))
    groups = {}
    for strand in strands:
        groups.setdefault(int(part[strand.ends[0]]), []).append(strand)
    fits = np.zeros((len(groups), len(curves)), bool)
    for row, group in enumerate(groups.values()):
        length, spots = sum(strand.length for strand in group), np.concatenate([strand.spots for strand in group])
        foreign = set().union(*(strand.sides for strand in strands if strand not in group))
        own = set().union(*(strand.sides for strand in group))
        for ring in np.flatnonzero(np.abs(shapely.length(curves) - length) <= noise * (len(spots) + 2)).tolist():
            near = shapely.dwithin(curves[ring], shapely.points(spots), noise).all()
            fits[row, ring] = near and anchors[ring] not in foreign
        if own & set(anchors):  # a ring that is anchored on a strand of this group is its ring
            fits[row] &= np.array([anchor in own for anchor in anchors])
    return _can_all_have(fits)


def _can_all_have(fits):
    """Whether every row of (r, c) bool can have a column of its own that it fits, by augmenting paths."""
    owner = {}

    def seat(row, tried):
        for column in np.flatnonzero(fits[row]).tolist():
            if column not in tried:
                tried.add(column)
                if column not in owner or seat(owner[column], tried):
                    owner[column] = row
                    return True
        return False

    return all(seat(row, set()) for row in range(len(fits)))


class Strand(NamedTuple):
    """A part of a level set from the vertex to the vertex.

    ends : its two zero directions; spots : (k, 2) its crossings; length :
    float; sides : set of the mesh edges it crosses, (lower, upper)
    """

    ends: tuple
    spots: np.ndarray
    length: float
    sides: frozenset


def _strands(surface, sides, vertex, link, wedges):
    """The level set through the vertex, followed away from it: list of :class:`Strand`."""
    # The level runs through the vertex: what does not touch it decides by rank.
    crossed = np.flatnonzero((sides.lower < vertex) & (sides.upper > vertex))
    a, b, c = surface.corners.T
    face = np.flatnonzero((a < vertex) & (c > vertex) & (b != vertex))
    number = np.full(len(sides.lower), -1)
    number[crossed] = np.arange(len(crossed))
    long = number[sides.of_face[face, 2]]
    short = number[np.where(b[face] > vertex, sides.of_face[face, 0], sides.of_face[face, 1])]
    _, part = find_components(long, short, len(crossed))
    centre = surface.points[vertex, :2]
    spots = cross(surface, sides.lower[crossed], sides.upper[crossed], surface.points[vertex, 2], *centre)
    steps = np.hypot(*(spots[long] - spots[short]).T)
    names = list(zip(sides.lower[crossed].tolist(), sides.upper[crossed].tolist()))
    place_of, ends = {pair: place for place, pair in enumerate(names)}, {}
    for direction, gate in enumerate(_gates(link, wedges)):
        place = place_of[min(gate), max(gate)]
        ends.setdefault(int(part[place]), []).append((direction, np.hypot(*(spots[place] - centre))))
    strands = []
    for name, ((one, first), (two, last)) in ends.items():
        here = np.flatnonzero(part == name)
        length = first + last + steps[part[long] == name].sum()
        strands.append(Strand((one, two), spots[here], length, frozenset(names[i] for i in here)))
    return strands


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
