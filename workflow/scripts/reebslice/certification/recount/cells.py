"""Cells (face, slab) of a cut surface, the pieces that they make and the measures of those, counted again.

A mesh edge that meets a slab joins the cells of its two faces there, and
pieces are the connected components.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .components import first_parents, join, number_sets


class Cells(NamedTuple):
    """The cells in slabs first..last-1, slab s being the one below level s, and the P pieces they make.

    origin : the first face that may meet those slabs
    start : the cell of face f and slab s is start[f - origin] + s
    part : (N,) the piece of each cell. Per piece: `slab`, `shell`, `euler`
    (V - E + F), `area`, `flux`
    """

    origin: int
    start: np.ndarray
    part: np.ndarray
    slab: np.ndarray
    shell: np.ndarray
    euler: np.ndarray
    area: np.ndarray
    flux: np.ndarray


class Slabs(NamedTuple):
    """Where K levels cut a surface of n vertices and s shells into slabs.

    place : (n,) int32, the levels below each vertex
    bounds : (K + 2,) float64, the heights between which the slabs are
    centre : (s, 2) float64, the middle of each shell, of :func:`find_centres`
    """

    place: np.ndarray
    bounds: np.ndarray
    centre: np.ndarray


def find_cells(surface, sides, slabs, run, of_vertex, count):
    """Find the cells of a surface in a run of slabs, and the pieces that they make.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
        The surface and its mesh edges.
    slabs, run : Slabs, Run
        Where all slabs are, and those to look at.
    of_vertex : (n,) int64
        Filled in for the vertices in the run: their pieces, counted on from `count`.
    count : int
        Pieces before the run.

    Returns
    -------
    Cells
        The flux is the integral over height of the signed area that the
        cell's level segment sweeps around the middle of its shell. A face
        within one horizontal plane counts whole where its middle corner lies.
    """
    vertices = tuple(np.searchsorted(slabs.place, (run.first, run.last)).tolist())
    return Cells(run.faces[0], *_find_cells(surface, sides, slabs, run, vertices, of_vertex, count))


@njit
def find_centres(points, corners, shell):
    """Find the middle of the lowest corners of each shell's faces.

    Parameters
    ----------
    points : (n, 3) float64
    corners : (m, 3) int32
    shell : (m,) int32
        The shell of each face.

    Returns
    -------
    (s, 2) float64
    """
    n = shell.max() + 1
    centre, weight = np.zeros((n, 2)), np.zeros(n)
    for f in range(len(corners)):
        centre[shell[f], 0] += points[corners[f, 0], 0]
        centre[shell[f], 1] += points[corners[f, 0], 1]
        weight[shell[f]] += 1
    return centre / np.maximum(weight, 1).reshape(-1, 1)


@njit
def _find_cells(surface, sides, slabs, run, vertices, of_vertex, count):
    """Columns of :class:`Cells`."""
    start, part = _join_cells(surface, sides, slabs.place, run)
    n_parts = number_sets(part)
    slab, shells, twice = np.empty(n_parts, np.int64), np.empty(n_parts, np.int64), np.zeros(n_parts, np.int64)
    area, flux = np.zeros(n_parts), np.zeros(n_parts)
    place, corners = slabs.place, surface.corners
    for f in range(run.faces[0], run.faces[1]):
        low, middle, high = place[corners[f, 0]], place[corners[f, 1]], place[corners[f, 2]]
        bottom, top = max(low, run.first), min(high + 1, run.last)
        if bottom >= top:
            continue
        low_half, high_half, whole = _halves(surface, f, slabs.centre)
        share, swept = _below(low_half, high_half, slabs.bounds[bottom]) if bottom > low else (0.0, 0.0)
        for s in range(bottom, top):
            p, share_below, swept_below = part[start[f - run.faces[0]] + s], share, swept
            share, swept = _below(low_half, high_half, slabs.bounds[s + 1])
            if low_half[1] + high_half[1] == 0.0:
                share = share_below + (s == middle)
            area[p] += (share - share_below) * whole
            flux[p] += swept - swept_below if surface.even[f] else swept_below - swept
            slab[p], shells[p] = s, surface.shell[f]
            # a face, less its sides here, each of which is in two faces: ac in all slabs, ab below b, bc above
            twice[p] += 2 - 1 - (s <= middle) - (s >= middle)
        for corner, s in enumerate((low, middle, high)):
            if run.first <= s < run.last:
                of_vertex[corners[f, corner]] = part[start[f - run.faces[0]] + s] + count
    # boundary circles have as many crossings as segments, so they cancel
    for v in range(vertices[0], vertices[1]):
        if of_vertex[v] >= count:
            twice[of_vertex[v] - count] += 2
    return start, part, slab, shells, twice // 2, area, flux


@njit
def _join_cells(surface, sides, place, run):
    """Where the cells of each face begin, and their sets: a mesh edge joins those of its two faces."""
    origin, end = run.faces
    start, n = np.empty(end - origin, np.int64), 0
    for f in range(origin, end):
        low, high = max(place[surface.corners[f, 0]], run.first), min(place[surface.corners[f, 2]] + 1, run.last)
        start[f - origin] = n - low
        n += max(high - low, 0)
    part = first_parents(n)
    for side in range(run.sides[0], run.sides[1]):
        low, high = max(place[sides.lower[side]], run.first), min(place[sides.upper[side]] + 1, run.last)
        if low < high:
            one, two = start[sides.faces[side, 0] - origin], start[sides.faces[side, 1] - origin]
            for s in range(low, high):
                join(part, one + s, two + s)
    return start, part


@njit
def _halves(surface, f, centre):
    """What :func:`_below` needs of face f below and above its middle corner, and the area of the face.

    Of each half: height of the corner it tapers to, its own height, its share
    of the face's area, and the coefficients of the area that the level segment
    sweeps around the `centre` of its shell: linear and quadratic in the way from that corner.
    """
    points, x, y = surface.points, centre[surface.shell[f], 0], centre[surface.shell[f], 1]
    i, j, k = surface.corners[f, 0], surface.corners[f, 1], surface.corners[f, 2]
    ax, ay, az = points[i, 0] - x, points[i, 1] - y, points[i, 2]
    bx, by, bz = points[j, 0] - x, points[j, 1] - y, points[j, 2]
    cx, cy, cz = points[k, 0] - x, points[k, 1] - y, points[k, 2]
    rise = cz - az
    part = (bz - az) / rise if rise > 0.0 else 0.0
    # from a, or c, to where side ac is as high as b, and to b
    dx, dy, ex, ey = part * (cx - ax), part * (cy - ay), bx - ax, by - ay
    low = az, bz - az, part, 0.5 * (ax * (ey - dy) - ay * (ex - dx)), 0.5 * (dx * ey - dy * ex)
    dx, dy, ex, ey = (1 - part) * (ax - cx), (1 - part) * (ay - cy), bx - cx, by - cy
    high = cz, cz - bz, 1 - part, 0.5 * (cx * (ey - dy) - cy * (ex - dx)), 0.5 * (dx * ey - dy * ex)
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, rise
    area = 0.5 * np.sqrt((uy * vz - uz * vy) ** 2 + (uz * vx - ux * vz) ** 2 + (ux * vy - uy * vx) ** 2)
    return low, high, area


@njit
def _below(low, high, z):
    """Of a face the share of its area below height z, and its flux from there down were it even."""
    share, flux = 0.0, 0.0
    corner, rise, part, linear, quadratic = low
    if rise > 0.0:
        t = min(max((z - corner) / rise, 0.0), 1.0)
        share += part * t * t
        flux += rise * t * t * (linear / 2 + quadratic * t / 3)
    corner, rise, part, linear, quadratic = high
    if rise > 0.0:
        t = min(max((corner - z) / rise, 0.0), 1.0)
        share += part * (1 - t * t)
        flux += rise * (linear / 2 + quadratic / 3 - t * t * (linear / 2 + quadratic * t / 3))
    return share, flux
