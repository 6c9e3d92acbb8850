"""Reading mesh files: every format gives the same solid, every trap a clear sentence."""

import struct

import numpy as np
import pytest
import trimesh

from reebslice.errors import MeshFormatError, NumberFormatError
from reebslice.formats.meshes import SUFFIXES, read_mesh
from reebslice.formats.number_lines import read_numbers
from reebslice.formats.ply import cut_strips
from reebslice.formats.polygons import cut_polygons
from reebslice.mesh.inspection import inspect_surface

# A box of 1 x 2 x 3; its six sides as quadrilaterals, counter-clockwise from outside.
CORNERS = np.array([[x, y, z] for z in (0, 3) for x, y in ((0, 0), (1, 0), (1, 2), (0, 2))], float)
SIDES = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
TRIANGLES = cut_polygons(CORNERS, np.ravel(SIDES).astype(np.int32), np.full(6, 4))[0]


def box():
    return trimesh.Trimesh(CORNERS, TRIANGLES, process=False)


def solid(path):
    """What the file describes: status, components, genus, volume."""
    found = inspect_surface(*read_mesh(path)[:2])[1]
    return found["status"], found["components"], found["genus"], found["volume"]


def ascii_stl(end="\n", comment=""):
    lines = ["solid box" + comment]
    for face in TRIANGLES:
        lines += ["facet normal 0 0 0" + comment, "outer loop"]
        lines += ["  vertex {} {} {}".format(*CORNERS[corner]) + comment for corner in face]
        lines += ["endloop", "endfacet"]
    return end.join([*lines, "endsolid box", ""]).encode()


def binary_stl(header=b"solid box, written by a program"):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[face].ravel(), 0) for face in TRIANGLES)
    return header.ljust(80) + struct.pack("<I", len(TRIANGLES)) + body


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".off", ".glb", ".3mf", ".STL", ".Ply"])
def test_every_format_gives_the_same_solid(tmp_path, suffix):
    path = tmp_path / f"box{suffix}"
    box().export(path, file_type=suffix[1:].lower())
    assert solid(path) == ("accepted", 1, 0, pytest.approx(6))
    assert suffix.lower() in SUFFIXES


def test_scene_parts_are_put_in_place_also_mirrored(tmp_path):
    scene = trimesh.Scene()
    for shift, scale in ((0, 1), (5, -2)):
        place = np.diag([scale, 1.0, 1.0, 1.0])
        place[0, 3] = shift
        scene.add_geometry(box(), transform=place)
    scene.export(tmp_path / "two.glb")
    points = read_mesh(tmp_path / "two.glb").points
    assert solid(tmp_path / "two.glb") == ("accepted", 2, 0, pytest.approx(6 + 12))
    assert points[:, 0].min() == 0 and points[:, 0].max() == 5


def test_gltf_with_its_buffers(tmp_path):
    for name, data in trimesh.Scene(box()).export(file_type="gltf").items():
        (tmp_path / name).write_bytes(data)
    assert solid(tmp_path / "model.gltf") == ("accepted", 1, 0, pytest.approx(6))


@pytest.mark.parametrize(
    "data",
    [
        ascii_stl(),
        ascii_stl(end="\r"),
        ascii_stl(end="\r\n"),
        ascii_stl(comment=" # from a sketch"),
        ascii_stl(comment=" ; vertex 1 2 3"),
        ascii_stl().upper(),
        b"# made by hand\n" + ascii_stl(),
        binary_stl(),
        binary_stl(b"solid facet vertex"),
        binary_stl() + b"\0",
        binary_stl() + b"\n",
        binary_stl(b"\0"),
    ],
    ids=[
        "ascii",
        "cr",
        "crlf",
        "comment",
        "semicolon",
        "upper",
        "lead",
        "solid",
        "words",
        "trailing",
        "newline",
        "plain",
    ],
)
def test_stl_that_readers_stumble_over(tmp_path, data):
    path = tmp_path / "box.stl"
    path.write_bytes(data)
    assert solid(path) == ("accepted", 1, 0, pytest.approx(6))


def off(polygons, head="OFF", extra=""):
    lines = [head, "# a comment", f"8 {len(polygons)} 0", ""]
    lines += ["{} {} {}".format(*corner) + extra for corner in CORNERS]
    lines += [f"{len(one)} " + " ".join(map(str, one)) + " 255 0 0 # red" for one in polygons]
    return "\n".join(lines)


