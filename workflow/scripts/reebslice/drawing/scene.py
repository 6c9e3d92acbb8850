"""A model as a scene: surface with arcs, contours, graphs, loops and pockets, to be written as binary glTF.

Everything is in the model frame; the scene turns it so that the height points up.
"""

import itertools
from typing import NamedTuple

import numpy as np

from ..formats.glb import LINES, POINTS, TRIANGLES, Part
from .canvas import rgb
from .display_curves import list_segments, simplify_curves
from .display_mesh import reduce_faces, split_by_label
from .embedded_graphs import find_vertices
from .loops import INKS as LOOP_INKS
from .marks import INK, MARKS, SOFT
from .pockets import INKS as POCKET_INKS

CURVE_POINTS = 25_000  # of contours
PATH_POINTS = 20_000  # of all arcs of a graph
FEWEST = 8  # points of an arc
POCKET_FACES = 12_000  # of all pockets, or islands


class Model(NamedTuple):
    """What is shown of a model; model frame, but for curves.

    Attributes
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
    arc_of_face, arc_of_contour : (m,) and (C,) int
        Arc of the surface's graph; -1 for none.
    rotation : (3, 3) float64
    heights : (K,) float64
        Of the levels.
    contours : pyarrow.Table
        Without `geometry`.
    curves : Curves
        Those of the contours, tilted frame.
    graphs : dict of str to EmbeddedGraph
    loops : Loops or None
        At most as many as are shown.
    pockets : dict of str to (Pockets, list of (points, faces))
        Pockets and islands with their bodies.
    """

    points: np.ndarray
    faces: np.ndarray
    arc_of_face: np.ndarray
    arc_of_contour: np.ndarray
    rotation: np.ndarray
    heights: np.ndarray
    contours: object
    curves: object
    graphs: dict
    loops: object
    pockets: dict


def list_parts(model, most):
    """Make the parts of a scene.

    Parameters
    ----------
    model : Model
    most : int
        Faces of the surface, beyond which it is decimated.

    Returns
    -------
    parts : list of Part
    notes : list of str
        What was left out or made coarser, in sentences.
    """
    surface, notes = _surface_part(model, most)
    contours, more = _contour_parts(model)
    parts = [surface, *contours]
    for name, graph in model.graphs.items():
        parts += _graph_parts(name, graph)
    for name, (found, bodies) in model.pockets.items():
        parts += _pocket_parts(name, found, bodies)
    return parts + _loop_parts(model), notes + more


def _surface_part(model, most):
    """The surface, with the arc of every face on its corners."""
    points, faces, arcs = reduce_faces(model.points, model.faces, model.arc_of_face, most)
    points, corners, arc, _ = split_by_label(points, faces, arcs)
    told = {"faces": len(model.faces), "faces_shown": len(faces)}
    notes = []
    if len(faces) < len(model.faces):
        notes = [
            f"The surface has {len(model.faces):,} faces; for display only, it is decimated to {len(faces):,}. "
            "All figures are those of the whole surface."
        ]
    return Part("surface", TRIANGLES, points, corners.ravel(), {"arc": arc}, (0.62, 0.70, 0.80, 0.45), told), notes


def _contour_parts(model):
    """The contours of the levels, each a run of lines."""
    table = model.contours
    level = table["level"].to_numpy()
    extent = float(np.ptp(model.points, axis=0).max(initial=0.0))
    shown = simplify_curves(model.curves, level, extent, CURVE_POINTS)
    if not len(shown.points):
        return [], []
    found = np.unique(shown.curve)
    levels = np.unique(level[found])
    told = {
        "contours": found.tolist(),
        "level": level[found].tolist(),
        "region": table["region"].to_numpy()[found].tolist(),
        "inner": table["inner"].to_numpy(zero_copy_only=False)[found].astype(int).tolist(),
        "arc": model.arc_of_contour[found].tolist(),
        "levels": levels.tolist(),
        "heights": model.heights[levels].tolist(),
    }
    height = model.heights[level[shown.curve]]
    points = np.column_stack([shown.points, height]) @ model.rotation
    part = Part(
        "contours", LINES, points, list_segments(shown.curve).ravel(), {"contour": shown.curve}, _rgba("#23527C"), told
    )
    notes = [f"Contours are drawn within {shown.tolerance:.2g} of where they are."]
    if shown.every > 1:
        notes = [f"Of {len(model.heights):,} levels, one in {shown.every} is shown."] + notes
    return [part], notes


