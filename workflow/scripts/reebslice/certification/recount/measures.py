"""Figures of a surface as a whole and of its shells, counted again."""

import numpy as np

from ...kernels import njit


@njit
def least_rise(points, lower, upper):
    """Find the smallest difference of height over mesh edges.

    Parameters
    ----------
    points : (n, 3) float64
    lower, upper : (E,) int
        Their ends.

    Returns
    -------
    float
    """
    least = np.inf
    for k in range(len(lower)):
        least = min(least, points[upper[k], 2] - points[lower[k], 2])
    return least


@njit
def label_vertices(corners, shell, n):
    """Find the shell of each of n vertices by that of some face of it.

    Parameters
    ----------
    corners : (m, 3) int
    shell : (m,) int
        The shell of each face.
    n : int

    Returns
    -------
    label : (n,) int32
    agree : bool
        Whether all faces of every vertex are of one shell.
    """
    label, agree = np.zeros(n, np.int32), True
    for f in range(len(corners)):
        for k in range(3):
            label[corners[f, k]] = shell[f]
    for f in range(len(corners)):
        for k in range(3):
            agree = agree and label[corners[f, k]] == shell[f]
    return label, agree


@njit
def largest_terms(x, y, z, direction):
    """Find the largest sum of the absolute terms of the product of a point with a direction.

    Parameters
    ----------
    x, y, z : (n,) float64
    direction : (3,) float64

    Returns
    -------
    float
    """
    a, b, c = direction
    largest = 0.0
    for i in range(len(x)):
        largest = max(largest, abs(a * x[i]) + abs(b * y[i]) + abs(c * z[i]))
    return largest


def measure_shells(points, faces, shell, n):
    """Measure each of n shells.

    Parameters
    ----------
    points, faces : columns x, y, z and a, b, c
    shell : (m,) int
        The shell of each face.
    n : int

    Returns
    -------
    area, volume : (n,) float64
        The volume by divergence around the middle of the shell's corners.
    """
    return _measure_shells(*points, *faces, shell, n)


@njit
def _measure_shells(x, y, z, a, b, c, shell, n):
    """As :func:`measure_shells`, by columns."""
    middle, weight = np.zeros((n, 3)), np.zeros(n)
    for f in range(len(shell)):
        weight[shell[f]] += 1
        middle[shell[f], 0] += x[a[f]]
        middle[shell[f], 1] += y[a[f]]
        middle[shell[f], 2] += z[a[f]]
    middle /= np.maximum(weight, 1).reshape(-1, 1)
    area, volume = np.zeros(n), np.zeros(n)
    for f in range(len(shell)):
        mx, my, mz = middle[shell[f], 0], middle[shell[f], 1], middle[shell[f], 2]
        ax, ay, az = x[a[f]] - mx, y[a[f]] - my, z[a[f]] - mz
        bx, by, bz = x[b[f]] - mx, y[b[f]] - my, z[b[f]] - mz
        cx, cy, cz = x[c[f]] - mx, y[c[f]] - my, z[c[f]] - mz
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        px, py, pz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area[shell[f]] += np.sqrt(px * px + py * py + pz * pz) / 2
        volume[shell[f]] += (ax * px + az * pz + ay * py) / 6
    return area, volume
