"""From slices to Reeb graphs: edges, arcs and the graphs."""

from collections import Counter
from itertools import chain
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from ..formats.graphml import Graph
from ..links.similarity import boolean_similarity, link_by_proximity, link_by_similarity
from ..planar.curves import curve_centres
from ..planar.outlines import outline_polygons
from ..slicing.tables import block_regions, contour_outlines, region_levels, region_outlines
from ..table_checks import build_table
from .arcs import arc_columns, bounding_arcs, trace_arcs
from .parts import linked_parts, solid_parts, surface_parts
from .reeb_graphs import augmented_graph, reeb_graph, simplified_graph
from .solid_nodes import embed_joints
from .void_graph import void_arcs

METHODS = ("exact", "similarity", "proximity")
SOLID_ATTRIBUTES = ("arc", "lower", "upper", "length", "volume", "similarity_min", "n_nodes")
SURFACE_ATTRIBUTES = ("arc", "lower", "upper", "length", "area", "inner", "n_nodes")
VOID_ATTRIBUTES = ("arc", "lower", "upper", "length", "volume", "outside", "n_nodes")
# what a joint does by how many items it has below and above (many: 2)
GUESSED = {
    (0, 1): (0, "A", "creation"),
    (1, 0): (2, "B", "annihilation"),
    (2, 1): (1, "A", "union"),
    (1, 2): (1, "B", "separation"),
}


class Synthesis(NamedTuple):
    """Tables `edges` and `arcs`, and the graphs made of them."""

    edges: pa.Table
    arcs: pa.Table
    solid: Graph
    surface: Graph
    void: Graph
    augmented: Graph
    solid_simplified: Graph
    surface_simplified: Graph


def synthesize(contours, curves, pieces, handles, nodes, rotation, feature_size, method="exact"):
    """Connect the levels into Reeb graphs.

    Parameters
    ----------
    contours : pyarrow.Table
        The table `contours`, without `geometry`.
    curves : Curves
        Its curves, tilted frame (:func:`tables.contour_curves`).
    pieces, handles, nodes : pyarrow.Table
    rotation : (3, 3) float64
        From the model frame to the tilted frame.
    feature_size : float
        Mesh units; the simplified graphs show nothing below it.
    method : {"exact", "similarity", "proximity"}
        The links of the mesh; Boolean 2D shape similarity, as in the paper;
        nearest centroids.

    Returns
    -------
    Synthesis
        All edges carry their Boolean similarity, and `linked` says whether the
        mesh links their ends.

    References
    ----------
    Pareja-Corcho et al., Synthesis of Reeb Graph and Morse Operators from Level
    Sets of a Boundary Representation, section on edges.
    """
    outlines = region_outlines(contours, curves)
    centres = contour_centres(contours, curves, rotation)
    material = np.column_stack([nodes[axis].to_numpy() for axis in "xyz"])
    truth = block_links(pieces, contours)
    if method == "exact":
        solid, surface = solid_parts(pieces, contours, handles), surface_parts(pieces, handles)
        rows = {row["handle"]: row for row in handles.to_pylist()}
        pairs = sorted(truth)
        held = [Counter(handles[part].to_pylist()) for part in ("block", "piece")]
    else:
        link = {"similarity": link_by_similarity, "proximity": link_by_proximity}[method]
        pairs = link(region_levels(contours), nodes["height"].to_numpy(), outline_polygons(outlines))
        solid = linked_parts(region_levels(contours), pairs)
        surface = linked_parts(contours["level"].to_numpy(), link_contours(contours, curves, link))
        rows, held = {}, [Counter(), Counter()]
    solid_joints = joint_rows(solid, material, nodes["height"].to_numpy(), rows, held[0])
    solid_joints = embed_joints(solid, solid_joints, material, nodes["inscribed_radius"].to_numpy())
    surface_joints = joint_rows(surface, centres, contours["height"].to_numpy(), rows, held[1])
    edges = edges_table(pairs, truth, solid, solid_joints, outlines, region_levels(contours), method)
    ends = zip(edges["source"].to_pylist(), edges["target"].to_pylist())
    similarity = dict(zip(ends, edges["similarity"].to_pylist()))
    traced, inner = (trace_arcs(solid), trace_arcs(surface)), contours["inner"].to_pylist()
    bounds = bounding_arcs(solid, *traced, contours["region"].to_pylist(), inner)
    solid_arcs = arc_columns(traced[0], "solid", solid_joints, material, similarity, bounds[0])
    surface_arcs = arc_columns(traced[1], "surface", surface_joints, centres, {}, bounds[1])
    # links that were guessed leave open what is void
    void, void_joints = void_arcs(pieces, contours, handles, centres, traced[1]) if method == "exact" else (None, {})
    tables = [solid_arcs, surface_arcs, *([void] if void else [])]
    arcs = build_table("arcs", {name: [*chain(*(table[name] for table in tables))] for name in solid_arcs})
    of = _rows_by_graph(arcs, inner)
    return Synthesis(
        edges,
        arcs,
        reeb_graph(of["solid"], solid_joints, SOLID_ATTRIBUTES, "s"),
        reeb_graph(of["surface"], surface_joints, SURFACE_ATTRIBUTES, "c"),
        reeb_graph(of["void"], void_joints, VOID_ATTRIBUTES, "v"),
        augmented_graph(solid, solid_joints, nodes, similarity),
        simplified_graph(of["solid"], solid_joints, "volume", feature_size, "s"),
        simplified_graph(of["surface"], surface_joints, "area", feature_size, "c"),
    )


