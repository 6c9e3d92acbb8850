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
from .rings import (
    Rings,
    begin_ring,
    cut_after,
    insert_after,
    join,
    label_of,
    no_rings,
    remove,
    replace,
)
from .strips import Strips, enter_face, lay_strips, leave_face
from .surface import MeshEdges, Ranked


class State(NamedTuple):
    """What the sweep holds.

    body : (m,) int32 of each face; of_vertex : (n,) a face of each; by_high : (m,) faces by their highest corners
    """

    surface: Ranked
    sides: MeshEdges
    rings: Rings
    strips: Strips
    body: np.ndarray
    of_vertex: np.ndarray
    by_high: np.ndarray
    hits: Hits


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
    state, arcs = _begin(surface, sides, np.zeros(len(surface.corners)) if body is None else body)
    count, looks, odd = _sweep(state, arcs, np.full((0 if body is not None else 1, 2), -1, np.int64))
    looks = looks[: 0 if body is None else None]
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
    order = np.argsort(cut, kind="stable")
    _, found, _ = _sweep(*_begin(surface, sides, body), np.column_stack([cut, face]).astype(np.int64)[order])
    question, faces, labels = found.reshape(-1, 3).T
    ends = np.searchsorted(question, np.arange(len(cut) + 1))
    groups = [(faces[a:b], labels[a:b]) for a, b in zip(ends[:-1].tolist(), ends[1:].tolist())]
    return [groups[k] for k in np.argsort(order).tolist()]


