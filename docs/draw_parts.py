"""Draw docs/parts.png: solids coloured by the arcs of their Reeb graphs, and pulled apart, a body for each arc.

python docs/draw_parts.py
"""

from pathlib import Path

import numpy as np
import trimesh

from reebslice import decompose
from reebslice.drawing.arc_colours import arc_colours
from reebslice.drawing.canvas import Words, encode_png, new_canvas, write_words
from reebslice.drawing.marks import INK
from reebslice.drawing.rasters import rasterize_mesh
from reebslice.drawing.shading import shade_layers
from reebslice.drawing.views import fit_view

WIDTH, HEIGHT = 420, 480


def move(*by):
    return trimesh.transformations.translation_matrix(by)


def make_models():
    """Name and mesh of each."""
    tall = trimesh.creation.cylinder(1, 2.2, sections=48, transform=move(0, 0, 1.1))
    hollow = trimesh.creation.cylinder(0.8, 2.2, sections=48, transform=move(0, 0, 1.4))
    upright = trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0])
    ring = trimesh.creation.torus(0.55, 0.16, 48, 16, transform=move(1.15, 0, 1.15) @ upright)
    mug = trimesh.boolean.difference([trimesh.boolean.union([tall, ring]), hollow])
    slabs = [trimesh.creation.box([3, 1, 0.4], move(0, 0, z)) for z in (0.2, 2.2)]
    posts = [trimesh.creation.box([0.4, 0.8, 2.2], move(x, 0, 1.2)) for x in (-1.1, 0, 1.1)]
    horns = [
        trimesh.creation.cone(0.4, h, sections=24, transform=move(x, 0, 2.39)) for x, h in ((-0.9, 0.9), (0.8, 1.4))
    ]
    return {"a mug": mug, "a frame with horns": trimesh.boolean.union([*slabs, *posts, *horns])}


def draw(bodies, pull, words):
    """The picture of bodies, each moved by the place of its middle times `pull`, the nearest in front."""
    middles = [(points.min(axis=0) + points.max(axis=0)) / 2 * [0.6 * pull, 0, pull] for points in bodies.points]
    moved = [points + middle for points, middle in zip(bodies.points, middles)]
    view = fit_view(np.concatenate(moved), -60, 20, 2 * WIDTH, 2 * HEIGHT, margin=0.1)
    layers = [rasterize_mesh(points, faces, view) for points, faces in zip(moved, bodies.faces)]
    nearest = np.maximum.reduce([layer.depth for layer in layers])
    jump, canvas = 0.01 * np.ptp(np.concatenate(moved)), new_canvas(WIDTH, HEIGHT, 1.35)
    seen = np.ones((HEIGHT, WIDTH, 3))
    for layer, colour in zip(layers, arc_colours(bodies.label) / 255):
        front = np.isfinite(layer.depth) & (layer.depth == nearest)
        covered = front.reshape(HEIGHT, 2, WIDTH, 2).mean(axis=(1, 3))[..., None]
        tone = shade_layers(layer, jump, 2).mean(axis=2, keepdims=True) / 255
        seen -= covered * (1 - np.clip(colour * (0.3 + 0.85 * tone), 0, 1))
    canvas.image[:] = np.rint(255 * np.clip(seen, 0, 1))
    write_words(canvas, [Words(words, (0.1 * WIDTH, 0.97 * HEIGHT), 10, INK)])
    return canvas.image


if __name__ == "__main__":
    pictures = []
    for name, mesh in make_models().items():
        bodies = decompose(mesh)
        pictures += [draw(bodies, 0, name), draw(bodies, 0.5, f"its {len(bodies.label)} parts, pulled apart")]
    (Path(__file__).parent / "parts.png").write_bytes(encode_png(np.hstack(pictures)))
