"""The combinatorics of a cut surface, counted again from the mesh alone.

Nothing here is shared with the code that makes the tables, and the methods
differ on purpose: contours are connected components of crossings rather than
cycles of a permutation, pieces are components of (face, slab) cells rather
than of vertices and contours, Euler characteristics are counted cell by cell
rather than summed from vertex indices.

Work proceeds in runs of levels, so that memory stays bounded however many
crossings there are.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .cells import Slabs, find_cells, find_centres
from .crossings import Cut, Run, enter_ends, find_crossings

CELLS_AT_ONCE = 200_000
PIECE_COLUMNS = ("slab", "piece_shell", "euler", "piece_area", "flux")


class Recount(NamedTuple):
    """What the mesh and the levels say about contours and pieces.

    Contours are numbered as in the table that was compared: `anchored` (C,)
    tells which of its rows found a contour of their own, `n_contours` (K,)
    how many the mesh has at each level. Per contour: `n_points`, `loose` (how
    many more there may be, by the way that saddles come apart), `area`
    (signed), `perimeter`, `shell`, `above`, `below` (the piece on either side).
    `side`, a mesh edge that it crosses. Per piece: `slab` (-1 is below all levels), `piece_shell`, `euler`
    (V - E + F), `piece_area`, `flux`. Per vertex: `piece_of_vertex`. Per mesh
    edge: `enters`, `leaves`, the contours at its highest and lowest crossing.
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
    weight = surface.weight
    first, last = np.searchsorted(z, height, side="left"), np.searchsorted(z, height, side="right")
    low, high = last.copy(), last.copy()
    for k in np.flatnonzero(~np.isnan(tie_x)).tolist():
        fx, fy = x[first[k] : last[k]], y[first[k] : last[k]]
        low[k] = first[k] + ((fx < tie_x[k]) | ((fx == tie_x[k]) & (fy < tie_y[k]))).sum()
        high[k] = first[k] + ((fx < tie_x[k]) | ((fx == tie_x[k]) & (fy <= tie_y[k]))).sum()
    return weight[low], weight[high]


def recount(surface, sides, levels, anchors, doubled):
    """Count contours and pieces of a surface cut at levels.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
        The surface, of n vertices, and its mesh edges.
    levels : dict of (K,) arrays
        height, below (ranks), tie_x, tie_y.
    anchors : dict of (C,) arrays
        level, lower, upper: a mesh edge of each contour by the surface vertices of its ends.
    doubled : (n,) int64
        How often the mesh edges up to a vertex may be doubled where the
        vertex, a multiple saddle, comes apart.

    Returns
    -------
    Recount
    """
    n, k = len(surface.points), len(levels["below"])
    place = np.repeat(np.arange(k + 1, dtype=np.int32), np.diff(levels["below"], prepend=0, append=n))
    anchor_side, ambiguous = _find_anchors(surface, sides, place, anchors)
    contours = _Contours(k, len(anchors["level"]), len(sides.lower))
    cut = Cut(place, np.stack([levels[column] for column in ("height", "tie_x", "tie_y")], axis=1), doubled)
    for run in _runs(surface, sides, place, k, 0):
        crossings = find_crossings(surface, sides, cut, run)
        name = _name_contours(crossings, anchors["level"], anchor_side, ambiguous, contours, run)
        _enter_contours(contours, crossings, name, place, sides, run)
    bounds = np.concatenate([[-np.inf], levels["height"], [np.inf]])
    slabs = Slabs(place, bounds, find_centres(surface.points, surface.corners, surface.shell))
    pieces = _Pieces(n, len(anchors["level"]))
    for run in _runs(surface, sides, place, k + 1, 1):
        cells = find_cells(surface, sides, slabs, run, pieces.of_vertex, pieces.count)
        _enter_pieces(pieces, cells, sides, anchors["level"], contours.side, run)
    columns = dict(zip(PIECE_COLUMNS, (np.concatenate(part) for part in pieces.columns)))
    ends = {"above": pieces.above, "below": pieces.below, "piece_of_vertex": pieces.of_vertex}
    return Recount(**vars(contours), **columns, **ends)


class _Contours:
    """Filled in run by run by :func:`_name_contours` and :func:`_enter_contours`."""

    def __init__(self, n_levels, n_contours, n_sides):
        self.n_contours = np.zeros(n_levels, np.int64)
        self.anchored = np.zeros(n_contours, bool)
        self.n_points, self.loose = np.zeros(n_contours, np.int64), np.zeros(n_contours, np.int64)
        self.area, self.perimeter = np.zeros(n_contours), np.zeros(n_contours)
        self.shell = np.full(n_contours, -1)
        self.side = np.full(n_contours, -1)
        self.enters, self.leaves = (np.full(n_sides, -1, np.int32) for _ in range(2))


class _Pieces:
    """Filled in run by run by :func:`_enter_pieces`; columns : those of PIECE_COLUMNS."""

    def __init__(self, n_vertices, n_contours):
        self.columns = tuple([] for _ in PIECE_COLUMNS)
        self.of_vertex = np.full(n_vertices, -1)
        self.above, self.below = np.full(n_contours, -1), np.full(n_contours, -1)
        self.count = 0


