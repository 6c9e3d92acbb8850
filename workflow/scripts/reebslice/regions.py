"""Regions of material at each level, and the blocks of solid between levels."""

from typing import NamedTuple

import numpy as np
from numba import njit

from .components import connected_items
from .exact_contours import ExactContours
from .nesting import nest_contours
from .pairing import find, join
from .slicing import measure_contours

# Of the largest coordinate: no crossing is computed further from its place. Interpolation
# takes a handful of operations, each of which errs by half of 2^-52.
ROUNDING = 64 * np.finfo(float).eps


class Regions(NamedTuple):
    """R regions, ordered by level and then by their outer contour, and what it takes to find them.

    level : (R,) int32; outer : (R,) int32, the outer contour
    of_contour : (C,) int32, the region that each contour bounds
    inner : (C,) bool; parent : (C,) int32, smallest contour around it, or -1
    area, perimeter : (C,) float64, of the contours, areas of holes negative
    """

    level: np.ndarray
    outer: np.ndarray
    of_contour: np.ndarray
    inner: np.ndarray
    parent: np.ndarray
    area: np.ndarray
    perimeter: np.ndarray


def find_regions(mesh, levels, contours, body, pieces=None):
    """The :class:`Regions` of a sliced surface.

    body : (C,) the body of each contour's shell. A hole belongs to the
    smallest outer contour around it of the same body, so bodies that overlap
    stay apart. Where the surface crosses itself this leaves something open,
    which the :class:`pieces.Pieces` settle; elsewhere they make no difference.
    """
    area, perimeter = measure_contours(contours)
    rounding = ROUNDING * max(mesh.points.max(), -mesh.points.min())
    exact = ExactContours(mesh, levels, contours)
    chain = np.arange(len(area)) if pieces is None else _cylinder_chains(pieces, len(area))
    inner = _inner_contours(exact, chain, area, perimeter, rounding)
    parent, outer, unsure = nest_contours(contours, np.abs(area), perimeter, inner, body, rounding)
    _nest_exactly(exact, np.flatnonzero(unsure), contours.level, inner, body, parent, outer)
    size = np.abs(area)
    for hole in np.flatnonzero(inner & (outer < 0)):
        outer[hole] = _nearest_outer(hole, contours.level, pieces, size, inner, body)
        parent[hole] = outer[hole] if parent[hole] < 0 else parent[hole]
    head = np.where(inner & (outer >= 0), outer, np.arange(len(inner)))
    outers = np.flatnonzero(head == np.arange(len(head))).astype(np.int32)
    name = np.full(len(head), -1, np.int32)
    name[outers] = np.arange(len(outers), dtype=np.int32)
    return Regions(contours.level[outers], outers, name[head], inner, parent, area, perimeter)


def _inner_contours(exact, chain, area, perimeter, rounding):
    """Whether each contour is a hole: (C,) bool.

    Along a chain of cylinders an outer contour stays outer and a hole stays a
    hole, so the chain is decided at once, by its contour whose area is
    largest for its perimeter: rounding never turns a tiny contour around. A
    chain whose contours all enclose no more than rounding, as those inside
    flats do, is decided by its shortest contour in exact numbers.
    """
    certain = np.abs(area) > rounding * (perimeter + rounding)
    roundness = np.divide(area, perimeter**2, out=np.zeros_like(area), where=certain)
    order = np.lexsort((-np.diff(exact.contours.start), np.abs(roundness), chain))
    surest = order[np.flatnonzero(np.diff(chain[order], append=-1))]
    inner = np.zeros(len(area), bool)
    inner[chain[surest]] = area[surest] < 0
    for contour in surest[~certain[surest]].tolist():
        inner[chain[contour]] = exact.is_hole(contour)
    return inner[chain]


def _nest_exactly(exact, unsure, level, inner, body, parent, outer):
    """Fill in `parent` and `outer` of the contours for which floats do not suffice."""
    for contour in unsure.tolist():
        first, end = _beside(level, contour)
        around = np.array(exact.around(contour, range(first, end)), np.int64)
        hosts = around[~inner[around] & (body[around] == body[contour])]
        parent[contour] = around[0] if len(around) else -1
        outer[contour] = hosts[0] if len(hosts) else -1


def _beside(level, contour):
    """First and end of the contours at the level of one."""
    return np.searchsorted(level, np.array([level[contour], level[contour] + 1], level.dtype))


def _nearest_outer(hole, level, pieces, size, inner, body):
    """The outer contour for a hole that lies in none: (-1: there is none at its level).

    Only a surface that crosses itself has such holes. Taken is an outer
    contour that bounds the same piece, if known, else the largest of the body.
    """
    first, end = _beside(level, hole)
    others = first + np.flatnonzero(~inner[first:end] & (body[first:end] == body[hole]))
    if len(others) == 0:
        return -1
    if pieces is None:
        return int(others[np.argmax(size[others])])
    joined = (pieces.above[others] == pieces.above[hole]) | (pieces.below[others] == pieces.below[hole])
    return int(others[np.lexsort((size[others], joined))[-1]])


def _cylinder_chains(pieces, n_contours):
    cylinder = (pieces.n_below == 1) & (pieces.n_above == 1) & (pieces.genus == 0)
    low = np.full(len(cylinder), -1, np.int64)
    low[pieces.above] = np.arange(n_contours)
    high = np.full(len(cylinder), -1, np.int64)
    high[pieces.below] = np.arange(n_contours)
    low, high = low[cylinder], high[cylinder]
    return connected_items(low, high, n_contours)


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


def host_unseen_voids(mesh, levels, crossings, pieces, body_of_vertex):
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
            hosts[int(piece)] = _piece_of_face(mesh, levels, crossings, pieces, face, int(pieces.slab[piece]) + 1)
    return hosts


@njit(cache=True)
def _first_face_along_x(points, faces, vertex, body, piece):
    """The first face of the vertex's body, but not of its piece, on a ray along +x from it; -1 for none."""
    x, y, z = points[vertex]
    best, best_x = -1, np.inf
    ends = np.empty((2, 2))
    for f in range(faces.shape[0]):
        a, b, c = faces[f]
        if (
            points[a, 2] > z
            or max(points[b, 2], points[c, 2]) <= z
            or body[a] != body[vertex]
            or piece[a] == piece[vertex]
        ):
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


def _piece_of_face(mesh, levels, crossings, pieces, face, slab):
    """The piece that a face has in one of its slabs."""
    lowest = int(mesh.faces[face, 0])
    below = int(np.searchsorted(levels.below, lowest, side="right"))
    if slab == below:
        return int(pieces.of_vertex[lowest])
    return int(pieces.above[crossings.label[crossings.offset[face] + slab - 1 - below]])
