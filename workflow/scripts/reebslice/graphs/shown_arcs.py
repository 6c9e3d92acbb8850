"""Which arc of the surface's graph, as the levels show it, each face of the surface lies on.

The exact graph has an arc for every chain of contours, however short. The graph that
the levels show has fewer, where what lies between two levels cancels. A contour of a
level is a point of one arc of each, which ties the two together; an exact arc that no
level crosses counts with the nearest that one does.
"""

import numpy as np

from ..arrays.grouping import list_incidence
from ..errors import ReebsliceError
from ..kernels import njit
from ..morse.face_arcs import arcs_of_faces
from ..slicing.graph_slices import trace_arcs_at_levels
from ..slicing.levels import Levels


def label_shown_arcs(mesh, graph, faces, tables):
    """Find the arc of `surface.graphml` on which each face lies.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's, of A arcs.
    faces : (m, 3) int
        That the mesh was made of.
    tables : dict of pyarrow.Table
        `levels`, `contours` (without `geometry`) and `arcs`.

    Returns
    -------
    (m,) int32
        `arc` of the rows of `arcs` with graph `surface`; -1 on a component that no level cuts.

    Raises
    ------
    ReebsliceError
        The contours are not those of this surface.
    """
    arc_of_contour = arcs_of_contours(tables["arcs"], tables["contours"].num_rows)
    contours, of_arcs = trace_arcs_at_levels(mesh, graph, _take_levels(tables["levels"]))
    anchors = mesh.vertex[np.column_stack([contours.lower, contours.upper])]
    told = np.column_stack([tables["contours"][name].to_numpy() for name in ("lower_vertex", "upper_vertex")])
    if not np.array_equal(anchors, told):
        raise ReebsliceError("contours.parquet: these are not the contours of the surface; make the results anew")
    shown = np.full(len(graph.arcs), -1, np.int32)
    crossed = np.flatnonzero(np.diff(of_arcs.start))
    shown[crossed] = arc_of_contour[of_arcs.member[of_arcs.start[crossed]]]
    return spread_labels(graph.arcs, shown)[arcs_of_faces(mesh, graph, faces)]


def arcs_of_contours(arcs, count):
    """Find the arc of the surface's graph of which each contour is a point.

    Parameters
    ----------
    arcs : pyarrow.Table
        The table `arcs`.
    count : int
        Number of contours.

    Returns
    -------
    (count,) int32
        `arc` of the rows with graph `surface`; -1 for none.
    """
    found = np.full(count, -1, np.int32)
    for graph, arc, nodes in zip(*(arcs[name].to_pylist() for name in ("graph", "arc", "nodes"))):
        if graph == "surface":
            found[nodes] = arc
    return found


def _take_levels(table):
    """The :class:`Levels` of the table `levels`."""
    tie_x, tie_y = (np.array(table[name].to_pylist(), float) for name in ("tie_x", "tie_y"))
    return Levels(table["height"].to_numpy(), table["vertices_below"].to_numpy(), tie_x, tie_y)


def spread_labels(ends, label):
    """Give arcs without a label that of the nearest arc with one.

    Parameters
    ----------
    ends : (A, 2) int
        Nodes 0, 1, ... that the arcs join.
    label : (A,) int32
        -1 for none.

    Returns
    -------
    (A,) int32
        Nearest by the number of nodes in between, then by the number of the arc; -1 where no way leads to a label.
    """
    ends = np.ascontiguousarray(ends)
    return _spread(ends, list_incidence(ends, int(ends.max(initial=-1)) + 1), label.astype(np.int32))


@njit
def _spread(ends, incident, label):
    """Do as :func:`spread_labels`, breadth first; changes `label` and returns it."""
    queue, count = np.empty(len(label), np.int64), 0
    for arc in range(len(label)):
        if label[arc] >= 0:
            queue[count] = arc
            count += 1
    place = 0
    while place < count:
        for end in ends[queue[place]]:
            for other in incident.member[incident.start[end] : incident.start[end + 1]]:
                if label[other] < 0:
                    label[other] = label[queue[place]]
                    queue[count] = other
                    count += 1
        place += 1
    return label
