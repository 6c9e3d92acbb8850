"""Where the meshes of glTF 2.0 stand: transforms, instances and the joints of skins.

References: "glTF 2.0 Specification", sections Transformations and Skins; the
extension EXT_mesh_gpu_instancing. Products are elementwise, never by BLAS:
the same bits for the same point, in every row and on every machine.
"""

import numpy as np

from ..errors import MeshFormatError
from .gltf_accessors import open_accessor, read_elements
from .gltf_asset import DAMAGED, take_kind, take_whole
from .gltf_shares import take_share


def multiply(left, right):
    """Multiply (..., 4, 4) matrices.

    Parameters
    ----------
    left, right : (..., 4, 4) float64

    Returns
    -------
    (..., 4, 4) float64
    """
    return sum(left[..., :, k, None] * right[..., None, k, :] for k in range(4))


def move(points, rows):
    """Return one coordinate of moved points.

    Parameters
    ----------
    points : (n, 3) float64
    rows : (..., 4) float64
        That row of the matrices, which broadcasts against the points.

    Returns
    -------
    (..., n) float64
    """
    return points[:, 0] * rows[..., 0] + points[:, 1] * rows[..., 1] + points[:, 2] * rows[..., 2] + rows[..., 3]


def find_determinants(matrices):
    """Return the determinants of the linear parts of matrices; below zero they mirror.

    Parameters
    ----------
    matrices : (k, 3 or 4, 4) float64

    Returns
    -------
    (k,) float64
    """
    (a, b, c), (d, e, f), (g, h, i) = (matrices[:, row, :3].T for row in range(3))
    return a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)


def compose(translation, rotation, scale, where):
    """Return the matrices T R S of many nodes or instances.

    Parameters
    ----------
    translation, scale : (n, 3) float64
    rotation : (n, 4) float64
        Quaternions x, y, z, w of length one; up to a hundredth off, as
        integers of eight bits are, they are brought to that length.
    where : callable
        Gives the name of row k, for the sentence.

    Returns
    -------
    (n, 4, 4) float64

    Raises
    ------
    MeshFormatError
        A quaternion has another length, or a number is not finite.
    """
    length = np.sqrt((rotation**2).sum(axis=1))
    sound = (np.abs(length - 1) < 0.01) & np.isfinite(translation).all(axis=1) & np.isfinite(scale).all(axis=1)
    if not sound.all():
        k = int(np.argmin(sound))
        raise MeshFormatError(
            f"{where(k)} has translation {translation[k].tolist()}, scale {scale[k].tolist()} and rotation"
            f" {rotation[k].tolist()} of length {length[k]:.4g}; numbers are finite, and a rotation is a quaternion"
            " x, y, z, w of length one: divide it by its length, or export the file again."
        )
    x, y, z, w = (rotation / length[:, None]).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrices = np.zeros((len(length), 4, 4))
    matrices[:, :3, :3] = np.array(rows).transpose(2, 0, 1) * scale[:, None, :]
    matrices[:, :3, 3], matrices[:, 3, 3] = translation, 1
    return matrices


def read_instances(asset, node, node_id):
    """Return the matrices of the instances of a node, in the node's own frame.

    Parameters
    ----------
    asset : Asset
    node : dict
    node_id : int

    Returns
    -------
    (k, 4, 4) float64, or None
        None where EXT_mesh_gpu_instancing is absent or gives none of
        TRANSLATION, ROTATION and SCALE: the mesh is there once.

    Raises
    ------
    MeshFormatError
        The attributes differ in count or are not as the extension says.
    """
    where = f"EXT_mesh_gpu_instancing of node {node_id}"
    extensions = take_kind(node, "extensions", dict, f"Node {node_id}")
    attributes = take_kind(take_kind(extensions, "EXT_mesh_gpu_instancing", dict, where), "attributes", dict, where)
    opened = {}
    for name, shape in (("TRANSLATION", "VEC3"), ("ROTATION", "VEC4"), ("SCALE", "VEC3")):
        if name in attributes:
            index = take_whole(attributes, name, where)
            # Beyond the extension's floats, integers are read as everywhere else: writers quantise these too.
            opened[name] = open_accessor(asset, index, shape, {5120, 5121, 5122, 5123, 5126}, f"{name} of {where}")
    if not opened:
        return None
    counts = {name: accessor.count for name, accessor in opened.items()}
    if len(set(counts.values())) > 1:
        raise MeshFormatError(f"{where} has attributes of different count ({counts}); {DAMAGED}.")
    (count,) = set(counts.values())
    take_share(asset, "places", count)
    rest = {"TRANSLATION": (0, 0, 0), "ROTATION": (0, 0, 0, 1), "SCALE": (1, 1, 1)}
    columns = {name: np.tile(np.array(row, np.float64), (count, 1)) for name, row in rest.items()}
    columns |= {name: read_elements(accessor).astype(np.float64) for name, accessor in opened.items()}
    return compose(*columns.values(), lambda k: f"Instance {k} of node {node_id}")
