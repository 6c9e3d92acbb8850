"""Figures of a surface as a whole and of its shells, counted again."""

import numpy as np

from ...kernels import njit


def find_least_rise(points, lower, upper):
    """Find the smallest difference of height over mesh edges, by their ends."""
    z = np.ascontiguousarray(points[:, 2])
    return float((z[upper] - z[lower]).min())


@njit
def measure_shells(points, faces, shell, n):
    """Measure each of n shells.

    Parameters
    ----------
    points, faces : tuples of columns x, y, z and a, b, c
    shell : (m,) int
        The shell of each face.
    n : int

    Returns
    -------
    area, volume : (n,) float64
        The volume by divergence, seen from a corner of the shell.
    """
    (x, y, z), (a, b, c) = points, faces
    area, volume, seen_from = np.zeros(n), np.zeros(n), np.zeros(n, np.int64)
    for f in range(len(shell)):
        seen_from[shell[f]] = a[f]
    for f in range(len(shell)):
        o = seen_from[shell[f]]
        ax, ay, az = x[a[f]] - x[o], y[a[f]] - y[o], z[a[f]] - z[o]
        ux, uy, uz = x[b[f]] - x[a[f]], y[b[f]] - y[a[f]], z[b[f]] - z[a[f]]
        vx, vy, vz = x[c[f]] - x[a[f]], y[c[f]] - y[a[f]], z[c[f]] - z[a[f]]
        px, py, pz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area[shell[f]] += np.sqrt(px * px + py * py + pz * pz) / 2
        volume[shell[f]] += (ax * px + az * pz + ay * py) / 6
    return area, volume
