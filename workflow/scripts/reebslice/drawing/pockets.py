"""A still picture of pockets and islands: coloured bodies that shine through the surface, as through glass."""

import numpy as np

from .body_scenes import scene_of_bodies
from .canvas import rgb
from .glass import draw_glass, write_legend, write_numbers
from .rasters import rasterize_mesh
from .shading import shade_layers

# Colours of Okabe and Ito, told apart by the colour-blind; what is most urgent for a coater or printer is warmest.
INKS = {"basin": "#0072B2", "bell": "#E69F00", "sealed": "#A3246E", "island": "#009E73"}
WORDS = {
    "basin": "holds liquid",
    "bell": "catches air",
    "sealed": "sealed off",
    "island": "begins in the air",
}
STRENGTH = 0.85  # of a pocket's colour


def pockets_scene(bodies, kinds, ids):
    """Write pockets and islands as a scene in binary glTF.

    Parameters
    ----------
    bodies : list of (points, faces)
        Closed meshes, as of :func:`..graphs.bodies.pocket_bodies`.
    kinds : list of str
    ids : list of int
        Nodes are called by kind and id, such as `basin3`.

    Returns
    -------
    bytes
    """
    names = [f"{kind}{number}" for kind, number in zip(kinds, ids, strict=True)]
    points, faces = zip(*bodies) if bodies else ((), ())
    return scene_of_bodies(names, points, faces, np.array([rgb(INKS[kind]) for kind in kinds]).reshape(-1, 3))


def draw_pockets(name, points, faces, bodies, kinds, options):
    """Draw a surface with its pockets and islands.

    Parameters
    ----------
    name : str
        Written at the top.
    points, faces : (n, 3) float64 and (m, 3) int
        The surface in the tilted frame, height up.
    bodies : list of (points, faces)
        Closed meshes in the same frame, as of :func:`..graphs.bodies.pocket_bodies`.
    kinds : list of str
        Of each body, as in :class:`..graphs.pocket_measures.Pockets`.
    options : dict
        width (pixels), azimuth (degrees, or None for the largest silhouette) and elevation (degrees, or
        None for what suits the model).

    Returns
    -------
    (height, width, 3) uint8
        The picture is as high as wide. Where several bodies lie behind one another, the nearest is coloured. Numbers
        on them are rows of the table `pockets`, or `islands`.
    """
    canvas, view, fine, jump = draw_glass(points, faces, options)
    seen, width = canvas.image / 255.0, view.width
    own = {kind: [body for body, other in zip(bodies, kinds, strict=True) if other == kind] for kind in INKS}
    layers = {kind: _rasterize_all(own[kind], fine) for kind in INKS if own[kind]}
    nearest = np.maximum.reduce([layer.depth for layer in layers.values()], initial=-np.inf)
    for kind, layer in layers.items():
        front = np.isfinite(layer.depth) & (layer.depth == nearest)
        covered = front.reshape(width, 2, width, 2).mean(axis=(1, 3))[..., None]
        tone = shade_layers(layer, jump, 2).mean(axis=2, keepdims=True) / 255
        seen *= 1 - STRENGTH * covered * (1 - np.clip(rgb(INKS[kind]) / 255 * (0.55 + 0.75 * tone), 0, 1))
    canvas.image[:] = np.rint(255 * seen)
    before = [kinds[:k].count("island") for k in range(len(kinds))]
    rows = [count if kind == "island" else k - count for k, (kind, count) in enumerate(zip(kinds, before))]
    write_numbers(canvas, view, rows, [points for points, _ in bodies])
    write_legend(canvas, name, kinds, INKS, WORDS)
    return canvas.image


def _rasterize_all(bodies, view):
    """The :class:`Layers` of several bodies."""
    shifts = np.cumsum([0, *(len(points) for points, _ in bodies)])
    faces = np.concatenate([corners + shift for (_, corners), shift in zip(bodies, shifts)])
    return rasterize_mesh(np.concatenate([points for points, _ in bodies]), faces, view)
