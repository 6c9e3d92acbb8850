"""Compare all models with each other: a matrix of distances with a map of them, and of each model the most alike."""

from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from corpus.gathering import read_tables
from corpus.layout import MODELS_FOLDER
from corpus.storage import read_json, write_table
from reebslice.descriptors.comparison import compare_descriptors, rank_by_neighbourhood
from reebslice.descriptors.graph_distances import compare_diagrams, compare_graphs, share_functions
from reebslice.descriptors.neighbours import distance_table, neighbour_table

# What models are compared by: the stage that makes the tables which this takes, and these.
WAYS = {
    "descriptors": (compare_descriptors, "describe_shape", ("descriptors",)),
    "diagrams": (compare_diagrams, "graph_functions", ("function_nodes",)),
    "graphs": (compare_graphs, "graph_functions", ("function_nodes", "function_arcs")),
}


def gather(job):
    """Write both tables over the status tables of the stage, `job.input.status`; as `job.params.options` say."""
    made = main(job.input.status, **job.params.options)
    for path, table in zip(job.output.tables, made, strict=True):
        write_table(path, Path(path).stem, table)


def main(tables, by, manifold, neighbours):
    """Return the tables `distances` and `neighbours` over the models of the status tables that did not fail.

    Functions count whose graphs are certified.
    """
    compare, stage, names = WAYS[by]
    found = [read_tables(tables, stage, name, all_or_none=False) for name in names]
    models = list(found[0])
    if stage == "graph_functions":
        found = [{model: _keep_certified(model, table) for model, table in each.items()} for each in found]
        models, lacking = share_functions(found[0])
        for model, missing in lacking.items():
            print(f"{model} is left out of the comparison, as it has no certified graph of {', '.join(missing)}")
    distances = compare(*([each[model] for model in models] for each in found))
    if manifold:
        distances = rank_by_neighbourhood(distances)
    return distance_table(models, distances), neighbour_table(models, distances, neighbours)


def _keep_certified(model, table):
    """The rows of the functions of a model whose graphs are certified."""
    certificates = read_json(MODELS_FOLDER / model / "functions.json")["functions"]
    names = [name for name, certificate in certificates.items() if certificate["verdict"] == "exact"]
    return table.filter(pc.is_in(table["function"], value_set=pa.array(names, pa.string())))
