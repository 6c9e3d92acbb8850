"""Slices of a surface from its Reeb graph: only what the levels cross is visited, and pieces are pieces of the graph.

A contour is a point of an arc, so every arc gives the contours of all levels
between its ends, and a piece of the surface is a piece of the graph: the
quotient that makes the graph keeps the components of sublevel and superlevel
sets. Time and memory grow as the crossings and the graph, not as the mesh.
"""

import numpy as np
from numba import njit

from ..arrays.components import find, join
from ..arrays.grouping import list_incidence
from ..errors import TooManyCrossingsError
from ..morse.ordered_mesh import cross_at, next_half_edge
from .contours import MOST_CROSSINGS, Contours
from .pieces import Pieces


def trace_arcs_at_levels(mesh, graph, levels):
    """The :class:`contours.Contours` of all levels, the same as `trace_contours` gives, and those of every arc.

    The second is as of `contours_of_arcs`. Raises TooManyCrossingsError as soon as
    there are too many.
    """
    offset, level, crossing = _cross_arcs(mesh, graph, levels)
    first, length = _walk_contours(mesh.faces, mesh.twins, levels.below, level, crossing, MOST_CROSSINGS)
    if length.sum() > MOST_CROSSINGS:
        raise TooManyCrossingsError(
            f"{len(levels.height)} levels cross the mesh edges more than {MOST_CROSSINGS} times"
        )
    order = np.lexsort((first, level))
    contour = np.empty(len(order), np.int32)
    contour[order] = np.arange(len(order), dtype=np.int32)
    level, first, start = level[order], first[order], np.concatenate([[0], np.cumsum(length[order])])
    points = _trace_points(mesh.points, mesh.faces, mesh.twins, level, first, start, *levels)
    face, corner = np.divmod(first, 3)
    lower, upper = mesh.faces[face, corner], mesh.faces[face, (corner + 1) % 3]
    return Contours(level, start, points, first, lower, upper), (offset, contour)


def contours_of_arcs(mesh, graph, levels, crossings):
    """The contours that are points of each arc of the :class:`reeb_graph.ReebGraph`, upward: (offset, contour).

    crossings : :class:`contours.Crossings`. offset : (A + 1,); contour : (C,)
    int32, of which those of arc a are contour[offset[a]:offset[a + 1]].
    """
    offset, level, crossing = _cross_arcs(mesh, graph, levels)
    face = crossing // 3
    lowest = np.searchsorted(levels.below, mesh.faces[face, 0], side="right")
    return offset, crossings.label[crossings.offset[face] + level - lowest]


def _cross_arcs(mesh, graph, levels):
    """Levels that each arc crosses, arc by arc, and an upward half-edge where it does: offset, level, crossing."""
    ends = graph.nodes[graph.arcs]
    lowest, end = (np.searchsorted(levels.below, ends[:, k], side="right") for k in (0, 1))
    offset = np.concatenate([[0], np.cumsum(end - lowest)])
    level = (np.arange(offset[-1]) + np.repeat(lowest - offset[:-1], end - lowest)).astype(np.int32)
    return offset, level, _climb(mesh.faces, mesh.twins, levels.below, graph.gates, offset, level)


