"""Loops with a place: against theory, and handles and tunnels against linking numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import solids
from linking import kinds_by_linking
from reebslice import exact_graphs, find_loops, height_mesh, surface_reeb_graph
from reebslice.errors import ReebsliceError
from reebslice.graphs.voids import void_reeb_graph
from test_laws import cases

KIND_OF_SIDES = {(True, False): "handle", (False, True): "tunnel", (False, False): "mixed"}


def crossings(solid, path, circle, turn):
    """How often a closed path crosses a circle around upward and downward; None where the circle meets a vertex."""
    points, circle = solid.points @ turn.T, circle @ turn.T
    height, scale = circle[0, 2], np.ptp(points, axis=0).max()
    if np.abs(points[:, 2] - height).min() <= 1e-12 * scale:
        return None
    ends = points[path], points[np.roll(path, -1)]
    share = (height - ends[0][:, 2:]) / np.where(ends[1] == ends[0], 1, ends[1] - ends[0])[:, 2:]
    spots = (ends[0] + share * (ends[1] - ends[0]))[:, None, :2]
    crosses = (ends[0][:, 2] < height) != (ends[1][:, 2] < height)
    on = np.linalg.norm(spots - circle[None, :, :2], axis=2).min(axis=1) < 1e-9 * scale
    rises = ends[1][:, 2] > ends[0][:, 2]
    return int((crosses & on & rises).sum()), int((crosses & on & ~rises).sum())


def paths_of(loops):
    return [loops.paths.member[a:b] for a, b in zip(loops.paths.start[:-1], loops.paths.start[1:])]


def check(solid, turn, genus=None):
    """What holds of the loops of every solid; returns them."""
    loops = find_loops(solid.points, solid.faces, turn)
    graph = surface_reeb_graph(height_mesh(solid.points, solid.faces, turn))
    bodies = len(np.unique(solids.connected_vertices(solid)[solid.faces]))
    assert len(loops.bottom) == len(graph.arcs) - len(graph.nodes) + bodies
    assert genus is None or len(loops.bottom) == genus
    edges = {(a, b) for a, b in np.concatenate([solid.faces[:, [k, (k + 1) % 3]] for k in range(3)]).tolist()}
    table = []
    for path, circle in zip(paths_of(loops), loops.circles):
        assert len(path) >= 3
        assert all(pair in edges for pair in zip(path.tolist(), np.roll(path, -1).tolist()))
        assert np.ptp((circle @ turn.T)[:, 2]) < 1e-9
        table.append([crossings(solid, path, other, turn) for other in loops.circles])
    for k, row in enumerate(table):
        assert row[k] is None or sorted(row[k]) == [0, 1]
    if table and not any(cell is None for row in table for cell in row):
        signs = np.array([[up - down for up, down in row] for row in table])
        assert round(abs(np.linalg.det(signs))) == 1, "circles and paths are no basis of the homology"
    height = solid.points @ turn[2]
    assert np.allclose(height[loops.bottom], loops.bottom_height)
    assert np.allclose(height[loops.top], loops.top_height)
    assert (loops.bottom_height <= loops.height + 1e-12).all()
    assert (loops.height <= loops.top_height + 1e-12).all()
    ring = [np.linalg.norm(np.diff(circle, axis=0, append=circle[:1]), axis=1).sum() for circle in loops.circles]
    assert np.allclose(ring, loops.perimeter)
    assert (np.pi * loops.radius**2 <= loops.section * (1 + 1e-9) + 1e-9).all()
    assert (4 * np.pi * loops.section <= loops.perimeter**2 * (1 + 1e-9)).all()
    for kind, inner, flat in zip(loops.kind, loops.inner, loops.flat):
        assert not flat or kind == ("tunnel" if inner else "handle")
    return loops


def check_kinds(solid, loops):
    expected = kinds_by_linking(solid.points, solid.faces, loops.circles)
    assert loops.kind.tolist() == [KIND_OF_SIDES[sides] for sides in expected]


# --------------------------------------------------------------------------
# Laws


@cases(60)
@given(solids.any_solids(), st.integers(0, 5))
def test_every_loop_has_a_circle_around_it_and_a_path_that_crosses_it_once(solid, seed):
    check(solid, solids.rotation(seed) if seed else np.eye(3), solid.genus)


@cases(25)
@given(st.one_of(solids.trusses(), solids.machined_parts(), solids.csgs()), st.integers(0, 5))
def test_handles_and_tunnels_are_those_that_linking_numbers_tell(solid, seed):
    turn = solids.rotation(seed + 1)
    check_kinds(solid, check(solid, turn))


@cases(25)
@given(solids.trusses(), st.integers(1, 5))
def test_handles_are_loops_of_the_solid_and_tunnels_are_loops_of_the_void(solid, seed):
    turn = solids.rotation(seed)
    loops = find_loops(solid.points, solid.faces, turn)
    _, inside = exact_graphs(solid.points, solid.faces, turn)
    around = void_reeb_graph(solid.points, solid.faces, turn)
    n_inside, n_around = (len(graph.arcs) - len(graph.vertex) + _components(graph) for graph in (inside, around))
    assert n_inside + n_around == len(loops.bottom)
    handles, tunnels = ((loops.kind == kind).sum() for kind in ("handle", "tunnel"))
    assert handles <= n_inside and tunnels <= n_around
    assert (loops.kind == "mixed").any() or (handles, tunnels) == (n_inside, n_around)


def _components(graph):
    import networkx

    return networkx.number_connected_components(graph.to_networkx())
