"""The one way from arrays to a surface on which the height is a Morse function."""

import numpy as np

from .ordered_mesh import HeightMesh, order_by_height
from .unfolding import unfold_saddles


def height_mesh(points, faces, rotation=None) -> HeightMesh:
    """Order a surface by height and unfold its multiple saddles into simple ones.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, model frame, finite.
    faces : (m, 3) int
        Vertex ids, counter-clockwise seen from outside, of a closed,
        edge-manifold, oriented surface in which the faces around every vertex
        are one fan. This is taken for granted but for the mesh edges.
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
    ValueError
        Where a mesh edge does not lie in exactly two faces that run along it in
        opposite directions.
    """
    return unfold_saddles(order_by_height(points, faces, np.eye(3) if rotation is None else rotation))