@njit(cache=True)
def _climb(faces, twins, below, gates, offset, level):
    """Go up from each gate: an upward half-edge across every level that is asked for."""
    crossing = np.empty(len(level), np.int32)
    for a in range(len(gates)):
        h = gates[a]
        for place in range(offset[a], offset[a + 1]):
            while faces[h // 3, (h % 3 + 1) % 3] < below[level[place]]:
                h = _go_up(faces, twins, h)
            crossing[place] = h
    return crossing


@njit(cache=True)
def _walk_contours(faces, twins, below, level, crossing, most_crossings):
    """First half-edge and number of crossings of contours, until there are too many."""
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


@njit(cache=True)
def _go_up(faces, twins, h):
    """An upward half-edge from the upper end of h, a regular vertex."""
    vertex = faces[h // 3, (h % 3 + 1) % 3]
    while True:
        h = h // 3 * 3 + (h % 3 + 1) % 3  # leaves the vertex
        if faces[h // 3, (h % 3 + 1) % 3] > vertex:
            return h
        h = twins[h]


@njit(cache=True)
def _trace_points(points, faces, twins, level, first, start, height, below, tie_x, tie_y):
    out = np.empty((start[-1], 2))
    for c in range(len(level)):
        k, h = level[c], first[c]
        for place in range(start[c], start[c + 1]):
            low, high = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
            out[place, 0], out[place, 1] = cross_at(points[low], points[high], height[k], tie_x[k], tie_y[k])
            h = next_half_edge(faces, twins, h, below[k])
    return out


def pieces_of_graph(mesh, graph, levels, contours, of_arcs):
    """The :class:`pieces.Pieces`, but for their areas and fluxes (None) and for what regular vertices are in (-1).

    of_arcs : from `contours_of_arcs`. Pieces of one slab come in any order.
    """
    offset, contour = of_arcs
    k, c = len(graph.nodes), len(contours.level)
    roots, piece = np.unique(_join_pieces(graph.arcs, offset, contour, k, c), return_inverse=True)
    piece, count = piece.astype(np.int32), len(roots)
    of_node, below, above = piece[:k], piece[k : k + c], piece[k + c :]
    slab = np.empty(count, np.int32)
    node_slab = np.searchsorted(levels.below, graph.nodes, side="right")
    slab[piece] = np.concatenate([node_slab, contours.level, contours.level + 1]) - 1
    n_below = np.bincount(above, minlength=count).astype(np.int32)
    n_above = np.bincount(below, minlength=count).astype(np.int32)
    index = np.where(np.bincount(graph.arcs.ravel(), minlength=k) == 1, 1, -1)  # an extremum ends one arc
    euler = np.rint(np.bincount(of_node, weights=index, minlength=count)).astype(np.int32)
    essential = np.flatnonzero(_pair_nodes(graph.arcs, *list_incidence(graph.arcs, k), offset, contour, c) < 0)
    of_vertex = np.full(len(mesh.points), -1, np.int32)
    of_vertex[graph.nodes] = of_node
    critical = _list_by(of_node[essential], graph.nodes[essential], count)
    genus = (2 - n_below - n_above - euler) // 2
    return Pieces(slab, of_vertex, above, below, n_below, n_above, euler, genus, None, None, critical)


def _list_by(group, values, n_groups):
    """The values of every group, in their order: a list of arrays, of which most are empty."""
    order = np.argsort(group, kind="stable")
    values, (present, first) = values[order], np.unique(group[order], return_index=True)
    members = [values[:0]] * n_groups
    for place, part in zip(present.tolist(), np.split(values, first[1:])):
        members[place] = part
    return members


@njit(cache=True)
def _join_pieces(arcs, offset, contour, k, c):
    """Union-find over nodes, then contours seen from below, then from above."""
    root = np.arange(k + 2 * c)
    for a in range(len(arcs)):
        last = np.int64(arcs[a, 0])
        for place in range(offset[a], offset[a + 1]):
            join(root, last, k + contour[place])
            last = k + c + contour[place]
        join(root, last, np.int64(arcs[a, 1]))
    for i in range(len(root)):
        root[i] = find(root, i)
    return root


@njit(cache=True)
def _pair_nodes(arcs, start, member, offset, contour, c):
    """Partner of every node inside its slab, (K,) int32, -1 for none: `pairing.pair_in_slabs` in the graph."""
    k = len(start) - 1
    partner = np.full(k, -1, np.int32)
    for upward in (True, False):
        root, age, birth = np.arange(k + c), np.full(k + c, -1), np.full(k + c, -1)  # -1: it came in through a level
        for time in range(k):
            v = time if upward else k - 1 - time
            age[v], birth[v] = time, v
            for i in range(start[v], start[v + 1]):
                arc = member[i]
                if arcs[arc, 1 if upward else 0] != v:
                    continue
                met = np.int64(arcs[arc, 0 if upward else 1])
                if offset[arc] < offset[arc + 1]:
                    met = k + contour[offset[arc + 1] - 1 if upward else offset[arc]]
                a, b = find(root, v), find(root, met)
                if a == b:
                    continue
                if age[a] < age[b]:
                    a, b = b, a
                if birth[a] >= 0 and birth[a] != v:
                    partner[birth[a]], partner[v] = v, birth[a]
                root[a] = b
    return partner
