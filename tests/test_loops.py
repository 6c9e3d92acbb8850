"""Loops with a place: against theory, and handles and tunnels against linking numbers."""

import itertools
from collections import Counter
from pathlib import Path

import manifold3d
import networkx
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import solids
from linking import kinds_by_linking
from reebslice import exact_graphs, find_loops, height_mesh, inspect_surface, read_mesh, surface_reeb_graph
from reebslice.arrays.grouping import Groups, group_of_members
from reebslice.drawing.canvas import rgb
from reebslice.drawing.loops import INKS, draw_loops
from reebslice.errors import ReebsliceError
from reebslice.graphs.loop_cycles import find_core, pair_loops, trace_loops
from reebslice.graphs.loop_kinds import KINDS, find_kinds
from reebslice.graphs.loop_measures import draw_circles, nest_bodies
from reebslice.graphs.loop_paths import walk_cycles
from reebslice.graphs.voids import void_reeb_graph
from reebslice.slicing.exact_contours import walk_crossings
from reebslice.slicing.graph_slices import trace_arcs_at_levels
from reebslice.slicing.levels import Levels, make_levels, uniform_heights
from test_laws import cases

CORPUS = Path(__file__).parents[2] / "shared" / "meshes"
UNION = manifold3d.OpType.Add
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


def check(solid, turn, genus=None, distance=None):
    """What holds of the loops of every solid; returns them."""
    loops = find_loops(solid.points, solid.faces, turn, distance)
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
    assert (np.pi * loops.inscribed_radius**2 <= loops.section * (1 + 1e-9) + 1e-9).all()
    assert (4 * np.pi * loops.section <= loops.perimeter**2 * (1 + 1e-9)).all()
    for kind, inner, flat in zip(loops.kind, loops.inner, loops.flat):
        assert not flat or kind == ("tunnel" if inner else "handle")
    return loops


def check_kinds(solid, loops):
    expected = kinds_by_linking(solid.points, solid.faces, loops.circles)
    assert loops.kind.tolist() == [KIND_OF_SIDES[sides] for sides in expected]


def hollow_ring():
    return solids.unite(solids.torus(upright=True), solids.carve(solids.torus(minor=0.4, upright=True)))


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
    return networkx.number_connected_components(graph.to_networkx())


@cases(15)
@given(st.one_of(solids.trusses(), solids.csgs()), st.integers(1, 5))
def test_loops_do_not_depend_on_the_order_of_the_mesh_and_grow_with_it(solid, seed):
    turn = solids.rotation(seed)
    one = find_loops(solid.points, solid.faces, turn)
    other = solids.permute(solids.scale(solid, 2.0), seed)
    two = find_loops(other.points, other.faces, turn)
    assert one.kind.tolist() == two.kind.tolist()
    assert (2 * solid.points[one.bottom] == other.points[two.bottom]).all()
    assert (2 * solid.points[one.top] == other.points[two.top]).all()
    for name, power in (("height", 1), ("perimeter", 1), ("section", 2), ("inscribed_radius", 1), ("length", 1)):
        assert np.allclose(2**power * getattr(one, name), getattr(two, name), rtol=1e-9, atol=1e-9)


@cases(20)
@given(st.one_of(solids.trusses(), st.just(hollow_ring())), st.integers(0, 5))
@example(solids.torus(), None)
@example(solids.linked_rings(), None)
@example(solids.plate(3), None)
def test_the_kind_of_any_contour_is_that_which_linking_numbers_tell(solid, seed):
    turn = np.eye(3) if seed is None else solids.rotation(seed)
    mesh = height_mesh(solid.points, solid.faces, turn)
    graph = surface_reeb_graph(mesh)
    levels = make_levels(mesh, uniform_heights(*mesh.points[[0, -1], 2], np.ptp(mesh.points[:, 2]) / 12))
    contours, of_arcs = trace_arcs_at_levels(mesh, graph, levels)
    core = find_core(graph)
    nesting = nest_bodies(mesh, levels, contours, of_arcs, np.zeros(len(mesh.points), np.int32))
    chosen = np.flatnonzero(core.chain[nesting.arc] >= 0)
    kind, own = find_kinds(core, nesting, chosen)
    curves = draw_circles(contours, chosen, levels.height[contours.level[chosen]])
    for place, sides in enumerate(kinds_by_linking(solid.points @ turn.T, solid.faces, curves)):
        if sides != (True, True):  # it cuts no loop
            assert KINDS[kind[place]] == KIND_OF_SIDES[sides]
            assert own[place] == sides[int(nesting.inner[chosen[place]])]


