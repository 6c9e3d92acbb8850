"""The sliced Reeb graph of the void: against that of the surface turned inside out, and against floods of voxels."""

from collections import Counter
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

import networkx as nx
import numpy as np
import pyarrow as pa
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage

import make_examples
import pipeline
import solids
from certify import mesh_lengths
from corpus.storage import read_json, read_table
from corpus.surfaces import read_faces, read_points, read_rotation
from reebslice.certification.certificate import certify
from reebslice.graphs.arcs import trace_arcs
from reebslice.graphs.parts import surface_parts
from reebslice.graphs.void_graph import void_arcs, void_parts
from reebslice.graphs.voids import void_reeb_graph
from reebslice.handles.classification import classify_handles
from reebslice.morse.height_mesh import height_mesh
from reebslice.morse.reeb_graph import surface_reeb_graph
from reebslice.schemas import MODEL_TABLES, SCHEMAS
from reebslice.slicing.refinement import slice_surface
from reebslice.slicing.tables import contours_table, pieces_table
from test_laws import cases

BELOW, ABOVE = -1, -2


def cut(solid, rotation=None, distance=None, refine="exact"):
    """The tables of a solid, of one body whatever it is."""
    mesh = height_mesh(solid.points, solid.faces, np.eye(3) if rotation is None else rotation)
    nowhere = np.zeros(len(mesh.points), np.int32)
    slices, _ = slice_surface(mesh, nowhere, distance or np.ptp(mesh.points[:, 2]) / 4, refine)
    contours, pieces = contours_table(mesh, slices, nowhere), pieces_table(mesh, slices, nowhere)
    handles = classify_handles(mesh, surface_reeb_graph(mesh), solid.points, pieces, contours)
    return SimpleNamespace(contours=contours, pieces=pieces, handles=handles)


def sliced_graph(tables):
    """(vertex, height) of the nodes, -1 and infinite where the outside goes on, and pairs of places of the arcs."""
    walls = trace_arcs(surface_parts(tables.pieces, tables.handles))
    centres = np.zeros((len(tables.contours), 3))
    columns, joints = void_arcs(tables.pieces, tables.contours, tables.handles, centres, walls)
    return name_nodes(tables.handles, joints, zip(columns["source"], columns["target"]))


def name_nodes(handles, joints, ends):
    vertex, height = (handles[name].to_pylist() for name in ("vertex", "height"))
    ends_of_outside = {BELOW: (-1, -np.inf), ABOVE: (-1, np.inf)}
    place = {joint: k for k, joint in enumerate(joints)}
    nodes = [ends_of_outside[h] if h < 0 else (vertex[h], height[h]) for h in joints]
    return nodes, [(place[a], place[b]) for a, b in ends]


def exact_graph(points, faces, rotation=None):
    graph = void_reeb_graph(points, faces, rotation)
    return list(zip(graph.vertex.tolist(), graph.height.tolist())), graph.arcs.tolist()


def contract(nodes, arcs, together):
    """The graph with the ends of each arc that is `together` as one, and without nodes that have one arc either way."""
    groups = nx.utils.UnionFind(range(len(nodes)))
    for pair in filter(together, arcs):
        groups.union(*pair)
    graph = nx.MultiGraph()
    graph.add_nodes_from((groups[k], {"label": label, "height": label[1]}) for k, label in enumerate(nodes))
    graph.add_edges_from((groups[a], groups[b]) for a, b in arcs if groups[a] != groups[b])
    for node in list(graph):
        ends = [other for _, other in graph.edges(node)]
        if len(ends) == 2 and np.prod([graph.nodes[e]["height"] - graph.nodes[node]["height"] for e in ends]) < 0:
            graph.remove_node(node)
            graph.add_edge(*ends)
    graph.remove_nodes_from([node for node, degree in list(graph.degree) if degree == 0])
    return graph


def labelled(nodes, arcs):
    """Ends of the arcs by vertices, parts of one saddle as one node."""
    graph = contract(nodes, arcs, lambda pair: nodes[pair[0]] == nodes[pair[1]])
    return Counter(tuple(sorted(graph.nodes[end]["label"] for end in pair)) for pair in graph.edges())


