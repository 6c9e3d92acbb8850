"""The solid's graph by merge trees, held against the one by slices, which shares nothing with it but the surface's."""

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
from reebslice.graphs import exact, solid_by_trees, solid_levels
from reebslice.graphs.exact import merged_solid_graph, sliced_solid_graph
from reebslice.graphs.exact_lines import exact_end
from reebslice.graphs.flat_pairs import cancel_pairs, find_flat_pairs
from reebslice.graphs.plumb_lines import meet_faces
from reebslice.graphs.solid_by_trees import solid_graph_by_trees
from reebslice.graphs.voids import void_mesh, void_reeb_graph
from reebslice.handles.sides import link_areas
from reebslice.mesh.exact_signs import scale_points
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
    assert solid_graph_by_trees(mesh, graph, body) is not None
    found, (nodes, arcs) = merged_solid_graph(mesh, graph, body), sliced_solid_graph(mesh, graph, body)
    pairs = find_flat_pairs(mesh.points[graph.nodes, 2], graph)
    kept = pairs[np.isin(graph.nodes[pairs], nodes).all(axis=1)]
    expected = cancel_pairs(np.searchsorted(graph.nodes, nodes)[arcs], len(graph.nodes), kept)
    assert Counter(map(tuple, found[0][found[1]].tolist())) == Counter(map(tuple, graph.nodes[expected].tolist()))
    assert len(kept) or found[0].tolist() == nodes.tolist()
    return len(nodes)


@cases(60)
@given(solids.any_solids(), st.integers(0, 5))
def test_trees_and_slices_give_one_graph(solid, seed):
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
def test_a_line_meets_the_faces_of_its_own_body(seed):
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
    """With bounds of rounding so large that no line and hardly a ray in a level is certain, all graphs stay."""
    shapes = [solids.csg(5, 6), solids.nested_shells(3), solids.Solid(*noisy_volumes.noisy_plate(12, 1.2, 1.0, 4))]
    meshes = [turned(solid, seed) for solid in shapes]
    expected = [merged_solid_graph(mesh, surface_reeb_graph(mesh), one_body(mesh)) for mesh in meshes]

    def meet_doubtfully(*arguments):
        hits = meet_faces(*arguments)
        return hits._replace(face=hits.face * 0, near=hits.near * 0, far=hits.far * np.inf, doubtful=hits.far > 0)

    exact = []
    monkeypatch.setattr(solid_by_trees, "meet_faces", meet_doubtfully)
    monkeypatch.setattr(solid_levels, "ROUNDING", 0.05)
    monkeypatch.setattr(solid_levels, "exact_end", lambda *a: exact.append(a) or exact_end(*a))
    for mesh, (nodes, arcs) in zip(meshes, expected):
        graph = surface_reeb_graph(mesh)
        assert solid_graph_by_trees(mesh, graph, one_body(mesh)) is not None
        found = merged_solid_graph(mesh, graph, one_body(mesh))
        assert (found[0] == nodes).all() and (found[1] == arcs).all()
    assert len(exact) > 20


def test_a_surface_that_crosses_itself_is_sliced():
    ball = solids.hollow_ball()
    crossed = solids.unite(ball, solids.move(ball, [0.55, 0.2, 0.1]))  # the voids overlap, and so do the balls
    mesh = turned(crossed, 1)
    graph = surface_reeb_graph(mesh)
    assert solid_graph_by_trees(mesh, graph, one_body(mesh)) is None
    found, expected = (make(mesh, graph, one_body(mesh)) for make in (merged_solid_graph, sliced_solid_graph))
    assert all((a == b).all() for a, b in zip(found, expected))


def count_links(mesh):
    """How many extrema there are of each kind: minimum or not, sign of the area of the link."""
    graph = surface_reeb_graph(mesh)
    ends = np.flatnonzero(np.bincount(graph.arcs.ravel()) == 1)
    lower = np.isin(ends, graph.arcs[:, 0]).tolist()
    return Counter(zip(lower, np.sign(link_areas(mesh, graph.nodes[ends])).tolist()))


