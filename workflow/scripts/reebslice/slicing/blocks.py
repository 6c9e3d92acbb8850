"""Blocks: components of the solid between two consecutive levels."""

from typing import NamedTuple

import numpy as np

from ..arrays.components import find, join
from ..kernels import njit


class Blocks(NamedTuple):
    """B blocks of the solid.

    Attributes
    ----------
    of_piece : (P,) int32
        The block that each piece bounds.
    above, below : (R,) int32
        The block on the upper and on the lower side of every region.
    count : int
        Number of blocks.
    """

    of_piece: np.ndarray
    above: np.ndarray
    below: np.ndarray
    count: int  # type: ignore[assignment]  # a method of tuples is called so


def find_blocks(pieces, contours, regions, unseen_host):
    """Find the connected components of the solid in each slab, which regions and pieces hold together.

    Parameters
    ----------
    pieces : Pieces
        P pieces.
    contours : Contours
        C contours.
    regions : Regions
        R regions.
    unseen_host : dict of int to int
        For each closed void wholly inside a slab a piece of the block that surrounds it: what
        :func:`host_unseen_voids` returns.

    Returns
    -------
    Blocks
        Numbered by their first piece.
    """
    r, p = len(regions.level), len(pieces.slab)
    hosts = np.array(sorted(unseen_host.items()), np.int64).reshape(-1, 2)
    root = _join_blocks(r, p, regions.of_contour, pieces.piece_above, pieces.piece_below, hosts)
    _, block = np.unique(root, return_inverse=True)
    of_piece, above, below = (part.astype(np.int32) for part in np.split(block, [p, p + r]))
    return Blocks(of_piece, above, below, block.max() + 1)


@njit
def _join_blocks(r, p, region, piece_above, piece_below, hosts):
    """Union-find over p pieces, then r regions seen from above, then from below: the root of each."""
    root = np.arange(p + 2 * r)
    for c in range(len(region)):
        join(root, p + region[c], piece_above[c])
        join(root, p + r + region[c], piece_below[c])
    for i in range(len(hosts)):
        join(root, hosts[i, 0], hosts[i, 1])
    for i in range(len(root)):
        root[i] = find(root, i)
    return root


def host_unseen_voids(mesh, levels, crossings, pieces, surfaces, body_of_vertex):
    """Find, for each closed void wholly inside a slab, a piece of the block around it.

    Each takes one point location: from the void's lowest vertex along +x to the first face of the same body.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    levels : Levels
        The cuts.
    crossings : Crossings
        Those of :func:`.contours.trace_crossings`.
    pieces : Pieces
        P pieces.
    surfaces : PieceSurfaces
        Theirs.
    body_of_vertex : (n,) int32
        Bodies that may overlap.

    Returns
    -------
    dict of int to int
        The host of every void, both pieces. A void is left out if the ray meets no face of its body.
    """
    hosts = {}
    closed = (pieces.n_below + pieces.n_above == 0) & (surfaces.flux < 0)
    for piece in np.flatnonzero(closed):
        vertex = int(np.flatnonzero(surfaces.of_vertex == piece)[0])
        face = _first_face_along_x(mesh.points, mesh.faces, vertex, body_of_vertex, surfaces.of_vertex)
        if face >= 0:
            lowest = int(mesh.faces[face, 0])
            steps = int(pieces.slab[piece]) + 1 - int(np.searchsorted(levels.below, lowest, side="right"))
            contour = crossings.label[crossings.offset[face] + steps - 1] if steps else None
            hosts[int(piece)] = int(pieces.piece_above[contour] if steps else surfaces.of_vertex[lowest])
    return hosts


@njit
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
