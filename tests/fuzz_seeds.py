"""Small sound files of every kind that is read, for mutations to begin with."""

import io
import json
import zipfile
from functools import cache

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from corpus.layout import STATUS_SCHEMA
from corpus.storage import GEOPARQUET, TABLE, VERSION
from gltf_files import BOX, CORNERS, UBYTE, Builder, pack_glb, skinned
from mesh_writers import obj_text, off_text, ply_bytes, stl_bytes, stl_text
from reebslice.formats.graphml import Graph, graphml_text
from reebslice.schemas import FORMAT_VERSION, SCHEMAS, file_schema
from threemf_files import ROOT, box, group, model_xml, relationships

POINTS = np.array(CORNERS, float)
TRIANGLES = np.reshape(BOX, (-1, 3)).tolist()
POLYGONS = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
# An outline with a notch, closed by a fan of triangles to a point above it.
NOTCHED = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 1, 0], [0, 4, 0], [2, 0.5, 3]], float)
FAN = [[4, 3, 2, 1, 0], *([k, (k + 1) % 5, 5] for k in range(5))]
STRIPS = (
    b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    b"property uchar red\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
)
OFF_BINARY = b"OFF BINARY\n" + np.array([4, 4, 0], ">i4").tobytes() + np.eye(4, 3, dtype=">f4").tobytes()
LOOP = bytes.fromhex("010200000004000000") + np.array([[0, 0], [1, 0], [0, 1], [0, 0]], "<f8").tobytes()


def _strips():
    rows = b"".join(point.tobytes() + b"\7" for point in np.eye(4, 3, dtype="<f4"))
    return STRIPS + rows + np.array([7, 0, 1, 2, 3, -1, 0, 1], "<i4").tobytes()


def _binary_off():
    faces = [(3, 2, 1, 0, 0), (3, 0, 1, 3, 0), (3, 1, 2, 3, 0), (3, 2, 0, 3, 1, 9)]
    return OFF_BINARY + b"".join(np.array(one, ">i4").tobytes() for one in faces)


def _gltf():
    """A skinned box, and an instanced and morphed one: the more is used, the more damage can do."""
    build = Builder()
    skinned(build, np.zeros((8, 4)), np.tile([255, 0, 0, 0], (8, 1)), UBYTE, [np.eye(4)] * 2)
    targets = [{"POSITION": build.accessor(CORNERS, sparse=[1, 2], base=False)}]
    shifts = {"TRANSLATION": build.accessor([[9, 0, 0], [0, 9, 0]]), "ROTATION": build.accessor([[0, 0, 0, 1]] * 2)}
    mesh = build.box(CORNERS, targets=targets)
    build.document["meshes"][mesh]["weights"] = [0.5]
    extension = {"EXT_mesh_gpu_instancing": {"attributes": shifts}}
    build.node(mesh=mesh, extensions=extension, rotation=[0, 0, 0, 1])
    strip = build.accessor([0, 1, 2, 3, 255, 4, 5, 6], UBYTE)
    corners = build.accessor(CORNERS, gap=4)
    strips = [{"attributes": {"POSITION": corners}, "indices": strip, "mode": mode} for mode in (5, 6)]
    build.node(mesh=build.add("meshes", primitives=strips), matrix=np.diag([1, 1, -1, 1]).ravel().tolist())
    build.document["extensionsUsed"] = ["KHR_mesh_primitive_restart", "EXT_mesh_gpu_instancing"]
    return build


def _glb():
    build = _gltf()
    build.document["buffers"] = [{"byteLength": len(build.data)}]
    return pack_glb(json.dumps(build.document).encode(), build.data)


def _gltf_text():
    from base64 import b64encode

    build = _gltf()
    data = "data:application/octet-stream;base64," + b64encode(build.data).decode()
    build.document["buffers"] = [{"byteLength": len(build.data), "uri": data}]
    return json.dumps(build.document).encode()


