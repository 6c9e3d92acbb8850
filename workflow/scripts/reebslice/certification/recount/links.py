"""Links of vertices, and the directions in which the surface is level there, in whole numbers.

The height is tilted by so little that no two vertices change their order, so
that no two have one height; everything is times a power of two, so that
nothing is rounded.
"""

from functools import cmp_to_key
from itertools import pairwise

import numpy as np

from .surface import oriented_faces


def smallest_tilt(points):
    """Find a tilt small enough that it changes the order of no two points.

    Parameters
    ----------
    points : (n, 3) float64
        In order of height.

    Returns
    -------
    int
        The tilt along x is 2 ** -that, the one along y its square: steps of
        height outweigh the one along x, and, where heights tie, steps of x that along y, twice over.
    """
    x, y, rises = np.abs(points[:, 0]).max(), np.abs(points[:, 1]).max(), np.diff(points[:, 2])
    least = (x + y) / rises[rises > 0].min()
    if not rises.all():
        steps = np.diff(np.sort(points[:, 0]))
        least = max(least, y / steps[steps > 0].min())
    return max(3, int(np.ceil(3 + np.log2(least))))


def whole_points(points, tilt):
    """Put points in whole numbers.

    Parameters
    ----------
    points : (k, 3) float64
    tilt : int
        Of :func:`smallest_tilt`.

    Returns
    -------
    unit : int
        A power of two.
    list of (int, int, int)
        x, y and the tilted height, each times `unit`; the height times one more.
    """
    ratios = [[value.as_integer_ratio() for value in point] for point in points.tolist()]
    unit = max(below for point in ratios for _, below in point)
    whole = ([above * (unit // below) for above, below in point] for point in ratios)
    return unit, [(x, y, (((z << tilt) + x) << tilt) + y) for x, y, z in whole]


def find_links(surface, vertices):
    """Find the links of some vertices.

    Parameters
    ----------
    surface : Ranked
    vertices : list of int

    Returns
    -------
    dict
        {vertex: its link as a cycle, counter-clockwise seen from outside}.
    """
    chosen, after = np.zeros(len(surface.points), bool), {vertex: {} for vertex in vertices}
    chosen[vertices] = True
    low, middle, high = (chosen[column] for column in surface.corners.T)
    for a, b, c in oriented_faces(surface, np.flatnonzero(low | middle | high)).tolist():
        for v, p, q in ((a, b, c), (b, c, a), (c, a, b)):
            if v in after:
                after[v][p] = q
    return {vertex: follow(steps) for vertex, steps in after.items()}


def follow(after):
    """Follow steps, {from: to}, around their cycle, from the first one on."""
    cycle = [next(iter(after))]
    while after[cycle[-1]] != cycle[0]:
        cycle.append(after[cycle[-1]])
    return cycle


def find_arms(points, tilt, vertex, link):
    """Find where the members of a link are, seen from its vertex: whole numbers as of :func:`whole_points`."""
    _, ((x, y, h), *others) = whole_points(points[[vertex, *link]], tilt)
    return [(p - x, q - y, r - h) for p, q, r in others]


def find_upper_wedges(arms):
    """Find the runs of arms that lead up, in a link: places (first, last) of each."""
    up = [h > 0 for _, _, h in arms]
    starts = [k for k in range(len(up)) if up[k] and not up[k - 1]]
    ends = [k for k in range(len(up)) if up[k] and not up[(k + 1) % len(up)]]
    return list(zip(starts, ends if not starts or starts[0] <= ends[0] else ends[1:] + ends[:1]))


def order_level_directions(arms, wedges):
    """Order the horizontal directions in which the surface around a vertex is level.

    Parameters
    ----------
    arms : list of (int, int, int)
        Of :func:`find_arms`.
    wedges : list of (int, int)
        Of :func:`find_upper_wedges`. Directions 2 w and 2 w + 1 bound wedge w, the first where the link enters it.

    Returns
    -------
    list of int
        How many directions come before each one, counter-clockwise; those that coincide share a place.
    """
    directions = []
    for first, last in wedges:
        for low, high in ((first - 1, first), ((last + 1) % len(arms), last)):
            (px, py, ph), (qx, qy, qh) = arms[low], arms[high]
            directions.append((px * qh - qx * ph, py * qh - qy * ph))  # times qh - ph > 0

    def compare(i, j):
        (px, py), (qx, qy) = directions[i], directions[j]
        halves = (py < 0 or (py == 0 and px < 0)), (qy < 0 or (qy == 0 and qx < 0))
        return halves[0] - halves[1] if halves[0] != halves[1] else py * qx - px * qy

    around, places = sorted(range(len(directions)), key=cmp_to_key(compare)), [0] * len(directions)
    for number, (one, two) in enumerate(pairwise(around), start=1):
        places[two] = places[one] if compare(one, two) == 0 else number
    return places
