"""Draw docs/directions.png: a part in its best and in its worst direction of all that are compared.

python docs/draw_directions.py
"""

from pathlib import Path

import numpy as np
import trimesh

from reebslice import compare_directions, find_islands, find_pockets, pocket_bodies
from reebslice.drawing.canvas import Words, encode_png, new_canvas, write_words
from reebslice.drawing.marks import INK
from reebslice.drawing.pockets import draw_pockets
from reebslice.tilt.choice import rotation_to_vertical

WIDTH = 560


def make_part():
    """A housing: a box with a deep recess, a bore, a window, and a hook on its side."""
    recess = trimesh.creation.box(bounds=[[0.3, 0.3, 0.4], [2.7, 1.7, 3]])
    bore = trimesh.creation.cylinder(
        0.35, 2, sections=48, transform=trimesh.transformations.translation_matrix([1, 1, 0])
    )
    window = trimesh.creation.box(bounds=[[2.5, 0.7, 1.1], [4, 1.3, 1.7]])
    arm = trimesh.creation.box(bounds=[[-1.4, 0.8, 1.3], [0.1, 1.2, 1.6]])
    tip = trimesh.creation.box(bounds=[[-1.4, 0.8, 0.6], [-1.1, 1.2, 1.5]])
    shell = trimesh.boolean.difference([trimesh.creation.box(bounds=[[0, 0, 0], [3, 2, 2]]), recess, bore, window])
    return trimesh.boolean.union([shell, arm, tip])


def draw(mesh, found, place, words):
    """The part with what is up there, its pockets and islands, and its row."""
    up, depth = found.direction[place], 1e-3 * np.linalg.norm(mesh.extents)
    points = np.array(mesh.vertices) @ rotation_to_vertical(up).T
    faces, bodies, kinds = np.array(mesh.faces), [], []
    for find in (find_pockets, find_islands):
        pockets = find(points, faces, least_depth=depth)
        bodies, kinds = bodies + pocket_bodies(points, faces, pockets), kinds + pockets.kind.tolist()
    image = draw_pockets(words, points, faces, bodies, kinds, {"width": WIDTH, "azimuth": -55, "elevation": 18})
    canvas = new_canvas(WIDTH, 60, WIDTH / 432)
    told = (
        f"{found.islands[place]} islands, {found.basins[place]} basins, {found.bells[place]} bells, "
        f"{found.overhang_area[place]:.2f} overhanging, {found.layers[place]} layers"
    )
    write_words(canvas, [Words(told, (0.04 * WIDTH, 30), 9.5, INK)])
    return np.vstack([image, canvas.image])


if __name__ == "__main__":
    mesh = make_part()
    found = compare_directions(mesh, distance=0.1)
    asked = ((0, "the best"), (len(found.height) // 2, "in the middle"), (len(found.height) - 1, "the worst"))
    pictures = [draw(mesh, found, place, f"{words} of {len(found.height)} directions") for place, words in asked]
    (Path(__file__).parent / "directions.png").write_bytes(encode_png(np.hstack(pictures)))
