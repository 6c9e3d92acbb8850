"""Contours, their nesting and their blocks, and pairs in slabs, against slow versions that share no code with them."""

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import solids
from corpus.storage import read_blocks, read_table, write_blocks
from reebslice.arrays.grouping import split_into_blocks
from reebslice.mesh.half_edges import find_twins
from reebslice.mesh.orders import canonical_faces
from reebslice.morse.height_mesh import order_by_height
from reebslice.morse.reeb_graph import surface_reeb_graph
from reebslice.morse.unfolding import unfold_saddles
from reebslice.slicing import tables
from reebslice.slicing.contours import measure_contours, trace_blocks, trace_contours, trace_crossings
from reebslice.slicing.graph_slices import contours_of_arcs
from reebslice.slicing.levels import make_levels, uniform_heights, vertex_slabs
from reebslice.slicing.pairing import pair_in_slabs
from reebslice.slicing.slices import cut_surface, nested_blocks, nested_contours

some = settings(max_examples=30, deadline=None, derandomize=True)
cases = given(solids.any_solids(), st.integers(0, 3), st.integers(1, 12))


def sliced(solid, seed, count):
    rotation = np.eye(3) if seed == 0 else solids.rotation(seed)
    mesh = unfold_saddles(order_by_height(solid.points, solid.faces, rotation))
    low, high = mesh.points[[0, -1], 2]
    return mesh, make_levels(mesh, uniform_heights(low, high, (high - low) / count))


def slow_contours(mesh, below):
    """Contours between the ranks below - 1 and below: lists of (face, lower rank, upper rank), in order."""
    following, face_of = {}, {}
    for number, face in enumerate(mesh.faces.tolist()):
        up = down = None
        for tail, head in zip(face, face[1:] + face[:1]):
            if tail < below <= head:
                up = (tail, head)
            if head < below <= tail:
                down = (head, tail)
        if up:
            following[down], face_of[up] = up, number
    contours = []
    for start in sorted(face_of, key=face_of.get):
        contour = []
        while start in following:
            start = following.pop(start)
            contour.append((face_of[start], *start))
        if contour:
            contours.append(contour[-1:] + contour[:-1])  # the first popped comes after the start
    return contours


@cases
@some
def test_contours_follow_the_faces(solid, seed, count):
    mesh, levels = sliced(solid, seed, count)
    contours, crossings = trace_crossings(mesh, levels)
    slow = [(k, ring) for k, below in enumerate(levels.below.tolist()) for ring in slow_contours(mesh, below)]
    assert contours.level.tolist() == [k for k, _ in slow]
    assert np.diff(contours.start).tolist() == [len(ring) for _, ring in slow]
    assert list(zip(contours.lower.tolist(), contours.upper.tolist())) == [ring[0][1:] for _, ring in slow]
    assert mesh.faces.ravel()[contours.first].tolist() == contours.lower.tolist()
    low, high = (np.array([edge[end] for _, ring in slow for edge in ring], int) for end in (1, 2))
    z = np.repeat(levels.height[contours.level], np.diff(contours.start))
    (p, q), rise = (mesh.points[low], mesh.points[high]), mesh.points[high, 2] - mesh.points[low, 2]
    steep = rise > 1e-6
    share = ((z - p[:, 2])[steep] / rise[steep])[:, None]
    expected = p[steep] + share * (q - p)[steep]
    np.testing.assert_allclose(contours.points[steep], expected[:, :2], atol=1e-9)
    lowest = vertex_slabs(mesh, levels)[mesh.faces[:, 0]]
    for number, (k, ring) in enumerate(slow):
        for face, *_ in ring:
            assert crossings.label[crossings.offset[face] + k - lowest[face]] == number
    assert len(crossings.label) == contours.start[-1]


@cases
@some
def test_nested_contours_are_those_of_the_whole_cut(solid, seed, count):
    mesh, levels = sliced(solid, seed, count)
    body = solids.connected_vertices(mesh) % 2
    slices = cut_surface(mesh, levels, body)
    for found, expected in zip(nested_contours(mesh, levels.height, body), (slices.contours, slices.regions)):
        for name, column in found._asdict().items():
            assert column.tolist() == getattr(expected, name).tolist(), name


