"""The Reeb graphs of a surface and of the solid that it bounds, by a sweep that keeps the contours of a moving level.

A level rises through the vertices, one after the other. Its contours are cyclic sequences of the mesh edges that it
crosses (:mod:`.rings`). A regular vertex takes a run of them out of one contour and puts another run in; a saddle cuts
contours open and joins what is left otherwise; an extremum begins or ends one. So each contour is an arc of the
surface's graph from the critical vertex where it came about to the one where it ends. Right after that the contour is
looked at, and right before (:mod:`.hosts`): whether it is a hole, and then which contour is around it.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .hosts import DOUBTFUL, ODD, OUTER, SEEN, TRIES, Hits, level_below, list_places, look_along, no_hits
from .rings import Rings, label_of, no_rings
from .strips import Mesh, Strips, enter_face, lay_strips, leave_face
from .vertex_passes import pass_vertex, walk_around


class State(NamedTuple):
    """What the sweep holds and looks at."""

    mesh: Mesh
    rings: Rings
    strips: Strips
    hits: Hits


class Order(NamedTuple):
    """What the sweep goes through.

    critical : (n,) bool of each vertex; upper : (E,) upper end of each mesh edge; of_vertex : (n,) a face of each;
    by_high : (m,) faces in order of their highest corners
    """

    critical: np.ndarray
    upper: np.ndarray
    of_vertex: np.ndarray
    by_high: np.ndarray


class Arcs(NamedTuple):
    """Arcs of the surface's graph, A of them.

    low, high : (A,) ranks of the critical vertices at their ends
    kind : (A,) hosts.OUTER or HOLE, 0 where rounding leaves it open
    above_low, below_high : (A,) the arc around a hole right above its lower end, right below its upper end, or -1
    """

    low: np.ndarray
    high: np.ndarray
    kind: np.ndarray
    above_low: np.ndarray
    below_high: np.ndarray


class Doubts(NamedTuple):
    """Looks that rounding left open, and whether any told of a hole without a contour around.

    arc, cut : (q,) the arc, and the level at which it was to be looked at
    face : (q, hosts.TRIES) faces of its contour there, -1 for none
    odd : bool
    """

    arc: np.ndarray
    cut: np.ndarray
    face: np.ndarray
    odd: bool


def sweep_surface(surface, sides, body=None):
    """Sweep a surface.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
        Closed, each vertex with one link.
    body : (m,) int, optional
        Body of each face, in their order in `surface`; if not given, contours are not looked at.

    Returns
    -------
    arcs : Arcs
    doubts : Doubts
    """
    count, looks, odd, arcs = _run_sweep(surface, sides, body, np.empty((0, 2), np.int64))
    looks = looks.reshape(-1, 2 + TRIES)
    return Arcs(*(column[:count] for column in arcs)), Doubts(looks[:, 0], looks[:, 1], looks[:, 2:], bool(odd))


def list_neighbours(surface, sides, body, cut, face):
    """List the faces that a line along x through some faces may meet.

    Parameters
    ----------
    surface, sides, body
        As for :func:`sweep_surface`.
    cut, face : (q,) int
        Faces, and levels that they meet.

    Returns
    -------
    list of (faces, labels)
        Of each question two (k,) arrays: faces of the same body that meet the level, and the arcs of their contours.
    """
    if not len(cut):
        return []  # a sweep that is asked nothing looks at all contours
    order = np.argsort(cut, kind="stable")
    found = _run_sweep(surface, sides, body, np.column_stack([cut, face]).astype(np.int64)[order])[1]
    question, faces, labels = found.reshape(-1, 3).T
    ends = np.searchsorted(question, np.arange(len(cut) + 1))
    groups = [(faces[a:b], labels[a:b]) for a, b in zip(ends[:-1].tolist(), ends[1:].tolist())]
    return [groups[k] for k in np.argsort(order).tolist()]


def _run_sweep(surface, sides, body, asked):
    """What :func:`_sweep` returns, and the arcs."""
    of_vertex = np.empty(len(surface.points), np.int32)
    of_vertex[surface.corners] = np.arange(len(surface.corners), dtype=np.int32)[:, None]
    by_high = np.argsort(surface.corners[:, 2], kind="stable").astype(np.int32)
    most = int(np.maximum(surface.changes[surface.index >= 0] // 2, 1).sum())
    arcs = Arcs(*(np.full(most, fill, np.int32) for fill in (-1, -1, 0, -1, -1)))
    own = np.zeros(len(surface.corners), np.int32) if body is None else np.ascontiguousarray(body, np.int32)
    mesh, rings = Mesh(surface.points, surface.corners, surface.even, *sides[2:4], own), no_rings(len(sides.lower))
    order, state = Order(surface.index >= 0, sides.upper, of_vertex, by_high), None
    if body is not None:
        strips = lay_strips(surface)
        state = State(mesh, rings, strips, no_hits(int(np.diff(strips.start).max()) + 2 * SEEN, most))
    return *_sweep(mesh, rings, order, arcs, state, asked), arcs


@njit
def _sweep(mesh, rings, order, arcs, state, asked):
    """Fill in the arcs: their number, what is in doubt as rows of arc, cut and faces, and whether any look is odd.

    Or answer what is asked, (q, 2) cuts, ascending, and faces, instead of looking: rows of question, face and arc.
    Without a `state`, which numba leaves out of what it compiles then, the contours are followed alone.
    """
    upper, points = order.upper, mesh.points
    question, left, count, odd = 0, np.int64(0), 0, False
    doubts, reach = [np.int64(0) for _ in range(0)], np.abs(points).max()
    for v in range(len(points)):
        if state is not None:
            while question < len(asked) and asked[question, 0] == v:
                _list_strips(state, doubts, question, asked[question, 1])
                question += 1
        edges, mixed = walk_around(mesh, v, order.of_vertex[v])
        ended = [edge for edge in edges if upper[edge] == v and order.critical[v]]
        for edge in ended:
            arc = np.int64(label_of(rings, edge))
            if arcs.high[arc] < 0:
                arcs.high[arc] = v
                if state is not None:
                    level = level_below(points, v, reach)
                    odd |= len(asked) == 0 and _look(state, level, arcs, doubts, arc, edge)
        pass_vertex(rings, upper, v, edges, mixed)
        if state is not None:
            left = _pass_faces(state, order.by_high, v, left)
        begun, first = [edge for edge in edges if upper[edge] != v and order.critical[v]], count
        count = _begin_arcs(rings, arcs, v, begun, first)
        if state is not None:
            for edge in begun:
                if first < count and label_of(rings, edge) == first and len(asked) == 0:
                    odd |= _look(state, level_below(points, v + 1, reach), arcs, doubts, np.int64(first), edge)
                    first += 1
    return count, np.array(doubts), odd


@njit(inner=True)
def _begin_arcs(rings, arcs, v, edges, count):
    """Begin an arc with each contour that some edges at a vertex cross; count : arcs before; returns those after."""
    first = count
    for edge in edges:
        if not first <= label_of(rings, edge) < count:
            rings.label[edge], arcs.low[count] = count, v
            count += 1
    return count


@njit(inner=True)
def _pass_faces(state, by_high, v, left):
    """Put the faces that begin at a vertex into the strips, and take out those that end; left : how many had ended."""
    corners = state.mesh.corners
    for face in range(np.searchsorted(corners[:, 0], v), np.searchsorted(corners[:, 0], v + 1)):
        enter_face(state.strips, face)
    while left < len(by_high) and corners[by_high[left], 2] == v:
        leave_face(state.strips, by_high[left])
        left += 1
    return left


@njit(inner=True)
def _list_strips(state, found, question, face):
    """Append the faces of one body with a face that share a strip with it, and their contours."""
    strips, body = state.strips, state.mesh.body
    for strip in range(strips.first[face, 0], strips.first[face, 1] + 1):
        for place in range(strips.start[strip], strips.start[strip] + strips.count[strip]):
            other = strips.member[place]
            if body[other] == body[face] and strip == max(strips.first[other, 0], strips.first[face, 0]):
                found.append(np.int64(question))
                found.append(np.int64(other))
                found.append(np.int64(label_of(state.rings, state.mesh.of_face[other, 2])))


@njit
def _look(state, level, arcs, doubts, arc, edge):
    """Look at the contour of an arc that passes an edge; returns whether what is seen contradicts itself."""
    ends = arcs.high[arc] == level.cut
    if ends and arcs.kind[arc] == OUTER:
        return False
    answer, kind, host = DOUBTFUL, 0, -1
    faces, own = list_places(state, edge)
    if level.height == level.height:
        for face in faces[faces >= 0]:
            answer, kind, host = look_along(state, level, face, arc, own)
            if answer != DOUBTFUL:
                break
    if answer == DOUBTFUL:
        doubts.append(arc)
        doubts.append(np.int64(level.cut))
        for k in range(TRIES):
            doubts.append(np.int64(faces[k]))
        return False
    return note_look(arcs, arc, level.cut, kind, host) or answer == ODD


@njit
def note_look(arcs, arc, cut, kind, host):
    """Note what a look at the level `cut` told of an arc; returns whether it contradicts what is known."""
    contradicts = arcs.kind[arc] != 0 and arcs.kind[arc] != kind
    arcs.kind[arc] = kind
    if cut == arcs.high[arc]:
        arcs.below_high[arc] = host
    if cut == arcs.low[arc] + 1:
        arcs.above_low[arc] = host
    return contradicts
