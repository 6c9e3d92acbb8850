"""Measures of circles around loops, and of paths along them."""

import numpy as np

from ..arrays.grouping import Groups
from ..formats.wkb import pack_curves, unpack_curves
from ..kernels import njit
from ..planar.circles import largest_circles
from ..planar.curves import Curves, pick_curves
from ..planar.outlines import Outlines, mend_outlines
from ..slicing.contours import Contours
from ..slicing.regions import find_regions

# Of the circle with the same perimeter: no inscribed circle is larger than that found by more than this share of it.
TOLERANCE = 1e-3


def nest_bodies(mesh, levels, contours, body_of_vertex):
    """Find which contours are inside which, body by body.

    Parameters
    ----------
    mesh : HeightMesh
    levels : Levels
    contours : Contours
        C contours.
    body_of_vertex : (n,) int32

    Returns
    -------
    Regions
        Its `parent` is the smallest contour around each one of the same body. Numbers of regions count for each
        body apart.
    """
    body = body_of_vertex[contours.lower]
    bodies = np.unique(body)
    if len(bodies) < 2:
        return find_regions(mesh, levels, contours, body)
    parts = []
    for one in bodies:
        rows = np.flatnonzero(body == one)
        part = find_regions(mesh, levels, _pick_contours(contours, rows), body[rows])
        parts.append((rows, part._replace(parent=np.where(part.parent < 0, -1, rows[part.parent]).astype(np.int32))))
    whole = parts[0][1]
    for name in ("of_contour", "inner", "parent", "area", "perimeter"):
        column = np.empty(len(body), getattr(whole, name).dtype)
        for rows, part in parts:
            column[rows] = getattr(part, name)
        whole = whole._replace(**{name: column})
    return whole


def _pick_contours(contours, rows):
    """The :class:`Contours` of the rows, ascending."""
    points, start = pick_curves(Curves(contours.points, contours.start), rows)
    return Contours(contours.level[rows], start, points, *(column[rows] for column in contours[3:]))


def measure_insides(contours, regions, chosen, height):
    """Measure what is immediately inside contours, in their planes.

    Parameters
    ----------
    contours : Contours
        C contours.
    regions : Regions
        What :func:`nest_bodies` found.
    chosen : (L,) int
        Contours, each once.
    height : (L,) float64
        Theirs.

    Returns
    -------
    section, radius : (L,) float64
        Area, without what is inside further contours in there, and the radius of the largest circle.
    centre : (L, 3) float64
        Of that circle; the mean of the points where there is none, as inside flats.
    circles : list of (P, 3) float64
        The points of the contours.
    """
    place = np.full(len(contours.level) + 1, -1)  # the last entry is that of no parent
    place[chosen] = np.arange(len(chosen))
    children = np.flatnonzero(place[regions.parent] >= 0)
    owner = np.concatenate([np.arange(len(chosen)), place[regions.parent[children]]])
    members = np.concatenate([chosen, children])
    hole = np.arange(len(members)) >= len(chosen)
    size = np.abs(regions.area[members])
    section = np.bincount(owner, weights=np.where(hole, -size, size), minlength=len(chosen))
    order = np.lexsort((hole, owner))
    outlines = _outlines(contours, members[order], owner[order], hole[order], len(chosen))
    middle, radius = largest_circles(outlines, TOLERANCE / (2 * np.pi) * regions.perimeter[chosen])
    circles = [contours.points[contours.start[c] : contours.start[c + 1]] for c in chosen]
    means = np.array([circle.mean(axis=0) for circle in circles]).reshape(-1, 2)
    centre = np.column_stack([np.where(np.isnan(middle), means, middle), height])
    rings = [np.column_stack([circle, np.full(len(circle), z)]) for circle, z in zip(circles, height)]
    return np.maximum(section, 0.0), np.maximum(radius, 0.0), centre, rings


def _outlines(contours, members, owner, hole, count):
    """The :class:`Outlines` of `count` areas from the contours that bound them, those around them first."""
    picked = _pick_contours(contours, members)
    curves = unpack_curves([pack_curves(picked.points, picked.start)], len(picked.points) + len(members))
    usable = np.diff(curves.start) >= 4
    has_rim = np.zeros(count, bool)
    has_rim[owner[usable & ~hole]] = True
    rows = np.flatnonzero(usable & has_rim[owner])
    start = np.concatenate([[0], np.cumsum(np.bincount(owner[rows], minlength=count))])
    return mend_outlines(Outlines(*pick_curves(curves, rows), start, hole[rows]))


def paths_of_vertices(mesh, walked):
    """Convert paths of ranks to paths of vertices.

    Parameters
    ----------
    mesh : HeightMesh
    walked : Groups
        L closed paths of ranks.

    Returns
    -------
    paths : Groups
        Of vertices; of those that follow themselves, as copies of an unfolded saddle do, there is one.
    length : (L,) float64
        Mesh units.
    """
    start, vertex, length = _measure_paths(mesh.points, mesh.vertex, walked)
    return Groups(start, vertex), length


@njit
def _measure_paths(points, vertex, walked):
    """Kernel of `paths_of_vertices`: starts, vertices, lengths."""
    n = len(walked.start) - 1
    start, length, kept = np.zeros(n + 1, np.int64), np.zeros(n), np.empty(len(walked.member), np.int32)
    for k in range(n):
        start[k + 1], before = start[k], walked.member[walked.start[k + 1] - 1]
        for place in range(walked.start[k], walked.start[k + 1]):
            v = walked.member[place]
            x, y, z = points[v, 0] - points[before, 0], points[v, 1] - points[before, 1], points[v, 2] - points[before, 2]
            length[k] += np.sqrt(x * x + y * y + z * z)
            if vertex[v] != vertex[before]:
                kept[start[k + 1]] = vertex[v]
                start[k + 1] += 1
            before = v
    return start, kept[: start[n]], length
