"""Pockets of the void and islands of the solid: components that height alone cuts off.

What holds liquid is a component of the void below some height that does not
reach the space around; what catches air is one above some height. Both, and
what begins in the air when built upward, are components of sublevel or
superlevel sets, which the graph's extended persistence pairs with the critical
points where they end.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.components import find, join
from ..arrays.grouping import Groups
from ..kernels import njit
from ..mesh.arguments import LEAST, take_number
from ..morse.height_mesh import height_mesh, height_mesh_of_bodies
from ..morse.persistence import extended_pairs
from ..morse.reeb_graph import surface_reeb_graph
from .exact import solid_reeb_graph
from .pocket_measures import Pockets, measure_pockets
from .voids import void_mesh


def find_pockets(
    points: Any,
    faces: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
    least_depth: float = 0.0,
    distance: float | None = None,
) -> Pockets:
    """Find where liquid stays, where air is caught, and what is sealed, in the direction of height.

    Parameters
    ----------
    points, faces, rotation
        As for :func:`.voids.void_reeb_graph`.
    least_depth : float
        Basins and bells less deep are left out, mesh units; noise makes many.
    distance : float, optional
        Upper bound of the spacing of the levels at which largest sections and throats are looked for, mesh units;
        by default 1/200 of the height from the lowest end of a pocket to the highest.

    Returns
    -------
    Pockets
        Sealed voids, basins, then bells, each by vertex and height of their
        beginnings. A basin is a minimum of the void with all that fills up from
        there before it spills: into another, lower one (`into`), or outside. The
        pockets of a sealed void are not listed apart.

    Raises
    ------
    NotASolidError, ReebsliceError, TooManyCrossingsError
        As of :func:`exact_graphs`; or `least_depth` is negative, or the distance no positive number.

    Examples
    --------
    A box with a smaller box taken out of its top is a cup:

    >>> import numpy as np, trimesh
    >>> cup = trimesh.boolean.difference([trimesh.creation.box([3, 3, 3]),
    ...     trimesh.creation.box([1, 1, 2], trimesh.transformations.translation_matrix([0, 0, 1]))])
    >>> pockets = find_pockets(cup)
    >>> pockets.kind.tolist(), pockets.volume.round(6).tolist(), pockets.section.round(6).tolist()
    (['basin'], [1.5], [1.0])
    """
    _check_lengths(least_depth, distance)
    mesh = void_mesh(height_mesh(points, faces, rotation))
    graph = surface_reeb_graph(mesh)
    body = np.zeros(len(mesh.points), np.int32)
    nodes, arcs = solid_reeb_graph(mesh, graph, body)
    pairs = extended_pairs(len(nodes), arcs)
    open_air = _same_component(len(nodes), arcs, 0)
    basins = nodes[_deep(mesh, nodes, pairs.ordinary[open_air[pairs.ordinary[:, 0]]], least_depth)]
    bells = nodes[_deep(mesh, nodes, pairs.relative[open_air[pairs.relative[:, 0]]], least_depth)][:, ::-1]
    sealed = nodes[pairs.extremes[~open_air[pairs.extremes[:, 0]]]]
    found = ("sealed", sealed, True), ("basin", basins, False), ("bell", bells, False)
    pockets = measure_pockets(mesh, graph, body, found, distance)
    return pockets._replace(shells=_without_box(pockets.shells, int(mesh.vertex.max()) - 7))


def _without_box(shells, box):
    """The shells but for the box, whose first vertex this is: pockets touch it where a surface crosses itself."""
    own = shells.member < box
    kept = np.concatenate([[0], np.cumsum(own)])
    return Groups(kept[shells.start], shells.member[own])


def find_islands(
    points: Any,
    faces: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
    body_of_vertex: ArrayLike | None = None,
    least_depth: float = 0.0,
    distance: float | None = None,
) -> Pockets:
    """Find what begins in the air when the solid is built upward, layer on layer.

    Parameters
    ----------
    points, faces, rotation, body_of_vertex
        As for :func:`exact_graphs`.
    least_depth : float
        Islands that join within less height are left out, mesh units, and what
        begins no higher above the lowest point of all stands as well as that.
    distance : float, optional
        As for :func:`find_pockets`.

    Returns
    -------
    Pockets
        All of the kind ``island``: the minima of the solid above the lowest
        height of all, at which it stands. A body that begins above that height is
        an island that never joins.

    Raises
    ------
    NotASolidError, ReebsliceError, TooManyCrossingsError
        As of :func:`exact_graphs`; or `least_depth` is negative, or the distance no positive number.

    Examples
    --------
    >>> import trimesh
    >>> legs = [trimesh.creation.box(bounds=[[x, 0, z], [x + 1, 1, 3]]) for x, z in ((0, 0), (2, 1))]
    >>> table = trimesh.boolean.union([*legs, trimesh.creation.box(bounds=[[0, 0, 3], [3, 1, 4]])])
    >>> islands = find_islands(table)
    >>> islands.begin_height.tolist(), islands.end_height.tolist(), islands.volume.round(6).tolist()
    ([1.0], [3.0], [2.0])
    """
    _check_lengths(least_depth, distance)
    mesh, body = height_mesh_of_bodies(points, faces, rotation, body_of_vertex)
    graph = surface_reeb_graph(mesh)
    nodes, arcs = solid_reeb_graph(mesh, graph, body)
    pairs = extended_pairs(len(nodes), arcs)
    height = mesh.points[nodes, 2]
    found = []
    for chosen, whole in ((pairs.ordinary, False), (pairs.extremes, True)):
        chosen = chosen[height[chosen[:, 0]] > height[0] + least_depth]
        found.append(("island", nodes[_deep(mesh, nodes, chosen, least_depth)], whole))
    return measure_pockets(mesh, graph, body, found, distance)


def _check_lengths(least_depth, distance):
    """Raise ReebsliceError unless the one is a length of 0 or more, and the other, if given, of more."""
    take_number(least_depth, "least_depth", 0)
    if distance is not None:
        take_number(distance, "distance", LEAST)


def _same_component(count, arcs, node):
    """Whether each of `count` nodes hangs together with one node: (count,) bool."""
    root = np.arange(count)
    _join_all(root, np.ascontiguousarray(arcs))
    return root == root[node]


@njit
def _join_all(root, pairs):
    """Join the sets of each pair; `root`, changed in place, becomes flat."""
    for low, high in pairs:
        join(root, np.int64(low), np.int64(high))
    for i in range(len(root)):
        root[i] = find(root, i)


def _deep(mesh, nodes, pairs, least_depth):
    """The pairs whose heights differ, and by `least_depth` or more."""
    low, high = (mesh.points[nodes[column], 2] for column in pairs.T)
    return pairs[(high > low) & (high - low >= least_depth)]
