"""Coloured files of what lies along arcs, for other programs."""

import colorsys

import numpy as np

from ..formats.ply_bytes import ply_bytes
from .body_scenes import scene_of_bodies

# The golden angle as a share of a turn: hues of consecutive numbers lie far apart.
GOLDEN = 0.38196601125010515
NOTHING = (160, 160, 160)


def arc_colours(arcs):
    """Give arcs colours.

    Parameters
    ----------
    arcs : (k,) int
        -1 for none.

    Returns
    -------
    (k, 3) uint8
        Red, green, blue: one colour for each number, whatever the others are; grey for -1.
    """
    arcs = np.asarray(arcs)
    numbers, which = np.unique(arcs, return_inverse=True)
    palette = [_colour(number) if number >= 0 else NOTHING for number in numbers.tolist()]
    return np.array(palette, np.uint8).reshape(-1, 3)[which.ravel()]


def _colour(number):
    """The colour of a number: hues by the golden angle, in turn lighter and darker."""
    shade = (0.95, 0.75, 0.85)[number % 3]
    return tuple(round(255 * part) for part in colorsys.hsv_to_rgb(number * GOLDEN % 1, 0.55, shade))


def coloured_ply(labelled, face_arcs, by):
    """Write a surface coloured by its arcs as PLY.

    Parameters
    ----------
    labelled : LabelledMesh
        Of n vertices and T triangles.
    face_arcs : pyarrow.Table
        Its rows.
    by : {"solid", "surface"}
        The graph whose arcs have colours.

    Returns
    -------
    bytes
        Vertices and triangles have the properties `red`, `green`, `blue`, `surface_arc` and `solid_arc`, -1 for none,
        triangles also `face`, the row of the table `faces`. Where arcs meet, each has vertices of its own, so
        that programs that show colours of vertices alone show sharp borders.
    """
    arcs = {
        name: face_arcs[name].fill_null(-1).to_numpy()[labelled.row].astype(np.int32)
        for name in ("surface_arc", "solid_arc")
    }
    pairs, pair = np.unique(np.column_stack(list(arcs.values())), axis=0, return_inverse=True)
    keys = labelled.triangles * len(pairs) + pair.reshape(-1, 1)
    vertices, triangles = np.unique(keys, return_inverse=True)
    of_points = dict(zip(arcs, pairs[vertices % len(pairs)].T.astype(np.int32)))
    of_triangles = arcs | {"face": face_arcs["face"].to_numpy()[labelled.row].astype(np.int32)}
    for columns in (of_points, of_triangles):
        columns |= dict(zip(("red", "green", "blue"), arc_colours(columns[f"{by}_arc"]).T))
    return ply_bytes(labelled.points[vertices // len(pairs)], triangles.reshape(-1, 3), of_points, of_triangles)


def coloured_scene(bodies):
    """Write closed parts of a solid as a scene in binary glTF, a coloured node for each.

    Parameters
    ----------
    bodies : ArcBodies

    Returns
    -------
    bytes
        Nodes are called `s` and the number of their arc, as edges are in `solid.graphml`; `rest` is what is on none.
    """
    names = [f"s{arc}" if arc >= 0 else "rest" for arc in bodies.label.tolist()]
    return scene_of_bodies(names, bodies.points, bodies.faces, arc_colours(bodies.label))
