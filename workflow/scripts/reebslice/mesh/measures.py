"""Area and volume of shells, summed face by face."""

from fractions import Fraction

import numpy as np

from ..kernels import njit


def orient_faces(faces, turned):
    """Turn over some faces, each from its first corner on.

    Parameters
    ----------
    faces : (m, 3) int
    turned : (m,) bool
        The faces to turn over.

    Returns
    -------
    (m, 3) int
        A new array if any is turned over, else `faces` itself.
    """
    if not turned.any():
        return faces
    wound = faces.copy()
    _turn_over(wound, turned)
    return wound


@njit
def _turn_over(faces, turned):
    for f in range(len(faces)):
        if turned[f]:
            faces[f, 1], faces[f, 2] = faces[f, 2], faces[f, 1]


def measure_shells(points, faces, shell, n_shells):
    """Sum the area and the signed volume of each shell.

    Parameters
    ----------
    points, faces : (n, 3) float64, mesh units, and (m, 3) int
    shell : (m,) int
        The shell of each face, below `n_shells`.
    n_shells : int

    Returns
    -------
    areas, volumes : (s,) float64
        Volumes are taken about a point of the shell, so that a small part far
        from the origin keeps its digits; where rounding could hide the sign,
        the volume is summed exactly: 0.0 means that it is zero.
    """
    areas, volumes, sizes, counts = _sum_faces(points, faces, np.ascontiguousarray(shell, np.int32), int(n_shells))
    # Differences and products round by 1e-16 each, sums by the square root of their length.
    noise = 2e-15 * sizes * np.sqrt(counts)
    for doubtful in np.flatnonzero(np.abs(volumes) <= noise):
        volumes[doubtful] = sum_volume_exactly(points, faces[shell == doubtful])
    return areas, volumes


@njit
def _sum_faces(points, faces, shell, n_shells):
    """Area, signed volume, what went into the volume in absolute numbers, and faces of each shell."""
    centre, counts = np.empty((n_shells, 3)), np.zeros(n_shells, np.int64)
    areas, volumes, sizes = np.zeros(n_shells), np.zeros(n_shells), np.zeros(n_shells)
    for f in range(len(faces)):
        s = np.int64(shell[f])
        if counts[s] == 0:
            first = faces[f, 0]
            centre[s, 0], centre[s, 1], centre[s, 2] = points[first, 0], points[first, 1], points[first, 2]
        counts[s] += 1
        ax, ay, az = _spoke(points, faces[f, 0], centre, s)
        bx, by, bz = _spoke(points, faces[f, 1], centre, s)
        cx, cy, cz = _spoke(points, faces[f, 2], centre, s)
        x, y, z = _cross(bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az)
        areas[s] += np.sqrt(x * x + y * y + z * z) / 2
        x, y, z = _cross(bx, by, bz, cx, cy, cz)
        volumes[s] += (ax * x + az * z + ay * y) / 6
        ax, ay, az = abs(ax), abs(ay), abs(az)
        bx, by, bz, cx, cy, cz = abs(bx), abs(by), abs(bz), abs(cx), abs(cy), abs(cz)
        sizes[s] += ax * (by * cz + bz * cy) + ay * (bz * cx + bx * cz) + az * (bx * cy + by * cx)
    return areas, volumes, sizes, counts


@njit(inner=True)
def _spoke(points, one, centres, other):
    return points[one, 0] - centres[other, 0], points[one, 1] - centres[other, 1], points[one, 2] - centres[other, 2]


@njit
def _cross(ax, ay, az, bx, by, bz):
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def count_collinear(points, faces):
    """Count the faces whose three distinct corners are in line, to rounding.

    They carry no area, but without them the surface would be open.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int

    Returns
    -------
    int
    """
    return _count_collinear(points, np.ascontiguousarray(faces, np.int32))


@njit
def _count_collinear(points, faces):
    count = 0
    for f in range(len(faces)):
        a = np.int64(faces[f, 0])
        bx, by, bz = _spoke(points, faces[f, 1], points, a)
        cx, cy, cz = _spoke(points, faces[f, 2], points, a)
        x, y, z = _cross(bx, by, bz, cx, cy, cz)
        sides = np.sqrt(bx * bx + by * by + bz * bz) * np.sqrt(cx * cx + cy * cy + cz * cz)
        count += np.sqrt(x * x + y * y + z * z) <= 1e-15 * sides
    return count


def sum_volume_exactly(points, faces):
    """Sum the signed volume of a closed surface in whole numbers.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int

    Returns
    -------
    float
        Correctly rounded.
    """
    used, local = np.unique(faces, return_inverse=True)
    exact = [[Fraction(float(x)) for x in point] for point in points[used]]
    six = Fraction(0)
    for i, j, k in local.reshape(-1, 3):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = exact[i], exact[j], exact[k]
        six += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return float(six / 6)
