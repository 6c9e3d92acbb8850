"""Closed paths shortened, stretch by stretch, on a surface that is cut along circles."""

import heapq

import numpy as np

from ..arrays.grouping import Groups
from ..arrays.sorting import order_floats
from ..kernels import njit
from ..morse.ordered_mesh import next_half_edge
from .loop_paths import distance, drop_spurs

# Vertices that all searches together may visit: so many, or a share of the mesh's, if that is more.
LEAST_VISITS = 100_000
SHARE = 1 / 8
# Times that every path is gone through: at first from one circle to the next, then in at least so many stretches.
ROUNDS = 3
STRETCHES = 4


def shorten_paths(mesh, walked, first, cut):
    """Shorten closed paths, each of which crosses a circle of its own once.

    The mesh edges at which a path crosses circles are kept. Between them, stretch by stretch, it gives way to the
    shortest path along mesh edges that crosses no circle (A*: Hart, Nilsson and Raphael 1968), if that is shorter
    and found in time. As stretches have ends, what comes out is shorter, and not the shortest.

    Parameters
    ----------
    mesh : HeightMesh
    walked : Groups
        L closed paths of ranks.
    first, cut : (L,) int
        Of the circle of each path a half-edge that runs upward, and the number of vertices below it.

    Returns
    -------
    Groups
        As `walked`. Each path crosses the circles as it did before.
    """
    visits = max(LEAST_VISITS, int(SHARE * len(mesh.points)))
    return Groups(*_shorten(mesh, walked, np.asarray(first, np.int64), np.asarray(cut, np.int64), visits))


@njit
def _shorten(mesh, walked, first, cut, visits):
    """Kernel of `shorten_paths`; short paths have their turn first."""
    n, loops = len(mesh.points), len(first)
    blocked, leaving = np.zeros(len(mesh.twins), np.bool_), _leave_vertices(mesh.faces, n)
    for k in range(loops):
        _mark_circle(mesh, first[k], cut[k], blocked)
    search = np.full(n, -1, np.int64), np.empty(n), np.empty(n, np.int64), np.zeros(1, np.int64)
    found = [walked.member[walked.start[k] : walked.start[k + 1]] for k in range(loops)]
    length = np.array([_measure(mesh.points, np.append(path, path[:1])) for path in found])
    for turn, k in enumerate(order_floats(length)):
        left = visits // (loops - turn)
        visits -= left
        for round_ in range(ROUNDS):
            found[k], left = _shorten_once(mesh, leaving, blocked, found[k], round_, left, search)
        visits += left
    start = np.zeros(loops + 1, np.int64)
    for k in range(loops):
        start[k + 1] = start[k] + len(found[k])
    member = np.empty(start[-1], np.int64)
    for k in range(loops):
        for i in range(len(found[k])):
            member[start[k] + i] = found[k][i]
    return start, member


@njit(inner=True)
def _leave_vertices(faces, n):
    """A half-edge that leaves each vertex, (n,) int64."""
    leaving = np.empty(n, np.int64)
    for h in range(3 * len(faces)):
        leaving[faces[h // 3, h % 3]] = h
    return leaving


@njit(inner=True)
def _mark_circle(mesh, first, cut, marked):
    """Mark the half-edges, both ways, that a contour crosses."""
    h = first
    while True:
        marked[h] = marked[mesh.twins[h]] = True
        h = np.int64(next_half_edge(mesh.faces, mesh.twins, h, cut))
        if h == first:
            break


@njit
def _measure(points, path):
    """Length of a path."""
    total = 0.0
    for k in range(1, len(path)):
        total += distance(points, path[k - 1], path[k])
    return total


@njit(inner=True)
def _shorten_once(mesh, leaving, blocked, path, round_, visits, search):
    """The closed path with each stretch as short as it can be, and the visits that are left."""
    stretch = _measure(mesh.points, path) / STRETCHES if round_ else np.inf
    turn = _turn(mesh, leaving, blocked, path) if round_ == 0 else len(path) * round_ // (STRETCHES * ROUNDS)
    path = np.concatenate((path[turn:], path[: turn + 1]))
    kept, begin = [path[0]], 0
    while begin < len(path) - 1:
        end, reach = begin, 0.0
        while end < len(path) - 1 and reach < stretch:
            if blocked[_half_edge(mesh, leaving, path[end], path[end + 1])]:
                break
            reach += distance(mesh.points, path[end], path[end + 1])
            end += 1
        if end > begin + 1:
            way, spent = _search(mesh, leaving, blocked, path[begin], path[end], reach, visits, search)
            visits -= spent
            kept.extend(way if len(way) else list(path[begin + 1 : end + 1]))
        else:
            end = begin + 1
            kept.append(path[end])
        begin = end
    return np.array(drop_spurs(kept)), visits


@njit
def _turn(mesh, leaving, blocked, path):
    """A place of a path at which it is about to cross a circle."""
    for place in range(len(path) - 1):
        if blocked[_half_edge(mesh, leaving, path[place], path[place + 1])]:
            return place
    return len(path) - 1


@njit(inner=True)
def _half_edge(mesh, leaving, tail, head):
    """The half-edge from one vertex to another."""
    faces, h = mesh.faces, leaving[tail]
    while faces[h // 3, (h % 3 + 1) % 3] != head:
        h = np.int64(mesh.twins[h // 3 * 3 + (h % 3 + 2) % 3])
    return h


@njit
def _search(mesh, leaving, blocked, source, goal, most, visits, search):
    """The shortest path, without its source, and how many vertices were visited.

    It is empty unless it is shorter than `most`. `search` has the last search to reach each vertex, its distance
    then and where from, and the number of searches.
    """
    points, faces, twins = mesh.points, mesh.faces, mesh.twins
    seen, away, came, count = search
    count[0] += 1
    seen[source], away[source], spent = count[0], 0.0, 0
    heap, here = [(distance(points, source, goal), source)], source
    while len(heap) > 0 and spent < visits and here != goal:
        bound, here = heapq.heappop(heap)
        spent, g = spent + 1, leaving[here]
        while here != goal:
            there = np.int64(faces[g // 3, (g % 3 + 1) % 3])
            far = away[here] + distance(points, here, there)
            if not blocked[g] and (seen[there] != count[0] or far < away[there]):
                bound = far + distance(points, there, goal)
                if bound < most * (1 - 1e-12):
                    seen[there], away[there], came[there] = count[0], far, here
                    heapq.heappush(heap, (bound, there))
            g = np.int64(twins[g // 3 * 3 + (g % 3 + 2) % 3])
            if g == leaving[here]:
                break
    way = [goal for _ in range(0)]
    while here == goal and goal != source:
        way.append(goal)
        goal = here = came[goal]
    return way[::-1], spent
