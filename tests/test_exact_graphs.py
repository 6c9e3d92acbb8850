"""Exact graphs of surface and solid together, and the slices that are made along the surface's graph."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import reference
import solids
from reebslice.arrays.grouping import list_groups
from reebslice.graphs.exact import exact_graphs
from reebslice.mesh.half_edges import find_twins
from reebslice.mesh.orders import canonical_faces
from reebslice.morse.critical_points import vertex_indices
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph
from reebslice.slicing.contours import trace_crossings
from reebslice.slicing.graph_slices import contours_of_arcs, trace_arcs_at_levels
from reebslice.slicing.levels import make_levels, uniform_heights
from reebslice.slicing.refinement import slice_surface
from reebslice.slicing.slices import cut_along_arcs, cut_surface
from test_laws import cases


def simple_mesh(solid, seed):
    return height_mesh(solid.points, solid.faces, solids.rotation(seed))


def ends(graph):
    """Arcs between different vertices: parts of one saddle are one node in the reference."""
    return Counter(pair for pair in map(tuple, graph.vertex[graph.arcs].tolist()) if pair[0] != pair[1])


@cases(80)
@given(solids.any_solids(), st.integers(0, 5))
def test_both_graphs_are_those_of_the_reference(solid, seed):
    mesh = simple_mesh(solid, seed)
    assume((np.diff(mesh.points[np.append(True, np.diff(mesh.vertex) != 0), 2]) > 0).all())
    points = np.empty_like(solid.points)
    points[mesh.vertex] = mesh.points
    try:
        expected = reference.sweep(reference.as_points(points), [tuple(f) for f in solid.faces.tolist()])
    except reference.Ambiguous:
        assume(False)
    height = {v: k for k, v in enumerate(reference.order_vertices(reference.as_points(points)))}
    for found, graph in zip(exact_graphs(solid.points, solid.faces, solids.rotation(seed)), expected):
        where = dict(graph.nodes(data="vertex"))
        arcs = (tuple(sorted((where[a], where[b]), key=height.get)) for a, b in graph.edges())
        assert ends(found) == Counter(pair for pair in arcs if pair[0] != pair[1])
        assert (np.diff(found.height) >= 0).all() and (found.arcs[:, 0] < found.arcs[:, 1]).all()


@pytest.mark.parametrize("holes", [1, 3])
def test_a_plate_on_edge_shows_its_holes_and_a_lying_one_does_not(holes):
    upright, lying = solids.plate(holes, upright=True), solids.plate(holes)
    for graph in exact_graphs(upright.points, upright.faces, solids.rotation(3)):
        assert len(graph.arcs) - len(graph.vertex) + 1 == holes
    graph = exact_graphs(lying.points, lying.faces)[1]
    assert len(graph.arcs) - len(graph.vertex) + 1 == 0


def test_shells_in_each_other_are_one_solid_or_bodies_of_their_own():
    ball = solids.ball_in_hollow_ball()
    surface, solid = exact_graphs(ball.points, ball.faces, solids.rotation(1))
    assert len(surface.vertex) - len(surface.arcs) == 3  # three spheres, an arc each
    assert len(solid.vertex) - len(solid.arcs) == 2  # the hollow ball, and the one inside
    apart = solids.unite(solids.icosphere(2), solids.icosphere(1, radius=0.5))
    bodies = np.repeat([0, 1], [len(solids.icosphere(2).points), len(solids.icosphere(1).points)])
    solid = exact_graphs(apart.points, apart.faces, solids.rotation(1), bodies)[1]
    assert len(solid.vertex) == 4 and len(solid.arcs) == 2


@cases(40)
@given(solids.any_solids(), st.integers(0, 5), st.integers(1, 9))
def test_slices_along_the_graph_are_those_of_the_mesh(solid, seed, count):
    mesh = simple_mesh(solid, seed)
    graph, body = surface_reeb_graph(mesh), np.zeros(len(mesh.points), np.int32)
    heights = uniform_heights(mesh.points[0, 2], mesh.points[-1, 2], np.ptp(mesh.points[:, 2]) / count)
    levels = make_levels(mesh, heights)
    contours, crossings = trace_crossings(mesh, levels)
    found, of_arcs = trace_arcs_at_levels(mesh, graph, levels)
    assert all((a == b).all() for a, b in zip(found, contours))
    assert all((a == b).all() for a, b in zip(of_arcs, contours_of_arcs(mesh, graph, levels, crossings)))
    one, other = cut_along_arcs(mesh, levels, body, graph), cut_surface(mesh, levels, body)
    assert all((a == b).all() for a, b in zip(one.regions, other.regions))

    def pieces(slices):
        part, blocks = slices.pieces, slices.block_of_piece
        bounds = [(part.piece_above, range(len(part.piece_above))), (part.piece_below, range(len(part.piece_below)))]
        members = [[np.flatnonzero(side == piece).tolist() for side, _ in bounds] for piece in range(len(part.slab))]
        figures = zip(part.slab, part.euler_characteristic, part.genus, list_groups(part.critical))
        rows = [(*map(str, row), str(member)) for row, member in zip(figures, members)]
        parts = (tuple(sorted(rows[p] for p in np.flatnonzero(blocks == b))) for b in set(blocks.tolist()))
        return Counter(rows), Counter(parts)

    assert pieces(one) == pieces(other)


@cases(20)
@given(solids.any_solids(), st.integers(0, 3))
def test_the_solid_has_the_loops_that_exact_levels_show(solid, seed):
    mesh = simple_mesh(solid, seed)
    body = solids.connected_vertices(mesh)
    of_vertex = np.empty(len(solid.points), np.int32)
    of_vertex[mesh.vertex] = body
    slices, _ = slice_surface(mesh, body, np.ptp(mesh.points[:, 2]), "exact")
    graph = exact_graphs(solid.points, solid.faces, solids.rotation(seed), of_vertex)[1]
    assert len(graph.arcs) - len(graph.vertex) == len(slices.regions.level) - slices.n_blocks


@cases(40)
@given(st.one_of(solids.cones(), solids.wedge_solids(), solids.any_solids()), st.sampled_from([None, 1]))
def test_an_unfolded_mesh_is_in_canonical_order(solid, seed):
    mesh = height_mesh(solid.points, solid.faces, None if seed is None else solids.rotation(seed))
    n = len(mesh.points)
    assert (canonical_faces(mesh.faces, np.arange(n, dtype=np.int32)) == mesh.faces).all()
    assert (find_twins(mesh.faces, n) == mesh.twins).all()
    assert vertex_indices(mesh).min() >= -1


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_surface_in_one_plane_has_graphs(axis):
    """Two triangles back to back: what encloses nothing is ordered by the coordinates that differ."""
    points = np.insert(np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 1.0]]), axis, 5.0, axis=1)
    for graph in exact_graphs(points, [[0, 1, 2], [0, 2, 1]]):
        assert len(graph.vertex) == 2 and graph.arcs.tolist() == [[0, 1]]
