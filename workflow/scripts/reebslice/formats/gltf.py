"""Read glTF 2.0, .gltf and .glb: the triangles of its scene, each in its place.

Read here and not through a library: of those for Python, pygltflib gives the
JSON as classes and leaves accessors, hierarchy and all that follows to the
user, and trimesh passes over a good part of what the specification lets a file
say (docs name it). JSON, base64 and arrays are at hand anyway.

References: "glTF 2.0 Specification" (ISO/IEC 12113:2022), section Geometry.
"""

from typing import NamedTuple

import numpy as np

from ..errors import MeshFormatError
from .gltf_accessors import check_count, open_accessor, read_elements
from .gltf_asset import DAMAGED, UNPACK, list_companions, open_asset, take_entry, take_kind, take_numbers, take_whole
from .gltf_places import find_determinants, move, multiply, read_instances
from .gltf_scene import read_scene
from .gltf_shares import take_share
from .gltf_skins import pose, read_influences, read_joints
from .mesh_file import MeshFile

__all__ = ["list_companions", "read_gltf"]

POSITIONS = {5120, 5121, 5122, 5123, 5126}
TRIANGLES, STRIP, FAN = 4, 5, 6


def read_gltf(path):
    """Read the triangles of a glTF 2.0 scene.

    Parameters
    ----------
    path : str or Path
        A .gltf or .glb file; its first bytes say which. External buffers are
        those beside it (`list_companions`); nothing else is opened.

    Returns
    -------
    MeshFile
        Points in metres and +Y up, as glTF has them, not merged; corners that
        share a position and a node share its bits. Faces are wound as the
        specification says, mirrored nodes and instances included. Triangles
        of strips and fans that name a vertex twice, which only join strips,
        are left out. There is at least one face. Points of the file that no
        face uses may be among the points.

        Nodes, instances, skins and morph weights are as they are at rest.
        Notes tell of animations, of primitives and nodes that were left out,
        of weights that were applied, of the choice of scene.

    Raises
    ------
    MeshFormatError
        The file is not as the specification says, or requires what is not
        read; the sentence says which object of the file, and the cure.
    """
    asset = open_asset(path)
    scene = read_scene(asset)
    parts, skins = {}, {}
    for node_id in scene.shown:
        node = asset.document["nodes"][node_id]
        if "mesh" in node:
            _place_mesh(asset, node, node_id, scene.placed, parts, skins)
    _tell_left_out(asset.notes, parts)
    return MeshFile(*_join(list(parts.values()), asset.notes), "metre", tuple(asset.notes))


class Part(NamedTuple):
    """Triangles of one primitive, all its places (k, 4, 4), and, if it has no triangles, why."""

    points: np.ndarray
    faces: np.ndarray
    places: list
    reason: str = ""


def _place_mesh(asset, node, node_id, placed, parts, skins):
    """Add the places of a node to the parts of its mesh; a part is decoded, and a skin read, when it is first met."""
    where = f"Node {node_id}"
    mesh_id = take_whole(node, "mesh", where)
    mesh, name = take_entry(asset.document, "meshes", mesh_id, where), f"mesh {mesh_id}"
    weights = take_numbers(node if "weights" in node else mesh, "weights", None, f"{where} or {name}", [])
    skin = take_whole(node, "skin", where) if "skin" in node else None
    instances = read_instances(asset, node, node_id)
    if skin is not None and instances is not None:
        raise MeshFormatError(
            f"{where} is both skinned and placed by EXT_mesh_gpu_instancing, which is not read; place copies by nodes."
        )
    if skin is not None and skin not in skins:
        skins[skin] = read_joints(asset, skin, placed, where)
    places = placed[node_id][None] if instances is None else multiply(placed[node_id], instances)
    places = np.eye(4)[None] if skin is not None else places
    for k, primitive in enumerate(take_kind(mesh, "primitives", list, name)):
        key, whose = (mesh_id, k, weights.tobytes(), skin), f"primitive {k} of {name}"
        if key not in parts:
            if not isinstance(primitive, dict):
                raise MeshFormatError(f"{whose} is no object; {DAMAGED}.")
            parts[key] = _read_primitive(asset, primitive, whose, weights, skins.get(skin))
        if len(parts[key].faces):
            take_share(asset, "places", len(places))
            take_share(asset, "vertices", len(places) * len(parts[key].points))
            take_share(asset, "faces", len(places) * len(parts[key].faces))
            parts[key].places.append(places)
    if weights.any():
        _tell_once(asset.notes, f"Morph targets of {name} are applied with weights {weights.tolist()}.")
    if skin is not None:
        _tell_once(asset.notes, f"Skin {skin} poses {name} by its joints at rest; its node's transform is not used.")


