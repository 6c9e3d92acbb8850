"""Rays that meet faces."""

import numpy as np


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
