"""Slab pieces: the connected components of the surface between two levels.

A piece of the surface is a piece of its Reeb graph: the quotient that makes the
graph keeps the components of what lies between two levels. So the graph, cut
where its arcs cross levels, gives the pieces without a look at the mesh.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.components import find, join
from ..arrays.grouping import Groups, group_items, group_of_members
from ..kernels import njit
from .levels import vertex_slabs
from .pairing import pair_in_slabs

KIND_OF_ELEMENTARY = {(1, 1): "cylinder", (0, 1): "birth", (1, 0): "death", (2, 1): "join", (1, 2): "split"}


class Pieces(NamedTuple):
    """P pieces of a surface that is cut in C contours and whose Reeb graph has K nodes.

    Attributes
    ----------
    slab : (P,) int32
        The level below each piece, -1 for the lowest slab.
    of_node : (K,) int32
        The piece of every critical point.
    piece_above, piece_below : (C,) int32
        The piece on the upper and on the lower side of every contour. (The columns `below` and `above` of
        the table `pieces` are the inverse: the contours that bound a piece from below and from above.)
    n_below, n_above : (P,) int32
        Number of contours that bound each piece from below and from above.
    euler_characteristic, genus : (P,) int32
        The one is 2 - 2 genus - n_below - n_above.
    critical : Groups
        Ranks of the essential critical points of each piece, ascending.
    """

    slab: np.ndarray
    of_node: np.ndarray
    piece_above: np.ndarray
    piece_below: np.ndarray
    n_below: np.ndarray
    n_above: np.ndarray
    euler_characteristic: np.ndarray
    genus: np.ndarray
    critical: Groups

    def kinds(self):
        """Name the kind of every piece: a list of P words of `schemas.PIECE_KINDS`."""
        ends = zip(self.n_below.tolist(), self.n_above.tolist(), self.genus.tolist())
        return [kind_of_piece(*end) for end in ends]


class PieceSurfaces(NamedTuple):
    """The part of the surface that each of P pieces is.

    Attributes
    ----------
    of_vertex : (n,) int32
        The piece of every vertex.
    area : (P,) float64
        Area, mesh units squared.
    flux : (P,) float64
        Flux of (x, 0, 0) through the piece, whose sum over a closed part is its volume, mesh units cubed.
    """

    of_vertex: np.ndarray
    area: np.ndarray
    flux: np.ndarray


def kind_of_piece(n_below, n_above, genus):
    """Name a piece by the number of its boundary contours and its genus.

    Returns
    -------
    str
        One of `schemas.PIECE_KINDS`: the name of an elementary piece; "unseen" if no contour bounds it;
        else "compound".
    """
    if n_below + n_above == 0:
        return "unseen"
    return KIND_OF_ELEMENTARY.get((n_below, n_above), "compound") if genus == 0 else "compound"


def find_pieces(graph, levels, contours, of_arcs):
    """Find the pieces of a sliced surface from its Reeb graph.

    Parameters
    ----------
    graph : ReebGraph
        The surface's, of K nodes and A arcs.
    levels : Levels
        The cuts.
    contours : Contours
        Their C contours.
    of_arcs : Groups
        The contours of each arc, upward, as of :func:`.graph_slices.contours_of_arcs`.

    Returns
    -------
    Pieces
        In any order. Every contour bounds exactly one piece below it and one above; that is the exact
        link between the contours of consecutive levels.
    """
    k, c = len(graph.nodes), len(contours.level)
    roots, piece = np.unique(_join_pieces(graph.arcs, of_arcs, k, c), return_inverse=True)
    piece, count = piece.astype(np.int32), len(roots)
    of_node, below, above = piece[:k], piece[k : k + c], piece[k + c :]
    slab = np.empty(count, np.int32)
    node_slab = np.searchsorted(levels.below, graph.nodes, side="right")
    slab[piece] = np.concatenate([node_slab, contours.level, contours.level + 1]) - 1
    n_below = np.bincount(above, minlength=count).astype(np.int32)
    n_above = np.bincount(below, minlength=count).astype(np.int32)
    index = np.where(np.bincount(graph.arcs.ravel(), minlength=k) == 1, 1, -1)  # an extremum ends one arc
    euler = np.rint(np.bincount(of_node, weights=index, minlength=count)).astype(np.int32)
    essential = np.flatnonzero(pair_in_slabs(graph, of_arcs) < 0)
    critical = _group_ranks(of_node[essential], graph.nodes[essential], count)
    genus = (2 - n_below - n_above - euler) // 2
    return Pieces(slab, of_node, above, below, n_below, n_above, euler, genus, critical)


def _group_ranks(piece, ranks, count):
    """Group ranks by piece, each group in the order that they come in."""
    places = group_items(piece, count)
    return Groups(places.start, ranks[places.member])


@njit
def _join_pieces(arcs, of_arcs, k, c):
    """Union-find over k nodes, then c contours seen from below, then from above: the root of each."""
    offset, contour = of_arcs.start, of_arcs.member
    root = np.arange(k + 2 * c)
    for a in range(len(arcs)):
        last = np.int64(arcs[a, 0])
        for place in range(offset[a], offset[a + 1]):
            join(root, last, k + contour[place])
            last = k + c + contour[place]
        join(root, last, np.int64(arcs[a, 1]))
    for i in range(len(root)):
        root[i] = find(root, i)
    return root


def measure_pieces(mesh, graph, levels, crossings, pieces):
    """Measure the surfaces of pieces, face by face, and number the pieces by slab and first vertex.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    graph : ReebGraph
        The mesh's.
    levels : Levels
        The cuts.
    crossings : Crossings
        Those of :func:`.contours.trace_crossings`.
    pieces : Pieces
        Those of :func:`find_pieces`.

    Returns
    -------
    pieces : Pieces
        The same, ordered by slab, then by lowest vertex; a piece without vertices comes after those that have
        some, and these are ordered by the first contour that bounds them from above.
    surfaces : PieceSurfaces
        Their vertices, areas and fluxes. A face in one horizontal plane counts whole where its middle vertex lies.
    """
    slab = vertex_slabs(mesh, levels)
    of_vertex = np.full(len(mesh.points), -1, np.int32)
    of_vertex[graph.nodes] = pieces.of_node
    _spread_pieces(mesh.faces, slab, crossings, pieces.piece_above, of_vertex)
    ceiling = np.append(levels.height, np.inf)
    area, flux = _measure_pieces(mesh, slab, ceiling, crossings, pieces.piece_above, of_vertex, len(pieces.slab))
    first = _first_members(np.concatenate([of_vertex, pieces.piece_below, pieces.piece_above]), len(pieces.slab))
    order = np.lexsort((first, pieces.slab))
    name = np.empty(len(order), np.int32)
    name[order] = np.arange(len(order), dtype=np.int32)
    return _renumber(pieces, order, name), PieceSurfaces(name[of_vertex], area[order], flux[order])


def _renumber(pieces, order, name):
    """The pieces in another order; name : (P,) their new numbers."""
    slab, n_below, n_above = pieces.slab[order], pieces.n_below[order], pieces.n_above[order]
    euler, genus = pieces.euler_characteristic[order], pieces.genus[order]
    above, below = name[pieces.piece_above], name[pieces.piece_below]
    critical = _group_ranks(name[group_of_members(pieces.critical)], pieces.critical.member, len(order))
    return Pieces(slab, name[pieces.of_node], above, below, n_below, n_above, euler, genus, critical)


@njit
def _first_members(piece, count):
    """The place of the first member of every piece."""
    first = np.empty(count, np.int64)
    for i in range(len(piece) - 1, -1, -1):
        first[piece[i]] = i
    return first


@njit
def _spread_pieces(faces, slab, crossings, piece_above, of_vertex):
    """Fill in the pieces of vertices, which are known (not -1) for minima.

    Faces ascend by their lowest corner, and every vertex but a minimum is a higher corner of some face.
    """
    offset, label = crossings.offset, crossings.label
    for f in range(faces.shape[0]):
        a = faces[f, 0]
        for k in (1, 2):
            v = faces[f, k]
            if of_vertex[v] < 0:
                steps = slab[v] - slab[a]
                of_vertex[v] = of_vertex[a] if steps == 0 else piece_above[label[offset[f] + steps - 1]]


@njit(inline="always")
def _below_height(z, z0, z1, z2, x0, x1, x2):
    """Share of a triangle's area below z, and of its area times x."""
    if z >= z2:
        return 1.0, (x0 + x1 + x2) / 3.0
    if z <= z0:
        return 0.0, 0.0
    if z < z1:
        t1, t2 = (z - z0) / (z1 - z0), (z - z0) / (z2 - z0)
        share = t1 * t2
        return share, share * (x0 + (t1 * (x1 - x0) + t2 * (x2 - x0)) / 3.0)
    t0, t1 = (z2 - z) / (z2 - z0), (z2 - z) / (z2 - z1)
    share = t0 * t1
    return 1.0 - share, (x0 + x1 + x2) / 3.0 - share * (x2 + (t0 * (x0 - x2) + t1 * (x1 - x2)) / 3.0)


