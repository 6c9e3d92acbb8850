"""Draw docs/centrelines.png: a knot, a tree with a loop and, of a file that is given, a vessel.

python docs/draw_centrelines.py [SURFACE]
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))

from reebslice import find_centrelines
from reebslice.drawing.canvas import encode_png
from reebslice.drawing.centrelines import draw_centrelines
from tubes import make_knot, make_tree

OPTIONS = {"width": 520, "azimuth": -60, "elevation": 24}


def read_vessel(path):
    """Points and faces of a surface, the faces turned outward."""
    import trimesh

    mesh = trimesh.load_mesh(path)
    mesh.merge_vertices()
    return np.array(mesh.vertices), np.array(mesh.faces) if mesh.volume > 0 else np.array(mesh.faces)[:, ::-1]


if __name__ == "__main__":
    models = {"knot": make_knot()[:2], "tree with a loop": make_tree()[:2]}
    if len(sys.argv) > 1:
        models["vessel"] = read_vessel(sys.argv[1])
    pictures = [
        draw_centrelines(name, points, faces, find_centrelines(points, faces), OPTIONS)
        for name, (points, faces) in models.items()
    ]
    (Path(__file__).parent / "centrelines.png").write_bytes(encode_png(np.hstack(pictures)))
