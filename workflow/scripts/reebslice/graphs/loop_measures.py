"""Measures of circles around loops, and of paths along them."""

import numpy as np

from ..arrays.grouping import Groups, group_of_members
from ..formats.wkb import pack_curves, unpack_curves
from ..kernels import njit
from ..planar.circles import largest_circles
from ..planar.curves import Curves, pick_curves
from ..planar.outlines import Outlines, mend_outlines
from ..slicing.contours import Contours
from ..slicing.regions import find_regions
from .loop_kinds import Nesting

# Of the circle with the same perimeter: no inscribed circle is larger than that found by more than this share of it.
TOLERANCE = 1e-3


def nest_bodies(mesh, levels, contours, of_arcs, body_of_vertex):
    """Find which contours are inside which, body by body.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    levels : Levels
        The cuts.
    contours : Contours
        C contours.
    of_arcs : Groups
        The contours of each arc, as of :func:`.graph_slices.trace_arcs_at_levels`.
    body_of_vertex : (n,) int32
        Of the ranks.

    Returns
    -------
    Nesting
        Of C contours.
    """
    body, count = body_of_vertex[contours.lower], len(contours.level)
    arc, parent, inner = np.empty(count, np.int64), np.full(count, -1, np.int32), np.empty(count, bool)
    area, perimeter = np.empty(count), np.empty(count)
    arc[of_arcs.member] = group_of_members(of_arcs)
    for one in np.unique(body):
        rows = np.flatnonzero(body == one)
        found = find_regions(mesh, levels, _pick_contours(contours, rows), body[rows])
        parent[rows] = np.where(found.parent < 0, -1, rows[found.parent])
        inner[rows], area[rows], perimeter[rows] = found.inner, np.abs(found.area), found.perimeter
    return Nesting(contours.level, arc, parent, inner, area, perimeter)


def _pick_contours(contours, rows):
    """The :class:`Contours` of the rows, ascending."""
    points, start = pick_curves(Curves(contours.points, contours.start), rows)
    return Contours(contours.level[rows], start, points, *(column[rows] for column in contours[3:]))


def measure_insides(contours, nesting, chosen):
    """Measure what is immediately inside contours, in their planes.

    Parameters
    ----------
    contours : Contours
        C contours.
    nesting : Nesting or Regions
        Theirs: what is around each, and its area, with or without a sign, and length.
    chosen : (L,) int
        Contours, each once.

    Returns
    -------
    section, radius : (L,) float64
        Area, without what is inside further contours in there, and the radius of the largest circle.
    centre : (L, 2) float64
        Of that circle; a point of the contour where there is none, as inside flats.
    """
    place = np.full(len(nesting.parent) + 1, -1)  # the last entry is that of no parent
    place[chosen] = np.arange(len(chosen))
    children = np.flatnonzero(place[nesting.parent] >= 0)
    members = np.concatenate([chosen, children])
    hole, owner = np.arange(len(members)) >= len(chosen), np.append(place[chosen], place[nesting.parent[children]])
    area = np.abs(nesting.area[members]) * np.where(hole, -1, 1)
    section = np.bincount(owner, weights=area, minlength=len(chosen))
    order = np.lexsort((hole, owner))
    outlines = _outlines(contours, members[order], owner[order], hole[order], len(chosen))
    centre, radius = largest_circles(outlines, TOLERANCE / (2 * np.pi) * nesting.perimeter[chosen])
    centre = np.where(np.isnan(centre), contours.points[contours.start[chosen]], centre)
    return np.maximum(section, 0.0), np.maximum(radius, 0.0), centre


def draw_circles(contours, chosen, height):
    """List the points (P, 3) of contours, which lie at heights (L,)."""
    points, start = contours.points, contours.start
    flat = [points[start[c] : start[c + 1]] for c in chosen.tolist()]
    return [np.column_stack([curve, np.full(len(curve), z)]) for curve, z in zip(flat, height.tolist())]


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
            x, y, z = (
                points[v, 0] - points[before, 0],
                points[v, 1] - points[before, 1],
                points[v, 2] - points[before, 2],
            )
            length[k] += np.sqrt(x * x + y * y + z * z)
            if vertex[v] != vertex[before]:
                kept[start[k + 1]] = vertex[v]
                start[k + 1] += 1
            before = v
    return start, kept[: start[n]], length
