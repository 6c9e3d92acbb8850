"""Regions of material at each level, and the blocks of solid between levels."""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from numba import njit
from scipy.sparse.csgraph import connected_components

from .exact_contours import ExactContours
from .pairing import find, join
from .slicing import measure_contours

# Of the largest coordinate: no crossing is computed further from its place. Interpolation
# takes a handful of operations, each of which errs by half of 2^-52.
ROUNDING = 64 * np.finfo(float).eps


class Regions(NamedTuple):
    """R regions, ordered by level and then by their outer contour.

    level : (R,) int32; outer : (R,) int32, the outer contour
    of_contour : (C,) int32, the region that each contour bounds
    inner : (C,) bool; parent : (C,) int32, smallest contour around it, or -1
    """

    level: np.ndarray
    outer: np.ndarray
    of_contour: np.ndarray
    inner: np.ndarray
    parent: np.ndarray


def find_regions(mesh, levels, contours, pieces, body):
    """The :class:`Regions` of a sliced surface.

    body : (C,) the body of each contour's shell. A hole belongs to the
    smallest outer contour around it of the same body, so bodies that overlap
    stay apart.
    """
    area, perimeter = measure_contours(contours)
    rounding = ROUNDING * np.abs(mesh.points).max()
    exact = ExactContours(mesh, levels, contours)
    inner = _inner_contours(exact, pieces, area, perimeter, rounding)
    parent, outer, unsure = _nest(
        contours.level, contours.start, contours.points, np.abs(area), perimeter, inner, body, rounding
    )
    _nest_exactly(exact, np.flatnonzero(unsure), contours.level, inner, body, parent, outer)
    for hole in np.flatnonzero(inner & (outer < 0)):
        outer[hole] = _nearest_outer(hole, contours.level, pieces, np.abs(area), inner, body)
        parent[hole] = outer[hole] if parent[hole] < 0 else parent[hole]
    head = np.where(inner & (outer >= 0), outer, np.arange(len(inner)))
    outers = np.flatnonzero(head == np.arange(len(head))).astype(np.int32)
    name = np.full(len(head), -1, np.int32)
    name[outers] = np.arange(len(outers), dtype=np.int32)
    return Regions(contours.level[outers], outers, name[head], inner, parent)


def _inner_contours(exact, pieces, area, perimeter, rounding):
    """Whether each contour is a hole: (C,) bool.

    Along a chain of cylinders an outer contour stays outer and a hole stays a
    hole, so the chain is decided at once, by its contour whose area is
    largest for its perimeter: rounding never turns a tiny contour around. A
    chain whose contours all enclose no more than rounding, as those inside
    flats do, is decided by its shortest contour in exact numbers.
    """
    chain = _cylinder_chains(pieces, len(area))
    certain = np.abs(area) > rounding * (perimeter + rounding)
    roundness = np.divide(area, perimeter**2, out=np.zeros_like(area), where=certain)
    order = np.lexsort((-np.diff(exact.contours.start), np.abs(roundness), chain))
    surest = order[np.flatnonzero(np.diff(chain[order], append=-1))]
    inner = np.zeros(len(area), bool)
    inner[chain[surest]] = [
        area[contour] < 0 if certain[contour] else exact.is_hole(contour) for contour in surest.tolist()
    ]
    return inner[chain]


def _nest_exactly(exact, unsure, level, inner, body, parent, outer):
    """Fill in `parent` and `outer` of the contours for which floats do not suffice."""
    for contour in unsure.tolist():
        first, end = np.searchsorted(level, [level[contour], level[contour] + 1])
        around = np.array(exact.around(contour, range(first, end)), np.int64)
        hosts = around[~inner[around] & (body[around] == body[contour])]
        parent[contour] = around[0] if len(around) else -1
        outer[contour] = hosts[0] if len(hosts) else -1


def _nearest_outer(hole, level, pieces, size, inner, body):
    """The outer contour for a hole that lies in none: (-1: there is none at its level).

    Only a surface that crosses itself has such holes. Taken is an outer
    contour that bounds the same piece, else the largest of the body.
    """
    others = np.flatnonzero((level == level[hole]) & ~inner & (body == body[hole]))
    if len(others) == 0:
        return -1
    joined = (pieces.above[others] == pieces.above[hole]) | (pieces.below[others] == pieces.below[hole])
    return int(others[np.lexsort((size[others], joined))[-1]])


