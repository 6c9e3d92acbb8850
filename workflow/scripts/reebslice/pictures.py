"""One still picture per model: the solid's Reeb graph in the body, and flat by height.

Left the translucent surface in the tilted frame, height up, with the graph's
arcs through the material points (figure 6 of Pareja-Corcho et al.); right the
same graph drawn flat, every node at its height. An operation has one colour
and one shape in both (colours of Okabe and Ito, told apart by the
colour-blind); side B is hollow. A ring marks a node that stands for several
handles, which the levels do not separate.
"""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from .layouts import place_graph, trace_arc
from .shading import (
    fit_view,
    project_points,
    rasterize_mesh,
    shade_layers,
    shrink_image,
    widest_azimuth,
)

MARKS = {
    "creation": ("^", "#009E73"),
    "union": ("o", "#0072B2"),
    "separation": ("D", "#D55E00"),
    "annihilation": ("v", "#A3246E"),
    "": ("s", "#6B7280"),
}
VERDICT_INKS = {"exact": "#00724F", "exact_at_feature_size": "#005A8C", "uncertified": "#B3470A"}
INK, SOFT, FAR = "#1B1F24", "#5B6470", np.array([0.44, 0.47, 0.52])
INCHES = (12.0, 7.2)
HALO = [withStroke(linewidth=1.6, foreground="white")]
LABELS = 40  # nodes, beyond which handles are not numbered
CASED = 400  # arcs, beyond which lines cross without a white casing


def draw_model(name, facts, verdict, points, faces, rotation, graph, paths, curves, options):
    """Draw the model and its solid Reeb graph.

    Parameters
    ----------
    name, facts, verdict : str, list of str, str
        Title; short statements in a line below it; the certificate's verdict.
    points, faces : (n, 3) floats, (m, 3) ints
        The surface in the tilted frame, faces counter-clockwise from outside.
    rotation : (3, 3) floats
        From the model frame to the tilted frame.
    graph : networkx.MultiGraph
        The solid's graph; nodes with height, x, y, z (model frame), side,
        operation, handle and, if not 1, n_handles, edges with arc.
    paths : dict
        For an arc the material points (k, 3), model frame, upward; an arc
        without an entry is drawn straight.
    curves : list of (k, 3) floats
        Closed contours in the tilted frame, drawn faintly.
    options : dict
        width (pixels), azimuth (degrees, or None for the largest silhouette) and
        elevation (degrees).

    Returns
    -------
    matplotlib.figure.Figure
        `width` pixels wide when saved at its own dpi. Text and lines scale
        with the width. An empty surface or graph gives empty panels.
    """
    width = int(options.get("width", 1600))
    figure = Figure(figsize=INCHES, dpi=width / INCHES[0], facecolor="white")
    FigureCanvasAgg(figure)
    azimuth, elevation = options.get("azimuth"), float(options.get("elevation", 15))
    azimuth = widest_azimuth(points, faces, elevation) if azimuth is None else float(azimuth)
    view, body, flat = _arrange(figure, points, azimuth, elevation)
    marks, seen, traces = draw_in_body(body, view, points, faces, rotation, graph, paths, curves)
    _draw_frame(body, view, rotation)
    _draw_flat(flat, graph, marks, seen, traces)
    _write_title(figure, name, facts, verdict)
    _write_legend(figure, marks)
    return figure


def _arrange(figure, points, azimuth, elevation):
    """The view and the two panels; the left one as wide as the model asks for."""
    width, height = figure.get_size_inches() * figure.dpi
    tall = 0.80
    seen = np.ptp(fit_view(points, azimuth, elevation, 1, 1).axes[:2] @ points.T, axis=1) if len(points) else np.ones(2)
    aspect = np.clip(seen[0] / max(seen[1], 1e-300), 0.1, 10)
    part = float(np.clip(aspect * tall * height / width, 0.34, 0.56))
    view = fit_view(points, azimuth, elevation, round(part * width), round(tall * height))
    left = figure.add_axes([0.01, 0.085, part, tall], label="body")
    left.set(xlim=(0, view.width), ylim=(view.height, 0))
    left.axis("off")
    right = figure.add_axes([part + 0.075, 0.105, 0.90 - part, tall - 0.035], label="flat")
    return view, left, right


# --------------------------------------------------------------------------
# Left: the body


def draw_in_body(axes, view, points, faces, rotation, graph, paths, curves=(), labels=True):
    """Draw the surface and its graph inside, seen in `view`, as on the left of :func:`draw_model`.

    Arguments as there; labels : whether the handles of few nodes are numbered.
    Returns the nodes with their attributes, their places (k, 3) in the view and the
    lines of the arcs.
    """
    marks = [(key, graph.nodes[key]) for key in graph.nodes]
    places = np.array([[mark["x"], mark["y"], mark["z"]] for _, mark in marks], float).reshape(-1, 3)
    seen = project_points(places @ rotation.T, view)
    traces = _trace_paths(graph, marks, places, rotation, paths, view)
    _draw_body(axes, points, faces, view, curves)
    _draw_traces(axes, traces)
    _draw_marks(axes, marks, seen[:, :2], labels)
    return marks, seen, traces


