"""Slab pieces: the connected components of the surface between two levels."""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..morse.critical_points import vertex_indices
from .levels import vertex_slabs

KIND_OF_ELEMENTARY = {(1, 1): "cylinder", (0, 1): "birth", (1, 0): "death", (2, 1): "join", (1, 2): "split"}


class Pieces(NamedTuple):
    """P pieces, ordered by slab.

    slab : (P,) int32, the level below it, -1 for the lowest slab
    of_vertex : (n,) int32; above, below : (C,) int32, the piece that each
        contour bounds from below (its upper side) and from above
    n_below, n_above, euler_characteristic, genus : (P,) int32
    area : (P,) float64, of the surface; flux : (P,) float64, the flux of
        (x, 0, 0) through it, whose sum over a closed part is its volume
    critical : list of P int32 arrays, ranks of the essential critical points
    """

    slab: np.ndarray
    of_vertex: np.ndarray
    above: np.ndarray
    below: np.ndarray
    n_below: np.ndarray
    n_above: np.ndarray
    euler_characteristic: np.ndarray
    genus: np.ndarray
    area: np.ndarray
    flux: np.ndarray
    critical: list

    def kinds(self):
        """Kind of every piece: a list of P words of `schemas.PIECE_KINDS`."""
        ends = zip(self.n_below.tolist(), self.n_above.tolist(), self.genus.tolist())
        return [kind_of_piece(*end) for end in ends]


def kind_of_piece(n_below, n_above, genus):
    """The word for a piece with these boundary contours and this genus."""
    if n_below + n_above == 0:
        return "unseen"
    return KIND_OF_ELEMENTARY.get((n_below, n_above), "compound") if genus == 0 else "compound"


def find_pieces(mesh, levels, contours, crossings, partner, member):
    """The :class:`Pieces` of a sliced surface.

    crossings : :class:`contours.Crossings`; partner : (n,) and member : (n + 2 C,)
    from :func:`pairing.pair_in_slabs`. Every contour bounds exactly one piece
    below it and one above; that is the exact link between the contours of
    consecutive levels.
    """
    slab, n, c = vertex_slabs(mesh, levels), len(mesh.points), len(contours.level)
    piece, piece_slab = _number_pieces(member, np.concatenate([slab, contours.level, contours.level + 1]) - 1)
    of_vertex, below, above = piece[:n], piece[n : n + c], piece[n + c :]
    count = len(piece_slab)
    n_below = np.bincount(above, minlength=count).astype(np.int32)
    n_above = np.bincount(below, minlength=count).astype(np.int32)
    index = vertex_indices(mesh)
    euler = np.rint(np.bincount(of_vertex, weights=index, minlength=count)).astype(np.int32)
    area, flux = _measure_pieces(
        mesh.points, mesh.faces, slab, crossings.offset, crossings.label,
        np.append(levels.height, np.inf), of_vertex, above, count,
    )  # fmt: skip
    essential = np.flatnonzero((index != 0) & (partner < 0))
    critical = _split_by(of_vertex[essential], essential, count)
    genus = (2 - n_below - n_above - euler) // 2
    return Pieces(piece_slab, of_vertex, above, below, n_below, n_above, euler, genus, area, flux, critical)


def _number_pieces(member, slab):
    """Number the pieces by slab, then by first member: the piece of every member, and the slab of every piece."""
    first = np.flatnonzero(member == np.arange(len(member)))
    first = first[np.argsort(slab[first], kind="stable")]
    name = np.empty(len(member), np.int32)
    name[first] = np.arange(len(first), dtype=np.int32)
    return name[member], slab[first]


def _split_by(group, values, n_groups):
    order = np.argsort(group, kind="stable")
    cuts = np.searchsorted(group[order], np.arange(1, n_groups))
    return np.split(values[order].astype(np.int32), cuts)


@njit(cache=True, inline="always")
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


@njit(cache=True)
def _measure_pieces(points, faces, slab, offset, label, ceiling, of_vertex, above, count):
    """Area and flux of (x, 0, 0) of every piece, face by face, slab by slab.

    A face in one horizontal plane counts whole where its middle vertex lies.
    """
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
            piece = of_vertex[a] if s == slab[a] else above[label[offset[f] + s - 1 - slab[a]]]
            area[piece] += whole * (share - seen)
            flux[piece] += 0.5 * nx * (moment - seen_x)
            seen, seen_x = share, moment
    return area, flux
