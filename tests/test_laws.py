"""The library against the slow reference, and laws that hold whatever the solid."""

import itertools
import math
import tempfile
from collections import Counter
from functools import cached_property

import networkx as nx
import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, assume, given, settings
from hypothesis import strategies as st

import pipeline
import reference
import solids
from reebslice.morse.height_mesh import height_mesh
from reebslice.schemas import EVENTS

pytestmark = pytest.mark.skipif(bool(pipeline.missing_stages()), reason=f"no stages {pipeline.missing_stages()}")

LAX = [HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large]


def cases(count):
    """So many solids, the same in every run; not shrunk, which can take minutes, as they are small."""
    phases = (Phase.explicit, Phase.generate)
    return settings(
        max_examples=count, phases=phases, deadline=None, derandomize=True, suppress_health_check=LAX, database=None
    )


def run(solid, **sections):
    with tempfile.TemporaryDirectory() as folder:
        return pipeline.run_stages(solid, folder, **sections)


class Comparison:
    """One result beside the reference's answers for the same surface, at the same levels.

    A level that runs between the parts of an unfolded multiple saddle has no
    counterpart in the reference: such levels are left out (`kept` are the others), and the
    slabs and vertices next to them are not compared in full.
    """

    def __init__(self, result):
        self.result = result
        self.states = {}
        try:
            self.surface, self.solid = reference.sweep(result.points, result.faces, states=self.states)
        except reference.Ambiguous:
            assume(False)
        self.order = reference.order_vertices(result.points)
        changes = dict(self.surface.nodes(data="changes"))
        self.copies = {v: max(1, changes.get(v, 0) // 2 - 1) for v in self.order}
        unfolded = np.cumsum([0] + [self.copies[v] for v in self.order]).tolist()
        below = [(row["level"], row["vertices_below"]) for row in result.levels]
        self.cut = {level: unfolded.index(n) for level, n in below if n in unfolded}
        self.kept = sorted(self.cut)
        inside = [n for level, n in below if level not in self.cut]
        self.parted = {self.order[int(np.searchsorted(unfolded, n)) - 1] for n in inside}

    def is_parted(self, group):
        """Whether a level that was left out runs through a group of critical points, or beside it."""
        places = [self.order.index(v) for v in group.vertices]
        return any(min(places) <= self.order.index(v) <= max(places) for v in self.parted)

    @cached_property
    def aboves(self):
        return {level: set(self.order[self.cut[level] :]) for level in self.kept}

    @cached_property
    def contours(self):
        """{contour id: its mesh edges}, found by the mesh edge that the table gives."""
        walked = {level: reference.walk_contours(self.result.faces, self.aboves[level]) for level in self.kept}
        named = {}
        for level, rows in self.rows_at.items():
            for row in rows:
                anchor = (row["lower_vertex"], row["upper_vertex"])
                (named[row["contour"]],) = (c for c in walked[level] if anchor in c)
            assert len({named[row["contour"]] for row in rows}) == len(rows)
        assert all(len(self.rows_at[level]) == len(walked[level]) for level in self.kept)
        return named

    @cached_property
    def pieces(self):
        return reference.find_pieces(self.result.faces, [self.aboves[level] for level in self.kept])

    @cached_property
    def rows_at(self):
        """{kept level: rows of its contours}."""
        rows = {level: [] for level in self.kept}
        for row in self.result.contours:
            if row["level"] in rows:
                rows[row["level"]].append(row)
        return rows

    def slabs(self):
        """Slabs between two kept levels that follow each other: {slab: its number among kept levels}."""
        ends = [-1, *self.kept, len(self.result.levels)]
        return {low: k - 1 for k, (low, high) in enumerate(itertools.pairwise(ends)) if high == low + 1}


# --------------------------------------------------------------------------
# Levels, contours, regions, pieces


def check_levels(c):
    heights = [row["height"] for row in c.result.levels]
    assert heights == sorted(heights)
    for level in c.kept:
        row = c.result.levels[level]
        z, tie = row["height"], (row["tie_x"], row["tie_y"])
        above = {v for v, p in enumerate(c.result.points) if p[2] > z}
        if tie[0] is not None:
            above |= {v for v, p in enumerate(c.result.points) if p[2] == z and p[:2] > tie}
        assert above == c.aboves[level]
        regions = c.states[c.cut[level]]
        assert row["n_regions"] == len(regions) and row["n_contours"] == sum(map(len, regions))


def check_contours(c):
    rows = [row for level in c.kept[:: 1 + len(c.kept) // 20] for row in c.rows_at[level]]
    points = [tuple(map(reference.Fraction, p)) for p in c.result.points]
    scale = max(abs(x) for p in c.result.points for x in p)
    simple = max(c.copies.values()) == 1
    for row in rows:
        contour = c.contours[row["contour"]]
        if simple:
            assert row["n_points"] == len(contour)
        if c.result.levels[row["level"]]["tie_x"] is None:
            height = reference.Fraction(row["height"])
            corners = reference.locate_contour(contour, [p[2] for p in points], height, points)
            assert row["signed_area"] == pytest.approx(float(reference.measure_area(corners)), abs=1e-9 * scale**2)
            lengths = np.hypot(*np.subtract(np.array(corners[1:] + corners[:1], float), np.array(corners, float)).T)
            assert row["perimeter"] == pytest.approx(lengths.sum(), rel=1e-7, abs=1e-9 * scale)


def check_regions(c):
    for level in c.kept:
        found = {}
        for row in c.rows_at[level]:
            found.setdefault(row["region"], set()).add((frozenset(c.contours[row["contour"]]), row["inner"]))
        assert all(sum(not inner for _, inner in region) == 1 for region in found.values())
        assert {frozenset(contour for contour, _ in region) for region in found.values()} == c.states[c.cut[level]]


def check_parted(c):
    """Levels between the parts of a multiple saddle: their contours touch there but do not cross; their regions."""
    if not c.parted:
        return
    vertices = np.array([[row[axis] for axis in "xyz"] for row in c.result.vertices])
    mesh = height_mesh(vertices, np.array(c.result.faces), c.result.tilt["rotation"])
    origin, faces = mesh.vertex.tolist(), [tuple(face) for face in mesh.faces.tolist()]
    order = {(face[k], face[(k + 1) % 3]): (f, k) for f, face in enumerate(faces) for k in range(3)}
    heights, exact = reference.tilt_slightly(c.result.points)
    for row in c.result.levels:
        if row["level"] in c.cut:
            continue
        walked = reference.walk_contours(faces, set(range(row["vertices_below"], len(origin))))
        walked.sort(key=lambda contour: min(order[edge] for edge in contour))
        saddle = origin[row["vertices_below"]]
        assert saddle == origin[row["vertices_below"] - 1]
        spot = exact[saddle][:2]
        curves = [reference.locate_touching(contour, origin, saddle, heights, exact) for contour in walked]
        assert not reference.count_crossings(curves, spot)
        found = {}
        for contour, stated in enumerate(r for r in c.result.contours if r["level"] == row["level"]):
            found.setdefault(stated["region"], set()).add(contour)
        apart = {contour: reference.start_away(curve, spot) for contour, curve in enumerate(curves)}
        regions = reference.nest_contours(apart)
        assert sorted(map(sorted, found.values())) == sorted(map(sorted, regions.values()))


def check_pieces(c):
    slabs = c.slabs()
    expected = Counter()
    for piece in c.pieces:
        key = (frozenset(piece.below), frozenset(piece.above), piece.euler_characteristic, piece.genus, piece.kind)
        expected[(piece.slab, *key)] += 1
    found = Counter()
    for row in c.result.pieces:
        if row["slab"] in slabs:
            ends = (frozenset(frozenset(c.contours[name]) for name in row[side]) for side in ("below", "above"))
            found[(slabs[row["slab"]], *ends, row["euler_characteristic"], row["genus"], row["kind"])] += 1
    assert found == Counter({key: n for key, n in expected.items() if key[0] in slabs.values()})
    corners = np.array(c.result.points)[np.array(c.result.faces)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    area, volume = np.linalg.norm(normals, axis=1).sum(), (normals * corners[:, 0]).sum() / 3
    assert sum(row["area"] for row in c.result.pieces) == pytest.approx(area)
    assert sum(row["flux"] for row in c.result.pieces) == pytest.approx(volume)


def check_edges(c):
    """Regions are linked iff the solid between the two levels connects them."""
    region_of = {}
    for level, rows in c.rows_at.items():
        region_of |= {(level, frozenset(c.contours[row["contour"]])): row["region"] for row in rows}
    found = {(row["source"], row["target"]) for row in c.result.edges}
    level_of = [row["level"] for row in c.result.nodes]
    for slab, k in c.slabs().items():
        if slab in (-1, len(c.result.levels) - 1):
            continue
        links = nx.Graph()
        for number, piece in enumerate(piece for piece in c.pieces if piece.slab == k):
            for side, level, ends in (("low", slab, piece.below), ("high", slab + 1, piece.above)):
                links.add_edges_from((("piece", number), (side, region_of[level, end])) for end in ends)
        expected = set()
        for block in nx.connected_components(links):
            ends = {side: {name for s, name in block if s == side} for side in ("low", "high")}
            expected |= {(low, high) for low in ends["low"] for high in ends["high"]}
        assert {pair for pair in found if level_of[pair[0]] == slab} == expected


# --------------------------------------------------------------------------
# Handles and graphs


def check_handles(c, resolved):
    """Handles are the critical points that do not cancel between levels, each with its event."""
    groups = reference.group_by_levels(c.surface, [c.cut[level] for level in c.kept])
    essential = reference.find_essential(c.surface, groups)
    handles = {}
    for row in c.result.handles:
        handles.setdefault(row["vertex"], []).append(row)
    assert handles.keys() <= set(c.surface), "a handle at a regular vertex"
    for group in groups:
        if c.is_parted(group):
            continue
        rows = [row for v in group.vertices for row in handles.get(v, [])]
        left = Counter({v: essential[v] for v in group.vertices if v in essential})
        assert Counter(row["vertex"] for row in rows) == left
        assert all(row["index"] == c.surface.nodes[row["vertex"]]["index"] for row in rows)
        if len(rows) == 1 and group.loops == 0:
            (row,) = rows
            side, index, _, _, _, operation = EVENTS[group.change]
            assert (row["change"], row["side"]) == (group.change, side)
            assert (row["index"], row["operation"]) == (index, operation)
            assert row["resolved"]
            continue
        assert not rows or not resolved
        for row in rows:
            assert row["change"] is None and not row["resolved"]
            event = c.surface.nodes[row["vertex"]]
            if event["change"] is not None:
                assert (row["side"], row["operation"]) == (event["side"], event["operation"])
    return essential


def check_blocks(c):
    """Handles share a block iff the material between two levels connects them; unseen voids too."""
    groups = reference.group_by_levels(c.solid, [c.cut[level] for level in c.kept])
    of_vertex = {v: k for k, group in enumerate(groups) for v in group.vertices if not c.is_parted(group)}
    pairs = {(of_vertex[row["vertex"]], row["block"]) for row in c.result.handles if row["vertex"] in of_vertex}
    assert len(pairs) == len({group for group, _ in pairs}) == len({block for _, block in pairs})


def check_graphs(c, essential):
    for name, graph in (("surface", c.surface), ("solid", c.solid)):
        groups = reference.group_by_levels(graph, [c.cut[level] for level in c.kept])
        dull = {k for k, group in enumerate(groups) if not group.vertices & essential.keys()}
        found = c.result.labelled(name)
        assert reference.contract_groups(found, groups, dull) == reference.contract_groups(graph, groups, dull)
        if all(len(group.vertices) == 1 for group in groups):
            assert reference.compare_graphs(found, graph, name == "surface") == []


def least_length(graph, name, row):
    """How long an arc is at least: the way between its ends, which of the solid lie in the material."""
    if name != "solid":
        return row["upper"] - row["lower"]
    joints = (row["source"], row["target"])
    ends = (graph.nodes[f"h{n}" if n >= 0 else f"b{-1 - n}"] for n in joints)
    return math.dist(*([end[axis] for axis in "xyz"] for end in ends))


def check_arcs(c):
    """The table and the drawing file tell the same, and measures add up."""
    for name in ("surface", "solid", "void"):
        rows = [row for row in c.result.arcs if row["graph"] == name]
        graph = c.result.graphs[name]
        # the outside goes on below all, -1, and above all, -2
        ends = ([f"h{n}" if n >= 0 else f"b{-1 - n}" for n in (row["source"], row["target"])] for row in rows)
        assert Counter(map(frozenset, ends)) == Counter(map(frozenset, graph.edges()))
        long = [row for row in rows if name != "void" or row["nodes"]]
        assert all(row["length"] * (1 + 1e-9) >= least_length(graph, name, row) >= 0 for row in long)
        assert all(row["upper"] >= row["lower"] for row in long)
        assert all(row["length"] is None and row["upper"] >= row["lower"] for row in rows if row not in long)
    for measure, name in (("volume", "solid"), ("area", "surface")):
        total = sum(row[measure] for row in c.result.shells)
        assert sum(row[measure] for row in c.result.arcs if row["graph"] == name) == pytest.approx(total)


def check_identities(result):
    genus = sum(row["genus"] for row in result.shells)
    assert genus == reference.count_loops(result.graphs["surface"]) + sum(row["genus"] for row in result.pieces)
    chi = sum(row["euler_characteristic"] for row in result.shells)
    assert chi == sum((-1) ** row["index"] for row in result.handles)
    assert chi == sum(row["euler_characteristic"] for row in result.pieces)
    loops = {name: reference.count_loops(graph) for name, graph in result.graphs.items()}
    # however it is sliced: at a height, solid and void are a tree
    assert loops["solid"] + loops["void"] == loops["surface"]
    assert nx.number_connected_components(result.graphs["void"]) == 1 + sum(row["void"] for row in result.shells)


def check_all(solid, refine, **sections):
    """Everything; `refine` of the levels. With "exact" nothing may stay unresolved."""
    result = run(solid, levels={"refine": refine, **sections.pop("levels", {})}, **sections)
    check_identities(result)
    c = Comparison(result)
    check_levels(c)
    check_contours(c)
    check_regions(c)
    check_parted(c)
    check_pieces(c)
    check_edges(c)
    essential = check_handles(c, resolved=refine == "exact")
    check_blocks(c)
    if refine == "exact":
        check_graphs(c, essential)
        check_arcs(c)


FAMILIES = {
    "voxels": solids.voxel_solids(),
    "trusses": solids.trusses(),
    "terrains": solids.terrains(4),
    "blobs": solids.blobs(),
    "nests": solids.nests(),
    "boxes": solids.csgs(balls=False),
    "boxes and balls": solids.csgs(),
}
TEXTBOOK = {
    "tetrahedron": solids.tetrahedron(),
    "cube": solids.cube(2),
    "icosphere": solids.icosphere(1),
    "lying torus": solids.torus(),
    "upright torus": solids.torus(upright=True),
    "plate": solids.plate(2),
    "upright plate": solids.plate(2, True),
    "hollow ball": solids.hollow_ball(),
    "ball in hollow ball": solids.ball_in_hollow_ball(),
    "hollow off the middle": solids.unite(
        solids.icosphere(1, 4.0), solids.carve(solids.move(solids.icosphere(), [1, 1, 2]))
    ),
    "linked rings": solids.linked_rings(),
    "monkey saddle": solids.monkey_saddle(3),
    "five petals": solids.monkey_saddle(5),
    "arch": solids.arch(),
    "bowl": solids.bowl_shape(),
    "overhang": solids.overhang(),
    "staircase": solids.staircase(),
    "cup": solids.cup(),
    "tunnel": solids.tunnel(),
    # Levels through a pit's lowest point, and along ridges, where contours are points or touch.
    "pit": solids.terrain([[0, 1, 0], [1, 0, 1], [0, 1, 0]]),
    "pit over a foot": solids.terrain([[0, 1, 0], [1, 0, 1], [0, 1, 0]], [[0, 0, 0], [0, 0, 0], [0, 0, 2]]),
    "ridges": solids.terrain([[0, 0, 0, 0], [4, 0, 4, 0], [0, 3, 0, 3], [0, 0, 3, 0]]),
}
# Among them some that make ties: then x and y of the tilted frame must break them.
directions = st.one_of(
    st.sampled_from([[1, 0, 0], [0, -1, 0], [0, 0, -1], [1, 1, 0], [1, 1, 1]]),
    solids.SEEDS.map(lambda seed: solids.rotation(seed)[2].tolist()),
)
spacings = st.sampled_from([1.0, 0.5, 0.25, 0.1])


@pytest.mark.parametrize("name", TEXTBOOK)
@pytest.mark.parametrize("distance", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("refine", ["exact", "none"])
def test_textbook_solids(name, refine, distance):
    check_all(TEXTBOOK[name], refine, levels={"distance": distance})


@pytest.mark.parametrize("family", FAMILIES)
def test_exact_levels_show_the_reference_graphs(family):
    @cases(16)
    @given(FAMILIES[family], spacings)
    def check(solid, distance):
        check_all(solid, "exact", levels={"distance": distance})

    check()


@pytest.mark.parametrize("family", FAMILIES)
def test_uniform_levels_show_the_reference_pieces(family):
    @cases(8)
    @given(FAMILIES[family], spacings)
    def check(solid, distance):
        check_all(solid, "none", levels={"distance": distance})

    check()


@pytest.mark.parametrize("family", FAMILIES)
def test_exact_levels_in_another_direction(family):
    @cases(8)
    @given(FAMILIES[family], directions)
    def check(solid, direction):
        check_all(solid, "exact", tilt={"mode": "direction", "direction": direction})

    check()


@cases(10)
@given(st.one_of(*FAMILIES.values()))
def test_exact_levels_in_the_selected_tilt(solid):
    check_all(solid, "exact", tilt={"mode": "auto"})


# --------------------------------------------------------------------------
# Laws


@cases(8)
@given(st.one_of(*FAMILIES.values()), solids.SEEDS)
def test_order_of_vertices_and_faces_changes_nothing(solid, seed):
    one, two = run(solid), run(solids.permute(solid, seed))
    for name in pipeline.TABLES:
        assert one.tables[name] == two.tables[name], name
    for name, graph in one.graphs.items():
        told = [(list(g.nodes(data=True)), list(g.edges(keys=True, data=True))) for g in (graph, two.graphs[name])]
        assert repr(told[0]) == repr(told[1]), name  # as NaN is not itself


def show_events(result, rename=lambda vertex: vertex):
    keys = ("index", "side", "operation", "change")
    return sorted((rename(row["vertex"]), *(str(row[key]) for key in keys)) for row in result.handles)


@cases(8)
@given(st.one_of(*FAMILIES.values()), st.sampled_from([0.5, 2.0, 1024.0]))
def test_scale_multiplies_lengths_and_nothing_else(solid, factor):
    one, two = run(solid), run(solids.scale(solid, factor))
    assert show_events(one) == show_events(two)
    for row, big in zip(one.contours, two.contours, strict=True):
        assert big["signed_area"] == factor**2 * row["signed_area"]
        assert big["region"] == row["region"] and big["parent"] == row["parent"]
    for name in ("surface", "solid"):
        assert reference.compare_graphs(two.labelled(name), one.labelled(name), name == "surface") == []


@cases(8)
@given(st.one_of(solids.voxel_solids(), solids.terrains(4)), st.tuples(*[st.integers(-64, 64)] * 3))
def test_shift_moves_handles_and_nothing_else(solid, by):
    levels = {"distance": 0.125, "units": "absolute"}
    one, two = run(solid, levels=levels), run(solids.move(solid, by), levels=levels)
    assert show_events(one) == show_events(two)
    for row, moved in zip(one.handles, two.handles, strict=True):
        assert [moved[axis] for axis in "xyz"] == [row[axis] + step for axis, step in zip("xyz", by)]
    for name in ("surface", "solid"):
        assert reference.compare_graphs(two.labelled(name), one.labelled(name), name == "surface") == []


@cases(8)
@given(solids.turned(st.one_of(solids.voxel_solids(), solids.trusses(), solids.nests(), solids.csgs(balls=False))))
def test_upside_down_swaps_minima_with_maxima_and_sides(solid):
    rank = {v: r for r, v in enumerate(reference.order_vertices(reference.as_points(solid.points)))}
    stars = {v: [tuple(face) for face in solid.faces.tolist() if v in face] for v in rank}
    assume(all(reference.count_sign_changes(v, star, rank) <= 4 for v, star in stars.items()))
    one, two = run(solid), run(solids.transform(solid, -np.eye(3)))
    last = len(one.points) - 1
    for name in ("surface", "solid"):
        summary = reference.summarize_graph(one.labelled(name), name == "surface")
        turned = reference.reverse_summary(summary, lambda vertex: last - vertex)
        assert turned == reference.summarize_graph(two.labelled(name), name == "surface")


@cases(8)
@given(st.one_of(*FAMILIES.values()), st.one_of(*FAMILIES.values()))
def test_disjoint_union_adds(one, two):
    def fit(solid):
        """Into the height range [0, 1], by steps that are the same for both."""
        low, high = solid.points[:, 2].min(), solid.points[:, 2].max()
        points = solid.points - [0, 0, low]
        return solids.Solid(points / [1, 1, high - low], solid.faces)

    one, two = fit(one), fit(two)
    two = solids.move(two, [np.ceil(one.points[:, 0].max() - two.points[:, 0].min()) + 1, 0, 0])
    results = [run(solid, levels={"refine": "none"}) for solid in (one, two, solids.unite(one, two))]
    first = len(results[0].points)
    for name in ("surface", "solid"):
        a, b, both = (result.labelled(name) for result in results)
        nx.set_node_attributes(b, {node: vertex + first for node, vertex in b.nodes(data="vertex")}, "vertex")
        added = nx.disjoint_union(a, b)
        for graph in (added, both):
            for _, data in graph.nodes(data=True):
                data.update(outer=data["outer"] or 0, inner=data["inner"] or 0)
        assert reference.compare_graphs(both, added, name == "surface") == []
