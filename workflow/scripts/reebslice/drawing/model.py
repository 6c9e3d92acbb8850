"""What the picture of a model shows, gathered from the model's tables."""

from xml.etree import ElementTree

import numpy as np
import pyarrow as pa

from ..formats.graphml import Graph
from ..formats.wkb import unpack_curves

CURVES = 14  # levels whose contours are drawn faintly
GRAPHML = "{http://graphml.graphdrawing.org/xmlns}"


def list_facts(certificate, n_faces, n_levels):
    """The statements below the title: faces, genus, loops, voids, levels, and what is not shown."""
    counts = [
        (n_faces, "face", "faces"),
        (n_levels, "level", "levels"),
        (certificate.get("loops_solid"), "loop", "loops"),
        (certificate.get("voids") or None, "void", "voids"),
        (certificate.get("hidden_genus") or None, "hidden loop", "hidden loops"),
        (certificate.get("suppressed_loops") or None, "suppressed loop", "suppressed loops"),
    ]
    facts = [f"{count:,} {one if count == 1 else many}" for count, one, many in counts if isinstance(count, int)]
    genus = certificate.get("genus")
    return facts[:1] + ([f"genus {genus}"] if genus is not None else []) + facts[1:]


def read_graph(path):
    """The Graph in a GraphML file; importing networkx for that takes longer than drawing a model."""
    root = ElementTree.parse(path).getroot()
    kinds = {"int": int, "long": int, "float": float, "double": float}
    declared = root.iter(GRAPHML + "key")
    keys = {key.get("id"): (key.get("attr.name"), kinds.get(key.get("attr.type"), str)) for key in declared}

    def facts(element):
        data = ((keys[item.get("key")], item.text or "") for item in element.iter(GRAPHML + "data"))
        return {name: kind(text) for (name, kind), text in data}

    nodes = {node.get("id"): facts(node) for node in root.iter(GRAPHML + "node")}
    edges = [(edge.get("source"), edge.get("target"), facts(edge)) for edge in root.iter(GRAPHML + "edge")]
    return Graph(nodes, edges)


def tilt_points(points, rotation):
    """Points (n, 3) in the tilted frame."""
    return points @ rotation.T


def stack_columns(table, names):
    """The columns `names`, numbers without nulls, of a table as one array (rows, columns)."""
    return np.column_stack([read_column(table, name) for name in names])


def read_column(table, name):
    """A column of numbers without nulls as an array; pyarrow's own to_numpy would import pandas."""
    return np.from_dlpack(table[name].combine_chunks())


def trace_solid_arcs(arcs, nodes):
    """For every arc of the solid graph its material points (k, 3), upward, in the model frame."""
    points, numbers = stack_columns(nodes, "xyz"), read_column(nodes, "node")
    order = np.argsort(numbers)
    rows = zip(arcs["graph"].to_pylist(), arcs["arc"].to_pylist(), arcs["nodes"].to_pylist(), strict=True)
    return {
        arc: points[order[np.searchsorted(numbers, np.array(chain, int), sorter=order)]]
        for graph, arc, chain in rows
        if graph == "solid"
    }


def pick_curves(levels, contours, geometry):
    """The contours (k, 3), tilted frame, of some levels spread evenly over the heights.

    geometry : that column of the table `contours`, an iterable of Arrow arrays.
    """
    heights = read_column(levels, "height")
    if len(heights) == 0:
        return []
    wanted = np.linspace(heights.min(), heights.max(), CURVES + 2)[1:-1]
    chosen = read_column(levels, "level")[np.unique(np.abs(heights[:, None] - wanted).argmin(axis=0))]
    rows = np.flatnonzero(np.isin(read_column(contours, "level"), chosen))
    most = int(read_column(contours, "n_points")[rows].sum()) + len(rows)
    points, start = unpack_curves(take_rows(geometry, rows), most)
    tops = read_column(contours, "height")[rows]
    lines = np.split(points, start[1:-1]) if len(rows) else []
    return [np.column_stack([line, np.full(len(line), top)]) for line, top in zip(lines, tops, strict=True)]


def take_rows(blocks, rows):
    """Of a column that comes in blocks, the ascending `rows`, in blocks."""
    first = 0
    for block in blocks:
        inside = rows[(rows >= first) & (rows < first + len(block))]
        yield block.take(pa.array(inside - first))
        first += len(block)