@cases(15)
@given(solids.trusses((3, 3, 2)), st.integers(0, 5))
def test_cycles_run_through_both_ends_and_stay_between(solid, seed):
    graph = surface_reeb_graph(height_mesh(solid.points, solid.faces, solids.rotation(seed)))
    bottom, top = pair_loops(graph)
    cycles = trace_loops(find_core(graph), bottom, top)
    for k, (start, end) in enumerate(itertools.pairwise(cycles.start)):
        members = cycles.member[start:end]
        assert len(set(members.tolist())) == len(members)
        nodes, count = np.unique(graph.arcs[members], return_counts=True)
        assert (count == 2).all() and len(nodes) == len(members)
        assert (nodes[0], nodes[-1]) == (bottom[k], top[k])
        assert networkx.is_connected(networkx.Graph(graph.arcs[members].tolist()))


@cases(25)
@given(st.one_of(solids.trusses((3, 3, 2)), solids.machined_parts(), solids.csgs()), st.integers(0, 5))
def test_a_path_crosses_a_contour_of_its_cycle_once_wherever_it_is(solid, seed):
    """Before it is shortened, however many arcs a mesh edge spans."""
    mesh = height_mesh(solid.points, solid.faces, solids.rotation(seed))
    graph = surface_reeb_graph(mesh)
    cycles = trace_loops(find_core(graph), *pair_loops(graph))
    for start, end in itertools.pairwise(cycles.start):
        arcs = cycles.member[start:end]
        ends = graph.nodes[graph.arcs[arcs]]
        cuts = np.concatenate([ends[:, 0] + 1, ends.sum(axis=1) // 2 + 1, ends[:, 1]])
        levels = Levels(mesh.points[cuts, 2], cuts, *np.full((2, len(cuts)), np.nan))
        order = np.argsort(cuts, kind="stable")
        contours, of_arcs = trace_arcs_at_levels(mesh, graph, Levels(*(column[order] for column in levels)))
        cycle = Groups(np.arange(len(cuts) + 1) * len(arcs), np.tile(arcs, len(cuts)))
        paths = walk_cycles(mesh, graph, cycle, cuts[order])
        for contour in of_arcs.member[np.isin(group_of_members(of_arcs), arcs)]:
            level = contours.level[contour]
            low, high = walk_crossings(mesh.faces, mesh.twins, contours.first[contour], cuts[order][level])
            path = paths.member[paths.start[level] : paths.start[level + 1]]
            sides = Counter(frozenset(side) for side in zip(path.tolist(), np.roll(path, -1).tolist()))
            assert sum(sides[frozenset(side)] for side in zip(low.tolist(), high.tolist())) == 1


# --------------------------------------------------------------------------
# Shapes of which one knows


@pytest.mark.parametrize(
    ("solid", "kinds"),
    [
        (solids.torus(), ["tunnel"]),
        (solids.torus(upright=True), ["handle"]),
        (solids.plate(3), ["tunnel"] * 3),
        (solids.plate(3, upright=True), ["handle"] * 3),
        (solids.tunnel(), ["handle"]),
        (solids.trefoil(), ["handle"]),
        (solids.linked_rings(), ["handle", "mixed"]),
        (hollow_ring(), ["mixed", "tunnel"]),
        (solids.winding_voids(), ["tunnel"] * 2),
        (solids.cup(), []),
    ],
    ids=["lying", "upright", "plate", "frame", "tunnel", "trefoil", "linked", "hollow", "caves", "cup"],
)
def test_shapes_have_the_loops_that_one_sees(solid, kinds):
    loops = check(solid, np.eye(3), len(kinds))
    assert sorted(loops.kind.tolist()) == kinds
    check_kinds(solid, loops)


def test_bodies_are_told_apart():
    rings = solids.linked_rings()
    loops = find_loops(rings.points, rings.faces, body_of_vertex=solids.connected_vertices(rings))
    assert sorted(zip(loops.kind.tolist(), loops.flat.tolist())) == [("handle", True), ("tunnel", True)]


def test_circles_go_around_the_thinnest_bars_and_leave_the_thickest():
    widths, parts, x = (1.0, 0.5, 2.0, 0.8), [], 0.0
    for width in widths:
        parts.append(manifold3d.Manifold.cube((width, 1.0, 3.0)).translate((x, 0.0, 1.0)))
        x += width + 1
    beam = manifold3d.Manifold.cube((x - 1, 1.0, 1.0))
    solid = solids.from_manifold(manifold3d.Manifold.batch_boolean([*parts, beam, beam.translate((0, 0, 4))], UNION))
    loops = check(solid, np.eye(3), 3)
    assert np.allclose(np.sort(loops.perimeter), [3.0, 3.6, 4.0])
    assert np.allclose(np.sort(loops.section), [0.5, 0.8, 1.0])
    assert np.allclose(np.sort(loops.inscribed_radius), [0.25, 0.4, 0.5], atol=1e-3)
    assert (loops.kind == "handle").all() and loops.flat.all()


def test_paths_are_shortened():
    lying, upright = (find_loops(ring.points, ring.faces) for ring in (solids.torus(), solids.torus(upright=True)))
    assert np.allclose(lying.length, 2 * 7 * 0.7 * np.sin(np.pi / 7))  # once around the bar
    assert np.allclose(upright.length, 2 * 12 * (2 + 0.7 * np.cos(6 * np.pi / 7)) * np.sin(np.pi / 12), rtol=0.3)


def test_the_circle_is_at_the_waist():
    ring = solids.torus(around=96, across=16, upright=True)
    angle = np.arctan2(ring.points[:, 2], ring.points[:, 0])
    spine = 2 * np.stack([np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    waist = 0.3 + 0.7 * np.abs(np.sin((angle - 0.2) / 2))[:, None]  # thinnest at the angle 0.2
    solid = solids.Solid(spine + waist * (ring.points - spine), ring.faces)
    loops = check(solid, np.eye(3), 1)
    assert abs(loops.height[0] - 2 * np.sin(0.2)) < 0.15
    assert np.linalg.norm(loops.centre[0] - [2 * np.cos(0.2), 0, 2 * np.sin(0.2)]) < 0.15
    assert np.allclose(loops.length, 2 * np.pi * (2 - 0.7), rtol=0.5)


def test_a_circle_with_a_bent_bore_inside_is_a_handle_though_its_disc_is_not_flat():
    """Two bores in a leg that are one bent bore: contours that are rims of a tube in the material, with no disc."""
    filled = np.ones((16, 5, 9), bool)
    filled[5:7, :, 2:7] = False  # the window between a leg 5 wide and one 9 wide
    filled[1, 2, 1:] = filled[3, 2, 1:] = filled[1:4, 2, 1] = False
    solid = solids.replace(solids.voxels(filled), genus=2)
    loops = check(solid, np.eye(3), 2)
    check_kinds(solid, loops)
    assert sorted(zip(loops.kind.tolist(), loops.flat.tolist())) == [("handle", False), ("tunnel", True)]
    assert np.allclose(np.sort(loops.section), [1, 23])


def test_a_longer_circle_is_taken_where_the_shorter_one_is_mixed():
    """A hollow frame with a hole in one leg: only the level of the hole has a contour that is a handle's."""
    filled = np.ones((11, 3, 11), bool)
    filled[3:8, :, 3:8] = False
    filled[1:10, 1, [1, 9]] = filled[[1, 9], 1, 1:10] = False
    filled[0, 1, 5] = False
    loops = check(solids.voxels(filled), np.eye(3), 2)
    assert sorted(zip(loops.kind.tolist(), loops.perimeter.tolist())) == [("handle", 16.0), ("tunnel", 4.0)]


def test_the_picture_has_each_kind_in_its_colour():
    ring = hollow_ring()
    loops = find_loops(ring.points, ring.faces)
    image = draw_loops("ring", ring.points, ring.faces, loops, {"width": 200})
    for kind, ink in INKS.items():
        assert (image == rgb(ink)).all(axis=2).any() == (kind in loops.kind)


def test_the_door_says_what_is_wrong():
    ring = solids.torus()
    for distance in (0, -1, np.nan, np.inf, "a"):
        with pytest.raises(ReebsliceError, match="distance is"):
            find_loops(ring.points, ring.faces, distance=distance)
    with pytest.raises(ReebsliceError, match="bod"):
        find_loops(ring.points, ring.faces, body_of_vertex=[0])


def test_a_coarse_distance_misses_no_loop():
    solid = solids.truss((3, 3, 3), 2**54 - 1)
    loops = check(solid, solids.rotation(1), distance=100.0)
    assert len(loops.bottom) == solid.genus > 20
    check_kinds(solid, loops)


# --------------------------------------------------------------------------
# Real meshes


@pytest.mark.skipif(not (CORPUS / "MANIFEST.csv").is_file(), reason="the corpus ../shared/meshes is absent")
@pytest.mark.parametrize("name", ["eight_g2.off", "A_letter.obj", "block_stand_voids.stl", "motor_holder_voids.stl"])
def test_loops_of_real_meshes(name):
    file = read_mesh(CORPUS / name)
    tables, inspection = inspect_surface(file.points, file.faces)
    points, faces = (
        np.column_stack([tables[table][column].to_numpy() for column in columns])
        for table, columns in (("vertices", "xyz"), ("faces", "abc"))
    )
    solid = solids.Solid(points, faces)
    check_kinds(solid, check(solid, np.eye(3), inspection["genus"]))
