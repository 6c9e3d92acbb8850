"""Which nodes a glTF 2.0 scene shows, and where every node stands.

References: "glTF 2.0 Specification", sections Scenes, Nodes and Hierarchy and
Transformations; the extensions KHR_node_visibility and MSFT_lod.
"""

from typing import NamedTuple

import numpy as np

from ..errors import MeshFormatError
from .gltf_asset import DAMAGED, take_entry, take_kind, take_numbers, take_whole, take_wholes
from .gltf_places import compose, multiply


class Scene(NamedTuple):
    """Which nodes are shown, and where every node of the file stands."""

    shown: list
    """Ids of the visible nodes of the scene, parents before children, in the order of the file."""
    placed: np.ndarray
    """(nodes, 4, 4) global matrices."""


def read_scene(asset):
    """Find the nodes of the scene that a file shows.

    The scene is the one that the file names, else its first; a file without
    scenes shows all root nodes. The notes of the asset tell of a choice and of
    nodes that are left out.

    Parameters
    ----------
    asset : Asset

    Returns
    -------
    Scene

    Raises
    ------
    MeshFormatError
        The nodes are no forest, a scene lists what is no root, or a transform
        is none.
    """
    count = len(take_kind(asset.document, "nodes", list, "The file"))
    nodes = [take_entry(asset.document, "nodes", k, "The file") for k in range(count)]
    children = [take_wholes(node, "children", f"Node {k}") for k, node in enumerate(nodes)]
    parents = _find_parents(children)
    placed = _place_nodes(_read_transforms(nodes), parents, children)
    shown, hidden = _walk(nodes, children, _choose_roots(asset, nodes, parents, placed))
    _tell_left_out(asset, nodes, shown, hidden)
    return Scene(shown, placed)


def _find_parents(children):
    """Return the parent of every node, -1 where there is none."""
    parents = [-1] * len(children)
    for k, ids in enumerate(children):
        for child in ids:
            if child >= len(children):
                raise MeshFormatError(f"Node {k} has child {child}, but there are {len(children)} nodes; {DAMAGED}.")
            if parents[child] >= 0:
                raise MeshFormatError(
                    f"Node {child} is a child of node {parents[child]} and again of node {k}, where one parent is"
                    " allowed; give each parent a node of its own that refers to the same mesh."
                )
            parents[child] = k
    return parents


def _choose_roots(asset, nodes, parents, placed):
    """Return the ids of the nodes with which the scene begins."""
    scenes = take_kind(asset.document, "scenes", list, "The file")
    if not scenes:
        roots = [k for k in range(len(nodes)) if parents[k] < 0]
        if roots:
            asset.notes.append(f"The file has no scene: all {len(roots)} root nodes are read.")
        coarse = {k for node in nodes for k in take_wholes(_extension(node, "MSFT_lod"), "ids", "MSFT_lod")}
        return [k for k in roots if k not in coarse]
    chosen = take_whole(asset.document, "scene", "The file", 0)
    ids = take_wholes(take_entry(asset.document, "scenes", chosen, "The file"), "nodes", f"Scene {chosen}")
    if len(scenes) > 1:
        why = "names" if "scene" in asset.document else "names none and begins with"
        asset.notes.append(f"Of {len(scenes)} scenes, scene {chosen} is read, which the file {why}.")
    for k in ids:
        take_entry(asset.document, "nodes", k, f"Scene {chosen}")
        if parents[k] >= 0:  # not allowed, but UniGLTF wrote whole libraries so, below an empty parent
            sentence = f"Scene {chosen} lists node {k}, which is no root node but a child of node {parents[k]}"
            if not np.array_equal(placed[parents[k]], np.eye(4)):
                raise MeshFormatError(f"{sentence}, whose transform may be meant or not; list root nodes only.")
            asset.notes.append(f"{sentence}; that has no transform, so that it is read where it stands.")
    return ids


def _walk(nodes, children, roots):
    """Return the nodes below the roots, depth first, and those at which a hidden branch begins."""
    shown, hidden, met, waiting = [], [], set(), roots[::-1]
    while waiting:
        k = waiting.pop()
        if k in met:
            raise MeshFormatError(f"The scene shows node {k} twice; list each root node once, and no node below it.")
        met.add(k)
        if _extension(nodes[k], "KHR_node_visibility").get("visible", True) is False:
            hidden.append(k)
            continue
        shown.append(k)
        waiting += children[k][::-1]
    return shown, hidden


def _extension(node, name):
    """Return the extension object of a node, empty where there is none."""
    return take_kind(take_kind(node, "extensions", dict, "A node"), name, dict, "A node")


def _tell_left_out(asset, nodes, shown, hidden):
    """Note what of the file is not shown."""
    meshed = [k for k in sorted(set(range(len(nodes))) - set(shown)) if "mesh" in nodes[k]]
    if meshed:
        asset.notes.append(
            f"{len(meshed)} nodes with a mesh are not shown by the scene and left out, the first is node {meshed[0]}"
            + (f"; KHR_node_visibility hides node {hidden[0]} and all below it." if hidden else ".")
        )
    if animations := take_kind(asset.document, "animations", list, "The file"):
        asset.notes.append(f"{len(animations)} animations are not played: nodes, joints and morph weights are at rest.")


def _read_transforms(nodes):
    """Return the local matrix of every node."""
    matrices = {}
    parts = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
    table = {key: np.tile(np.array(value, np.float64), (len(nodes), 1)) for key, value in parts.items()}
    for k, node in enumerate(nodes):
        for key in parts.keys() & node.keys():
            table[key][k] = take_numbers(node, key, len(parts[key]), f"Node {k}")
        if "matrix" in node:
            matrix = take_numbers(node, "matrix", 16, f"Node {k}").reshape(4, 4).T
            if parts.keys() & node.keys() or matrix[3].tolist() != [0, 0, 0, 1]:
                raise MeshFormatError(
                    f"Node {k} has a matrix with the last row {matrix[3].tolist()}, and the keys {sorted(node)}; a"
                    " matrix ends in the row 0, 0, 0, 1 and stands without translation, rotation and scale: keep one."
                )
            matrices[k] = matrix
    local = compose(*table.values(), lambda k: f"Node {k}")
    for k, matrix in matrices.items():
        local[k] = matrix
    return local


def _place_nodes(local, parents, children):
    """Return the global matrix of every node: that of its parent times its own."""
    placed, waiting = local.copy(), [k for k in range(len(local)) if parents[k] < 0]
    reached = set(waiting)
    while waiting:
        k = waiting.pop()
        for child in children[k]:
            placed[child] = multiply(placed[k], local[child])
        waiting += children[k]
        reached.update(children[k])
    if len(reached) < len(local):
        around = min(set(range(len(local))) - reached)
        for _ in local:  # up, into the circle below which it hangs
            around = parents[around]
        raise MeshFormatError(
            f"Node {around} is its own ancestor; take it out of a list of children, scenes are trees."
        )
    return placed