def threemf_parts():
    """The parts of a package, as {name: text}: two model parts, components, a mirrored copy, a slicer's settings."""
    use = 'objectid="1" transform="-1 0 0 0 1 0 0 0 1 9 0 0"'
    items = '<item objectid="3"/><item objectid="1" p:path="/3D/b.model"/>'
    root = model_xml(box() + box(2, more='type="support"') + group(3, use, 'objectid="2"'), items)
    slow = model_xml(box()).replace('<vertex x="0"', '<!-- slow --><vertex x="0"', 1)
    roles = '<config><object id="1"><part id="1" subtype="negative_part"/></object></config>'
    parts = {"_rels/.rels": relationships("/" + ROOT), ROOT: root, "3D/b.model": slow}
    return parts | {"Metadata/model_settings.config": roles}


def pack(parts, methods=(zipfile.ZIP_DEFLATED,)):
    """A package of parts, packed by the methods in turn."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for k, (name, text) in enumerate(parts.items()):
            archive.writestr(zipfile.ZipInfo(name), text, methods[k % len(methods)])
    return file.getvalue()


@cache
def mesh_files():
    """{ending: [bytes]} of sound meshes."""
    meshes = [(POINTS, POLYGONS), (NOTCHED, FAN)]
    return {
        ".stl": [stl_bytes(POINTS, TRIANGLES), stl_text(POINTS, TRIANGLES).encode()],
        ".obj": [obj_text(*mesh).encode() for mesh in meshes]
        + [b"v 0 0 0\nv 1 0 0 1\nv 0 1 0 0.5\nf -3//1 -2/7/8 \\\n-1\nl 1 2\n"],
        ".ply": [ply_bytes(*mesh, order, kind) for mesh in meshes for order in ("", "<", ">") for kind in ("float",)]
        + [_strips()],
        ".off": [off_text(*mesh).encode() for mesh in meshes]
        + [_binary_off(), b"COFF 4 1 0\n# c\n0 0 1 9 9 9 9\n1 0 0\n0 1 0\n0 0 0\n3 0 1 2\n"]
        + [b"OFF\n3 1 0\n0 0 0 1 0 0 0 1 0 3 0 1 2\n"],
        ".gltf": [_gltf_text()],
        ".glb": [_glb()],
        ".3mf": [pack(threemf_parts())],
    }


def graph_files():
    """GraphML of two small graphs."""
    rows = ((0.5, "A", True), (1.5, "B<&>", False), (-1e300, "", True))
    nodes = {str(k): {"x": x, "side": side, "flag": flag} for k, (x, side, flag) in enumerate(rows)}
    edges = [
        ("0", "1", {"id": "e0", "level": 3}),
        ("0", "1", {"id": "e1", "level": 4}),
        ("1", "2", {"id": "e2", "level": -1}),
    ]
    graphs = Graph(nodes, edges), Graph({"0": {"x": float("nan")}}, [])
    return [graphml_text(graph, "solid", {"model": "a & b", "z": 1.0}).encode() for graph in graphs]


def table(name, rows=5):
    """A table that matches its declaration, and whose numbers mean nothing."""
    make = {
        pa.int32(): lambda k: k,
        pa.int64(): lambda k: k,
        pa.float64(): lambda k: k / 3,
        pa.bool_(): lambda k: k % 2 == 0,
        pa.string(): lambda k: f"word {k}",
        pa.binary(): lambda k: LOOP,
    }
    schema = file_schema(name) if name in SCHEMAS else STATUS_SCHEMA
    columns = []
    for field in schema:
        one = make.get(field.type) or (lambda k, of=field.type: [k] * (k % 3) if pa.types.is_list(of) else None)
        columns.append(pa.array([one(k) for k in range(rows)], field.type))
    metadata = {TABLE: name.encode(), VERSION: FORMAT_VERSION.encode(), b"geo": json.dumps(GEOPARQUET).encode()}
    return pa.Table.from_arrays(columns, schema=schema).replace_schema_metadata(metadata)


def parquet_bytes(values, **style):
    """A table as a Parquet file."""
    file = io.BytesIO()
    pq.write_table(values, file, **style)
    return file.getvalue()
