"""OBJ, PLY, OFF and STL as their specifications say: what is read, what is told, what is refused, and where."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from mesh_writers import off_text, ply_bytes, stl_text
from reebslice.errors import MeshFormatError
from reebslice.formats.meshes import read_mesh
from reebslice.mesh.inspection import inspect_surface

# A box of 2 x 4 x 6 about the origin; its sides as quads.
CORNERS = np.array([[x, y, z] for z in (-3, 3) for x, y in ((-1, -2), (1, -2), (1, 2), (-1, 2))], float)
SIDES = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
MIXED = [[3, 2, 1, 0], [4, 5, 6], [4, 6, 7], *SIDES[2:]]
V = "".join("v {} {} {}\n".format(*corner) for corner in CORNERS)
F = "".join("f {} {} {} {}\n".format(*(v + 1 for v in side)) for side in SIDES)
CASES = Path(__file__).parents[2] / "shared" / "cases"


def read(folder, name, data):
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return read_mesh(path)


def assert_box(mesh):
    a, b, c = (mesh.points[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    assert np.linalg.norm(normals, axis=1).sum() / 2 == pytest.approx(88)
    assert (a * normals).sum() / 6 == pytest.approx(48)


def list_cases():
    kinds = (".obj", ".ply", ".off", ".stl")
    if not CASES.exists():
        return []
    return [
        (name, want) for name, want in json.loads((CASES / "expected.json").read_text()).items() if name.endswith(kinds)
    ]


@pytest.mark.skipif(not CASES.exists(), reason="the shared cases are not beside the checkout")
@pytest.mark.parametrize("name, want", list_cases(), ids=[name for name, _ in list_cases()])
def test_shared_cases_have_their_area_and_volume(name, want):
    if want.get("status") == "rejected":
        with pytest.raises(MeshFormatError, match="Git LFS pointer.*fetch"):
            read_mesh(CASES / name)
        return
    mesh = read_mesh(CASES / name)
    a, b, c = (mesh.points[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    if "area" in want:
        assert np.linalg.norm(normals, axis=1).sum() / 2 == pytest.approx(want["area"], rel=1e-5)
    if "volume" in want and name != "insert_in_cavity.stl":
        assert (a * normals).sum() / 6 == pytest.approx(want["volume"])
    if "area" in want:
        found = inspect_surface(*mesh[:2])[1]
        assert (found["status"], found["components"]) == ("accepted", 1)
        assert found["volume"] == pytest.approx(want["volume"])


@pytest.mark.parametrize(
    "text",
    [
        V + F,
        (V + F).replace("\n", "\r\n"),
        "\ufeff" + V + F,
        V + "".join("f {} {} {} {}\n".format(*(v - 8 for v in side)) for side in SIDES) + V,
        V + F.replace("f 4 3", "f 4 \\\n 3").replace("f 5 6", "f 5\\\n6"),
        "v \\\n-1 -2 \\\n-3\n" + V.partition("\n")[2] + F,
        "# C:\\models\\\n" + V + F,
        "mtllib a.mtl\no box\ng side\n"
        + V
        + "vt 0 0\nvn 0 0 1\ns off\n"
        + F.replace(" 1", " 1/1").replace(" 2", " 2//1"),
        V.replace("\n", " 0.5 0.5 0.5\n") + F,
        V.replace("\n", " 1.0\n") + F + "usemtl x\ns 1\n",
        F + V,
        V + F.replace("f ", "fo "),
        "\t" + V.replace("v ", "v\t") + F.replace("\n", "  # a side\n"),
        V + F.rstrip(),
    ],
    ids="plain crlf mark negative joined joinedv comment slashes colours weights ahead fo blanks unended".split(),
)
def test_obj_is_read(tmp_path, text):
    mesh = read(tmp_path, "box.obj", text)
    assert_box(mesh)
    assert mesh.unit is None and mesh.notes == ()


@pytest.mark.parametrize(
    "text, told",
    [
        (V + F + "l 1 2\nl 2 3\np 1\n", "2 statements of lines (l)|1 statements of points (p)"),
        (V + F + "cstype bspline\nsurf 0 1 0 1 1 2 3 4\nend\n", "left out: 1 surf"),
        (V.replace("\n", " 0.5\n") + F, "8 vertices have a weight (w) other than 1"),
        (V + F + "f 1 2\n", "1 faces of fewer than three corners were left out, the first is face 7 (line 15)"),
    ],
    ids=["lines", "surface", "weights", "short"],
)
def test_obj_tells_what_it_leaves_out(tmp_path, text, told):
    mesh = read(tmp_path, "box.obj", text)
    assert_box(mesh)
    assert all(any(part in note for note in mesh.notes) for part in told.split("|"))


def ply(body, elements, form="ascii"):
    return f"ply\nformat {form} 1.0\n{elements}end_header\n".encode() + body


XYZ = "property double x\nproperty double y\nproperty double z\n"
VERTICES = f"element vertex 8\n{XYZ}"
ROWS = "".join("{} {} {}\n".format(*corner) for corner in CORNERS)
LISTS = "".join("4 {} {} {} {}\n".format(*side) for side in SIDES)


def rich_ply(order):
    """An element ahead, lists among scalars, faces before vertices and of mixed size, and an element behind."""
    kind = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = "comment end_header\nobj_info made\nelement camera 2\nproperty list uchar short a\nproperty float32 b\n"
    head += f"element face {len(MIXED)}\nproperty uchar red\nproperty list ushort uint vertex_index\n"
    head += "property list uchar float texcoord\nelement vertex 8\nproperty int8 tag\nproperty float64 z\n"
    head += "property float x\nproperty int16 y\nelement edge 3\nproperty int vertex1\n"
    data = [struct.pack(f"{order}B{n}hf", n, *range(n), 0.5) for n in (3, 0)]
    for face in MIXED:
        n = len(face)
        data.append(struct.pack(f"{order}BH{n}IB{2 * n}f", 7, n, *face, 2 * n, *range(2 * n)))
    data += [struct.pack(f"{order}bdfh", 1, z, x, int(y)) for x, y, z in CORNERS]
    return ply(b"".join(data) + bytes(12), head, kind)


RICH_ASCII = "3 0 1 2 0.5\n" + "".join(f"7 {len(f)} {' '.join(map(str, f))} 2 0.5 0.5\n" for f in MIXED)
RICH_HEAD = (
    f"element camera 1\nproperty list int int a\nproperty float b\nelement face {len(MIXED)}\nproperty uchar r\n"
)
RICH_HEAD += f"property list char int32 vertex_indices\nproperty list uint8 float32 uv\n{VERTICES}element edge 1\n"


@pytest.mark.parametrize(
    "data",
    [
        *(ply_bytes(CORNERS, MIXED, order, kind) for order in ("", "<", ">") for kind in ("float", "double")),
        ply_bytes(CORNERS, MIXED).replace(b"\n", b"\r\n"),
        ply_bytes(CORNERS, MIXED).replace(b"\n", b"\r"),
        ply_bytes(CORNERS, MIXED, "<").replace(b"\n", b"\r\n", 9),
        rich_ply("<"),
        rich_ply(">"),
        ply((RICH_ASCII + ROWS + "5\n").encode(), RICH_HEAD + "property int e\n"),
        ply(
            (ROWS.replace("\n", " ") + LISTS).encode(),
            VERTICES + "element face 6\nproperty list uchar int vertex_index\n",
        ),
    ],
    ids="af ad lf ld bf bd crlf cr binary_crlf rich_little rich_big rich_ascii one_line".split(),
)
def test_ply_is_read(tmp_path, data):
    mesh = read(tmp_path, "box.ply", data)
    assert_box(mesh)
    assert mesh.unit is None and mesh.notes == ()


def off_binary(faces=SIDES):
    data = struct.pack(">3i", 8, len(faces), 0) + CORNERS.astype(">f4").tobytes()
    for k, face in enumerate(faces):
        data += struct.pack(f">{len(face) + 2 + k}i", len(face), *face, k, *([0] * k))
    return b"OFF BINARY\n" + data


@pytest.mark.parametrize(
    "data",
    [
        off_text(CORNERS, MIXED),
        off_text(CORNERS, SIDES).replace("OFF\n8 6 0", "# by hand\n\nOFF # here\n8 6"),
        off_text(CORNERS, SIDES).replace("OFF\n", "OFF "),
        off_text(CORNERS, SIDES).replace("OFF", "STOFF").replace(".0\n", ".0 0.5 0.5\n"),
        "OFF\n8 6 12\n" + ROWS.replace("\n", " ") + "\n" + LISTS,
        "COFF\n8 6 0\n" + ROWS.replace("\n", " 0.1 0.2 0.3 1\n") + LISTS.replace("\n", " 255 0 0 # red\n"),
        off_binary(),
        off_binary(MIXED),
    ],
    ids="mixed comments oneline texture freeform colours binary binary_mixed".split(),
)
def test_off_is_read(tmp_path, data):
    assert_box(read(tmp_path, "box.off", data))


TRIANGLES = [face for a, b, c, d in SIDES for face in ([a, b, c], [a, c, d])]
STL = stl_text(CORNERS, TRIANGLES)


@pytest.mark.parametrize(
    "text",
    [
        STL,
        STL.replace("solid test", "solid " + "a very long title facet vertex 1 2 3 " * 70, 1),
        STL.replace("\n", " ").replace("solid test", "solid test\n", 1),
        STL.replace("endsolid test\n", "endsolid test\nsolid more\nendsolid more\n"),
        STL.replace("endfacet\n", "endfacet\n\n\t\n").replace("facet normal", "  FACET NORMAL"),
    ],
    ids=["plain", "title", "one_line", "two_solids", "blanks"],
)
def test_ascii_stl_is_read(tmp_path, text):
    assert_box(read(tmp_path, "box.stl", text))


FOUR = STL.replace("endloop", "vertex 0 0 0\nendloop", 3).replace("vertex 0 0 0\nendloop", "endloop", 2)


@pytest.mark.parametrize(
    "name, data, words",
    [
        (
            "a.obj",
            V + F + "f 1 2 12\n",
            r"Face 7 \(line 15, 'f 1 2 12'\) names vertex 12, but the OBJ file has 8 vertices",
        ),
        ("a.obj", "v 0 0 0\nf 1 -1 -2\n" + V, r"Face 1 \(line 2, .*names vertex -2.*1 of them before that line"),
        ("a.obj", V + F + "f 0 1 2\n", r"line 15.*names vertex 0, .* counted from 1"),
        ("a.obj", V.replace("1.0", "1.#IND", 1) + F, r"Line 1 \('v -1.#IND.*' where a coordinate"),
        ("a.obj", V.replace("-3.0", "1.#QNAN", 1) + F, r"holds '1.#QNAN' where a coordinate"),
        ("a.obj", V + F.replace("f 5", "f x"), r"Line 10 .* holds 'x' where a vertex number"),
        ("a.obj", V + "v 1 2\n" + F, r"Line 9 \('v 1 2'\) gives a vertex fewer than three coordinates"),
        ("a.obj", V.replace("2.0", "nan", 1) + F, r"the first is vertex 1 \(line 1\) at \(-1, nan, -3\)"),
        ("a.obj", V.replace("1.0", "1,0", 1) + F, r"Line 1 .* holds '-1,0'"),
        ("a.obj", V, "holds 8 vertices and no faces: it is a point cloud"),
        ("a.obj", V + "surf 0 1 0 1 1 2\ncurv 0 1 1 2\n", r"only free-form curves and surfaces \(1 surf, 1 curv\)"),
        ("a.obj", "call other.obj\n" + V + F, "calls other files"),
        ("a.obj", V + "f 1 3 2 4\n", r"outline of face 1 \(line 9\), a polygon of 4 corners, crosses itself"),
        ("a.ply", ply(ROWS.encode(), VERTICES), "holds 8 points and no faces: it is a point cloud"),
        ("a.ply", ply_bytes(CORNERS, MIXED, "<")[:-5], "declares 7 rows of element face but ends within row 6"),
        ("a.ply", ply_bytes(CORNERS, MIXED)[:-9], "declares 7 rows of element face but ends within row 6"),
        ("a.ply", ply_bytes(CORNERS, MIXED, "<")[:300], "rows of element vertex but ends within row"),
        ("a.ply", ply_bytes(CORNERS, SIDES).replace(b"4 3 2 1 0", b"4 3 2 1 8"), r"face 0 \(line 18\): vertex 8, but"),
        (
            "a.ply",
            ply_bytes(CORNERS, SIDES).replace(b"double x", b"half x"),
            "Line 4 of the PLY header is 'property half x'",
        ),
        (
            "a.ply",
            ply_bytes(CORNERS, SIDES).replace(b"vertex_indices", b"corners"),
            "no list vertex_indices or vertex_index",
        ),
        ("a.ply", ply_bytes(CORNERS, SIDES).replace(b"double z", b"double w"), "no property z"),
        ("a.ply", ply_bytes(CORNERS, SIDES).replace(b"ascii", b"utf8"), "which is none of ascii"),
        ("a.ply", ply_bytes(CORNERS, SIDES).replace(b"-3.0", b"abc", 1), "Line 10 holds 'abc' where a number is due"),
        ("a.ply", b"PK" + bytes(90), "not with ply"),
        ("a.off", off_text(CORNERS, SIDES).replace("OFF", "4OFF"), "The file is 4OFF"),
        ("a.off", off_text(CORNERS, SIDES).replace("OFF", "nOFF 5"), "The file is nOFF"),
        ("a.off", off_text(CORNERS, SIDES).replace("-3.0", "x", 1), "Line 3 holds 'x'"),
        ("a.off", off_text(CORNERS, SIDES).replace("4 3 2 1 0", "4 3 2 1"), "face 0 is missing or names fewer"),
        ("a.off", off_text(CORNERS, SIDES).replace("4 3 2 1 0", "4 3 2 1 9"), r"face 0 \(line 11\): vertex 9"),
        ("a.off", off_text(CORNERS, SIDES).replace("8 6", "eight 6"), "'eight 6' where its numbers"),
        ("a.off", off_binary()[:-30], "is missing or names fewer"),
        ("a.off", off_binary()[:60], "binary OFF file declares 8 vertices of 12 bytes"),
        ("a.stl", FOUR, r"4 vertices instead of 3 in facet 3 \(line 16\)"),
        ("a.stl", STL[: STL.rindex("vertex")], r"ends within facet 12 \(line 79\): it is cut off"),
        ("a.stl", STL.replace("-3.0", "-3.0 7.0", 1), r"Line 4 .* not three numbers: '.* -3.0 7.0' \(facet 1\)"),
        ("a.stl", STL.replace("-3.0", "nan", 1), r"the first is vertex 1 of facet 1 \(line 4\) at \(-1, 2, nan\)"),
        ("a.stl", "solid nothing\nendsolid nothing\n" + " " * 99, "holds no facets"),
        (
            "a.ply",
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 132735\n",
            "pointer, not the mesh of 132735",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place(tmp_path, name, data, words):
    with pytest.raises(MeshFormatError, match=words) as told:
        read(tmp_path, name, data)
    assert "\n" not in str(told.value) and str(told.value).endswith(".")


def test_coordinates_are_told_in_digits_that_find_them_again(tmp_path):
    far = V.replace("2.0", "4785273.25", 1).replace("-3.0", "inf", 1)
    with pytest.raises(MeshFormatError, match=r"4785273\.25"):
        read(tmp_path, "a.obj", far + F)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be"])
def test_text_in_utf_16_is_read(encoding, tmp_path):
    text = ("" if encoding == "utf-16" else "\ufeff") + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    (tmp_path / "a.obj").write_bytes(text.encode(encoding))
    assert read_mesh(tmp_path / "a.obj").faces.tolist() == [[0, 1, 2]]
