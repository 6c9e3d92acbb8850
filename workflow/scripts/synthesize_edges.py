"""Connect the levels: `edges`, `arcs` and the Reeb graphs as GraphML."""

import networkx as nx

from batches import run_batch
from reebslice.schemas import GRAPHS
from reebslice.synthesis import synthesize
from storage import read_table, write_table
from surfaces import read_feature_size, read_rotation

OUTPUTS = (
    "edges.parquet",
    "arcs.parquet",
    "solid.graphml",
    "surface.graphml",
    "augmented.graphml",
    "solid_simplified.graphml",
    "surface_simplified.graphml",
)


def main(source, target, options):
    """Connect the levels of the model in folder `source`, write the graphs to folder `target`.

    options : those of `edges`, and `levels`, those of `levels`.
    """
    contours, pieces, handles, nodes = (
        read_table(source / f"{name}.parquet", name) for name in ("contours", "pieces", "handles", "nodes")
    )
    size = read_feature_size(source, options["levels"])
    result = synthesize(contours, pieces, handles, nodes, read_rotation(source), size, options["method"])
    write_table(target / "edges.parquet", "edges", result.edges)
    write_table(target / "arcs.parquet", "arcs", result.arcs)
    for name in GRAPHS:
        nx.write_graphml(getattr(result, name), target / f"{name}.graphml", edge_id_from_attribute="id")


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)  # noqa: F821
