"""Seconds of each kernel, to be held against those of an earlier commit.

    pip install pytest-benchmark
    export PYTHONPATH=benchmarks
    python -m pytest benchmarks/bench_kernels.py --benchmark-save=before
    python -m pytest benchmarks/bench_kernels.py --benchmark-compare

Processor time, minima of several rounds on warm kernels. --benchmark-compare-fail=min:10%
makes it an error when one has become slower by a tenth.
"""

import numpy as np
import pytest

from bumpy_meshes import bumpy_torus, level_heights, white_noise
from reebslice.graphs.exact import solid_reeb_graph
from reebslice.mesh.merging import merge_exactly
from reebslice.morse.critical_points import vertex_indices
from reebslice.morse.ordered_mesh import order_by_height
from reebslice.morse.reeb_graph import surface_reeb_graph
from reebslice.morse.unfolding import unfold_saddles
from reebslice.slicing.contours import trace_contours
from reebslice.slicing.levels import make_levels
from reebslice.slicing.slices import cut_surface, nested_contours

pytest.importorskip("pytest_benchmark", reason="pip install pytest-benchmark")
LEVELS = 1000
MESHES = {"smooth": bumpy_torus, "noise": white_noise}


@pytest.fixture(scope="module", params=[("smooth", 20_000), ("smooth", 500_000), ("noise", 100_000)], ids=str)
def arrays(request):
    name, faces = request.param
    return MESHES[name](faces)


@pytest.fixture(scope="module")
def mesh(arrays):
    return order_by_height(*arrays, np.eye(3))


@pytest.fixture(scope="module")
def levels(arrays, mesh):
    if len(surface_reeb_graph(mesh).nodes) > 1000:
        pytest.skip("noise has too many contours for a thousand levels")
    return level_heights(arrays[0], LEVELS)


def no_bodies(mesh):
    return np.zeros(len(mesh.points), np.int32)


def test_order(benchmark, arrays):
    benchmark(order_by_height, *arrays, np.eye(3))


def test_merge_corners(benchmark, arrays):
    points, faces = arrays
    corners = points[faces].reshape(-1, 3).astype(np.float32).astype(float)
    benchmark(merge_exactly, corners, np.arange(len(corners), dtype=np.int32).reshape(-1, 3))


@pytest.mark.parametrize("kernel", [vertex_indices, unfold_saddles, surface_reeb_graph], ids=lambda one: one.__name__)
def test_critical_points_and_graph(benchmark, mesh, kernel):
    benchmark(kernel, unfold_saddles(mesh) if kernel is surface_reeb_graph else mesh)


def test_solid_graph(benchmark, mesh, levels):
    simple = unfold_saddles(mesh)
    graph = surface_reeb_graph(simple)
    benchmark(solid_reeb_graph, simple, graph, no_bodies(simple))


def test_contours(benchmark, mesh, levels):
    benchmark(trace_contours, mesh, make_levels(mesh, levels))


def test_regions(benchmark, mesh, levels):
    benchmark(nested_contours, mesh, levels)


def test_pieces_and_blocks(benchmark, mesh, levels):
    benchmark(cut_surface, mesh, make_levels(mesh, levels), no_bodies(mesh))
