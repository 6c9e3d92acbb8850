"""The void's Reeb graph, pockets and islands: against theory, and against floods of voxels."""

import heapq
import itertools
from collections import Counter

import networkx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage

import solids
from reebslice.errors import ReebsliceError
from reebslice.graphs.bodies import pocket_bodies
from reebslice.graphs.pockets import find_islands, find_pockets
from reebslice.graphs.voids import void_reeb_graph
from test_laws import cases


def count_voids_and_genus(solid):
    """Of a solid whose shells are known by their vertices: shells of negative volume, and the sum of the genera."""
    shell = solids.connected_vertices(solid)
    a, b, c = (solid.points[solid.faces[:, k]] for k in range(3))
    volumes = np.bincount(shell[solid.faces[:, 0]], weights=np.einsum("ij,ij->i", a, np.cross(b, c)))
    used = len(np.unique(solid.faces))
    shells = len(np.unique(shell[solid.faces[:, 0]]))
    return int((volumes < 0).sum()), shells - (used - len(solid.faces) // 2) // 2


def count_components_and_loops(graph):
    count = networkx.number_connected_components(graph.to_networkx())
    return count, len(graph.arcs) - len(graph.vertex) + count


def rows(pockets, kind):
    """(begin height, end height) of the pockets of a kind, counted."""
    chosen = pockets.kind == kind
    return Counter(zip(pockets.begin_height[chosen].tolist(), pockets.end_height[chosen].tolist()))


def drained(pockets, kind):
    """The volume of all pockets of a kind that open into no other."""
    return pockets.volume[(pockets.kind == kind) & (pockets.into < 0)].sum()


# --------------------------------------------------------------------------
# Against theory


@cases(60)
@given(solids.any_solids(), st.integers(0, 5))
def test_the_void_has_the_components_and_loops_that_alexander_duality_says(solid, seed):
    rotation = solids.rotation(seed)
    void = void_reeb_graph(solid.points, solid.faces, rotation)
    components, loops = count_components_and_loops(void)
    voids, genus = count_voids_and_genus(solid)
    assert components == 1 + voids
    assert loops <= genus
    assert np.isinf(void.height).sum() == 2
    assert (np.diff(void.height) >= 0).all()


def test_a_void_around_a_tunnel_has_a_loop_only_along_heights_that_pass_through_it():
    upright, lying = solids.torus(upright=True), solids.torus()
    assert count_components_and_loops(void_reeb_graph(upright.points, upright.faces)) == (1, 0)
    assert count_components_and_loops(void_reeb_graph(lying.points, lying.faces)) == (1, 1)


@pytest.mark.parametrize(
    ("name", "kind", "heights", "volume", "section"),
    [
        ("cup", "basin", (1.0, 2.0), 1.0, 1.0),
        ("overhang", "island", (1.0, 3.0), 2.0, 1.0),
    ],
)
def test_named_shapes(name, kind, heights, volume, section):
    solid = getattr(solids, name)()
    found = find_islands if kind == "island" else find_pockets
    pockets = found(solid.points, solid.faces)
    assert pockets.kind.tolist() == [kind]
    assert (pockets.begin_height[0], pockets.end_height[0]) == heights
    assert pockets.volume[0] == pytest.approx(volume, rel=1e-9)
    assert pockets.section[0] == pytest.approx(section, rel=1e-5)
    assert pockets.into.tolist() == [-1]


def test_feet_on_one_plate_are_no_islands():
    arch = solids.arch()
    assert len(find_islands(arch.points, arch.faces).kind) == 0
    lean = np.array([[1.0, 0.0, 0.01], [0.0, 1.0, 0.0], [-0.01, 0.0, 1.0]]) / np.array([[1.00005], [1.0], [1.00005]])
    assert len(find_islands(arch.points, arch.faces, lean).kind) == 1
    assert len(find_islands(arch.points, arch.faces, lean, least_depth=0.1).kind) == 0


def test_a_bore_is_no_trap():
    for upright in (True, False):
        ring = solids.torus(upright=upright)
        assert len(find_pockets(ring.points, ring.faces).kind) == 0
        assert len(find_islands(ring.points, ring.faces).kind) == 0


def test_two_dips_in_one_basin_fill_one_into_the_other():
    height = np.full((7, 5), 4)
    height[1:6, 1:4] = 3
    height[1:3, 1:4], height[4:6, 1:4] = 1, 2
    filled = np.arange(5) < height[:, :, None]
    solid = solids.voxels(filled)
    pockets = find_pockets(solid.points, solid.faces)
    assert pockets.kind.tolist() == ["basin", "basin"]
    deep, shallow = np.argsort(pockets.begin_height)
    assert (pockets.begin_height[deep], pockets.end_height[deep]) == (1.0, 4.0)
    assert (pockets.begin_height[shallow], pockets.end_height[shallow]) == (2.0, 3.0)
    assert pockets.volume[[deep, shallow]] == pytest.approx([12 + 6 + 15, 6], rel=1e-9)
    assert pockets.into[[deep, shallow]].tolist() == [-1, deep]


def test_a_body_that_floats_never_joins():
    solid = solids.unite(solids.cube(), solids.move(solids.cube(), (3.0, 0.0, 0.5)))
    islands = find_islands(solid.points, solid.faces)
    assert len(islands.kind) == 1
    assert islands.volume[0] == pytest.approx(np.ptp(solids.cube().points, axis=0).prod())
    assert islands.section.tolist() == [0.0]


def shells_touched(pockets):
    return [pockets.shells.member[a:b].tolist() for a, b in zip(pockets.shells.start[:-1], pockets.shells.start[1:])]


def test_the_throat_of_a_flask_is_its_neck():
    filled = np.ones((7, 7, 6), bool)
    filled[1:6, 1:6, 1:3] = filled[3, 3, 3:5] = filled[2:5, 2:5, 5] = False
    flask = solids.voxels(filled)
    base = flask.points[:, 2].min()
    for pockets in (find_pockets(flask.points, flask.faces), find_pockets(flask.points, flask.faces, distance=0.3)):
        assert pockets.kind.tolist() == ["basin"]
        assert pockets.largest == pytest.approx([25]) and pockets.section == pytest.approx([9])
        assert pockets.throat_section == pytest.approx([1]) and pockets.throat_radius == pytest.approx([0.5], rel=1e-2)
        assert base + 3 < pockets.throat_height[0] < base + 5
    upside_down = find_pockets(flask.points, flask.faces, np.diag([1.0, -1.0, -1.0]))
    assert upside_down.kind.tolist() == ["bell"] and upside_down.throat_section == pytest.approx([1])
    assert -base - 5 < upside_down.throat_height[0] < -base - 3


def test_what_is_sealed_has_no_throat_and_touches_the_shells_around_and_in_it():
    solid = solids.ball_in_hollow_ball()
    shell = solids.connected_vertices(solid)
    pockets = find_pockets(solid.points, solid.faces)
    assert pockets.kind.tolist() == ["sealed"] and np.isnan(pockets.throat_section).all()
    by_height = np.argsort(solid.points[:, 2], kind="stable")
    outer = shell[np.argmax(np.linalg.norm(solid.points, axis=1))]
    (touched,) = shells_touched(pockets)
    assert [shell[vertex] for vertex in touched] == [one for one in dict.fromkeys(shell[by_height]) if one != outer]
    assert touched == [min(np.flatnonzero(shell == shell[v]), key=by_height.tolist().index) for v in touched]
    many = [
        solids.move(solids.scale(solids.cube(), 0.1), (x, y, z)) for x in range(5) for y in range(5) for z in range(5)
    ]
    room = solids.carve(solids.move(solids.scale(solids.cube(), 8.0), (-2.0, -2.0, -2.0)))
    hall = solids.unite(solids.move(solids.scale(solids.cube(), 10.0), (-3.0, -3.0, -3.0)), room, *many)
    (touched,) = shells_touched(find_pockets(hall.points, hall.faces))
    shell = solids.connected_vertices(hall)
    assert len(touched) == 126 == len({int(shell[first]) for first in touched}) and shell[0] not in shell[touched]


def test_shallow_pockets_are_left_out():
    solid = solids.cup()
    assert len(find_pockets(solid.points, solid.faces, least_depth=1.0).kind) == 1
    assert len(find_pockets(solid.points, solid.faces, least_depth=1.01).kind) == 0
    for wrong in (-1, np.nan, "1", None):
        for find in (find_pockets, find_islands):
            with pytest.raises(ReebsliceError, match=f"least_depth is {wrong!r}"):
                find(solid.points, solid.faces, least_depth=wrong)
    for wrong in (0, -1, np.nan, "1"):
        for find in (find_pockets, find_islands):
            with pytest.raises(ReebsliceError, match=f"distance is {wrong!r}"):
                find(solid.points, solid.faces, distance=wrong)


def test_points_in_no_face_are_passed_over():
    cup, loose = solids.cup(), [[np.nan] * 3, [9.0, 9.0, 9.0]]
    points = np.concatenate([loose, cup.points])
    pockets, plain = find_pockets(points, cup.faces + 2), find_pockets(cup.points, cup.faces)
    assert pockets.begin.tolist() == (plain.begin + 2).tolist() and pockets.volume.tolist() == plain.volume.tolist()
    [(corners, _)] = pocket_bodies(points, cup.faces + 2, pockets)
    assert np.ptp(corners, axis=0) == pytest.approx([1, 1, 1])


def test_water_on_a_terrain_is_that_of_a_flood_from_its_border():
    size, random = 14, np.random.default_rng(7)
    land, width = solids.terrain(1 + random.random((size, size))), size**2
    points, faces = land.points, land.faces
    top = faces[(points[faces][:, :, 2] > 0.5).all(axis=1)]
    level = spill_levels(points, top)
    held = sum(water_over(points[face], level[face].min()) for face in top)
    pockets = find_pockets(points, faces)
    assert (pockets.kind == "basin").sum() > 5 and width == len(np.unique(top))
    assert drained(pockets, "basin") == pytest.approx(held, rel=1e-9)


def spill_levels(points, top):
    """To what height water stands over each vertex: the lowest pass on any way along mesh edges to the border."""
    near = {vertex: set() for vertex in np.unique(top).tolist()}
    sides = Counter(frozenset(side) for face in top.tolist() for side in itertools.combinations(face, 2))
    for one, other in sides:
        near[one].add(other)
        near[other].add(one)
    border = set().union(*(side for side, count in sides.items() if count == 1))
    level, waiting = np.full(len(points), -np.inf), [(points[vertex, 2], vertex) for vertex in border]
    heapq.heapify(waiting)
    while waiting:
        height, vertex = heapq.heappop(waiting)
        if level[vertex] == -np.inf:
            level[vertex] = height
            for other in near[vertex]:
                heapq.heappush(waiting, (max(height, points[other, 2]), other))
    return level


def water_over(corners, level):
    """Volume between a triangle, seen from above, and a level: by divided differences of the third power."""
    heights = np.sort(corners[:, 2])
    (ax, ay), (bx, by) = (corners[k, :2] - corners[0, :2] for k in (1, 2))
    powers = [
        max(level - z, 0.0) ** 3 / np.prod([other - z for other in np.delete(heights, k)])
        for k, z in enumerate(heights)
    ]
    return abs(ax * by - ay * bx) / 6 * sum(powers)


@cases(40)
@given(solids.turned(solids.any_solids()))
def test_upside_down_basins_are_bells(solid):
    flip = np.diag([1.0, -1.0, -1.0])
    here, there = (find_pockets(solid.points, solid.faces, rotation) for rotation in (np.eye(3), flip))
    for one, other in (("basin", "bell"), ("bell", "basin"), ("sealed", "sealed")):
        a, b = here.kind == one, there.kind == other
        assert a.sum() == b.sum()
        assert np.sort(here.volume[a]) == pytest.approx(np.sort(there.volume[b]), rel=1e-6, abs=1e-9)


@cases(40)
@given(solids.any_solids(), st.integers(0, 5))
def test_every_void_is_sealed_and_no_volume_is_negative(solid, seed):
    pockets = find_pockets(solid.points, solid.faces, solids.rotation(seed))
    assert (pockets.kind == "sealed").sum() == count_voids_and_genus(solid)[0]
    assert (pockets.volume >= 0).all()


@cases(60)
@given(solids.any_solids(), st.integers(0, 5))
def test_bodies_are_closed_and_have_the_volumes_of_the_table(solid, seed):
    rotation = solids.rotation(seed)
    for find in (find_pockets, find_islands):
        pockets = find(solid.points, solid.faces, rotation)
        bodies = pocket_bodies(solid.points, solid.faces, pockets, rotation)
        assert len(bodies) == len(pockets.kind)
        for (points, faces), volume in zip(bodies, pockets.volume):
            half_edges = Counter(
                map(tuple, np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).tolist())
            )
            assert all(half_edges[head, tail] == count for (tail, head), count in half_edges.items())
            a, b, c = (points[faces[:, k]] - points[0] for k in range(3))
            size = np.ptp(solid.points, axis=0).prod()
            assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(volume, abs=1e-7 * size)


