"""Meshes to measure on, of any size: the bumpy torus, and white noise on it."""

import numpy as np

MAJOR, MINOR = 2.0, 0.7
# Angle of the torus's axis with the height. Lying, levels cross it as rings with a hole; upright, as disks, and its
# solid has a loop. Some heights tie.
TILTS = {"lying": np.radians(15.0), "upright": np.radians(80.0)}


def bumpy_torus(faces, bumps=12, tilt="lying", height=0.1):
    """A torus whose tube swells and shrinks `bumps` times around: points (n, 3) float64, faces (m, 3) int32.

    Closed, embedded, oriented outward, of genus 1 whatever the bumps, with
    about `faces` faces. tilt : "lying" or "upright"; height : of the bumps, in tube radii. Most bumps make
    a maximum and a saddle, most dents a minimum and a saddle, so that critical
    points grow as the square of `bumps`.
    """
    u, v, faces = _tube_grid(faces)
    radius = MINOR * (1 + height * np.sin(bumps * u) * np.sin(max(bumps // 3, 1) * v + 1.0))
    ring = MAJOR + radius * np.cos(v)
    x, y, z = ring * np.cos(u), ring * np.sin(u), radius * np.sin(v)
    cos, sin = np.cos(TILTS[tilt]), np.sin(TILTS[tilt])
    y, z = y * cos - z * sin, y * sin + z * cos
    return np.column_stack([x, y, z]), faces


def white_noise(faces, seed=0):
    """The same torus with random heights: a critical point at every fourth vertex or so. Only its mesh is a torus."""
    points, faces = bumpy_torus(faces)
    points[:, 2] = np.random.default_rng(seed).random(len(points))
    return points, faces


def _tube_grid(faces):
    """Angles around the ring and around the tube of every vertex, and the faces between them."""
    across = max(4, round(np.sqrt(faces / 2 * MINOR / MAJOR)))
    around = max(6, round(faces / 2 / across))
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    right, up = (i + 1) % around, (j + 1) % across
    a, b, c, d = i * across + j, right * across + j, right * across + up, i * across + up
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]).astype(np.int32)
    return 2 * np.pi * i / around, 2 * np.pi * (j + 0.5 * (i % 2)) / across, faces


def level_heights(points, count):
    """`count` equispaced heights half a spacing inside the ends, none of them that of a vertex: (count,) float64."""
    low, high = points[:, 2].min(), points[:, 2].max()
    heights = low + (high - low) * (np.arange(count) + 0.5) / count
    while (met := np.isin(heights, points[:, 2])).any():
        heights[met] = np.nextafter(heights[met], np.inf)
    return heights