def same_by_heights(one, other):
    """Whether graphs are the same once what is at one height is one node, as order inside flats makes and unmakes."""
    graphs = [contract(n, a, lambda pair, n=n: n[pair[0]][1] == n[pair[1]][1]) for n, a in (one, other)]
    return nx.is_isomorphic(*graphs, node_match=lambda a, b: a["height"] == b["height"])


# --------------------------------------------------------------------------
# Against the surface turned inside out, in a box


@cases(45)
@given(solids.any_solids(), st.integers(0, 5))
def test_exact_slices_show_the_graph_of_the_surface_turned_inside_out(solid, seed):
    rotation = solids.rotation(seed)
    found = sliced_graph(cut(solid, rotation))
    assert labelled(*found) == labelled(*exact_graph(solid.points, solid.faces, rotation))


@cases(25)
@given(st.one_of(solids.voxel_solids((3, 4, 4)), solids.trusses(), solids.terrains(), solids.flat_solids()))
def test_flats_show_it_too(solid):
    assert same_by_heights(sliced_graph(cut(solid)), exact_graph(solid.points, solid.faces))


@pytest.fixture(scope="module")
def examples(tmp_path_factory):
    folder = tmp_path_factory.mktemp("examples")
    make_examples.main(folder)
    return folder


@pytest.mark.parametrize("name", make_examples.EXPECTED)
def test_the_examples_have_the_graph_that_their_meshes_have(name, examples, tmp_path):
    pipeline.run_mesh(examples / name, tmp_path, tilt={"mode": "auto"})
    handles, arcs = (read_table(tmp_path / f"{table}.parquet", table) for table in ("handles", "arcs"))
    ends = [(row["source"], row["target"]) for row in arcs.to_pylist() if row["graph"] == "void"]
    found = name_nodes(handles, dict.fromkeys(end for pair in ends for end in pair), ends)
    expected = exact_graph(read_points(tmp_path), read_faces(tmp_path), read_rotation(tmp_path))
    assert same_by_heights(found, expected) and len(found[1]) >= 1 + make_examples.EXPECTED[name][1]


# --------------------------------------------------------------------------
# Against floods of voxels


def flood(layers):
    """Name the components of the empty cells of a stack of layers, from 1."""
    return ndimage.label(layers)[0]


def blocks_by_flood(empty):
    """Of every slab between the middles of neighbouring layers: {(components in the lower one, in the upper one)}."""
    flat = [flood(empty[:, :, [k]])[:, :, 0] for k in range(empty.shape[2])]
    slabs = []
    for low in range(len(flat) - 1):
        both = flood(empty[:, :, low : low + 2])
        members = [
            [frozenset(np.unique(flat[low + k][both[:, :, k] == part]).tolist()) for k in (0, 1)]
            for part in range(1, both.max() + 1)
        ]
        slabs.append(set(map(tuple, members)))
    return flat, slabs


def regions_of_layers(flat, contours, blocks):
    """{region of the void: (layer, component)}: of each component the smallest contour around one of its cells."""
    rings = shapely.from_wkb(contours["geometry"].to_pylist())
    filled = np.array([shapely.Polygon(shapely.get_coordinates(ring)) for ring in rings])
    level, region = contours["level"].to_numpy(), blocks.region
    named = {}
    for layer, components in enumerate(flat):
        for component in range(1, components.max() + 1):
            cell = np.argwhere(components == component)[0] - 0.5  # of the cells a border was added around
            around = np.flatnonzero((level == layer - 1) & shapely.contains_xy(filled, *cell))
            smallest = around[np.argmin(shapely.area(filled[around]))] if len(around) else None
            item = len(blocks.hole) + layer if smallest is None else region[smallest]
            assert smallest is None or contours["inner"][int(smallest)].as_py()
            assert item not in named
            named[item] = layer, component
    return named


