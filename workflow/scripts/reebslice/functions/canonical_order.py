"""A surface in an order of its own, so that what is summed over it rounds alike whatever the order in the file."""

from typing import NamedTuple

import numpy as np

from ..mesh.arguments import explain_open, take_mesh
from ..mesh.faults import find_used
from ..morse.ordered_mesh import order_by_height


class CanonicalSurface(NamedTuple):
    """The vertices of a surface that are in some face, in order of (z, x, y, id), and its faces in that of theirs.

    Attributes
    ----------
    points : (n, 3) float64
        Model frame.
    faces : (m, 3) int32
    vertex : (n,) int
        The row of each vertex in the arrays that were given.
    given : int
        Rows of points there.
    """

    points: np.ndarray
    faces: np.ndarray
    vertex: np.ndarray
    given: int

    def spread(self, values):
        """Values of the points that were given, (given,) float64, from those of the vertices; NaN in no face."""
        out = np.full(self.given, np.nan)
        out[self.vertex] = values
        return out


def canonical_surface(points, faces=None):
    """Put a surface in canonical order.

    Parameters
    ----------
    points, faces
        As for :func:`..morse.height_mesh.height_mesh`, but for a `HeightMesh`.

    Returns
    -------
    CanonicalSurface
        Whatever the order of vertices and faces, unless vertices coincide.

    Raises
    ------
    NotASolidError
        The arrays are none of a closed, oriented surface.
    """
    points, faces = take_mesh(points, faces)
    used = find_used(len(points), faces)
    try:
        mesh = order_by_height(points[used], np.searchsorted(used, faces), np.eye(3))
    except ValueError:
        raise explain_open(points, faces) from None
    return CanonicalSurface(mesh.points, mesh.faces, used[mesh.vertex], len(points))
