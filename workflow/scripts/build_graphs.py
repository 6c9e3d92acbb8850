"""Build the exact Reeb graphs of surface and solid without levels: `exact_nodes`, `exact_arcs`, and both as GraphML.

For meshes of any noise: what it takes does not grow with the levels that would part all events. Lengths, volumes and
material points, which come from contours, these graphs do not have.
"""

from corpus.storage import read_json, write_table, write_text
from corpus.surfaces import read_faces, read_points, read_rotation, read_shells
from reebslice.formats.graphml import graphml_text
from reebslice.graphs.exact_tables import exact_tables, name_graph
from reebslice.graphs.reeb_graphs import describe_graph
from reebslice.morse.height_mesh import height_mesh
from reebslice.schemas import EXACT_GRAPHS

OUTPUTS = ("exact_nodes.parquet", "exact_arcs.parquet", "exact_surface.graphml", "exact_solid.graphml")


def main(source, target, options):
    """Build the graphs of the model in folder `source`, write them to folder `target`."""
    points = read_points(source)
    mesh = height_mesh(points, read_faces(source), read_rotation(source))
    nodes, arcs = exact_tables(mesh, points, read_shells(source, len(points))[1][mesh.vertex])
    write_table(target / "exact_nodes.parquet", "exact_nodes", nodes)
    write_table(target / "exact_arcs.parquet", "exact_arcs", arcs)
    tilt, unit = read_json(source / "tilt.json"), read_json(source / "inspection.json")["unit"]
    for name in EXACT_GRAPHS:
        about = describe_graph(name, source.name, tilt["direction"], unit) | {"certificate": "exact_graphs.json"}
        write_text(target / f"{name}.graphml", graphml_text(name_graph(name, nodes, arcs), name, about))
