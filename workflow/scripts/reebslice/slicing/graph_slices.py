"""Contours of a surface from its Reeb graph: only what the levels cross is visited.

A contour is a point of an arc, so every arc gives the contours of all levels
between its ends: climbing the surface from the lower end of the arc finds a
mesh edge of each. Time and memory grow as the crossings and the graph, and as
the mesh edges climbed, not as the mesh.
"""

import numpy as np

from ..arrays.grouping import Groups
from ..errors import TooManyCrossingsError
from ..kernels import njit
from ..morse.ordered_mesh import cross_at, next_half_edge
from .contours import MOST_CROSSINGS, Contours


def trace_arcs_at_levels(mesh, graph, levels, most=None):
    """Trace the contours of all levels along the arcs of the surface's Reeb graph.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    graph : ReebGraph
        The mesh's, of A arcs.
    levels : Levels
        The cuts.
    most : int, optional
        Points that there may be; by default MOST_CROSSINGS.

    Returns
    -------
    contours : Contours
        To the last bit those of :func:`.contours.trace_contours`.
    of_arcs : Groups
        The contours that are points of each arc, upward, as of :func:`contours_of_arcs`.

    Raises
    ------
    TooManyCrossingsError
        As soon as the points are known to be more than `most`.
    """
    offset, level, crossing = _cross_arcs(mesh, graph, levels)
    most = MOST_CROSSINGS if most is None else most
    first, length = _walk_contours(mesh, levels, level, crossing, most)
    if length.sum() > most:
        raise TooManyCrossingsError(
            f"{len(levels.height)} levels cross the mesh edges more than {most} times, which is more than "
            "can be held: smooth the surface, or look at the features of a size only (`slice_surface`)"
        )
    order = np.lexsort((first, level))
    contour = np.empty(len(order), np.int32)
    contour[order] = np.arange(len(order), dtype=np.int32)
    level, first, start = level[order], first[order], np.concatenate([[0], np.cumsum(length[order])])
    points = _trace_points(mesh, levels, level, first, start)
    face, corner = np.divmod(first, 3)
    lower, upper = mesh.faces[face, corner], mesh.faces[face, (corner + 1) % 3]
    return Contours(level, start, points, first, lower, upper), Groups(offset, contour)


def contours_of_arcs(mesh, graph, levels, crossings):
    """Look up the contours that are points of each arc of the surface's Reeb graph.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    graph : ReebGraph
        The mesh's, of A arcs.
    levels : Levels
        The cuts.
    crossings : Crossings
        Those of :func:`.contours.trace_crossings`, of C contours.

    Returns
    -------
    Groups
        The contours of each arc, upward; ``member`` is (C,) int32 and has every contour once.
    """
    offset, level, crossing = _cross_arcs(mesh, graph, levels)
    face = crossing // 3
    lowest = np.searchsorted(levels.below, mesh.faces[face, 0], side="right")
    return Groups(offset, crossings.label[crossings.offset[face] + level - lowest])


def _cross_arcs(mesh, graph, levels):
    """Levels that each arc crosses, arc by arc, and an upward half-edge where it does: offset, level, crossing."""
    ends = graph.nodes[graph.arcs]
    lowest, end = (np.searchsorted(levels.below, ends[:, k], side="right") for k in (0, 1))
    offset = np.concatenate([[0], np.cumsum(end - lowest)])
    level = (np.arange(offset[-1]) + np.repeat(lowest - offset[:-1], end - lowest)).astype(np.int32)
    return offset, level, climb(mesh.faces, mesh.twins, levels.below, graph.gates, offset, level)


@njit
def climb(faces, twins, below, gates, offset, level):
    """Go up from the gate of each arc to the levels that cross it.

    Parameters
    ----------
    faces, twins : arrays
        Of the mesh.
    below : (K,) int
        Vertices below each level.
    gates : (A,) int32
        Of the graph.
    offset : (A + 1,) int
        Arc a asks for ``level[offset[a]:offset[a + 1]]``.
    level : (L,) int
        Ascending for each arc.

    Returns
    -------
    (L,) int32
        An upward half-edge that crosses each level, on the contour of its arc.
    """
    crossing = np.empty(len(level), np.int32)
    for a in range(len(gates)):
        h = np.int64(gates[a])
        for place in range(offset[a], offset[a + 1]):
            while faces[h // 3, (h % 3 + 1) % 3] < below[level[place]]:
                h = _go_up(faces, twins, h)
            crossing[place] = h
    return crossing


@njit(inner=True)
def _go_up(faces, twins, h):
    """An upward half-edge from the upper end of h, a regular vertex."""
    vertex = faces[h // 3, (h % 3 + 1) % 3]
    while True:
        h = h // 3 * 3 + (h % 3 + 1) % 3  # leaves the vertex
        if faces[h // 3, (h % 3 + 1) % 3] > vertex:
            return h
        h = twins[h]


@njit
def _walk_contours(mesh, levels, level, crossing, most_crossings):
    """First half-edge and number of crossings of contours, until there are too many."""
    faces, twins, below = mesh.faces, mesh.twins, levels.below
    first, length, total = crossing.copy(), np.zeros(len(level), np.int64), 0
    for c in range(len(level)):
        h, cut = crossing[c], below[level[c]]
        while length[c] == 0 or h != crossing[c]:
            length[c] += 1
            first[c] = min(first[c], h)
            h = next_half_edge(faces, twins, h, cut)
        total += length[c]
        if total > most_crossings:
            break
    return first, length


@njit
def _trace_points(mesh, levels, level, first, start):
    """Points (X, 2) of contours from their levels, first half-edges and starts."""
    points, faces, twins = mesh.points, mesh.faces, mesh.twins
    height, below, tie_x, tie_y = levels.height, levels.below, levels.tie_x, levels.tie_y
    out = np.empty((start[-1], 2))
    for c in range(len(level)):
        k, h = level[c], first[c]
        for place in range(start[c], start[c + 1]):
            low, high = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
            out[place, 0], out[place, 1] = cross_at(points[low], points[high], height[k], tie_x[k], tie_y[k])
            h = next_half_edge(faces, twins, h, below[k])
    return out
