"""Write glTF 2.0 files for tests: JSON and struct, nothing of a library."""

import base64
import json
import struct
from urllib.parse import quote

import numpy as np

from reebslice.formats.gltf import read_gltf

FLOAT, BYTE, UBYTE, SHORT, USHORT, UINT = 5126, 5120, 5121, 5122, 5123, 5125
TYPES = {FLOAT: "<f4", BYTE: "i1", UBYTE: "u1", SHORT: "<i2", USHORT: "<u2", UINT: "<u4"}
SHAPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}

# A box of 1 x 2 x 3; its six sides as quadrilaterals, counter-clockwise from outside.
CORNERS = [[x, y, z] for z in (0, 3) for x, y in ((0, 0), (1, 0), (1, 2), (0, 2))]
SIDES = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
BOX = [corner for a, b, c, d in SIDES for corner in (a, b, c, a, c, d)]


class Builder:
    """A glTF document under construction; every method returns the index of what it adds."""

    def __init__(self):
        self.data = b""
        self.document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}

    def add(self, kind, **entry):
        entries = self.document.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def view(self, data, **more):
        self.data += bytes(-len(self.data) % 4)
        start, self.data = len(self.data), self.data + data
        return self.add("bufferViews", buffer=0, byteOffset=start, byteLength=len(data), **more)

    def accessor(self, values, kind=FLOAT, normalized=False, gap=0, before=0, sparse=None, base=True):
        """Elements with `gap` bytes between and `before` bytes ahead; rows `sparse` are replaced, of no base if so."""
        values = np.array(values, TYPES[kind])
        values = values.reshape(len(values), -1)
        entry = {"componentType": kind, "count": len(values), "type": SHAPES[values.shape[1]]}
        if normalized:
            entry["normalized"] = True
        stored = values.copy()
        if sparse is not None:
            stored[sparse] = 7 if base else 0
            places = self.view(np.array(sparse, "<u2").tobytes())
            entry["sparse"] = {
                "count": len(sparse),
                "indices": {"bufferView": places, "componentType": USHORT},
                "values": {"bufferView": self.view(values[sparse].tobytes())},
            }
        if base:
            data = bytes(before) + b"".join(row.tobytes() + b"\xaa" * gap for row in stored)
            stride = {"byteStride": stored[0].nbytes + gap} if gap else {}
            entry |= {"bufferView": self.view(data, **stride), "byteOffset": before}
        return self.add("accessors", **entry)

    def box(self, corners=CORNERS, **primitive):
        """A mesh of one box."""
        attributes = {"POSITION": self.accessor(corners)}
        indices = self.accessor(BOX, USHORT)
        return self.add("meshes", primitives=[{"attributes": attributes, "indices": indices, **primitive}])

    def node(self, root=True, **entry):
        index = self.add("nodes", **entry)
        if root:
            self.document["scenes"][0]["nodes"].append(index)
        return index

    def write(self, path, uri=None):
        """Write .glb, or .gltf whose buffer is the file `uri` beside it, or a data: URI if that is "data"."""
        document = dict(self.document)
        buffer = {"byteLength": len(self.data)}
        if uri == "data":
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        elif uri is not None:
            buffer["uri"] = quote(uri)
            (path.parent / uri).parent.mkdir(exist_ok=True)
            (path.parent / uri).write_bytes(self.data)
        document.setdefault("buffers", [buffer])
        text = json.dumps(document).encode()
        path.write_bytes(text if path.suffix == ".gltf" else pack_glb(text, self.data))
        return path


def pack_glb(text, data=b"", version=2):
    """Return the bytes of a GLB file."""
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(data), 0x004E4942) + data if data else b""
    return struct.pack("<4sII", b"glTF", version, 12 + len(chunks)) + chunks


def measure(path):
    """Signed volume and bounds of what a file holds; inside out is negative."""
    points, faces, unit, _ = read_gltf(path)
    assert unit == "metre" and points.dtype == np.float64 and faces.max() < len(points)
    a, b, c = (points[faces[:, k]] for k in range(3))
    used = points[np.unique(faces)]
    return float((a * np.cross(b, c)).sum() / 6), used.min(axis=0).tolist(), used.max(axis=0).tolist()


def skinned(build, joints, weights, kind=FLOAT, matrices=None, **node):
    """Add a box whose joints, nodes 1 and 2, stand at heights 6 and 1."""
    mesh = build.box()
    attributes = build.document["meshes"][mesh]["primitives"][0]["attributes"]
    attributes["JOINTS_0"] = build.accessor(joints, UBYTE)
    attributes["WEIGHTS_0"] = build.accessor(weights, kind, normalized=kind != FLOAT)
    skin = {"joints": [1, 2]}
    if matrices is not None:
        skin["inverseBindMatrices"] = build.accessor(np.array(matrices, float).transpose(0, 2, 1).reshape(-1, 16))
    build.node(mesh=mesh, skin=build.add("skins", **skin), translation=[1000, 0, 0], **node)
    build.node(root=False, translation=[0, 0, 5])
    build.node(children=[1], translation=[0, 0, 1])
