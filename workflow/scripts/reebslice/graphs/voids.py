"""The void: what is not material, around the solid and inside it.

A level set bounds material on one side and void on the other, so the void's
Reeb graph takes nothing new: the surface is turned inside out and put into a
box that is far larger. The solid of that surface is the void inside the box.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.sorting import order_floats
from ..kernels import njit
from ..mesh.half_edges import find_twins
from ..mesh.orders import canonical_faces
from ..morse.height_mesh import HeightMesh, height_mesh
from ..morse.reeb_graph import surface_reeb_graph
from .exact import ExactGraph, solid_reeb_graph

# Corners 4 z + 2 x + y of the box around all, in order of height, and its faces, counter-clockwise seen from outside.
_CORNERS = np.array([[k >> 1 & 1, k & 1, k >> 2] for k in range(8)], float)
_SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6]], np.int32)
_FACES = np.concatenate([_SIDES[:, [0, 1, 2]], _SIDES[:, [0, 2, 3]]])


def void_mesh(mesh):
    """Turn a surface inside out, in a box of about three times its size.

    Parameters
    ----------
    mesh : HeightMesh

    Returns
    -------
    HeightMesh
        Its solid is the void inside the box. Entries of `vertex` are those of `mesh`, or, for the eight corners
        of the box, larger. The box stands upright in the tilted frame.
    """
    corners, n = _box_around(mesh.points), len(mesh.points)
    points = np.concatenate([corners[:4], mesh.points, corners[4:]])
    faces, twins = _turn_inside_out(mesh.faces, mesh.twins)
    # the lower corners come before all that is in the box and the upper ones behind it, and so do their faces
    around = canonical_faces(_FACES, np.arange(8))
    low = int(np.searchsorted(around[:, 0], 4))
    own = find_twins(around, 8)
    own[own >= 3 * low] += 3 * len(faces)
    around[around >= 4] += n
    faces = np.concatenate([around[:low], faces + np.int32(4), around[low:]])
    twins = np.concatenate([own[: 3 * low], twins + np.int32(3 * low), own[3 * low :]])
    box = mesh.vertex.max() + 1 + np.arange(8, dtype=np.int32)
    return HeightMesh(points, faces, twins, np.concatenate([box[:4], mesh.vertex, box[4:]]))


@njit
def _turn_inside_out(faces, twins):
    """Faces and twins of a mesh in order of height with every face wound the other way, in lexicographic order."""
    m, first = len(faces), 0
    place = np.arange(m)  # of each face in the new order: among those of one lowest corner by the last corner
    while first < m:
        end = first + 1
        while end < m and faces[end, 0] == faces[first, 0]:
            end += 1
        if end - first > 24:
            order = order_floats(faces[first:end, 2].astype(np.float64))
            for i in range(len(order)):
                place[first + order[i]] = first + i
        else:  # counting those before each is faster than sorting so few
            for f in range(first, end):
                place[f] = first
                for g in range(first, end):
                    place[f] += faces[g, 2] < faces[f, 2]
        first = end
    turned, across = np.empty_like(faces), np.empty_like(twins)
    for f in range(m):
        turned[place[f], 0], turned[place[f], 1], turned[place[f], 2] = faces[f, 0], faces[f, 2], faces[f, 1]
        for k in range(3):
            twin = twins[3 * f + k]
            across[3 * place[f] + 2 - k] = 3 * place[twin // 3] + 2 - twin % 3
    return turned, across


def box_in(points, faces):
    """Turn a surface inside out and put it into an upright box of three times its size and more.

    Parameters
    ----------
    points : (n, 3) float64
        All of them in faces.
    faces : (m, 3) int

    Returns
    -------
    points : (n + 8, 3) float64
        The corners of the box come last, in order of height, then x, then y.
    faces : (m + 12, 3) int
    """
    return np.concatenate([points, _box_around(points)]), np.concatenate([faces[:, ::-1], _FACES + len(points)])


def _box_around(points):
    """The corners of an upright box of three times the size of some points and more, in order of height, (8, 3)."""
    low, high = (np.array([end(column) for column in points.T]) for end in (np.min, np.max))
    margin = (high - low).max()
    return low - margin + _CORNERS * (high - low + 2 * margin)


def void_reeb_graph(points: Any, faces: ArrayLike | None = None, rotation: ArrayLike | None = None) -> ExactGraph:
    """Build the Reeb graph of the void: of all space but the solid that a surface bounds.

    Parameters
    ----------
    points : (n, 3) float, mesh units
        Or, with `faces` left out, a `trimesh.Trimesh`, a `pyvista.PolyData` or a :class:`HeightMesh`.
    faces : (m, 3) int
        Of a surface as for :func:`exact_graphs`, which does not cross itself, be it of one body or of several.
    rotation : (3, 3) float, optional
        The height is its third row times a point; by default z.

    Returns
    -------
    ExactGraph
        A point of it is a connected component of the void at a height. The
        space around the solid begins at a node of the height -inf and ends at
        one of +inf, both with the vertex -1. Every other component of the graph
        is a sealed void. The graph has as many components as the solid has
        voids and one more, and at most as many loops as the solid has
        (Alexander duality). Pairs of critical points at one height, inside
        flats, that cancel are left out.

    Raises
    ------
    NotASolidError, ReebsliceError, TooManyCrossingsError
        As of :func:`exact_graphs`.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> void = void_reeb_graph(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> void.height.tolist(), void.arcs.tolist()
    ([-inf, 0.0, 1.0, inf], [[0, 1], [1, 2], [2, 3]])
    """
    mesh = void_mesh(height_mesh(points, faces, rotation))
    nodes, arcs = solid_reeb_graph(mesh, surface_reeb_graph(mesh), np.zeros(len(mesh.points), np.int32))
    outside = mesh.vertex[nodes] >= mesh.vertex.max() - 7  # the corners of the box come last
    far = np.where(mesh.points[nodes, 2] < np.median(mesh.points[[0, -1], 2]), -np.inf, np.inf)
    return ExactGraph(
        np.where(outside, -1, mesh.vertex[nodes]).astype(np.int32),
        np.where(outside, far, mesh.points[nodes, 2]),
        arcs,
    )
