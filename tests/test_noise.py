"""Noisy volumes: nothing is lost at any feature size, and what is shown does not depend on the levels."""

import importlib
import sys
from collections import Counter
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

import certify
import solids
from corpus.storage import read_json
from pipeline import run_stages

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
noisy_volumes = importlib.import_module("noisy_volumes")

PLATE = {"size": 36, "white": 0.9, "waves": 0.5, "seed": 7}


@pytest.fixture(scope="module")
def plate():
    return solids.Solid(*noisy_volumes.noisy_plate(**PLATE))


def run(solid, folder, size, distance):
    """Results and certificate, at a feature size and a distance, parts of the height."""
    levels = {"distance": distance, "refine": "feature", "feature_size": size}
    folder.mkdir()
    result = run_stages(solid, folder, levels=levels)
    certify.main(folder, folder, {"units": "relative"} | levels)
    return result, read_json(folder / "certificate.json")


def by_vertex(result, name):
    """Vertices and arcs, by the vertices of their ends, of a simplified graph."""
    graph = result.graphs[f"{name}_simplified"]
    vertex = {node: result.handles[int(data["handle"])]["vertex"] for node, data in graph.nodes(data=True)}
    return set(vertex.values()), Counter(tuple(sorted((vertex[a], vertex[b]))) for a, b in graph.edges())


def test_an_isosurface_is_closed_whatever_the_values():
    values = np.random.default_rng(0).standard_normal((6, 7, 5))
    points, faces = noisy_volumes.isosurface(values)
    ends = np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)])
    ways = Counter(map(tuple, ends.tolist()))
    assert set(ways.values()) == {1} and all((b, a) in ways for a, b in ways)
    # the volume is on the side of the positive values
    ball = 4.0 - np.linalg.norm(np.indices((12, 12, 12)) - 5.5, axis=0)
    points, faces = noisy_volumes.isosurface(np.moveaxis(ball[None], 0, -1)[..., 0])
    a, b, c = points[faces].transpose(1, 0, 2)
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(4 / 3 * np.pi * 64, rel=0.05)
    assert len(points) - len(faces) // 2 == 2


def test_noise_hides_nothing_and_levels_change_nothing(plate, tmp_path):
    size, seen = 0.1, []
    for part in (2, 4):
        result, certificate = run(plate, tmp_path / str(part), size, size / part)
        simplified = certificate["simplified"]
        assert certificate["verdict"] == "exact_at_feature_size"
        assert certificate["genus"] > 5 and certificate["shells"] > 1 and len(result.critical_points) > 1000
        loops = simplified["loops_surface"] + simplified["suppressed_loops"] + certificate["hidden_genus"]
        assert loops == certificate["genus"]
        loops = [row for row in result.critical_points if row["pairing"] == "loop"]
        large = [row for row in loops if row["persistence"] >= certificate["feature_size"]]
        assert simplified["suppressed_loops"] > 0 and 2 * simplified["loops_surface"] == len(large)
        shown = nx.number_connected_components(result.graphs["surface_simplified"])
        assert shown + simplified["suppressed_shells"] == certificate["shells"]
        seen.append([by_vertex(result, name) for name in ("solid", "surface")])
    assert seen[0] == seen[1]
    # a node stands for its largest event: that of the feature size, where one is
    large = {row["vertex"] for row in result.handles if row["persistence"] >= certificate["feature_size"]}
    assert seen[1][1][0] <= large


def test_nothing_is_shown_where_all_is_smaller(plate, tmp_path):
    result, certificate = run(plate, tmp_path / "all", 1.5, 0.1)
    assert certificate["verdict"] == "exact_at_feature_size"
    assert certificate["simplified"]["suppressed_shells"] == certificate["shells"]
    assert result.graphs["solid_simplified"].number_of_nodes() == 0


def test_dense_noise_on_a_ring_leaves_its_loop(tmp_path):
    ring = solids.Solid(*noisy_volumes.bumpy_torus(100, 50, 2.0, 1))
    result, certificate = run(ring, tmp_path / "ring", 0.2, 0.1)
    assert len(result.critical_points) > 1000 and certificate["genus"] == 1
    assert certificate["simplified"]["loops_solid"] == 1 and certificate["hidden_genus"] == 0
    assert result.graphs["solid_simplified"].number_of_nodes() == 4