@njit
def _measure_pieces(mesh, slab, ceiling, crossings, piece_above, of_vertex, count):
    """Area and flux of (x, 0, 0) of every piece, face by face, slab by slab; ceiling : (K + 1,) tops of the slabs."""
    points, faces, offset, label = mesh.points, mesh.faces, crossings.offset, crossings.label
    area, flux = np.zeros(count), np.zeros(count)
    centre = points[:, 0].mean()
    for f in range(faces.shape[0]):
        # faces start with their lowest vertex
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        whole = 0.5 * np.sqrt(nx * nx + ny * ny + nz * nz)
        middle, top = (b, c) if b < c else (c, b)
        if points[a, 2] == points[top, 2]:
            area[of_vertex[middle]] += whole
            continue
        seen, seen_x = 0.0, 0.0
        for s in range(slab[a], slab[top] + 1):
            share, moment = 1.0, (points[a, 0] + points[b, 0] + points[c, 0]) / 3.0 - centre
            if s < slab[top]:
                share, moment = _below_height(
                    ceiling[s], points[a, 2], points[middle, 2], points[top, 2],
                    points[a, 0] - centre, points[middle, 0] - centre, points[top, 0] - centre,
                )  # fmt: skip
            piece = of_vertex[a] if s == slab[a] else piece_above[label[offset[f] + s - 1 - slab[a]]]
            area[piece] += whole * (share - seen)
            flux[piece] += 0.5 * nx * (moment - seen_x)
            seen, seen_x = share, moment
    return area, flux