def _cylinder_chains(pieces, n_contours):
    cylinder = (pieces.n_below == 1) & (pieces.n_above == 1) & (pieces.genus == 0)
    low = np.full(len(cylinder), -1, np.int64)
    low[pieces.above] = np.arange(n_contours)
    high = np.full(len(cylinder), -1, np.int64)
    high[pieces.below] = np.arange(n_contours)
    low, high = low[cylinder], high[cylinder]
    links = sparse.coo_array((np.ones(len(low), bool), (low, high)), shape=(n_contours, n_contours))
    return connected_components(links, directed=False)[1]


@njit(cache=True)
def _nest(level, start, points, size, perimeter, inner, body, rounding):
    """Smallest contour around each one, and smallest outer one of its body (-1: none), and which are unsure.

    Contours are disjoint, so a contour is tested by a point inside it, and
    what is around it is larger. Unsure is where that point is no further than
    rounding from the other contour, or the sizes differ by no more.
    """
    n = len(level)
    box = np.empty((n, 4))
    probe = np.empty((n, 2))
    for c in range(n):
        ring = points[start[c] : start[c + 1]]
        box[c, 0], box[c, 1] = ring[:, 0].min() - rounding, ring[:, 1].min() - rounding
        box[c, 2], box[c, 3] = ring[:, 0].max() + rounding, ring[:, 1].max() + rounding
        probe[c, 0], probe[c, 1] = _point_inside(ring)
    parent, outer, unsure = np.full(n, -1, np.int32), np.full(n, -1, np.int32), np.zeros(n, np.bool_)
    first = 0
    while first < n:
        end = first
        while end < n and level[end] == level[first]:
            end += 1
        around = first + np.argsort(size[first:end], kind="mergesort")
        for c in range(first, end):
            x, y = probe[c]
            for e in around:
                slack = rounding * (perimeter[c] + perimeter[e] + rounding)
                if e == c or size[e] < size[c] - slack:
                    continue
                if x < box[e, 0] or x > box[e, 2] or y < box[e, 1] or y > box[e, 3]:
                    continue
                same_body = body[e] == body[c] and not inner[e]
                if parent[c] >= 0 and not same_body:
                    continue
                encloses, near = _encloses(points[start[e] : start[e + 1]], x, y, rounding)
                if near or (encloses and size[e] <= size[c] + slack):
                    unsure[c] = True
                    break
                if encloses:
                    if parent[c] < 0:
                        parent[c] = e
                    if same_body:
                        outer[c] = e
                        break
        first = end
    return parent, outer, unsure


@njit(cache=True)
def _point_inside(ring):
    """The middle of the widest stretch inside a ring on a line halfway up.

    The line runs between two of its points' y, so it meets none of them. A
    ring that is all in one line gives the middle of its longest segment.
    """
    middle = 0.5 * (ring[:, 1].min() + ring[:, 1].max())
    low, high = -np.inf, np.inf
    for i in range(len(ring)):
        if ring[i, 1] <= middle:
            low = max(low, ring[i, 1])
        else:
            high = min(high, ring[i, 1])
    y = 0.5 * (low + high)
    hits = np.empty(len(ring))
    count = 0
    longest, x_longest, y_longest = -1.0, 0.0, 0.0
    for i in range(len(ring)):
        (px, py), (qx, qy) = ring[i - 1], ring[i]
        if (py > y) != (qy > y):
            hits[count] = px + (y - py) / (qy - py) * (qx - px)
            count += 1
        length = (qx - px) ** 2 + (qy - py) ** 2
        if length > longest:
            longest, x_longest, y_longest = length, 0.5 * (px + qx), 0.5 * (py + qy)
    stretches = np.sort(hits[:count])
    widest, x = 0.0, x_longest
    for i in range(0, count - 1, 2):
        if stretches[i + 1] - stretches[i] > widest:
            widest, x = stretches[i + 1] - stretches[i], 0.5 * (stretches[i] + stretches[i + 1])
    return x, (y if widest > 0.0 else y_longest)


