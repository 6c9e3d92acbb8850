"""Describe a model by numbers of its surface and of the graphs of its functions, by which shapes can be told apart."""

import numpy as np

from corpus.storage import read_json, read_table, write_table
from corpus.surfaces import read_faces, read_points
from reebslice.descriptors.surface import describe_surface
from reebslice.functions.heights import directional_height
from reebslice.table_checks import build_table

OUTPUTS = ("descriptors.parquet",)


def main(source, target, options):
    """Describe the model in folder `source`, write to folder `target`; of its functions those that are certified."""
    points, faces = read_points(source), read_faces(source)
    certificates = read_json(source / "functions.json")["functions"]
    tables = [_split(read_table(source / f"{name}.parquet", name)) for name in ("function_nodes", "function_arcs")]
    values = _split(read_table(source / "function_values.parquet", "function_values"))
    graphs = {}
    for name, certificate in certificates.items():
        if certificate["verdict"] == "exact":
            up = certificate.get("direction")
            of_vertices = values[name]["value"] if up is None else directional_height(points, up)
            graphs[name] = (of_vertices, *(table[name] for table in tables))
    described = describe_surface(points, faces, graphs)
    write_table(target / "descriptors.parquet", "descriptors", build_table("descriptors", described))


def _split(table):
    """Columns of the rows of each function, by its name."""
    names = table["function"].to_numpy(zero_copy_only=False)
    columns = {name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names}
    return {name: {key: column[names == name] for key, column in columns.items()} for name in np.unique(names)}