def _draw_body(axes, points, faces, view, curves):
    """The surface, twice as fine as the picture and averaged, with some contours on it."""
    fine = view._replace(width=2 * view.width, height=2 * view.height, scale=2 * view.scale)
    layers = rasterize_mesh(points, faces, fine)
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 1.0
    image = shrink_image(shade_layers(layers, 0.012 * extent), 2)
    axes.imshow(image.clip(0, 1), extent=(0, view.width, view.height, 0), interpolation="nearest", aspect="auto")
    segments, hidden = _split_curves(curves, layers.depth, fine, 0.006 * extent)
    for part, opacity in ((segments[hidden], 0.10), (segments[~hidden], 0.38)):
        if len(part):
            axes.add_collection(LineCollection(part / 2, colors="#23527C", linewidths=0.5, alpha=opacity))


def _split_curves(curves, depth, view, slack):
    """Segments (k, 2, 2) of the contours in pixels, and which lie behind the front-most surface."""
    seen = [project_points(curve, view) for curve in curves if len(curve) > 1]
    if not seen:
        return np.empty((0, 2, 2)), np.empty(0, bool)
    pairs = np.concatenate([np.stack([curve[:-1], curve[1:]], axis=1) for curve in seen])
    middle = pairs.mean(axis=1)
    column = np.clip(middle[:, 0].astype(int), 0, view.width - 1)
    row = np.clip(middle[:, 1].astype(int), 0, view.height - 1)
    return pairs[:, :, :2], middle[:, 2] < depth[row, column] - slack


def _trace_paths(graph, marks, places, rotation, paths, view):
    """Per edge: its arc, its two nodes' numbers and its polyline (column, row, depth), upward."""
    number = {key: i for i, (key, _) in enumerate(marks)}
    traces = []
    for a, b, facts in graph.edges(data=True):
        i, j = sorted((number[a], number[b]), key=lambda k: (marks[k][1]["height"], k))
        inner = np.asarray(paths.get(facts.get("arc"), ()), float).reshape(-1, 3)
        line = np.vstack([places[i], inner, places[j]])
        traces.append((facts.get("arc"), i, j, project_points(line @ rotation.T, view)))
    return traces


def _draw_traces(axes, traces):
    """The arcs over the body, the nearer ones over and darker than the farther ones."""
    if not traces:
        return
    depths = np.array([trace[3][:, 2].mean() for trace in traces])
    nearness = (depths - depths.min()) / max(np.ptp(depths), 1e-300)
    near = np.array([0.106, 0.122, 0.141])
    inks = FAR + nearness[:, None] * (near - FAR)
    order = np.argsort(depths, kind="stable")
    lines = [traces[k][3][:, :2] for k in order]
    thick = 1.7 if len(traces) <= 60 else 1.1 if len(traces) <= CASED else 0.6
    if len(traces) > CASED:
        axes.add_collection(LineCollection(lines, colors=inks[order], linewidths=thick, zorder=3))
        return
    for step, (line, k) in enumerate(zip(lines, order, strict=True)):
        for colour, extra, lift in (("white", 1.8, 0), (inks[k], 0, 0.5)):
            axes.add_line(
                Line2D(line[:, 0], line[:, 1], color=colour, linewidth=thick + extra, solid_joinstyle="round",
                       solid_capstyle="round", zorder=3 + (step + lift) / (len(lines) + 1),
                       gid="arc" if lift else "casing")
            )  # fmt: skip


def _draw_frame(axes, view, rotation):
    """The axes of the model frame, small, in the lower left corner."""
    size = 0.055 * view.height
    origin = np.array([1.5 * size, view.height - 1.4 * size])
    for name, direction in zip("xyz", (view.axes @ rotation).T, strict=True):
        tip = origin + size * direction[:2] * [1, -1]
        axes.plot(*np.column_stack([origin, tip]), color=SOFT, linewidth=1.0, zorder=5)
        axes.text(*(origin + 1.35 * size * direction[:2] * [1, -1]), name, color=SOFT, fontsize=7.5,
                  ha="center", va="center", zorder=5)  # fmt: skip


# --------------------------------------------------------------------------
# Right: the flat drawing


