"""What a few bytes ask for is held against what is there: all files here are small, and the bounds are lowered."""

import json
import struct
import tracemalloc
import zipfile

import numpy as np
import pytest

from gltf_files import CORNERS, SIDES, UBYTE, USHORT, Builder, measure, pack_glb
from mesh_writers import stl_text
from reebslice.errors import MeshFormatError
from reebslice.formats import gltf_shares, packages, step_tessellation, threemf_scene
from reebslice.formats.gltf import read_gltf
from reebslice.formats.meshes import LONGEST, read_mesh
from reebslice.formats.step import _POINT
from threemf_files import ROOT, box, group, mesh_xml, model_xml, refusal, volume, write

MEGABYTE = 1 << 20


def peak(read, *arguments):
    """How many bytes reading takes at once, a refusal among them."""
    tracemalloc.start()
    try:
        read(*arguments)
    except MeshFormatError:
        pass
    finally:
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return found


def refused(path):
    with pytest.raises(MeshFormatError) as caught:
        read_mesh(path)
    return str(caught.value)


# --------------------------------------------------------------------------
# 3MF


def test_a_part_is_not_unpacked_beyond_what_it_declares(tmp_path):
    """A few megabytes behind a declared size of a few hundred bytes, in the list of parts alone."""
    path = write(tmp_path, model_xml(box()) + " " * (8 * MEGABYTE))
    data = bytearray(path.read_bytes())
    at = data.rfind(b"PK\x01\x02")
    data[at + 24 : at + 28] = struct.pack("<I", 500)
    path.write_bytes(data)
    assert "cannot be unpacked" in refusal(path)
    assert peak(refusal, path) < MEGABYTE


def test_a_part_that_holds_less_than_it_declares_is_damaged(tmp_path):
    path = write(tmp_path, model_xml(box()))
    data = bytearray(path.read_bytes())
    at = data.rfind(b"PK\x01\x02")
    data[at + 24 : at + 28] = struct.pack("<I", 90_000)
    path.write_bytes(data)
    assert "unpacks to" in refusal(path) and "90000" in refusal(path)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_methods_of_packing_that_packages_do_not_have_are_refused(tmp_path, method):
    path = tmp_path / "a.3mf"
    with (
        zipfile.ZipFile(write(tmp_path, model_xml(box()), name="b.3mf")) as sound,
        zipfile.ZipFile(path, "w") as archive,
    ):
        for name in sound.namelist():
            archive.writestr(name, sound.read(name), method)
    assert f"packed by method {method}" in refusal(path)


def test_parts_that_are_not_used_are_not_unpacked(tmp_path, monkeypatch):
    parts = {"3D/other.model": model_xml(box()), "Metadata/thumbnail.png": "x" * 1000, "a.xml": "x" * 1000}
    path = write(tmp_path, model_xml(box()), parts)
    opened = []
    monkeypatch.setattr(zipfile.ZipFile, "open", _note(zipfile.ZipFile.open, opened))
    assert volume(read_mesh(path)) == 1 and opened == ["_rels/.rels", ROOT]


def _note(method, names):
    def called(self, entry, *more):
        names.append(entry.filename)
        return method(self, entry, *more)

    return called


def test_the_bound_on_a_part_is_told_with_name_size_and_cure(tmp_path, monkeypatch):
    monkeypatch.setattr(packages, "LARGEST_PART", 2000)
    told = refusal(write(tmp_path, model_xml(box()) + " " * 5000))
    assert f"/{ROOT} unpacks to" in told and "at most 2000 bytes for one part" in told and "fewer triangles" in told


def test_vertices_that_no_triangle_uses_are_counted_where_they_are_placed(tmp_path, monkeypatch):
    monkeypatch.setattr(threemf_scene, "MOST_TRIANGLES", 20_000)
    lone = mesh_xml().replace("</vertices>", '<vertex x="0" y="0" z="0"/>' * 100 + "</vertices>")
    groups = [group(k, *[f'objectid="{k - 1}"'] * 9) for k in range(2, 5)]
    xml = model_xml(f'<object id="1">{lone}</object>' + "".join(groups), '<item objectid="4"/>')
    assert "places 78732 triangles (or vertices)" in refusal(write(tmp_path, xml))


def test_copies_that_have_more_digits_than_the_file_has_bytes_are_not_counted(tmp_path):
    groups = [group(k, *[f'objectid="{k - 1}"'] * 9) for k in range(2, 60)]
    told = refusal(write(tmp_path, model_xml(box() + "".join(groups), '<item objectid="59"/>')))
    assert f"{threemf_scene.UNCOUNTED} objects and more" in told


