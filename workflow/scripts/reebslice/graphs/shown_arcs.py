"""Which arc of the surface's graph, as the levels show it, each face of the surface lies on.

The exact graph has an arc for every chain of contours, however short. The graph that
the levels show has fewer, where what lies between two levels cancels. A contour of a
level is a point of one arc of each, which ties the two together; an exact arc that no
level crosses counts with the nearest that one does.
"""

import numpy as np

from ..arrays.nearest_labels import spread_labels
from ..errors import ReebsliceError
from ..morse.face_arcs import arcs_of_faces
from ..slicing.graph_slices import trace_arcs_at_levels
from ..slicing.tables import levels_of_table


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
    (m,) int64
        `arc` of the rows of `arcs` with graph `surface`; -1 on a component that no level cuts.

    Raises
    ------
    ReebsliceError
        The contours are not those of this surface.
    """
    arc_of_contour = arcs_of_contours(tables["arcs"], tables["contours"].num_rows)
    contours, of_arcs = trace_arcs_at_levels(mesh, graph, levels_of_table(tables["levels"]))
    anchors = mesh.vertex[np.column_stack([contours.lower, contours.upper])]
    told = np.column_stack([tables["contours"][name].to_numpy() for name in ("lower_vertex", "upper_vertex")])
    if not np.array_equal(anchors, told):
        raise ReebsliceError("contours.parquet: these are not the contours of the surface; make the results anew")
    shown = np.full(len(graph.arcs), -1, np.int32)
    crossed = np.flatnonzero(np.diff(of_arcs.start))
    shown[crossed] = arc_of_contour[of_arcs.member[of_arcs.start[crossed]]]
    return spread_over_arcs(graph.arcs, shown)[arcs_of_faces(mesh, graph, faces)]


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


def spread_over_arcs(ends, label):
    """Give arcs without a label that of the nearest arc with one.

    Parameters
    ----------
    ends : (A, 2) int
        Nodes 0, 1, ... that the arcs join.
    label : (A,) int
        -1 for none.

    Returns
    -------
    (A,) int64
        Nearest by the number of nodes in between, of equally near ones the lowest label; -1 where no way leads to one.
    """
    count = len(label)
    items = np.append(label, np.full(int(np.max(ends, initial=-1)) + 1, -1))  # nodes lie between arcs
    return spread_labels(items, np.repeat(np.arange(count), 2), count + np.ravel(ends))[:count]
