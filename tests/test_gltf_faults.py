"""glTF 2.0 that is not as the specification says: a sentence names what is wrong, where, and the cure."""

import json

import numpy as np
import pytest
from gltf_files import CORNERS, FLOAT, UBYTE, Builder, pack_glb, skinned
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from reebslice.errors import MeshFormatError
from reebslice.formats.gltf import list_companions, read_gltf


@pytest.fixture
def build():
    return Builder()


@pytest.fixture
def glb(tmp_path):
    return tmp_path / "model.glb"


def entry(kind, index, **values):
    """A change of one entry of the document; None takes the key out."""

    def change(document):
        document[kind][index].update(values)
        for key in [key for key, value in values.items() if value is None]:
            del document[kind][index][key]

    return change


FAULTS = {
    "version 1": (lambda d: d["asset"].update(version="1.0"), "glTF 1.0"),
    "laid out as 1.0": (lambda d: d.update(asset={}, meshes={"box": {}}), "glTF 1.0"),
    "version 3": (lambda d: d["asset"].update(version="3.0"), "glTF 3.0"),
    "needs 2.1": (lambda d: d["asset"].update(version="2.1", minVersion="2.1"), "glTF 2.1"),
    "no version": (lambda d: d.update(asset={}), "no version"),
    "accessor too long": (
        entry("accessors", 0, count=9),
        r"Accessor 0 \(POSITION of primitive 0 of mesh 0\).*byte 108",
    ),
    "huge count": (entry("accessors", 0, count=10**15), "Accessor 0"),
    "huge count without indices": (
        lambda d: (entry("accessors", 0, count=10**15)(d), d["meshes"][0]["primitives"][0].pop("indices")),
        "Accessor 0",
    ),
    "zeros without end": (entry("accessors", 1, bufferView=None, count=10**12), "1000000000000 elements without"),
    "view too long": (entry("bufferViews", 0, byteLength=10**9), "BufferView 0 ends at byte 1000000000 of buffer 0"),
    "view of no buffer": (entry("bufferViews", 0, buffer=7), "BufferView 0 names entry 7 of buffers"),
    "no view": (entry("accessors", 0, bufferView=9), "Accessor 0 .* names entry 9 of bufferViews"),
    "no accessor": (
        lambda d: d["meshes"][0]["primitives"][0].update(indices=5),
        "indices .* names entry 5 of accessors",
    ),
    "stride too small": (
        entry("bufferViews", 0, byteStride=8),
        "elements of 12 bytes, but BufferView 0 has byteStride 8",
    ),
    "stride of indices": (entry("bufferViews", 1, byteStride=4), "tightly packed, but BufferView 1"),
    "type": (entry("accessors", 0, type="VEC4"), "'VEC4' of componentType 5126; allowed are VEC3"),
    "component type": (entry("accessors", 0, componentType=5124), "componentType 5124"),
    "float indices": (entry("accessors", 1, componentType=FLOAT), "componentType 5126; allowed are SCALAR"),
    "mode": (lambda d: d["meshes"][0]["primitives"][0].update(mode=7), "mode 7"),
    "not threes": (entry("accessors", 1, count=35), "primitive 0 of mesh 0 has 35 corners"),
    "short strip": (
        lambda d: (entry("accessors", 1, count=2)(d), d["meshes"][0]["primitives"][0].update(mode=5)),
        "at least three",
    ),
    "vertex": (entry("accessors", 0, count=7), r"Accessor 1 \(indices .* names vertex 7 at place 11, but there are 7"),
    "beyond whole numbers": (entry("accessors", 0, count=10**400), "whole number"),
    "no mesh": (entry("nodes", 0, mesh=3), "Node 0 names entry 3 of meshes"),
    "no scene": (lambda d: d.update(scene=2), "entry 2 of scenes"),
    "circle": (lambda d: d["nodes"].extend([{"children": [2]}, {"children": [3]}, {"children": [2]}]), "two|parent"),
    "own ancestor": (lambda d: d["nodes"].extend([{"children": [2]}, {"children": [1]}]), "is its own ancestor"),
    "two parents": (
        lambda d: (d["nodes"].extend([{"children": [0]}, {"children": [0]}]), d["scenes"][0].update(nodes=[1, 2])),
        "Node 0 is a child of node 1 and again of node 2",
    ),
    "scene lists a child": (
        lambda d: d["nodes"].append({"children": [0], "scale": [2, 2, 2]}),
        "lists node 0, which is no root node but a child of node 1",
    ),
    "scene lists parent and child": (
        lambda d: (d["nodes"].append({"children": [0]}), d["scenes"][0].update(nodes=[0, 1])),
        "shows node 0 twice",
    ),
    "scene lists twice": (lambda d: d["scenes"][0].update(nodes=[0, 0]), "shows node 0 twice"),
    "matrix": (entry("nodes", 0, matrix=[1, 0, 0]), "Node 0 has matrix"),
    "matrix and scale": (entry("nodes", 0, matrix=[1.0] + [0] * 14 + [1], scale=[1, 1, 1]), "keep one"),
    "projective matrix": (entry("nodes", 0, matrix=[1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "last row"),
    "rotation of no length": (entry("nodes", 0, rotation=[0, 0, 0, 0]), "Node 0 has .* rotation .* of length 0;"),
    "version 1 as a number": (lambda d: d["asset"].update(version=1), "glTF 1,"),
    "version 1.0.1": (lambda d: d["asset"].update(version="1.0.1"), "glTF 1.0.1,"),
    "not a number": (entry("nodes", 0, translation=[0, float("nan"), 0]), "Node 0 has translation"),
    "text for a number": (entry("nodes", 0, mesh="box"), "Node 0 has mesh = 'box'"),
    "negative": (entry("bufferViews", 0, byteOffset=-4), "byteOffset = -4"),
    "list for an object": (lambda d: d["meshes"][0]["primitives"][0].update(attributes=[]), "attributes"),
    "number for a list": (lambda d: d.update(nodes=4), "nodes = 4"),
    "weights": (entry("nodes", 0, weights=[1]), "0 morph targets but 1 weights"),
    "skin without joints": (lambda d: (entry("nodes", 0, skin=0)(d), d.update(skins=[{"joints": [0]}])), "no JOINTS_0"),
    "absolute": (
        lambda d: d.update(buffers=[{"byteLength": 9, "uri": "/etc/hostname"}]),
        "'/etc/hostname'; only a path",
    ),
    "encoded absolute": (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "%2Fetc%2Fhostname"}]), "only a path"),
    "address": (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "https://x.example/a.bin"}]), "only a path"),
    "file scheme": (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "file:///a.bin"}]), "only a path"),
    "query": (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "a.bin?x=1"}]), "only a path"),
    "missing file": (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "no%20such.bin"}]), "'no such.bin' beside"),
    "bad base64": (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "data:;base64,*"}]), "not base64"),
    "short buffer": (
        lambda d: d.update(buffers=[{"byteLength": 9, "uri": "data:;base64,AAAA"}]),
        "its data: URI has 3",
    ),
    "second buffer without uri": (
        lambda d: (d.update(buffers=[{"byteLength": 9}, {"byteLength": 99}]), entry("bufferViews", 0, buffer=1)(d)),
        "Buffer 1 has neither",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_named(build, glb, fault):
    build.node(mesh=build.box())
    change, sentence = FAULTS[fault]
    change(build.document)
    with pytest.raises(MeshFormatError, match=sentence) as told:
        read_gltf(build.write(glb))
    assert str(told.value).endswith((".", ")"))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda data: data[:-5], "cut off: its header declares"),
        (lambda data: data[:16], "cut off"),
        (lambda data: data[:4] + b"\x01\0\0\0" + data[8:], "binary glTF of version 1"),
        (lambda data: data[:12] + b"\xff\xff\0\0" + data[16:], "Chunk 0 of the GLB file, at byte 12, declares 65535"),
        (lambda data: data[:16] + b"BIN\0" + data[20:], "does not begin with a JSON chunk"),
        (lambda data: data[:20] + b"[" + data[21:], "JSON"),
        (lambda data: b"", "0 bytes"),
        (lambda data: b"{" + data, "JSON"),
        (lambda data: b"[1]", "no object"),
        (lambda data: b"[" * 100000, "cannot be read"),
        (lambda data: b"\xff\xfe{\0}\0", "cannot be read"),
    ],
)
def test_damaged_container_is_named(build, glb, change, sentence):
    build.node(mesh=build.box())
    glb.write_bytes(change(build.write(glb).read_bytes()))
    with pytest.raises(MeshFormatError, match=sentence):
        read_gltf(glb)