@pytest.mark.parametrize(
    "text",
    [
        off(SIDES),
        off(TRIANGLES.tolist()),
        off([*SIDES[1:], *TRIANGLES[:2].tolist()]),
        off(SIDES, "COFF", " 1 0 0 1"),
        off(SIDES, "NOFF", " 0 0 1"),
        off(SIDES).replace("OFF\n# a comment\n", "OFF "),
        off(SIDES).replace("\n", "\r\n"),
    ],
    ids=["quads", "triangles", "mixed", "colours", "normals", "oneline", "crlf"],
)
def test_off_with_polygons_and_colours(tmp_path, text):
    (tmp_path / "box.off").write_text(text, newline="")
    assert solid(tmp_path / "box.off") == ("accepted", 1, 0, pytest.approx(6))


def test_ply_and_obj_with_polygons(tmp_path):
    points = "\n".join("{} {} {}".format(*corner) for corner in CORNERS)
    faces = "\n".join("4 {} {} {} {}".format(*side) for side in SIDES)
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
    head += "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "box.ply").write_text(f"{head}{points}\n{faces}\n")
    assert solid(tmp_path / "box.ply") == ("accepted", 1, 0, pytest.approx(6))
    lines = ["mtllib none.mtl", "o box"] + ["v {} {} {}".format(*corner) for corner in CORNERS]
    lines += ["f " + " ".join(f"{corner - 8}//" for corner in side) for side in SIDES]
    (tmp_path / "box.obj").write_text("\n".join(lines).replace("//", ""))
    assert solid(tmp_path / "box.obj") == ("accepted", 1, 0, pytest.approx(6))


@pytest.mark.parametrize("order", ["<", ">"])
def test_ply_with_triangle_strips(tmp_path, order):
    strips = np.array([3, 2, 0, 1, 4, 5, 7, 6, 3, 2, -1, 3, 0, 7, 4, -1, 2, 6, 1, 5])
    kind = {"<": "little", ">": "big"}[order]
    head = f"ply\nformat binary_{kind}_endian 1.0\ncomment strips\nelement vertex 8\nproperty float x\n"
    head += "property float y\nproperty float z\nproperty uchar red\nelement tristrips 1\n"
    head += "property list int int vertex_indices\nend_header\n"
    table = np.zeros(8, [("p", order + "f4", 3), ("red", "u1")])
    table["p"] = CORNERS
    words = np.concatenate([[len(strips)], strips]).astype(order + "i4")
    (tmp_path / "box.ply").write_bytes(head.encode() + table.tobytes() + words.tobytes())
    points, faces = read_mesh(tmp_path / "box.ply")[:2]
    assert len(faces) == 12
    assert inspect_surface(points, faces)[1]["volume"] == pytest.approx(6)


def test_strips_keep_one_winding():
    assert cut_strips(np.array([0, 1, 2, 3, 7, 8, 9]), np.array([4, 3])).tolist() == [
        [0, 1, 2],
        [2, 1, 3],
        [7, 8, 9],
    ]


def test_step_cylinder_is_closed_and_in_millimetres(tmp_path):
    pytest.importorskip("cascadio")
    (tmp_path / "rod.step").write_text(step_cylinder(radius=10, height=20))
    status, components, genus, volume = solid(tmp_path / "rod.step")
    assert (status, components, genus) == ("accepted", 1, 0)
    assert 0.99 * np.pi * 2000 < volume < np.pi * 2000