@cases
@some
def test_blocks_are_the_whole_in_parts(solid, seed, count):
    mesh, levels = sliced(solid, seed, count)
    contours, regions = nested_contours(mesh, levels.height)
    for most in (1, 40, 10**9):
        n_contours = n_regions = n_points = 0
        for block, nested in nested_blocks(mesh, levels.height, most):
            rows = slice(n_contours, n_contours + len(block.level))
            assert len(block.points) <= most or len(set(block.level.tolist())) == 1
            assert (block.points == contours.points[n_points : n_points + len(block.points)]).all()
            assert (block.start + n_points == contours.start[rows.start : rows.stop + 1]).all()
            for name in ("level", "first", "lower", "upper"):
                assert (getattr(block, name) == getattr(contours, name)[rows]).all()
            assert (nested.of_contour + n_regions == regions.of_contour[rows]).all()
            assert (np.where(nested.parent < 0, -1, nested.parent + n_contours) == regions.parent[rows]).all()
            outer = regions.outer[n_regions : n_regions + len(nested.outer)]
            assert (nested.outer + n_contours == outer).all()
            assert (nested.level == regions.level[n_regions : n_regions + len(nested.level)]).all()
            n_contours, n_regions, n_points = rows.stop, n_regions + len(nested.level), n_points + len(block.points)
        assert (n_contours, n_regions) == (len(contours.level), len(regions.level))
        assert n_points == len(contours.points)


def test_many_contours_of_a_level_nest_as_they_were_made():
    spot = 10.0 * np.argwhere(np.ones((6, 6)))
    shells = [solids.move(solids.nested_shells(1 + i % 4), (x, y, 0.0)) for i, (x, y) in enumerate(spot)]
    wide = solids.icosphere(3, 120.0)
    mesh, _ = sliced(solids.unite(wide, solids.carve(solids.scale(wide, 0.9)), *shells), 0, 1)
    contours, regions = nested_contours(mesh, [0.01])
    first = contours.start[:-1]
    size = np.abs(measure_contours(contours)[0])
    depth = np.zeros(len(size), int)
    for c in np.argsort(-size):
        depth[c] = 0 if regions.parent[c] < 0 else depth[regions.parent[c]] + 1
    assert len(size) == 2 + sum(1 + i % 4 for i in range(36))
    assert regions.inner.tolist() == (depth % 2 == 1).tolist()
    small = size < 100
    assert sorted(depth[~small]) == [0, 1]
    for i, (x, y) in enumerate(spot):
        near = small & (np.hypot(*(contours.points[first] - (x, y)).T) < 5)
        assert sorted(depth[near]) == [2 + k for k in range(1 + i % 4)]


def test_no_levels_give_no_contours():
    mesh, _ = sliced(solids.icosphere(1), 0, 1)
    assert trace_contours(mesh, make_levels(mesh, [])).start.tolist() == [0]
    assert [len(block.level) for block in trace_blocks(mesh, make_levels(mesh, []), 10)] == [0]


def test_items_are_split_into_blocks_of_bounded_size():
    blocks = list(split_into_blocks(np.cumsum([0, 3, 3, 9, 1, 1, 0, 5]), 7))
    assert blocks == [(0, 2), (2, 3), (3, 7)]
    assert list(split_into_blocks(np.array([0]), 7)) == [(0, 0)]


def age(vertex, upward):
    """What sorts before is older; no vertex is older than any."""
    return vertex is not None, (vertex or 0) if upward else -(vertex or 0)