def test_primitive_restart_is_refused(build, glb):
    primitive = {"attributes": {"POSITION": build.accessor(CORNERS)}, "mode": 5}
    primitive["indices"] = build.accessor([0, 1, 3, 255, 4, 5, 7], UBYTE)
    build.node(mesh=build.add("meshes", primitives=[primitive]))
    with pytest.raises(MeshFormatError, match="holds 255 at place 3, which would restart"):
        read_gltf(build.write(glb))


@pytest.mark.parametrize("places", [[3, 3], [5, 2], [2, 8]])
def test_sparse_indices_rise_and_stay_inside(build, glb, places):
    build.node(mesh=build.box())
    indices = {"bufferView": build.view(np.array(places, "u1").tobytes()), "componentType": UBYTE}
    values = {"bufferView": build.view(bytes(24))}
    build.document["accessors"][0]["sparse"] = {"count": 2, "indices": indices, "values": values}
    with pytest.raises(MeshFormatError, match="Accessor 0 .* sparse indices that do not rise"):
        read_gltf(build.write(glb))


def test_coordinates_in_use_are_finite(build, glb):
    build.node(mesh=build.box([*CORNERS[:6], [1, np.inf, 3], CORNERS[7], [np.nan] * 3]))
    with pytest.raises(MeshFormatError, match=r"1 vertices .* vertex 6 of Accessor 0 .* at \(1.0, inf, 3.0\)"):
        read_gltf(build.write(glb))


