"""Classify the Morse events between the levels: `handles`; and what the surface has whatever the levels."""

from corpus.storage import read_table, write_json, write_table
from corpus.surfaces import read_faces, read_points, read_rotation
from reebslice.handles.classification import classify_handles, critical_tables
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph
from reebslice.slicing.sampling import sampling_figures

OUTPUTS = ("handles.parquet", "critical_points.parquet", "critical_arcs.parquet", "sampling.json")


def main(source, target, options):
    """Classify the events of the model in folder `source`, write them to folder `target`."""
    pieces = read_table(source / "pieces.parquet", "pieces")
    contours = read_table(source / "contours.parquet", "contours", without=("geometry",))
    points = read_points(source)
    mesh = height_mesh(points, read_faces(source), read_rotation(source))
    graph = surface_reeb_graph(mesh)
    handles = classify_handles(mesh, graph, points, pieces, contours)
    write_table(target / "handles.parquet", "handles", handles)
    critical_points, critical_arcs = critical_tables(mesh, graph, handles)
    write_table(target / "critical_points.parquet", "critical_points", critical_points)
    write_table(target / "critical_arcs.parquet", "critical_arcs", critical_arcs)
    write_json(target / "sampling.json", sampling_figures(critical_arcs))