@cases(40)
@given(st.integers(1, 2**48 - 1), st.integers(0, 3), st.booleans())
def test_blocks_of_the_void_are_those_of_a_flood(bits, diagonals, inverted):
    filled = np.array([bits >> k & 1 for k in range(48)], bool).reshape(4, 4, 3)
    grid = solids.fill_pinches(filled)
    grid = grid[tuple(slice(c.min(), c.max() + 1) for c in np.nonzero(grid))]
    grid = ~np.pad(grid, 1) if inverted else grid
    tables = cut(solids.voxels(grid, diagonals), distance=1.0, refine="none")
    assert np.allclose(np.unique(tables.contours["height"]) % 1, 0.5)
    flat, slabs = blocks_by_flood(np.pad(~grid, 1, constant_values=True))
    void = void_parts(tables.pieces, tables.contours, tables.handles)
    named = regions_of_layers(flat, tables.contours, void.blocks)
    assert len(named) == len(void.blocks.above), "contours - regions + 1 of them at each level"
    found = [set() for _ in slabs]
    unseen = 0
    for low, high in zip(void.parts.below, void.parts.above):
        members = [frozenset(named[item][1] for item in side) for side in (low, high)]
        layers = {named[item][0] - k for k, side in enumerate((low, high)) for item in side}
        unseen += not layers
        if layers and -1 not in layers and len(slabs) not in layers:  # not below or above all
            found[layers.pop()].add(tuple(members))
    assert found == slabs and unseen == 0


# --------------------------------------------------------------------------
# What the files tell


def run(solid, folder, **sections):
    """Result, tables and certificate of a solid."""
    result = pipeline.run_stages(solid, folder, **sections)
    tables = {name: read_table(f"{folder}/{name}.parquet", name) for name in MODEL_TABLES}
    return result, tables, certificate(folder, tables, result.graphs, **sections.get("levels", {}))


def certificate(folder, tables, graphs, **levels):
    tilt, told = (read_json(f"{folder}/{name}.json") for name in ("tilt", "inspection"))
    lengths = mesh_lengths(tables["vertices"], tilt, pipeline.OPTIONS["levels"] | levels)
    return certify(tables, tilt, pipeline.as_read(graphs), *lengths, inspection=told)


def void_rows(result):
    return [row for row in result.arcs if row["graph"] == "void"]


@pytest.mark.parametrize(
    ("solid", "nodes", "loops"),
    [
        (solids.cube(), 2, 0),
        (solids.torus(upright=True), 2, 0),
        (solids.torus(), 4, 1),
        (solids.plate(3), 8, 3),
        (solids.cup(), 4, 0),
        (solids.nested_shells(4), 6, 0),
        (solids.linked_rings(), 4, 1),
    ],
    ids=["cube", "ring on edge", "lying ring", "plate", "cup", "nested shells", "linked rings"],
)
def test_textbook_solids_have_the_void_that_they_should(solid, nodes, loops, tmp_path):
    result, _, found = run(solid, tmp_path)
    graph = result.graphs["void"]
    assert (len(graph), found["loops_void"]) == (nodes, loops)
    assert found["loops_void"] + found["loops_solid"] == found["loops_surface"] == found["genus"]
    assert nx.number_connected_components(graph) == 1 + found["voids"]
    assert (found["verdict"], found["void_verdict"], found["void_reason"]) == ("exact", "exact", "")
    assert all(result.graphs["surface"].nodes[n] | d == result.graphs["surface"].nodes[n] for n, d in events(graph))


def events(graph):
    """Nodes that are handles, without what is about the void: the count of what they stand for, that they branch."""
    return [
        (node, {k: v for k, v in data.items() if k not in ("n_handles", "branches")})
        for node, data in graph.nodes(data=True)
        if node[0] == "h"
    ]


def test_the_outside_goes_on_below_and_above_all(tmp_path):
    result, _, _ = run(solids.torus(), tmp_path, tilt={"mode": "direction", "direction": [0.1, 0.2, 0.97]})
    rows, graph = void_rows(result), result.graphs["void"]
    heights = [row["height"] for row in result.handles]
    assert [row["lower"] for row in rows if row["source"] == BELOW] == [min(heights)]
    assert [row["upper"] for row in rows if row["target"] == ABOVE] == [max(heights)]
    assert {graph.degree("b0"), graph.degree("b1")} == {1}
    assert (graph.nodes["b0"]["height"], graph.nodes["b1"]["height"]) == (min(heights), max(heights))
    outside = [row for row in rows if not row["nodes"]]
    assert len(outside) == 3 and all(row["length"] is row["volume"] is None for row in outside)
    (through,) = (row for row in rows if row["nodes"])
    inner = {row["contour"]: row["inner"] for row in result.contours}
    assert (
        all(inner[contour] for contour in through["nodes"]) and through["length"] >= through["upper"] - through["lower"]
    )
    walls = {row["arc"]: row for row in result.arcs if row["graph"] == "surface"}
    assert [set(walls[arc]["nodes"]) == set(through["nodes"]) for arc in through["bounds"]] == [True]
    assert {data["outside"] for *_, data in graph.edges(data=True)} == {True, False}


