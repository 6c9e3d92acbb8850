"""Closed bodies as a scene that other programs open."""

import numpy as np

_EXTREMES = (np.min, np.min), (np.max, np.max)


def scene_of_bodies(names, points, faces, colours):
    """Write closed bodies as a scene in binary glTF, a coloured node for each.

    Parameters
    ----------
    names : list of str
        Of the nodes, each another.
    points : list of (k, 3) float64
        Corners of each.
    faces : list of (l, 3) int
        Of each, counter-clockwise seen from outside.
    colours : (B, 3) uint8
        Red, green, blue.

    Returns
    -------
    bytes
        The file has single precision, about the middle of all, which the matrix of each node puts back. Without a
        body it is a scene without nodes.
    """
    import trimesh  # takes long to load

    scene, middle = trimesh.Scene(), np.zeros(3)
    if len(points):
        low, high = (extreme([edge(spots, axis=0) for spots in points], axis=0) for extreme, edge in _EXTREMES)
        middle = (low + high) / 2
    place = trimesh.transformations.translation_matrix(middle)
    for name, spots, corners, colour in zip(names, points, faces, colours):
        material = trimesh.visual.material.PBRMaterial(baseColorFactor=[*colour, 255], metallicFactor=0.0)
        mesh = trimesh.Trimesh(spots - middle, corners, process=False)
        mesh.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(mesh, node_name=name, geom_name=name, transform=place)
    return trimesh.exchange.gltf.export_glb(scene)  # scene.export refuses one without bodies
