"""Rays that meet faces."""

import shapely


def meet_faces(corners, starts):
    """Find the faces that rays along +x, and their continuations backward, pass through.

    Parameters
    ----------
    corners : (m, 3, 3) float64
        Corners of the faces.
    starts : (q, 3) float64
        Starts of the rays. One that meets a mesh edge exactly meets none of its faces.

    Returns
    -------
    ray, face : (k,) int64
        The pairs that meet.
    ahead : (k,) float64
        How far the face is from the start, negative behind it.
    """
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