def test_names_of_nested_elements_do_not_add_up(tmp_path):
    tags = [f"e{k}{'x' * 20_000}" for k in range(100)]
    xml = model_xml(box() + "".join(f"<{tag}>" for tag in tags) + "".join(f"</{tag}>" for tag in tags[::-1]))
    path = write(tmp_path, xml)
    assert peak(read_mesh, path) < 8 * len(xml)


# --------------------------------------------------------------------------
# glTF


@pytest.fixture
def build():
    return Builder()


@pytest.fixture
def glb(tmp_path):
    return tmp_path / "model.glb"


def test_elements_that_are_read_again_and_again_are_bounded(build, glb, monkeypatch):
    mesh = build.box()
    build.document["meshes"][mesh]["primitives"] *= 50
    build.node(mesh=mesh)
    assert measure(build.write(glb))[0] == 300
    monkeypatch.setitem(gltf_shares.MOST, "elements", (1000, 0))
    with pytest.raises(MeshFormatError, match="elements and more, .* at most 1000 are read"):
        read_gltf(glb)


def test_places_of_parts_are_bounded(build, glb, monkeypatch):
    mesh = build.box()
    for _ in range(20):
        build.node(mesh=mesh)
    monkeypatch.setitem(gltf_shares.MOST, "places", (19, 0))
    with pytest.raises(MeshFormatError, match="asks for 20 places and more"):
        read_gltf(build.write(glb))


@pytest.mark.parametrize("shared", ["by nodes", "by primitives"])
def test_a_small_file_places_no_more_than_four_million_vertices(build, glb, shared):
    mesh = build.box(np.tile(CORNERS, (2500, 1)))
    primitives = build.document["meshes"][mesh]["primitives"]
    primitives[0]["indices"] = build.accessor(np.arange(19_998), USHORT)
    if shared == "by primitives":
        primitives *= 220
    for _ in range(220 if shared == "by nodes" else 1):
        build.node(mesh=mesh)
    path = build.write(glb)
    with pytest.raises(MeshFormatError, match="vertices and more, of a file of .* at most 4194304 are read"):
        read_gltf(path)
    assert peak(read_gltf, path) < (4 if shared == "by nodes" else 200) * MEGABYTE


def test_primitives_that_use_little_of_a_long_accessor_hold_no_copies_of_it(build, glb):
    corners = np.concatenate([CORNERS[:2], np.full((20_000, 3), 9.0), CORNERS[2:]])
    position, places = build.accessor(corners), np.array([0, 1, *range(20_002, 20_008)])
    sides = [places[[a, b, c, a, c, d]] for a, b, c, d in SIDES]
    primitives = [{"attributes": {"POSITION": position}, "indices": build.accessor(ids, USHORT)} for ids in sides * 20]
    build.node(mesh=build.add("meshes", primitives=primitives))
    assert measure(build.write(glb)) == (pytest.approx(20 * 6), [0, 0, 0], [1, 2, 3])
    assert len(read_gltf(glb).points) <= 20 * 8 * len(SIDES) and peak(read_gltf, glb) < 3 * MEGABYTE


def test_zeros_that_no_bytes_hold_are_held_against_the_size_of_the_file(build, glb):
    index = build.accessor(np.ones((3, 3)), sparse=[0, 1, 2], base=False)
    build.document["accessors"][index]["count"] = 300_000
    build.node(mesh=build.add("meshes", primitives=[{"attributes": {"POSITION": index}}]))
    with pytest.raises(MeshFormatError, match="declares 300000 elements without a bufferView"):
        read_gltf(build.write(glb))


def test_a_file_that_many_buffers_name_is_held_once(build, tmp_path):
    (tmp_path / "a.bin").write_bytes(np.tile(np.float32(CORNERS[:3]).ravel(), 30_000).tobytes())
    for kind, one in (("buffers", {"uri": "a.bin", "byteLength": 1_080_000}), ("bufferViews", {"byteLength": 36})):
        build.document[kind] = [one | ({"buffer": k} if "uri" not in one else {}) for k in range(50)]
    for k in range(50):
        build.add("accessors", bufferView=k, componentType=5126, count=3, type="VEC3")
    build.node(mesh=build.add("meshes", primitives=[{"attributes": {"POSITION": k}} for k in range(50)]))
    path = build.write(tmp_path / "model.gltf")
    assert len(read_gltf(path).faces) == 50
    assert peak(read_gltf, path) < 2 * MEGABYTE


def test_restarts_without_triangles_between_take_no_memory_each(build, glb):
    build.document["extensionsUsed"] = ["KHR_mesh_primitive_restart"]
    indices = build.accessor([0, 1, 2, *[255] * 50_000, 4, 5, 6, 7], UBYTE)
    primitive = {"attributes": {"POSITION": build.accessor(CORNERS)}, "indices": indices, "mode": 5}
    build.node(mesh=build.add("meshes", primitives=[primitive]))
    build.write(glb)
    assert len(read_gltf(glb).faces) == 3 and peak(read_gltf, glb) < 3 * MEGABYTE


