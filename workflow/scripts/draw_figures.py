"""Draw every model as in the paper, each figure as SVG and PDF.

`figure_levels`: critical level sets with their handles (figure 3 of Pareja-Corcho et
al.); `figure_links`: the links between levels (4); `figure_graph`: the Reeb graph in the body (6).
"""

from corpus.storage import read_table
from draw import read_geometry, read_model
from reebslice.drawing.figures import choose_events, paint_levels, paint_links
from reebslice.drawing.model import stack_columns
from reebslice.drawing.picture import open_canvas, paint_model
from reebslice.drawing.vectors import encode_vectors

OUTPUTS = (
    "figure_levels.svg",
    "figure_levels.pdf",
    "figure_links.svg",
    "figure_links.pdf",
    "figure_graph.svg",
    "figure_graph.pdf",
)


def main(source, target, options):
    """Write the figures of the model in folder `source` to folder `target`.

    options : width, azimuth, elevation and graph of `draw`.
    """
    title, body, graph, paths = read_model(source, options["graph"])
    tables = {name: read_table(source / f"{name}.parquet", name) for name in ("handles", "nodes", "edges")}
    contours = read_table(source / "contours.parquet", "contours", without=("geometry",))
    events = choose_events(tables["handles"], graph, contours, read_geometry(source))
    nodes, edges = tables["nodes"], tables["edges"]
    links = {
        "points": stack_columns(nodes, "xyz"),
        "critical": nodes["critical"].to_numpy(zero_copy_only=False),
        "pairs": stack_columns(edges, ("source", "target")),
        "operations": edges["operation"].to_pylist(),
    }
    paint = {
        "levels": lambda canvas: paint_levels(canvas, title, body._replace(curves=[]), events, options),
        "links": lambda canvas: paint_links(canvas, title, body, links, options),
        "graph": lambda canvas: paint_model(canvas, title, body, graph, paths, options),
    }
    for name, draw in paint.items():
        canvas = draw(open_canvas(options, strokes=[]))
        for form in ("svg", "pdf"):
            (target / f"figure_{name}.{form}").write_bytes(encode_vectors(canvas, form))
