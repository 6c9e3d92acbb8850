"""Sizes of a solid and the distances in it."""

import numpy as np

from ..arrays.components import connected_items


def sizes(points, faces):
    """Area of the surface and volume of the solid, mesh units squared and cubed."""
    a, b, c = (np.asarray(points)[np.asarray(faces)[:, k]] for k in range(3))
    apex = np.asarray(points).mean(axis=0)
    cross = np.cross(b - a, c - a)
    return np.linalg.norm(cross, axis=1).sum() / 2, np.einsum("ij,ij->", a - apex, cross) / 6


def betti_numbers(points, faces):
    """Betti numbers of the surface, [b0, b1, b2]: shells, twice the sum of genera, shells."""
    faces = np.asarray(faces)
    used = np.unique(faces)
    label = connected_items(np.searchsorted(used, faces[:, :2]).ravel(), np.searchsorted(used, faces[:, 1:]).ravel(), len(used))
    shells = int(label.max()) + 1
    euler = len(used) - len(faces) // 2
    return np.array([shells, 2 * shells - euler, shells], float)


def distance_histogram(points, faces, pairs=2**16, bins=64):
    """D2."""
    points, faces = np.asarray(points), np.asarray(faces)
    spread = sample_surface(points, faces, 2 * pairs)
    distance = np.linalg.norm(spread[:pairs] - spread[pairs:], axis=1)
    return np.histogram(distance / distance.mean(), bins=bins, range=(0, 3))[0] / pairs


def sample_surface(points, faces, number, seed=0):
    """Points spread evenly over the surface: (number, 3)."""
    random = np.random.default_rng(seed)
    a, b, c = (points[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    face = np.minimum(np.searchsorted(np.cumsum(area) / area.sum(), random.random(number)), len(faces) - 1)
    root, part = np.sqrt(random.random(number)), random.random(number)
    weights = np.stack([1 - root, root * (1 - part), root * part])
    return weights[0][:, None] * a[face] + weights[1][:, None] * b[face] + weights[2][:, None] * c[face]
