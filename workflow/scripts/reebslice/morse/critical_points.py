"""Critical points of the height on a surface: their indices and how many there are."""

import numpy as np

from ..kernels import njit


def vertex_indices(mesh):
    """Compute the piecewise-linear index of every vertex.

    One minus half the sign changes around the link; a sign change is a face in
    which the vertex is the middle one.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices, unfolded or not.

    Returns
    -------
    (n,) int32
        1 at an extremum, 0 at a regular vertex, -k at a k-fold saddle. They sum
        to the Euler characteristic.

    References
    ----------
    T. F. Banchoff, Critical points and curvature for embedded polyhedra,
    Journal of Differential Geometry 1 (1967), doi:10.4310/jdg/1214428092, and
    Critical points and curvature for embedded polyhedral surfaces, American
    Mathematical Monthly 77 (1970)
    """
    return _count_indices(mesh.faces, len(mesh.points))


@njit
def _count_indices(faces, n):
    """Vertex indices from faces that have their lowest corner first."""
    twice = np.full(n, 2, np.int32)
    for f in range(faces.shape[0]):
        twice[min(faces[f, 1], faces[f, 2])] -= 1
    return twice // 2


def morse_indices(mesh, vertices):
    """Tell minima, saddles and maxima apart.

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    vertices : (k,) int
        Ranks of critical points.

    Returns
    -------
    (k,) int32
        Morse index: 0 minimum, 1 saddle, 2 maximum.
    """
    is_top = np.zeros(len(mesh.points), bool)  # some face has it as its highest corner
    is_top[np.maximum(mesh.faces[:, 1], mesh.faces[:, 2])] = True  # the first corner is the lowest
    saddle = vertex_indices(mesh)[vertices] < 0
    return np.where(saddle, 1, np.where(is_top[vertices], 2, 0)).astype(np.int32)


def count_critical_points(points, faces):
    """Count minima, saddles and maxima of the height without putting the vertices in order.

    Parameters
    ----------
    points : (n, 3) float64
        Vertices, tilted frame.
    faces : (m, 3) int32
        Vertex ids of a closed surface in which the faces around every vertex
        are one fan.

    Returns
    -------
    dict
        minima, saddles, maxima : int; a k-fold saddle counts k times. As of the
        `HeightMesh`: equal heights are told apart by x, then y, then the id.
    """
    index, is_lowest = _find_indices(points, faces)
    return {
        "minima": int(((index == 1) & is_lowest).sum()),
        "saddles": -int(index[index < 0].sum()),
        "maxima": int(((index == 1) & ~is_lowest).sum()),
    }


@njit
def _find_indices(points, faces):
    """Index of every vertex, (n,) int32, and whether it is the lowest corner of some face, (n,) bool."""
    twice, is_lowest = np.full(len(points), 2, np.int32), np.zeros(len(points), np.bool_)
    for f in range(len(faces)):
        low, middle, high = faces[f]
        if _is_below(points, middle, low):
            low, middle = middle, low
        if _is_below(points, high, middle):
            middle, high = high, middle
            if _is_below(points, middle, low):
                low, middle = middle, low
        twice[middle] -= 1
        is_lowest[low] = True
    return twice // 2, is_lowest


@njit(inline="always")
def _is_below(points, v, w):
    """Whether vertex v comes before w in the order of (z, x, y, id)."""
    if points[v, 2] != points[w, 2]:
        return points[v, 2] < points[w, 2]
    if points[v, 0] != points[w, 0]:
        return points[v, 0] < points[w, 0]
    return points[v, 1] < points[w, 1] or (points[v, 1] == points[w, 1] and v < w)