def _runs(surface, sides, place, n, more):
    """Runs of levels, or with `more` of 1 of slabs, of at most CELLS_AT_ONCE cells each, where one allows it.

    Of 0..n-1; mesh edges and faces are in order of their lower ends. They meet
    what is from the place of their lower end to that of their upper one, less
    1 but for `more`.
    """
    side_ends, face_ends = (sides.lower, sides.upper), (surface.corners[:, 0], surface.corners[:, 2])
    sizes = _count_open(place, *(face_ends if more else side_ends), n, more)
    first, held, of_sides, of_faces = 0, 0, (0, 0), (0, 0)
    for k in range(1, n + 1):
        held += sizes[k - 1]
        if k == n or held + sizes[k] > CELLS_AT_ONCE:
            of_sides = _window(place, *side_ends, *of_sides, first, k, more)
            of_faces = _window(place, *face_ends, *of_faces, first, k, more)
            yield Run(first, k, of_sides, of_faces)
            first, held = k, 0


@njit
def _count_open(place, lower, upper, n, more):
    """How many of what reaches from `lower` to `upper` meet each level or slab."""
    rises = np.zeros(n + 2, np.int64)
    for i in range(len(lower)):
        rises[place[lower[i]]] += 1
        rises[place[upper[i]] + more] -= 1
    return np.cumsum(rises)


@njit
def _window(place, lower, upper, begin, end, first, last, more):
    """The range after (begin, end) that holds all that meet first..last-1."""
    while begin < len(lower) and place[upper[begin]] + more <= first:
        begin += 1
    end = max(end, begin)
    while end < len(lower) and place[lower[end]] < last:
        end += 1
    return begin, end


def _find_anchors(surface, sides, place, anchors):
    """A mesh edge of every contour row, (C,) or -1; and rows where several fit."""
    n = int(max(surface.origin.max(initial=0), anchors["lower"].max(initial=0), anchors["upper"].max(initial=0))) + 1
    named = np.zeros(n, bool)
    named[anchors["lower"]] = True
    ends = np.flatnonzero(named[surface.origin]).astype(sides.lower.dtype)
    begin, end = (np.searchsorted(sides.lower, ends, side=side) for side in ("left", "right"))
    near = np.repeat(end - np.cumsum(end - begin), end - begin) + np.arange((end - begin).sum())
    keys = surface.origin[sides.lower[near]].astype(np.int64) * n + surface.origin[sides.upper[near]]
    order = np.argsort(keys, kind="stable")
    keys, near = keys[order], near[order]
    wanted, level = anchors["lower"] * n + anchors["upper"], anchors["level"]
    low, high = np.searchsorted(keys, wanted, side="left"), np.searchsorted(keys, wanted, side="right")
    row = np.repeat(np.arange(len(wanted)), high - low)
    side = near[np.arange(len(row)) + (high - np.cumsum(high - low))[row]]
    met = (place[sides.lower[side]] <= level[row]) & (level[row] < place[sides.upper[side]])
    row, side = row[met], side[met]
    found = np.full(len(wanted), -1)
    found[row[::-1]] = side[::-1]  # the first that fits
    several = np.flatnonzero(np.bincount(row, minlength=len(wanted)) > 1).tolist()
    return found, {k: side[row == k] for k in several}


def _name_contours(crossings, level, anchor_side, ambiguous, out, run):
    """The contour row of each recounted contour, -1 for none; a contour is taken once."""
    name = np.full(len(crossings.level), -1)
    rows = np.flatnonzero((level >= run.first) & (level < run.last) & (anchor_side >= 0))
    sure = np.array([row not in ambiguous for row in rows.tolist()], bool)
    for row in np.concatenate([rows[sure], rows[~sure]]).tolist():
        for side in ambiguous.get(row, anchor_side[row : row + 1]):
            found = crossings.part[crossings.start[side - crossings.origin] + level[row]]
            if name[found] < 0:
                name[found], out.anchored[row], out.side[row] = row, True, side
                break
    return name


def _enter_contours(out, crossings, name, place, sides, run):
    """Enter the contours of a run by their rows."""
    levels = slice(run.first, run.last)
    out.n_contours[levels] = np.bincount(crossings.level, minlength=run.last)[levels]
    named = np.flatnonzero(name >= 0)
    for column in ("n_points", "loose", "area", "perimeter", "shell"):
        getattr(out, column)[name[named]] = getattr(crossings, column)[named]
    enter_ends(sides, place, run, crossings, name, out.enters, out.leaves)


def _enter_pieces(out, cells, sides, level, anchor_side, run):
    """Enter the pieces of a run of slabs, and which of them each contour bounds.

    Slab s of the cells is the one below level s, so the table's slab is s - 1.
    """
    for column, values in zip(out.columns, (cells.slab - 1, cells.shell, cells.euler, cells.area, cells.flux)):
        column.append(values)
    for ends, slab in ((out.above, level + 1), (out.below, level)):
        rows = np.flatnonzero((anchor_side >= 0) & (slab >= run.first) & (slab < run.last))
        ends[rows] = cells.part[cells.start[sides.faces[anchor_side[rows], 0] - cells.origin] + slab[rows]] + out.count
    out.count += len(cells.slab)
