"""What the contours of any function measure in space, where they need not lie in a plane."""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import Groups
from ..kernels import njit
from ..morse.ordered_mesh import next_half_edge
from .graph_slices import climb


class Rings(NamedTuple):
    """Contours of the arcs of a Reeb graph, R of them, arc by arc, upward.

    Attributes
    ----------
    of_arcs : Groups
        Rings of each arc: right above its lower end, at the levels that cross it, and right below its upper end.
    value : (R,) float64
        Of the function.
    perimeter : (R,) float64
    mean : (R, 3) float64
        Mean point of the curve.
    area : (R, 3) float64
        Area vector: seen along a unit vector, the curve encloses the area of the product of both.
    moment : (R, 3, 3) float64
        Its product with the area vector of whatever length is the first moment of the area seen along that.
    """

    of_arcs: Groups
    value: np.ndarray
    perimeter: np.ndarray
    mean: np.ndarray
    area: np.ndarray
    moment: np.ndarray


def measure_rings(mesh, graph, levels, places):
    """Measure the contours of all arcs, at their ends and at some levels.

    Parameters
    ----------
    mesh : HeightMesh
        Whose height is the function.
    graph : ReebGraph
        The mesh's.
    levels : Levels
    places : (n, 3) float64
        Where the vertices of the mesh are in space.

    Returns
    -------
    Rings
    """
    ends = graph.nodes[graph.arcs]
    low, high = (np.searchsorted(levels.below, ends[:, k], side="right") for k in (0, 1))
    start = np.concatenate([[0], np.cumsum(high - low + 2)])
    cut, value = np.empty(start[-1], np.int32), np.empty(start[-1])
    level = np.arange(start[-1]) - np.repeat(start[:-1] + 1 - low, high - low + 2)
    inside = np.ones(start[-1], bool)
    inside[start[:-1]] = inside[start[1:] - 1] = False
    cut[inside], value[inside] = levels.below[level[inside]], levels.height[level[inside]]
    cut[start[:-1]], cut[start[1:] - 1] = ends[:, 0] + 1, ends[:, 1]
    value[start[:-1]], value[start[1:] - 1] = mesh.points[ends, 2].T
    crossing = climb(mesh.faces, mesh.twins, cut, graph.gates, start, np.arange(len(cut), dtype=np.int32))
    found = _measure(mesh, places, crossing, cut, value)
    return Rings(Groups(start, np.arange(start[-1])), value, *found)


@njit
def _measure(mesh, places, crossing, cut, value):
    """Perimeter, mean, area vector and moment of contours."""
    count = len(crossing)
    perimeter, mean = np.zeros(count), np.zeros((count, 3))
    area, moment = np.zeros((count, 3)), np.zeros((count, 3, 3))
    first, here, there, patch = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for ring in range(count):
        h = np.int64(crossing[ring])
        _place(mesh, places, h, value[ring], first)
        for k in range(3):
            there[k] = first[k]
        while True:
            for k in range(3):
                here[k] = there[k]
            h = np.int64(next_half_edge(mesh.faces, mesh.twins, h, cut[ring]))
            _place(mesh, places, h, value[ring], there)
            step = np.sqrt(((there - here) ** 2).sum())
            perimeter[ring] += step
            a, b = here - first, there - first
            for k in range(3):
                patch[k] = (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]) / 2
                mean[ring, k] += step * (a[k] + b[k]) / 2
            for k in range(3):
                area[ring, k] += patch[k]
                for j in range(3):
                    moment[ring, k, j] += (a[k] + b[k]) / 3 * patch[j]
            if h == crossing[ring]:
                break
        for k in range(3):
            mean[ring, k] = first[k] + (mean[ring, k] / perimeter[ring] if perimeter[ring] > 0 else 0.0)
            for j in range(3):
                moment[ring, k, j] += first[k] * area[ring, j]
    return perimeter, mean, area, moment


@njit
def _place(mesh, places, h, value, out):
    """Where a contour of this value crosses an upward half-edge; the middle of one that is at one value."""
    low, high = mesh.faces[h // 3, h % 3], mesh.faces[h // 3, (h % 3 + 1) % 3]
    span, t = mesh.points[high, 2] - mesh.points[low, 2], 0.5
    if span > 0:
        t = min(max((value - mesh.points[low, 2]) / span, 0.0), 1.0)
    for k in range(3):
        out[k] = places[low, k] + t * (places[high, k] - places[low, k])