@pytest.mark.parametrize("high", [3, 2])
def test_a_pin_that_fills_a_pocket_or_a_void_changes_no_graph(high):
    """Its vertices are at the places of the pocket's: no line can tell, and what is an outer contour stays one."""
    block = np.ones((4, 4, 3), bool)
    block[1:3, 1:3, 1:high] = False
    block, pin = solids.voxels(block), solids.move(solids.voxels(np.ones((2, 2, high - 1), bool)), [1.0, 1.0, 1.0])
    both = solids.unite(block, pin)
    body = np.repeat([0, 1], [len(block.points), len(pin.points)]).astype(np.int32)
    mesh = turned(both, None)
    assert solid_graph_by_trees(mesh, surface_reeb_graph(mesh), one_body(mesh)) is None
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
@given(solids.any_solids(), st.integers(1, 3))
def test_a_line_meets_the_nearest_of_all_faces_above_or_below_its_vertex(solid, seed):
    mesh = turned(solid, seed)
    graph = surface_reeb_graph(mesh)
    ends = np.flatnonzero(np.bincount(graph.arcs.ravel()) == 1)
    vertices, upward = graph.nodes[ends].astype(np.int64), ~np.isin(ends, graph.arcs[:, 0])
    hits = meet_faces(scale_points(mesh.points), mesh.faces, one_body(mesh), vertices, upward)
    a, b, c = (mesh.points[mesh.faces[:, k]] for k in range(3))

    def doubled_area(u, v):
        return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]

    area = doubled_area(b - a, c - a)
    area[area == 0] = np.nan  # between the copies of a saddle
    for v, up, face in zip(vertices.tolist(), upward.tolist(), hits.face.tolist()):
        p = mesh.points[v]
        share = np.stack([doubled_area(y - x, p - x) / area for x, y in ((b, c), (c, a), (a, b))])
        rise = (share * [a[:, 2], b[:, 2], c[:, 2]]).sum(axis=0) - p[2]
        met = (share > 0).all(axis=0) & (rise > 0 if up else rise < 0) & (mesh.faces != v).all(axis=1)
        nearest = np.argmin(np.where(met, np.abs(rise), np.inf)) if met.any() else -1
        assert face == nearest


def test_lines_find_long_thin_faces_across_many_strips():
    """Small voids in a cone of needles, each of which lies across all strips of lines."""
    count, random = 60, np.random.default_rng(1)
    turn = 2 * np.pi * np.arange(count) / count
    rim = np.column_stack([20 * np.cos(turn), 20 * np.sin(turn), np.full(count, -1.5)])
    here, there = np.arange(count), (np.arange(count) + 1) % count
    sides = [(here, there, np.full(count, count)), (there, here, np.full(count, count + 1))]
    cone = solids.Solid(np.vstack([rim, [0, 0, 30], [0, 0, -2]]), np.concatenate([np.column_stack(s) for s in sides]))
    places = np.stack(np.meshgrid(*[np.arange(6)] * 3), axis=-1).reshape(-1, 3) + random.uniform(-0.2, 0.2, (216, 3))
    voids = (solids.carve(solids.move(solids.scale(solids.tetrahedron(), 0.1), place / 3 - 1)) for place in places)
    solid = solids.unite(cone, *voids)
    mesh = turned(solid, None)
    trees = solid_graph_by_trees(mesh, surface_reeb_graph(mesh), one_body(mesh))
    below, above = np.bincount(trees[:, 1]), np.bincount(trees[:, 0])
    assert len(trees) == len(below) - 1 and len(below) == 2 + 2 * len(places)  # a chain: each void opens and closes
    assert below[:-1].max() <= 2 and above.max() <= 2


@pytest.mark.parametrize("exponent", [-1000, -540, 520, 1000])
def test_graphs_do_not_depend_on_the_unit(exponent):
    shells, turn = solids.nested_shells(3), solids.rotation(1)
    graphs = zip(*(exact_graphs(np.ldexp(shells.points, by), shells.faces, turn) for by in (0, exponent)))
    assert all((one.vertex == two.vertex).all() and one.arcs.tolist() == two.arcs.tolist() for one, two in graphs)


def test_levels_pierce_each_loop_once_where_few_can():
    """Ten windows side by side take one level, ten on top of each other one each."""
    row = solids.plate(10, upright=True)
    for solid, count in ((row, 1), (solids.transform(row, [[0, 0, -1], [0, 1, 0], [1, 0, 0]]), 10)):
        mesh = turned(solid, None)
        cut = solid_levels.cut_at_loops(mesh, surface_reeb_graph(mesh), one_body(mesh))
        assert len(cut.levels.height) == count


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
