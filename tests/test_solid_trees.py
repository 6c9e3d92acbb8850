"""The solid's graph by rays, held against the one by slices, which shares nothing with it but the surface's graph."""

import importlib
import sys
from collections import Counter
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import solids
from reebslice import exact_graphs, height_mesh, inspect_surface, read_mesh, surface_reeb_graph
from reebslice.graphs import exact, outer_arcs, ray_hosts
from reebslice.graphs.exact import rayed_solid_graph, sliced_solid_graph
from reebslice.graphs.exact_rays import exact_host
from reebslice.graphs.face_grid import build_grid, find_candidates
from reebslice.graphs.flat_pairs import cancel_pairs, find_flat_pairs
from reebslice.graphs.solid_by_rays import solid_graph_by_rays
from reebslice.graphs.voids import void_mesh, void_reeb_graph
from reebslice.handles.sides import link_areas
from reebslice.slicing import graph_slices
from test_laws import cases

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
noisy_volumes = importlib.import_module("noisy_volumes")
MESHES = Path(__file__).parents[2] / "shared" / "meshes"


def turned(solid, seed):
    return height_mesh(solid.points, solid.faces, None if seed is None else solids.rotation(seed))


def one_body(mesh):
    return np.zeros(len(mesh.points), np.int32)


def compare(mesh, body=None):
    """Assert that both ways give one graph; slices may keep pairs in flats that others had them part."""
    graph, body = surface_reeb_graph(mesh), one_body(mesh) if body is None else body
    assert solid_graph_by_rays(mesh, graph, body) is not None
    found, (nodes, arcs) = rayed_solid_graph(mesh, graph, body), sliced_solid_graph(mesh, graph, body)
    pairs = find_flat_pairs(mesh.points[graph.nodes, 2], graph)
    kept = pairs[np.isin(graph.nodes[pairs], nodes).all(axis=1)]
    expected = cancel_pairs(np.searchsorted(graph.nodes, nodes)[arcs], len(graph.nodes), kept)
    assert Counter(map(tuple, found[0][found[1]].tolist())) == Counter(map(tuple, graph.nodes[expected].tolist()))
    assert len(kept) or found[0].tolist() == nodes.tolist()
    return len(nodes)


@cases(60)
@given(solids.any_solids(), st.integers(0, 5))
def test_rays_and_slices_give_one_graph(solid, seed):
    compare(turned(solid, seed))


@cases(40)
@given(st.one_of(solids.voxel_solids(), solids.trusses(), solids.machined_parts(), solids.combs(), solids.terrains()))
def test_flats_and_ties_give_the_graph_of_slices_but_for_pairs_of_one_height(solid):
    compare(turned(solid, None))


@cases(30)
@given(st.one_of(solids.nests(), solids.csgs(), solids.cones()), st.integers(0, 3))
def test_the_void_has_the_graph_of_slices(solid, seed):
    compare(void_mesh(turned(solid, seed)))


@pytest.mark.parametrize("seed", [None, 1, 2])
def test_a_ray_counts_the_faces_of_its_own_body(seed):
    """A hollow ball of one body overlaps one of another, and a third lies in its void."""
    balls = [solids.hollow_ball(), solids.move(solids.hollow_ball(), [0.7, 0.2, 0.1]), solids.icosphere(1, radius=0.2)]
    solid, body = solids.unite(*balls), np.repeat([0, 1, 2], [len(ball.points) for ball in balls]).astype(np.int32)
    mesh = turned(solid, seed)
    compare(mesh, body[mesh.vertex])


@pytest.mark.parametrize("around, across, amplitude", [(60, 30, 0.4), (80, 50, 2.0), (60, 80, 3.9)])
def test_a_noisy_ring_has_the_graph_of_slices(around, across, amplitude):
    assert compare(height_mesh(*noisy_volumes.bumpy_torus(around, across, amplitude, 1))) > 20


@pytest.mark.parametrize("white", [0.6, 1.6])
def test_a_porous_plate_has_the_graph_of_slices(white):
    assert compare(height_mesh(*noisy_volumes.noisy_plate(22, white, 1.0, 4))) > 50


@pytest.mark.skipif(not MESHES.is_dir(), reason="the corpus ../shared/meshes is absent")
@pytest.mark.parametrize("name", ["cheese_g133.off", "tray_bottom_g23.STL", "block_stand_voids.stl", "hand_cgal.off"])
def test_a_real_mesh_has_the_graph_of_slices(name):
    file = read_mesh(MESHES / name)
    tables, _ = inspect_surface(file.points, file.faces)
    points, faces = (np.column_stack([tables[key][name] for name in names]) for key, names in
                     (("vertices", "xyz"), ("faces", "abc")))  # fmt: skip
    for seed in (None, 1):
        compare(height_mesh(points, faces, None if seed is None else solids.rotation(seed)))


@pytest.mark.parametrize("seed", [None, 3])
def test_what_floats_leave_open_rational_numbers_decide(monkeypatch, seed):
    """With a bound of rounding so large that hardly a ray and no area is certain, all graphs stay as they are."""
    shapes = [solids.csg(5, 6), solids.nested_shells(3), solids.Solid(*noisy_volumes.noisy_plate(12, 1.2, 1.0, 4))]
    meshes = [turned(solid, seed) for solid in shapes]
    expected = [rayed_solid_graph(mesh, surface_reeb_graph(mesh), one_body(mesh)) for mesh in meshes]
    monkeypatch.setattr(ray_hosts, "ROUNDING", 0.05)
    monkeypatch.setattr(outer_arcs, "ROUNDING", 1e3)
    exact = []
    monkeypatch.setattr("reebslice.graphs.solid_by_rays.exact_host", lambda *a: exact.append(a) or exact_host(*a))
    for mesh, (nodes, arcs) in zip(meshes, expected):
        graph = surface_reeb_graph(mesh)
        found = rayed_solid_graph(mesh, graph, one_body(mesh))
        assert (found[0] == nodes).all() and (found[1] == arcs).all()
    assert len(exact) > 20


