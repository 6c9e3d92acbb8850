"""What parallel planes make of a surface: cells, one per face and level or per face and slab, and their components.

The contours are the connected components of the cells in levels, the pieces of
the surface those of the cells in slabs: a mesh edge that meets a level or slab
joins the cells of its two faces there. One kernel finds both.
"""

from typing import NamedTuple

import numpy as np

from ...kernels import njit
from .components import first_parents, join, number_sets


class Cut(NamedTuple):
    """Where K levels cut a surface of n vertices and s shells.

    place : (n,) int32, the levels below each vertex
    planes : (K, 3) float64, height, tie_x and tie_y of each level
    bounds : (K + 2,) float64, the heights between which the slabs are; slab k is the one below level k
    centre : (s, 2) float64, the middle of each shell
    """

    place: np.ndarray
    planes: np.ndarray
    bounds: np.ndarray
    centre: np.ndarray


class Run(NamedTuple):
    """Levels or slabs first..last-1, and ranges (begin, end) that hold all faces and all mesh edges that meet them."""

    first: int
    last: int
    faces: tuple
    sides: tuple


class Cells(NamedTuple):
    """The cells of a run, and the P components that they make.

    origin : the first face of the run
    start : the cell of face f in level or slab k is start[f - origin] + k
    part : (N,) int32, the component of each cell
    n_parts : P
    """

    origin: int
    start: np.ndarray
    part: np.ndarray
    n_parts: int

    def of(self, face, k):
        """Find the component of faces in levels or slabs that they meet.

        Parameters
        ----------
        face, k : (q,) int

        Returns
        -------
        (q,) int32
        """
        return self.part[self.start[face - self.origin] + k]


def join_cells(surface, sides, place, run, slabs):
    """Find the cells of a surface in a run, and the components that they make.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
        The surface and its mesh edges.
    place : (n,) int32
        The levels below each vertex.
    run : Run
    slabs : bool
        Whether the cells are those in slabs, or in levels.

    Returns
    -------
    Cells
    """
    return Cells(run.faces[0], *_join_cells(surface, sides, place, run, int(slabs)))


@njit
def _join_cells(surface, sides, place, run, more):
    """What is from the place of its lower to that of its upper end meets the levels between, and 1 `more` slab."""
    origin, end = run.faces
    start, n = np.empty(end - origin, np.int64), 0
    for f in range(origin, end):
        low, high = max(place[surface.corners[f, 0]], run.first), min(place[surface.corners[f, 2]] + more, run.last)
        start[f - origin] = n - low
        n += max(high - low, 0)
    part = first_parents(n)
    for side in range(run.sides[0], run.sides[1]):
        low, high = max(place[sides.lower[side]], run.first), min(place[sides.upper[side]] + more, run.last)
        if low < high:
            one, two = start[sides.faces[side, 0] - origin], start[sides.faces[side, 1] - origin]
            for k in range(low, high):
                join(part, one + k, two + k)
    return start, part, number_sets(part)


@njit
def measure_contours(surface, cut, run, cells, doubled):
    """Measure the contours that the cells in a run of levels make.

    Parameters
    ----------
    surface, cut, run : Ranked, Cut, Run
    cells : Cells
        Of levels.
    doubled : (n,) int64
        How often the mesh edges up to a vertex may be doubled where the
        vertex, a multiple saddle, comes apart.

    Returns
    -------
    level, shell, n_points, loose : (P,) int64
        `n_points` counts crossings of mesh edges, `loose` how many more there may be.
    area, perimeter : (P,) float64
        The area is signed, negative for holes.
    """
    n, place = cells.n_parts, cut.place
    level, shell, n_points, loose = np.zeros((4, n), np.int64)
    area, perimeter, seen_from = np.zeros(n), np.zeros(n), np.empty((n, 2))
    for f in range(run.faces[0], run.faces[1]):
        a, b, c = surface.corners[f]
        first, last = max(place[a], run.first), min(place[c], run.last)
        if first >= last:
            continue
        ab, bc, ac = line(surface.points, a, b), line(surface.points, b, c), line(surface.points, a, c)
        for k in range(first, last):
            p = cells.part[cells.start[f - run.faces[0]] + k]
            (px, py), (qx, qy) = meet(ac, cut.planes, k), meet(ab if k < place[b] else bc, cut.planes, k)
            if n_points[p] == 0:  # from a point of the contour, nothing cancels far from the origin
                level[p], shell[p], seen_from[p, 0], seen_from[p, 1] = k, surface.shell[f], px, py
            n_points[p] += 1
            loose[p] += doubled[c] + doubled[b if k < place[b] else c]
            x, y = seen_from[p, 0], seen_from[p, 1]
            swept = 0.5 * ((px - x) * (qy - y) - (py - y) * (qx - x))
            area[p] += swept if surface.even[f] else -swept
            perimeter[p] += np.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))
    return level, shell, n_points, loose // 2, area, perimeter  # each crossing was met in two faces


