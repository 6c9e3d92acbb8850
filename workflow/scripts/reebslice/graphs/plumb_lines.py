"""The first face above or below vertices, along plumb lines, exact.

A line runs beside its vertex, by infinitesimals e in x and e^2 in y
(simulation of simplicity), so it meets no vertex and no mesh edge, and no face
that is upright. Which faces it meets, and on which side of each the vertex is,
are signs of determinants of the given coordinates (:mod:`..mesh.exact_signs`);
the infinitesimal tilt of heights shears space along plumb lines and changes
none of them. Which of two faces is the nearer one follows from bounds of the
two distances, or is decided in rational numbers (:mod:`.exact_lines`).

The lines are held in strips of equally many along x, sorted by y in each, and
every face looks up those in the box of what of it lies in each strip. So time
grows as the faces, the strips that they cross and the lines in these boxes,
and memory as the lines.
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from ..mesh.exact_signs import LINE_BOUND, PLANE_BOUND, ROOM, UNDERFLOW, side_sign, turn_sign

SPARE = 1e-14  # of the coordinates of a mesh edge's ends: more than interpolating between them is off
SLACK = 1e-15  # of a quotient: what dividing its bounds may be off


class LineHits(NamedTuple):
    """The first face that each of Q plumb lines meets.

    Attributes
    ----------
    face, rises : (Q,) int32 and (Q,) bool
        -1 where there is none; whether it looks upward.
    near, far : (Q,) float64
        Bounds of the distance to it, in the unit of the points.
    doubtful : (Q,) bool
        Whether rounding leaves open which of several faces is first; `face` is one of them, and the bounds hold
        for the first.
    winding : (Q,) int32
        How many more of all faces that the line meets look upward than downward.
    """

    face: np.ndarray
    rises: np.ndarray
    near: np.ndarray
    far: np.ndarray
    doubtful: np.ndarray
    winding: np.ndarray


class _Strips(NamedTuple):
    """Lines in strips of `width`, in order of y in each.

    left : (s,) first x of each strip; head : (c + 1,) first strip from each of c cells of equal width on, from `low`
    on `scale` cells a unit; x, y, vertex, upward : (Q,) of the lines
    """

    width: int
    left: np.ndarray
    low: float
    scale: float
    head: np.ndarray
    x: np.ndarray
    y: np.ndarray
    vertex: np.ndarray
    upward: np.ndarray


def meet_faces(points, faces, body_of_vertex, vertices, upward):
    """Find the first face on each plumb line.

    Parameters
    ----------
    points : (n, 3) float64
        Of :func:`.exact_signs.scale_points`, in order of rank; there may be further ones.
    faces : (m, 3) int32
        Ranks, the lowest of each face first.
    body_of_vertex : (n,) int32
        Only faces of the body of the line's vertex count.
    vertices : (Q,) int
        Where the lines begin: local minima of their surface where lines run down, local maxima where they run up.
    upward : (Q,) bool
        Which way each runs.

    Returns
    -------
    LineHits or None
        None where a face goes through a vertex.
    """
    if not len(vertices):
        return _no_hits(0)
    order, strips = _lay_strips(points, vertices, upward)
    touches, _, hits = _meet(points, faces, body_of_vertex, strips, False)
    if touches:
        return None
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    return LineHits(*(column[place] for column in hits))


def list_faces(points, faces, body_of_vertex, vertices, upward):
    """List all faces on plumb lines.

    Parameters
    ----------
    points, faces, body_of_vertex, vertices, upward
        As for :func:`meet_faces`.

    Returns
    -------
    list of Q lists of int
        Faces, in any order.
    """
    (order, strips), found = _lay_strips(points, vertices, upward), [[] for _ in vertices]
    listed = _meet(points, faces, body_of_vertex, strips, True)[1]
    for line, face in listed.reshape(-1, 2).tolist():
        found[order[line]].append(face)
    return found


def _lay_strips(points, vertices, upward):
    """The order of lines in strips, (Q,), and the strips, of which there are as many as lines in each."""
    count = len(vertices)
    width = max(1, int(np.sqrt(count)))
    x, y = points[vertices, 0], points[vertices, 1]
    by_x = np.argsort(x, kind="stable")
    strip = np.empty(count, np.int64)
    strip[by_x] = np.arange(count) // width
    order, left = np.lexsort((y, strip)), x[by_x[::width]]
    low, spread = left[0], left[-1] - left[0]
    scale = 4 * len(left) / spread if spread > 0 else 0.0
    cells = _cell_of(left, low, scale, 4 * len(left) + 1)
    head = np.searchsorted(cells, np.arange(4 * len(left) + 2))
    lines = (column[order] for column in (x, y, np.asarray(vertices, np.int64), upward))
    return order, _Strips(width, left, float(low), float(scale), head, *lines)


def _cell_of(x, low, scale, count):
    """Cells in which places are."""
    return np.clip((x - low) * scale, 0.0, count - 1.0).astype(np.int64)


@njit
def _meet(points, faces, body, strips, listing):
    """Whether any face goes through a vertex, lines and faces that they meet if asked, and else the hits."""
    work, hits = np.empty(ROOM), _no_hits(len(strips.x))
    touches, listed = False, [np.int64(0) for _ in range(0)]
    for f in range(len(faces)):
        a, b, c = np.int64(faces[f, 0]), np.int64(faces[f, 1]), np.int64(faces[f, 2])
        x0, x1 = _span(points[a, 0], points[b, 0], points[c, 0])
        y0, y1 = _span(points[a, 1], points[b, 1], points[c, 1])
        strip, highest = _first_strip(strips, x0), max(b, c)
        while strip < len(strips.left) and strips.left[strip] <= x1:
            end = min((strip + 1) * strips.width, len(strips.x))
            low, high = y0, y1
            if x0 < strips.left[strip] or (end < len(strips.x) and strips.left[strip + 1] < x1):
                low, high = _span_of_part(points, (a, b, c), strips, strip)
            line = _first_from(strips.y, strip * strips.width, end, low) - 1
            strip += 1
            while line + 1 < end and strips.y[line + 1] <= high:
                line += 1
                v, up = strips.vertex[line], strips.upward[line]
                if not (x0 <= strips.x[line] <= x1 and (highest > v if up else a < v) and body[a] == body[v]):
                    continue
                turn = _turn_around(points, a, b, c, v, work)
                if turn == 0:
                    continue
                side = side_sign(points, (a, b, c), v, work)
                touches |= side == 0
                if (side == turn) == up:
                    continue  # the face is on the other side of the vertex
                if listing:
                    listed.append(line)
                    listed.append(f)
                else:
                    _note_face(points, faces, strips, hits, line, f, turn)
    return touches, np.array(listed), hits


@njit
def _no_hits(count):
    """The hits of so many lines that have met no face yet."""
    near, far, winding = np.full(count, np.inf), np.full(count, np.inf), np.zeros(count, np.int32)
    return LineHits(
        np.full(count, np.int32(-1)), np.zeros(count, np.bool_), near, far, np.zeros(count, np.bool_), winding
    )


@njit(inline="always")
def _first_strip(strips, x):
    """The first strip that may hold lines from x on."""
    cell = int(min(max((x - strips.low) * strips.scale, 0.0), len(strips.head) - 2.0))
    return max(_first_from(strips.left, strips.head[cell], strips.head[cell + 1], x) - 1, 0)


@njit
def _note_face(points, faces, strips, hits, line, f, turn):
    """Note a face that a line meets, if it may be the first; turn : 1 if it looks upward, else -1."""
    hits.winding[line] += turn
    lowest, highest, known = faces[f, 0], max(faces[f, 1], faces[f, 2]), hits.face[line]
    if known >= 0:
        if strips.upward[line]:
            beyond = lowest >= max(faces[known, 1], faces[known, 2])
        else:
            beyond = highest <= faces[known, 0]
        if beyond:
            return
    near, far = _bound_distance(points, faces[f], strips.vertex[line])
    if far < hits.near[line]:
        hits.face[line], hits.rises[line], hits.doubtful[line] = f, turn > 0, False
        hits.near[line], hits.far[line] = near, far
    elif near <= hits.far[line]:
        hits.doubtful[line] = True
        hits.near[line], hits.far[line] = min(hits.near[line], near), min(hits.far[line], far)


@njit(inline="always")
def _span(a, b, c):
    """The least and the largest of three."""
    return min(a, b, c), max(a, b, c)


@njit(inner=True)
def _span_of_part(points, corners, strips, strip):
    """Bounds of y, wider by some roundings, of the part of a face within a strip."""
    left, low, high = strips.left[strip], np.inf, -np.inf
    right = strips.left[strip + 1] if strip + 1 < len(strips.left) else np.inf
    for k in range(3):
        one, two = corners[k], corners[(k + 1) % 3]
        if points[two, 0] < points[one, 0]:
            one, two = two, one
        x, y = points[one, 0], points[one, 1]
        run, rise = points[two, 0] - x, points[two, 1] - y
        if x <= right and points[two, 0] >= left:
            slack = SPARE * (abs(y) + abs(points[two, 1]))
            first = (left - x) / run if left > x else 0.0  # never 0 / 0: such an edge is in the strip
            last = (right - x) / run if right < points[two, 0] else 1.0
            low = min(low, y + min(first * rise, last * rise) - slack)
            high = max(high, y + max(first * rise, last * rise) + slack)
    return low, high


@njit(inline="always")
def _first_from(values, first, end, least):
    """The first place from `first` on, before `end`, where ascending values are not below `least`; else `end`."""
    while first < end:
        middle = (first + end) // 2
        if values[middle] < least:
            first = middle + 1
        else:
            end = middle
    return first


@njit
def _turn_around(points, a, b, c, v, work):
    """How a face turns around the plumb line beside v, seen from above: 1 or -1; 0 if the line passes by."""
    one = _turn(points, a, b, v, work)
    if one == 0 or _turn(points, b, c, v, work) != one or _turn(points, c, a, v, work) != one:
        return 0
    return one


@njit
def _turn(points, i, j, v, work):
    """On which side of a mesh edge the plumb line beside v is, seen from above; 0 if the edge is upright."""
    x, y = points[v, 0], points[v, 1]
    one, two = (points[i, 0] - x) * (points[j, 1] - y), (points[i, 1] - y) * (points[j, 0] - x)
    if one != 0 or two != 0:  # else a difference is 0 in each, and v exactly on the line of the edge
        if abs(one - two) > LINE_BOUND * (abs(one) + abs(two)) + UNDERFLOW:
            return 1 if one > two else -1
        sign = turn_sign(points, (i, j, v), 2, work)
        if sign != 0:
            return sign
    if points[i, 1] != points[j, 1]:
        return -1 if points[j, 1] > points[i, 1] else 1
    if points[i, 0] != points[j, 0]:
        return 1 if points[j, 0] > points[i, 0] else -1
    return 0


@njit
def _bound_distance(points, corners, v):
    """Bounds of the plumb distance of v from the plane of a face that is not upright.

    It is six times the volume of the tetrahedron over twice the area of the face seen from above.
    """
    a, b, c = corners
    ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
    wx, wy, wz = points[v, 0] - points[a, 0], points[v, 1] - points[a, 1], points[v, 2] - points[a, 2]
    area = ux * vy - uy * vx
    volume = abs(wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * area)
    spread = abs(ux * vy) + abs(uy * vx)
    terms = abs(wx) * (abs(uy * vz) + abs(uz * vy)) + abs(wy) * (abs(uz * vx) + abs(ux * vz)) + abs(wz) * spread
    off, rest = PLANE_BOUND * terms + UNDERFLOW, 2 * LINE_BOUND * spread + UNDERFLOW
    area = abs(area)
    least = max(volume - off, 0.0) / (area + rest) * (1 - SLACK)
    return least, (volume + off) / (area - rest) * (1 + SLACK) if area > rest else np.inf
