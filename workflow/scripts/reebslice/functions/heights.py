"""Heights along directions that are spread well, whichever way a model stands."""

import math

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ReebsliceError


def spread_axes(number: int) -> np.ndarray:
    """Spread directions over the half sphere, as the height along the opposite of one is its mirror image.

    Parameters
    ----------
    number : int
        How many, 1 or more.

    Returns
    -------
    (number, 3) float64
        Unit vectors, a spherical Fibonacci lattice; the first is the third axis.

    Raises
    ------
    ReebsliceError
        The number is less than 1.

    References
    ----------
    A. Gonzalez, Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices, Mathematical
    Geosciences 42 (2010), doi:10.1007/s11004-009-9257-x

    Examples
    --------
    >>> spread_axes(1).tolist()
    [[0.0, 0.0, 1.0]]
    """
    if number < 1:
        raise ReebsliceError(f"number is {number}: there must be at least one direction.")
    k = np.arange(number)
    z = 1 - k / number
    turn = k * math.pi * (3 - math.sqrt(5))
    across = np.sqrt(1 - z**2)
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), z])


def directional_height(points: ArrayLike, direction: ArrayLike) -> np.ndarray:
    """Measure how high each point is in a direction.

    Parameters
    ----------
    points : (n, 3) float
    direction : (3,) float
        What is up, a unit vector.

    Returns
    -------
    (n,) float64
        Scalar products, mesh units, summed from the first coordinate on, so they are the same on every machine.

    Examples
    --------
    >>> directional_height([[1, 2, 3]], [0, 0, 1]).tolist()
    [3.0]
    """
    x, y, z = np.asarray(points, np.float64).T
    u, v, w = np.asarray(direction, np.float64).tolist()
    return x * u + y * v + z * w
