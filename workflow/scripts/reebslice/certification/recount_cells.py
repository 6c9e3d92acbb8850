"""Areas and volumes of the cells (face, slab) of a cut surface, counted again."""

import numpy as np
from numba import njit


def measure_cells(surface, place, height, face, slab):
    """Area and flux of (face, slab) cells, two (k,) float64.

    The flux is the integral over height of the signed area that the cell's
    level segment sweeps around the middle of its shell; it is quadratic on
    either side of the middle corner, where Simpson's rule is exact. A face
    within one horizontal plane counts whole where its middle corner lies.
    """
    floor, ceiling = np.append(-np.inf, height), np.append(height, np.inf)
    centre = _shell_centres(surface)[surface.shell]
    middle = place[surface.corners[:, 1]]
    return _measure(surface.points, surface.corners, surface.even, middle, centre, floor, ceiling, face, slab)


def _shell_centres(surface):
    n = int(surface.shell.max(initial=0)) + 1
    weight = np.maximum(np.bincount(surface.shell, minlength=n), 1)
    middle = surface.points[surface.corners[:, 0], :2]
    return np.stack([np.bincount(surface.shell, middle[:, k], n) / weight for k in (0, 1)], axis=1)


@njit(cache=True)
def _measure(points, corners, even, middle, centre, floor, ceiling, face, slab):
    area, flux = np.zeros(len(face)), np.zeros(len(face))
    for k in range(len(face)):
        f, s = face[k], slab[k]
        a, b, c = points[corners[f, 0]], points[corners[f, 1]], points[corners[f, 2]]
        rise = c[2] - a[2]
        share = 1.0 if rise == 0 and s == middle[f] else 0.0
        for low, high, corner in ((a, b, a), (b, c, c)):
            z0, z1 = max(low[2], floor[s]), min(high[2], ceiling[s])
            deep = z1 - z0
            if deep <= 0.0:
                continue
            # the level segment's length in parts of the longest one is linear here
            share += (_share(z0, corner[2], b[2]) + _share(z1, corner[2], b[2])) * deep / rise
            swept = _swept(z0, a, b, c, corner, centre[f]) + _swept(z1, a, b, c, corner, centre[f])
            flux[k] += deep / 6 * (swept + 4 * _swept((z0 + z1) / 2, a, b, c, corner, centre[f]))
        area[k] = share * _area(a, b, c)
        if not even[f]:
            flux[k] = -flux[k]
    return area, flux


@njit(cache=True, inline="always")
def _share(z, start, end):
    """How far z is on the way from `start` to `end`, within 0 and 1."""
    return min(max((z - start) / (end - start), 0.0), 1.0) if end != start else 1.0


@njit(cache=True, inline="always")
def _swept(z, a, b, c, corner, centre):
    """Signed area between `centre` and the level segment from side ac to the middle corner's side."""
    s, t = _share(z, a[2], c[2]), _share(z, corner[2], b[2])
    px, py = a[0] + s * (c[0] - a[0]) - centre[0], a[1] + s * (c[1] - a[1]) - centre[1]
    qx, qy = corner[0] + t * (b[0] - corner[0]) - centre[0], corner[1] + t * (b[1] - corner[1]) - centre[1]
    return 0.5 * (px * qy - py * qx)


@njit(cache=True, inline="always")
def _area(a, b, c):
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return 0.5 * np.sqrt((uy * vz - uz * vy) ** 2 + (uz * vx - ux * vz) ** 2 + (ux * vy - uy * vx) ** 2)
