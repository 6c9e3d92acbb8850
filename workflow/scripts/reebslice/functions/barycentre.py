"""Distance from the centre of mass of the volume that a surface encloses."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import NotASolidError
from .canonical_order import canonical_surface


def barycentric_distance(points: Any, faces: ArrayLike | None = None) -> np.ndarray:
    """Measure how far each vertex is from the centre of mass.

    Parameters
    ----------
    points, faces
        As for :func:`.height_mesh`, but for a `HeightMesh`.

    Returns
    -------
    (n,) float64
        Straight distance of each point from the centre of mass of the solid of uniform density, mesh units; NaN of
        points in no face. It does not depend on where the model stands and how it is turned, but for rounding, nor at
        all on the order of vertices and faces.

    Raises
    ------
    NotASolidError
        The mesh is not as `height_mesh` wants it, or encloses no volume.

    Notes
    -----
    The centre is the sum over faces (a, b, c) of det(a, b, c) (a + b + c) / 4, over that of det(a, b, c): tetrahedra
    with a common apex, whose volumes have signs.

    References
    ----------
    M. Hilaga, Y. Shinagawa, T. Kohmura and T. L. Kunii, Topology matching for fully automatic similarity estimation
    of 3D shapes, SIGGRAPH 2001, doi:10.1145/383259.383282, on functions that do not depend on how a shape is turned.

    Examples
    --------
    >>> points = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]])
    >>> barycentric_distance(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).round(3).tolist()
    [1.732, 3.317, 3.317, 3.317]
    """
    surface = canonical_surface(points, faces)
    apex = surface.points.mean(axis=0)
    a, b, c = ((surface.points - apex)[surface.faces[:, k]] for k in range(3))
    sixfold = np.einsum("ij,ij->i", a, np.cross(b, c))
    if not sixfold.sum() > 0:
        raise NotASolidError(
            "The surface encloses no volume, so it has no centre of mass: give the surface of a solid."
        )
    centre = apex + (sixfold @ (a + b + c)) / (4 * sixfold.sum())
    return surface.spread(np.linalg.norm(surface.points - centre, axis=1))
