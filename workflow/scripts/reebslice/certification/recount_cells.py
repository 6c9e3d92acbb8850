"""Areas and volumes of the cells (face, slab) of a cut surface, counted again."""

import numpy as np


def measure_cells(surface, place, height, face, slab):
    """Area and flux of (face, slab) cells, two (k,) float64.

    The flux is the integral over height of the signed area that the cell's
    level segment sweeps around the middle of its shell; it is quadratic on
    either side of the middle corner, where Simpson's rule is exact. A face
    within one horizontal plane counts whole where its middle corner lies.
    """
    a, b, c = (surface.points[column] for column in surface.corners[face].T)
    floor = np.concatenate([[-np.inf], height])[slab]
    ceiling = np.concatenate([height, [np.inf]])[slab]
    whole = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    centre = _shell_centres(surface)[surface.shell[face]]
    rise = c[:, 2] - a[:, 2]
    share, flux = np.zeros(len(face)), np.zeros(len(face))
    for low, high, corner in ((a, b, a), (b, c, c)):
        z0, z1 = np.maximum(low[:, 2], floor), np.minimum(high[:, 2], ceiling)
        deep = np.maximum(z1 - z0, 0.0)
        widths = [_width(z, corner[:, 2], b[:, 2]) for z in (z0, z1)]
        share += (widths[0] + widths[1]) * np.divide(deep, rise, out=np.zeros(len(deep)), where=rise > 0)
        swept = [_swept(z, a, b, c, corner, centre) for z in (z0, (z0 + z1) / 2, z1)]
        flux += deep / 6 * (swept[0] + 4 * swept[1] + swept[2])
    flat = rise == 0
    share[flat] = slab[flat] == place[surface.corners[face[flat], 1]]
    return whole * share, np.where(surface.even[face], flux, -flux)


def _shell_centres(surface):
    n = int(surface.shell.max(initial=0)) + 1
    weight = np.maximum(np.bincount(surface.shell, minlength=n), 1)
    middle = surface.points[surface.corners[:, 0], :2]
    return np.stack([np.bincount(surface.shell, middle[:, k], n) / weight for k in (0, 1)], axis=1)


def _share(z, start, end):
    """How far z is on the way from `start` to `end`, within 0 and 1."""
    return np.clip(np.divide(z - start, end - start, out=np.ones(len(z)), where=end != start), 0.0, 1.0)


def _width(z, tip, middle):
    """Length of the level segment at z in parts of the longest one."""
    return _share(z, tip, middle)


def _swept(z, a, b, c, corner, centre):
    """Signed area between `centre` and the level segment from side ac to the middle corner's side."""
    p = a[:, :2] + _share(z, a[:, 2], c[:, 2])[:, None] * (c - a)[:, :2] - centre
    q = corner[:, :2] + _share(z, corner[:, 2], b[:, 2])[:, None] * (b - corner)[:, :2] - centre
    return 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
