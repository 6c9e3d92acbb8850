"""Draw the simplified solid graph of models at several feature sizes, side by side.

    python benchmarks/draw_feature_sizes.py PICTURE.png MESH[@X,Y,Z]... [--sizes 0.2 0.1 ...] [--results FOLDER][--keep]

One row a model: the body, and the graph without what is smaller than each
size (parts of the height range). X,Y,Z is the direction that points up, by
default the one that the tilt selects. All stages are run for every size, at half
of it from level to level; with --keep, results that are there are taken.
"""

import argparse
import io
import itertools
from pathlib import Path

import networkx as nx
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from corpus.storage import (
    read_json,
    read_table,
)
from model_runs import read_figures, run_model
from reebslice.drawing.canvas import new_canvas
from reebslice.drawing.marks import (
    INK,
    MARKS,
    SOFT,
)
from reebslice.drawing.model import (
    stack_columns,
    trace_solid_arcs,
)
from reebslice.drawing.picture import (
    Body,
    draw_in_body,
)
from reebslice.drawing.rasters import widest_azimuth
from reebslice.drawing.views import fit_view
from reebslice.formats.graphml import Graph

PANEL, GAP, TITLE, FOOT = (300, 250), 50, 40, 40  # pixels
DOTS_PER_INCH, ELEVATION = 100, 15


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("picture", type=Path)
    parser.add_argument("meshes", nargs="+", metavar="MESH[@X,Y,Z]")
    parser.add_argument("--sizes", nargs="+", type=float, default=[0.2, 0.1, 0.05, 0.02])
    parser.add_argument("--results", type=Path, default=Path("results/benchmarks/feature_sizes"))
    parser.add_argument("--keep", action="store_true")
    options = parser.parse_args(arguments)
    rows = []
    for mesh in options.meshes:
        rows.append([])
        for size in options.sizes:
            rows[-1].append(run_size(mesh, size, options))
            print(mesh, size, read_figures(rows[-1][-1]), flush=True)
    figure = draw_table(rows, options.sizes)
    save_small(figure, options.picture)


def run_size(mesh, size, options):
    """The folder of results of one mesh, which may have a direction, at one feature size."""
    path, _, direction = str(mesh).partition("@")
    tilt = {"mode": "direction", "direction": [float(x) for x in direction.split(",")]} if direction else {}
    return run_model(path, options.results, options.keep, tilt, distance=None, feature_size=size)


def draw_table(rows, sizes):
    """The figure: rows of result folders, one for each of the sizes."""
    width = (len(sizes) + 1) * PANEL[0]
    height = TITLE + len(rows) * (PANEL[1] + GAP) + FOOT
    figure = Figure(figsize=(width / DOTS_PER_INCH, height / DOTS_PER_INCH), dpi=DOTS_PER_INCH, facecolor="white")
    FigureCanvasAgg(figure)
    for column, size in enumerate(sizes, 1):
        figure.text((column + 0.5) * PANEL[0] / width, 1 - TITLE / 2 / height, f"feature size {size:.0%} of the height",
                    ha="center", va="center", fontsize=10, fontweight="bold", color=INK)  # fmt: skip
    for number, folders in enumerate(rows):
        top = TITLE + number * (PANEL[1] + GAP)
        boxes = [[k * PANEL[0] / width, 1 - (top + PANEL[1]) / height, PANEL[0] / width, PANEL[1] / height]
                 for k in range(len(sizes) + 1)]  # fmt: skip
        draw_row(figure, folders, boxes)
    handles = [
        Line2D([], [], linestyle="", marker=shape, color=colour, markersize=6, label=operation)
        for operation, (shape, colour) in MARKS.items() if operation
    ]  # fmt: skip
    handles += [Line2D([], [], linestyle="", marker="o", markerfacecolor="white", color=SOFT, markersize=6,
                       label="hollow: side B")]  # fmt: skip
    handles += [Line2D([], [], linestyle="", marker="o", markerfacecolor="none", color=INK, markersize=11,
                       label="several handles between two levels")]  # fmt: skip
    figure.legend(handles=handles, loc="lower center", ncols=6, frameon=False, fontsize=9, labelcolor=INK)
    return figure