def volumes_of(bodies):
    for points, faces in bodies:
        a, b, c = (points[faces[:, k]] - points[0] for k in range(3))
        yield float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("by", [(0.0, 0.0, 1.0), (0.5, 0.5, 1.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0)])
def test_an_island_that_touches_another_body_is_cut_out_itself(by):
    below, above = solids.cube(), solids.scale(solids.cube(), 2.0)
    low, side = below.points.min(axis=0), np.ptp(below.points, axis=0)
    above = solids.move(above, low + side * by - above.points.min(axis=0))
    both = solids.unite(below, above)
    body = np.repeat([0, 1], [len(below.points), len(above.points)]).astype(np.int32)
    islands = find_islands(both.points, both.faces, None, body)
    assert islands.volume == pytest.approx([8 * side.prod()])
    assert list(volumes_of(pocket_bodies(both.points, both.faces, islands))) == pytest.approx([8 * side.prod()])


def test_bodies_are_cut_out_far_from_the_origin():
    cup = solids.cup()
    for by in (1e6, 1e8, 3e8):
        far = solids.move(cup, (by, by, by))
        pockets = find_pockets(far.points, far.faces)
        assert list(volumes_of(pocket_bodies(far.points, far.faces, pockets))) == pytest.approx([1.0], rel=1e-6)