def _tell_once(notes, sentence):
    if sentence not in notes:
        notes.append(sentence)


def _tell_left_out(notes, parts):
    """Note the primitives that hold no triangles, by reason."""
    for reason in sorted({part.reason for part in parts.values()} - {""}):
        keys = list(dict.fromkeys(key[:2] for key, part in parts.items() if part.reason == reason))
        mesh, first = keys[0]
        notes.append(f"{len(keys)} primitives {reason} were left out, the first is primitive {first} of mesh {mesh}.")


# --------------------------------------------------------------------------
# One primitive


def _read_primitive(asset, primitive, where, weights, joints):
    """Return a primitive, morphed and posed, in no place yet."""
    mode = take_whole(primitive, "mode", where, TRIANGLES)
    if mode > FAN:
        raise MeshFormatError(f"{where} has mode {mode}, which is none of 0 to 6; {DAMAGED}.")
    attributes = take_kind(primitive, "attributes", dict, where)
    if mode < TRIANGLES:
        return _leave_out("of points or lines")
    if "POSITION" not in attributes:
        return _leave_out("without positions")
    position = _open_stored(asset, attributes, "POSITION", primitive, where)
    runs = _read_runs(asset, primitive, where, position.count, mode)
    if not any(map(len, runs)):
        return _leave_out("of no vertices")
    faces = np.concatenate([_cut_triangles(ids, mode, where) for ids in runs])
    rows = min(int(ids.min()) for ids in runs), max(int(ids.max()) for ids in runs) + 1  # of a long shared accessor
    points = read_elements(position, rows).astype(np.float64)
    points = _apply_targets(asset, primitive, where, weights, points, position.count, rows)
    faces = faces - rows[0]
    _check_finite(points, faces, rows[0], position.name)
    if joints is not None:
        influences = read_influences(asset, attributes, where, position.count, rows, len(joints))
        points, mirrored = pose(points, *influences, joints)
        faces = faces[:, ::-1] if mirrored else faces
    return Part(*_drop_unused(points, faces), [])


def _drop_unused(points, faces):
    """Return points and faces without the points that no face uses, where these are more than half.

    So many primitives that each use a few vertices of one long accessor hold no copies of all of it.
    """
    used = np.zeros(len(points), bool)
    used[faces] = True
    if 2 * np.count_nonzero(used) >= len(points):
        return points, faces
    return points[used], (np.cumsum(used) - 1)[faces]


def _leave_out(reason):
    return Part(np.zeros((0, 3)), np.zeros((0, 3), np.int64), [], reason)


def _open_stored(asset, owner, key, primitive, where):
    """Return the accessor of positions or indices, or name the extension that alone would give its elements."""
    shape, kinds = ("VEC3", POSITIONS) if key == "POSITION" else ("SCALAR", {5121, 5123, 5125})
    accessor = open_accessor(asset, take_whole(owner, key, where), shape, kinds, f"{key} of {where}")
    if accessor.stored is None and accessor.sparse is None:
        source = " and ".join(sorted(take_kind(primitive, "extensions", dict, where))) or "an extension"
        raise MeshFormatError(f"{accessor.name} holds no elements: they are stored by {source} only, {UNPACK}.")
    return accessor


