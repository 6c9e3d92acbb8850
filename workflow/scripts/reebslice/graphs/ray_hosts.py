"""The outer contour around each event of a hole, by one ray.

At an event of a hole the contour around it does not touch the vertex, so it is
one arc of the surface's Reeb graph that passes there. A sweep upward knows the
arc of every mesh edge that crosses the level (:mod:`..morse.face_arcs`); when
it comes to the vertex, a ray in the plane of the level tells around which
contours the vertex lies: those that it crosses more often outward than inward.
Of these the host is the outer contour that the ray leaves first for good.

The plane is tilted infinitesimally, as the order of ranks says, and runs right
below the vertex. Copies of an unfolded saddle share one point, which contours
of other copies touch; there the ray starts amid a segment of the event's own
contour that is off this point. Whatever a ray decides by coordinates is either
certain, whatever rounding did, or left to :mod:`.exact_rays`.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import list_incidence
from ..kernels import njit
from ..morse.face_arcs import arc_at, pass_node
from ..morse.ordered_mesh import cross_at, next_half_edge
from .face_grid import build_grid, find_candidates

# Direction of all rays: parallel to no line through few points of a lattice.
TURN = 0.8765432101234567, 0.4813349876543211
# Of the largest coordinate: offsets and distances along a ray, with what a crossing is off its place, err by less.
ROUNDING = 128 * np.finfo(float).eps
DONE, DOUBT, ODD = 0, 1, 2
UNSURE = 2


class RayHosts(NamedTuple):
    """What rays found of K critical points, and what they left open at D of them.

    Attributes
    ----------
    host : (K,) int32
        The arc around each event of a hole; -1 at other events, and where it is open.
    odd : bool
        Whether what a ray crosses fits no solid; nothing else is then to be used.
    doubtful : (D,) int64
        Places in `graph.nodes` where rounding leaves the answer open, ascending.
    start : (D + 1,) int64
        The d-th of them owns ``face[start[d]:start[d + 1]]`` and as many arcs.
    face, arc : (F,) int64
        All faces that the level there crosses, of the same body, and the arc of the contour in each.
    """

    host: np.ndarray
    odd: bool
    doubtful: np.ndarray
    start: np.ndarray
    face: np.ndarray
    arc: np.ndarray


class _Scene(NamedTuple):
    """What all rays need; offset : (n,) of the vertices from a line along the rays; rounding : mesh units."""

    mesh: tuple
    graph: tuple
    body: np.ndarray
    inner: np.ndarray
    offset: np.ndarray
    grid: tuple
    rounding: float


class _Marks(NamedTuple):
    """Of every arc, by the ray at hand: whether it is met, crossings outward less inward, bounds of the last one."""

    met: np.ndarray
    winding: np.ndarray
    near: np.ndarray
    far: np.ndarray


def shoot_rays(mesh, graph, into, inner, wanted, body_of_vertex):
    """Find the outer contour around each wanted event of a hole.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices whose saddles are simple.
    graph : ReebGraph
        The mesh's, of K nodes and A arcs.
    into : (n, 2) int32
        Of the mesh's :class:`.contour_trees.Gates`.
    inner : (A,) bool
        Whether each arc is a hole.
    wanted : (K,) bool
        The events.
    body_of_vertex : (n,) int32
        Only contours of the event's own body count.

    Returns
    -------
    RayHosts
    """
    if not wanted.any():
        nothing = np.empty(0, np.int64)
        return RayHosts(np.full(len(wanted), -1, np.int32), False, nothing, np.zeros(1, np.int64), nothing, nothing)
    offset = TURN[0] * mesh.points[:, 1] - TURN[1] * mesh.points[:, 0]
    rounding = ROUNDING * np.abs(mesh.points).max()
    grid = build_grid(mesh.faces, offset, 4 * rounding)
    scene = _Scene(mesh, graph, body_of_vertex, inner, offset, grid, rounding)
    return RayHosts(*_sweep(scene, into, list_incidence(graph.arcs, len(graph.nodes)), wanted))


@njit
def _sweep(scene, into, incident, wanted):
    """Columns of :class:`RayHosts`, by the sweep of :mod:`..morse.face_arcs`."""
    mesh, graph = scene.mesh, scene.graph
    n, n_arcs = len(mesh.points), len(graph.arcs)
    root, label = np.arange(n_arcs).astype(np.int32), np.full(3 * len(mesh.faces), np.int32(-1))
    begin, host = np.empty(n, np.int32), np.full(len(graph.nodes), np.int32(-1))
    marks = _Marks(np.zeros(n_arcs, np.bool_), np.zeros(n_arcs, np.int32), np.empty(n_arcs), np.empty(n_arcs))
    met, crossed = np.empty(n_arcs, np.int32), np.empty(len(scene.grid.face), np.int32)
    doubtful, start = [np.int64(0) for _ in range(0)], [np.int64(0)]
    face, arc = [np.int64(0) for _ in range(0)], [np.int64(0) for _ in range(0)]
    place, odd = 0, False
    for v in range(n):
        if place == len(graph.nodes) or graph.nodes[place] != v:
            begin[v] = arc_at(mesh.faces, root, label, begin, np.int64(into[v, 0]))
            continue
        if wanted[place]:
            outcome, host[place] = _shoot(scene, (root, label, begin), place, into[v, 0], marks, (met, crossed))
            if outcome == ODD:
                odd = True
                break
            if outcome == DOUBT:
                _list_crossed(scene, (root, label, begin), v, face, arc)
                doubtful.append(np.int64(place))
                start.append(np.int64(len(face)))
        begin[v] = pass_node(mesh, graph, incident, place, root, label)
        place += 1
    return host, odd, np.array(doubtful), np.array(start), np.array(face), np.array(arc)


@njit(inner=True)
def _list_crossed(scene, state, v, face, arc):
    """Append all faces of the body of v that the level right below it crosses, and their arcs."""
    faces, (root, label, begin) = scene.mesh.faces, state
    for f in range(len(faces)):
        if faces[f, 0] >= v:
            break
        if max(faces[f, 1], faces[f, 2]) >= v and scene.body[faces[f, 0]] == scene.body[v]:
            _, rising = _crossed_sides(faces, f, v)
            face.append(np.int64(f))
            arc.append(np.int64(arc_at(faces, root, label, begin, rising)))


@njit(inline="always")
def _crossed_sides(faces, f, cut):
    """The sides of a face through which the contour at a cut comes in and leaves: one falls, the other rises."""
    falling, rising = np.int64(-1), np.int64(-1)
    for k in range(3):
        tail, head = faces[f, k] >= cut, faces[f, (k + 1) % 3] >= cut
        if tail and not head:
            falling = np.int64(3 * f + k)
        elif head and not tail:
            rising = np.int64(3 * f + k)
    return falling, rising


@njit(inline="always")
def _cross_side(points, faces, h, v):
    """Where a half-edge crosses the plane through vertex v: x, y."""
    one, other = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
    low, high = min(one, other), max(one, other)
    return cross_at(points[low], points[high], points[v, 2], points[v, 0], points[v, 1])


@njit(inner=True)
def _find_start(scene, v, gate):
    """A point of a contour at event v, from which a ray starts, and whether there is one.

    Of an unfolded saddle it is the middle of a segment that is off its point and has some length.
    """
    points, faces, twins, vertex = scene.mesh.points, scene.mesh.faces, scene.mesh.twins, scene.mesh.vertex
    x, y = points[v, 0], points[v, 1]
    if vertex[v - 1] != vertex[v] and (v + 1 == len(vertex) or vertex[v + 1] != vertex[v]):
        return x, y, True
    h, away, px, py = np.int64(gate), False, x, y
    while True:
        low, high = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        if vertex[low] == vertex[v] or vertex[high] == vertex[v]:
            away = False
        else:
            qx, qy = _cross_side(points, faces, h, v)
            if away and abs(qx - px) + abs(qy - py) > 1024 * scene.rounding:
                return 0.5 * (px + qx), 0.5 * (py + qy), True
            away, px, py = True, qx, qy
        h = np.int64(next_half_edge(faces, twins, h, v))
        if h == gate:
            return x, y, False


@njit(inner=True)
def _shoot(scene, state, place, gate, marks, room):
    """Outcome and host of one event: a ray forward and, if that leaves it in doubt, backward."""
    v = np.int64(scene.graph.nodes[place])
    x, y, found = _find_start(scene, v, gate)
    if not found:
        return DOUBT, np.int32(-1)
    met, crossed = room
    offset = TURN[0] * y - TURN[1] * x
    count = find_candidates(scene.grid, len(scene.offset), v, offset, crossed)
    for way in (1.0, -1.0):
        outcome, n_met = _cross_faces(scene, state, place, (x, y, way), marks, (met, crossed[:count]))
        host = np.int32(-1)
        if outcome == DONE:
            outcome, host = _choose_host(scene, marks, met[:n_met])
        for arc in met[:n_met]:
            marks.met[arc] = False
        if outcome != DOUBT:
            break
    return outcome, host


@njit(inner=True)
def _cross_faces(scene, state, place, ray, marks, room):
    """Cross faces one by one; the outcome, and how many arcs are met. ray : its start, and 1.0 forward, -1.0 back."""
    faces, points, offset = scene.mesh.faces, scene.mesh.points, scene.offset
    body, rounding = scene.body, scene.rounding
    arcs, (root, label, begin), (x, y, way), (met, crossed) = scene.graph.arcs, state, ray, room
    v, n_met = np.int64(scene.graph.nodes[place]), 0
    aside, margin = TURN[0] * y - TURN[1] * x, 4 * rounding
    for f in crossed:
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        if a >= v or max(b, c) < v or body[a] != body[v]:
            continue
        one, two, three = offset[a], offset[b], offset[c]
        if max(one, two, three) < aside - margin or min(one, two, three) > aside + margin:
            continue
        falling, rising = _crossed_sides(faces, np.int64(f), v)
        px, py = _cross_side(points, faces, falling, v)
        qx, qy = _cross_side(points, faces, rising, v)
        sign, distance, error = _cross_ray(way * (px - x), way * (py - y), way * (qx - x), way * (qy - y), rounding)
        if sign == 0:
            continue
        arc = arc_at(faces, root, label, begin, rising)
        if arcs[arc, 1] == place:
            continue  # a contour of the event's own
        if sign == UNSURE:
            return DOUBT, n_met
        if not marks.met[arc]:
            marks.met[arc], marks.winding[arc], marks.near[arc], marks.far[arc] = True, 0, -np.inf, -np.inf
            met[n_met] = arc
            n_met += 1
        marks.winding[arc] += sign
        marks.near[arc] = max(marks.near[arc], distance - error)
        marks.far[arc] = max(marks.far[arc], distance + error)
    return DONE, n_met


@njit(inner=True)
def _cross_ray(px, py, qx, qy, rounding):
    """How a segment crosses a ray that starts at the origin: sign, distance, and the most that this errs by.

    1 if it runs to the left, -1 if to the right, 0 if it does not cross the ray, UNSURE where rounding hides it.
    """
    pt, qt = TURN[0] * px + TURN[1] * py, TURN[0] * qx + TURN[1] * qy  # forward along the ray
    ps, qs = TURN[0] * py - TURN[1] * px, TURN[0] * qy - TURN[1] * qx  # aside from it, to the left
    if max(pt, qt) < -rounding:
        return 0, 0.0, 0.0
    if abs(ps) <= rounding or abs(qs) <= rounding:
        return UNSURE, 0.0, 0.0
    if (ps > 0) == (qs > 0):
        return 0, 0.0, 0.0
    turn = pt * qs - ps * qt
    if abs(turn) <= 2 * rounding * (abs(pt) + abs(ps) + abs(qt) + abs(qs)):
        return UNSURE, 0.0, 0.0
    if (turn > 0) != (qs > 0):
        return 0, 0.0, 0.0  # behind the start
    return (1 if qs > 0 else -1), turn / (qs - ps), 4 * rounding * (1 + abs(qt - pt) / abs(qs - ps))


@njit(inner=True)
def _choose_host(scene, marks, met):
    """Outcome and host: of the outer contours around the start the one that the ray leaves first for good."""
    best, total = np.int32(-1), 0
    for arc in met:
        winding = marks.winding[arc]
        total += winding
        if winding == 0:
            continue
        if winding != (-1 if scene.inner[arc] else 1):
            return ODD, np.int32(-1)
        if winding > 0 and (best < 0 or marks.far[arc] < marks.far[best]):
            best = arc
    if total != 1 or best < 0:
        return ODD, np.int32(-1)
    for arc in met:
        if arc != best and marks.winding[arc] > 0 and marks.near[arc] <= marks.far[best]:
            return DOUBT, np.int32(-1)
    return DONE, best
