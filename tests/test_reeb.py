"""The exact Reeb graph without levels, extended persistence, simplified graphs, figures of sampling."""

from collections import Counter

import networkx as nx
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import reference
import solids
from reebslice.graphs.simplification import simplify_graph
from reebslice.morse.critical_points import vertex_indices
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.persistence import extended_pairs
from reebslice.morse.reeb_graph import critical_persistence, surface_reeb_graph
from reebslice.slicing.contours import trace_contours
from reebslice.slicing.levels import make_levels, uniform_heights
from reebslice.slicing.sampling import event_spans, fewest_uniform_levels, sampling_figures
from test_laws import cases


def mesh_of(solid, seed=None):
    return height_mesh(solid.points, solid.faces, None if seed is None else solids.rotation(seed))


def pairs_of(n_nodes, arcs):
    """Pairs of components of sublevel sets, of superlevel sets, and of loops, three sorted lists."""
    return tuple(sorted(map(tuple, pairs.tolist())) for pairs in extended_pairs(n_nodes, arcs)[:3])


def reduce_boundaries(n_nodes, arcs):
    """Extended persistence by its definition: the boundary matrix of the graph and a cone over it, reduced."""
    cells = [((0, v, 0), ("node", v), []) for v in range(n_nodes)]
    cells += [((0, high, 1), ("arc", k), [("node", low), ("node", high)]) for k, (low, high) in enumerate(arcs)]
    cells += [((1, -n_nodes, 0), ("tip", 0), [])]
    cells += [((1, -v, 1), ("node's cone", v), [("node", v), ("tip", 0)]) for v in range(n_nodes)]
    cells += [
        ((1, -low, 2), ("arc's cone", k), [("arc", k), ("node's cone", low), ("node's cone", high)])
        for k, (low, high) in enumerate(arcs)
    ]
    cells.sort(key=lambda cell: cell[0])
    place = {cell[1]: k for k, cell in enumerate(cells)}
    columns, kinds = {}, ([], [], [])
    for _, (kind, name), boundary in cells:
        column = {place[face] for face in boundary}
        while column and max(column) in columns:
            column = column ^ columns[max(column)]
        if not column:
            continue
        columns[max(column)] = column
        born, of = cells[max(column)][1]
        if (born, kind) == ("node", "arc"):
            kinds[0].append((of, arcs[name][1]))
        elif (born, kind) == ("node's cone", "arc's cone"):
            kinds[1].append((arcs[name][0], of))
        elif (born, kind) == ("arc", "arc's cone"):
            kinds[2].append((arcs[name][0], arcs[of][1]))
    return tuple(sorted(pair for pair in kind if pair[0] != pair[1]) for kind in kinds)


@st.composite
def graphs(draw, most=24):
    """A multigraph on 0..n-1, every node with an arc, arcs upward."""
    n = draw(st.integers(2, 12))
    ends = st.tuples(st.integers(0, n - 1), st.integers(0, n - 1)).filter(lambda pair: pair[0] != pair[1])
    arcs = [tuple(sorted(pair)) for pair in draw(st.lists(ends, min_size=1, max_size=most))]
    used = sorted({node for arc in arcs for node in arc})
    place = {node: k for k, node in enumerate(used)}
    return len(used), [(place[a], place[b]) for a, b in arcs]


# --------------------------------------------------------------------------
# The exact graph


@cases(60)
@given(solids.any_solids(), st.sampled_from([None, 1]))
def test_the_graph_without_levels_is_that_of_the_reference(solid, seed):
    mesh = mesh_of(solid, seed)
    graph = surface_reeb_graph(mesh)
    points = np.empty_like(solid.points)
    points[mesh.vertex] = mesh.points
    try:
        expected, _ = reference.sweep(reference.as_points(points), [tuple(f) for f in solid.faces.tolist()])
    except reference.Ambiguous:
        assume(False)
    ends = mesh.vertex[graph.nodes[graph.arcs]].tolist()
    found = Counter(tuple(pair) for pair in ends if pair[0] != pair[1])  # parts of one saddle are one node there
    height = {v: k for k, v in enumerate(reference.order_vertices(reference.as_points(points)))}
    wanted = Counter(tuple(sorted((a, b), key=height.get)) for a, b in expected.edges())
    assert found == wanted


@cases(40)
@given(solids.any_solids(), st.integers(0, 5))
def test_partners_are_those_of_the_reduced_matrix(solid, seed):
    mesh = mesh_of(solid, seed)
    graph = surface_reeb_graph(mesh)
    assert (graph.partner[graph.partner] == np.arange(len(graph.nodes))).all()
    pairs = reduce_boundaries(len(graph.nodes), list(map(tuple, graph.arcs.tolist())))
    for kind in pairs:
        assert all(graph.partner[low] == high for low, high in kind)
    shells = nx.number_connected_components(nx.MultiGraph(graph.arcs.tolist()))
    assert 2 * (sum(map(len, pairs)) + shells) == len(graph.nodes)


@cases(30)
@given(solids.any_solids(), st.integers(0, 5), st.integers(1, 9))
def test_every_level_cuts_as_many_arcs_as_it_has_contours(solid, seed, count):
    mesh = mesh_of(solid, seed)
    graph = surface_reeb_graph(mesh)
    levels = make_levels(
        mesh, uniform_heights(mesh.points[0, 2], mesh.points[-1, 2], np.ptp(mesh.points[:, 2]) / count)
    )
    low, high = graph.nodes[graph.arcs].T
    cut = [((low < below) & (below <= high)).sum() for below in levels.below]
    assert cut == np.bincount(trace_contours(mesh, levels).level, minlength=len(cut)).tolist()


