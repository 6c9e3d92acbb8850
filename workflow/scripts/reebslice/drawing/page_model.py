"""Gather what the page of a model shows."""

import numpy as np

from ..errors import ReebsliceError, TooManyCrossingsError
from ..graphs.bodies import pocket_bodies
from ..graphs.loops import find_loops
from ..graphs.pockets import find_islands, find_pockets
from ..graphs.shown_arcs import arcs_of_contours, label_shown_arcs
from ..graphs.synthesis import contour_centres
from ..morse.height_mesh import height_mesh
from ..morse.reeb_graph import surface_reeb_graph
from .embedded_graphs import embed_graphs
from .model import stack_columns
from .scene import Model

MOST_LOOPS = 400
MOST_POCKETS = 40  # of pockets, and of islands


def gather_model(tables, body, curves, graphs, rotation, size):
    """Gather what the page of a model shows.

    Parameters
    ----------
    tables : dict of pyarrow.Table
        vertices, faces, levels, contours (without `geometry`), nodes and arcs.
    body : (n,) int
        Of every vertex.
    curves : Curves
        Those of the contours.
    graphs : dict of str to Graph
        Those that are shown.
    rotation : (3, 3) float64
    size : float
        Pockets and islands less deep are left out, mesh units.

    Returns
    -------
    model : Model
    notes : list of str
        What is left out, in sentences.
    """
    points, faces = stack_columns(tables["vertices"], "xyz"), stack_columns(tables["faces"], "abc")
    mesh = height_mesh(points, faces, rotation)
    labels = label_shown_arcs(mesh, surface_reeb_graph(mesh), faces, tables)
    contours, arcs = tables["contours"], tables["arcs"]
    material = stack_columns(tables["nodes"], "xyz")
    embedded = embed_graphs(graphs, arcs.to_pylist(), material, contour_centres(contours, curves, rotation))
    loops, notes = _find_loops(points, faces, rotation, body)
    pockets, more = _find_pockets(points, faces, rotation, body, size)
    notes += more + [
        f"The {name.replace('_', ', ')} graph is too large to be read, and is left out: {len(graph.nodes):,} nodes."
        for name, graph in graphs.items()
        if name not in embedded
    ]
    heights = tables["levels"]["height"].to_numpy()
    owners = arcs_of_contours(arcs, contours.num_rows)
    return Model(points, faces, labels, owners, rotation, heights, contours, curves, embedded, loops, pockets), notes


def _find_loops(points, faces, rotation, body):
    """The loops that are shown, the longest-lived ones, or None, and what is left out."""
    try:
        loops = find_loops(points, faces, rotation, body_of_vertex=body)
    except TooManyCrossingsError as fault:
        return None, [f"No loops are shown: {fault}"]
    count = len(loops.kind)
    if count <= MOST_LOOPS:
        return loops, []
    chosen = np.sort(np.argsort(loops.bottom_height - loops.top_height, kind="stable")[:MOST_LOOPS])
    columns = [_pick(column, chosen) for column in loops]
    return loops._replace(**dict(zip(loops._fields, columns))), [
        f"Of {count:,} loops the {MOST_LOOPS} highest are shown."
    ]


def _pick(column, chosen):
    """Some rows of a column of :class:`Loops`."""
    if isinstance(column, np.ndarray):
        return column[chosen]
    if isinstance(column, list):
        return [column[k] for k in chosen]
    members = [column.member[column.start[k] : column.start[k + 1]] for k in chosen]
    start = np.concatenate([[0], np.cumsum([len(own) for own in members])])
    return column._replace(start=start, member=np.concatenate(members))


def _find_pockets(points, faces, rotation, body, size):
    """Pockets and islands with their bodies, by name, and what is left out."""
    ways = {
        "pockets": lambda least: find_pockets(points, faces, rotation, least),
        "islands": lambda least: find_islands(points, faces, rotation, body, least),
    }
    shown, notes = {}, []
    for name, find in ways.items():
        try:
            found, least = find(size), size
            if len(found.kind) > MOST_POCKETS:
                depths = np.sort(np.abs(found.end_height - found.begin_height))
                least = float(depths[-MOST_POCKETS])
                found = find(least)
            shown[name] = found, pocket_bodies(points, faces, found, rotation)
        except ReebsliceError as fault:
            notes.append(f"No {name} are shown: {fault}")
        else:
            notes.append(f"{name.capitalize()} less than {least:.3g} deep are not shown.")
    return shown, notes
