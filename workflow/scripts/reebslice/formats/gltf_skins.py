"""Vertices of glTF 2.0 that joints carry: linear blend skinning.

References: "glTF 2.0 Specification", section Skins.
"""

import numpy as np

from ..errors import MeshFormatError
from .gltf_accessors import check_count, open_accessor, read_elements
from .gltf_asset import DAMAGED, take_entry, take_whole, take_wholes
from .gltf_places import find_determinants, move, multiply

MOST_SETS = 4  # of four joints each; programs write one or two


def read_joints(asset, skin_id, placed, where):
    """Return the matrices that carry vertices from the mesh to the scene, one for each joint of a skin.

    Parameters
    ----------
    asset : Asset
    skin_id : int
    placed : (nodes, 4, 4) float64
        Global matrices.
    where : str
        Who refers to the skin, for the sentence.

    Returns
    -------
    (joints, 4, 4) float64
        The global matrix of the joint times its inverse bind matrix.

    Raises
    ------
    MeshFormatError
        A joint is no node, or listed twice, or there are fewer matrices than joints.
    """
    skin, name = take_entry(asset.document, "skins", skin_id, where), f"Skin {skin_id}"
    joints = take_wholes(skin, "joints", name)
    if len(set(joints)) < len(joints):
        raise MeshFormatError(f"{name} lists a joint twice, where each is listed once; {DAMAGED}.")
    for joint in joints:
        take_entry(asset.document, "nodes", joint, name)
    if "inverseBindMatrices" not in skin:
        return placed[joints]
    index = take_whole(skin, "inverseBindMatrices", name)
    stored = open_accessor(asset, index, "MAT4", {5126}, f"inverseBindMatrices of skin {skin_id}")
    if stored.count < len(joints):
        raise MeshFormatError(f"{name} has {len(joints)} joints but {stored.count} inverse bind matrices; {DAMAGED}.")
    inverse = read_elements(stored).reshape(-1, 4, 4).transpose(0, 2, 1)
    return multiply(placed[joints], inverse[: len(joints)])


def read_influences(asset, attributes, where, count, rows, n_joints):
    """Return which joints carry the vertices of a primitive, and by what weights.

    Parameters
    ----------
    asset : Asset
    attributes : dict
        Of the primitive; every set JOINTS_k with WEIGHTS_k is read.
    where : str
        The name of the primitive, for the sentence.
    count : int
        Its number of positions.
    rows : (int, int)
        The first vertex and the one after the last.
    n_joints : int

    Returns
    -------
    joints : (n, 4 s) int64
        Over s sets; 0 where the weight is.
    weights : (n, 4 s) float64
        Not negative; the sum of a row is one.

    Raises
    ------
    MeshFormatError
        A set is missing, or there are more than `MOST_SETS`, or a vertex has no joint.
    """
    sets = sum(f"JOINTS_{k}" in attributes for k in range(len(attributes)))
    if not sets:
        raise MeshFormatError(f"{where} is skinned but has no JOINTS_0 and WEIGHTS_0; {DAMAGED}.")
    if sets > MOST_SETS:
        raise MeshFormatError(
            f"{where} has {sets} sets of joints and weights; at most {MOST_SETS} are read: limit the joints for each"
            f" vertex to {4 * MOST_SETS} in the program that wrote the file."
        )
    columns = {}
    for name, kinds in (("JOINTS", {5121, 5123}), ("WEIGHTS", {5121, 5123, 5126})):
        found = []
        for k in range(sets):
            index = take_whole(attributes, f"{name}_{k}", where)
            found.append(open_accessor(asset, index, "VEC4", kinds, f"{name}_{k} of {where}"))
            check_count(found[-1], count)
        columns[name] = np.hstack([read_elements(accessor, rows) for accessor in found])
    joints, weights = columns["JOINTS"].astype(np.int64), columns["WEIGHTS"].astype(np.float64)
    total = weights.sum(axis=1)
    bad = np.flatnonzero(~(total > 0) | (weights < 0).any(axis=1) | ((joints >= n_joints) & (weights != 0)).any(axis=1))
    if len(bad):
        k = bad[0]
        raise MeshFormatError(
            f"Vertex {rows[0] + k} of {where} has joints {joints[k].tolist()} with weights {weights[k].tolist()}; its"
            f" skin has {n_joints} joints, and weights are positive in sum: {DAMAGED}."
        )
    return np.where(weights != 0, joints, 0), weights / total[:, None]


def pose(points, joints, weights, matrices):
    """Move points by the weighted matrices of their joints.

    Parameters
    ----------
    points : (n, 3) float64
    joints : (n, k) ids of matrices
    weights : (n, k) float64
    matrices : (m, 4, 4) float64
        By `read_joints`.

    Returns
    -------
    points : (n, 3) float64
        In the frame of the scene.
    mirrored : bool
        Whether most of them are mirrored, so that faces turn over.
    """
    blended = np.zeros((len(points), 3, 4))
    for k in range(joints.shape[1]):
        blended += weights[:, k, None, None] * matrices[joints[:, k], :3]
    moved = np.column_stack([move(points, blended[:, row]) for row in range(3)])
    return moved, bool((find_determinants(blended) < 0).mean() > 0.5)
