"""glTF 2.0: every file is read as the specification says, or refused by a sentence that names why."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from gltf_files import BOX, BYTE, CORNERS, FLOAT, SHORT, SIDES, UBYTE, UINT, USHORT, Builder, measure, skinned
from reebslice.errors import MeshFormatError
from reebslice.formats import gltf_shares
from reebslice.formats.gltf import list_companions, read_gltf

CASES = Path(__file__).parents[2] / "shared" / "cases"


def notes(path):
    return " ".join(read_gltf(path).notes)


@pytest.fixture
def build():
    return Builder()


@pytest.fixture
def glb(tmp_path):
    return tmp_path / "model.glb"


# --------------------------------------------------------------------------
# Shared cases


@pytest.mark.skipif(not CASES.is_dir(), reason="the cases ../shared/cases are absent")
@pytest.mark.parametrize("name", sorted(path.name for path in CASES.glob("gltf_*")))
def test_shared_case(name):
    expected = json.loads((CASES / "expected.json").read_text())[name]
    if expected.get("status") == "rejected":
        with pytest.raises(MeshFormatError, match="KHR_draco_mesh_compression|EXT_meshopt_compression"):
            read_gltf(CASES / name)
        return
    volume, low, high = measure(CASES / name)
    assert volume == pytest.approx(expected.get("volume", 32))  # gltf_instancing.gltf says so in its note
    assert [low, high] == expected.get("bounds", [low, high])


# --------------------------------------------------------------------------
# Container


@pytest.mark.parametrize("uri", [None, "data", "my part.bin", "größe #1?.bin", "parts/100%.bin"])
def test_buffer_is_found_wherever_it_is(build, tmp_path, uri):
    build.node(mesh=build.box())
    path = build.write(tmp_path / ("model.glb" if uri is None else "model.gltf"), uri)
    assert measure(path)[0] == 6
    assert list_companions(path) == ([] if uri in (None, "data") else [uri])


def test_data_uri_without_base64_and_without_padding(build, tmp_path):
    build.node(mesh=build.box())
    percent = "data:application/gltf-buffer," + "".join(f"%{byte:02x}" for byte in build.data)
    build.document["buffers"] = [{"byteLength": len(build.data), "uri": percent}]
    assert measure(build.write(tmp_path / "model.gltf"))[0] == 6
    del build.document["buffers"]
    text = build.write(tmp_path / "model.gltf", "data").read_text().replace("=", "")
    (tmp_path / "model.gltf").write_text(text)
    assert measure(tmp_path / "model.gltf")[0] == 6


def test_content_tells_json_from_glb(build, tmp_path):
    build.node(mesh=build.box())
    binary = build.write(tmp_path / "model.glb")
    assert measure(binary.rename(tmp_path / "binary.gltf"))[0] == 6
    plain = build.write(tmp_path / "model.gltf", "data")
    plain.write_bytes(b"\xef\xbb\xbf" + plain.read_bytes())  # a byte order mark may be ignored
    assert measure(plain.rename(tmp_path / "plain.glb"))[0] == 6


def test_unknown_chunks_and_bytes_after_the_end_are_left_out(build, glb):
    build.node(mesh=build.box())
    data = bytearray(build.write(glb).read_bytes()) + b"\x04\0\0\0WHATnone"
    data[8:12] = len(data).to_bytes(4, "little")
    glb.write_bytes(data)
    assert measure(glb)[0] == 6 and not notes(glb)
    glb.write_bytes(bytes(data) + b"\0\0")
    assert measure(glb)[0] == 6 and "2 bytes after the end" in notes(glb)


def test_chunks_that_are_not_padded_are_read_and_told(build, tmp_path):
    build.node(mesh=build.box())
    text = build.write(tmp_path / "model.gltf").read_bytes()
    text += b" " * (1 - len(text) % 4 + 4)
    data = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(build.data))
    for kind, chunk in ((b"JSON", text), (b"BIN\0", build.data)):
        data += struct.pack("<I4s", len(chunk), kind) + chunk
    (tmp_path / "model.glb").write_bytes(data)
    assert measure(tmp_path / "model.glb")[0] == 6
    assert "Chunk 0 of the GLB file ends at byte" in notes(tmp_path / "model.glb")


def test_whole_numbers_may_be_written_with_a_fraction_and_the_last_of_a_repeated_key_counts(build, tmp_path):
    build.node(mesh=build.box())
    text = build.write(tmp_path / "model.gltf", "data").read_text()
    text = text.replace('"count": 36', '"count": 3, "count": 3.6e1').replace('"mesh": 0', '"mesh": 0.0')
    (tmp_path / "model.gltf").write_text(text)
    assert measure(tmp_path / "model.gltf")[0] == 6


def test_min_and_max_are_not_believed(build, glb):
    build.node(mesh=build.box())
    build.document["accessors"][0] |= {"min": [5, 5, 5], "max": [6, 6, 6]}
    assert measure(build.write(glb)) == (6, [0, 0, 0], [1, 2, 3])


def test_companions_are_named_without_being_there(build, tmp_path):
    build.document["buffers"] = [
        {"byteLength": 4, "uri": uri}
        for uri in ("a.bin", "sub/b%20c.bin", "./a.bin", "a.bin", "https://x.example/d.bin", "/e.bin", "%2Fe.bin")
    ]
    path = build.write(tmp_path / "model.gltf")
    assert list_companions(path) == ["a.bin", "sub/b c.bin", "./a.bin"]
    path.write_text("{")
    assert list_companions(path) == []


# --------------------------------------------------------------------------
# Accessors


@pytest.mark.parametrize("kind", [BYTE, UBYTE, SHORT, USHORT])
def test_normalized_integers_by_the_equations(build, glb, kind):
    top = np.iinfo({BYTE: "i1", UBYTE: "u1", SHORT: "i2", USHORT: "u2"}[kind]).max
    low = -top if kind in (BYTE, SHORT) else 0
    corners = np.where(np.array(CORNERS) > 0, top, low)
    position = build.accessor(corners, kind, normalized=True, gap=1 if kind in (BYTE, UBYTE) else 2)
    indices = build.accessor(BOX, UINT)
    mesh = build.add("meshes", primitives=[{"attributes": {"POSITION": position}, "indices": indices}])
    build.node(mesh=mesh, scale=[10, 10, 10], translation=[3, 4, 5])
    size, start = (20, -10) if low else (10, 0)
    assert measure(build.write(glb)) == (size**3, [3 + start, 4 + start, 5 + start], [13, 14, 15])


def test_lowest_signed_integer_is_minus_one(build, glb):
    corners = np.where(np.array(CORNERS) > 0, 127, -128)
    position = build.accessor(corners, BYTE, normalized=True, gap=1)
    primitive = {"attributes": {"POSITION": position}, "indices": build.accessor(BOX, UBYTE)}
    build.node(mesh=build.add("meshes", primitives=[primitive]))
    assert measure(build.write(glb)) == (8, [-1, -1, -1], [1, 1, 1])


@pytest.mark.parametrize("kind", [BYTE, UBYTE, SHORT, USHORT, FLOAT])
def test_plain_integers_are_coordinates(build, glb, kind):
    position = build.accessor(CORNERS, kind)
    primitive = {"attributes": {"POSITION": position}, "indices": build.accessor(BOX, UBYTE)}
    build.node(mesh=build.add("meshes", primitives=[primitive]))
    assert measure(build.write(glb))[0] == 6


@pytest.mark.parametrize("base", [True, False])
def test_sparse_accessor_with_and_without_base(build, glb, base):
    position = build.accessor(CORNERS, sparse=[1, 2, 3, 4, 5, 6, 7], base=base)
    indices = build.accessor(BOX, USHORT, sparse=[0, 35])
    build.node(mesh=build.add("meshes", primitives=[{"attributes": {"POSITION": position}, "indices": indices}]))
    assert measure(build.write(glb)) == (6, [0, 0, 0], [1, 2, 3])


def test_sparse_values_reach_the_vertices_of_a_later_primitive(build, glb):
    many = [[x + 10 * k, y, z] for k in range(2) for x, y, z in CORNERS]
    position = build.accessor(many, sparse=[3, 9, 15])
    second = {"attributes": {"POSITION": position}, "indices": build.accessor(np.array(BOX) + 8, USHORT)}
    build.node(mesh=build.add("meshes", primitives=[second]))
    assert measure(build.write(glb)) == (6, [10, 0, 0], [11, 2, 3])


def test_strides_and_offsets(build, glb):
    position = build.accessor(CORNERS, gap=20, before=8)
    indices = build.accessor(BOX, USHORT, before=6)
    build.node(mesh=build.add("meshes", primitives=[{"attributes": {"POSITION": position}, "indices": indices}]))
    assert measure(build.write(glb))[0] == 6


def test_last_element_needs_no_padding(build, glb):
    position = build.accessor(CORNERS, gap=4)
    view = build.document["bufferViews"][0]
    view["byteLength"] -= 4  # as the specification counts: stride * (count - 1) + element
    indices = build.accessor(BOX, USHORT)
    build.node(mesh=build.add("meshes", primitives=[{"attributes": {"POSITION": position}, "indices": indices}]))
    assert measure(build.write(glb))[0] == 6


def test_primitives_that_share_one_accessor_keep_their_own_vertices(build, glb):
    many = [[x + 10 * k, y, z] for k in range(5) for x, y, z in CORNERS]
    position = build.accessor(many)
    primitives = [
        {"attributes": {"POSITION": position}, "indices": build.accessor(np.array(BOX) + 8 * k, USHORT)}
        for k in range(5)
    ]
    build.node(mesh=build.add("meshes", primitives=primitives))
    assert measure(build.write(glb)) == (30, [0, 0, 0], [41, 2, 3])
    assert len(read_gltf(glb).points) == 40


# --------------------------------------------------------------------------
# Primitives


def split_box(build, mode):
    """Write each side of the box as a primitive of its own: two triangles, a strip or a fan."""
    position = build.accessor(CORNERS)
    order = {4: (0, 1, 2, 0, 2, 3), 5: (0, 1, 3, 2), 6: (0, 1, 2, 3)}[mode]
    return [
        {
            "attributes": {"POSITION": position},
            "indices": build.accessor([side[k] for k in order], UBYTE),
            "mode": mode,
        }
        for side in SIDES
    ]


@pytest.mark.parametrize("mode", [4, 5, 6])
def test_triangles_strips_and_fans_are_wound_alike(build, glb, mode):
    build.node(mesh=build.add("meshes", primitives=split_box(build, mode)))
    assert measure(build.write(glb)) == (6, [0, 0, 0], [1, 2, 3])
    assert len(read_gltf(glb).faces) == 12


@pytest.mark.parametrize("mode", [4, 5, 6])
def test_without_indices(build, glb, mode):
    order = {4: (0, 1, 2, 0, 2, 3), 5: (0, 1, 3, 2), 6: (0, 1, 2, 3)}[mode]
    primitives = [
        {"attributes": {"POSITION": build.accessor([CORNERS[side[k]] for k in order])}, "mode": mode} for side in SIDES
    ]
    build.node(mesh=build.add("meshes", primitives=primitives))
    assert measure(build.write(glb))[0] == 6


def test_strips_joined_by_repeated_vertices(build, glb):
    strip = []
    for a, b, c, d in SIDES:
        strip += [a, a, b, d, c, c]
    primitive = {
        "attributes": {"POSITION": build.accessor(CORNERS)},
        "indices": build.accessor(strip, UBYTE),
        "mode": 5,
    }
    build.node(mesh=build.add("meshes", primitives=[primitive]))
    volume, *_ = measure(build.write(glb))
    assert abs(volume) == 6 and len(read_gltf(glb).faces) == 12


@pytest.mark.parametrize("mode", [5, 6])
def test_strips_and_fans_restart_where_the_extension_allows(build, glb, mode):
    order = {5: (0, 1, 3, 2), 6: (0, 1, 2, 3)}[mode]
    ids = [k for side in SIDES for k in (*(side[place] for place in order), 255)] + [255, 3, 255]
    primitive = {
        "attributes": {"POSITION": build.accessor(CORNERS)},
        "indices": build.accessor(ids, UBYTE),
        "mode": mode,
    }
    build.node(mesh=build.add("meshes", primitives=[primitive]))
    build.document |= {key: ["KHR_mesh_primitive_restart"] for key in ("extensionsUsed", "extensionsRequired")}
    assert measure(build.write(glb))[0] == 6 and len(read_gltf(glb).faces) == 12


def test_long_strip_by_the_equation(build, glb):
    zigzag = [[k // 2, k % 2, 0] for k in range(9)]
    build.node(mesh=build.add("meshes", primitives=[{"attributes": {"POSITION": build.accessor(zigzag)}, "mode": 5}]))
    expected = [[i, i + 1 + i % 2, i + 2 - i % 2] for i in range(7)]
    assert read_gltf(build.write(glb)).faces.tolist() == expected


def test_points_and_lines_are_left_out_and_told(build, glb):
    mesh = build.box()
    position = build.accessor(CORNERS)
    build.document["meshes"][mesh]["primitives"] += [
        {"attributes": {"POSITION": position}, "mode": mode} for mode in (0, 1, 2, 3)
    ]
    build.document["meshes"][mesh]["primitives"].append({"attributes": {}})
    build.node(mesh=mesh)
    assert measure(build.write(glb))[0] == 6
    assert "4 primitives of points or lines were left out, the first is primitive 1 of mesh 0" in notes(glb)
    assert "1 primitives without positions" in notes(glb)


def test_only_points_is_no_mesh(build, glb):
    mesh = build.add("meshes", primitives=[{"attributes": {"POSITION": build.accessor(CORNERS)}, "mode": 0}])
    build.node(mesh=mesh)
    with pytest.raises(MeshFormatError, match="no triangle.*of points or lines"):
        read_gltf(build.write(glb))


# --------------------------------------------------------------------------
# Scene


def test_hierarchy_of_matrices_and_trs(build, glb):
    turn = [0, 0, np.sqrt(0.5), np.sqrt(0.5)]  # x to y
    build.node(root=False, mesh=build.box(), translation=[1, 0, 0])
    build.node(matrix=[2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 0, 0, 1], rotation=None, children=[0])
    del build.document["nodes"][1]["rotation"]
    build.node(root=False, mesh=0, translation=[100, 0, 0], rotation=turn, scale=[2, 1, 1])
    build.document["nodes"][1]["children"].append(2)
    volume, low, high = measure(build.write(glb))
    assert volume == pytest.approx(6 * 8 + 6 * 2 * 8)
    np.testing.assert_allclose([low, high], [[7, 0, 0], [5 + 2 * 100, 4, 6]], atol=1e-12)


@pytest.mark.parametrize("scale", [[-1, 1, 1], [-1, -1, -1], [1, -2, 1]])
def test_mirrored_nodes_turn_faces_over(build, glb, scale):
    build.node(children=[1], scale=scale)
    build.node(root=False, mesh=build.box())
    assert measure(build.write(glb))[0] == 6 * abs(np.prod(scale))


def test_mirrored_twice_is_not_mirrored(build, glb):
    build.node(children=[1], scale=[-1, 1, 1])
    build.node(root=False, mesh=build.box(), scale=[1, 1, -1])
    assert measure(build.write(glb))[0] == 6


def test_the_scene_that_the_file_names_is_read(build, glb):
    build.node(mesh=build.box())
    build.node(root=False, mesh=0, scale=[2, 2, 2])
    build.document |= {"scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}]}
    assert measure(build.write(glb))[0] == 48
    assert "Of 2 scenes, scene 1 is read, which the file names" in notes(glb)
    assert "1 nodes with a mesh are not shown by the scene and left out, the first is node 0" in notes(glb)
    del build.document["scene"]
    assert measure(build.write(glb))[0] == 6 and "names none and begins with" in notes(glb)
    del build.document["scenes"]
    assert measure(build.write(glb))[0] == 54 and "no scene: all 2 root nodes are read" in notes(glb)


def test_a_child_that_the_scene_lists_stands_below_an_empty_parent(build, glb):
    build.node(mesh=build.box())
    build.node(root=False, children=[0])
    assert measure(build.write(glb))[0] == 6
    assert "Scene 0 lists node 0, which is no root node but a child of node 1; that has no transform" in notes(glb)


def test_lower_levels_of_detail_are_no_parts_of_a_file_without_scenes(build, glb):
    build.node(mesh=build.box(), extensions={"MSFT_lod": {"ids": [1]}})
    build.node(root=False, mesh=0)
    del build.document["scene"], build.document["scenes"]
    assert measure(build.write(glb))[0] == 6


def test_hidden_branches_are_left_out_and_told(build, glb):
    build.node(mesh=build.box())
    build.node(children=[2], extensions={"KHR_node_visibility": {"visible": False}})
    build.node(root=False, mesh=0, extensions={"KHR_node_visibility": {"visible": True}})
    build.document["extensionsRequired"] = ["KHR_node_visibility"]
    assert measure(build.write(glb))[0] == 6
    assert "the first is node 2; KHR_node_visibility hides node 1" in notes(glb)


def test_corners_in_one_place_stay_in_one_place(build, glb):
    """Corners repeat all along the array: cracks would open if rounding depended on the row."""
    rng = np.random.default_rng(1)
    corners = rng.random((8, 3)).astype(np.float32)
    position = build.accessor(corners[np.tile(BOX, 50)])
    mesh = build.add("meshes", primitives=[{"attributes": {"POSITION": position}}])
    build.node(mesh=mesh, rotation=[0.5, 0.5, -0.5, 0.5], scale=[1 / 3, 0.7, 1.1], translation=[0.1, 0.2, 1e6])
    assert len(np.unique(read_gltf(build.write(glb)).points, axis=0)) == 8


def test_animations_are_told(build, glb):
    build.node(mesh=build.box())
    build.document["animations"] = [{"channels": [], "samplers": []}]
    assert "1 animations are not played" in notes(build.write(glb))


# --------------------------------------------------------------------------
# Instances, morph targets, skins


def test_instances(build, glb):
    attributes = {
        "TRANSLATION": build.accessor([[0, 0, 0], [10, 0, 0], [0, 50, 0]]),
        "ROTATION": build.accessor([[0, 0, 0, 127], [0, 0, 127, 0], [64, 64, 64, 64]], BYTE, normalized=True),
        "SCALE": build.accessor([[1, 1, 1], [1, 1, 1], [-1, 2, 2]]),
        "_ID": build.accessor([[1], [2], [3]]),
    }
    build.node(mesh=build.box(), scale=[2, 2, 2], extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    volume, low, high = measure(build.write(glb))
    assert volume == pytest.approx(8 * (6 + 6 + 6 * 4))
    np.testing.assert_allclose([low, high], [[0, -4, 0], [20, 100, 8]], atol=1e-12)


def test_instances_of_nothing_are_one(build, glb):
    build.node(mesh=build.box(), extensions={"EXT_mesh_gpu_instancing": {"attributes": {}}})
    assert measure(build.write(glb))[0] == 6


def morphed(build, **node):
    mesh = build.box()
    grow = np.where(np.array(CORNERS) == [0, 0, 3], [[0, 0, 3]], 0) * (np.array(CORNERS)[:, 2:] > 0)
    targets = [
        {"POSITION": build.accessor(grow)},
        {"NORMAL": 0},
        {"POSITION": build.accessor(np.sign(grow) * 127, BYTE, normalized=True, sparse=[4, 5, 6, 7], base=False)},
    ]
    build.document["meshes"][mesh]["primitives"][0]["targets"] = targets
    build.node(mesh=mesh, **node)
    return build.document["meshes"][mesh]


def test_morph_targets_by_the_weights_of_the_mesh_or_of_the_node(build, glb):
    mesh = morphed(build)
    assert measure(build.write(glb))[0] == 6 and not notes(glb)
    mesh["weights"] = [1, 5, 0]
    assert measure(build.write(glb))[0] == 12
    assert "Morph targets of mesh 0 are applied with weights [1.0, 5.0, 0.0]" in notes(glb)
    build.document["nodes"][0]["weights"] = [0, 0, 2]
    assert measure(build.write(glb))[0] == 2 * (3 + 2)


@pytest.mark.parametrize("kind", [FLOAT, UBYTE, USHORT])
def test_skin_is_posed_by_its_joints_not_by_its_node(build, glb, kind):
    top = {FLOAT: 1, UBYTE: 255, USHORT: 65535}[kind]
    upper = np.array(CORNERS)[:, 2] > 0
    weights = np.where(upper[:, None], [0, top, 0, 0], [top, 0, 0, 0])
    down = np.eye(4)
    down[2, 3] = -1  # the second joint was bound where it stands
    skinned(build, np.tile([0, 1, 0, 0], (8, 1)), weights, kind, [np.eye(4), down])
    # Below: joint 1 stands at 6, bound at 0. Above: joint 2 stands at 1, bound there.
    assert measure(build.write(glb)) == (-6, [0, 0, 3], [1, 2, 6])
    assert "Skin 0 poses mesh 0" in notes(glb)


def test_weights_blend_matrices(build, glb):
    upper = np.array(CORNERS)[:, 2] > 0
    weights = np.where(upper[:, None], [0.25, 0.75, 0, 0], [0, 1, 0, 0])
    skinned(build, np.tile([0, 1, 0, 0], (8, 1)), weights)
    assert measure(build.write(glb)) == (2 * (3 + 0.25 * 5), [0, 0, 1], [1, 2, 1 + 3 + 0.25 * 5])


def test_inverse_bind_matrix_comes_before_the_joint(build, glb):
    shift = np.eye(4)
    shift[0, 3] = 10
    skinned(build, np.zeros((8, 4)), np.tile([1, 0, 0, 0], (8, 1)), matrices=[shift] * 2)
    build.document["nodes"][1]["rotation"] = [0, 0, 1, 0]  # half a turn about z: x and y change sign
    volume, low, high = measure(build.write(glb))
    np.testing.assert_allclose([volume, *low, *high], [6, -11, -2, 6, -10, 0, 9], atol=1e-12)


def test_weights_that_nearly_sum_to_one_are_brought_to_it(build, glb):
    skinned(build, np.zeros((8, 4)), np.tile([0.5, 0.498046875, 0, 0], (8, 1)))  # both of the joint at height 6
    volume, low, high = measure(build.write(glb))
    np.testing.assert_allclose([volume, *low, *high], [6, 0, 0, 6, 1, 2, 9], atol=1e-12)


def test_mirroring_joints_turn_faces_over(build, glb):
    skinned(build, np.zeros((8, 4)), np.tile([1, 0, 0, 0], (8, 1)), matrices=[np.diag([-1, 1, 1, 1])] * 2)
    assert measure(build.write(glb)) == (6, [-1, 0, 6], [0, 2, 9])


def test_second_set_of_joints(build, glb):
    skinned(build, np.zeros((8, 4)), np.tile([0.5, 0, 0, 0], (8, 1)))
    attributes = build.document["meshes"][0]["primitives"][0]["attributes"]
    attributes["JOINTS_1"] = build.accessor(np.ones((8, 4)), USHORT)
    attributes["WEIGHTS_1"] = build.accessor(np.tile([0.5, 0, 0, 0], (8, 1)))
    assert measure(build.write(glb)) == (6, [0, 0, 3.5], [1, 2, 6.5])


# --------------------------------------------------------------------------
# Extensions


@pytest.mark.parametrize("name", ["KHR_draco_mesh_compression", "KHR_meshopt_compression", "ACME_bent_space"])
def test_required_extension_is_refused_by_name(build, glb, name):
    build.node(mesh=build.box())
    build.document |= {"extensionsUsed": [name], "extensionsRequired": [name]}
    with pytest.raises(MeshFormatError, match=f"requires {name}"):
        read_gltf(build.write(glb))


def test_optional_extension_is_told_and_its_uncompressed_form_read(build, glb):
    packed = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
    build.node(mesh=build.box(extensions=packed))
    build.document["extensionsUsed"] = ["KHR_draco_mesh_compression", "ACME_bent_space", "KHR_materials_unlit"]
    assert measure(build.write(glb))[0] == 6
    assert "KHR_draco_mesh_compression is optional here: the uncompressed form is read" in notes(glb)
    assert "The optional extensions ACME_bent_space are not known" in notes(glb)
    for key in ("bufferView", "byteOffset"):
        del build.document["accessors"][0][key]
    with pytest.raises(MeshFormatError, match="POSITION of primitive 0 of mesh 0.*KHR_draco_mesh_compression only"):
        read_gltf(build.write(glb))


def test_view_that_only_an_extension_fills_is_refused_by_name(build, glb):
    build.node(mesh=build.box())
    view = build.document["bufferViews"][0]
    view |= {"buffer": 1, "extensions": {"EXT_meshopt_compression": {"buffer": 0}}}
    build.document["buffers"] = [{"byteLength": len(build.data)}, {"byteLength": 96}]
    with pytest.raises(MeshFormatError, match="BufferView 0 is stored by EXT_meshopt_compression only"):
        read_gltf(build.write(glb))
    view["buffer"] = 0  # a fallback that is there is read
    assert measure(build.write(glb))[0] == 6


def test_harmless_extensions_may_be_required(build, glb):
    build.node(mesh=build.box())
    build.document["extensionsRequired"] = ["KHR_texture_transform", "KHR_materials_unlit", "KHR_mesh_quantization"]
    assert measure(build.write(glb))[0] == 6


# --------------------------------------------------------------------------
# Limits


def test_limits_are_told_before_memory_is_asked_for(build, glb, monkeypatch):
    monkeypatch.setitem(gltf_shares.MOST, "faces", (100, 0))
    shifts = build.accessor([[k, 0, 0] for k in range(9)])
    build.node(mesh=build.box(), extensions={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": shifts}}})
    with pytest.raises(MeshFormatError, match="108 faces .* at most 100 are read"):
        read_gltf(build.write(glb))
