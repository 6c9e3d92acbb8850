"""One still picture per model: the solid's Reeb graph in the body, and flat by height.

Left the translucent surface in the tilted frame, height up, with the graph's
arcs through the material points (figure 6 of Pareja-Corcho et al.); right the
same graph drawn flat, every node at its height. An operation has one colour
and one shape in both (colours of Okabe and Ito, told apart by the
colour-blind); side B is hollow. A ring marks a node that stands for several
handles, which the levels do not separate. Places on the picture are (column, row) in pixels.
"""

from typing import NamedTuple

import numpy as np

from .canvas import Words, draw_lines, draw_marks, draw_segments, measure_text, new_canvas, rgb, write_words
from .flat import Panel, draw_flat
from .marks import CASED, FAR, INK, SOFT, draw_nodes, group_marks, mark_style, ring_style
from .rasters import rasterize_mesh, widest_azimuth
from .shading import shade_layers
from .views import fit_view, project_points, view_axes

VERDICT_INKS = {"exact": "#00724F", "exact_at_feature_size": "#005A8C", "uncertified": "#B3470A"}
POINTS = (864, 518.4)  # size of the picture, in the points that words and lines are measured in
LABELS = 40  # nodes, beyond which handles are not numbered


class Title(NamedTuple):
    """Words at the top: the model, short statements in a line below it, and the certificate's verdict."""

    name: str
    facts: list
    verdict: str


class Body(NamedTuple):
    """The surface of a model.

    Attributes
    ----------
    points : (n, 3) float64
        Vertices in the tilted frame.
    faces : (m, 3) int
        Counter-clockwise seen from outside.
    rotation : (3, 3) float64
        From the model frame to the tilted frame.
    curves : list of (k, 3) float64
        Closed contours in the tilted frame, drawn faintly.
    """

    points: np.ndarray
    faces: np.ndarray
    rotation: np.ndarray
    curves: list


def draw_model(title, body, graph, paths, options):
    """Draw the model and its solid Reeb graph.

    Parameters
    ----------
    title : Title
    body : Body
    graph : Graph
        The solid's graph; nodes with height, x, y, z (model frame), side,
        operation, handle and, if not 1, n_handles, edges with arc.
    paths : dict
        For an arc the material points (k, 3), model frame, upward; an arc
        without an entry is drawn straight.
    options : dict
        width (pixels), azimuth (degrees, or None for the largest silhouette) and
        elevation (degrees).

    Returns
    -------
    (height, width, 3) uint8
        Text and lines scale with the width. An empty surface or graph gives
        empty panels.
    """
    points = body.points
    width = int(options.get("width", 1600))
    height, unit = int(width * POINTS[1] / POINTS[0]), width / POINTS[0]
    canvas = new_canvas(width, height, unit)
    azimuth, elevation = options.get("azimuth"), float(options.get("elevation", 15))
    azimuth = widest_azimuth(points, body.faces, elevation) if azimuth is None else float(azimuth)
    view, corner, flat = _arrange(width, height, points, azimuth, elevation)
    seen, ends = draw_in_body(canvas, corner, view, body, graph, paths)
    words = _draw_frame(canvas, corner, view, body.rotation)
    marks = list(graph.nodes.values())
    spots, labels = draw_flat(canvas, flat, marks, seen, ends)
    for places in (seen, spots):
        words += _number_marks(marks, places, unit)
    write_words(canvas, words + labels + _write_title(title, width, height) + _draw_legend(canvas, marks))
    return canvas.image


def _arrange(width, height, points, azimuth, elevation):
    """The view, its upper left corner and the panel on its right; the view as wide as the model asks for."""
    tall = 0.80 * height
    seen = np.ptp(view_axes(azimuth, elevation)[:2] @ points.T, axis=1) if len(points) else np.ones(2)
    part = np.clip(np.clip(seen[0] / max(seen[1], 1e-300), 0.1, 10) * tall / width, 0.34, 0.56)
    view = fit_view(points, azimuth, elevation, round(part * width), round(tall))
    flat = Panel((part + 0.075) * width, 0.13 * height, (0.90 - part) * width, 0.765 * height)
    return view, np.array([round(0.01 * width), round(0.115 * height)]), flat


# --------------------------------------------------------------------------
# Left: the body


def draw_in_body(canvas, corner, view, body, graph, paths):
    """Draw a surface and its graph inside, as on the left of :func:`draw_model`.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    corner : (2,) int
        Column and row of the view's upper left corner in the picture.
    view : View
    body, graph, paths
        As for :func:`draw_model`.

    Returns
    -------
    places : (k, 2) float64
        Column and row of the nodes.
    ends : (m, 2) int
        Numbers of the lower and the upper node of every edge.
    """
    rotation = body.rotation
    marks = list(graph.nodes.values())
    places = np.array([[mark["x"], mark["y"], mark["z"]] for mark in marks], float).reshape(-1, 3)
    ends = _list_ends(graph)
    seen = project_points(places @ rotation.T, view)[:, :2] + corner
    _draw_body(canvas, corner, body, view)
    lines = [
        np.vstack([places[i], np.reshape(paths.get(facts.get("arc"), ()), (-1, 3)), places[j]])
        for (i, j), (_, _, facts) in zip(ends, graph.edges, strict=True)
    ]
    _draw_arcs(canvas, corner, [project_points(line @ rotation.T, view) for line in lines])
    draw_nodes(canvas, marks, seen)
    return seen, ends


