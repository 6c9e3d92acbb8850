"""Draw docs/loops.png: a mug, a drilled block, a frame, and a bent tube.

python docs/draw_loops.py
"""

from pathlib import Path

import numpy as np
import trimesh

from reebslice import find_loops
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.loops import draw_loops

UPRIGHT = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])


def move(*by):
    return trimesh.transformations.translation_matrix(by)


def make_models():
    """Name and mesh of each, with many small faces, as paths run along mesh edges."""
    ring = trimesh.creation.torus(0.55, 0.14, 96, 32, transform=move(1.15, 0, 1.05) @ UPRIGHT)
    tall = trimesh.creation.cylinder(1, 2.2, sections=96, transform=move(0, 0, 1.1))
    hollow = trimesh.creation.cylinder(0.85, 2.2, sections=96, transform=move(0, 0, 1.4))
    mug = trimesh.boolean.difference([trimesh.boolean.union([tall, ring]), hollow])
    drills = [
        trimesh.creation.cylinder(r, 3, sections=64, transform=move(x, 0, 0)) for x, r in ((-0.8, 0.3), (0.7, 0.45))
    ]
    block = trimesh.boolean.difference([trimesh.creation.box([3, 1.6, 1.2]), *drills])
    windows = [trimesh.creation.box([w, 2, 1.6], move(x, 0, 0)) for x, w in ((-0.95, 0.7), (0, 0.6), (0.9, 0.7))]
    frame = trimesh.boolean.difference([trimesh.creation.box([3.2, 0.5, 2.4]), *windows])
    tube = trimesh.util.concatenate(
        [trimesh.creation.torus(1, 0.4, 96, 48, transform=UPRIGHT),
         trimesh.creation.torus(1, 0.25, 96, 48, transform=UPRIGHT).copy()]
    )  # fmt: skip
    tube.faces[len(tube.faces) // 2 :] = tube.faces[len(tube.faces) // 2 :, ::-1]
    fine = {"mug": mug, "drilled block": block, "frame": frame}
    fine = {
        name: trimesh.Trimesh(*trimesh.remesh.subdivide_to_size(*_arrays(mesh), 0.08)) for name, mesh in fine.items()
    }
    return {**fine, "tube, bent into a ring": tube}


def _arrays(mesh):
    return mesh.vertices, mesh.faces


def draw(name, mesh):
    """The picture of one model."""
    mesh.merge_vertices()
    options = {"width": 560, "azimuth": -70, "elevation": 22}
    return draw_loops(name, np.array(mesh.vertices), np.array(mesh.faces), find_loops(mesh), options)


if __name__ == "__main__":
    pictures = [draw(name, mesh) for name, mesh in make_models().items()]
    rows = [np.hstack(pictures[k : k + 2]) for k in (0, 2)]
    (Path(__file__).parent / "loops.png").write_bytes(encode_png(np.vstack(rows)))
