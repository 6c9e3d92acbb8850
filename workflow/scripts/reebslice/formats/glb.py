"""Binary glTF 2.0 (`.glb`) of points, lines and triangles with numbers on their vertices.

Khronos Group, glTF 2.0 specification, https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

import json
import struct
from typing import NamedTuple

import numpy as np

from ..errors import ReebsliceError

POINTS, LINES, TRIANGLES = 0, 1, 4
FLOAT, SHORT, INT = 5126, 5123, 5125
LARGEST_ID = 1 << 24  # whole numbers up to here are exact in single precision


class Part(NamedTuple):
    """One mesh of a scene, under a node of its own.

    Attributes
    ----------
    name : str
    mode : {POINTS, LINES, TRIANGLES}
    points : (n, 3) float64
        At least one.
    indices : (k,) int
        Points that make the primitives: two a line, three a triangle.
    ids : dict of str to (n,) int
        Numbers of every point from -1 to 2**24, by name: `arc` becomes the attribute `_ARC`.
    colour : (4,) float
        Red, green, blue and opacity, from 0 to 1.
    extras : dict
        What else is told of it; JSON.
    """

    name: str
    mode: int
    points: np.ndarray
    indices: np.ndarray
    ids: dict
    colour: tuple
    extras: dict


def write_glb(parts, rotation, origin, extras):
    """Write a scene as binary glTF.

    Parameters
    ----------
    parts : list of Part
    rotation : (3, 3) float64
        From the frame of the points to the tilted frame, whose third coordinate is the height.
    origin : (3,) float64
        A point near the others. Points are told relative to it, in single precision.
    extras : dict
        What is told of the whole; JSON.

    Returns
    -------
    bytes
        One node per part, under a node that turns the height to y, which glTF has up. The same for the same input.

    Raises
    ------
    ReebsliceError
        An id is more than single precision holds.
    ValueError
        A number in `extras` is not finite.
    """
    turn = np.eye(4)
    turn[:3, :3] = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]) @ np.asarray(rotation, float)
    root = {"name": "height up", "matrix": turn.T.ravel().tolist(), "children": list(range(1, len(parts) + 1))}
    scene = {
        "asset": {"version": "2.0", "generator": "reebslice"},
        "extras": extras,
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [root],
        "meshes": [],
        "materials": [],
        "accessors": [],
        "bufferViews": [],
    }
    data = bytearray()
    for number, part in enumerate(parts):
        scene["nodes"].append({"name": part.name, "mesh": number, "translation": np.asarray(origin, float).tolist()})
        scene["meshes"].append(_add_mesh(scene, data, part, origin, number))
        scene["materials"].append(_tell_material(part.colour))
    scene["buffers"] = [{"byteLength": len(data)}]
    text = json.dumps(scene, separators=(",", ":"), sort_keys=True, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data))
    return b"".join(
        (head, struct.pack("<I4s", len(text), b"JSON"), text, struct.pack("<I4s", len(data), b"BIN\0"), data)
    )


def _add_mesh(scene, data, part, origin, number):
    """Append the arrays of a part to the file; return its mesh."""
    places = (np.asarray(part.points, float) - origin).astype("<f4")
    attributes = {"POSITION": _add_array(scene, data, places, "VEC3", FLOAT)}
    for name, ids in part.ids.items():
        if len(ids) and np.max(ids) > LARGEST_ID:
            raise ReebsliceError(f"{part.name}: {name} {np.max(ids)} is more than a glTF attribute can tell exactly")
        attributes[f"_{name.upper()}"] = _add_array(scene, data, np.asarray(ids).astype("<f4"), "SCALAR", FLOAT)
    short = len(places) < 65535  # that number itself restarts a primitive
    indices = np.asarray(part.indices).astype("<u2" if short else "<u4")
    order = _add_array(scene, data, indices, "SCALAR", SHORT if short else INT)
    primitive = {"attributes": attributes, "indices": order, "mode": part.mode, "material": number}
    return {"name": part.name, "primitives": [primitive], "extras": part.extras}


def _add_array(scene, data, array, shape, kind):
    """Append an array to the data; return the number of its accessor."""
    view = {"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes, "target": 34962 + (kind != FLOAT)}
    accessor = {"bufferView": len(scene["bufferViews"]), "componentType": kind, "count": len(array), "type": shape}
    if shape == "VEC3":
        accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
    scene["bufferViews"].append(view)
    scene["accessors"].append(accessor)
    data += array.tobytes()
    data += bytes(-len(data) % 4)
    return len(scene["accessors"]) - 1


def _tell_material(colour):
    """The glTF material of a colour; a translucent one shows both sides."""
    material = {"pbrMetallicRoughness": {"baseColorFactor": list(colour), "metallicFactor": 0, "roughnessFactor": 0.9}}
    return material | ({"alphaMode": "BLEND", "doubleSided": True} if colour[3] < 1 else {})
