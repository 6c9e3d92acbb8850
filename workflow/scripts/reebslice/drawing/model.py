"""What the picture of a model shows, gathered from the model's tables."""

import numpy as np
import pyarrow as pa

from ..certification.graphml import parse_graph
from ..formats.graphml import Graph
from ..formats.wkb import unpack_curves

CURVES = 14  # levels whose contours are drawn faintly


def list_facts(certificate, n_faces, n_levels):
    """List the statements below the title: faces, genus, loops, voids, levels, and what is not shown.

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
        (certificate.get("loops_solid"), "loop", "loops"),
        (certificate.get("voids") or None, "void", "voids"),
        (certificate.get("hidden_genus") or None, "hidden loop", "hidden loops"),
        (certificate.get("suppressed_loops") or None, "suppressed loop", "suppressed loops"),
    ]
    facts = [f"{count:,} {one if count == 1 else many}" for count, one, many in counts if isinstance(count, int)]
    genus = certificate.get("genus")
    return facts[:1] + ([f"genus {genus}"] if genus is not None else []) + facts[1:]


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
    rows = np.flatnonzero(np.isin(read_column(contours, "level"), chosen))
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
