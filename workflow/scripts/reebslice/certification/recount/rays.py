"""Rays that meet faces."""

import numpy as np
import shapely


def first_face_along_x(corners, x, y, z):
    """The first face, of (m, 3, 3) corners, that a ray along +x meets; -1 for none."""
    hits = _hits(corners, x, y, z)
    return min(hits, key=lambda hit: hit[0])[1] if hits else -1


def _hits(corners, x, y, z):
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = np.flatnonzero(
        (low[:, 1] <= y) & (y <= high[:, 1]) & (low[:, 2] <= z) & (z <= high[:, 2]) & (high[:, 0] >= x)
    )
    a, b, c = corners[near].transpose(1, 0, 2)

    def part(p, q):
        return (p[:, 1] - y) * (q[:, 2] - z) - (p[:, 2] - z) * (q[:, 1] - y)

    u, v, w = part(b, c), part(c, a), part(a, b)
    total = u + v + w
    met = ((u > 0) == (v > 0)) & ((v > 0) == (w > 0)) & (total != 0)
    where = np.divide(u * a[:, 0] + v * b[:, 0] + w * c[:, 0], total, out=np.zeros(len(u)), where=met)
    met &= where > x
    return list(zip(where[met].tolist(), near[met].tolist()))


def meet_faces(corners, starts):
    """Rays along +x and faces that they meet, forward or backward: (ray, face, distance)."""
    low, high = corners[:, :, 1:].min(axis=1), corners[:, :, 1:].max(axis=1)
    tree = shapely.STRtree(shapely.box(*low.T, *high.T))
    ray, face = tree.query(shapely.points(starts[:, 1:]))
    x, y, z = starts[ray].T
    a, b, c = corners[face].transpose(1, 0, 2)

    def part(p, q):
        return (p[:, 1] - y) * (q[:, 2] - z) - (p[:, 2] - z) * (q[:, 1] - y)

    u, v, w = part(b, c), part(c, a), part(a, b)
    total = u + v + w
    met = ((u > 0) == (v > 0)) & ((v > 0) == (w > 0)) & (total != 0)
    where = (u * a[:, 0] + v * b[:, 0] + w * c[:, 0])[met] / total[met]
    return ray[met], face[met], where - x[met]
