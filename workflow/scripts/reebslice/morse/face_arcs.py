"""The arc of the surface's Reeb graph on which each vertex and each face lies.

A sweep upward keeps, for every mesh edge that crosses the level, the arc of
the contour that crosses it there. A regular vertex hands the arc of the mesh
edges that end in it to those that begin. Where two arcs unite, the sets of
their mesh edges do; where one parts in two, the shorter of the two contours
is walked and its mesh edges are labelled anew, so that time grows as the mesh
and as those shorter contours.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.components import find
from ..arrays.grouping import list_incidence
from ..kernels import njit
from ..mesh.arguments import take_mesh
from .contour_trees import find_gates
from .height_mesh import height_mesh
from .ordered_mesh import next_half_edge
from .reeb_graph import surface_reeb_graph


class ArcLabels(NamedTuple):
    """Arcs of a surface of n vertices and m faces.

    Attributes
    ----------
    of_vertex : (n,) int32
        The arc on which each regular vertex lies; -1 at critical points.
    of_face : (m,) int32
        The arc on which the middle of each face lies: the contour through its middle corner, or, where that is a
        critical point, the contour just below or just above it, on whichever side more of the face lies.
    """

    of_vertex: np.ndarray
    of_face: np.ndarray


def label_faces(points: Any, faces: ArrayLike | None = None, rotation: ArrayLike | None = None) -> np.ndarray:
    """Find the arc of the surface's Reeb graph on which each face lies.

    Parameters
    ----------
    points, faces, rotation
        As for :func:`.height_mesh.height_mesh`.

    Returns
    -------
    (m,) int32
        Of each row of `faces` the arc, a row of `arcs` of the first graph of :func:`exact_graphs`, that passes the
        middle of the face, as :class:`ArcLabels` says. Exact, as the graph is.

    Raises
    ------
    NotASolidError, ReebsliceError
        As of `height_mesh`.

    Examples
    --------
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> label_faces(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).tolist()
    [0, 0, 0, 0]
    """
    points, corners = take_mesh(points, faces)
    mesh = height_mesh(points, corners, rotation)
    return arcs_of_faces(mesh, surface_reeb_graph(mesh), corners)


def arcs_of_faces(mesh, graph, faces):
    """Do as :func:`label_faces` with what the pipeline has at hand.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's.
    faces : (m, 3) int
        That the mesh was made of.

    Returns
    -------
    (m,) int32
        As of :func:`label_faces`.
    """
    labels = label_arcs(mesh, graph)
    row = match_faces(mesh, faces)
    arcs = np.empty(len(faces), np.int32)
    arcs[row[row >= 0]] = labels.of_face[row >= 0]
    return arcs


def match_faces(mesh, faces):
    """Find which of the faces that a mesh was made of each of its faces is.

    Parameters
    ----------
    mesh : HeightMesh
        Of m faces, in an order of its own.
    faces : (k, 3) int
        Those of the surface.

    Returns
    -------
    (m,) int64
        Rows of `faces`; -1 of the faces without area that unfolding added between the copies of a saddle.
    """
    found = mesh.vertex[mesh.faces]
    kept = np.flatnonzero((found != np.roll(found, 1, axis=1)).all(axis=1))
    row = np.full(len(found), -1)
    row[kept[_order_of_faces(found[kept])]] = _order_of_faces(faces)
    return row


def _order_of_faces(faces):
    """An order of faces that does not depend on theirs, nor on the corner that each begins with: (m,) int."""
    first = faces.argmin(axis=1)
    turned = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return np.lexsort(turned.T[::-1])


def label_arcs(mesh, graph):
    """Find the arc on which each vertex and each face lies.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices and m faces whose saddles are simple.
    graph : ReebGraph
        The mesh's.

    Returns
    -------
    ArcLabels
        Exact, as the graph is.
    """
    gates = find_gates(mesh.faces, mesh.twins, len(mesh.points))
    incident = list_incidence(graph.arcs, len(graph.nodes))
    return ArcLabels(*_sweep(mesh, graph, gates.into, incident))


@njit
def _sweep(mesh, graph, into, incident):
    """Columns of :class:`ArcLabels`."""
    n, m = len(mesh.points), len(mesh.faces)
    root = np.arange(len(graph.arcs)).astype(np.int32)  # of an arc that has ended, one that goes on from it
    label = np.full(3 * m, np.int32(-1))  # of upward half-edges that a walk has labelled
    begin = np.empty(n, np.int32)  # the arc of all others that begin in a vertex
    of_vertex, of_face = np.full(n, np.int32(-1)), np.empty(m, np.int32)
    place = 0
    for v in range(n):
        if place < len(graph.nodes) and graph.nodes[place] == v:
            _mark_faces(mesh, into[v], root, label, begin, of_face, v, True)
            begin[v] = pass_node(mesh, graph, incident, place, root, label)
            _mark_faces(mesh, into[v], root, label, begin, of_face, v, False)
            place += 1
        else:
            begin[v] = of_vertex[v] = arc_at(mesh.faces, root, label, begin, np.int64(into[v, 0]))
    for f in range(m):
        middle = min(mesh.faces[f, 1], mesh.faces[f, 2])
        if of_vertex[middle] >= 0:
            of_face[f] = of_vertex[middle]
    return of_vertex, of_face


@njit(inline="always")
def arc_at(faces, root, label, begin, h):
    """Find the arc of the contour that crosses a half-edge at the level that a sweep has come to.

    Parameters
    ----------
    faces : (m, 3) int32
        Of the mesh.
    root, label, begin : (A,), (3 m,) and (n,) int32
        Where arcs that have ended go on, the arcs of half-edges that a walk has labelled, or -1, and those of all
        others that begin in a vertex.
    h : int
        The half-edge, upward.

    Returns
    -------
    int
    """
    arc = label[h] if label[h] >= 0 else begin[faces[h // 3, h % 3]]
    return find(root, arc)


@njit(inner=True)
def pass_node(mesh, graph, incident, place, root, label):
    """Pass a critical point in a sweep: end its lower arcs and begin its upper ones.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's.
    incident : Groups
        Arcs at each node.
    place : int
        Of the critical point, in `graph.nodes`.
    root, label : arrays
        As for :func:`arc_at`. Modified.

    Returns
    -------
    int
        The arc of half-edges that begin here and are not labelled; -1 at a maximum.
    """
    arcs = incident.member[incident.start[place] : incident.start[place + 1]]
    first, second, cut = np.int32(-1), np.int32(-1), graph.nodes[place] + 1
    for arc in arcs:
        if graph.arcs[arc, 0] == place:
            first, second = arc, first
    if first < 0:
        return first  # a maximum: nothing goes on
    if second >= 0:
        first, second = _longer_first(mesh, graph.gates, np.int64(first), np.int64(second), np.int64(cut))
        h = start = np.int64(graph.gates[second])
        while True:
            label[h] = second
            h = np.int64(next_half_edge(mesh.faces, mesh.twins, h, cut))
            if h == start:
                break
    for arc in arcs:
        if graph.arcs[arc, 1] == place:
            root[arc] = first
    return first


@njit(inner=True)
def _longer_first(mesh, gates, one, two, cut):
    """Two arcs that begin right below a cut, that with the longer contour first."""
    h, g = np.int64(gates[one]), np.int64(gates[two])
    while True:
        h = np.int64(next_half_edge(mesh.faces, mesh.twins, h, cut))
        g = np.int64(next_half_edge(mesh.faces, mesh.twins, g, cut))
        if g == gates[two]:
            return one, two
        if h == gates[one]:
            return two, one


@njit(inner=True)
def _mark_faces(mesh, into, root, label, begin, of_face, v, below):
    """Label those faces around v whose middle corner it is and of which more lies on this side of it."""
    if into[0] < 0:
        return  # a minimum: the lowest corner of all its faces
    points, faces, twins = mesh.points, mesh.faces, mesh.twins
    start = h = into[0] // 3 * 3 + (into[0] % 3 + 1) % 3  # leaves v
    while True:
        f = h // 3
        low, high = faces[f, 0], max(faces[f, 1], faces[f, 2])
        if low != v and high != v:
            rises = points[v, 2] - points[low, 2], points[high, 2] - points[v, 2]
            if (rises[0] >= rises[1]) == below:
                edge = 3 * f if faces[f, 1] == high else 3 * f + 2
                edge = edge if edge % 3 == 0 else twins[edge]
                of_face[f] = arc_at(faces, root, label, begin, np.int64(edge))
        h = twins[f * 3 + (h % 3 + 2) % 3]
        if h == start:
            break
