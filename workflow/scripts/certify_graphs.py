"""Certify the exact graphs made without levels, as they are read back from their files: `exact_graphs.json`."""

from pathlib import Path

from corpus.storage import read_json, read_table, write_json
from reebslice.certification.exact_graphs import TABLES, certify_exact_graphs
from reebslice.certification.graphml import parse_graph
from reebslice.schemas import EXACT_GRAPHS

OUTPUTS = ("exact_graphs.json",)


def main(source, target, options):
    """Certify the graphs of the model in folder `source`; write the certificate to folder `target`.

    In the table of models its figures stand where there is no certificate.json; `exact_verdict` always does.
    """
    source = Path(source)
    tables = {name: read_table(source / f"{name}.parquet", name) for name in TABLES}
    graphs = {name: parse_graph((source / f"{name}.graphml").read_bytes()) for name in EXACT_GRAPHS}
    inspection, tilt = read_json(source / "inspection.json"), read_json(source / "tilt.json")
    certificate = certify_exact_graphs(tables, tilt, graphs, inspection, source.name)
    write_json(target / "exact_graphs.json", {"exact_verdict": certificate["verdict"]} | certificate)