def _graph_parts(name, graph):
    """The arcs of a graph as lines, its nodes as points, and lines from these to their critical vertices."""
    parts = []
    most = max(PATH_POINTS // max(len(graph.arcs), 1), FEWEST)
    paths = [_thin(path, most) for path in graph.paths]
    if paths:
        arc = np.repeat(np.arange(len(paths)), [len(path) for path in paths])
        rows = [
            facts | {"ends": pair, "surface": walls}
            for facts, pair, walls in zip(graph.arcs, graph.ends.tolist(), graph.walls)
        ]
        points, lines = np.concatenate(paths), list_segments(arc).ravel()
        parts.append(Part(f"{name} arcs", LINES, points, lines, {"arc": arc}, _rgba(INK), {"arcs": rows}))
    if graph.nodes:
        vertices = find_vertices(graph.nodes)
        number = np.arange(len(vertices))
        colour = _rgba(MARKS["union"][1])
        parts.append(
            Part(f"{name} nodes", POINTS, graph.spots, number, {"node": number}, colour, {"nodes": graph.nodes})
        )
        ends = np.concatenate([graph.spots, vertices])
        leaders = np.column_stack([number, number + len(number)]).ravel()
        parts.append(Part(f"{name} leaders", LINES, ends, leaders, {"node": np.tile(number, 2)}, _rgba(SOFT), {}))
    return parts


def _thin(path, most):
    """A curve of which no more than `most` points are kept, evenly, both ends among them."""
    if len(path) <= most:
        return path
    return path[np.unique(np.linspace(0, len(path) - 1, most).round().astype(int))]


def _loop_parts(model):
    """Circles around loops, and closed paths along them."""
    loops = model.loops
    if loops is None or not len(loops.kind):
        return []
    names = (
        "kind",
        "inner",
        "height",
        "perimeter",
        "section",
        "inscribed_radius",
        "length",
        "bottom_height",
        "top_height",
    )
    columns = {name: getattr(loops, name).tolist() for name in names}
    rows = [dict(zip(columns, row)) for row in zip(*columns.values())]
    rows = [row | {"centre": spot} for row, spot in zip(rows, loops.centre.tolist())]
    paths = [model.points[loops.paths.member[a:b]] for a, b in itertools.pairwise(loops.paths.start)]
    return [
        _closed_lines("loop circles", loops.circles, rows),
        _closed_lines("loop paths", paths, rows),
    ]


def _closed_lines(name, curves, rows):
    """A part of closed curves, the first point of each not repeated at its end."""
    closed = [np.vstack([curve, curve[:1]]) for curve in curves]
    loop = np.repeat(np.arange(len(closed)), [len(curve) for curve in closed])
    lines = list_segments(loop).ravel()
    return Part(name, LINES, np.concatenate(closed), lines, {"loop": loop}, _rgba(LOOP_INKS["handle"]), {"loops": rows})


def _pocket_parts(name, found, bodies):
    """The bodies of pockets, or islands."""
    share = POCKET_FACES // max(len(bodies), 1)
    shapes = [reduce_faces(points, faces, np.zeros(len(faces), int), max(share, 60))[:2] for points, faces in bodies]
    kept = [k for k, (_, faces) in enumerate(shapes) if len(faces)]
    if not kept:
        return []
    first = np.cumsum([0] + [len(shapes[k][0]) for k in kept])
    number = np.repeat(np.arange(len(kept)), np.diff(first))
    faces = np.concatenate([shapes[k][1] + shift for k, shift in zip(kept, first)])
    names = ("kind", "begin_height", "end_height", "volume", "section")
    rows = [{key: getattr(found, key)[k].item() for key in names} for k in kept]
    points, colour = np.concatenate([shapes[k][0] for k in kept]), _rgba(POCKET_INKS[rows[0]["kind"]], 0.6)
    return [Part(name, TRIANGLES, points, faces.ravel(), {"pocket": number}, colour, {"pockets": rows})]


def _rgba(ink, opacity=1.0):
    """Red, green, blue and opacity of a colour such as #23527C."""
    return (*(rgb(ink) / 255).round(4).tolist(), opacity)
