"""The Reeb graph of a solid from that of its surface, without levels.

At a height that is no vertex's, every region of material has one outer contour.
So the arcs of the solid are the outer arcs of the surface, glued and parted at
the events of holes: each of these has one region below and one above, whose
outer contour is one arc that passes the event, or, where a hole joins the
outside, one that ends there and one that begins.

| event | arcs of the solid there |
| --- | --- |
| ``->o``, ``o->``, ``o,o->o``, ``o->o,o``, ``o->i,o``, ``i,o->o`` | the outer ones end or begin at it |
| ``->i``, ``i->``, ``i->i,i``, ``i,i->i`` | that of the contour around it passes it |
| ``i,o->i``, ``i->i,o`` | that of the contour around it passes it, and that of the island ends or begins |

Which other holes a region has is no data of the graph, so a contour around a
hole has to be known at the hole's own events only, and there a ray tells
(:mod:`.ray_hosts`).
"""

from functools import cache

import numpy as np

from ..morse.contour_trees import find_gates
from ..slicing.exact_contours import exact_tilt
from .exact_rays import exact_host
from .outer_arcs import find_inner_arcs
from .ray_hosts import shoot_rays


def solid_graph_by_rays(mesh, graph, body_of_vertex):
    """Build the Reeb graph of the solid from that of its surface, every event a node.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    graph : ReebGraph
        Of the mesh, of K nodes.
    body_of_vertex : (n,) int32
        Bodies that may overlap.

    Returns
    -------
    (A, 2) int64 or None
        Arcs between places in `graph.nodes`, the lower end first, in lexicographic order; nodes and order of events
        are those of the ranks. None where contours fit no solid, where two vertices are at one place, or sheets
        touch so that rational numbers do not tell either which contour is around which.
    """
    if _touches_itself(mesh):
        return None
    into = find_gates(mesh.faces, mesh.twins, len(mesh.points)).into
    inner = find_inner_arcs(mesh, graph, into)
    if inner is None:
        return None
    hosts = shoot_rays(mesh, graph, into, inner, _events_of_holes(graph, inner), body_of_vertex)
    if hosts.odd:
        return None
    host, tilt = hosts.host, cache(lambda: exact_tilt(mesh.points))
    for k, place in enumerate(hosts.doubtful.tolist()):
        crossed = slice(hosts.start[k], hosts.start[k + 1])
        arc = exact_host(mesh, graph, inner, place, (hosts.face[crossed], hosts.arc[crossed]), tilt())
        if arc is None:
            return None
        host[place] = arc
    hosted = np.flatnonzero(host >= 0)
    ends = graph.arcs[host[hosted]]
    if not ((ends[:, 0] < hosted) & (hosted < ends[:, 1])).all():
        return None
    return _subdivide(graph.arcs[~inner], host, np.cumsum(~inner) - 1)


def _touches_itself(mesh):
    """Whether two vertices are at one place, where no ray tells sheets of the surface apart.

    Copies of an unfolded saddle are one vertex; and what is at one place is next to each other in order.
    """
    return ((mesh.points[1:] == mesh.points[:-1]).all(axis=1) & (mesh.vertex[1:] != mesh.vertex[:-1])).any()


def _events_of_holes(graph, inner):
    """Which nodes (K,) have a contour around them: where the one contour, above or below, is a hole."""
    k = len(graph.nodes)
    ends = graph.arcs[inner]
    inner_ends = np.bincount(ends[:, 0], minlength=k), np.bincount(ends[:, 1], minlength=k)
    all_ends = np.bincount(graph.arcs[:, 0], minlength=k), np.bincount(graph.arcs[:, 1], minlength=k)
    return ((all_ends[0] == 1) & (inner_ends[0] == 1)) | ((all_ends[1] == 1) & (inner_ends[1] == 1))


def _subdivide(arcs, host, row):
    """Arcs parted at the events that they host.

    arcs : (A, 2) outer ones; host : (K,) arc among all around each event, or -1; row : of all arcs, among the outer.
    """
    hosted = np.flatnonzero(host >= 0)
    place = np.concatenate([arcs.ravel(), hosted]).astype(np.int64)
    arc = np.concatenate([np.repeat(np.arange(len(arcs)), 2), row[host[hosted]]])
    order = np.lexsort((place, arc))
    place, arc = place[order], arc[order]
    parts = np.column_stack([place[:-1], place[1:]])[arc[:-1] == arc[1:]]
    return parts[np.lexsort(parts.T[::-1])]
