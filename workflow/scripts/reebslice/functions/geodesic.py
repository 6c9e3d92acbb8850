"""Distance along a surface from a tip of it, by the heat method of potpourri3d.

The heat method, with the intrinsic Delaunay Laplacian of Sharp and Crane, is off by some percent, but smooth: it makes
fewer critical points than the exact distance of Mitchell, Mount and Papadimitriou, and takes seconds where that takes
minutes on the slivers of CAD models. The graph is exact for the function that it gives, whatever that is.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.components import connected_items
from ..errors import ReebsliceError
from .canonical_order import canonical_surface


def geodesic_distance(points: Any, faces: ArrayLike | None = None) -> np.ndarray:
    """Measure how far each vertex is from the tip of its shell, along the surface.

    Parameters
    ----------
    points, faces
        As for :func:`.height_mesh`, but for a `HeightMesh`.

    Returns
    -------
    (n,) float64
        Mesh units, 0 at the tips; NaN of points in no face. Every connected shell has a tip of its own: the vertex
        that is farthest along the shell from the one that is farthest, in a straight line, from the centre of its
        area. In a tube that is an end. Of vertices equally far it is the first by z, then x, then y. The values do
        not depend on the order of vertices and faces at all, and on place and rotation of the model by little more
        than rounding, unless two vertices are nearly as far.

    Raises
    ------
    NotASolidError
        The mesh is not as `height_mesh` wants it.
    ReebsliceError
        There is no package potpourri3d, or the heat method fails on the mesh.

    References
    ----------
    K. Crane, C. Weischedel and M. Wardetzky, Geodesics in heat, ACM Transactions on Graphics 32 (2013),
    doi:10.1145/2516971.2516977

    N. Sharp and K. Crane, A Laplacian for nonmanifold triangle meshes, Computer Graphics Forum 39 (2020),
    doi:10.1111/cgf.14069

    Examples
    --------
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5]])
    >>> int(geodesic_distance(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).argmax())
    3
    """
    surface = canonical_surface(points, faces)
    shell = connected_items(surface.faces[:, :2].ravel(), surface.faces[:, 1:].ravel(), len(surface.points))
    values = np.empty(len(surface.points))
    place = np.empty(len(shell), np.int64)
    # one shell at a time: in a shell without a tip the heat method gives numbers, too, which mean nothing
    for number in range(shell.max() + 1):
        chosen = np.flatnonzero(shell == number)
        place[chosen] = np.arange(len(chosen))
        values[chosen] = _distance_from_tip(
            surface.points[chosen], place[surface.faces[shell[surface.faces[:, 0]] == number]]
        )
    return surface.spread(values)


def _distance_from_tip(points, faces):
    """Distance (n,) of the vertices of one shell from its tip."""
    try:
        from potpourri3d import MeshHeatMethodDistanceSolver  # which not all that imports the library needs
    except ImportError:
        raise ReebsliceError("geodesic distance takes the package potpourri3d: pip install potpourri3d") from None
    low, high = points.min(axis=0), points.max(axis=0)
    unit = 2.0 ** np.floor(np.log2((high - low).max()))  # a power of two, so that scaling rounds nothing
    scaled = (points - (low + high) / 2) / unit
    try:
        solver = MeshHeatMethodDistanceSolver(scaled, faces)
        start = np.linalg.norm(scaled - _centre_of_area(scaled, faces), axis=1).argmax()
        values = solver.compute_distance(solver.compute_distance(start).argmax())
    except (ValueError, RuntimeError) as fault:
        raise ReebsliceError(f"no geodesic distance: the heat method fails on the mesh ({fault}).") from None
    if not np.isfinite(values).all():
        raise ReebsliceError(
            "no geodesic distance: the heat method gives values that are not finite, as it does on faces almost"
            " without area; remesh the surface."
        )
    return values * unit


def _centre_of_area(points, faces):
    """The mean point of the surface, (3,)."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return area @ (a + b + c) / (3 * area.sum())
