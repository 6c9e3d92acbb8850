"""How thick a solid is at the points of its surface: radii of the largest balls that touch there."""

import numpy as np
from scipy.spatial import cKDTree

STEPS = (10, 8)
THINNEST, THICKEST = 0.01, 0.4  # in lengths of which the square is the area
ROUNDS = 30
SHRINK = 1 - 1e-3  # a ball that shrinks by less has arrived


def describe_thickness(places, normals, area):
    """Distribute the surface over the radii of inner balls and the slope towards the centre.

    Parameters
    ----------
    places, normals : (p, 3) float64
        Points spread evenly over the surface, and outward unit normals.
    area : float
        Of the surface, mesh units squared.

    Returns
    -------
    (80,) float64
        Shares of the points: 10 equal steps of the logarithm of r / sqrt(area), r the radius of :func:`touching_balls`,
        from 0.01 to 0.4, what is beyond an end counting there, by 8 steps of n.u from -1 to 1, u being the direction
        from the mean of the points to the point and n the normal.
    """
    radius = touching_balls(places, normals, np.sqrt(area) / 2) / np.sqrt(area)
    from_centre = places - places.mean(axis=0)
    distance = np.maximum(np.linalg.norm(from_centre, axis=1), np.finfo(float).tiny)
    slope = np.einsum("ij,ij->i", normals, from_centre) / distance
    power = np.log(np.maximum(radius, THINNEST) / THINNEST) / np.log(THICKEST / THINNEST)
    cells = [np.clip(share * count, 0, count - 1).astype(int) for share, count in zip((power, (slope + 1) / 2), STEPS)]
    return np.bincount(np.ravel_multi_index(cells, STEPS), minlength=np.prod(STEPS)) / len(places)


def touching_balls(places, normals, largest):
    """Find the largest balls inside that touch a surface at its points.

    Parameters
    ----------
    places, normals : (p, 3) float64
        Points of the surface, and outward unit normals.
    largest : float
        No ball is larger.

    Returns
    -------
    (p,) float64
        Radii of balls around places - r normals with no other of the points inside, but for a thousandth of the radius.
        The surface is taken as it is: next to a convex mesh edge balls are small, however blunt it is.

    References
    ----------
    J. Ma, S. W. Bae and S. Choi, 3D medial axis point approximation using nearest neighbors and the normal field, The
    Visual Computer 28 (2012), doi:10.1007/s00371-011-0594-7
    """
    tree = cKDTree(places)
    radius, growing = np.full(len(places), float(largest)), np.arange(len(places))
    for _ in range(ROUNDS):
        own, size = places[growing], radius[growing]
        distance, near = tree.query(own - normals[growing] * size[:, None], k=2)
        itself = near[:, 0] == growing
        distance, near = np.where(itself, distance[:, 1], distance[:, 0]), np.where(itself, near[:, 1], near[:, 0])
        step = own - places[near]
        along = 2 * np.einsum("ij,ij->i", normals[growing], step)
        # the ball through both points that touches at the first
        through = np.einsum("ij,ij->i", step, step) / np.where(along > 0, along, 1)
        inside = (distance < size * SHRINK) & (along > 0) & (through < size)
        growing = growing[inside]
        radius[growing] = through[inside]
        if not len(growing):
            break
    return radius
