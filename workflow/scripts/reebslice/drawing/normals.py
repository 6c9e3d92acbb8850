"""Normals of a triangle mesh that are smooth except across creases."""

from typing import NamedTuple

import numpy as np

from ..kernels import njit

FLAT_VALENCE = 64  # faces around a vertex, beyond which it is the tip of a cone or the centre of a cap, and flat


class VertexNormals(NamedTuple):
    """Normals of n vertices, where they are smooth, and the faces around the others.

    Attributes
    ----------
    crease : float
        Angle in degrees from which two faces make a crease.
    smooth : (n, 3) float32
        Unit normal of a vertex, the area-weighted mean over its faces; 0 where two of them meet at a crease.
    around : (k,) int32
        Faces around the vertices that are not smooth, save for those with more
        than `FLAT_VALENCE` faces (tips, centres of caps).
    start : (n + 1,) int32
        Vertex v owns around[start[v]:start[v + 1]].
    """

    crease: float
    smooth: np.ndarray
    around: np.ndarray
    start: np.ndarray


def find_vertex_normals(points, faces, crease):
    """Find the normals of vertices whose faces meet at less than a crease.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int
    crease : float
        Degrees.

    Returns
    -------
    VertexNormals
    """
    return VertexNormals(crease, *_find_vertex_normals(points, faces, crease))


@njit
def _find_vertex_normals(points, faces, crease):
    """Smooth normals (n, 3), and the faces around the other vertices, as in :class:`VertexNormals`."""
    total, count = np.zeros((len(points), 3)), np.zeros(len(points), np.int32)
    for f in range(len(faces)):
        x, y, z, area = _face_normal(points, faces, f)
        for i in range(3):
            v = faces[f, i]
            total[v, 0] += area * x
            total[v, 1] += area * y
            total[v, 2] += area * z
            count[v] += 1
    smooth = np.zeros((len(points), 3), np.float32)
    for v in range(len(points)):
        x, y, z = total[v, 0], total[v, 1], total[v, 2]
        length = np.sqrt(x * x + y * y + z * z)
        if length > 0 and count[v] <= FLAT_VALENCE:
            smooth[v, 0], smooth[v, 1], smooth[v, 2] = x / length, y / length, z / length
    # Where all normals lie within half a crease of their mean, any two are within a crease.
    bound, start = np.cos(np.radians(0.49 * crease)), np.zeros(len(points) + 1, np.int32)
    creased = np.zeros(len(points), np.bool_)
    for f in range(len(faces)):
        x, y, z, area = _face_normal(points, faces, f)
        for i in range(3):
            v = faces[f, i]
            if area > 0 and smooth[v, 0] * x + smooth[v, 1] * y + smooth[v, 2] * z < bound:
                creased[v] = count[v] <= FLAT_VALENCE
    for v in range(len(points)):
        start[v + 1] = start[v]
        if creased[v]:
            smooth[v] = 0
            start[v + 1] += count[v]
    around, fill = np.empty(start[-1], np.int32), start.copy()
    for f in range(len(faces) if len(around) else 0):
        for i in range(3):
            if creased[faces[f, i]]:
                around[fill[faces[f, i]]] = f
                fill[faces[f, i]] += 1
    return smooth, around, start


@njit(inline="always")
def _face_normal(points, faces, f):
    """Unit normal of a face and twice its area; all 0 of a face without area."""
    a, b, c = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
    ux, uy, uz, vx, vy, vz = b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx  # their cross product
    length = np.sqrt(x * x + y * y + z * z)
    over = 1.0 / length if length > 0 else 0.0
    return x * over, y * over, z * over, length


@njit
def corner_normals(points, faces, f, normals, out):
    """Find the normals at the corners of a face.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int
    f : int
        The face.
    normals : VertexNormals
    out : (3, 3) float64
        Filled with unit normals, one row per corner: that of the vertex, where
        it is smooth; else the area-weighted mean over those faces around it
        whose normals lie within a crease of the face's own. At vertices of very
        many faces it is the face's own. 0 for a face without area.

    Returns
    -------
    (3, 3) float64
        `out`.
    """
    smooth, around, start = normals.smooth, normals.around, normals.start
    bound, flat = np.cos(np.radians(normals.crease)), _face_normal(points, faces, f)
    for i in range(3):
        v = faces[f, i]
        out[i, 0], out[i, 1], out[i, 2] = smooth[v, 0], smooth[v, 1], smooth[v, 2]
        if smooth[v, 0] == 0 and smooth[v, 1] == 0 and smooth[v, 2] == 0:
            x = y = z = 0.0
            for k in range(start[v], start[v + 1]):
                p, q, r, area = _face_normal(points, faces, around[k])
                if p * flat[0] + q * flat[1] + r * flat[2] >= bound:
                    x, y, z = x + area * p, y + area * q, z + area * r
            length = np.sqrt(x * x + y * y + z * z)
            if length > 0:
                out[i, 0], out[i, 1], out[i, 2] = x / length, y / length, z / length
            else:
                out[i, 0], out[i, 1], out[i, 2] = flat[0], flat[1], flat[2]
    return out
