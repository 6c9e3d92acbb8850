"""Sides of critical points, from the geometry right around them.

Only what no rank can decide is done here with coordinates. What rounding
leaves open is "open", never a guess.
"""

import numpy as np

from ...kernels import njit

ANGLE = 1e-9  # openings smaller than this (radians) leave the order of directions open
# Tilts tried around a vertex where heights tie, rise per length.
TILTS = (0.0, 1e-9, 1e-6, 1e-3)
OPEN, A, B = range(3)
WORDS = np.array(["", "A", "B"], object)


def local_sides(surface, vertices):
    """Find the side of critical vertices from the geometry around them.

    Extrema: the sign of the area of the link, that is, whether the outside is
    up. Saddles: of the sector of the horizontal plane that an upper wedge of
    the link cuts off, whether it is void (A) or material (B).

    Parameters
    ----------
    surface : Ranked
    vertices : (k,) int

    Returns
    -------
    (k,) object
        "A", "B", or "" where the saddle is multiple or the directions are too close to tell.
    """
    links = _find_links(surface.corners, surface.even, vertices, len(surface.points))
    return WORDS[_find_sides(surface.points, surface.changes, vertices, *links)]


@njit
def _find_links(corners, even, vertices, n):
    """The links of some vertices as cycles, counter-clockwise from outside: their members, and where each begins."""
    place, first = np.full(n, -1), np.zeros(len(vertices) + 1, np.int64)
    for k in range(len(vertices)):
        place[vertices[k]] = k
    for v in corners.ravel():
        if place[v] >= 0:
            first[place[v] + 1] += 1
    first = np.cumsum(first)
    start, end, filled = np.empty(first[-1], np.int64), np.empty(first[-1], np.int64), first.copy()
    for f in range(len(corners)):
        a, b, c = corners[f, 0], corners[f, 1 if even[f] else 2], corners[f, 2 if even[f] else 1]
        for v, p, q in ((a, b, c), (b, c, a), (c, a, b)):
            k = place[v]
            if k >= 0:
                start[filled[k]], end[filled[k]] = p, q
                filled[k] += 1
    members, at = np.empty(first[-1], np.int64), np.empty(n, np.int64)
    for k in range(len(vertices)):
        for i in range(first[k], first[k + 1]):
            at[start[i]] = i
        i = first[k]
        for j in range(first[k], first[k + 1]):
            members[j] = start[i]
            i = at[end[i]]
    return members, first


@njit
def _find_sides(points, changes, vertices, members, first):
    """The side of each vertex by the first tilt that tells.

    Where heights tie, ranks are those of an infinitesimal tilt; any real one
    under which each neighbour is on its side of the vertex shows the same.
    """
    sides = np.zeros(len(vertices), np.int64)
    for k in range(len(vertices)):
        v, link = vertices[k], members[first[k] : first[k + 1]]
        x, y = points[link, 0] - points[v, 0], points[link, 1] - points[v, 1]
        z, above = points[link, 2] - points[v, 2], link > v
        for tilt in TILTS:
            rise = z + tilt * x + tilt * tilt * y
            if not np.all(np.where(above, rise, -rise) > 0):
                continue
            told = True
            if changes[v] == 0:
                sides[k] = _side_of_extremum(x, y, rise)
                told = sides[k] != OPEN
            elif changes[v] == 4:
                turns = _zero_directions(x, y, rise)
                gaps = np.sort(turns)
                told = min(np.diff(gaps).min(), gaps[0] + 2 * np.pi - gaps[-1]) >= ANGLE
                if told:
                    sides[k] = _side_of_saddle(turns)
            if told:
                break
    return sides


@njit
def _side_of_extremum(x, y, rise):
    """The side by the sign of the area of the link, seen from above at one height."""
    reach = max(np.abs(x).max(), np.abs(y).max())
    if reach == 0:
        return OPEN
    scale = np.abs(rise).min() / np.abs(rise) / reach
    x, y = x * scale, y * scale
    terms = x * np.roll(y, -1) - y * np.roll(x, -1)
    if abs(terms.sum()) > ANGLE * np.abs(terms).sum():
        return B if terms.sum() > 0 else A
    return OPEN


@njit
def _zero_directions(x, y, rise):
    """Angles at which the link of a simple saddle enters and leaves each upper wedge, in the order of the link."""
    n, turns, count = len(rise), np.empty(4), 0
    first = 0
    while not (rise[first] > 0 and rise[first - 1] < 0):
        first += 1
    for place in range(first, first + n):
        i, k = (place - 1) % n, place % n
        if (rise[k] > 0) != (rise[i] > 0):
            share = rise[i] / (rise[i] - rise[k])
            turns[count] = np.arctan2(y[i] + share * (y[k] - y[i]), x[i] + share * (x[k] - x[i]))
            count += 1
    return turns


@njit
def _side_of_saddle(turns):
    """The side by the two sectors that the upper wedges of a simple saddle cut off.

    The contour above runs in where the link leaves the wedge and out where it
    enters; the material is left of it, from where it enters to where it leaves.
    """
    within = 0
    for enters, leaves, one, two in ((0, 1, 2, 3), (2, 3, 0, 1)):
        width = (turns[leaves] - turns[enters]) % (2 * np.pi)
        within += ((turns[one] - turns[enters]) % (2 * np.pi) < width) + (
            (turns[two] - turns[enters]) % (2 * np.pi) < width
        )
    # both directions of the other wedge within, or neither, and the same of either wedge
    return A if within == 4 else B if within == 0 else OPEN
