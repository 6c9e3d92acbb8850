"""Arcs of a Reeb graph, their figures, and which arcs of the surface bound which of the solid."""

import itertools

import numpy as np


def trace_arcs(parts):
    """Trace the arcs between the joints of a graph.

    Parameters
    ----------
    parts : GraphParts

    Returns
    -------
    list of dict
        Sorted by `source` and `target`, the joints at the lower and the upper
        end, then by `nodes`, the items along the arc, upward. `measure` is the
        sum over the plain parts that the arc runs through, and an equal share,
        among the arc ends that meet there, of the parts at its two ends. A plain
        part that does not link one item to one other (only a surface that
        crosses itself has any) ends the arcs that reach it, at a joint with a
        negative number.
    """
    joints = [
        list(inside) or ([] if len(lower) == len(upper) == 1 else [-1 - part])
        for part, (lower, upper, inside) in enumerate(zip(parts.below, parts.above, parts.joints))
    ]
    part_above = {item: part for part, lower in enumerate(parts.below) for item in lower}
    arcs, ends = [], np.zeros(len(joints), int)
    for part, inside in enumerate(joints):
        for source, target in itertools.pairwise(inside):
            arcs.append({"source": source, "target": target, "nodes": [], "through": [], "between": (part, part)})
        for item in parts.above[part] if inside else ():
            nodes, through, following = [item], [], part_above[item]
            while not joints[following]:
                through.append(following)
                nodes.append(parts.above[following][0])
                following = part_above[nodes[-1]]
            target = joints[following][0]
            between = part, following
            arcs.append(
                {"source": inside[-1], "target": target, "nodes": nodes, "through": through, "between": between}
            )
    for arc in arcs:
        ends[list(arc["between"])] += 1 if arc["between"][0] != arc["between"][1] else 2
    share = (parts.measure / np.maximum(ends, 1)).tolist()
    for arc in arcs:
        shares = sum(share[part] for part in arc.pop("between"))
        arc["measure"] = float(parts.measure[arc.pop("through")].sum()) + shares
    return sorted(arcs, key=lambda arc: (arc["source"], arc["target"], arc["nodes"]))


def bounding_arcs(parts, solid, surface, region, inner):
    """Find which arcs of the surface bound which arcs of the solid.

    An arc of the solid keeps its surface arcs all along, because nothing
    happens on it. One without nodes lies between two events of a chain, and
    has those surface arcs of the regions next to the chain that pass it.

    Parameters
    ----------
    parts : GraphParts
        Of the solid.
    solid, surface : list of dict
        Arcs of both graphs, of :func:`trace_arcs`.
    region, inner : list
        Region of every contour, and whether it bounds a hole.

    Returns
    -------
    of_solid : list of list of int
        Arcs of the surface around each arc of the solid, outer ones before holes.
    of_surface : list of list of int
        Arcs of the solid that each arc of the surface bounds, upward.
    """
    arc_of = {contour: number for number, arc in enumerate(surface) for contour in arc["nodes"]}
    walls = [set() for _ in range(max(region, default=-1) + 1)]
    for contour, place in enumerate(region):
        walls[place].add(arc_of[contour])
    near = {}
    for lower, upper, joints in zip(parts.below, parts.above, parts.joints):
        if len(joints) > 1:
            near |= dict.fromkeys(itertools.pairwise(joints), walls[lower[0]] | walls[upper[0]])
    of_solid, of_surface = [], [[] for _ in surface]
    for number, arc in enumerate(solid):
        low, high = arc["source"], arc["target"]
        around = set().union(*(walls[node] for node in arc["nodes"])) if arc["nodes"] else near[low, high]
        if not arc["nodes"]:
            around = {k for k in around if surface[k]["source"] <= low and high <= surface[k]["target"]}
        of_solid.append(sorted(around, key=lambda k: (inner[surface[k]["nodes"][0]], k)))
        for k in of_solid[-1]:
            of_surface[k].append(number)
    return of_solid, of_surface


def arc_columns(arcs, graph, joints, points, similarity, bounds):
    """Tabulate the arcs of one graph.

    Parameters
    ----------
    arcs : list of dict
        Of :func:`trace_arcs`.
    graph : {"solid", "surface", "void"}
    joints : dict
        Row with x, y, z and height of every joint, by its id.
    points : (R, 3) float64
        Positions of the items, same frame as the joints.
    similarity : dict
        Shape similarity of pairs of items, empty where there is none.
    bounds : list of list of int
        Arcs of the surface that bound each, or of the solid that each bounds, as of :func:`bounding_arcs`.

    Returns
    -------
    dict of list
        Columns of the table `arcs`.
    """
    measure = [None if np.isnan(arc["measure"]) else arc["measure"] for arc in arcs]
    pairs = [list(zip(arc["nodes"][:-1], arc["nodes"][1:])) for arc in arcs]
    return {
        "arc": list(range(len(arcs))),
        "graph": [graph] * len(arcs),
        "source": [arc["source"] for arc in arcs],
        "target": [arc["target"] for arc in arcs],
        "lower": [joints[arc["source"]]["height"] for arc in arcs],
        "upper": [joints[arc["target"]]["height"] for arc in arcs],
        "length": _path_lengths(arcs, joints, points),
        "volume": measure if graph != "surface" else [None] * len(arcs),
        "area": measure if graph == "surface" else [None] * len(arcs),
        "nodes": [arc["nodes"] for arc in arcs],
        "bounds": bounds,
        "similarity_min": [min((similarity[p] for p in path if p in similarity), default=None) for path in pairs],
    }


def _path_lengths(arcs, joints, points):
    """Of each arc the length from joint to joint along its points, a list."""
    place = {number: len(points) + k for k, number in enumerate(joints)}
    every = np.vstack([points, *([row[axis] for axis in "xyz"] for row in joints.values())])
    paths = [[place[arc["source"]], *arc["nodes"], place[arc["target"]]] for arc in arcs]
    steps = np.diff(every[[item for path in paths for item in path]], axis=0)
    length, end = np.linalg.norm(steps, axis=1), np.cumsum([len(path) for path in paths]).tolist()
    return [float(length[b - len(path) : b - 1].sum()) for path, b in zip(paths, end)]
