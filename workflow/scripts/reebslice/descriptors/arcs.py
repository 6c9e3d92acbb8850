"""Lengths, radii and volumes of the arcs of a function's Reeb graph as histograms."""

import numpy as np

from ..morse.face_arcs import label_arcs
from ..morse.reeb_graph import surface_reeb_graph
from ..morse.value_mesh import value_mesh
from .surface_points import face_areas

BINS = 16
# Powers of ten of what is counted, in lengths of which the square is the area of the surface.
LENGTHS, RADII, VOLUMES = (-3, 1), (-3, 0), (-6, 0)


def describe_arcs(values, arcs, points, faces):
    """Distribute the surface over the lengths, radii and volumes of the arcs on which it lies.

    Parameters
    ----------
    values : (n,) float64
        The function, mesh units.
    arcs : dict of str to array
        Columns of `function_arcs`.
    points, faces : (n, 3) float64 and (m, 3) int

    Returns
    -------
    lengths, radii, volumes : (16,) float64
        Shares of the area of the surface in 16 equal steps of the logarithm: of the length L = upper - lower of the
        arc, from 10^-3 to 10; of the radius A / (2 pi L) of the tube with its length and the area A along it, from
        10^-3 to 1; of the volume A^2 / (4 pi L) of that tube, from 10^-6 to 1. The unit of length is the square root of
        the area of the surface; what is beyond an end counts in the last step there.
    """
    mesh = value_mesh(values, points, faces)
    area = face_areas(points, mesh.vertex[mesh.faces])  # unfolded saddles have added faces without area
    arc = label_arcs(mesh, surface_reeb_graph(mesh)).of_face
    share = np.bincount(arc, weights=area, minlength=len(arcs["lower"])) / area.sum()
    unit = np.sqrt(area.sum())
    length = np.maximum((np.asarray(arcs["upper"]) - np.asarray(arcs["lower"])) / unit, 10.0 ** LENGTHS[0])
    sizes = length, share / (2 * np.pi * length), share**2 / (4 * np.pi * length)
    return tuple(_spread(size, share, ends) for size, ends in zip(sizes, (LENGTHS, RADII, VOLUMES)))


def _spread(size, share, ends):
    """Shares of the area in steps of the logarithm of a size, (16,)."""
    low, high = ends
    power = np.log10(np.maximum(size, 10.0 ** (low - 1)))
    place = np.clip((power - low) / (high - low) * BINS, 0, BINS - 1).astype(int)
    return np.bincount(place, weights=share, minlength=BINS)