def test_a_body_of_another_volume_is_refused():
    cup = solids.cup()
    pockets = find_pockets(cup.points, cup.faces)
    with pytest.raises(ReebsliceError, match="basin 0 has the volume 2, but 1 was cut out for it"):
        pocket_bodies(cup.points, cup.faces, pockets._replace(volume=2 * pockets.volume))


# --------------------------------------------------------------------------
# Against floods of voxels


def flood(cells, ground):
    """Flood cells (x, y, z) layer by layer; whatever meets an elder flood ends there, and that of `ground` is eldest.

    Returns the layers (begin, end) of all floods that ended, counted; how many cells those had that ended in the
    eldest one; and of those that no other of their age met (begin, end, largest layer, least layer from there on).
    """
    ended, shapes, held, floods = Counter(), Counter(), 0, []
    for z in range(cells.shape[2]):
        labels, count = ndimage.label(cells & (np.arange(cells.shape[2]) <= z))
        merged = []
        for label in range(1, count + 1):
            inside = labels == label
            met = sorted((old for old in floods if (old[1] & inside).any()), key=lambda old: old[0])
            births = [birth for birth, *_ in met] + [z]
            area = int(inside[:, :, z].sum())
            merged.append((-1 if inside[ground] else births[0], inside, [*(met[0][2] if met else ()), area]))
            for birth, part, areas in met:
                if birth >= 0 and (inside[ground] or birth > births[0] or part is not met[0][1]):
                    ended[birth, z] += 1
                    held += int(part.sum()) if inside[ground] else 0
                    if births.count(birth) == 1:
                        shapes[birth, z, max(areas), min(areas[areas.index(max(areas)) :])] += 1
        floods = merged
    return ended, held, shapes


