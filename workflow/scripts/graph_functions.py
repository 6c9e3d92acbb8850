"""Build the Reeb graphs of functions on the surface besides the height, and certify each.

Writes the values of the functions, nodes and arcs of their graphs as tables, the graphs as one GraphML file, and in
functions.json the certificates, and of heights along other directions these in place of their values.
"""

import numpy as np

from corpus.stages import Rejected
from corpus.storage import read_json, write_json, write_table, write_text
from corpus.surfaces import read_faces, read_points
from reebslice.certification.functions import certify_function
from reebslice.errors import ReebsliceError
from reebslice.formats.graphml import graphml_text
from reebslice.formats.vertex_values import read_vertex_values
from reebslice.functions.barycentre import barycentric_distance
from reebslice.functions.geodesic import geodesic_distance
from reebslice.functions.heights import directional_height, spread_axes
from reebslice.graphs.function_graphs import graph_function, merge_graphs, stack_tables

OUTPUTS = (
    "function_values.parquet",
    "function_nodes.parquet",
    "function_arcs.parquet",
    "functions.graphml",
    "functions.json",
)
MADE = {"geodesic": geodesic_distance, "barycentre": barycentric_distance}
WORSE = ("exact", "uncertified", "rejected")  # of verdicts the later


def main(source, target, options):
    """Build the graphs of the model in folder `source`, write them to folder `target`.

    options : `functions`, their names; `path`, the mesh file, where one of them is to be read.
    """
    points, faces = read_points(source), read_faces(source)
    tolerance = read_json(source / "inspection.json")["tolerance"]
    parts, verdicts = {"function_values": [], "function_nodes": [], "function_arcs": []}, {}
    for name, direction in _list_functions(options["functions"]):
        about = {} if direction is None else {"direction": direction.tolist()}
        try:
            values = _take_values(name, direction, points, faces, options, tolerance)
            graph = graph_function(name, values, points, faces)
        except (ReebsliceError, OSError) as fault:  # the other functions have their graphs all the same
            verdicts[name] = about | {"verdict": "rejected", "reason": f"no graph of the function {name}: {fault}"}
            continue
        vertices = {"function": [name] * len(values), "vertex": np.arange(len(values)), "value": values}
        for table, part in zip(parts, (vertices, *graph), strict=True):
            if part is not vertices or direction is None:  # a height is told by its direction
                parts[table].append(part)
        verdicts[name] = about | certify_function(points, faces, values, *graph)
    if not parts["function_nodes"] and verdicts:
        raise Rejected(" ".join(one["reason"] for one in verdicts.values()))
    tables = {name: stack_tables(name, part) for name, part in parts.items()}
    for name, table in tables.items():
        write_table(target / f"{name}.parquet", name, table)
    merged = merge_graphs(tables["function_nodes"], tables["function_arcs"])
    write_text(target / "functions.graphml", graphml_text(merged, "functions", {"model": source.name}))
    told = {name: certificate["verdict"] for name, certificate in verdicts.items() if "direction" not in certificate}
    heights = [certificate["verdict"] for certificate in verdicts.values() if "direction" in certificate]
    if heights:
        told["directions"] = max(heights, key=WORSE.index)
    write_json(target / "functions.json", {"function_verdicts": told, "functions": verdicts})


def _list_functions(asked):
    """The names of all functions, each with its direction, or None where it has none."""
    for name in asked:
        if name.startswith("directions:"):
            axes = spread_axes(int(name.removeprefix("directions:")))
            yield from ((f"height:{number}", axis) for number, axis in enumerate(axes))
        else:
            yield name, None


def _take_values(name, direction, points, faces, options, tolerance):
    """The values (n,) of a function."""
    if direction is not None:
        return directional_height(points, direction)
    if name in MADE:
        return MADE[name](points, faces)
    return read_vertex_values(options["path"], name.removeprefix("file:"), points, tolerance)
