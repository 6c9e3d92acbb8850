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

from .canvas import Words, draw_lines, draw_segments, measure_text, new_canvas, rgb, write_words
from .embedded_graphs import find_vertices
from .flat import Panel, draw_flat
from .labels import spread_labels
from .legend import draw_legend, draw_scale
from .marks import CASED, FAR, INK, LABELLED, SOFT, draw_nodes, mark_size
from .rasters import choose_angles, rasterize_mesh
from .shading import shade_layers
from .titles import write_title
from .views import fit_view, project_points, view_axes

POINTS = (864, 518.4)  # size of the picture, in the points that words and lines are measured in


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
        Nodes with height, x, y, z (model frame), side, operation, handle
        and, if not 1, n_handles, edges with arc; a node with vertex_x,
        vertex_y, vertex_z has a thin line to there.
    paths : dict
        For an arc the points (k, 3) along it, model frame, upward; an arc
        without an entry is drawn straight.
    options : dict
        width (pixels), azimuth (degrees, or None for the largest silhouette) and
        elevation (degrees, or None for what suits the model).

    Returns
    -------
    (height, width, 3) uint8
        Text and lines scale with the width. An empty surface or graph gives
        empty panels.
    """
    return paint_model(open_canvas(options), title, body, graph, paths, options).image


def open_canvas(options, strokes=None):
    """Make an empty canvas for a picture of a model.

    Parameters
    ----------
    options : dict
        width, in pixels.
    strokes : list, optional
        Where lines, marks and words are kept instead of drawn.

    Returns
    -------
    Canvas
    """
    width = int(options.get("width", 1600))
    return new_canvas(width, int(width * POINTS[1] / POINTS[0]), width / POINTS[0])._replace(strokes=strokes)


def paint_model(canvas, title, body, graph, paths, options):
    """Draw what :func:`draw_model` draws on a canvas.

    Parameters
    ----------
    canvas : Canvas
        Of :func:`open_canvas`, drawn on in place.
    title, body, graph, paths, options
        As for :func:`draw_model`.

    Returns
    -------
    Canvas
        The same.
    """
    (height, width), unit = canvas.image.shape[:2], canvas.unit
    view, corner, flat = arrange(width, height, body, options)
    seen, ends = draw_in_body(canvas, corner, view, body, graph, paths)
    words = _draw_frame(canvas, corner, view, body.rotation)
    marks = list(graph.nodes.values())
    spots, labels = draw_flat(canvas, flat, marks, seen, ends)
    words += draw_scale(canvas, view, corner, title.unit)
    for places in (seen, spots) if len(marks) <= LABELLED else ():
        numbers = [str(mark.get("handle", "")) for mark in marks]
        words += spread_labels(canvas, numbers, places, 6.5, SOFT, mark_size(len(marks)) / 2)
    if title.graph:
        size = 8.5 * min(1.0, flat.width / measure_text(canvas, title.graph, 8.5))
        words.append(Words(title.graph, (flat.left, flat.top - 12 * unit), size, INK))
    write_words(canvas, words + labels + write_title(title, width, height) + draw_legend(canvas, marks))
    return canvas


def arrange(width, height, body, options):
    """Share a picture between the body and what is beside it.

    Parameters
    ----------
    width, height : int
        Of the picture, in pixels.
    body : Body
    options : dict
        azimuth and elevation, as for :func:`draw_model`.

    Returns
    -------
    view : View
        As wide as the model asks for.
    corner : (2,) int
        Column and row of its upper left corner.
    flat : Panel
        The part on its right.
    """
    points, angles = body.points, choose_angles(body.points, body.faces, options)
    tall = 0.78 * height
    seen = np.ptp(view_axes(**angles)[:2] @ points.T, axis=1) if len(points) else np.ones(2)
    part = np.clip(np.clip(seen[0] / max(seen[1], 1e-300), 0.1, 10) * tall / width, 0.34, 0.56)
    view = fit_view(points, **angles, width=round(part * width), height=round(tall))
    flat = Panel((part + 0.075) * width, 0.145 * height, (0.90 - part) * width, 0.735 * height)
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
    draw_body(canvas, corner, view, body)
    lines = [
        np.vstack([places[i], np.reshape(paths.get(facts.get("arc"), ()), (-1, 3)), places[j]])
        for (i, j), (_, _, facts) in zip(ends, graph.edges, strict=True)
    ]
    if len(marks) <= LABELLED:
        _draw_leaders(canvas, corner, view, marks, places, rotation)
    _draw_arcs(canvas, corner, [project_points(line @ rotation.T, view) for line in lines])
    draw_nodes(canvas, marks, seen)
    return seen, ends


def _draw_leaders(canvas, corner, view, marks, places, rotation):
    """Thin lines from the nodes to their critical vertices."""
    vertices = find_vertices(marks)
    leads = np.stack([project_points(ends @ rotation.T, view)[:, :2] + corner for ends in (places, vertices)], axis=1)
    draw_lines(canvas, [lead for lead in leads if (lead[0] != lead[1]).any()], rgb(SOFT), 0.4)


def _list_ends(graph):
    """Lower and upper node (m, 2) of every edge, as numbers."""
    place = {key: (facts["height"], i) for i, (key, facts) in enumerate(graph.nodes.items())}
    ends = [[i for _, i in sorted((place[a], place[b]))] for a, b, _ in graph.edges]
    return np.array(ends, int).reshape(-1, 2)


def draw_body(canvas, corner, view, body):
    """Draw a surface, twice as fine as the picture and averaged, with some contours on it.

    Parameters
    ----------
    canvas : Canvas
        Drawn on in place.
    corner : (2,) int
        Column and row of the view's upper left corner in the picture.
    view : View
    body : Body
    """
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