@st.composite
def grids(draw, size=5):
    """Random voxel solids without pinches, as grids with two empty cells around."""
    share, seed = draw(st.sampled_from([0.35, 0.5, 0.65])), draw(st.integers(0, 2**32 - 1))
    filled = np.random.default_rng(seed).random((size, size, size)) < share
    filled[0, 0, 0] = True
    filled = solids.fill_pinches(filled)
    return np.pad(filled[tuple(slice(c.min(), c.max() + 1) for c in np.nonzero(filled))], 2)


def compare_with_floods(grid, diagonals):
    """Hold the pockets and islands of a grid against floods of its cells; return how many there are."""
    solid, top = solids.voxels(grid, diagonals), grid.shape[2]
    base = solid.points[:, 2].min() - 2  # the height of the lowest cells
    open_air = ndimage.label(~grid)[0] == 1
    pockets, counts = find_pockets(solid.points, solid.faces, distance=0.5), 0
    for kind, cells, low, up in (("basin", open_air, 0, 1), ("bell", open_air[:, :, ::-1], top, -1)):
        ended, held, shapes = flood(cells, (0, 0, 0))
        assert rows(pockets, kind) == Counter(
            {(base + low + up * b, base + low + up * e): n for (b, e), n in ended.items()}
        )
        assert drained(pockets, kind) == pytest.approx(held, rel=1e-9)
        chosen = pockets.kind == kind
        sections = np.column_stack([pockets.largest, pockets.throat_section])[chosen].round(6).tolist()
        heights = np.column_stack([pockets.begin_height, pockets.end_height])[chosen].tolist()
        found = Counter((*ends, *section) for ends, section in zip(heights, sections))
        assert Counter({(base + low + up * b, base + low + up * e, *s): n for (b, e, *s), n in shapes.items()}) <= found
        counts += ended.total()
    assert (pockets.kind == "sealed").sum() == ndimage.label(~grid)[1] - 1
    assert pockets.volume[pockets.kind == "sealed"].sum() == pytest.approx((~grid & ~open_air).sum(), rel=1e-9)
    islands, bodies = find_islands(solid.points, solid.faces), ndimage.label(grid)[0]
    floors = {body: np.argwhere(bodies == body)[:, 2].min() for body in range(1, bodies.max() + 1)}
    ended = Counter()
    for body, floor in floors.items():
        cells = bodies == body
        ended += flood(cells, min(map(tuple, np.argwhere(cells)), key=lambda cell: cell[2]))[0]
        if floor > 2:
            ended[floor, np.argwhere(cells)[:, 2].max() + 1] += 1
    assert rows(islands, "island") == Counter({(base + b, base + e): n for (b, e), n in ended.items() if b > 2})
    return counts + ended.total()


@cases(80)
@given(grids(), st.integers(0, 3))
def test_pockets_and_islands_are_those_that_floods_of_voxels_find(grid, diagonals):
    compare_with_floods(grid, diagonals)
