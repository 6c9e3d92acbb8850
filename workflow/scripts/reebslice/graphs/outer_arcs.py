"""Which arcs of the surface's Reeb graph are outer contours, and which are holes: from their ends, mostly.

An arc is one contour that moves, so it is a hole at all heights or at none.
What begins or ends at an extremum is known from the link of that vertex. At a
saddle one contour becomes two or the other way around, and the one is of the
kind of at least one of the two, as the table of events says; the more so where
the link tells on which side of the surface the event happens. What none of
this settles is measured, contour by contour.
"""

import numpy as np

from ..arrays.grouping import list_incidence
from ..handles.sides import link_areas, turns_around_hole, walk_contour
from ..kernels import njit
from ..morse.ordered_mesh import HeightMesh, cross_at
from ..morse.reeb_graph import ReebGraph
from ..slicing.exact_contours import exact_tilt

ROUNDING = 64 * np.finfo(float).eps  # of the largest coordinate: no crossing is computed further from its place


def find_inner_arcs(mesh: HeightMesh, graph: ReebGraph, into: np.ndarray) -> np.ndarray | None:
    """Tell which arcs of the surface's Reeb graph are holes.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    graph : ReebGraph
        The mesh's, of A arcs.
    into : (n, 2) int32
        Of the mesh's :class:`.contour_trees.Gates`.

    Returns
    -------
    (A,) bool or None
        Exact: what rounding leaves open is decided in rational numbers. None where signs contradict each other, as
        those of a surface that crosses itself may.
    """
    count = len(graph.nodes)
    incident = list_incidence(graph.arcs, count)
    inner = np.full(len(graph.arcs), -1, np.int8)
    ends = np.flatnonzero(np.diff(incident.start) == 1)
    arcs = incident.member[incident.start[ends]]
    is_hole = (link_areas(mesh, graph.nodes[ends]) > 0) == (graph.arcs[arcs, 0] == ends)
    inner[arcs] = is_hole
    rounding = ROUNDING * np.abs(mesh.points).max()
    sides = _find_sides(mesh, graph.nodes, into, rounding)
    # an arc may run from extremum to extremum
    if (inner[arcs] != is_hole).any() or not _spread_signs(graph.arcs, incident, inner, sides, np.arange(count)):
        return None
    fit, doubtful = _measure_open(mesh, graph, incident, inner, sides, rounding)
    if not fit:
        return None
    tilt = exact_tilt(mesh.points) if (inner < 0).any() else None
    for arc in doubtful.tolist():
        if inner[arc] < 0:
            ends = graph.arcs[arc].astype(np.int64)
            inner[arc] = turns_around_hole(mesh, graph.gates[arc], int(graph.nodes[ends[0]]) + 1, tilt)
            if not _spread_signs(graph.arcs, incident, inner, sides, ends):
                return None
    return inner == 1


