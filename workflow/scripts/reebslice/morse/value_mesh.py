"""The one way from values at vertices to a surface on which they are a Morse function."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ReebsliceError
from ..mesh.arguments import check_fans, explain_open, take_mesh
from ..mesh.faults import find_used
from ..mesh.half_edges import find_twins
from ..mesh.orders import canonical_faces, height_order, order_copies
from .ordered_mesh import HeightMesh, tilt_points
from .unfolding import unfold_saddles


class ValueMesh(NamedTuple):
    """A closed oriented surface whose vertex ids are ranks of a function.

    Attributes
    ----------
    points : (n, 3) float64
        First and second coordinate of the model frame and, where a :class:`HeightMesh` has the height, the value;
        in ascending order of (value, z, x, y), those that tie in all as in a `HeightMesh`. Where the vertices are in
        space, `vertex` tells.
    faces, twins, vertex
        As of a `HeightMesh`.
    """

    points: np.ndarray
    faces: np.ndarray
    twins: np.ndarray
    vertex: np.ndarray


def value_mesh(values: ArrayLike, points: Any, faces: ArrayLike | None = None) -> ValueMesh:
    """Order a surface by any function of its vertices and unfold its multiple saddles into simple ones.

    Parameters
    ----------
    values : (n,) float
        The function, linear on every face. Of points in no face any number, or none (NaN).
    points, faces
        As for :func:`.height_mesh.height_mesh`, but for a `HeightMesh`.

    Returns
    -------
    ValueMesh
        What :func:`.reeb_graph.surface_reeb_graph` takes. Equal values are told apart as vertices are by height: by
        z, then x, then y (simulation of simplicity), then maxima before and minima after the rest, then the id. So a
        flat is monotone in this order, and the z of the points as values make the same order as the height. Nothing
        but the order counts, except where a multiple saddle may come apart in several ways.

    Raises
    ------
    NotASolidError
        The mesh is not as `height_mesh` wants it.
    ReebsliceError
        There is not one finite real number for each point. The message says where, and the cure.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> mesh = value_mesh([3, 1, 2, 0], points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> mesh.vertex.tolist(), mesh.points[:, 2].tolist()
    ([3, 1, 2, 0], [0.0, 1.0, 2.0, 3.0])
    """
    points, faces = take_mesh(points, faces)
    used = find_used(len(points), faces)
    numbers = _take_values(values, len(points), used)
    if len(used) < len(points):
        mesh = value_mesh(numbers[used], points[used], np.searchsorted(used, faces))
        return mesh._replace(vertex=used[mesh.vertex].astype(np.int32))
    placed = tilt_points(points, np.eye(3))
    vertex = height_order(placed)
    vertex = vertex[np.argsort(numbers[vertex], kind="stable")]
    vertex = order_copies(vertex, np.column_stack([placed, numbers]), faces)
    rank = np.empty(len(vertex), np.int32)
    rank[vertex] = np.arange(len(vertex), dtype=np.int32)
    faces_of_ranks = canonical_faces(faces, rank)
    try:
        twins = find_twins(faces_of_ranks, len(vertex))
    except ValueError:
        raise explain_open(points, faces) from None
    placed = placed[vertex]
    check_fans(placed, faces_of_ranks, twins)
    lifted = np.column_stack([placed[:, :2], numbers[vertex]])
    return ValueMesh(*unfold_saddles(HeightMesh(lifted, faces_of_ranks, twins, vertex)))


def _take_values(values, count, used):
    """One finite number for each of `count` points, those in no face left aside, (count,) float64 without -0.0."""
    try:
        taken = np.asarray(values)
    except ValueError:
        raise ReebsliceError(
            f"values has rows of unequal length: give one number for each of {count} points."
        ) from None
    if taken.ndim != 1 or len(taken) != count:
        raise ReebsliceError(
            f"values has the shape {taken.shape}, but there are {count} points: give one number for each, shape"
            f" ({count},)."
        )
    if taken.dtype.kind not in "buif":
        raise ReebsliceError(f"values holds values of type {taken.dtype}: give real numbers.")
    taken = taken.astype(np.float64) + 0.0
    bad = used[~np.isfinite(taken[used])]
    if len(bad):
        raise ReebsliceError(
            f"{len(bad)} values are not finite, the first is values[{bad[0]}] = {taken[bad[0]]}: give a number for"
            " every point of a face; the order of vertices with none would be a guess."
        )
    return taken