def test_a_surface_that_crosses_itself_is_sliced():
    ball = solids.hollow_ball()
    crossed = solids.unite(ball, solids.move(ball, [0.55, 0.2, 0.1]))  # the voids overlap, and so do the balls
    mesh = turned(crossed, 1)
    graph = surface_reeb_graph(mesh)
    assert solid_graph_by_rays(mesh, graph, one_body(mesh)) is None
    found, expected = (make(mesh, graph, one_body(mesh)) for make in (rayed_solid_graph, sliced_solid_graph))
    assert all((a == b).all() for a, b in zip(found, expected))


def count_links(mesh):
    """How many extrema there are of each kind: minimum or not, sign of the area of the link."""
    graph = surface_reeb_graph(mesh)
    ends = np.flatnonzero(np.bincount(graph.arcs.ravel()) == 1)
    lower = np.isin(ends, graph.arcs[:, 0]).tolist()
    return Counter(zip(lower, np.sign(link_areas(mesh, graph.nodes[ends])).tolist()))


@pytest.mark.parametrize("high", [3, 2])
def test_a_pin_that_fills_a_pocket_or_a_void_changes_no_graph(high):
    """Its vertices are at the places of the pocket's: no ray can tell, and what is an outer contour stays one."""
    block = np.ones((4, 4, 3), bool)
    block[1:3, 1:3, 1:high] = False
    block, pin = solids.voxels(block), solids.move(solids.voxels(np.ones((2, 2, high - 1), bool)), [1.0, 1.0, 1.0])
    both = solids.unite(block, pin)
    body = np.repeat([0, 1], [len(block.points), len(pin.points)]).astype(np.int32)
    mesh = turned(both, None)
    assert solid_graph_by_rays(mesh, surface_reeb_graph(mesh), one_body(mesh)) is None
    graphs = [exact_graphs(both.points, both.faces, None, body)[1]]
    graphs += [exact_graphs(one.points, one.faces)[1] for one in (block, pin)]
    together, *alone = (sorted(map(tuple, graph.height[graph.arcs].tolist())) for graph in graphs)
    assert together == sorted(alone[0] + alone[1])
    signs = [count_links(turned(solid, None)) for solid in (both, block, pin)]
    assert signs[0] == signs[1] + signs[2]


def test_noise_for_which_slices_have_no_room_has_its_graphs(monkeypatch):
    monkeypatch.setattr(graph_slices, "MOST_CROSSINGS", 5_000)
    monkeypatch.setattr(exact, "FEW_CROSSINGS", 5_000)
    points, faces = noisy_volumes.bumpy_torus(80, 50, 2.0, 2)
    for graph in exact_graphs(points, faces):
        assert len(graph.vertex) > 400 and len(graph.arcs) == len(graph.vertex)  # one part, one loop
    void = void_reeb_graph(points, faces)
    parts = nx.number_connected_components(void.to_networkx())
    assert parts == 1 and len(void.arcs) - len(void.vertex) + parts == 0


@cases(20)
@given(solids.any_solids(), st.sampled_from([None, 1]))
def test_the_grid_lists_each_face_that_a_level_and_a_line_may_cross_once(solid, seed):
    mesh = turned(solid, seed)
    n, random = len(mesh.points), np.random.default_rng(0)
    offset = mesh.points @ [0.6, -0.8, 0.0]
    grid, room = build_grid(mesh.faces, offset, 1e-9), np.empty(4 * len(mesh.faces), np.int32)
    for rank, aside in zip(random.integers(0, n, 50).tolist(), random.uniform(offset.min(), offset.max(), 50)):
        found = room[: find_candidates(grid, n, rank, aside, room)]
        meets = (mesh.faces.min(axis=1) < rank) & (mesh.faces.max(axis=1) >= rank)
        meets &= (offset[mesh.faces].min(axis=1) <= aside) & (offset[mesh.faces].max(axis=1) >= aside)
        assert len(np.unique(found)) == len(found) and np.isin(np.flatnonzero(meets), found).all()


def test_a_pair_goes_with_its_branch_and_what_the_branch_hosts_goes_over():
    # 1 begins, hosts the events 2 and 3, and joins 0 - 5 at 4
    arcs = np.array([[0, 4], [1, 2], [2, 3], [3, 4], [4, 5]])
    assert sorted(cancel_pairs(arcs, 6, np.array([[1, 4]])).tolist()) == [[0, 2], [2, 3], [3, 5]]
    upside_down = np.sort(5 - arcs, axis=1)
    assert sorted(cancel_pairs(upside_down, 6, np.array([[1, 4]])).tolist()) == [[0, 2], [2, 3], [3, 5]]
    # two events of a hole go from the arc that they part
    assert cancel_pairs(np.array([[0, 1], [1, 2], [2, 3]]), 4, np.array([[1, 2]])).tolist() == [[0, 3]]
    # a branch that parts in between stays
    forked = np.array([[0, 4], [1, 2], [2, 4], [2, 3], [4, 5]])
    assert sorted(cancel_pairs(forked, 6, np.array([[1, 4]])).tolist()) == sorted(forked.tolist())
