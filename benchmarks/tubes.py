"""Tubes whose centrelines and radii are known: a knot, and a tree like a neuron's with a loop."""

from typing import NamedTuple

import manifold3d
import numpy as np


class Tube(NamedTuple):
    """A surface and the segments that it is around.

    Attributes
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
    segments : (s, 2, 3) float64
        Ends of the pieces of the centreline.
    radii : (s, 2) float64
        At both ends.
    loops : int
        Of the centreline.
    """

    points: np.ndarray
    faces: np.ndarray
    segments: np.ndarray
    radii: np.ndarray
    loops: int


def _trefoil(t):
    return np.stack([np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t)], axis=1)


def make_knot(around=360, across=24, radius=0.4):
    """A tube along a trefoil knot."""
    t, step = 2 * np.pi * np.arange(around) / around, 1e-3
    here = _trefoil(t)
    tangent = _trefoil(t + step) - _trefoil(t - step)
    bend = _trefoil(t + step) - 2 * here + _trefoil(t - step)
    binormal = np.cross(tangent, bend)
    normal = np.cross(binormal, tangent)
    binormal /= np.linalg.norm(binormal, axis=1)[:, None]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    roll = 2 * np.pi * np.arange(across) / across
    ring = np.cos(roll)[:, None] * normal[:, None] + np.sin(roll)[:, None] * binormal[:, None]
    points = (here[:, None] + radius * ring).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    faces = np.stack([a, c, b, a, d, c], axis=-1).reshape(-1, 3).astype(np.int32)
    fine = _trefoil(np.linspace(0, 2 * np.pi, 4001))
    segments = np.stack([fine[:-1], fine[1:]], axis=1)
    return Tube(points, faces, segments, np.full(segments.shape[:2], radius), 1)


# Points (x, y, z, radius) of a tree, and the paths between them; the last path closes a loop.
SPOTS = {
    "soma": (0, 0, 0, 1.2), "a": (0, 0.2, 3, 0.55), "b": (0.6, 0.4, 6, 0.5), "c": (-2.2, 0.8, 8.2, 0.35),
    "d": (-4.6, 0.2, 9.4, 0.25), "e": (2.8, -0.4, 8, 0.38), "f": (5.2, 0.6, 8.6, 0.28), "g": (3.4, -1.4, 10.6, 0.26),
    "h": (-2.8, -1.6, -1.6, 0.5), "i": (-5, -2.2, -2, 0.36), "j": (-7.2, -1.4, -1, 0.24), "k": (-5.8, -3.8, -4, 0.24),
    "l": (2.6, 0.4, -2, 0.5), "m": (4.8, 0.8, -2.6, 0.4), "n": (6.6, 1.6, -1.2, 0.3), "o": (6.8, 1.2, -4.4, 0.3),
    "p": (8.8, 1.8, -2.9, 0.3), "q": (11, 2.4, -2.8, 0.22),
}  # fmt: skip
PATHS = ("soma a b c d", "b e f", "e g", "soma h i j", "i k", "soma l m n p q", "m o p")


def make_tree(edge=0.25):
    """A tree with a soma, and one loop: capsules between spheres, united, cut into triangles of this size."""
    spots = {name: np.array(spot, float) for name, spot in SPOTS.items()}
    pairs = [pair for path in PATHS for pair in zip(path.split(), path.split()[1:])]
    capsules = []
    for pair in pairs:
        ends = [manifold3d.Manifold.sphere(spots[k][3], 48).translate(spots[k][:3].tolist()) for k in pair]
        capsules.append(manifold3d.Manifold.batch_hull(ends))
    body = manifold3d.Manifold.batch_boolean(capsules, manifold3d.OpType.Add).refine_to_length(edge).to_mesh64()
    points = np.array(body.vert_properties[:, :3])
    segments = np.array([[spots[k][:3] for k in pair] for pair in pairs])
    radii = np.array([[spots[k][3] for k in pair] for pair in pairs])
    return Tube(points, np.array(body.tri_verts, np.int32), segments, radii, 1)
