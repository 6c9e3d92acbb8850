"""What one line through a contour tells: whether the contour is outer or a hole, and which one is around a hole.

Right of the last point in which a line along x meets a contour is its outside, and material is on the left of it. So
it is outer if it goes towards greater y there, and a hole if it goes the other way. Right of that point of a hole is
the material around it. Of the contours that the line crosses from there on once more one way than the other, which
are those around that point, the innermost is the one that it leaves first for good; where that is an outer one, it
bounds the material.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .rings import label_of, raise_member
from .strips import ROUNDING, cross_face, strip_of

OUTER, HOLE = 1, 2
SURE, DOUBTFUL, ODD = 0, 1, 2
TRIES = 8  # places of a contour at which a line may cross it
SEEN = 64  # members of it, of which these are


class Level(NamedTuple):
    """A level: ranks from `cut` on are above it; the plane at `height`, NaN where no float is between."""

    cut: int
    height: float
    room: float


class Line(NamedTuple):
    """A line along x at `y`, of which the part from `start` on counts, through faces of a body, but for one contour."""

    y: float
    start: float
    body: int
    own: int


class Hits(NamedTuple):
    """Room for what a line meets, in any order: `x`, its `room`, the `way`, 1 or -1, and the `label` of each contour.

    turns, final : (A,) of each label, 0 and -1 between two looks
    """

    x: np.ndarray
    room: np.ndarray
    way: np.ndarray
    label: np.ndarray
    turns: np.ndarray
    final: np.ndarray


def no_hits(most, n_labels):
    """Make :class:`Hits` for lines that meet at most so many faces of contours with labels below `n_labels`."""
    kinds = np.float64, np.float64, np.int32, np.int32
    return Hits(
        *(np.empty(most, kind) for kind in kinds), np.zeros(n_labels, np.int32), np.full(n_labels, -1, np.int32)
    )


@njit(inner=True)
def level_below(points, cut, reach):
    """Choose the plane right below a rank; reach : the largest coordinate."""
    low, high = points[cut - 1, 2], points[cut, 2]
    height = low + (high - low) / 2
    return Level(cut, height if low < height < high else np.nan, ROUNDING * reach)


@njit
def list_places(state, x):
    """List some faces of the contour of a member, which becomes the root.

    Parameters
    ----------
    state : sweep.State
    x : int
        A mesh edge that the contour crosses.

    Returns
    -------
    places : (TRIES,) int32
        Faces that are not along one y, -1 for none.
    own : (k,) int32
        All its faces, or none of a contour that is longer than `SEEN`.
    """
    rings, faces, corners, points = state.rings, state.mesh.faces, state.mesh.corners, state.mesh.points
    raise_member(rings, x)
    nodes, places, own = np.empty(SEEN + 2, np.int32), np.full(TRIES, -1, np.int32), np.empty(2 * SEEN, np.int32)
    nodes[0], n_nodes, n_places, n_own, k = x, 1, 0, 0, 0
    while k < n_nodes <= SEEN:
        for face in faces[nodes[k]]:
            if state.mesh.of_face[face, 2] == nodes[k]:  # so each comes once
                own[n_own] = face
                n_own += 1
                a, b, c = corners[face]
                if n_places < TRIES and not points[a, 1] == points[b, 1] == points[c, 1]:
                    places[n_places] = face
                    n_places += 1
        for child in (rings.left[nodes[k]], rings.right[nodes[k]]):
            if child >= 0:
                nodes[n_nodes] = child
                n_nodes += 1
        k += 1
    return places, own[: n_own if n_nodes <= SEEN else 0]


@njit(inner=True)
def look_along(state, level, face, label, own):
    """Look along the line through the middle of the segment of a face.

    Parameters
    ----------
    state : sweep.State
    level : Level
    face : int
        Of the contour; faces of other bodies are passed over.
    label : int
        That of the contour.
    own : (k,) int
        All its faces, or none, if they are not known.

    Returns
    -------
    answer : int
        SURE, DOUBTFUL where rounding may turn something around, or ODD where no outer contour is around the hole.
    kind : int
        OUTER or HOLE.
    host : int
        Label of the contour around a hole, or -1.
    """
    strips, hits, body = state.strips, state.hits, state.mesh.body[face]
    _, y, _, end = cross_face(state.mesh, face, level.cut, level.height)
    if not abs(end - y) > 8 * level.room:
        return DOUBTFUL, 0, -1
    y, count, start = (y + end) / 2, 0, -np.inf
    if len(own):
        count = _meet_faces(state, level, Line(y, start, body, -1), own, 0, label)
        answer, kind, host = read_hits(hits, count, label) if count > 0 else (DOUBTFUL, 0, -1)
        if answer == DOUBTFUL or kind == OUTER:
            return answer, kind, host
        start, room = hits.x[:count].max(), hits.room[:count].max()  # the last crossing stands for all
        hits.x[0], hits.room[0], hits.way[0], hits.label[0], count = start, room, -1, label, 1
    strip = strip_of(strips, y)
    members = strips.member[strips.start[strip] : strips.start[strip] + strips.count[strip]]
    line = Line(y, start, body, label if count else -1)
    count = _meet_faces(state, level, line, members, count, -1)
    return read_hits(hits, count, label) if count > 0 else (DOUBTFUL, 0, -1)


@njit(inner=True)
def _meet_faces(state, level, line, members, count, known):
    """Note where a line meets faces, after `count` that are noted; how many then are, or -1 where rounding hides it.

    known : label of the contours of all, or -1.
    """
    mesh, hits, points, y = state.mesh, state.hits, state.mesh.points, line.y
    for face in members:
        a, b, c = mesh.corners[face]
        one, two, three = points[a, 1], points[b, 1], points[c, 1]
        if min(one, two, three) - level.room > y or max(one, two, three) + level.room < y:
            continue
        if mesh.body[face] != line.body or max(points[a, 0], points[b, 0], points[c, 0]) < line.start:
            continue
        px, py, qx, qy = cross_face(mesh, face, level.cut, level.height)
        if abs(py - y) <= level.room or abs(qy - y) <= level.room:
            return -1
        if (py < y) != (qy < y):
            label = known if known >= 0 else label_of(state.rings, state.mesh.of_face[face, 2])
            if label != line.own:
                hits.x[count], hits.way[count] = px + (y - py) / (qy - py) * (qx - px), 1 if qy > py else -1
                hits.room[count] = 8 * level.room * (1 + abs(qx - px) / max(abs(qy - py) - 2 * level.room, 1e-300))
                hits.label[count] = label
                count += 1
    return count


@njit
def read_hits(hits, count, own):
    """What the first `count` crossings of a line tell of the contour `own`: as of :func:`look_along`."""
    last = -1
    for k in range(count):
        if hits.label[k] == own and (last < 0 or hits.x[k] > hits.x[last]):
            last = k
    if _is_near(hits, count, last, True):
        return DOUBTFUL, 0, -1
    if hits.way[last] > 0:
        return SURE, OUTER, -1
    best = _find_innermost(hits, count, hits.x[last])
    if best < 0:
        return ODD, HOLE, -1
    if _is_near(hits, count, best, False):
        return DOUBTFUL, 0, -1
    return (SURE, HOLE, np.int64(hits.label[best])) if hits.way[best] > 0 else (ODD, HOLE, -1)


@njit(inner=True)
def _find_innermost(hits, count, start):
    """The last crossing of the innermost contour around a point, -1 for none."""
    turns, final = hits.turns, hits.final
    for k in range(count):
        if hits.x[k] > start:
            label = hits.label[k]
            turns[label] += hits.way[k]
            if final[label] < 0 or hits.x[k] > hits.x[final[label]]:
                final[label] = k
    best = -1
    for k in range(count):
        label = hits.label[k]
        if final[label] == k and turns[label] != 0 and (best < 0 or hits.x[k] < hits.x[best]):
            best = k
    for k in range(count):
        turns[hits.label[k]], final[hits.label[k]] = 0, -1
    return best


@njit(inner=True)
def _is_near(hits, count, one, itself):
    """Whether rounding may change the order of a crossing and another; of the same label only if `itself`."""
    for k in range(count):
        near = abs(hits.x[k] - hits.x[one]) <= hits.room[k] + hits.room[one]
        if k != one and near and (itself or hits.label[k] != hits.label[one]):
            return True
    return False