@njit
def _find_sides(mesh, nodes, into, rounding):
    """0 where void ends above a saddle (side A), 1 where material does (B), -1 where rounding hides it: (K,) int8.

    The contours through a saddle leave it in two directions, with material on the left, and arrive from two others.
    A level right above cuts off the sector between the two directions of each upper wedge of the link.
    """
    points, faces, twins = mesh.points, mesh.faces, mesh.twins
    side, ways = np.full(len(nodes), np.int8(-1)), np.empty((4, 2))
    for k in range(len(nodes)):
        v, count, first = nodes[k], 0, 0
        if into[v, 1] < 0:
            continue
        h = start = np.int64(into[v, 0] // 3 * 3 + (into[v, 0] % 3 + 1) % 3)  # leaves the saddle
        while True:
            face, corner = h // 3, h % 3
            x, y = faces[face, (corner + 1) % 3], faces[face, (corner + 2) % 3]
            if (x < v) != (y < v):
                px, py = cross_at(points[min(x, y)], points[max(x, y)], points[v, 2], points[v, 0], points[v, 1])
                if count < 4:
                    ways[count, 0], ways[count, 1] = px - points[v, 0], py - points[v, 1]
                first = 1 if count == 0 and y < v else first  # the contour arrives from there
                count += 1
            h = np.int64(twins[3 * face + (corner + 2) % 3])
            if h == start:
                break
        if count == 4:
            side[k] = _side_of(ways[first], ways[first + 1], ways[(first + 2) % 4], rounding)
    return side


@njit(inline="always")
def _side_of(leaving, arriving, other, rounding):
    """Side of a saddle by the directions of one upper wedge, and one of those of the other."""
    turns, bound = np.empty(3), np.inf
    for k in range(3):
        one, two = (leaving, leaving, other)[k], (arriving, other, arriving)[k]
        turns[k] = one[0] * two[1] - one[1] * two[0]
        error = rounding * (abs(one[0]) + abs(one[1]) + abs(two[0]) + abs(two[1]) + rounding)
        bound = min(bound, abs(turns[k]) - error)
    if not bound > 0:
        return -1
    if turns[0] > 0:
        return 0 if turns[1] > 0 and turns[2] > 0 else 1
    return 1 if turns[1] < 0 and turns[2] < 0 else 0


@njit
def _measure_open(mesh, graph, incident, inner, sides, rounding):
    """Measure what is open, arc by arc, and fill in what follows.

    Returns whether areas do not contradict each other, and the arcs whose area rounding may have turned around.
    """
    doubtful = [np.int64(0) for _ in range(0)]
    for arc in range(len(inner)):
        if inner[arc] < 0:
            ends = graph.arcs[arc].astype(np.int64)
            vertex = np.int64(graph.nodes[ends[0]])
            area, length, _ = walk_contour(mesh, np.int64(graph.gates[arc]), np.int64(-1), vertex, vertex + 1)
            if abs(area) <= rounding * (length + rounding):
                doubtful.append(np.int64(arc))
                continue
            inner[arc] = area < 0
            if not _spread_signs(graph.arcs, incident, inner, sides, ends):
                return False, np.array(doubtful)
    return True, np.array(doubtful)


@njit
def _spread_signs(arcs, incident, inner, sides, nodes):
    """Fill in what the arcs at the given nodes, and at those that follow, tell of each other; whether none contradict.

    Of three arcs, the one that is alone on its side of the saddle is of the kind of at least one of the two others.
    Of a union or separation of two contours, as many more are holes than of the one, as `sides` says.
    """
    stack, waits = list(nodes), np.zeros(len(incident.start) - 1, np.bool_)
    while len(stack) > 0:
        node = stack.pop()
        waits[node] = False
        first = incident.start[node]
        if incident.start[node + 1] - first != 3:
            continue
        one, a, b = incident.member[first], incident.member[first + 1], incident.member[first + 2]
        while (arcs[one, 0] == node) == (arcs[a, 0] == node) or (arcs[one, 0] == node) == (arcs[b, 0] == node):
            one, a, b = a, b, one  # until the first is alone
        side = sides[node] if arcs[one, 0] == node or sides[node] < 0 else 1 - sides[node]
        fits, always, never = 0, 7, 7  # of the eight combinations, as bits
        for bits in range(8):
            x, y, z = bits & 1, bits >> 1 & 1, bits >> 2
            if (
                x in (y, z) and (side < 0 or y + z == x + side)
                and (inner[one] < 0 or inner[one] == x) and (inner[a] < 0 or inner[a] == y)
                and (inner[b] < 0 or inner[b] == z)
            ):  # fmt: skip
                fits, always, never = fits + 1, always & bits, never & ~bits
        if fits == 0:
            return False
        for k in range(3):
            arc = (one, a, b)[k]
            if inner[arc] < 0 and (always | never) >> k & 1:
                inner[arc] = always >> k & 1
                for end in arcs[arc]:
                    if not waits[end]:
                        waits[end] = True
                        stack.append(np.int64(end))
    return True
