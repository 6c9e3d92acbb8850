"""Triangles of a STEP file, as OpenCascade makes them, by way of binary glTF 2.0."""

import json
import re
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..errors import MeshFormatError
from .opencascade import convert_step

MOST_TRIANGLES = 1 << 25  # what is placed many times; what is there once may always be read
METRE = 1000.0  # millimetres in the unit of glTF


class Tessellation(NamedTuple):
    """Triangles of all parts of a STEP file, each part in a frame of its own, in millimetres.

    Attributes
    ----------
    points : (n, 3) float64
        In the frames of the parts; each is a float32 in metres.
    faces : (m, 3) int64
    part : (n,) int64
        The part that each point belongs to.
    matrices : (p, 4, 4) float64
        Places of the parts, applied to column vectors (x, y, z, 1).
    low, high : (p, 3) float64
        Boxes of the parts in their frames, not rounded to float32.
    """

    points: np.ndarray
    faces: np.ndarray
    part: np.ndarray
    matrices: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def world(self):
        """Return the points (n, 3) in place."""
        turned = np.einsum("nij,nj->ni", self.matrices[self.part, :3, :3], self.points)
        return turned + self.matrices[self.part, :3, 3]


def tessellate(data):
    """Return the `Tessellation` of a STEP file.

    Parameters
    ----------
    data : bytes of the file

    Raises
    ------
    MeshFormatError
        OpenCascade cannot read the file, or finds no faces in it.
    """
    if find_spec("cascadio") is None:
        raise ImportError("STEP files are read by the package cascadio, which is not installed: pip install cascadio")
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "model.step"), Path(folder, "model.glb")
        source.write_bytes(data)
        told = Path(folder, "told.txt")
        code = convert_step(source, target, told)
        if code == -9:
            raise MemoryError("the process that reads the STEP file was killed, most likely for want of memory")
        if code or not target.exists():
            text = re.sub(r"\x1b\[[\d;]*m", "", told.read_text(errors="replace") if told.exists() else "")
            lines = [line.strip(" *") for line in text.splitlines() if "ERR" in line]
            told = lines[0][:200] if lines else f"its process ended with {code}"
            raise MeshFormatError(f"OpenCascade cannot read the STEP file ({told}); it is damaged: export it again.")
        return parse_glb(target.read_bytes())


def parse_glb(data):
    """Return the `Tessellation` in binary glTF as OpenCascade writes it.

    Parameters
    ----------
    data : bytes

    Raises
    ------
    MeshFormatError
        There are no faces, or more than `MOST_TRIANGLES` and than `data` has
        bytes, as copies of few.
    """
    length = int.from_bytes(data[12:16], "little")
    scene, buffer = json.loads(data[20 : 20 + length]), data[28 + length :]
    parts, count, triangles = [], 0, 0
    for mesh, matrix in _walk(scene):
        for primitive in scene["meshes"][mesh]["primitives"]:
            if primitive.get("mode", 4) == 4:
                position = scene["accessors"][primitive["attributes"]["POSITION"]]
                points = METRE * _read_accessor(scene, buffer, position).reshape(-1, 3)
                indices = scene["accessors"][primitive["indices"]]
                triangles += indices["count"] // 3
                if triangles > (most := max(MOST_TRIANGLES, len(data))):
                    raise MeshFormatError(
                        f"The STEP file places more than {most} triangles, copies included, which is the most that is"
                        " read; export fewer copies."
                    )
                faces = _read_accessor(scene, buffer, indices).reshape(-1, 3) + count
                box = METRE * np.array([position["min"], position["max"]])
                parts.append(
                    (points, faces.astype(np.int64), np.full(len(points), len(parts)), matrix[None], box[None])
                )
                count += len(points)
    if not parts:
        raise MeshFormatError("The STEP file holds no faces; export the model again, as solids.")
    points, faces, part, matrices, boxes = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Tessellation(points, faces, part, matrices, boxes[:, 0], boxes[:, 1])


def _walk(scene):
    """The meshes of a scene and the (4, 4) matrices in millimetres that place them, in order."""
    nodes = scene.get("nodes", [])
    waiting = [(node, np.eye(4)) for node in reversed(scene["scenes"][scene.get("scene", 0)].get("nodes", []))]
    while waiting:
        number, above = waiting.pop()
        node = nodes[number]
        matrix = above @ _node_matrix(node)
        if "mesh" in node:
            yield node["mesh"], matrix
        waiting += [(child, matrix) for child in reversed(node.get("children", []))]


def _node_matrix(node):
    """The (4, 4) matrix of a node, in millimetres."""
    if "matrix" in node:
        matrix = np.array(node["matrix"], np.float64).reshape(4, 4).T
    else:
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        matrix = np.eye(4)
        matrix[:3, :3] = np.eye(3) + 2 * np.array(
            [
                [-y * y - z * z, x * y - z * w, x * z + y * w],
                [x * y + z * w, -x * x - z * z, y * z - x * w],
                [x * z - y * w, y * z + x * w, -x * x - y * y],
            ]
        )
        matrix[:3, :3] *= node.get("scale", (1, 1, 1))
        matrix[:3, 3] = node.get("translation", (0, 0, 0))
    matrix[:3, 3] *= METRE
    return matrix


_TYPES = {5121: np.dtype("u1"), 5123: np.dtype("<u2"), 5125: np.dtype("<u4"), 5126: np.dtype("<f4")}


def _read_accessor(scene, buffer, accessor):
    """The numbers of an accessor, packed as OpenCascade packs them."""
    view, kind = scene["bufferViews"][accessor["bufferView"]], _TYPES[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
    if view.get("byteStride", width * kind.itemsize) != width * kind.itemsize:
        raise RuntimeError("OpenCascade's glTF has strides that this reader does not know")
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.frombuffer(buffer, kind, accessor["count"] * width, start).astype(np.float64)