@pytest.mark.parametrize("holes", [1, 2, 5])
def test_loops_of_a_plate_are_its_holes(holes):
    mesh = mesh_of(solids.plate(holes, upright=True), 2)
    graph = surface_reeb_graph(mesh)
    assert len(graph.arcs) - len(graph.nodes) + 1 == holes
    index = vertex_indices(mesh)[graph.nodes]
    assert ((index == -1) & (index[graph.partner] == -1)).sum() == 2 * holes


def test_persistence_of_an_upright_torus():
    mesh = mesh_of(solids.torus(upright=True, around=16, across=8), 0)
    graph = surface_reeb_graph(mesh)
    heights = mesh.points[graph.nodes, 2]
    assert graph.partner.tolist() == [3, 2, 1, 0]
    spans = [heights[3] - heights[0], heights[2] - heights[1]]
    persistence = critical_persistence(mesh, graph)
    assert persistence[graph.nodes].tolist() == [spans[0], spans[1], spans[1], spans[0]]
    assert np.isnan(np.delete(persistence, graph.nodes)).all()


# --------------------------------------------------------------------------
# Persistence and simplification of graphs


@cases(400)
@given(graphs())
def test_extended_pairs_are_those_of_the_reduced_matrix(graph):
    n, arcs = graph
    assert pairs_of(n, arcs) == reduce_boundaries(n, arcs)
    parts = nx.connected_components(nx.MultiGraph(arcs))
    assert sorted(map(tuple, extended_pairs(n, arcs).extremes.tolist())) == sorted((min(p), max(p)) for p in parts)


@cases(400)
@given(graphs(), st.randoms(use_true_random=False), st.floats(0.01, 0.9))
def test_a_simplified_graph_keeps_what_is_large_and_nothing_else(graph, random, size):
    n, arcs = graph
    heights = sorted(random.random() for _ in range(n))
    measure = [random.random() for _ in arcs]
    left, shares = simplify_graph(heights, arcs, measure, size)
    assert sum(shares) == pytest.approx(sum(measure))
    assert (left[:, 0] < left[:, 1]).all()

    def large(pairs):
        return [sorted(p for p in kind if heights[p[1]] - heights[p[0]] >= size) for kind in pairs]

    before, after = pairs_of(n, arcs), pairs_of(n, left)
    assert large(after) == list(map(sorted, after))
    assert len(after[2]) <= len(before[2])
    if len(large(before)[2]) == len(before[2]):  # only gluing a loop may move other pairs
        assert large(after) == large(before)
    components = [nx.number_connected_components(nx.MultiGraph(list(map(tuple, ends)))) for ends in (arcs, left)]
    assert components[0] == components[1]


def test_a_small_loop_with_a_horn_on_it_leaves_the_horn():
    #   0 - 1 < (2 - 5 horn) > 3 - 4
    arcs = [(0, 1), (1, 2), (1, 3), (2, 3), (2, 5), (3, 4)]
    heights = [0.0, 1.0, 1.05, 1.1, 2.0, 2.5]
    left, measure = simplify_graph(heights, arcs, [1.0] * 6, 0.2)
    assert left.tolist() == [[0, 2], [2, 4], [2, 5]]
    assert measure.tolist() == pytest.approx([2.5, 2.5, 1.0])


def test_a_node_that_does_not_branch_stays_if_asked():
    arcs = [(0, 1), (1, 2)]
    assert simplify_graph([0.0, 1.0, 2.0], arcs, [1.0, 2.0], 0.1)[0].tolist() == [[0, 2]]
    assert simplify_graph([0.0, 1.0, 2.0], arcs, [1.0, 2.0], 0.1, kept=[1])[0].tolist() == [[0, 1], [1, 2]]


# --------------------------------------------------------------------------
# How densely levels must lie


@cases(60)
@given(solids.any_solids(), st.integers(0, 5))
def test_the_number_of_uniform_levels_is_the_least_that_works(solid, seed):
    mesh = mesh_of(solid, seed)
    graph = surface_reeb_graph(mesh)
    spans = mesh.points[graph.nodes, 2][graph.arcs]
    spans = spans[spans[:, 0] < spans[:, 1]]
    count = fewest_uniform_levels(spans)
    assume(count is not None and count < 3000)

    def cuts_all(k):
        heights = uniform_heights(spans.min(), spans.max(), np.ptp(spans) / k)
        return all(((low <= heights) & (heights < high)).any() for low, high in spans)

    assert cuts_all(count)
    assert not any(cuts_all(k) for k in range(max(1, count - 40), count))


def test_figures_of_a_tall_and_a_short_tower():
    # lowest point, union of two feet at 3, summit: spans [0, 3), [1, 3), [3, 4)
    arcs = {"source": [0, 1, 2], "target": [2, 2, 3], "lower": [0.0, 1.0, 3.0], "upper": [3.0, 3.0, 4.0]}
    figures = sampling_figures({name: Column(values) for name, values in arcs.items()})
    assert figures == {"fewest_levels": 2, "shortest_arc": 1.0, "uniform_levels": 2, "exact_distance": 0.5}


def test_events_at_one_height_inside_a_flat_are_one_or_none():
    # 0 - 1 = 2 - 3 with 1 and 2 at one height: a bump of the flat that the order alone makes
    spans = event_spans(*map(np.array, ([0, 1, 2, 2], [2, 2, 3, 4], [0.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 5.0])))
    assert spans.tolist() == [[0.0, 5.0]]


class Column(list):
    """As much of a column as the figures need."""

    def to_numpy(self):
        return np.array(self)
