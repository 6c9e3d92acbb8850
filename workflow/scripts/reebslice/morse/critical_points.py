"""Critical points of the height: their indices, sides, and simple saddles."""

import numpy as np
from numba import njit


def vertex_indices(mesh):
    """PL index of every vertex, (n,) int32: 1 extremum, 0 regular, -1 saddle.

    One minus half the sign changes around the link (Banchoff 1967,
    doi:10.1007/BF01076127); a sign change is a face in which the vertex is
    the middle one. Values below -1 are multiple saddles.
    """
    return _count_indices(mesh.faces, len(mesh.points))


@njit(cache=True)
def _count_indices(faces, n):
    twice = np.full(n, 2, np.int32)
    for f in range(faces.shape[0]):
        twice[min(faces[f, 1], faces[f, 2])] -= 1  # the first corner is the lowest
    return twice // 2


def morse_indices(mesh, vertices):
    """Morse index (0, 1, 2) of critical `vertices` of an unfolded mesh, (k,) int32."""
    is_top = np.zeros(len(mesh.points), bool)  # some face has it as its highest corner
    is_top[np.maximum(mesh.faces[:, 1], mesh.faces[:, 2])] = True  # the first corner is the lowest
    saddle = vertex_indices(mesh)[vertices] < 0
    return np.where(saddle, 1, np.where(is_top[vertices], 2, 0)).astype(np.int32)
