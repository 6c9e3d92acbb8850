"""Points spread over a surface, and what pairs of them tell of the shape."""

import numpy as np
from scipy.special import sph_harm_y

from ..arrays.components import connected_items

POINTS, PAIRS = 4096, 2**16
SEED = 0
# Steps of distance, of how far both normals point apart, and of the cosine between them. The last two are odd: what
# coplanar and perpendicular faces make is 0, and is to lie inside a step, where rounding does not move it to another.
STEPS = (10, 9, 7)
FARTHEST = 2.4
DEGREES = range(2, 9)


def face_areas(points, faces):
    """Areas of triangles, (m,) float64."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def betti_numbers(points, faces):
    """Count shells, independent closed curves and voids of the surface itself.

    Returns
    -------
    (3,) float64
        b0 = b2 = number of shells; b1 = 2 b0 - chi, twice the genera together, chi = vertices - faces / 2.
    """
    used, corners = np.unique(faces, return_inverse=True)
    corners = corners.reshape(-1, 3)
    shells = connected_items(corners[:, :2].ravel(), corners[:, 1:].ravel(), len(used)).max() + 1
    return np.array([shells, 2 * shells - len(used) + len(faces) // 2, shells], float)


def sample_surface(points, faces):
    """Spread points over a surface evenly by area, the same ones however it is turned.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int

    Returns
    -------
    places, normals : (4096, 3) float64
        With faces in the order of the distances of their middles from the centre of the area, and each beginning with
        its farthest corner: one point in each 4096th of the area, at random within it, but always the same; and
        the unit normal of its face, outward. Another order of vertices or faces, or a rotation, changes them only
        where such distances are equal, or nearly so.
    """
    random = np.random.default_rng(SEED)
    area = face_areas(points, faces)
    middle = points[faces].mean(axis=1)
    centre = area @ middle / area.sum()
    order = np.argsort(np.linalg.norm(middle - centre, axis=1), kind="stable")
    far = np.linalg.norm(points - centre, axis=1)[faces].argmax(axis=1)
    turned = np.take_along_axis(faces, (far[:, None] + np.arange(3)) % 3, axis=1)[order]
    share = (np.arange(POINTS) + random.random(POINTS)) / POINTS
    chosen = turned[np.minimum(np.searchsorted(np.cumsum(area[order]) / area.sum(), share), len(faces) - 1)]
    a, b, c = (points[chosen[:, k]] for k in range(3))
    root, part = np.sqrt(random.random((POINTS, 1))), random.random((POINTS, 1))
    normal = np.cross(b - a, c - a)
    return a + root * (b - a) + root * part * (c - b), normal / np.linalg.norm(normal, axis=1, keepdims=True)


def normal_powers(points, faces):
    """Tell how the normals of a surface are spread over the directions, whichever way it is turned.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int

    Returns
    -------
    (7,) float64
        Of each degree l = 2 to 8 the root of the sum over m of |c_lm|^2, c_lm being the sum over faces of area times
        the spherical harmonic Y_lm of the outward normal, over the whole area. Degree 0 is a constant, and degree 1
        vanishes for a closed surface.

    References
    ----------
    B. K. P. Horn, Extended Gaussian images, Proceedings of the IEEE 72 (1984), doi:10.1109/PROC.1984.13073

    M. Kazhdan, T. Funkhouser and S. Rusinkiewicz, Rotation invariant spherical harmonic representation of 3D shape
    descriptors, SGP 2003
    """
    a, b, c = (points[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    size = np.linalg.norm(cross, axis=1)
    cross, size = cross[size > 0], size[size > 0]
    polar, azimuth = np.arccos(np.clip(cross[:, 2] / size, -1, 1)), np.arctan2(cross[:, 1], cross[:, 0])
    share = size / size.sum()
    powers = []
    for degree in DEGREES:
        orders = np.arange(degree + 1)
        sums = share @ sph_harm_y(degree, orders, polar[:, None], azimuth[:, None])
        powers.append(np.abs(sums[0]) ** 2 + 2 * (np.abs(sums[1:]) ** 2).sum())  # order -m is that of m, conjugate
    return np.sqrt(powers)


def relate_pairs(places, normals):
    """Tell how pairs of points of a surface lie to each other.

    Parameters
    ----------
    places, normals : (p, 3) float64
        Points and unit normals.

    Returns
    -------
    (630,) float64
        Shares of 65,536 pairs: 10 steps of their distance over the mean distance, from 0 to 2.4, by 9 of n1.u - n2.u,
        u being the unit vector from the first to the second, by 7 of n1.n2. It does not depend on size, place and
        rotation.

    References
    ----------
    E. Wahl, U. Hillenbrand and G. Hirzinger, Surflet-pair-relation histograms: a statistical 3D-shape representation
    for rapid classification, 3DIM 2003, doi:10.1109/IM.2003.1240284, of whose four features the two angles to u are
    added up here.

    R. Osada, T. Funkhouser, B. Chazelle and D. Dobkin, Shape distributions, ACM Transactions on Graphics 21 (2002),
    doi:10.1145/571647.571648, where distance alone is D2.
    """
    random = np.random.default_rng(SEED)
    first, second = random.integers(0, len(places), (2, PAIRS))
    apart = first != second
    first, second = first[apart], second[apart]
    step = places[second] - places[first]
    distance = np.linalg.norm(step, axis=1)
    along = step / np.maximum(distance, np.finfo(float).tiny)[:, None]
    away = np.einsum("ij,ij->i", normals[first] - normals[second], along)
    turned = np.einsum("ij,ij->i", normals[first], normals[second])
    features = (distance / distance.mean(), 0, FARTHEST), (away, -2, 2), (turned, -1, 1)
    places_of = [
        np.clip((value - low) / (high - low) * count, 0, count - 1).astype(int)
        for (value, low, high), count in zip(features, STEPS)
    ]
    return np.bincount(np.ravel_multi_index(places_of, STEPS), minlength=np.prod(STEPS)) / len(first)
