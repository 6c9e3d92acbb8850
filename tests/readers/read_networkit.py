"""Read all graphs with NetworKit, which takes nodes and edges and no attributes."""

import json
import sys
from pathlib import Path

import networkit

for folder in sys.argv[1:]:
    for name, told in json.loads(Path(folder, "expected.json").read_text())["graphs"].items():
        graph = networkit.readGraph(f"{folder}/{name}.graphml", networkit.Format.GraphML)
        assert not graph.isDirected()
        assert sorted(sorted(edge) for edge in graph.iterEdges()) == [edge[:2] for edge in told["edges"]], name
        assert graph.numberOfNodes() == len(told["ids"])
print("networkit", networkit.__version__)
