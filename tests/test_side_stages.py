"""What the stages aside of the way to the certificate write."""

import base64
import json
import shutil
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from PIL import Image

import cut_pockets
import draw_loops as draw_loops_stage
import find_loops as loops_stage
import find_pockets as pockets_stage
import pipeline
import solids
from corpus.storage import read_table
from corpus.surfaces import read_faces, read_points, read_rotation
from reebslice import find_loops
from reebslice.drawing.loops import draw_loops
from reebslice.graphs.loop_kinds import KINDS
from reebslice.handles.at_vertices import find_handles
from reebslice.schemas import SCHEMAS
from reebslice.table_checks import build_table


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    """The folder of a plate with two holes, with what the stages before left."""
    folder = tmp_path_factory.mktemp("aside")
    pipeline.run_stages(solids.plate(2, upright=True), folder, tilt={"mode": "auto"})
    return folder


def read_vtp(path):
    """Points, lines as arrays of points, and data of lines of a file of poly data, read by hand."""
    (piece,) = ElementTree.parse(path).getroot().iter("Piece")
    kinds = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}

    def numbers(element):
        raw = base64.b64decode(element.text)
        assert int.from_bytes(raw[:8], "little") == len(raw) - 8
        return np.frombuffer(raw[8:], kinds[element.get("type")])

    points = numbers(piece.find("Points/DataArray")).reshape(-1, 3)
    parts = {part.get("Name"): numbers(part) for part in piece.find("Lines")}
    lines = [points[line] for line in np.split(parts["connectivity"], parts["offsets"][:-1])]
    assert len(points) == int(piece.get("NumberOfPoints")) and len(lines) == int(piece.get("NumberOfLines"))
    return lines, {part.get("Name"): numbers(part) for part in piece.find("CellData")}


def test_loops_are_those_of_the_library_with_their_events(plate, tmp_path):
    loops_stage.main(plate, tmp_path, {"distance": 0.01})
    table = read_table(tmp_path / "loops.parquet", "loops").to_pylist()
    surface = {name: read_table(plate / f"{name}.parquet", name) for name in ("vertices", "faces", "handles")}
    points = np.column_stack([surface["vertices"][axis] for axis in "xyz"])
    rotation = np.array(json.loads((plate / "tilt.json").read_text())["rotation"])
    height = np.ptp(points @ rotation[2])
    faces = np.column_stack([surface["faces"][corner] for corner in "abc"])
    loops = find_loops(points, faces, rotation, 0.01 * height)
    assert len(table) == len(loops.kind) == 2
    assert [row["kind"] for row in table] == loops.kind.tolist()
    assert [row["path"] for row in table] == [
        part.tolist() for part in np.split(loops.paths.member, loops.paths.start[1:-1])
    ]
    assert all(np.array_equal(np.reshape(row["circle"], (-1, 3)), circle) for row, circle in zip(table, loops.circles))
    handles = surface["handles"].to_pylist()
    for row in table:
        assert handles[row["bottom_handle"]]["vertex"] == row["bottom"]
        assert handles[row["bottom_handle"]]["operation"] == "separation"
        assert handles[row["top_handle"]]["vertex"] == row["top"] and handles[row["top_handle"]]["operation"] == "union"
    counts = json.loads((tmp_path / "loops.json").read_text())["loops"]
    assert sum(counts.values()) == 2 and all(counts[kind] == list(loops.kind).count(kind) for kind in KINDS)
    lines, data = read_vtp(tmp_path / "loops.vtp")
    assert data["loop"].tolist() == [0, 1, 0, 1] and data["path"].tolist() == [0, 0, 1, 1]
    for line, loop, path in zip(lines, data["loop"], data["path"]):
        curve = points[table[loop]["path"]] if path else np.reshape(table[loop]["circle"], (-1, 3))
        assert np.array_equal(line, np.append(curve, curve[:1], axis=0))


def events(folder):
    return {row["handle"]: row for row in read_table(folder / "handles.parquet", "handles").to_pylist()}


def test_pockets_and_islands_begin_and_end_at_their_events(tmp_path):
    """A cup that holds a void in its wall, a leg that hangs from it, and a body that floats."""
    filled = np.zeros((7, 5, 6), bool)
    filled[:5, :, 1:] = True
    filled[1, 1, 3:6] = filled[3, 3, 2] = False
    filled[5:, 2, 5] = filled[6, 2, 3:5] = True
    filled[2, 2, 0] = True
    solid = solids.unite(solids.voxels(filled), solids.move(solids.cube(), (20.0, 0.0, 4.0)))
    pipeline.run_stages(solid, tmp_path, tilt={"mode": "none"})
    pockets_stage.main(tmp_path, tmp_path, {"least_depth": 0.0, "distance": 0.01})
    pockets, islands = (read_table(tmp_path / f"{name}.parquet", name).to_pylist() for name in ("pockets", "islands"))
    handles = events(tmp_path)
    expected = {"sealed": ("->i", "i->"), "basin": ("->i", None), "island": ("->o", None), "bell": ("i->", None)}
    for row in pockets + islands:
        first, last = (handles[row[f"{side}_handle"]] for side in ("begin", "end"))
        change, closing = expected[row.get("kind", "island")]
        assert (first["vertex"], first["height"]) == (row["begin"], row["begin_height"])
        assert (last["vertex"], last["height"]) == (row["end"], row["end_height"])
        assert first["change"] == change and closing in (None, last["change"])
        assert row["depth"] == abs(row["end_height"] - row["begin_height"])
        assert [row[axis] for axis in ("x", "y", "z")] == [first[axis] for axis in ("x", "y", "z")]
        assert [row[axis] for axis in ("end_x", "end_y", "end_z")] == [last[axis] for axis in ("x", "y", "z")]
    by_kind = {row["kind"]: row for row in pockets}
    assert sorted(by_kind) == ["basin", "sealed"] and len(pockets) == 2
    assert by_kind["basin"]["volume"] == pytest.approx(3) and by_kind["sealed"]["volume"] == pytest.approx(1)
    assert by_kind["sealed"]["throat_section"] is None and by_kind["basin"]["throat_section"] == pytest.approx(1)
    shells = read_table(tmp_path / "shells.parquet", "shells").to_pylist()
    assert by_kind["sealed"]["shells"] == [row["shell"] for row in shells if row["void"]]
    operations = {handles[row["end_handle"]]["operation"] for row in islands}
    assert len(islands) == 2 and operations == {"union", "annihilation"}
    sums = json.loads((tmp_path / "pockets.json").read_text())
    assert {name: part["count"] for name, part in sums.items()} == {"basins": 1, "bells": 0, "sealed": 1, "islands": 2}
    assert sums["islands"]["volume"] == pytest.approx(sum(row["volume"] for row in islands))


