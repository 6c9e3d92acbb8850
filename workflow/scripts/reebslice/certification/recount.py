"""The combinatorics of a cut surface, counted again from the mesh alone.

Nothing here is shared with the code that makes the tables, and the methods
differ on purpose: contours are connected components of crossings rather than
cycles of a permutation, pieces are components of (face, slab) cells rather
than of vertices and contours, Euler characteristics are counted cell by cell
rather than summed from vertex indices.

A vertex id in this module is a rank: its place in the order of (height,
tilted x, tilted y, surface vertex). Work proceeds in runs of levels, so that
memory stays bounded however many crossings there are.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .recount_cells import measure_cells

CELLS_AT_ONCE = 2_000_000


class Ranked(NamedTuple):
    """A closed surface whose vertex ids are ranks of height.

    points : (n, 3) tilted frame; origin : (n,) the surface vertex of each rank
    corners : (m, 3) ranks, ascending within each face
    even : (m,) bool, whether `corners` is counter-clockwise seen from outside
    shell : (m,) the shell of each face
    """

    points: np.ndarray
    origin: np.ndarray
    corners: np.ndarray
    even: np.ndarray
    shell: np.ndarray


class Sides(NamedTuple):
    """The E mesh edges: lower and upper end, and the three of each face.

    of_face : (m, 3), for corners a < b < c the mesh edges ab, bc, ac
    faces : (E, 2) the two faces at each mesh edge
    """

    lower: np.ndarray
    upper: np.ndarray
    of_face: np.ndarray
    faces: np.ndarray


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


def rotate(points, rotation):
    """Points (n, 3) in the tilted frame, summed in the order x, y, z."""
    x, y, z = np.asarray(points, float).T
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in np.asarray(rotation, float)], axis=1)


def rank_surface(points, faces, shell):
    """The :class:`Ranked` surface of tilted `points` (n, 3) and `faces` (m, 3)."""
    order = np.lexsort((np.arange(len(points)), points[:, 1], points[:, 0], points[:, 2]))
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return _sort_corners(points[order], order, rank[faces], shell)


def _sort_corners(points, origin, faces, shell):
    turn = np.argsort(faces, axis=1)
    even = (turn[:, 1] - turn[:, 0]) % 3 == 1
    return Ranked(points, origin, np.take_along_axis(faces, turn, axis=1), even, np.asarray(shell))


def oriented_faces(surface):
    """The faces (m, 3), counter-clockwise seen from outside."""
    a, b, c = surface.corners.T
    return np.stack([a, np.where(surface.even, b, c), np.where(surface.even, c, b)], axis=1)


def sign_changes(surface):
    """Sign changes around the link of every vertex: faces with it in the middle."""
    return np.bincount(surface.corners[:, 1], minlength=len(surface.points))


def copies(surface):
    """How many simple critical points each vertex stands for, at least 1."""
    return np.maximum(sign_changes(surface) // 2 - 1, 1)


def find_sides(surface):
    """The :class:`Sides`, or None unless each lies in two opposite half-edges."""
    n, corners = len(surface.points), surface.corners
    tails, heads = corners[:, [0, 1, 0]], corners[:, [1, 2, 2]]
    keys, of_face, counts = np.unique(tails * n + heads, return_inverse=True, return_counts=True)
    of_face = of_face.reshape(-1, 3)
    upward = np.stack([surface.even, surface.even, ~surface.even], axis=1)
    balance = np.bincount(of_face.ravel(), np.where(upward, 1, -1).ravel(), len(keys))
    if (counts != 2).any() or balance.any() or (tails == heads).any():
        return None
    faces = (np.argsort(of_face.ravel(), kind="stable") // 3).reshape(-1, 2)
    return Sides(keys // n, keys % n, of_face, faces)


def count_below(surface, height, tie_x, tie_y):
    """Vertices below each level by its definition: two (K,) bounds, low and high.

    The bounds differ only for a cut inside vertices of one position.
    """
    z, x, y = surface.points[:, 2], surface.points[:, 0], surface.points[:, 1]
    weight = np.concatenate([[0], np.cumsum(copies(surface))])
    low, high = [], []
    for h, tx, ty in zip(height, tie_x, tie_y):
        first, last = np.searchsorted(z, h, side="left"), np.searchsorted(z, h, side="right")
        if np.isnan(tx):
            low.append(last)
            high.append(last)
            continue
        fx, fy = x[first:last], y[first:last]
        low.append(first + ((fx < tx) | ((fx == tx) & (fy < ty))).sum())
        high.append(first + ((fx < tx) | ((fx == tx) & (fy <= ty))).sum())
    return weight[np.array(low, int)], weight[np.array(high, int)]


def cross(surface, low, high, height, tie_x, tie_y):
    """Where mesh edges from `low` up to `high` meet tilted planes, (k, 2)."""
    p, q = surface.points[low], surface.points[high]
    rise = q - p
    flat = rise[:, 2] == 0
    steep = flat & (rise[:, 0] == 0)
    wanted = np.where(steep, tie_y - p[:, 1], np.where(flat, tie_x - p[:, 0], height - p[:, 2]))
    span = np.where(steep, rise[:, 1], np.where(flat, rise[:, 0], rise[:, 2]))
    share = np.divide(wanted, span, out=np.full(len(span), 0.5), where=span != 0)
    share = np.clip(np.nan_to_num(share, nan=0.5), 0.0, 1.0)
    return p[:, :2] + share[:, None] * rise[:, :2]


def recount(surface, sides, levels, anchors, doubled):
    """The :class:`Recount` of a surface cut at levels.

    doubled : (n,) int, how often the mesh edges up to a vertex may be doubled
        where the vertex, a multiple saddle, comes apart
    levels : dict of (K,) arrays height, below (ranks), tie_x, tie_y
    anchors : dict of (C,) arrays level, lower, upper; a mesh edge of each
        contour by the surface vertices of its ends
    """
    below, k = levels["below"], len(levels["below"])
    place = np.searchsorted(below, np.arange(len(surface.points)), side="right")
    anchor_side, ambiguous = _find_anchors(surface, sides, place, anchors)
    contours = _Contours(k, len(anchors["level"]), len(sides.lower))
    for first, last in _runs(place[sides.lower], place[sides.upper], k):
        _count_contours(surface, sides, place, levels, anchors, anchor_side, ambiguous, doubled, contours, first, last)
    pieces = _Pieces(len(surface.points), len(anchors["level"]))
    a, c = place[surface.corners[:, 0]], place[surface.corners[:, 2]] + 1
    for first, last in _runs(a, c, k + 1):
        _count_pieces(surface, sides, place, levels, anchors, contours.side, pieces, first, last)
    return Recount(
        contours.n, contours.anchored, contours.n_points, contours.loose, contours.area, contours.perimeter, contours.shell,
        pieces.above, pieces.below, contours.side, *(np.concatenate(part) for part in pieces.columns()),
        pieces.of_vertex, contours.enters, contours.leaves,
    )  # fmt: skip


class _Contours:
    """Filled in run by run by :func:`_count_contours`."""

    def __init__(self, n_levels, n_contours, n_sides):
        self.n = np.zeros(n_levels, np.int64)
        self.anchored = np.zeros(n_contours, bool)
        self.n_points, self.loose = np.zeros(n_contours, np.int64), np.zeros(n_contours, np.int64)
        self.area, self.perimeter = np.zeros(n_contours), np.zeros(n_contours)
        self.shell = np.full(n_contours, -1)
        self.side = np.full(n_contours, -1)
        self.enters, self.leaves = np.full(n_sides, -1), np.full(n_sides, -1)


class _Pieces:
    """Filled in run by run by :func:`_count_pieces`."""

    def __init__(self, n_vertices, n_contours):
        self.slab, self.shell, self.euler, self.area, self.flux = ([] for _ in range(5))
        self.of_vertex = np.full(n_vertices, -1)
        self.above, self.below = np.full(n_contours, -1), np.full(n_contours, -1)
        self.count = 0

    def columns(self):
        return self.slab, self.shell, self.euler, self.area, self.flux


def _runs(start, stop, n):
    """Ranges [first, last) of 0..n with at most CELLS_AT_ONCE cells, where one allows it."""
    rises = np.bincount(start, minlength=n + 1)[: n + 1] - np.bincount(stop, minlength=n + 1)[: n + 1]
    sizes = np.cumsum(rises)[:n]
    first, held = 0, 0
    for k in range(n):
        if held and held + sizes[k] > CELLS_AT_ONCE:
            yield first, k
            first, held = k, 0
        held += sizes[k]
    if first < n:
        yield first, n


def _expand(start, stop, first, last):
    """Cells (owner, place) of the intervals [start, stop) cut to [first, last).

    Returns owner, place and `offset`: the cell of (owner, place) is offset + place.
    """
    start, stop = np.maximum(start, first), np.minimum(stop, last)
    size = np.maximum(stop - start, 0)
    begin = np.cumsum(size) - size
    owner = np.repeat(np.arange(len(size)), size)
    offset = begin - start
    return owner, np.arange(len(owner)) - offset[owner], offset


def _find_anchors(surface, sides, place, anchors):
    """A mesh edge of every contour row, (C,) or -1; and rows where several fit."""
    n = int(max(surface.origin.max(initial=0), anchors["lower"].max(initial=0), anchors["upper"].max(initial=0))) + 1
    keys = surface.origin[sides.lower] * n + surface.origin[sides.upper]
    order = np.argsort(keys, kind="stable")
    wanted = anchors["lower"] * n + anchors["upper"]
    low = np.searchsorted(keys[order], wanted, side="left")
    high = np.searchsorted(keys[order], wanted, side="right")
    found, ambiguous = np.full(len(wanted), -1), {}
    for row in range(len(wanted)):
        fits = order[low[row] : high[row]]
        level = anchors["level"][row]
        fits = fits[(place[sides.lower[fits]] <= level) & (level < place[sides.upper[fits]])]
        if len(fits):
            found[row] = fits[0]
        if len(fits) > 1:
            ambiguous[row] = fits
    return found, ambiguous


def _count_contours(surface, sides, place, levels, anchors, anchor_side, ambiguous, doubled, out, first, last):
    low, high = place[sides.lower], place[sides.upper]
    owner, level, offset = _expand(low, high, first, last)
    a, b, c = (place[column] for column in surface.corners.T)
    face, at, _ = _expand(a, c, first, last)
    long = offset[sides.of_face[face, 2]] + at
    short = offset[np.where(b[face] > at, sides.of_face[face, 0], sides.of_face[face, 1])] + at
    links = coo_array((np.ones(len(face), np.int8), (long, short)), shape=(len(owner),) * 2)
    n_parts, part = connected_components(links, directed=False)
    level_of_part = np.zeros(n_parts, np.int64)
    level_of_part[part] = level
    out.n[first:last] = np.bincount(level_of_part, minlength=last)[first:last]
    name = _name_parts(part, n_parts, offset, anchors["level"], anchor_side, ambiguous, out, first, last)
    _measure(surface, sides, levels, owner, level, part, name, face, at, long, short, out)
    loose = np.bincount(part, doubled[sides.upper[owner]], n_parts)
    out.loose[name[name >= 0]] = loose[name >= 0]
    label = name[part]
    for side, edge in ((out.enters, high - 1), (out.leaves, low)):
        here = np.flatnonzero((low < high) & (edge >= first) & (edge < last))
        side[here] = label[offset[here] + edge[here]]


def _name_parts(part, n_parts, offset, level, anchor_side, ambiguous, out, first, last):
    """The contour row of each component, -1 for none; a component is taken once."""
    name = np.full(n_parts, -1)
    rows = np.flatnonzero((level >= first) & (level < last) & (anchor_side >= 0))
    sure = np.array([row not in ambiguous for row in rows.tolist()], bool)
    for row in np.concatenate([rows[sure], rows[~sure]]).tolist():
        for side in ambiguous.get(row, anchor_side[row : row + 1]):
            found = part[offset[side] + level[row]]
            if name[found] < 0:
                name[found], out.anchored[row], out.side[row] = row, True, side
                break
    return name


def _measure(surface, sides, levels, owner, level, part, name, face, at, long, short, out):
    """Crossing counts, signed areas, perimeters and shells of the contours of a run."""
    spots = cross(
        surface, sides.lower[owner], sides.upper[owner],
        levels["height"][level], levels["tie_x"][level], levels["tie_y"][level],
    )  # fmt: skip
    centre = np.zeros((len(name), 2))
    centre[part] = spots  # any point of the contour: no cancellation far from the origin
    even = surface.even[face]
    p = spots[np.where(even, long, short)] - centre[part[long]]
    q = spots[np.where(even, short, long)] - centre[part[long]]
    area = np.bincount(part[long], 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]), len(name))
    perimeter = np.bincount(part[long], np.hypot(*(q - p).T), len(name))
    shell = np.full(len(name), -1)
    shell[part[long]] = surface.shell[face]
    n_points = np.bincount(part, minlength=len(name))
    named = np.flatnonzero(name >= 0)
    rows = name[named]
    out.area[rows], out.perimeter[rows] = area[named], perimeter[named]
    out.shell[rows], out.n_points[rows] = shell[named], n_points[named]


def _count_pieces(surface, sides, place, levels, anchors, anchor_side, out, first, last):
    """Join the (face, slab) cells of a run of slabs across mesh edges.

    Slab s of this function is the one below level s, so the table's slab is s - 1.
    """
    a, c = place[surface.corners[:, 0]], place[surface.corners[:, 2]]
    face, slab, offset = _expand(a, c + 1, first, last)
    side, at, _ = _expand(place[sides.lower], place[sides.upper] + 1, first, last)
    one, two = (offset[sides.faces[side, k]] + at for k in (0, 1))
    links = coo_array((np.ones(len(side), np.int8), (one, two)), shape=(len(face),) * 2)
    n, part = connected_components(links, directed=False)
    some_face = np.empty(len(surface.points), np.int64)
    some_face[surface.corners] = np.arange(len(surface.corners))[:, None]
    inside = np.flatnonzero((place >= first) & (place < last))
    of_vertex = part[offset[some_face[inside]] + place[inside]]
    out.of_vertex[inside] = of_vertex + out.count
    # Boundary circles have as many crossings as segments, so they cancel.
    euler = np.bincount(of_vertex, minlength=n) - np.bincount(part[one], minlength=n) + np.bincount(part, minlength=n)
    slab_of, shell_of = np.zeros(n, np.int64), np.zeros(n, np.int64)
    slab_of[part], shell_of[part] = slab, surface.shell[face]
    area, flux = measure_cells(surface, place, levels["height"], face, slab)
    for column, values in zip(
        out.columns(), (slab_of - 1, shell_of, euler, np.bincount(part, area, n), np.bincount(part, flux, n))
    ):
        column.append(values)
    for ends, shift in ((out.above, 1), (out.below, 0)):
        wanted = anchors["level"] + shift
        rows = np.flatnonzero((anchor_side >= 0) & (wanted >= first) & (wanted < last))
        ends[rows] = part[offset[sides.faces[anchor_side[rows], 0]] + wanted[rows]] + out.count
    out.count += n
