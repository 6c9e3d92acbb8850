"""Centrelines of tubes that bend, branch and close: centres of the contours of the geodesic distance from a tip.

Every contour is a point of the Reeb graph of the distance, so its centre is one of a path along an arc, and the paths
have the branches and the loops of the graph: as many loops as the genus, however thin they are. Only leaves that do
not leave the tube are cut off, which no loop does.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.grouping import Groups
from ..errors import ReebsliceError
from ..functions.geodesic import geodesic_distance
from ..mesh.arguments import LEAST, take_mesh, take_number
from ..mesh.faults import find_used
from ..mesh.surface_distances import distance_to_surface
from ..morse.face_arcs import label_arcs
from ..morse.ordered_mesh import HeightMesh
from ..morse.reeb_graph import surface_reeb_graph
from ..morse.value_mesh import value_mesh
from ..slicing.levels import make_levels, uniform_heights
from ..slicing.rings import measure_rings
from .branch_points import move_branch_points, trim_end
from .branches import Branches, path_lengths

SMALL = 1e-75  # mesh units; of an extent below, or above its inverse, volumes and squares of areas are no floats


class Centrelines(NamedTuple):
    """Centrelines of a surface: P points in B branches.

    Attributes
    ----------
    points : (P, 3) float64
        Centres, model frame. A free end is the last centre that still has all that is behind it within `prune` radii;
        in a cone that has none, the vertex at its tip.
    value : (P,) float64
        Of the function.
    radius : (P,) float64
        Distance to the surface: radius of the largest ball around the centre that stays in the tube.
    section : (P,) float64
        Area of the contour, seen along the path; 0 at the tip of a cone, NaN where branches meet.
    branches : Groups
        Points of each branch, from node to node. A node is the first or last point of all branches that meet there.
    area : (B,) float64
        Surface of the tube along each branch; that of all branches is that of the surface.
    """

    points: np.ndarray
    value: np.ndarray
    radius: np.ndarray
    section: np.ndarray
    branches: Groups
    area: np.ndarray


def find_centrelines(
    points: Any,
    faces: ArrayLike | None = None,
    distance: float | None = None,
    values: ArrayLike | None = None,
    prune: float = 1.5,
) -> Centrelines:
    """Find the centrelines of a surface that is made of tubes.

    Parameters
    ----------
    points, faces
        As for :func:`.height_mesh`, but for a `HeightMesh`.
    distance : float, optional
        Between contours, in the unit of the function; 1/200 of its range by default.
    values : (n,) float, optional
        The function whose contours are taken; by default :func:`.geodesic_distance`.
    prune : float
        A leaf goes if it stays within so many radii of the point from which it branches: what is between tip and
        axis, and bumps of the wall. So does the end of a path within so many radii of a centre. 0 keeps all.

    Returns
    -------
    Centrelines
        Their loops are those of the Reeb graph of the function, as many as the genus of all shells together, and every
        shell has a connected part of its own.

    Raises
    ------
    NotASolidError, ReebsliceError
        As of `height_mesh`, of `geodesic_distance`, of :func:`.value_mesh`; or a number, or the extent of the mesh, is
        out of range.
    TooManyCrossingsError
        The distance is too small.

    Examples
    --------
    >>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5]])
    >>> lines = find_centrelines(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], values=points[:, 2])
    >>> len(lines.branches.start) - 1
    1
    """
    points, faces = take_mesh(points, faces)
    extent = np.ptp(points, axis=0).max()
    if not SMALL < extent < 1 / SMALL:
        raise ReebsliceError(
            f"the mesh has an extent of {extent:.3g}, of which volumes are no floats: take another unit."
        )
    values = geodesic_distance(points, faces) if values is None else values
    mesh = HeightMesh(*value_mesh(values, points, faces))
    low, high = mesh.points[[0, -1], 2]
    if not high > low:
        raise ReebsliceError("the function is constant, so it has no contours: give one that is not.")
    step = (high - low) / 200 if distance is None else take_number(distance, "distance", LEAST)
    levels = make_levels(mesh, uniform_heights(low, high, step))
    graph, places = surface_reeb_graph(mesh), points[mesh.vertex]
    chains, spots = _chain_arcs(graph, measure_rings(mesh, graph, levels, places), mesh, places)
    found = Branches(chains)
    where, reach = spots["points"], spots["reach"]
    limit = take_number(prune, "prune", 0.0)
    span = np.abs(np.diff(mesh.points[graph.nodes[graph.arcs], 2], axis=1))[:, 0].tolist()
    found.prune(
        span, lambda leaf: (np.linalg.norm(where[leaf] - where[leaf[0]], axis=1) <= limit * reach[leaf[0]]).all()
    )
    return _gather(found, spots, (points, faces), _areas_of_arcs(mesh, graph, places), limit)


def _chain_arcs(graph, rings, mesh, places):
    """Points of each arc, lists of ids; and the points: nodes, then rings, as columns."""
    nodes, arcs = len(graph.nodes), graph.arcs
    first, last = rings.of_arcs.start[:-1], rings.of_arcs.start[1:] - 1
    up, down = (np.bincount(arcs[:, k], minlength=nodes) for k in (0, 1))
    # a saddle lies at the centre of the one contour on its one side
    at, ring = np.full(nodes, -1), np.concatenate([first, last])
    alone = np.concatenate([up[arcs[:, 0]] == 1, down[arcs[:, 1]] == 1]) & ((up > 0) & (down > 0))[arcs.T.ravel()]
    at[arcs.T.ravel()[alone]] = ring[alone]
    whole = rings.perimeter > 0
    chains = []
    for arc, (low, high) in enumerate(arcs.tolist()):
        inner = range(first[arc] + (at[low] == first[arc]), last[arc] + 1 - (at[high] == last[arc]))
        chains.append([low, *(nodes + k for k in inner if whole[k]), high])
    centre = _centre_rings(rings, np.linalg.norm(rings.area, axis=1), rings.area)
    centre, section = _turn_to_path(rings, centre, chains, nodes)
    spot, extreme = places[graph.nodes].copy(), at < 0
    spot[~extreme] = centre[at[~extreme]]
    reach = np.zeros(nodes)  # the radius of the widest of the contours that meet at a node
    np.maximum.at(reach, arcs.T.ravel(), np.sqrt(np.linalg.norm(rings.area, axis=1)[ring] / np.pi))
    return chains, {
        "points": np.concatenate([spot, centre]),
        "value": np.concatenate([mesh.points[graph.nodes, 2], rings.value]),
        "section": np.concatenate([np.where(extreme, 0.0, np.nan), section]),
        "reach": np.concatenate([reach, np.zeros(len(centre))]),
    }


def _centre_rings(rings, seen, along):
    """Centres of the areas of rings seen along vectors; of those that enclose little, the mean of the curve."""
    flat = seen * 4 * np.pi < 0.1 * rings.perimeter**2
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = np.einsum("rij,rj->ri", rings.moment, along) / np.einsum("ri,ri->r", rings.area, along)[:, None]
    return np.where(flat[:, None], rings.mean, centre)


def _turn_to_path(rings, centre, chains, nodes):
    """Centres (R, 3) and areas (R,) of rings seen along the path through their neighbours on their arc."""
    section = np.linalg.norm(rings.area, axis=1)
    along = rings.area.copy()
    for chain in chains:
        inner = np.array(chain[1:-1], np.int64) - nodes
        if len(inner) < 2:
            continue
        step = np.gradient(centre[inner], axis=0)
        size = np.linalg.norm(step, axis=1, keepdims=True)
        step = np.divide(step, size, out=np.zeros_like(step), where=size > 0)
        seen = np.abs(np.einsum("ri,ri->r", rings.area[inner], step))
        right = seen > 0.5 * section[inner]  # else the path does not go through the contour
        along[inner[right]], section[inner[right]] = step[right], seen[right]
    return _centre_rings(rings, section, along), section


def _areas_of_arcs(mesh, graph, places):
    """Surface along each arc, (A,): of the faces whose middle lies on it."""
    a, b, c = (places[mesh.faces[:, k]] for k in range(3))
    size = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return np.bincount(label_arcs(mesh, graph).of_face, weights=size, minlength=len(graph.arcs))


def _gather(found, spots, surface, area, limit):
    """The :class:`Centrelines` of some :class:`Branches`, their free ends trimmed, only the points that they have."""
    points, faces = surface
    corners = find_used(len(points), faces)
    used = np.unique(np.concatenate([np.asarray(chain) for chain in found.chains.values()]))
    radius = np.zeros(len(spots["points"]))
    radius[used] = distance_to_surface(spots["points"][used], points[corners], np.searchsorted(corners, faces))
    move_branch_points(found, spots["points"], limit * radius)
    chains = [
        trim_end(chain, [len(found.at[chain[end]]) == 1 for end in (0, -1)], spots["points"], limit * radius)
        for chain in found.chains.values()
    ]
    member = np.concatenate([np.asarray(chain) for chain in chains])
    used = np.unique(member)
    branches = Groups(np.cumsum([0, *map(len, chains)]), np.searchsorted(used, member))
    own = np.array([area[list(found.arcs[branch])].sum() for branch in found.chains])
    return Centrelines(spots["points"][used], spots["value"][used], radius[used], spots["section"][used], branches, own)


def branch_figures(lines):
    """Measure the branches.

    Parameters
    ----------
    lines : Centrelines

    Returns
    -------
    dict of str to (B,) array
        `source` and `target`, points at both ends; `length` of the path; `tortuosity`, it over the straight distance
        of its ends, NaN of a closed one; `mean_radius`, along the path, and `least_radius`, both without tips;
        `area` of the surface along it; `volume`, of cones between consecutive sections, up to where the path ends.
    """
    rows = []
    for low, high in zip(lines.branches.start[:-1], lines.branches.start[1:]):
        ids = lines.branches.member[low:high]
        length, volume = path_lengths(lines.points[ids]), cone_volumes(lines, ids)
        chord = float(np.linalg.norm(lines.points[ids[0]] - lines.points[ids[-1]]))
        inner = lines.section[ids] != 0
        radius = lines.radius[ids][inner] if inner.any() else lines.radius[ids]
        weight = np.gradient(length)[inner] if inner.sum() > 1 else np.ones(len(radius))
        mean = float(np.average(radius, weights=weight)) if weight.sum() > 0 else float(radius.mean())
        rows.append(
            {
                "source": ids[0],
                "target": ids[-1],
                "length": length[-1],
                "tortuosity": length[-1] / chord if chord > 0 else np.nan,
                "mean_radius": mean,
                "least_radius": radius.min(),
                "volume": volume[-1],
            }
        )
    return {name: np.array([row[name] for row in rows]) for name in rows[0]} | {"area": lines.area}


def cone_volumes(lines, ids):
    """Sum the volume along a path.

    Parameters
    ----------
    lines : Centrelines
    ids : (n,) int
        Points of the path.

    Returns
    -------
    (n,) float64
        Volume up to each point, of cones between sections; where a section is not known, those around stand for it.
    """
    length, section = path_lengths(lines.points[ids]), lines.section[ids]
    known = np.flatnonzero(~np.isnan(section))
    if len(known) < len(section):
        section = np.interp(length, length[known], section[known]) if len(known) else np.zeros(len(section))
    one, other = section[:-1], section[1:]
    return np.concatenate([[0.0], np.cumsum(np.diff(length) * (one + other + np.sqrt(one * other)) / 3)])
