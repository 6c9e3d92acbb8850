"""Orthographic views of points, height up."""

from typing import NamedTuple

import numpy as np


class View(NamedTuple):
    """An orthographic view: rows of `axes` are right, up and toward the eye.

    A point p is seen at pixel ((p . right - centre_x) scale + width / 2,
    height / 2 - (p . up - centre_y) scale), rows counted from the top.
    """

    axes: np.ndarray
    centre: np.ndarray
    scale: float
    width: int
    height: int


def view_axes(azimuth, elevation):
    """Rotation (3, 3) from the tilted frame to right, up, toward the eye.

    Angles in degrees. At azimuth 0 the eye is on the +x axis, at 90 on +y;
    a positive elevation looks down. Height points up in the picture.
    """
    a, e = np.radians([azimuth, elevation])
    right = [-np.sin(a), np.cos(a), 0.0]
    up = [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)]
    toward = [np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]
    return np.array([right, up, toward])


def choose_elevation(points):
    """Choose from how high a model is seen: low what stands, from above what lies flat.

    Parameters
    ----------
    points : (n, 3) float64
        In the tilted frame.

    Returns
    -------
    float
        Degrees: 15 for a model at least half as high as wide, 60 for one at most a tenth as high, between them evenly.
    """
    if len(points) == 0:
        return 15.0
    wide, deep, high = np.ptp(points, axis=0).tolist()
    flat = (0.5 - high / max(wide, deep, 1e-300)) / 0.4
    return 15.0 + 45.0 * min(max(flat, 0.0), 1.0)


def fit_view(points, azimuth, elevation, width, height, margin=0.06):
    """The view in which `points` (n, 3) fill a picture of width x height pixels.

    `margin` is the empty part at each side. A single point, or none, is
    put in the middle.
    """
    axes = view_axes(azimuth, elevation)
    if len(points) == 0:
        return View(axes, np.zeros(2), 1.0, width, height)
    seen = axes[:2] @ points.T
    low, high = seen.min(axis=1), seen.max(axis=1)
    room = np.array([width, height]) * (1 - 2 * margin)
    extent = high - low
    scale = float(np.min(room / np.where(extent > 0, extent, np.inf), initial=np.inf, where=extent > 0))
    return View(axes, (low + high) / 2, scale if np.isfinite(scale) else 1.0, width, height)


def project_points(points, view):
    """Pixel column, pixel row and depth, shape (n, 3), of `points` (n, 3)."""
    seen = np.asarray(points, dtype=float).reshape(-1, 3) @ view.axes.T
    column = (seen[:, 0] - view.centre[0]) * view.scale + view.width / 2
    row = view.height / 2 - (seen[:, 1] - view.centre[1]) * view.scale
    return np.column_stack([column, row, seen[:, 2]])
