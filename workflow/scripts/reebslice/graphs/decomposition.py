"""The solid taken apart at its events: a closed mesh for every arc of its Reeb graph."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.grouping import group_items
from ..errors import ReebsliceError
from ..mesh.arguments import take_arrays, take_bodies, take_rotation
from ..mesh.sheets import split_double_edges, split_pinches
from ..morse.height_mesh import height_mesh
from ..morse.reeb_graph import surface_reeb_graph
from ..table_checks import build_table
from .cut_faces import cut_mesh, part_faces
from .event_slices import cut_at_events, find_sections, sections_at
from .exact import solid_reeb_graph

LEFT_OUT = -2  # label of what becomes no body


class ArcBodies(NamedTuple):
    """Closed meshes that together are the solid, one for each of L labels.

    Attributes
    ----------
    label : (L,) int64
        Ascending; arcs, and -1 for what is on none.
    points : list of (k, 3) float64
        Vertices of each, model frame.
    faces : list of (l, 3) int32
        Counter-clockwise seen from outside.
    is_cut : list of (l,) bool
        Whether a face closes a cut, or is of the surface.
    """

    label: np.ndarray
    points: list
    faces: list
    is_cut: list


def decompose(
    points: Any,
    faces: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
    body_of_vertex: ArrayLike | None = None,
) -> ArcBodies:
    """Take a solid apart at its events: one closed body for each arc of its Reeb graph.

    The solid is cut where the graph has a node, at the height of that node and only there: through the part of the
    solid in which the event happens, and through nothing else at that height.

    Parameters
    ----------
    points, faces, rotation, body_of_vertex
        As for :func:`exact_graphs`.

    Returns
    -------
    ArcBodies
        `label` are rows of `arcs` of the second graph of :func:`exact_graphs`; which of several arcs between the same
        two nodes is which is left open. An arc of no height has no body. Each body is closed: every mesh edge is in
        two faces that run along it in opposite directions. Two bodies that meet share the faces of the cut. So
        volumes add up to that of the solid but for rounding. Without -1, unless the surface crosses itself.

    Raises
    ------
    NotASolidError, ReebsliceError, TooManyCrossingsError
        As of :func:`exact_graphs`.

    Notes
    -----
    Needs manifold3d, which the extra `formats` brings, for the triangles of the cuts.

    Examples
    --------
    >>> import trimesh
    >>> fork = trimesh.boolean.union([trimesh.creation.box(bounds=box) for box in (
    ...     ([0, 0, 0], [1, 1, 3]), ([2, 0, 0], [3, 1, 3]), ([0, 0, 3], [3, 1, 4]))])
    >>> bodies = decompose(fork)
    >>> [round(float(trimesh.Trimesh(*body).volume), 6) for body in zip(bodies.points, bodies.faces)]
    [3.0, 3.0, 3.0]
    """
    points, faces = take_arrays(points, faces)
    mesh, matrix = height_mesh(points, faces, rotation), take_rotation(rotation)
    graph, body = surface_reeb_graph(mesh), take_bodies(body_of_vertex, len(points))[mesh.vertex]
    nodes, arcs = solid_reeb_graph(mesh, graph, body)
    inner = np.bincount(arcs.ravel(), minlength=len(nodes)) > 1
    slices = cut_at_events(mesh, graph, body, nodes[inner])
    sections, _ = find_sections(slices, graph)
    label = _name_sections(mesh, graph, slices, sections, nodes, arcs)[sections.of_part]
    return arc_bodies(mesh, slices, np.where(sections.flat, LEFT_OUT, label), points, matrix)


def _name_sections(mesh, graph, slices, sections, nodes, arcs):
    """The arc of each section, between whose events it lies; -1 for none."""
    label = np.full(sections.of_part.max() + 1, -1)
    ends = [[sections_at(slices, sections, graph, node, upward) for node in nodes.tolist()] for upward in (True, False)]
    for arc, (low, high) in enumerate(arcs.tolist()):
        between = np.intersect1d(ends[0][low], ends[1][high])
        free = between[label[between] < 0]
        if len(free) and mesh.points[nodes[low], 2] < mesh.points[nodes[high], 2]:
            label[free[0]] = arc
    return label


def arc_bodies(mesh, slices, label, points, rotation):
    """Close the parts of a solid that have one label each.

    Parameters
    ----------
    mesh : HeightMesh
    slices : EventSlices
        Of B blocks.
    label : (B,) int64
        Of blocks: -1 or more, or LEFT_OUT.
    points : (n, 3) float64
        Of the surface, model frame.
    rotation : (3, 3) float64
        From the model frame to the tilted frame.

    Returns
    -------
    ArcBodies

    Raises
    ------
    ReebsliceError
        A cut could not be closed, as where a surface crosses itself.
    """
    parts = part_faces(mesh, slices, label[slices.block_of_piece])
    below, above = label[slices.block_below], label[slices.block_above]
    regions = np.flatnonzero(below != above)
    bounds = group_items(slices.regions.of_contour, len(slices.regions.level))
    contours = [bounds.member[bounds.start[r] : bounds.start[r + 1]] for r in regions.tolist()]
    cut = cut_mesh(mesh, slices, parts, len(points), np.concatenate([np.zeros(0, np.int64), *contours]))
    every = np.concatenate([points, cut.points @ np.asarray(rotation)])
    tilted = np.concatenate([points @ np.asarray(rotation).T, cut.points])[:, :2]
    rings, caps = iter(cut.rings), []
    for group in contours:
        caps.append(_close([next(rings) for _ in group], tilted))
    sizes = [len(cap) for cap in caps]
    caps = np.concatenate([np.zeros((0, 3), np.int64), *caps])
    corners = np.concatenate([cut.triangles, caps, caps[:, ::-1]])
    owner = [parts.label[cut.part], np.repeat(below[regions], sizes), np.repeat(above[regions], sizes)]
    return _gather_bodies(every, corners, np.concatenate(owner), np.arange(len(corners)) >= len(cut.triangles))


def labelled_bodies(mesh, labels, points, rotation):
    """Take a solid apart by the arcs of the written graph.

    Parameters
    ----------
    mesh : HeightMesh
    labels : ArcSlices
        Of :func:`.arc_labels.slice_arcs`.
    points : (n, 3) float64
        Of the surface, model frame.
    rotation : (3, 3) float64
        From the model frame to the tilted frame.

    Returns
    -------
    ArcBodies
        Arcs without height have none, nor have those that hang together with a lower one between two levels.

    Raises
    ------
    ReebsliceError
        As of :func:`arc_bodies`.
    """
    label = np.where(labels.flat, LEFT_OUT, labels.solid_of_block)
    return arc_bodies(mesh, labels.slices, label, points, rotation)


def parts_table(bodies, rotation):
    """Make the table `parts`.

    Parameters
    ----------
    bodies : ArcBodies
    rotation : (3, 3) float64
        From the model frame to the tilted frame.

    Returns
    -------
    pyarrow.Table
    """
    heights = [spots @ np.asarray(rotation)[2] for spots in bodies.points]
    measures = [_measure(*body) for body in zip(bodies.points, bodies.faces, bodies.is_cut)]
    volume, area, cut_area = np.array(measures, float).reshape(-1, 3).T
    return build_table(
        "parts",
        {
            "solid_arc": [None if arc < 0 else arc for arc in bodies.label.tolist()],
            "lower": [height.min() for height in heights],
            "upper": [height.max() for height in heights],
            "volume": volume,
            "area": area,
            "cut_area": cut_area,
            "n_faces": [len(faces) for faces in bodies.faces],
        },
    )


def _measure(points, faces, is_cut):
    """Volume, and area of the faces that close no cut and of those that do."""
    a, b, c = (points[faces[:, k]] - points[0] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1) / 2
    return (a * normal).sum() / 6, area[~is_cut].sum(), area[is_cut].sum()


def _close(rings, places):
    """Triangles whose boundary are closed rings of points, counter-clockwise seen from above: (k, 3) int64."""
    from manifold3d import triangulate  # not among the packages that the library itself needs

    rings = [ring for ring in rings if len(ring) > 2]
    if not rings:
        return np.zeros((0, 3), np.int64)
    triangles = triangulate([places[ring] for ring in rings], -1, False)
    corners = np.concatenate(rings)[np.asarray(triangles, np.int64)]
    return corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]  # rings may touch in a point


def _gather_bodies(points, corners, owner, is_cut):
    """Group faces by owner, each group a closed surface on its own."""
    kept = owner != LEFT_OUT
    corners, is_cut = corners[kept], is_cut[kept]
    labels, owner = np.unique(owner[kept], return_inverse=True)
    groups, bodies = group_items(owner, len(labels)), ArcBodies(labels, [], [], [])
    for members in np.split(groups.member, groups.start[1:-1]):
        used, faces = np.unique(corners[members], return_inverse=True)
        spots, faces, old = _separate(points[used], faces.reshape(-1, 3).astype(np.int32))
        for column, part in zip(bodies[1:], (spots, faces, is_cut[members][old])):
            column.append(part)
    return bodies


def _separate(points, faces):
    """Make a closed surface a manifold, where it touches itself in a vertex or along a mesh edge."""
    tails, heads = (ends.ravel().astype(np.int64) for ends in (faces, np.roll(faces, -1, axis=1)))
    ahead, back = tails * len(points) + heads, heads * len(points) + tails
    along, against = np.argsort(ahead, kind="stable"), np.argsort(back, kind="stable")
    if not np.array_equal(ahead[along], back[against]):
        raise ReebsliceError("a cut of the solid cannot be closed: the surface crosses itself at an event.")
    opposite = np.empty(len(ahead), np.int32)
    opposite[along] = against  # of several faces at an edge those of the surface with each other, and those of cuts
    faces, origin = split_pinches(faces, opposite, np.zeros(len(faces), np.int32), len(points))
    return split_double_edges(points[origin], faces, opposite)
