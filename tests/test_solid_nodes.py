"""Where the nodes of the solid's graph lie: in the material, against winding numbers."""

import numpy as np
import pytest

import certify
import solids
from corpus.storage import read_json, read_table
from pipeline import TABLES, as_read, run_stages
from reebslice.certification import certificate
from reebslice.graphs.parts import GraphParts
from reebslice.graphs.solid_nodes import embed_joints

LEVELS = {"distance": 0.1, "units": "relative", "feature_size": 0.2, "refine": "exact"}
TIPS = [(0, "A"), (2, "B")]


def winding_numbers(corners, spots):
    """How often the surface is around each spot: sums of solid angles (van Oosterom and Strackee)."""
    a, b, c = (corners[None, :, k] - spots[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    above = np.einsum("ijk,ijk->ij", a, np.cross(b, c))
    below = la * lb * lc + sum(np.einsum("ijk,ijk->ij", p, q) * r for p, q, r in ((a, b, lc), (b, c, la), (c, a, lb)))
    return 2 * np.arctan2(above, below).sum(axis=1) / (4 * np.pi)


SOLIDS = {
    "torus": solids.torus(upright=True),
    "lying": solids.torus(),
    "arch": solids.arch(),
    "cup": solids.cup(),
    "saddle": solids.monkey_saddle(5),
    "hollow": solids.hollow_ball(2),
    "rings": solids.linked_rings(),
    "plate": solids.plate(3),
    "blob": solids.blob(7, roughness=0.5),
    "machined": solids.machined(3),
}


@pytest.mark.parametrize("refine", ["exact", "none"])
@pytest.mark.parametrize("name", SOLIDS)
def test_nodes_lie_in_the_material_and_at_the_ends_of_tips(name, refine, tmp_path):
    solid, levels = SOLIDS[name], LEVELS | {"refine": refine}
    result = run_stages(solid, tmp_path, tilt={"mode": "auto"}, levels=levels, nodes={"sampler": "inscribed"})
    vertices = np.array([[row[axis] for axis in "xyz"] for row in result.tables["vertices"]])
    corners = vertices[[[row[corner] for corner in "abc"] for row in result.tables["faces"]]]
    nodes = dict(result.graphs["solid"].nodes(data=True))
    inner = {key: data for key, data in nodes.items() if data["region"] >= 0}
    spots = np.array([[data[axis] for axis in "xyz"] for data in inner.values()]).reshape(-1, 3)
    assert (np.abs(winding_numbers(corners, spots) - 1) < 1e-6).all()
    for key, data in nodes.items():
        handle = result.handles[data["handle"]]
        at_vertex = [data[f"vertex_{axis}"] for axis in "xyz"]
        assert at_vertex == [handle[axis] for axis in "xyz"]
        if key not in inner:
            assert (data["index"], data["side"]) in TIPS and at_vertex == [data[axis] for axis in "xyz"]
    certify.main(tmp_path, tmp_path, levels)
    checks = read_json(tmp_path / "certificate.json")["checks"]
    assert checks["solid.nodes_inside"]["holds"] and all(check["holds"] for check in checks.values())


def test_lengths_of_arcs_are_those_of_their_paths(tmp_path):
    result = run_stages(SOLIDS["arch"], tmp_path, levels=LEVELS)
    points = np.array([[row[axis] for axis in "xyz"] for row in result.nodes])
    nodes = {data["handle"]: [data[axis] for axis in "xyz"] for _, data in result.graphs["solid"].nodes(data=True)}
    arcs = [row for row in read_table(tmp_path / "arcs.parquet", "arcs").to_pylist() if row["graph"] == "solid"]
    for row in arcs:
        path = np.vstack([nodes[row["source"]], points[row["nodes"]].reshape(-1, 3), nodes[row["target"]]])
        assert row["length"] == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum(), rel=1e-12)
    assert len(arcs) > 2


def test_a_node_that_lies_elsewhere_is_caught(tmp_path):
    result = run_stages(SOLIDS["arch"], tmp_path, levels=LEVELS, nodes={"sampler": "inscribed"})
    tables, tilt = {name: read_table(tmp_path / f"{name}.parquet", name) for name in TABLES}, result.tilt

    def failures(change):
        graph = result.graphs["solid"].copy()
        change(next(data for _, data in graph.nodes(data=True) if data["region"] >= 0))
        found = certificate.certify(tables, tilt, as_read(result.graphs | {"solid": graph}), 0.2)
        failed = {name for name, check in found["checks"].items() if not check["holds"]}
        return failed - {"solid_simplified.nodes"}  # whose nodes are those of the full graph

    def to_region(region):
        return dict(zip("xyz", (result.nodes[region][axis] for axis in "xyz"))) | {"region": region}

    def beside(data):
        handle = result.handles[data["handle"]]
        return next(r for r in handle["regions_below"] + handle["regions_above"] if r != data["region"])

    assert failures(lambda data: None) == set()
    # beside its event, but not by the rule; far from it; at its vertex, on the surface; off every material point
    assert failures(lambda data: data.update(to_region(beside(data)))) == {"solid.node_attributes"}
    both = {"solid.node_attributes", "solid.nodes_inside"}
    assert failures(lambda data: data.update(to_region(len(result.nodes) - 1))) == both
    assert failures(lambda data: data.update({axis: data[f"vertex_{axis}"] for axis in "xyz"})) == both
    assert failures(lambda data: data.update(x=data["x"] + 1e-3)) == both
    assert failures(lambda data: data.update(region=10**6)) == both
    assert failures(lambda data: data.pop("region")) == both


def event(index, side, operation):
    place = {"x": 9.0, "y": 9.0, "z": 9.0, "vertex": 4}
    return place | {"index": index, "side": side, "operation": operation}


@pytest.mark.parametrize(
    "lower, upper, events, regions",
    [
        ([0, 1], [2], [(1, "A", "union")], [2]),
        ([0], [1, 2], [(1, "B", "separation")], [0]),
        ([], [0], [(0, "A", "creation")], [None]),
        ([0], [], [(2, "B", "annihilation")], [None]),
        ([], [0, 1], [(0, "A", "creation")], [None]),
        ([], [0, 1], [(1, "B", "separation")], [1]),
        ([], [], [(0, "A", "creation")], [None]),
        ([0], [1], [(1, "A", "separation")], [0]),
        ([0], [1], [(0, "B", "creation")], [0]),
        ([0], [1], [(2, "A", "annihilation")], [1]),
        ([0], [1], [(1, "A", "separation"), (1, "B", "union"), (0, "B", "creation")], [0, 1, 1]),
        ([0, 1], [2, 3], [(1, "A", "union")], [3]),
        ([0, 1], [2, 3], [(0, "A", "creation")], [1]),
    ],
)
def test_the_rule_of_where_nodes_lie(lower, upper, events, regions):
    points, room = np.arange(12.0).reshape(4, 3), np.array([1.0, 2.0, 1.0, 3.0])
    parts = GraphParts([lower], [upper], [list(range(len(events)))], np.ones(1))
    placed = embed_joints(parts, {k: event(*of) for k, of in enumerate(events)}, points, room)
    assert [placed[k]["region"] for k in range(len(events))] == regions
    for k, region in enumerate(regions):
        spot = [9.0, 9.0, 9.0] if region is None else points[region].tolist()
        assert [placed[k][axis] for axis in "xyz"] == spot
        assert [placed[k][f"vertex_{axis}"] for axis in "xyz"] == [9.0, 9.0, 9.0]


@pytest.mark.parametrize("method", ["similarity", "proximity"])
def test_nodes_of_guessed_links_are_material_points(method, tmp_path):
    result = run_stages(SOLIDS["torus"], tmp_path, levels=LEVELS, edges={"method": method})
    points = {tuple(row[axis] for axis in "xyz") for row in result.nodes}
    nodes = dict(result.graphs["solid"].nodes(data=True))
    assert nodes and all(tuple(data[axis] for axis in "xyz") in points for data in nodes.values())