def _begin(surface, sides, body):
    """The state before the sweep, and arcs of which nothing is known."""
    of_vertex = np.empty(len(surface.points), np.int32)
    of_vertex[surface.corners] = np.arange(len(surface.corners), dtype=np.int32)[:, None]
    by_high = np.argsort(surface.corners[:, 2], kind="stable").astype(np.int32)
    most = int(np.maximum(surface.changes[surface.index >= 0] // 2, 1).sum())
    arcs = Arcs(*(np.full(most, fill, np.int32) for fill in (-1, -1, 0, -1, -1)))
    body, rings, strips = np.ascontiguousarray(body, np.int32), no_rings(len(sides.lower)), lay_strips(surface)
    hits = no_hits(int(np.diff(strips.start).max()) + 2 * SEEN, most)
    return State(surface, sides, rings, strips, body, of_vertex, by_high, hits), arcs


@njit
def _sweep(state, arcs, asked):
    """Fill in the arcs: their number, what is in doubt as rows of arc, cut and faces, and whether any look is odd.

    Or answer what is asked, (q, 2) cuts, ascending, and faces, instead of looking: rows of question, face and arc.
    """
    surface, sides, rings = state.surface, state.sides, state.rings
    question, left, count, odd = 0, 0, 0, False
    doubts, reach = [np.int64(0) for _ in range(0)], np.abs(surface.points).max()
    for v in range(len(surface.points)):
        while question < len(asked) and asked[question, 0] == v:
            _list_strips(state, doubts, question, asked[question, 1])
            question += 1
        edges, mixed = _walk_around(state, v, state.of_vertex[v])
        critical = surface.index[v] >= 0
        if critical and v > 0:
            level = level_below(surface.points, v, reach)
            for edge in edges:
                if sides.upper[edge] == v:
                    arc = np.int64(label_of(rings, edge))
                    if arcs.high[arc] < 0:
                        arcs.high[arc] = v
                        if len(asked) == 0:
                            odd |= _look(state, level, arcs, doubts, arc, edge)
        _pass_vertex(rings, sides, v, edges, mixed)
        left = _pass_faces(state, v, left)
        if critical and v + 1 < len(surface.points):
            first, level = count, level_below(surface.points, v + 1, reach)
            for edge in edges:
                if sides.lower[edge] == v and not first <= label_of(rings, edge) < count:
                    rings.label[edge], arcs.low[count] = count, v
                    count += 1
            done = first
            for edge in edges:
                if sides.lower[edge] == v and label_of(rings, edge) == done and len(asked) == 0:
                    odd |= _look(state, level, arcs, doubts, np.int64(done), edge)
                    done += 1
    return count, np.array(doubts), odd


@njit
def _pass_faces(state, v, left):
    """Put the faces that begin at a vertex into the strips, and take out those that end; left : how many had ended."""
    corners, by_high = state.surface.corners, state.by_high
    for face in range(np.searchsorted(corners[:, 0], v), np.searchsorted(corners[:, 0], v + 1)):
        enter_face(state.strips, face)
    while left < len(by_high) and corners[by_high[left], 2] == v:
        leave_face(state.strips, by_high[left])
        left += 1
    return left


@njit
def _list_strips(state, found, question, face):
    """Append the faces of one body with a face that share a strip with it, and their contours."""
    strips = state.strips
    for strip in range(strips.first[face, 0], strips.first[face, 1] + 1):
        for place in range(strips.start[strip], strips.start[strip] + strips.count[strip]):
            other = strips.member[place]
            if state.body[other] == state.body[face] and strip == max(strips.first[other, 0], strips.first[face, 0]):
                found.append(np.int64(question))
                found.append(np.int64(other))
                found.append(np.int64(label_of(state.rings, state.sides.of_face[other, 2])))


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


@njit
def _walk_around(state, v, face):
    """Mesh edges (k,) around a vertex, counter-clockwise, and what lies between each and the next one.

    That is, where one leads up and the other down, the mesh edge across from the vertex, else -1.
    """
    corners, of_face, start = state.surface.corners, state.sides.of_face, face
    edges, mixed = [np.int32(0) for _ in range(0)], [np.int32(0) for _ in range(0)]
    while True:
        ab, bc, ac = of_face[face]
        a, b, _ = corners[face]
        one, two = (ab, ac) if v == a else (bc, ab) if v == b else (ac, bc)
        if not state.surface.even[face]:
            one, two = two, one
        edges.append(one)
        mixed.append(ac if v == b else np.int32(-1))
        face = state.sides.faces[two, 0] if state.sides.faces[two, 0] != face else state.sides.faces[two, 1]
        if face == start:
            return np.array(edges), np.array(mixed)


@njit
def _pass_vertex(rings, sides, v, edges, mixed):
    """Raise the level above a vertex."""
    count = len(edges)
    ends = [k for k in range(count) if mixed[k] >= 0 and sides.upper[edges[k]] == v]  # of the runs that lead down
    if len(ends) == 0:
        if sides.lower[edges[0]] == v:
            begin_ring(rings, edges[count - 1])
            for k in range(count - 1, 0, -1):
                insert_after(rings, edges[k], edges[k - 1])
        return
    starts = [k - 1 for k in range(count) if sides.upper[edges[k]] == v and mixed[k - 1] >= 0]  # before each such run
    if len(ends) == 1:
        _replace_run(rings, edges, starts[0] % count, ends[0])
    else:
        _cut_runs(rings, sides, v, edges, mixed)


@njit
def _replace_run(rings, edges, before, end):
    """Replace the run of edges from after `before` to `end` by the others, those from `before` backward."""
    count = len(edges)
    n_down = (end - before) % count
    n_up, place = count - n_down, np.int32(-1)
    for k in range(max(n_down, n_up)):
        down, up = edges[(before + 1 + k) % count], edges[(before - k) % count]
        if k < n_down and k < n_up:
            replace(rings, down, up)
        elif k < n_down:
            remove(rings, down)
        else:
            insert_after(rings, place, up)
        place = up


@njit
def _cut_runs(rings, sides, v, edges, mixed):
    """Cut contours open at a saddle, and join what is left the other way around."""
    count, cut = len(edges), [np.int64(-1)]
    befores, labels = [np.int32(0) for _ in range(0)], [np.int64(0) for _ in range(0)]
    for k in range(count):
        if sides.upper[edges[k]] == v and mixed[k - 1] >= 0:
            befores.append(mixed[k - 1])
            labels.append(np.int64(label_of(rings, edges[k])))
    for edge in edges:
        if sides.upper[edge] == v:
            remove(rings, edge)
    for k in range(len(befores)):
        cut_after(rings, befores[k], labels[k] not in cut)
        cut.append(labels[k])
    for k in range(count):
        if sides.lower[edges[k]] == v and mixed[k] >= 0:  # the last of a run that leads up
            place, j = mixed[k], k
            while sides.lower[edges[j]] == v:
                insert_after(rings, place, edges[j])
                place, j = edges[j], j - 1
            join(rings, place, mixed[j])
