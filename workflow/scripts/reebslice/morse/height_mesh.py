"""The one way from arrays to a surface on which the height is a Morse function."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..mesh.arguments import check_fans, explain_open, take_mesh, take_rotation
from ..mesh.faults import find_used
from .ordered_mesh import HeightMesh, order_by_height
from .unfolding import unfold_saddles


def height_mesh(points: Any, faces: ArrayLike | None = None, rotation: ArrayLike | None = None) -> HeightMesh:
    """Order a surface by height and unfold its multiple saddles into simple ones.

    Parameters
    ----------
    points : (n, 3) float, mesh units
        Vertices, model frame. Or, with `faces` left out, a `trimesh.Trimesh` or
        a `pyvista.PolyData` of triangles. Points in no face are passed over.
    faces : (m, 3) int
        Vertex ids, counter-clockwise seen from outside, of a closed,
        edge-manifold, oriented surface in which the faces around every vertex
        are one fan. That it does not cross itself is taken for granted.
    rotation : (3, 3) float, optional
        From the model frame to the tilted frame, in which z is the height; by
        default the frames are one.

    Returns
    -------
    HeightMesh
        Its ranks order the vertices by height, equal heights told apart by x,
        then y, then the id (simulation of simplicity), so that the height is a
        Morse function whatever the coordinates. A k-fold saddle is k vertices
        with consecutive ranks, one position and one entry in `vertex`; hence
        there are at least n of them.

    Raises
    ------
    NotASolidError
        The arrays cannot be used, an id or a coordinate is out of range, the
        surface is open or not oriented, sheets touch in a vertex, or the faces
        point inward. The message says where, and the cure.
    ReebsliceError
        The rotation is none.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> mesh = height_mesh(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> mesh.vertex.tolist(), mesh.points[:, 2].tolist()
    ([0, 1, 2, 3], [0.0, 0.1, 0.2, 1.0])
    """
    points, faces = take_mesh(points, faces)
    matrix = take_rotation(rotation)
    used = find_used(len(points), faces)
    if len(used) < len(points):
        mesh = height_mesh(points[used], np.searchsorted(used, faces), matrix)
        return mesh._replace(vertex=used[mesh.vertex].astype(np.int32))
    try:
        mesh = order_by_height(points, faces, matrix)
    except ValueError:
        raise explain_open(points, faces) from None
    check_fans(mesh.points, mesh.faces, mesh.twins)
    return unfold_saddles(mesh)
