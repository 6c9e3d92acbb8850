"""The combinatorics of a cut surface, counted again from the mesh alone.

Nothing here is shared with the code that makes the tables, and the methods
differ on purpose: contours are connected components of cells (face, level)
rather than cycles of a permutation, pieces are components of cells
(face, slab) rather than of vertices and contours, Euler characteristics are
counted cell by cell rather than summed from vertex indices.

Work proceeds in runs of slabs, each with the level above it, so that memory
stays bounded however many cells there are.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from .cells import Cut, Run, join_cells, measure_contours, measure_pieces
from .ranges import expand_ranges

CELLS_AT_ONCE = 200_000


class Recount(NamedTuple):
    """What the mesh and the levels say about contours and pieces.

    Contours are in the order of the table that was compared: `anchored` (C,)
    tells which of its rows found a contour of their own, `n_contours` (K,)
    how many the mesh has at each level. Per contour: `n_points`, `loose` (how
    many more there may be, by the way that saddles come apart), `area`
    (signed), `perimeter`, `shell`, `above`, `below` (the piece on either
    side), `side` (a mesh edge that it crosses). Per piece: `slab` (-1 is below
    all levels), `piece_shell`, `euler` (V - E + F), `piece_area`, `flux`. Per
    vertex: `piece_of_vertex`. Per mesh edge: `enters`, `leaves`, numbers of
    the contours at its highest and lowest crossing, -1 for none. Per cell that
    was asked for: `piece_of_cell`.
    """

    n_contours: np.ndarray
    anchored: np.ndarray
    n_points: np.ndarray
    loose: np.ndarray
    area: np.ndarray
    perimeter: np.ndarray
    shell: np.ndarray
    above: np.ndarray
    below: np.ndarray
    side: np.ndarray
    slab: np.ndarray
    piece_shell: np.ndarray
    euler: np.ndarray
    piece_area: np.ndarray
    flux: np.ndarray
    piece_of_vertex: np.ndarray
    enters: np.ndarray
    leaves: np.ndarray
    piece_of_cell: np.ndarray


def count_below(surface, height, tie_x, tie_y):
    """Count the vertices below each level by its definition.

    Parameters
    ----------
    surface : Ranked
    height, tie_x, tie_y : (K,) float64

    Returns
    -------
    low, high : (K,) int
        Bounds, which differ only for a cut inside vertices of one position.
    """
    x, y, z = surface.points.T
    first, low = np.searchsorted(z, height, side="left"), np.searchsorted(z, height, side="right")
    high = low.copy()
    for k in np.flatnonzero(~np.isnan(tie_x)).tolist():
        tied = slice(first[k], low[k])
        west, same = x[tied] < tie_x[k], x[tied] == tie_x[k]
        low[k] = first[k] + (west | (same & (y[tied] < tie_y[k]))).sum()
        high[k] = first[k] + (west | (same & (y[tied] <= tie_y[k]))).sum()
    return surface.weight[low], surface.weight[high]


def recount(surface, sides, levels, anchors, doubled, asked):
    """Count contours and pieces of a surface cut at levels.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
        The surface, of n vertices, and its mesh edges.
    levels : dict of arrays
        height (K,), below (K,) ranks, planes (K, 3) height, tie_x, tie_y.
    anchors : dict of (C,) arrays
        level, lower_vertex, upper_vertex: a mesh edge of each contour by the surface vertices of its ends.
    doubled : (n,) int64
        How often the mesh edges up to a vertex may be doubled where the
        vertex, a multiple saddle, comes apart.
    asked : two (q,) int
        Faces, and slabs that they meet.

    Returns
    -------
    Recount
    """
    n, k = len(surface.points), len(levels["below"])
    place = np.repeat(np.arange(k + 1, dtype=np.int32), np.diff(levels["below"], prepend=0, append=n))
    cut = Cut(place, levels["planes"], np.concatenate([[-np.inf], levels["height"], [np.inf]]), _find_centres(surface))
    row, side = _find_anchors(surface, sides, place, anchors)
    level, anchored, crossed = anchors["level"][row], sides.faces[side, 0], place[sides.lower] < place[sides.upper]
    leaving, entering = np.flatnonzero(crossed), sides.by_upper[crossed[sides.by_upper]]
    of_vertex = np.empty(n, np.int64)  # a face of each
    of_vertex[surface.corners] = np.arange(len(surface.corners))[:, None]
    contours = _Parts(
        (anchored, level),
        (sides.faces[leaving, 0], place[sides.lower[leaving]]),
        (sides.faces[entering, 0], place[sides.upper[entering]] - 1),
    )
    pieces = _Parts((anchored, level + 1), (anchored, level), (of_vertex, place), asked)
    for run in _runs(surface, sides, place, k + 1):
        cells = join_cells(surface, sides, place, run, slabs=False)
        contours.enter(cells, run, measure_contours(surface, cut, run, cells, doubled))
        cells = join_cells(surface, sides, place, run, slabs=True)
        pieces.enter(cells, run, measure_pieces(surface, cut, run, cells))
    found, *ends = contours.found
    enters, leaves = (np.full(len(crossed), -1, np.int32) for _ in range(2))
    leaves[leaving], enters[entering] = ends
    level, shell, *measures = contours.columns()
    slab, piece_shell, euler, *sizes = pieces.columns()
    above, below, piece_of_vertex, piece_of_cell = pieces.found
    pair = _match(row, found, len(anchors["level"]), len(level))
    return Recount(
        np.bincount(level, minlength=k), pair >= 0, *(column[found[pair]] for column in (*measures, shell)),
        above[pair], below[pair], side[pair], slab - 1, piece_shell,
        euler + np.bincount(piece_of_vertex, minlength=len(euler)), *sizes,
        piece_of_vertex, enters, leaves, piece_of_cell,
    )  # fmt: skip


class _Parts:
    """Contours or pieces, filled in run by run, and which of them cells are part of that were asked for.

    asked : per question faces, and the levels or slabs that they meet, in
    order of these
    """

    def __init__(self, *asked):
        self.asked, self.measures, self.count = asked, [], 0
        self.found = [np.empty(len(k), np.int64) for _, k in asked]

    def enter(self, cells, run, measures):
        for (face, k), found in zip(self.asked, self.found):
            here = slice(*np.searchsorted(k, (run.first, run.last)))
            found[here] = cells.of(face[here], k[here]) + self.count
        self.measures.append(measures)
        self.count += cells.n_parts

    def columns(self):
        return map(np.concatenate, zip(*self.measures))


def _find_centres(surface):
    """A point of each shell, seen from which little cancels: x and y, (s, 2)."""
    first = np.empty(surface.shell.max() + 1, np.int64)
    first[surface.shell] = surface.corners[:, 0]
    return surface.points[first, :2]


def _runs(surface, sides, place, n):
    """Runs of the slabs 0..n-1, of some CELLS_AT_ONCE cells each, where one slab allows it.

    Faces and mesh edges are in order of their lower ends.
    """
    ends = [(place[lower], place[upper]) for lower, upper in (surface.corners.T[[0, 2]], (sides.lower, sides.upper))]
    rises = np.bincount(ends[0][0], minlength=n + 1) - np.bincount(ends[0][1] + 1, minlength=n + 1)
    held = np.cumsum(np.cumsum(rises[:n])) // CELLS_AT_ONCE
    cuts = np.concatenate([[0], np.flatnonzero(np.diff(held)) + 1, [n]])
    windows = (
        zip(
            np.searchsorted(np.maximum.accumulate(upper), cuts[:-1]).tolist(), np.searchsorted(lower, cuts[1:]).tolist()
        )
        for lower, upper in ends
    )
    return map(Run, cuts[:-1].tolist(), cuts[1:].tolist(), *windows)


def _find_anchors(surface, sides, place, anchors):
    """The mesh edges that each contour may name by its vertices: rows and mesh edges, in order of level.

    Several only where vertices have come apart, of whose copies mesh edges are then told by one pair of vertices.
    """
    n, level = len(surface.points), anchors["level"]
    plain = np.cumsum(np.diff(surface.origin, prepend=surface.origin[0]) != 0)  # as ranks before any came apart
    rank = np.empty(plain[-1] + 1, np.int64)
    rank[surface.origin] = plain
    keys = plain[sides.lower] * n + plain[sides.upper]
    order = np.argsort(keys, kind="stable")  # they are nearly in order
    wanted = rank[anchors["lower_vertex"]] * n + rank[anchors["upper_vertex"]]
    low, high = (np.searchsorted(keys[order], wanted, side=side) for side in ("left", "right"))
    row, near = expand_ranges(low, high)
    side = order[near]
    met = np.flatnonzero((place[sides.lower[side]] <= level[row]) & (level[row] < place[sides.upper[side]]))
    met = met[np.argsort(level[row[met]], kind="stable")]
    return row[met], side[met]


def _match(row, contour, n_rows, n_contours):
    """Give each row a contour of its own among those that it may name: which of the pairs (row, contour), or -1."""
    pairs = csr_array((np.ones(len(row), bool), (row, contour)), shape=(n_rows, n_contours))
    match = maximum_bipartite_matching(pairs, perm_type="column")
    pair, mine = np.full(n_rows, -1), np.flatnonzero(contour == match[row])
    pair[row[mine]] = mine
    return pair
