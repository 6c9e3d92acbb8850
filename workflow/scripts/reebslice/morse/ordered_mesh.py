"""The surface in the tilted frame, its vertices in order of height, its multiple saddles as they are.

Everything combinatorial is decided here, once, on ranks: a vertex is above
another iff its rank is larger. Ties of height are broken by the two other
coordinates of the tilted frame, which is an infinitesimal tilt (simulation of
simplicity, SoS). A flat face is monotone in that order, so it makes no critical
points of its own. Of vertices at one position, where sheets touch, maxima come
first and minima last, as if the sheets were pulled apart; the rest by id.

A level is given by ranks as well, by its `cut`: the ranks from `cut` on are
above it. A half-edge is *upward* if it runs from a lower to a higher rank; each
contour crosses one upward half-edge of every mesh edge that it crosses.

References
----------
H. Edelsbrunner and E. P. Muecke, Simulation of simplicity, ACM Transactions on
Graphics 9 (1990), doi:10.1145/77635.77639
"""

from typing import NamedTuple

import numpy as np

from ..errors import ReebsliceError
from ..kernels import njit
from ..mesh.half_edges import find_twins
from ..mesh.orders import canonical_faces, height_order, order_copies


class HeightMesh(NamedTuple):
    """A closed oriented surface whose vertex ids are ranks of height.

    Attributes
    ----------
    points : (n, 3) float64
        Tilted frame, in ascending order of (z, x, y); see above for those at one position.
    faces : (m, 3) int32
        Ranks, counter-clockwise seen from outside, the lowest of each face
        first; in lexicographic order, which does not depend on the input's.
    twins : (3 m,) int32
        Half-edge 3 f + k runs from faces[f, k] to faces[f, (k + 1) % 3]; its
        twin runs back along the same mesh edge.
    vertex : (n,) int32
        The surface vertex that each rank stands for.
    """

    points: np.ndarray
    faces: np.ndarray
    twins: np.ndarray
    vertex: np.ndarray


def check_ordered(mesh):
    """Raise ReebsliceError unless `mesh` is a :class:`HeightMesh`."""
    if not isinstance(mesh, HeightMesh):
        raise ReebsliceError(
            f"mesh is a {type(mesh).__name__}, not a HeightMesh: make one by reebslice.height_mesh(points, faces)."
        )


def tilt_points(points, rotation):
    """Rotate points to the tilted frame.

    Each coordinate is summed in the order x, y, z, vertex by vertex: a matrix
    product may round a row differently depending on its place in the array, and
    ranks must not depend on that.

    Parameters
    ----------
    points : (n, 3) float
        Model frame, mesh units.
    rotation : (3, 3) float
        From the model frame to the tilted frame.

    Returns
    -------
    (n, 3) float64
        The points in the tilted frame; the third coordinate is the height.
    """
    return _rotate(np.ascontiguousarray(points, dtype=float), np.ascontiguousarray(rotation, dtype=float))


@njit
def _rotate(points, rotation):
    out = np.empty(points.shape)
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for r in range(3):
            out[i, r] = rotation[r, 0] * x + rotation[r, 1] * y + rotation[r, 2] * z
    return out


def order_by_height(points, faces, rotation):
    """Order a surface by height, multiple saddles as they are.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, model frame.
    faces : (m, 3) int
        Vertex ids, counter-clockwise seen from outside, of a closed,
        edge-manifold, oriented surface.
    rotation : (3, 3) float
        From the model frame to the tilted frame.

    Returns
    -------
    HeightMesh
        The same whatever the order of the faces and, if no two vertices
        coincide, of the vertices, but for `vertex`.

    Raises
    ------
    ValueError
        Where a mesh edge has no twin.
    """
    tilted = tilt_points(points, rotation)
    vertex = order_copies(height_order(tilted), tilted, faces)
    rank = np.empty(len(vertex), np.int32)
    rank[vertex] = np.arange(len(vertex), dtype=np.int32)
    faces = canonical_faces(faces, rank)
    return HeightMesh(_pick_rows(tilted, vertex), faces, find_twins(faces, len(vertex)), vertex)


@njit
def _pick_rows(points, chosen):
    """points[chosen], several times as fast for rows of three."""
    out = np.empty((len(chosen), 3))
    for i in range(len(chosen)):
        for k in range(3):
            out[i, k] = points[chosen[i], k]
    return out


@njit(inline="always")
def next_half_edge(faces, twins, h, cut):
    """Follow a contour from one crossing to the next, material on its left.

    Parameters
    ----------
    faces, twins : arrays
        Of a `HeightMesh`.
    h : int
        The upward half-edge at which the contour crosses.
    cut : int
        The level: ranks from `cut` on are above it.

    Returns
    -------
    int
        The upward half-edge at which it crosses next.
    """
    down = twins[h]
    face, corner = down // 3, down % 3
    return 3 * face + ((corner + 1) % 3 if faces[face, (corner + 2) % 3] >= cut else (corner + 2) % 3)


@njit(inline="always")
def cross_at(low, high, z, x, y):
    """Find where a mesh edge meets a plane; positions only, which edges cross is decided on ranks.

    Parameters
    ----------
    low, high : (3,) float
        Ends of the mesh edge, the lower rank first.
    z, x, y : float
        The plane is horizontal, at height z, tilted infinitesimally so that it
        passes through (x, y): of two ends at exactly the height z the one with
        the smaller (x, y) is below. x and y may be NaN where no end is at z.

    Returns
    -------
    tuple of float
        x and y of the crossing; the middle of a mesh edge whose ends coincide.
    """
    if low[2] < high[2]:
        t = (z - low[2]) / (high[2] - low[2])
    elif low[0] < high[0]:
        t = (x - low[0]) / (high[0] - low[0])
    elif low[1] < high[1]:
        t = (y - low[1]) / (high[1] - low[1])
    else:
        t = 0.5
    t = min(max(t, 0.0), 1.0)
    return low[0] + t * (high[0] - low[0]), low[1] + t * (high[1] - low[1])
