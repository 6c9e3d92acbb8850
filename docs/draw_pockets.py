"""Draw docs/pockets.png: a cup, the cup upside down, a hollow vessel, and a part that begins in the air.

python docs/draw_pockets.py
"""

from pathlib import Path

import numpy as np
import trimesh

from reebslice import find_islands, find_pockets, pocket_bodies
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.pockets import draw_pockets

AXIS = np.array([1.0, 0.0, 0.0])


def cylinder(radius, height, floor, x=0.0):
    """An upright cylinder that stands at height `floor`."""
    place = trimesh.transformations.translation_matrix([x, 0, floor + height / 2])
    return trimesh.creation.cylinder(radius, height, sections=96, transform=place)


def make_models():
    """Name and mesh of each."""
    upright = trimesh.transformations.rotation_matrix(np.pi / 2, AXIS)
    handle = trimesh.creation.torus(0.55, 0.13, 96, 32, transform=upright)
    handle.apply_translation([1.15, 0, 1.05])
    rim = trimesh.boolean.difference([handle, cylinder(0.95, 3, 0)])
    cup = trimesh.boolean.union([trimesh.boolean.difference([cylinder(1, 2.2, 0), cylinder(0.85, 2.2, 0.3)]), rim])
    upside_down = cup.copy().apply_transform(trimesh.transformations.rotation_matrix(np.pi, AXIS))
    vessel = trimesh.boolean.difference([cylinder(1, 2, 0), cylinder(0.8, 1.5, 0.25)])
    lamp = trimesh.boolean.union(
        [cylinder(0.9, 0.2, 0), cylinder(0.15, 2.2, 0, -0.6), cylinder(0.15, 0.5, 1.5, 0.6),
         trimesh.creation.box([1.5, 0.3, 0.2], trimesh.transformations.translation_matrix([0, 0, 2.1]))]
    )  # fmt: skip
    return {"cup": cup, "cup, upside down": upside_down, "closed vessel": vessel, "lamp": lamp}


def draw(name, mesh):
    """The picture of one model."""
    pockets, islands = find_pockets(mesh), find_islands(mesh)
    bodies = pocket_bodies(mesh, None, pockets) + pocket_bodies(mesh, None, islands)
    kinds = pockets.kind.tolist() + islands.kind.tolist()
    options = {"width": 560, "azimuth": -90, "elevation": 14}
    return draw_pockets(name, mesh.vertices, mesh.faces, bodies, kinds, options)


if __name__ == "__main__":
    pictures = [draw(name, mesh) for name, mesh in make_models().items()]
    rows = [np.hstack(pictures[k : k + 2]) for k in (0, 2)]
    (Path(__file__).parent / "pockets.png").write_bytes(encode_png(np.vstack(rows)))