def _rows_by_graph(arcs, inner):
    """The rows of the table `arcs` by their graph, with what the edges of the graphs tell besides."""
    rows = {"solid": [], "surface": [], "void": []}
    for row in arcs.to_pylist():
        nodes = row["nodes"]
        row |= {"n_nodes": len(nodes), "inner": inner[nodes[0]] if nodes else False, "outside": not nodes}
        rows[row["graph"]].append(row)
    return rows


def block_links(pieces, contours):
    """List the pairs of regions, the lower first, that a block joins: {pair: block}."""
    ends = zip(*block_regions(pieces, contours))
    return {(low, high): block for block, (below, above) in enumerate(ends) for low in below for high in above}


def link_contours(contours, curves, link):
    """Link contours of consecutive levels by the rule `link`, outer and inner ones apart: a sorted list of pairs."""
    level, height = contours["level"].to_numpy(), contours["height"].to_numpy()
    inner = contours["inner"].to_numpy(zero_copy_only=False)
    shapes = outline_polygons(contour_outlines(contours, curves))
    pairs = []
    for kind in (inner, ~inner):
        members = np.flatnonzero(kind)
        links = link(level[members], height[members], shapes[members])
        pairs += [(int(members[i]), int(members[j])) for i, j in links]
    return sorted(pairs)


def contour_centres(contours, curves, rotation):
    """Return the centroids of the contours, (C, 3) float64, model frame."""
    centres = curve_centres(*curves)
    return np.column_stack([centres, contours["height"].to_numpy()]) @ np.asarray(rotation)


def joint_rows(parts, points, height, handles, held):
    """Describe all joints of some parts.

    Parameters
    ----------
    parts : GraphParts
    points, height : (R, 3), (R,) float64
        Of the items.
    handles : dict
        Row of every handle by its id.
    held : Counter
        Handles in each part; a joint that is alone in its part stands for all of
        them (`n_handles`).

    Returns
    -------
    dict
        Row with x, y, z, height, index, side, ... of every joint by its id. A
        joint that is no handle, because the mesh was not asked, lies amid the
        items around it and has what their numbers suggest.
    """
    rows = {}
    for part, (lower, upper, joints) in enumerate(zip(parts.below, parts.above, parts.joints)):
        if joints and joints[0] in handles:
            rows |= {joint: handles[joint] | {"n_handles": held[part] - len(joints) + 1} for joint in joints}
        elif joints or len(lower) != 1 or len(upper) != 1:
            index, side, operation = GUESSED.get((min(len(lower), 2), min(len(upper), 2)), (1, "", "compound"))
            x, y, z = points[lower + upper].mean(axis=0).tolist()
            rows[joints[0] if joints else -1 - part] = {
                "handle": joints[0] if joints else -1 - part,
                "x": x, "y": y, "z": z, "height": float(height[lower + upper].mean()),
                "index": index, "side": side, "operation": operation, "change": None,
                "branches": len(lower) != len(upper),
            }  # fmt: skip
    return rows


def edges_table(pairs, truth, parts, joints, outlines, level, method):
    """Make the table `edges`: one row per pair of linked regions, with its Boolean similarity."""
    part_of = {low: part for part, lower in enumerate(parts.below) for low in lower}
    source, target = np.array(pairs, np.int64).reshape(-1, 2).T
    inside = [parts.joints[part_of[low]] for low in source.tolist()]
    return build_table(
        "edges",
        {
            "edge": np.arange(len(pairs)),
            "source": source,
            "target": target,
            "slab": level[source],
            "handle": [members[0] if members else None for members in inside],
            "operation": [joints[members[0]]["operation"] if members else "continuation" for members in inside],
            **boolean_similarity(outlines, source, target),
            "linked": [pair in truth for pair in pairs],
            "method": [method] * len(pairs),
        },
    )
