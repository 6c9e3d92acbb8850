"""The arc of each vertex and face, against walks along every contour."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import solids
from reebslice.graphs.exact import exact_graphs
from reebslice.morse.face_arcs import label_arcs, label_faces
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.ordered_mesh import next_half_edge
from reebslice.morse.reeb_graph import surface_reeb_graph
from test_laws import cases


def walk(mesh, start, cut):
    """All upward half-edges that the contour through one crosses."""
    crossed, h = set(), start
    while h not in crossed:
        crossed.add(h)
        h = next_half_edge(mesh.faces, mesh.twins, h, cut)
    return crossed


@cases(40)
@given(solids.any_solids(), st.integers(0, 5))
def test_a_vertex_lies_on_the_arc_whose_contour_passes_through_it(solid, seed):
    mesh = height_mesh(solid.points, solid.faces, solids.rotation(seed))
    graph = surface_reeb_graph(mesh)
    labels = label_arcs(mesh, graph)
    ends = graph.nodes[graph.arcs]
    assert (labels.of_vertex[graph.nodes] == -1).all()
    tails, heads = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    regular = np.setdiff1d(np.arange(len(mesh.points)), graph.nodes)
    for vertex in regular[:: max(1, len(regular) // 60)].tolist():
        arc = labels.of_vertex[vertex]
        assert ends[arc, 0] < vertex < ends[arc, 1]
        start = int(np.flatnonzero((tails == vertex) & (heads > tails))[0])
        crossed = walk(mesh, start, vertex + 1)
        others = [
            a
            for a in range(len(ends))
            if ends[a, 0] <= vertex < ends[a, 1] and contour_of(mesh, graph, a, vertex + 1) & crossed
        ]
        assert others == [arc]


def contour_of(mesh, graph, arc, cut):
    """The half-edges that the contour of an arc crosses at a level: that of its gate, followed up vertex by vertex."""
    low = graph.nodes[graph.arcs[arc, 0]]
    crossed = walk(mesh, int(graph.gates[arc]), low + 1)
    tails, heads = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    for level in range(low + 2, cut + 1):
        passed = {h for h in crossed if heads[h] == level - 1}
        if passed:
            start = int(np.flatnonzero((tails == level - 1) & (heads > tails))[0])
            crossed = walk(mesh, start, level)
    return crossed


@cases(40)
@given(solids.any_solids(), st.integers(0, 5))
def test_a_face_lies_on_an_arc_that_passes_its_middle(solid, seed):
    mesh = height_mesh(solid.points, solid.faces, solids.rotation(seed))
    graph = surface_reeb_graph(mesh)
    labels = label_arcs(mesh, graph)
    ends, middle = graph.nodes[graph.arcs[labels.of_face]], np.sort(mesh.faces, axis=1)[:, 1]
    assert ((ends[:, 0] <= middle) & (middle <= ends[:, 1])).all()
    regular = labels.of_vertex[middle] >= 0
    assert (labels.of_face[regular] == labels.of_vertex[middle[regular]]).all()


@cases(40)
@given(solids.any_solids(), st.integers(0, 5))
def test_faces_keep_their_arcs_in_the_order_of_the_caller(solid, seed):
    rotation = solids.rotation(seed)
    surface, _ = exact_graphs(solid.points, solid.faces, rotation)
    arcs = label_faces(solid.points, solid.faces, rotation)
    random = np.random.default_rng(seed)
    order, turn = random.permutation(len(solid.faces)), random.integers(3, size=len(solid.faces))
    shuffled = np.take_along_axis(solid.faces, (turn[:, None] + np.arange(3)) % 3, axis=1)[order]
    assert label_faces(solid.points, shuffled, rotation).tolist() == arcs[order].tolist()
    low, high = surface.height[surface.arcs[arcs]].T
    middle = np.sort((solid.points @ rotation[2])[solid.faces], axis=1)[:, 1]
    assert (low <= middle + 1e-9).all() and (middle <= high + 1e-9).all()


def test_the_legs_of_an_arch_are_arcs_of_their_own():
    arch = solids.arch()
    arcs, middles = label_faces(arch.points, arch.faces), arch.points[arch.faces].mean(axis=1)
    below = middles[:, 2] < 0.9 * arch.points[:, 2].max() / 2
    left = middles[:, 0] < arch.points[:, 0].mean()
    assert set(arcs[below & left]).isdisjoint(arcs[below & ~left])