def _draw_flat(axes, graph, marks, seen, traces):
    """The graph by height, lanes ordered as in the picture on the left where nothing else decides."""
    heights = np.array([mark["height"] for _, mark in marks], float)
    extent = float(np.ptp(heights)) if len(heights) else 0.0
    extent = extent if extent > 0 else 1.0
    ends = np.array([[i, j] for _, i, j, _ in traces], int).reshape(-1, 2)
    layout = place_graph(heights, ends[:, 0], ends[:, 1], seen[:, 0], _mark_size(len(marks)) / 660 * extent)
    spots = np.column_stack([layout.nodes, heights])
    lines = [
        trace_arc(spots[i], spots[j], lane, 0.03 * extent)
        for (i, j), lane in zip(ends, layout.lanes, strict=True)
    ]
    thick = 1.5 if len(lines) <= 60 else 1.0 if len(lines) <= CASED else 0.5
    opacity = 1.0 if len(lines) <= 2000 else 0.35
    axes.add_collection(
        LineCollection(lines, colors=INK, linewidths=thick, alpha=opacity, zorder=2, capstyle="round")
    )
    across = np.concatenate([layout.nodes, layout.lanes, [0.0]][: 2 if len(marks) else 3])
    middle, half = (across.min() + across.max()) / 2, max(np.ptp(across) * 0.54, 1.6)
    axes.set_xlim(middle - half, middle + half)
    low = heights.min() if len(heights) else 0.0
    axes.set_ylim(low - 0.04 * extent, low + 1.04 * extent)
    _draw_marks(axes, marks, spots)
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    axes.spines["left"].set_color(SOFT)
    axes.tick_params(axis="y", colors=SOFT, labelsize=8, length=3)
    axes.grid(axis="y", color="#E8EBEE", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)
    axes.set_xticks([])
    axes.set_ylabel("height", color=SOFT, fontsize=9)


# --------------------------------------------------------------------------
# Both


def _mark_size(count):
    """Points across a marker, falling with the number of nodes."""
    return float(np.clip(26 / max(count, 1) ** 0.36, 1.6, 8.0))


def _draw_marks(axes, marks, spots, labels=True):
    """The nodes, one artist per operation and side; their handles' numbers if they are few."""
    size = _mark_size(len(marks))
    for operation, (shape, colour) in MARKS.items():
        for side in ("A", "B"):
            own = [i for i, (_, mark) in enumerate(marks) if _style(mark) == (operation, side)]
            if own:
                axes.plot(*spots[own].T, linestyle="", clip_on=False, zorder=6, gid=f"{operation} {side}",
                          **_mark_style(shape, colour, side, size))  # fmt: skip
    several = [i for i, (_, mark) in enumerate(marks) if mark.get("n_handles", 1) > 1]
    if several:
        axes.plot(*spots[several].T, linestyle="", clip_on=False, zorder=5.9, gid="several", **_ring_style(size))
    if labels and len(marks) <= LABELS:
        for (_, mark), (x, y) in zip(marks, spots, strict=True):
            axes.annotate(str(mark.get("handle", "")), (x, y), (4.2, 2.6), textcoords="offset points", color=SOFT,
                          fontsize=6.5, va="bottom", ha="left", zorder=7, path_effects=HALO)  # fmt: skip


def _style(mark):
    operation = mark.get("operation") or ""
    return (operation if operation in MARKS else "", "B" if mark.get("side") == "B" else "A")


def _mark_style(shape, colour, side, size):
    size = size * {"D": 0.82, "s": 0.9}.get(shape, 1.0)
    hollow = {"markerfacecolor": "white", "markeredgecolor": colour, "markeredgewidth": max(0.19 * size, 0.5)}
    filled = {"markerfacecolor": colour, "markeredgecolor": "white", "markeredgewidth": 0.09 * size}
    return {"marker": shape, "markersize": size, **(filled if side == "A" else hollow)}


def _ring_style(size):
    return {"marker": "o", "markersize": 1.9 * size, "markerfacecolor": "none", "markeredgecolor": INK,
            "markeredgewidth": max(0.1 * size, 0.4)}  # fmt: skip


def _write_title(figure, name, facts, verdict):
    figure.text(0.018, 0.955, name, fontsize=15, fontweight="bold", color=INK, va="center")
    figure.text(0.018, 0.913, "   ".join(facts), fontsize=9.5, color=SOFT, va="center")
    words = verdict.replace("_", " ")
    figure.text(0.982, 0.955, words, fontsize=12, fontweight="bold", ha="right", va="center",
                color=VERDICT_INKS.get(verdict, SOFT))  # fmt: skip


def _write_legend(figure, marks):
    """One entry per operation and side that occurs, with its count."""
    styles = [_style(mark) for _, mark in marks]
    entries = []
    for operation, (shape, colour) in MARKS.items():
        for side in ("A", "B"):
            count = styles.count((operation, side))
            if count:
                label = f"{operation or 'compound'} {side} ({count:,})"
                entries.append(Line2D([], [], linestyle="", label=label, **_mark_style(shape, colour, side, 7)))
    several = sum(mark.get("n_handles", 1) > 1 for _, mark in marks)
    if several:
        entries.append(Line2D([], [], linestyle="", label=f"several handles ({several:,})", **_ring_style(6)))
    if entries:
        columns = len(entries) if len(entries) <= 6 else (len(entries) + 1) // 2  # two rows, beyond what fits in one
        figure.legend(handles=entries, loc="lower left", bbox_to_anchor=(0.012, 0.004), ncols=columns,
                      frameon=False, fontsize=8.5, labelcolor=INK, handletextpad=0.2, columnspacing=1.4)  # fmt: skip
