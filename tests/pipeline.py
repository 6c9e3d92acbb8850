"""Run the stages on one solid in a folder, and hand back everything they wrote."""

import importlib
import json
from dataclasses import dataclass
from pathlib import Path

import networkx as nx
import numpy as np

from corpus.storage import read_table
from reebslice.certification.graphml import ReadGraph
from reebslice.schemas import EVENTS, GRAPHS, MODEL_TABLES

STAGES = {
    "inspect_mesh": "inspect",
    "select_tilt": "tilt",
    "slice_mesh": "levels",
    "classify_handles": None,
    "sample_nodes": "nodes",
    "synthesize_edges": "edges",
}
OPTIONS = {
    "inspect": {"repair": ["merge", "duplicates", "split", "orient"], "merge_tolerance": 1e-6},
    "tilt": {"mode": "none", "direction": None},
    "levels": {"distance": 0.1, "units": "relative", "refine": "exact", "feature_size": 0.2},
    "nodes": {"sampler": "representative"},
    "edges": {"method": "exact"},
}
TABLES = MODEL_TABLES


@dataclass
class Result:
    """Tables as {name: list of rows}, graphs as MultiGraphs, and the surface in the tilted frame."""

    tables: dict
    graphs: dict
    tilt: dict
    points: list
    faces: list

    def __getattr__(self, name):
        return self.tables[name]

    def labelled(self, name):
        """The graph `name` with what `reference.compare_graphs` looks at on its nodes."""
        graph = self.graphs[name].copy()
        for _, data in graph.nodes(data=True):
            handle = self.handles[int(data["handle"])]
            _, _, outer, inner, _, _ = EVENTS.get(handle["change"], (None,) * 6)
            data.update(vertex=handle["vertex"], outer=outer, inner=inner)
            if data.get("change") == "":
                data["change"] = None
        return graph


def missing_stages():
    """The stages that cannot be imported."""
    return [stage for stage in STAGES if importlib.util.find_spec(stage) is None]


def write_off(path, solid):
    """A mesh file that keeps every digit."""
    lines = ["OFF", f"{len(solid.points)} {len(solid.faces)} 0"]
    lines += [" ".join(map(repr, point)) for point in solid.points.tolist()]
    lines += ["3 " + " ".join(map(str, face)) for face in solid.faces.tolist()]
    Path(path).write_text("\n".join(lines) + "\n")


def run_mesh(path, folder, **sections):
    """Run all stages on the mesh file `path`, outputs into `folder`; `sections` alter the options.

    For instance ``tilt={"mode": "auto"}, levels={"distance": 0.05}``.
    """
    for stage, section in STAGES.items():
        options = OPTIONS.get(section, {}) | sections.get(section, {})
        if stage == "synthesize_edges":
            options = options | {"levels": OPTIONS["levels"] | sections.get("levels", {})}
        source = Path(path) if stage == "inspect_mesh" else Path(folder)
        importlib.import_module(stage).main(source, Path(folder), options)


def run_stages(solid, folder, **sections):
    """Run all stages on `solid` in the empty `folder`, as :func:`run_mesh`: :class:`Result`."""
    folder = Path(folder)
    write_off(folder / "model.off", solid)
    run_mesh(folder / "model.off", folder, **sections)
    tables = {name: read_table(folder / f"{name}.parquet", name).to_pylist() for name in TABLES}
    graphs = {name: nx.read_graphml(folder / f"{name}.graphml", force_multigraph=True) for name in GRAPHS}
    tilt = json.loads((folder / "tilt.json").read_text())
    vertices = np.array([[row["x"], row["y"], row["z"]] for row in tables["vertices"]])
    faces = [(row["a"], row["b"], row["c"]) for row in tables["faces"]]
    return Result(tables, graphs, tilt, tilt_points(vertices, tilt["rotation"]), faces)


def as_read(graphs):
    """MultiGraphs by name as the certifier reads them; what is none stays as it is."""

    def told(graph):
        return {name: value for name, value in graph.graph.items() if not name.endswith("_default")}

    return {
        name: ReadGraph(dict(g.nodes(data=True)), list(g.edges(keys=True, data=True)), told(g))
        if g.is_multigraph()
        else g
        for name, g in graphs.items()
    }


def tilt_points(points, rotation):
    """Rows of rotation @ point, in the order of operations that the height is defined by."""
    return [tuple(float(a * x + b * y + c * z) for a, b, c in rotation) for x, y, z in points.tolist()]