def test_volumes_of_sealed_voids_are_what_their_walls_leave(tmp_path):
    result, _, _ = run(solids.nested_shells(4, 2), tmp_path)
    volumes = sorted(row["volume"] for row in void_rows(result) if row["nodes"])
    outer, first, second, core = (row["volume"] for row in sorted(result.shells, key=lambda row: -abs(row["volume"])))
    assert outer > -first > second > -core > 0
    assert volumes == pytest.approx([-core, -first - second])


def test_arcs_are_bounded_by_the_walls_of_their_holes_and_of_what_is_in_them(tmp_path):
    result, _, _ = run(solids.ball_in_hollow_ball(), tmp_path)
    outside, sealed = void_rows(result)
    walls = {row["arc"]: row for row in result.arcs if row["graph"] == "surface"}
    shell = {row["contour"]: row["shell"] for row in result.contours}
    void = next(row["shell"] for row in result.shells if row["void"])
    ball = next(row["shell"] for row in result.shells if row["parent"] == void)
    assert [shell[walls[arc]["nodes"][0]] for arc in sealed["bounds"]] == [void, ball]
    assert len(outside["bounds"]) == 1


@pytest.mark.parametrize(
    ("solid", "says"),
    [
        (solids.unite(solids.torus(), solids.move(solids.torus(), [1, 1, 0.2])), "share material"),
        (solids.unite(solids.icosphere(2, 3.0), solids.icosphere(1)), "share material"),
    ],
    ids=["bodies that cross", "a body inside another"],
)
def test_no_void_is_told_of_where_contours_do_not_tell(solid, says, tmp_path):
    result, tables, found = run(solid, tmp_path)
    assert void_rows(result) == [] and len(result.graphs["void"]) == 0
    assert found["verdict"] == "exact" and [n for n, check in found["checks"].items() if not check["holds"]] == []
    assert found["void_verdict"] == "uncertified" and says in found["void_reason"]
    invented = result.graphs["void"].copy()
    invented.add_node("b0", height=0.0)
    assert certificate(tmp_path, tables, result.graphs | {"void": invented})["verdict"] == "uncertified"


@pytest.mark.parametrize("method", ["similarity", "proximity"])
def test_links_that_are_guessed_leave_open_what_is_void(method, tmp_path):
    result = pipeline.run_stages(solids.torus(), tmp_path, edges={"method": method})
    assert void_rows(result) == [] and len(result.graphs["void"]) == 0


# --------------------------------------------------------------------------
# Levels that leave events together


def two_rings(apart):
    """Two rings, one a little higher along (0.1, 0.2, 0.97): only the void needs levels between their events."""
    return solids.unite(solids.torus(), solids.move(solids.torus(), [9.7, 0.0, apart - 1.0]))


@pytest.mark.parametrize(("refine", "verdict"), [("none", "uncertified"), ("feature", "exact"), ("exact", "exact")])
def test_events_of_the_outside_are_told_apart_by_levels_between_them(refine, verdict, tmp_path):
    tilt, levels = {"mode": "direction", "direction": [0.1, 0.2, 0.97]}, {"distance": 0.2, "feature_size": 0.2}
    result, _, found = run(two_rings(0.1), tmp_path, tilt=tilt, levels=levels | {"refine": refine})
    assert found["verdict"] == "exact" and found["void_verdict"] == verdict
    assert found["loops_void"] == 2  # whatever is told apart
    counts = [n for node, n in result.graphs["void"].nodes(data="n_handles") if node[0] == "h"]
    assert sum(counts) == 4 and (max(counts) == 1) == (refine != "none")
    assert found["unresolved_void_blocks"] == sum(n > 1 for n in counts)