@njit(cache=True, inline="always")
def _encloses(ring, x, y, rounding):
    """Whether a ring runs around (x, y), and whether it passes it within `rounding`."""
    inside = False
    px, py = ring[-1]
    for i in range(len(ring)):
        qx, qy = ring[i]
        if min(py, qy) <= y + rounding and max(py, qy) >= y - rounding and max(px, qx) >= x - rounding:
            ux, uy, vx, vy = qx - px, qy - py, x - px, y - py
            length = ux * ux + uy * uy
            along = min(max((ux * vx + uy * vy) / length, 0.0), 1.0) if length > 0.0 else 0.0
            if abs(along * ux - vx) <= rounding and abs(along * uy - vy) <= rounding:
                return inside, True
            if (py > y) != (qy > y) and (ux * vy > vx * uy) == (qy > py):
                inside = not inside
        px, py = qx, qy
    return inside, False


def find_blocks(pieces, contours, regions, unseen_host):
    """Blocks: the connected components of the solid in each slab.

    unseen_host : dict, for each closed void wholly inside a slab the piece
    whose block surrounds it. Returns (block of every piece (P,), block above
    and block below every region (R,), number of blocks); blocks are numbered
    by their first piece.
    """
    r, p = len(regions.level), len(pieces.slab)
    hosts = np.array(sorted(unseen_host.items()), np.int64).reshape(-1, 2)
    root = _join_blocks(r, p, regions.of_contour, pieces.above, pieces.below, hosts)
    _, block = np.unique(root, return_inverse=True)
    return tuple(part.astype(np.int32) for part in (block[:p], block[p : p + r], block[p + r :])) + (block.max() + 1,)


@njit(cache=True)
def _join_blocks(r, p, region, piece_above, piece_below, hosts):
    root = np.arange(p + 2 * r)
    for c in range(len(region)):
        join(root, p + region[c], piece_above[c])
        join(root, p + r + region[c], piece_below[c])
    for i in range(len(hosts)):
        join(root, hosts[i, 0], hosts[i, 1])
    for i in range(len(root)):
        root[i] = find(root, i)
    return root


def host_unseen_voids(mesh, levels, contours, pieces, body_of_vertex):
    """For each closed void wholly inside a slab, a piece of the block around it.

    Found by one point location: from the void's lowest vertex along +x to the
    first face of the same body. Returns {piece of void: piece of host}; a
    void that no face of its body is met from is left out.
    """
    hosts = {}
    closed = (pieces.n_below + pieces.n_above == 0) & (pieces.flux < 0)
    for piece in np.flatnonzero(closed):
        vertex = int(np.flatnonzero(pieces.of_vertex == piece)[0])
        face = _first_face_along_x(mesh.points, mesh.faces, vertex, body_of_vertex, pieces.of_vertex)
        if face >= 0:
            hosts[int(piece)] = _piece_of_face(mesh, levels, contours, pieces, face, int(pieces.slab[piece]) + 1)
    return hosts


@njit(cache=True)
def _first_face_along_x(points, faces, vertex, body, piece):
    """The first face of the vertex's body, but not of its piece, on a ray along +x from it; -1 for none."""
    x, y, z = points[vertex]
    best, best_x = -1, np.inf
    ends = np.empty((2, 2))
    for f in range(faces.shape[0]):
        a, b, c = faces[f]
        if points[a, 2] > z or max(points[b, 2], points[c, 2]) <= z or body[a] != body[vertex] or piece[a] == piece[vertex]:
            continue
        found = 0
        for p, q in ((points[a], points[b]), (points[b], points[c]), (points[c], points[a])):
            if (p[2] > z) != (q[2] > z):
                p, q = (p, q) if p[2] < q[2] else (q, p)
                share = (z - p[2]) / (q[2] - p[2])
                ends[found, 0], ends[found, 1] = p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
                found += 1
        (ax, ay), (bx, by) = ends
        if (ay > y) != (by > y):
            hit = ax + (y - ay) / (by - ay) * (bx - ax)
            if x < hit < best_x:
                best, best_x = f, hit
    return best


def _piece_of_face(mesh, levels, contours, pieces, face, slab):
    a, b, c = mesh.faces[face].tolist()
    below = int(np.searchsorted(levels.below, a, side="right"))
    if slab == below:
        return int(pieces.of_vertex[a])
    h = 3 * face if b > c else int(mesh.twins[3 * face + 2])
    return int(pieces.above[contours.label[contours.offset[h] + slab - 1 - below]])