def slow_pairs(mesh, levels):
    """Partners by the elder rule, told from all mesh edges of a slab and the contours that these run through."""
    contours, crossings = trace_crossings(mesh, levels)
    slab = vertex_slabs(mesh, levels)

    def contour_across(face, level):
        return "contour", int(crossings.label[crossings.offset[face] + level - slab[mesh.faces[face, 0]]])

    partner = np.full(len(slab), -1)
    for upward in (True, False):
        beside = [[] for _ in slab]
        for f, face in enumerate(mesh.faces.tolist()):
            for a, b in zip(face, face[1:] + face[:1]):
                early, late = (min(a, b), max(a, b)) if upward else (max(a, b), min(a, b))
                level = slab[late] - 1 if upward else slab[late]
                beside[late].append(early if slab[early] == slab[late] else contour_across(f, level))
        part_of, eldest = {}, {}  # of a vertex or contour: its part, a set; of a part: its oldest vertex, if born here
        for v in range(len(slab)) if upward else reversed(range(len(slab))):
            part_of[v] = own = frozenset([v])
            eldest[own] = v
            for other in beside[v]:
                if other not in part_of:
                    part_of[other] = frozenset([other])
                    eldest[part_of[other]] = None
            while others := [part_of[other] for other in beside[v] if part_of[other] is not part_of[v]]:
                parts = sorted((others[0], part_of[v]), key=lambda part: age(eldest[part], upward))
                born = eldest[parts[1]]
                if born is not None and born != v:
                    partner[born], partner[v] = v, born
                union = parts[0] | parts[1]
                eldest[union] = eldest[parts[0]]
                part_of.update(dict.fromkeys(union, union))
    return partner


@given(st.one_of(solids.blobs(), solids.terrains(), solids.voxel_solids()), st.integers(0, 2), st.integers(1, 6))
@settings(max_examples=20, deadline=None, derandomize=True)
def test_pairs_follow_the_elder_rule(solid, seed, count):
    mesh, levels = sliced(solid, seed, count)
    graph, (_, crossings) = surface_reeb_graph(mesh), trace_crossings(mesh, levels)
    partner = pair_in_slabs(graph, contours_of_arcs(mesh, graph, levels, crossings))
    found = np.full(len(mesh.points), -1)
    found[graph.nodes] = np.where(partner < 0, -1, graph.nodes[partner])
    assert found.tolist() == slow_pairs(mesh, levels).tolist()


@pytest.mark.parametrize("spokes", [3, 8, 500])
def test_faces_around_one_vertex_are_sorted_however_many(spokes):
    mesh = solids.permute(fan(spokes), 3)
    rank = np.random.default_rng(1).permutation(len(mesh.points))
    faces = canonical_faces(mesh.faces, rank)
    turned = [min(tuple(face[k:] + face[:k]) for k in range(3)) for face in rank[mesh.faces].tolist()]
    assert list(map(tuple, faces.tolist())) == sorted(turned)
    half_edges = [(face[k], face[(k + 1) % 3]) for face in faces.tolist() for k in range(3)]
    place = {half_edge: h for h, half_edge in enumerate(half_edges)}
    assert find_twins(faces, len(rank)).tolist() == [place[head, tail] for tail, head in half_edges]


def fan(spokes):
    """Two cones on one base."""
    turn, i = 2 * np.pi * np.arange(spokes) / spokes, np.arange(spokes)
    points = np.vstack([np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]), [[0, 0, -1], [0, 0, 1]]])
    lower = np.column_stack([np.roll(i, -1), i, np.full(spokes, spokes)])
    upper = np.column_stack([i, np.roll(i, -1), np.full(spokes, spokes + 1)])
    return solids.Solid(points, np.vstack([lower, upper]))


@pytest.mark.parametrize("faces", [[[0, 1, 2], [0, 2, 1], [0, 1, 3], [0, 3, 1]], [[0, 1, 2], [0, 1, 2], [2, 1, 0]]])
def test_twins_refuse_mesh_edges_of_many_faces(faces):
    with pytest.raises(ValueError, match="not closed and oriented"):
        find_twins(np.array(faces), 4)


def test_contours_are_written_block_by_block(monkeypatch, tmp_path):
    mesh, levels = sliced(solids.csg(3), 1, 9)
    shell = solids.connected_vertices(mesh)
    slices = cut_surface(mesh, levels, shell)
    whole = tables.contours_table(mesh, slices, shell)
    monkeypatch.setattr(tables, "POINTS_AT_ONCE", 30)
    blocks = list(tables.contours_blocks(mesh, slices, shell))
    assert len(blocks) > 3 and pa.concat_tables(blocks).equals(whole)
    write_blocks(tmp_path / "contours.parquet", "contours", blocks)
    assert read_table(tmp_path / "contours.parquet", "contours").equals(whole)
    geometry = list(read_blocks(tmp_path / "contours.parquet", "contours", "geometry"))
    assert len(geometry) == len(blocks) and pa.chunked_array(geometry).equals(whole["geometry"])
