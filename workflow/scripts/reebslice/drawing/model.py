"""What the picture of a model shows, gathered from the model's tables."""

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from ..certification.graphml import parse_graph
from ..formats.graphml import Graph
from ..formats.wkb import unpack_curves
from ..graphs.synthesis import contour_centres
from .embedded_graphs import embed_graph
from .page_words import describe_genus, format_figure

READABLE = 60  # nodes, beyond which a graph is drawn simplified unless another is asked for
VERTEX = ("vertex_x", "vertex_y", "vertex_z")
CURVES = 14  # levels whose contours are drawn faintly


def list_facts(certificate, n_faces, n_levels):
    """List the statements below the title: faces, genus as loops of solid and surface, levels, voids.

    Parameters
    ----------
    certificate : dict
        The content of certificate.json.
    n_faces, n_levels : int

    Returns
    -------
    list of str
    """
    counts = [
        (n_faces, "face", "faces"),
        (n_levels, "level", "levels"),
        (certificate.get("voids") or None, "void", "voids"),
    ]
    facts = [f"{count:,} {one if count == 1 else many}" for count, one, many in counts if isinstance(count, int)]
    genus = describe_genus(certificate)
    return facts[:1] + ([genus] if genus else []) + facts[1:]


def read_graph(path):
    """Read a GraphML file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Graph
        As the workflow wrote it.
    """
    read = parse_graph(path.read_bytes())
    return Graph(read.nodes, [(low, high, facts) for low, high, _, facts in read.edges])


def stack_columns(table, names):
    """Stack columns of numbers of a table side by side.

    Parameters
    ----------
    table : pyarrow.Table
    names : iterable of str
        Columns without nulls.

    Returns
    -------
    (rows, columns) array
    """
    return np.column_stack([read_column(table, name) for name in names])


def read_column(table, name):
    """Return a column of numbers without nulls as an array; pyarrow's own to_numpy would import pandas."""
    return np.from_dlpack(table[name].combine_chunks())


def choose_graph(wish, nodes):
    """Choose the graph that a picture shows.

    Parameters
    ----------
    wish : {"auto", "solid", "surface", "simplified"}
        `auto`: that of the solid, if it has no more than `READABLE` nodes, else that simplified.
    nodes : int
        Of the solid's graph.

    Returns
    -------
    str
        A name in `schemas.GRAPHS`.
    """
    if wish == "auto":
        wish = "solid" if nodes <= READABLE else "simplified"
    return {"simplified": "solid_simplified"}.get(wish, wish)


def describe_graph(name, shown, nodes, size, unit):
    """Say what graph a picture shows.

    Parameters
    ----------
    name : str
    shown, nodes : int
        Nodes that it has, and that the solid's graph has.
    size : float or None
        The feature size.
    unit : str or None
        Of length.

    Returns
    -------
    str
    """
    if name != "solid_simplified":
        return f"Reeb graph of the {name}, {shown:,} nodes"
    least = f" of {format_figure(float(f'{size:.3g}'), unit)} and more" if size else ""
    return f"Reeb graph of the solid, simplified: {shown:,} of {nodes:,} nodes, features{least}"


def place_arcs(name, graph, tables, curves, rotation):
    """Find where a graph is drawn in the body.

    Parameters
    ----------
    name : {"solid", "surface", "solid_simplified"}
    graph : Graph
    tables : dict of pyarrow.Table
        `arcs`, `nodes`, and `contours` without `geometry`.
    curves : function
        That returns the curves of the contours, called only where they are needed.
    rotation : (3, 3) float64
        From the model frame to the tilted frame.

    Returns
    -------
    graph : Graph
        With x, y, z where its nodes are drawn.
    paths : dict
        For every arc (k, 3) float64, upward, model frame.
    """
    material = stack_columns(tables["nodes"], "xyz")
    centres = contour_centres(tables["contours"], curves(), rotation) if name == "surface" else np.empty((0, 3))
    arcs = tables["arcs"].filter(pc.equal(tables["arcs"]["graph"], name.split("_")[0])).to_pylist()
    found = embed_graph(name, graph, arcs, centres if name == "surface" else material)
    nodes = {
        node["name"]: dict(zip(VERTEX, (node[axis] for axis in "xyz"))) | node | dict(zip("xyz", spot))
        for node, spot in zip(found.nodes, found.spots.tolist())
    }
    return Graph(nodes, graph.edges), {arc["arc"]: path[1:-1] for arc, path in zip(found.arcs, found.paths)}


def trace_solid_arcs(arcs, nodes):
    """Trace every arc of the solid's graph through its material points.

    Parameters
    ----------
    arcs, nodes : pyarrow.Table

    Returns
    -------
    dict
        For every arc of the solid (k, 3) float64, upward, model frame.
    """
    points, numbers = stack_columns(nodes, "xyz"), read_column(nodes, "node")
    order = np.argsort(numbers)
    rows = zip(arcs["graph"].to_pylist(), arcs["arc"].to_pylist(), arcs["nodes"].to_pylist(), strict=True)
    return {
        arc: points[order[np.searchsorted(numbers, np.array(chain, int), sorter=order)]]
        for graph, arc, chain in rows
        if graph == "solid"
    }


def pick_curves(levels, contours, geometry):
    """Pick the contours of some levels that are spread evenly over the heights.

    Parameters
    ----------
    levels, contours : pyarrow.Table
        `contours` without the column `geometry`.
    geometry : iterable of pyarrow.Array
        That column, in blocks.

    Returns
    -------
    list of (k, 3) float64
        Closed curves, tilted frame.
    """
    heights = read_column(levels, "height")
    if len(heights) == 0:
        return []
    wanted = np.linspace(heights.min(), heights.max(), CURVES + 2)[1:-1]
    chosen = read_column(levels, "level")[np.unique(np.abs(heights[:, None] - wanted).argmin(axis=0))]
    return unpack_contours(contours, geometry, np.flatnonzero(np.isin(read_column(contours, "level"), chosen)))


def unpack_contours(contours, geometry, rows):
    """Unpack the curves of some contours.

    Parameters
    ----------
    contours : pyarrow.Table
        Without the column `geometry`.
    geometry : iterable of pyarrow.Array
        That column, in blocks.
    rows : (k,) int
        Ascending.

    Returns
    -------
    list of (k, 3) float64
        Closed curves, tilted frame.
    """
    most = int(read_column(contours, "n_points")[rows].sum()) + len(rows)
    points, start = unpack_curves(take_rows(geometry, rows), most)
    tops = read_column(contours, "height")[rows]
    lines = np.split(points, start[1:-1]) if len(rows) else []
    return [np.column_stack([line, np.full(len(line), top)]) for line, top in zip(lines, tops, strict=True)]


def take_rows(blocks, rows):
    """Yield the ascending `rows` of a column that comes in blocks, in blocks."""
    first = 0
    for block in blocks:
        inside = rows[(rows >= first) & (rows < first + len(block))]
        yield block.take(pa.array(inside - first))
        first += len(block)
