"""The solid's graph, the contours and the surface as lines and triangles for ParaView; the graph as a tree for SWC."""

import numpy as np

from ..arrays.grouping import Groups
from ..formats.swc import swc_text
from ..formats.vtp import vtp_text
from .spanning_trees import span_forest

RADIUS = "MaximumInscribedSphereRadius"  # the name by which VMTK's and other tools know radii along centre lines
UNKNOWN = -1  # what stands for an arc that is none


def graph_lines(graph, arcs, nodes, facts):
    """Write the arcs of the solid's graph as lines through their material points.

    Parameters
    ----------
    graph : Graph
        Of the solid; node h7 is the handle 7.
    arcs, nodes : pyarrow.Table
    facts : dict of str to str
        About the model.

    Returns
    -------
    str
        Poly data, model frame, a line for each arc from its lower to its upper node. Points carry `height` and,
        under the name in `RADIUS`, the radius of the largest circle around them in their region; a node on the
        surface has 0.
    """
    material = np.column_stack([nodes[name].to_numpy() for name in ("x", "y", "z", "height", "inscribed_radius")])
    radius = {tuple(row[:3]): row[4] for row in material.tolist()}  # of nodes that are material points
    spots = {}
    for row in graph.nodes.values():
        place = [row[name] for name in ("x", "y", "z", "height")]
        spots[row["handle"]] = [*place, radius.get(tuple(place[:3]), 0.0)]
    rows = [row for row in arcs.to_pylist() if row["graph"] == "solid"]
    lines = [np.vstack([spots[row["source"]], material[row["nodes"]], spots[row["target"]]]) for row in rows]
    start = np.cumsum([0, *map(len, lines)])
    points = np.concatenate([np.empty((0, 5)), *lines])
    told = {name: np.array([row[name] for row in rows], np.int32) for name in ("arc", "source", "target")}
    told |= {name: np.array([row[name] for row in rows], np.float64) for name in ("lower", "upper", "length", "volume")}
    along = {"height": points[:, 3], RADIUS: points[:, 4]}
    return vtp_text(points[:, :3], Groups(start, np.arange(start[-1])), told, along, facts)


def contour_lines(contours, curves, rotation, facts):
    """Write the contours as closed lines.

    Parameters
    ----------
    contours : pyarrow.Table
        The table, which may lack the column `geometry`.
    curves : Curves
        Its curves, tilted frame.
    rotation : (3, 3) float64
        From the model frame to the tilted frame.
    facts : dict of str to str

    Returns
    -------
    str
        Poly data, model frame. Lines carry `contour`, `level`, `region`, `shell`, `inner` (0 or 1) and `height`.
    """
    size = np.diff(curves.start)
    height = contours["height"].to_numpy()
    points = np.column_stack([curves.points, np.repeat(height, size)]) @ np.asarray(rotation)
    told = {name: contours[name].to_numpy() for name in ("contour", "level", "region", "shell")}
    told |= {"inner": contours["inner"].to_numpy(zero_copy_only=False).astype(np.int32), "height": height}
    return vtp_text(points, _close(curves.start), told, None, facts)


def _close(start):
    """The points of closed curves, each with the first once more at its end where it is not there yet."""
    begin = start + np.arange(len(start))
    member = np.empty(begin[-1], np.int64)
    last = begin[1:] - 1
    inside = np.ones(len(member), bool)
    inside[last] = False
    member[inside] = np.arange(start[-1])
    member[last] = start[:-1]
    return Groups(begin, member)


def surface_triangles(points, faces, face_arcs, height, facts):
    """Write the surface as triangles with the arcs that they lie on.

    Parameters
    ----------
    points : (n, 3) float64
    faces : (m, 3) int
    face_arcs : pyarrow.Table
        A row for each face.
    height : (n,) float64
    facts : dict of str to str

    Returns
    -------
    str
        Poly data, model frame. Faces carry `surface_arc` and `solid_arc`, -1 where there is none, points `height`.
    """
    told = {name: face_arcs[name].fill_null(UNKNOWN).to_numpy() for name in ("surface_arc", "solid_arc")}
    cells = Groups(np.arange(0, faces.size + 1, 3), np.ravel(faces))
    return vtp_text(points, cells, told, {"height": height}, facts, "Polys")


def graph_tree(graph, facts):
    """Write the solid's graph with all material points as a forest in SWC.

    Parameters
    ----------
    graph : Graph
        The augmented graph.
    facts : dict of str to str

    Returns
    -------
    swc : str
        A tree for each body, its root the lowest event. Each loop is cut where the material is narrowest.
    cuts : list of dict
        What was cut, one edge per loop: `edge`, its `nodes`, and their numbers in the file, `points`.
    """
    names, nodes = list(graph.nodes), list(graph.nodes.values())
    place = {name: k for k, name in enumerate(names)}
    points = np.array([[row[axis] for axis in "xyz"] for row in nodes], float)
    radius = np.array([row["inscribed_radius"] for row in nodes], float)
    known = {tuple(spot): r for spot, r in zip(points.tolist(), radius.tolist()) if r == r}
    radius = np.array([known.get(tuple(spot), 0.0) for spot in points.tolist()])
    ends = np.array([[place[a], place[b]] for a, b, _ in graph.edges], np.int64).reshape(-1, 2)
    low, high = np.sort(radius[ends], axis=1).T
    forest = span_forest(len(names), ends, np.where(low > 0, low, high))  # at a node on the surface that of the point
    number = np.argsort(forest.order) + 1
    cuts = [
        {
            "edge": graph.edges[k][2]["id"],
            "nodes": [names[end] for end in ends[k].tolist()],
            "points": number[ends[k]].tolist(),
        }
        for k in forest.cut.tolist()
    ]
    return swc_text(points[forest.order], radius[forest.order], forest.parent, facts), cuts