def _list_ends(graph):
    """Lower and upper node (m, 2) of every edge, as numbers."""
    place = {key: (facts["height"], i) for i, (key, facts) in enumerate(graph.nodes.items())}
    ends = [[i for _, i in sorted((place[a], place[b]))] for a, b, _ in graph.edges]
    return np.array(ends, int).reshape(-1, 2)


def _draw_body(canvas, corner, body, view):
    """Draw the surface, twice as fine as the picture and averaged, with some contours on it."""
    points = body.points
    fine = view._replace(width=2 * view.width, height=2 * view.height, scale=2 * view.scale)
    layers = rasterize_mesh(points, body.faces, fine)
    extent = max(float(np.ptp(column)) for column in points.T) if len(points) else 1.0
    left, top = corner
    canvas.image[top : top + view.height, left : left + view.width] = shade_layers(layers, 0.012 * extent, 2)
    segments, hidden = _split_curves(body.curves, layers.depth, fine, 0.006 * extent)
    segments = segments / 2 + np.tile(corner, 2)
    draw_segments(canvas, [segments[hidden]], rgb("#23527C"), 0.5, opacity=0.10)
    draw_segments(canvas, [segments[~hidden]], rgb("#23527C"), 0.5, opacity=0.38)


def _split_curves(curves, depth, view, slack):
    """Segments (k, 4) of the contours in pixels, and which lie behind the front-most surface."""
    points = project_points(np.concatenate([np.empty((0, 3)), *curves]), view)
    inside = np.ones(max(len(points) - 1, 0), bool)
    inside[np.cumsum([len(curve) for curve in curves], dtype=int)[:-1] - 1] = False
    start, stop = points[:-1][inside], points[1:][inside]
    column, row, deep = ((start + stop) / 2).T
    column = np.clip(column.astype(int), 0, view.width - 1)
    row = np.clip(row.astype(int), 0, view.height - 1)
    return np.hstack([start[:, :2], stop[:, :2]]), deep < depth[row, column] - slack


def _draw_arcs(canvas, corner, traces):
    """The arcs (k, 3) over the body, the nearer ones over and darker than the farther ones."""
    depths = np.array([trace[:, 2].mean() for trace in traces])
    order = np.argsort(depths, kind="stable")
    nearness = (depths[order, None] - depths.min(initial=np.inf)) / max(np.ptp(depths) if len(depths) else 0, 1e-300)
    inks = rgb(FAR) + nearness * (rgb(INK) - rgb(FAR))
    lines = [traces[k][:, :2] + corner for k in order]
    thick = 1.7 if len(traces) <= 60 else 1.1 if len(traces) <= CASED else 0.6
    if len(traces) <= CASED:
        lines = [line for line in lines for _ in range(2)]
        inks = np.stack([np.full_like(inks, 255), inks], axis=1).reshape(-1, 3)
        thick = np.tile([thick + 1.8, thick], len(traces))
    draw_lines(canvas, lines, inks, thick)


def _draw_frame(canvas, corner, view, rotation):
    """The axes of the model frame, small, in the lower left corner; returns their letters."""
    size = 0.055 * view.height
    origin = corner + np.array([1.5 * size, view.height - 1.4 * size])
    ways = size * (view.axes @ rotation).T[:, :2] * [1, -1]
    draw_lines(canvas, [np.array([origin, origin + way]) for way in ways], rgb(SOFT), 1.0)
    return [Words(name, tuple(origin + 1.35 * way), 7.5, SOFT, "mm") for name, way in zip("xyz", ways)]


# --------------------------------------------------------------------------
# Words


def _number_marks(marks, spots, unit):
    """The numbers of the handles, if they are few."""
    return [
        Words(str(mark.get("handle", "")), (x + 4.2 * unit, y - 4.0 * unit), 6.5, SOFT, "ls", halo=0.8)
        for mark, (x, y) in zip(marks if len(marks) <= LABELS else (), spots)
    ]


def _write_title(title, width, height):
    """The words at the top."""
    ink = VERDICT_INKS.get(title.verdict, SOFT)
    return [
        Words(title.name, (0.018 * width, 0.045 * height), 15, INK, bold=True),
        Words("   ".join(title.facts), (0.018 * width, 0.087 * height), 9.5, SOFT),
        Words(title.verdict.replace("_", " "), (0.982 * width, 0.045 * height), 12, ink, "rm", bold=True),
    ]


def _draw_legend(canvas, marks):
    """One mark per operation and side that occurs, at the bottom in one row or two; returns its words."""
    entries = [
        (f"{operation or 'compound'} {side} ({len(own):,})", mark_style(operation, side, 7))
        for (operation, side), own in group_marks(marks)
    ]
    several = sum(mark.get("n_handles", 1) > 1 for mark in marks)
    if several:
        entries.append((f"several handles ({several:,})", ring_style(6)))
    rows = 1 if len(entries) <= 6 else 2  # beyond what fits in one
    words, left = [], 0.018 * canvas.image.shape[1]
    for k in range(0, len(entries), rows):
        for row, (text, style) in enumerate(entries[k : k + rows]):
            y = canvas.image.shape[0] - (14.5 + 13 * (rows - 1 - row)) * canvas.unit
            draw_marks(canvas, [(left + 6 * canvas.unit, y)], **style)
            words.append(Words(text, (left + 14 * canvas.unit, y), 8.5, INK))
        left += 28 * canvas.unit + max(measure_text(canvas, text, 8.5) for text, _ in entries[k : k + rows])
    return words