def test_joints_are_listed_once_and_their_sets_are_bounded(build, glb):
    mesh = build.box()
    attributes = build.document["meshes"][mesh]["primitives"][0]["attributes"]
    joints, weights = build.accessor(np.zeros((8, 4)), UBYTE), build.accessor(np.tile([1.0, 0, 0, 0], (8, 1)))
    for k in range(5):
        attributes |= {f"JOINTS_{k}": joints, f"WEIGHTS_{k}": weights}
    build.node(mesh=mesh, skin=build.add("skins", joints=[0]))
    with pytest.raises(MeshFormatError, match="5 sets of joints and weights; at most 4"):
        read_gltf(build.write(glb))
    build.document["skins"][0]["joints"] = [0, 0]
    with pytest.raises(MeshFormatError, match="lists a joint twice"):
        read_gltf(build.write(glb))


# --------------------------------------------------------------------------
# Text, and what is told


@pytest.mark.parametrize("size", ["nan", "2.5", "-nan", "1e30"])
def test_sizes_of_faces_that_are_no_whole_numbers_are_told_by_the_face(tmp_path, size):
    path = tmp_path / "a.off"
    path.write_text(f"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n{size} 0 1 2\n")
    assert "face 1 is missing or names fewer vertices" in refused(path)


def test_counts_beyond_all_numbers_are_told(tmp_path):
    path = tmp_path / "a.off"
    path.write_text(f"OFF\n{'9' * 5000} 1 0\n0 0 0\n")
    assert "where its numbers of vertices and faces are due" in refused(path)
    path = tmp_path / "a.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {'9' * 5000}\n")
    assert "Face 1 (line 4" in refused(path)


def test_faults_of_faces_on_one_line_are_told_without_lines(tmp_path):
    path = tmp_path / "a.off"
    path.write_text("OFF\n3 1 0\n0 0 0 1 0 0 0 1 0 3 0 1 7\n")
    assert "in face 0: vertex 7" in refused(path)


def test_words_of_one_long_line_are_looked_at_once(tmp_path):
    """A line of twenty thousand words `vertex` would take minutes if each were held against all that follow."""
    path = tmp_path / "a.stl"
    text = stl_text([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).replace("vertex 0.0", "vertex x", 1)
    path.write_text(text.replace("endsolid", "facet " + "vertex " * 21_000 + "\nendsolid"))
    assert peak(refused, path) < 20 * path.stat().st_size


def test_elements_of_a_long_header_are_looked_at_once(tmp_path, monkeypatch):
    path = tmp_path / "a.ply"
    more = "element a 1\nproperty char x\n" * 300
    head = f"ply\nformat ascii 1.0\n{more}element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    tail = "element face 1\nproperty list uchar int vertex_index\nend_header\n"
    path.write_text(head + tail + "7\n" * 300 + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    assert read_mesh(path).faces.tolist() == [[0, 1, 2]]


def test_sentences_are_one_line_of_bounded_length(tmp_path):
    path = tmp_path / "a.ply"
    path.write_bytes(b"ply\nformat \x07\x1b[31m" + b"x" * 9000 + b"\n")
    told = refused(path)
    assert told.isprintable() and len(told) <= LONGEST + 5 and told.endswith("export it as one.")


def test_assemblies_that_multiply_are_refused_before_they_are_held(monkeypatch):
    monkeypatch.setattr(step_tessellation, "MOST_TRIANGLES", 0)
    build = Builder()
    mesh = build.box()
    build.document["meshes"][mesh]["primitives"] *= 4
    for _ in range(2000):
        build.node(mesh=mesh)
    data = _pack(build)
    with pytest.raises(MeshFormatError, match=f"more than {len(data)} triangles, copies included"):
        step_tessellation.parse_glb(data)


def _pack(build):
    """The bytes of a .glb file as OpenCascade writes it, with the box of each accessor."""
    for entry in build.document["accessors"]:
        entry |= {"min": [0, 0, 0], "max": [1, 1, 1]}
    return pack_glb(json.dumps(build.document).encode(), build.data)


def test_texts_in_step_files_are_passed_in_one_go():
    text = b"#1=CARTESIAN_POINT('it''s " + b"''" * 50_000 + b"',(1.,2.,3.));#2=CARTESIAN_POINT('" + b"x" * 200_000
    assert [found.group(2, 3, 4) for found in _POINT.finditer(text)] == [(b"1.", b"2.", b"3.")]
