"""Closed paths along mesh edges that follow cycles of the surface's Reeb graph."""

import numpy as np

from ..arrays.grouping import Groups
from ..kernels import njit
from ..morse.ordered_mesh import next_half_edge


def walk_cycles(mesh, graph, cycles, cut):
    """Lay a closed path along mesh edges through the arcs of each cycle.

    From the lower end of an arc the path climbs, from vertex to higher vertex,
    until the next one would be above the arc's upper end, and then goes around
    the contour just below that, along its ends on one side: the upper ends of
    the mesh edges that the contour crosses or, where the arc is below the
    circle around, the lower ones. So whatever the mesh edges span, no way
    around crosses the height of the circle, and a climb crosses it once.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's.
    cycles : Groups
        L cycles, from their tops, as of :func:`.loop_cycles.trace_loops`.
    cut : (L,) int
        Of each cycle the level of its circle around: how many vertices are below.

    Returns
    -------
    Groups
        Ranks of the vertices of each path, in turn; the last is joined to the first.
        The path meets the ends of all arcs, and crosses at the height of its circle
        every arc of the cycle that is there just once, and no other.
    """
    return Groups(*_walk(mesh, graph.nodes, graph.arcs, graph.gates, cycles, np.asarray(cut, np.int64)))


@njit
def _walk(mesh, nodes, arcs, gates, cycles, cut):
    """Kernel of `walk_cycles`."""
    start, found = np.zeros(len(cut) + 1, np.int64), [np.int64(0) for _ in range(0)]
    for k in range(len(cut)):
        members = cycles.member[cycles.start[k] : cycles.start[k + 1]]
        node, path = np.int64(arcs[members[0], 1]), [np.int64(0) for _ in range(0)]
        for arc in members:
            low, high = np.int64(arcs[arc, 0]), np.int64(arcs[arc, 1])
            way = _climb_arc(mesh, nodes[low], np.int64(gates[arc]), nodes[high], nodes[high] < cut[k])
            if node == high:
                way = way[::-1]
            path.extend(way[:-1])
            node = low + high - node
        found.extend(drop_spurs(path))
        start[k + 1] = len(found)
    return start, np.array(found)


@njit(inner=True)
def _climb_arc(mesh, low, gate, high, stay_below):
    """Ranks of a path from the lower end of an arc to its upper end; `gate` leads from the one into the arc."""
    points, faces = mesh.points, mesh.faces
    path, h = [np.int64(low)], gate
    while True:
        head = np.int64(faces[h // 3, (h % 3 + 1) % 3])
        if head > high:
            break
        path.append(head)
        if head == high:
            return path
        h = _ahead(points, faces, mesh.twins, h, high)
    path.extend(_go_around(mesh, h, high, stay_below))
    if path[-1] != high:
        path.append(np.int64(high))
    return path


@njit(inner=True)
def _ahead(points, faces, twins, h, goal):
    """The upward half-edge from the upper end of h by which the way to a vertex is shortest, as the crow flies."""
    first = h // 3 * 3 + (h % 3 + 1) % 3  # leaves the vertex
    here, g, best, least = faces[first // 3, first % 3], first, first, np.inf
    while True:
        there = faces[g // 3, (g % 3 + 1) % 3]
        if there > here:
            way = distance(points, here, there) + distance(points, there, goal)
            if way < least:
                best, least = g, way
        g = np.int64(twins[g // 3 * 3 + (g % 3 + 2) % 3])
        if g == first:
            return best


@njit(inline="always")
def distance(points, v, w):
    """Between two vertices."""
    x, y, z = points[v, 0] - points[w, 0], points[v, 1] - points[w, 1], points[v, 2] - points[w, 2]
    return np.sqrt(x * x + y * y + z * z)


@njit(inner=True)
def _go_around(mesh, h, vertex, stay_below):
    """Ends of the mesh edges along the contour just below a vertex, from half-edge h to the vertex, by fewest edges.

    Lower ends, the vertex itself left out, or upper ones.
    """
    faces, twins, side = mesh.faces, mesh.twins, 0 if stay_below else 1
    onward, back, g, b = [np.int64(0) for _ in range(0)], [np.int64(0) for _ in range(0)], h, h
    while True:
        onward.append(np.int64(faces[g // 3, (g % 3 + side) % 3]))
        if faces[g // 3, (g % 3 + 1) % 3] == vertex:
            return onward
        back.append(np.int64(faces[b // 3, (b % 3 + side) % 3]))
        if faces[b // 3, (b % 3 + 1) % 3] == vertex:
            return back
        g = np.int64(next_half_edge(faces, twins, g, vertex))
        third = faces[b // 3, (b % 3 + 2) % 3]  # the contour came through the face of b
        b = np.int64(twins[b // 3 * 3 + (b % 3 + (2 if third >= vertex else 1)) % 3])


@njit(inner=True)
def drop_spurs(path):
    """The closed path without steps forth and back, and without vertices that follow themselves."""
    kept = [np.int64(0) for _ in range(0)]
    for v in path:
        if len(kept) > 1 and kept[-2] == v:
            kept.pop()
        elif len(kept) == 0 or kept[-1] != v:
            kept.append(v)
    low, high = 0, len(kept) - 1
    while high - low > 1:
        if kept[high] == kept[low] or kept[high - 1] == kept[low]:
            high -= 1
        elif kept[high] == kept[low + 1]:
            low += 1
        else:
            break
    return kept[low : high + 1]