def test_pointer_of_large_file_storage_is_named(build, tmp_path):
    build.node(mesh=build.box())
    path = build.write(tmp_path / "model.gltf", "a.bin")
    (tmp_path / "a.bin").write_bytes(b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 168\n")
    with pytest.raises(MeshFormatError, match="Git LFS pointer"):
        read_gltf(path)


def test_vertex_without_weights_is_named(build, glb):
    skinned(build, np.zeros((8, 4)), [[1, 0, 0, 0]] * 7 + [[0, 0, 0, 0]])
    with pytest.raises(MeshFormatError, match="Vertex 7 of primitive 0 of mesh 0 has joints"):
        read_gltf(build.write(glb))


def test_joint_that_the_skin_has_not_is_named(build, glb):
    skinned(build, np.full((8, 4), 2), np.tile([1, 0, 0, 0], (8, 1)))
    with pytest.raises(MeshFormatError, match="its skin has 2 joints"):
        read_gltf(build.write(glb))


def test_two_bin_chunks_are_refused(build, glb):
    build.node(mesh=build.box())
    data = bytearray(build.write(glb).read_bytes()) + b"\x04\0\0\0BIN\0none"
    data[8:12] = len(data).to_bytes(4, "little")
    glb.write_bytes(data)
    with pytest.raises(MeshFormatError, match="2 BIN chunks"):
        read_gltf(glb)


def test_file_without_nodes_places_nothing(build, glb):
    build.box()
    with pytest.raises(MeshFormatError, match="no triangle"):
        read_gltf(build.write(glb))
    glb.write_bytes(pack_glb(b'{"asset": {"version": "2.0"}}'))
    with pytest.raises(MeshFormatError, match="no triangle"):
        read_gltf(glb)


# --------------------------------------------------------------------------
# Any damage: a mesh or a sentence, nothing else


def rich_file(folder):
    """A file that uses all that is read: the more, the more damage can do."""
    build = Builder()
    skinned(build, np.zeros((8, 4)), np.tile([255, 0, 0, 0], (8, 1)), UBYTE, [np.eye(4)] * 2)
    targets = [{"POSITION": build.accessor(CORNERS, sparse=[1, 2], base=False)}]
    shifts = {"TRANSLATION": build.accessor([[9, 0, 0], [0, 9, 0]]), "ROTATION": build.accessor([[0, 0, 0, 1]] * 2)}
    mesh = build.box(CORNERS, targets=targets)
    build.document["meshes"][mesh]["weights"] = [0.5]
    build.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": shifts}}, rotation=[0, 0, 0, 1])
    return build.write(folder / "rich.gltf", "data")


def list_places(value, path=()):
    """Every key and index of a JSON value, as paths."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [found for key, inner in items for found in [(*path, key), *list_places(inner, (*path, key))]]


JUNK = [
    None,
    True,
    -1,
    0,
    1,
    2,
    7,
    1.5,
    2**31,
    2**70,
    1e308,
    "",
    "x",
    "MAT4",
    [],
    [0],
    [[]],
    {},
    {"x": 1},
    float("nan"),
]


@settings(max_examples=400, deadline=None, derandomize=True, database=None, phases=(Phase.explicit, Phase.generate))
@given(st.data())
def test_damaged_json_gives_a_mesh_or_a_sentence(tmp_path_factory, data):
    path = rich_file(tmp_path_factory.mktemp("rich"))
    document = json.loads(path.read_text())
    for _ in range(data.draw(st.integers(1, 3))):
        places = list_places(document)
        if not places:
            break
        *way, last = data.draw(st.sampled_from(places))
        owner = document
        for key in way:
            owner = owner[key]
        junk = data.draw(st.sampled_from(["out", *JUNK]))
        if junk == "out":
            del owner[last]
        else:
            owner[last] = json.loads(json.dumps(junk))
    path.write_text(json.dumps(document))
    check_mesh_or_sentence(path)


@settings(max_examples=300, deadline=None, derandomize=True, database=None, phases=(Phase.explicit, Phase.generate))
@given(st.data())
def test_damaged_bytes_give_a_mesh_or_a_sentence(tmp_path_factory, data):
    path = rich_file(tmp_path_factory.mktemp("rich"))
    binary = Builder()
    binary.node(mesh=binary.box())
    whole = pack_glb(path.read_bytes()) if data.draw(st.booleans()) else binary.write(path).read_bytes()
    damaged = bytearray(whole[: data.draw(st.integers(0, len(whole)))] if data.draw(st.booleans()) else whole)
    for _ in range(data.draw(st.integers(0, 4)) if damaged else 0):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(damaged)
    check_mesh_or_sentence(path)


def check_mesh_or_sentence(path):
    """Reading gives a sound mesh, or a sentence; naming companions never fails."""
    assert isinstance(list_companions(path), list)
    try:
        points, faces, *_ = read_gltf(path)
    except MeshFormatError as error:
        assert len(str(error)) > 20
        return
    assert len(faces) and faces.min() >= 0 and faces.max() < len(points) and np.isfinite(points[faces]).all()