def test_what_is_closed_within_a_slab_is_told_or_passed(tmp_path):
    """A hollow box with a ball in it, and a small hollow in its floor: both between two levels."""
    tiny = solids.icosphere(1, 0.05)
    hollow = solids.nest(solids.box(4, 4, 10), solids.box(3, 3, 8), solids.move(tiny, [0.2, 0.1, 0.27]))
    pit = solids.carve(solids.move(tiny, [0.2, 0.1, -4.75]))
    levels = {"distance": 0.1, "refine": "none"}
    result, _, found = run(solids.unite(hollow, pit), tmp_path, levels=levels)
    assert found["unseen"] == 2 and [n for n, check in found["checks"].items() if not check["holds"]] == []
    graph, rows = result.graphs["void"], void_rows(result)
    assert nx.number_connected_components(graph) == 3, "the outside, the hollow and the small one, a node alone"
    assert [row["volume"] for row in rows if row["nodes"]] == [None], "the ball is not taken off"
    floats = next(
        row["shell"] for row in result.shells if row["volume"] == pytest.approx(4 / 3 * np.pi * 0.05**3, rel=0.3)
    )
    inside = {row["handle"] for row in result.handles if result.pieces[row["piece"]]["shell"] == floats}
    assert inside and not {f"h{handle}" for handle in inside} & set(graph)


# --------------------------------------------------------------------------
# Lies that table and graph tell alike


def trade_ends(rows, graph):
    """Two arcs of the void, of holes, trade their upper ends."""
    one, two = [row for row in rows if row["graph"] == "void" and row["nodes"]][:2]
    for row, other in ((one, two["target"]), (two, one["target"])):
        move_edge(graph, row, other)
    one["target"], two["target"] = two["target"], one["target"]


def move_edge(graph, row, target):
    a, b, data = next((a, b, d) for a, b, k, d in graph.edges(keys=True, data=True) if k == f"v{row['arc']}")
    graph.remove_edge(a, b, f"v{row['arc']}")
    graph.add_edge(f"h{row['source']}", f"h{target}", key=f"v{row['arc']}", **data)


def drop_arc(rows, graph):
    """The last hole's arc is left out."""
    row = [row for row in rows if row["graph"] == "void" and row["nodes"]][-1]
    rows.remove(row)
    ends = next((a, b) for a, b, k in graph.edges(keys=True) if k == f"v{row['arc']}")
    graph.remove_edge(*ends, f"v{row['arc']}")


def close_the_outside(rows, graph):
    """The outside ends at the highest event."""
    row = next(row for row in rows if row["target"] == ABOVE)
    end = f"h{row['source']}"
    graph.remove_edge(*next((a, b) for a, b, k in graph.edges(keys=True) if k == f"v{row['arc']}"), f"v{row['arc']}")
    graph.remove_node("b1")
    rows.remove(row)
    assert end in graph


def pass_another_hole(rows, graph):
    """Two arcs trade a contour along them."""
    one, two = [row for row in rows if row["graph"] == "void" and row["nodes"]][:2]
    one["nodes"], two["nodes"] = one["nodes"][:-1] + two["nodes"][-1:], two["nodes"][:-1] + one["nodes"][-1:]


@pytest.mark.parametrize("lie", [trade_ends, drop_arc, close_the_outside, pass_another_hole])
def test_lies_about_the_void_are_caught(lie):
    tilt = {"mode": "direction", "direction": [0.1, 0.2, 0.97]}
    with TemporaryDirectory() as folder:
        result, tables, found = run(solids.plate(2), Path(folder), tilt=tilt)
        assert found["void_verdict"] == "exact"
        rows, graph = tables["arcs"].to_pylist(), result.graphs["void"].copy()
        lie(rows, graph)
        altered = tables | {"arcs": pa.Table.from_pylist(rows, schema=SCHEMAS["arcs"])}
        assert certificate(folder, altered, result.graphs | {"void": graph})["verdict"] == "uncertified"


def test_levels_of_a_hole_follow_each_other(tmp_path):
    result, _, _ = run(solids.plate(2), tmp_path, tilt={"mode": "direction", "direction": [0.1, 0.2, 0.97]})
    level = {row["contour"]: row["level"] for row in result.contours}
    for row in void_rows(result):
        assert all(level[b] == level[a] + 1 for a, b in pairwise(row["nodes"]))