def draw_row(figure, folders, boxes):
    """The body of one model, then its graph in the body for each folder of results."""
    rotation = np.array(read_json(folders[0] / "tilt.json")["rotation"])
    points = stack_columns(read_table(folders[0] / "vertices.parquet", "vertices"), "xyz") @ rotation.T
    faces = stack_columns(read_table(folders[0] / "faces.parquet", "faces"), "abc")
    view = fit_view(points, widest_azimuth(points, faces, ELEVATION), ELEVATION, *PANEL, margin=0.03)
    for folder, box in zip([None, *folders], boxes):
        graph, paths = (nx.MultiGraph(), {}) if folder is None else read_simplified(folder)
        graph = Graph(dict(graph.nodes(data=True)), list(graph.edges(data=True)))
        canvas = new_canvas(view.width, view.height, DOTS_PER_INCH / 72)
        draw_in_body(canvas, np.zeros(2, int), view, Body(points, faces, rotation, []), graph, paths)
        figure.figimage(canvas.image, box[0] * figure.bbox.width, box[1] * figure.bbox.height)
        lines = describe(read_figures(folder or folders[0]), folders[0].parent.name if folder is None else None)
        for step, (text, weight) in enumerate(lines):
            size, ink = (9, INK) if weight == "bold" else (8, SOFT)
            place = box[0] + box[2] / 2, box[1] - (13 + 16 * step) / figure.bbox.height
            figure.text(*place, text, ha="center", va="center", fontsize=size, fontweight=weight, color=ink)


def describe(figures, name=None):
    """Two lines of text with their weights: of the model if it has a name, else of one graph."""
    if name:
        facts = f"{figures['faces']:,} faces, {figures['critical']:,} critical points, genus {figures['genus']:,}"
        return [(name, "bold"), (facts, "normal")]
    first = f"{figures['nodes']:,} nodes, {count(figures['loops_solid'], 'loop')} of the solid"
    second = f"{figures['genus']:,} = {figures['loops']:,} shown + {figures['suppressed']:,} suppressed"
    second += f" + {figures['hidden']:,} hidden"
    return [(first, "bold"), (second, "normal")]


def count(number, word):
    return f"{number:,} {word}" + ("" if number == 1 else "s")


def read_simplified(folder):
    """The simplified solid graph, and for each of its arcs a line (k, 3) through material points.

        Each arc is led along the shortest way in the whole graph between its ends
        that other arcs between them have not taken, and past the events on it that are
    not shown.
    """
    graph = nx.MultiGraph(nx.read_graphml(folder / "solid_simplified.graphml", force_multigraph=True))
    whole = nx.MultiGraph(nx.read_graphml(folder / "solid.graphml", force_multigraph=True))
    inside = trace_solid_arcs(
        read_table(folder / "arcs.parquet", "arcs"), read_table(folder / "nodes.parquet", "nodes")
    )
    taken, paths = set(), {}
    for low, high, facts in sorted(graph.edges(data=True), key=lambda edge: edge[2]["upper"] - edge[2]["lower"]):
        if graph.nodes[low]["height"] > graph.nodes[high]["height"]:
            low, high = high, low
        paths[facts["arc"]] = find_way(whole, low, high, inside, taken)
    return graph, paths


def find_way(whole, low, high, inside, taken):
    """Points (k, 3) on the shortest way from `low` to `high`; arcs in `taken` cost ten times as much and more."""

    def cost(a, b, arcs):
        return min(facts["length"] * (10 if key in taken else 1) for key, facts in arcs.items())

    nodes = nx.shortest_path(whole, low, high, weight=cost)
    points = []
    for a, b in itertools.pairwise(nodes):
        arcs = whole[a][b]
        key = min(arcs, key=lambda key: arcs[key]["length"] * (10 if key in taken else 1))
        taken.add(key)
        line = inside.get(arcs[key]["arc"], np.empty((0, 3)))
        points += list(line if whole.nodes[a]["height"] <= whole.nodes[b]["height"] else line[::-1])
    return np.array(points).reshape(-1, 3)


def save_small(figure, path):
    """Write a PNG of 256 colours, those of the marks among them, without the date or the version of any program."""
    image = io.BytesIO()
    figure.savefig(image, format="png")
    image = Image.open(image).convert("RGB")
    sample = Image.new("RGB", (image.width, image.height + 40 * len(MARKS)))
    sample.paste(image)
    for number, (_, colour) in enumerate(MARKS.values()):
        sample.paste(colour, (0, image.height + 40 * number, image.width, image.height + 40 * (number + 1)))
    image = image.quantize(256, palette=sample.quantize(256), dither=Image.Dither.NONE)
    palette, corner = image.getpalette(), 3 * image.getpixel((0, 0))
    palette[corner : corner + 3] = 255, 255, 255  # the background, which quantizing tints
    image.putpalette(palette)
    image.save(path, optimize=True)


if __name__ == "__main__":
    main()