@pytest.mark.parametrize(
    "name, data, words",
    [
        ("a.stl", b"", "empty"),
        ("a.stl", b"solid only a name".ljust(84, b"\0"), "no faces"),
        ("a.stl", binary_stl()[:-60], "declares 12 facets"),
        ("a.stl", b"solid", "no facets"),
        ("a.stl", ascii_stl().replace(b"vertex 1.0 2.0", b"vertex blah 2.0", 1), "blah"),
        ("a.stl", ascii_stl()[:400], "cut off"),
        ("a.stl", ascii_stl().replace(b"1.0", b"nan", 1), "finite"),
        ("a.off", off(SIDES)[:-40].encode(), "face 4 is missing or names fewer"),
        ("a.off", b"OFFX\n", "begins with"),
        ("a.off", off(SIDES).replace("7 6", "7 8").encode(), "vertex 8, but there are 8 vertices, counted from 0"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "names vertex 9"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces: it is a point cloud"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", "finite"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1e99 0\nf 1 2 3\n", "scale"),
        ("a.ply", b"ply\nformat ascii 1.0\n", "end_header is missing"),
        ("a.glb", trimesh.Scene(box()).export(file_type="glb")[:300], "damaged|no faces|cut off"),
        ("a.3mf", b"PK\3\4 nothing", "damaged|cut off"),
        ("a.step", b"ISO-10303-21;\n", "damaged|no faces"),
        ("a.txt", b"text", "not supported"),
        ("a", b"text", "not supported"),
    ],
)
def test_what_is_no_mesh_is_told(tmp_path, name, data, words):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(MeshFormatError, match=words) as told:
        read_mesh(tmp_path / name)
    assert "\n" not in str(told.value) and str(told.value).endswith(".")


def step_cylinder(radius, height):
    """A STEP file of one cylinder: two circles, one seam, three faces."""
    lines = []

    def add(text):
        lines.append(f"#{len(lines) + 1}={text};")
        return f"#{len(lines)}"

    def point(*place):
        return add("CARTESIAN_POINT('',({!r},{!r},{!r}))".format(*map(float, place)))

    def direction(*way):
        return add("DIRECTION('',({!r},{!r},{!r}))".format(*map(float, way)))

    def axes(z):
        return add(f"AXIS2_PLACEMENT_3D('',{point(0, 0, z)},{direction(0, 0, 1)},{direction(1, 0, 0)})")

    def side(edge, sense):
        return add(f"ORIENTED_EDGE('',*,*,{edge},.{sense}.)")

    def face(edges, surface, sense):
        loop = add(f"EDGE_LOOP('',({','.join(edges)}))")
        bound = add(f"FACE_BOUND('',{loop},.T.)")
        return add(f"ADVANCED_FACE('',({bound}),{surface},.{sense}.)")

    length = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid_angle = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    exact = add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'','')")
    context = add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({exact}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))REPRESENTATION_CONTEXT('',''))"
    )
    ends = [add(f"VERTEX_POINT('',{point(radius, 0, z)})") for z in (0, height)]
    rims = [add(f"CIRCLE('',{axes(z)},{float(radius)!r})") for z in (0, height)]
    rims = [add(f"EDGE_CURVE('',{end},{end},{rim},.T.)") for end, rim in zip(ends, rims, strict=True)]
    up = add(f"VECTOR('',{direction(0, 0, 1)},1.)")
    line = add(f"LINE('',{point(radius, 0, 0)},{up})")
    seam = add(f"EDGE_CURVE('',{ends[0]},{ends[1]},{line},.T.)")
    round_edges = [side(rims[0], "T"), side(seam, "T"), side(rims[1], "F"), side(seam, "F")]
    faces = [
        face(round_edges, add(f"CYLINDRICAL_SURFACE('',{axes(0)},{float(radius)!r})"), "T"),
        face([side(rims[0], "F")], add(f"PLANE('',{axes(0)})"), "F"),
        face([side(rims[1], "T")], add(f"PLANE('',{axes(height)})"), "T"),
    ]
    shell = add(f"CLOSED_SHELL('',({','.join(faces)}))")
    brep = add(f"MANIFOLD_SOLID_BREP('',{shell})")
    shape = add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({axes(0)},{brep}),{context})")
    design = add("APPLICATION_CONTEXT('automotive design')")
    discipline = add(f"PRODUCT_CONTEXT('',{design},'mechanical')")
    product = add(f"PRODUCT('rod','rod','',({discipline}))")
    formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    stage = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{design},'design')")
    definition = add(f"PRODUCT_DEFINITION('design','',{formation},{stage})")
    link = add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    add(f"SHAPE_DEFINITION_REPRESENTATION({link},{shape})")
    head = "HEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    head += "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\n"
    data = "\n".join(lines)
    return f"ISO-10303-21;\n{head}DATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n"


def test_numbers_are_read_line_by_line_to_the_last_bit():
    random = np.random.default_rng(0)
    values = (random.normal(size=300) * 10.0 ** random.integers(-300, 300, 300)).tolist()
    lines = [" ".join(map(repr, values[k : k + 3])) for k in range(0, 300, 3)]
    numbers, widths = read_numbers("\r\n \t\n".join(lines).encode())
    assert numbers.tolist() == values and widths.tolist() == [3] * 100
    numbers, widths = read_numbers(b"1 2\n\n 3\nno number", 2)
    assert numbers.tolist() == [1, 2, 3] and widths.tolist() == [2, 1]
    assert [len(part) for part in read_numbers(b" \n")] == [len(part) for part in read_numbers(b"")] == [0, 0]
    with pytest.raises(NumberFormatError):
        read_numbers(b"1 2abc 3")


@pytest.mark.parametrize("suffix, options", [("obj", {}), ("ply", {}), ("ply", {"encoding": "ascii"}), ("off", {})])
def test_what_is_read_here_is_what_trimesh_reads(tmp_path, suffix, options):
    ball = trimesh.creation.icosphere(3)
    path = tmp_path / f"ball.{suffix}"
    ball.export(path, **options)
    points, faces = read_mesh(path)[:2]
    other = trimesh.load(path, process=False)
    assert (points.astype(np.float32)[faces] == np.asarray(other.vertices, np.float32)[other.faces]).all()