def test_feet_of_a_wide_low_table_are_no_islands_though_it_leans(tmp_path):
    filled = np.ones((40, 40, 2), bool)
    filled[:, :, 0] = False
    filled[np.ix_((0, 39), (0, 39), (0,))] = True
    pipeline.run_stages(solids.voxels(filled), tmp_path, tilt={"mode": "auto"})
    for least, count in ((0.0, 3), (0.001, 0)):
        pockets_stage.main(tmp_path, tmp_path, {"least_depth": least, "distance": 0.1})
        assert len(read_table(tmp_path / "islands.parquet", "islands")) == count


def test_pockets_of_a_surface_that_crosses_itself_touch_its_own_shells(tmp_path):
    path = Path(__file__).parents[2] / "shared/cases/tube_that_turns_over.off"
    if not path.exists():
        pytest.skip(f"{path} is not there")
    pipeline.run_mesh(path, tmp_path, levels={"refine": "none"})
    pockets_stage.main(tmp_path, tmp_path, {"least_depth": 0.0, "distance": 0.01})
    table = read_table(tmp_path / "pockets.parquet", "pockets")
    assert {shell for shells in table["shells"].to_pylist() for shell in shells} <= {0}


def test_pockets_are_cut_out_and_drawn(tmp_path):
    solid = solids.unite(solids.cup(), solids.move(solids.cube(), (20.0, 0.0, 4.0)))
    for case, least in (("some", 0.0), ("none", 1.0)):
        folder = tmp_path / case
        folder.mkdir()
        pipeline.run_stages(solid, folder, tilt={"mode": "auto"})
        pockets_stage.main(folder, folder, {"least_depth": least, "distance": 0.01})
        cut_pockets.main(folder, folder, {"width": 200, "azimuth": None, "elevation": 15})
        scene = trimesh.load(folder / "pockets.glb")
        volumes = {}
        for name in ("pockets", "islands"):
            for row in read_table(folder / f"{name}.parquet", name).to_pylist():
                kind = row.get("kind", "island")
                volumes[f"{kind}{row[name[:-1]]}"] = row["volume"]
        assert sorted(volumes) == ([] if least else ["basin0", "island0"])
        assert {name: mesh.volume for name, mesh in scene.geometry.items()} == pytest.approx(volumes, rel=1e-5)
        assert all(mesh.is_watertight for mesh in scene.geometry.values())
        assert Image.open(folder / "pockets.png").size == (200, 200)


def test_loops_are_drawn_from_their_table_as_the_library_draws_them(plate, tmp_path):
    folder = shutil.copytree(plate, tmp_path / "plate")
    loops_stage.main(folder, folder, {"distance": 0.01})
    options = {"width": 200, "azimuth": None, "elevation": 15}
    draw_loops_stage.main(folder, folder, options)
    points, rotation = read_points(folder), read_rotation(folder)
    height = np.ptp(points @ rotation[2])
    loops = find_loops(points, read_faces(folder), rotation, 0.01 * height)
    loops = loops._replace(circles=[circle @ rotation.T for circle in loops.circles])
    image = draw_loops("plate", points @ rotation.T, read_faces(folder), loops, options)
    assert np.array_equal(np.asarray(Image.open(folder / "loops.png")), image)


def test_pockets_less_deep_than_asked_are_left_out(tmp_path):
    pipeline.run_stages(solids.cup(), tmp_path, tilt={"mode": "none"})
    for depth, count in ((0.213, 1), (0.214, 0)):  # parts of the diagonal, the root of 22
        pockets_stage.main(tmp_path, tmp_path, {"least_depth": depth, "distance": 0.1})
        assert len(read_table(tmp_path / "pockets.parquet", "pockets")) == count


def test_a_handle_is_the_first_of_its_vertex_operation_and_side():
    rows = [(0, 7, "creation", "A"), (1, 5, "union", "B"), (2, 5, "union", "A"), (3, 5, "separation", "A")]
    blank = {"index": 1, "height": 0.0, "x": 0.0, "y": 0.0, "z": 0.0, "persistence": 0.0, "change": None, "pair": None}
    columns = {field.name: [] for field in SCHEMAS["handles"]}
    for handle, vertex, operation, side in rows:
        row = blank | {"handle": handle, "vertex": vertex, "operation": operation, "side": side}
        for field in SCHEMAS["handles"]:
            empty = [] if "list" in str(field.type) else False if str(field.type) == "bool" else 0
            columns[field.name].append(row.get(field.name, empty))
    handles = build_table("handles", columns)
    assert find_handles(handles, [5, 7, 9], "union") == [1, None, None]
    assert find_handles(handles, [5, 5], "union", "A") == [2, 2]
    assert find_handles(handles, [7, 5], "creation", "A") == [0, None]
