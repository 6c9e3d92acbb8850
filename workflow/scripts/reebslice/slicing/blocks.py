"""Blocks: components of the solid between two consecutive levels."""

import numpy as np
from numba import njit

from ..arrays.components import find, join


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