def cross(surface, low, high, planes):
    """Find where mesh edges meet planes that are tilted infinitesimally.

    Parameters
    ----------
    surface : Ranked
    low, high : (k,) int
        The ends of the mesh edges, upward.
    planes : (k, 3) float64
        height, tie_x and tie_y.

    Returns
    -------
    (k, 2) float64
    """
    return _cross(surface.points, np.ascontiguousarray(low), np.ascontiguousarray(high), planes)


@njit
def _cross(points, low, high, planes):
    """As :func:`cross`."""
    spots = np.empty((len(low), 2))
    for k in range(len(low)):
        spots[k, 0], spots[k, 1] = meet(line(points, low[k], high[k]), planes, k)
    return spots


@njit
def line(points, low, high):
    """What :func:`meet` needs of the mesh edge from `low` up to `high`; ties of height are tilts."""
    axis, column = 2, 0
    if points[low, 2] == points[high, 2]:
        axis, column = (0, 1) if points[low, 0] != points[high, 0] else (1, 2)
    x, y, start = points[low, 0], points[low, 1], points[low, axis]
    return column, start, points[high, axis] - start, x, y, points[high, 0] - x, points[high, 1] - y


@njit
def meet(edge, planes, k):
    """Where a mesh edge, of :func:`line`, meets plane k, (height, tie_x, tie_y)."""
    column, start, span, x, y, dx, dy = edge
    share = (planes[k, column] - start) / span if span != 0 else 0.5
    share = 0.5 if np.isnan(share) else min(max(share, 0.0), 1.0)
    return x + share * dx, y + share * dy


@njit
def measure_pieces(surface, cut, run, cells):
    """Measure the pieces of surface that the cells in a run of slabs make.

    Parameters
    ----------
    surface, cut, run : Ranked, Cut, Run
    cells : Cells
        Of slabs.

    Returns
    -------
    slab, shell, euler : (P,) int64
        V - E + F, of which the vertices are not yet counted. Boundary circles
        have as many crossings as segments, so they cancel.
    area, flux : (P,) float64
        The flux is the integral over height of the signed area that the
        cell's level segment sweeps around the middle of its shell. A face
        within one horizontal plane counts whole where its middle corner lies.
    """
    n, place = cells.n_parts, cut.place
    (slab, shell, euler), (area, flux) = np.zeros((3, n), np.int64), np.zeros((2, n))
    for f in range(run.faces[0], run.faces[1]):
        a, b, c = surface.corners[f]
        low, middle, high = place[a], place[b], place[c]
        bottom, top = max(low, run.first), min(high + 1, run.last)
        if bottom >= top:
            continue
        low_half, high_half, whole = _halves(surface, f, cut.centre)
        share, swept = _below(low_half, high_half, cut.bounds[bottom]) if bottom > low else (0.0, 0.0)
        for s in range(bottom, top):
            p, share_below, swept_below = cells.part[cells.start[f - run.faces[0]] + s], share, swept
            share, swept = _below(low_half, high_half, cut.bounds[s + 1])
            if low_half[1] + high_half[1] == 0.0:
                share = share_below + (s == middle)
            area[p] += (share - share_below) * whole
            flux[p] += swept - swept_below if surface.even[f] else swept_below - swept
            slab[p], shell[p] = s, surface.shell[f]
            # twice a face, less its sides here, each of which is in two faces: ac in all slabs, ab below b, bc above
            euler[p] += 2 - 1 - (s <= middle) - (s >= middle)
    return slab, shell, euler // 2, area, flux


@njit(inner=True)
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


@njit(inner=True)
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