def _read_runs(asset, primitive, where, count, mode):
    """Return the vertex ids of a primitive, all of which exist, as one list (n,) int64 or as many as it restarts."""
    if "indices" not in primitive:
        return [np.arange(count)]
    accessor = _open_stored(asset, primitive, "indices", primitive, where)
    ids = read_elements(accessor._replace(normalized=False))[:, 0].astype(np.int64)
    top, runs = np.iinfo(accessor.dtype).max, [ids]
    if mode != TRIANGLES and "KHR_mesh_primitive_restart" in take_kind(asset.document, "extensionsUsed", list, where):
        ends = np.concatenate([[-1], np.flatnonzero(ids == top), [len(ids)]])
        drawn = np.flatnonzero(np.diff(ends) > 3)  # shorter ones draw nothing
        runs = [ids[ends[k] + 1 : ends[k + 1]] for k in drawn] or [ids[:0]]
        ids = np.where(ids == top, 0, ids)
    at = int(ids.argmax()) if len(ids) else 0
    if len(ids) and ids[at] == top:
        raise MeshFormatError(
            f"{accessor.name} holds {top} at place {at}, which would restart the primitive and is not allowed; write"
            " separate primitives, or ids of a wider componentType."
        )
    if len(ids) and ids[at] >= count:
        raise MeshFormatError(
            f"{accessor.name} names vertex {ids[at]} at place {at}, but there are {count} vertices; {DAMAGED}."
        )
    return runs


def _cut_triangles(ids, mode, where):
    """Return the triangles (m, 3) of a list, strip or fan, wound as the section Meshes says."""
    if len(ids) % 3 if mode == TRIANGLES else len(ids) < 3:
        needed = "a multiple of three" if mode == TRIANGLES else "at least three"
        raise MeshFormatError(f"{where} has {len(ids)} corners where {needed} are due (mode {mode}); {DAMAGED}.")
    if mode == TRIANGLES:
        return ids.reshape(-1, 3)
    if mode == FAN:
        faces = np.column_stack([ids[1:-1], ids[2:], np.broadcast_to(ids[0], len(ids) - 2)])
    else:
        faces = np.column_stack([ids[:-2], ids[1:-1], ids[2:]])
        faces[1::2, 1:] = faces[1::2, :0:-1]
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)]


def _apply_targets(asset, primitive, where, weights, points, count, rows):
    """Return the points moved by the weighted morph targets."""
    targets = take_kind(primitive, "targets", list, where)
    if weights.any() and len(weights) != len(targets):
        raise MeshFormatError(f"{where} has {len(targets)} morph targets but {len(weights)} weights; {DAMAGED}.")
    for k, (weight, target) in enumerate(zip(weights, targets, strict=False)):
        whose = f"target {k} of {where}"
        target = take_kind({whose: target}, whose, dict, where)
        if weight and "POSITION" in target:
            index = take_whole(target, "POSITION", whose)
            moves = open_accessor(asset, index, "VEC3", POSITIONS, f"POSITION of {whose}")
            check_count(moves, count)
            points = points + weight * read_elements(moves, rows)
    return points


def _check_finite(points, faces, first, name):
    """Refuse coordinates in use that are no numbers."""
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad) and len(bad := bad[np.isin(bad, faces)]):
        raise MeshFormatError(
            f"{len(bad)} vertices have coordinates that are not finite numbers, the first is vertex {first + bad[0]} of"
            f" {name} at {tuple(points[bad[0]].tolist())}; mend or remove them in the program that wrote the file."
        )


# --------------------------------------------------------------------------
# Places


def _join(parts, notes):
    """Return all points and faces: part by part, each in all its places."""
    parts = [part for part in parts if part.places]
    places = [np.concatenate(part.places) for part in parts]
    counts = [(len(k) * len(part.points), len(k) * len(part.faces)) for k, part in zip(places, parts, strict=True)]
    n_points, n_faces = (sum(column) for column in zip(*counts, strict=True)) if counts else (0, 0)
    if not n_faces:
        told = ["The file holds no faces: its scene places no triangle; export the mesh again.", *notes]
        raise MeshFormatError(" ".join(told))
    points, faces = np.empty((n_points, 3)), np.empty((n_faces, 3), np.int32)
    at, row = 0, 0
    for matrices, part, (size, rows) in zip(places, parts, counts, strict=True):
        here = points[at : at + size].reshape(len(matrices), len(part.points), 3)
        there = faces[row : row + rows].reshape(len(matrices), len(part.faces), 3)
        for axis in range(3):
            here[:, :, axis] = move(part.points, matrices[:, None, axis])
        starts = at + np.arange(len(matrices)) * len(part.points)
        np.add(part.faces, starts[:, None, None], out=there, casting="unsafe")  # fits, by the bounds on vertices
        mirrored = find_determinants(matrices) < 0
        there[mirrored] = there[mirrored][:, :, ::-1]
        at, row = at + size, row + rows
    return points, faces
