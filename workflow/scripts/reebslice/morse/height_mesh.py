"""The one way from arrays to a surface on which the height is a Morse function."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ReebsliceError
from ..mesh.arguments import check_fans, explain_open, take_arrays, take_bodies, take_mesh, take_rotation
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
        Or a `HeightMesh`, which is what comes back: the functions that build
        graphs and find pockets, islands and loops take one as well, so that
        several of them order a surface only once.
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
    if isinstance(points, HeightMesh):
        if faces is not None:
            raise ReebsliceError("faces are given beside a HeightMesh, which has its own: leave them out.")
        return points
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


def height_mesh_of_bodies(points, faces=None, rotation=None, body_of_vertex=None):
    """Order a surface as :func:`height_mesh` does, and find the body of each rank.

    Parameters
    ----------
    points, faces, rotation
        As for `height_mesh`.
    body_of_vertex : (n,) int, optional
        By default all are one body.

    Returns
    -------
    mesh : HeightMesh
    body_of_rank : (len(mesh.points),) int32

    Raises
    ------
    NotASolidError, ReebsliceError
        As of `height_mesh`; or the bodies are none.
    """
    mesh = height_mesh(points, faces, rotation)
    if isinstance(points, HeightMesh):
        count = max(int(mesh.vertex.max()) + 1, 0 if body_of_vertex is None else len(np.atleast_1d(body_of_vertex)))
    else:
        count = len(take_arrays(points, faces)[0])
    return mesh, take_bodies(body_of_vertex, count)[mesh.vertex]
