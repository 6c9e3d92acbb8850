"""Signed areas of the contours next to critical points, which tell on which side of the surface an event happens."""

import numpy as np

from ..kernels import njit
from ..morse.ordered_mesh import cross_at, next_half_edge
from ..slicing.exact_contours import exact_tilt, locate_corners, turns_clockwise, walk_crossings


def link_areas(mesh, vertices):
    """Measure the signed horizontal areas of the links of extrema, scaled to one height.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    vertices : (k,) int
        Ranks of extrema.

    Returns
    -------
    (k,) float64
        The area of the contour at an infinitesimal distance from each, up to a positive factor, counter-clockwise
        seen from outside: at a minimum negative, and at a maximum positive, where material is inside the contour.
        An area that rounding could turn around, as at the rim of a flat, is a tiny one of the right sign.
    """
    wanted = np.full(len(mesh.points), -1, np.int32)
    wanted[vertices] = np.arange(len(vertices), dtype=np.int32)
    area, size, gate = _link_areas(mesh.points, mesh.faces, wanted, len(vertices))
    doubtful = np.flatnonzero(~(np.abs(area) > 32 * np.finfo(float).eps * size)).tolist()  # eight roundings a term
    tilt = exact_tilt(mesh.points) if doubtful else None
    for k in doubtful:
        is_minimum = mesh.faces[gate[k] // 3, gate[k] % 3] == vertices[k]
        hole = turns_around_hole(mesh, *_next_cut(mesh, int(vertices[k]), int(gate[k])), tilt)
        area[k] = np.finfo(float).tiny * (1 if hole == is_minimum else -1)
    return area


def _next_cut(mesh, v, gate):
    """An upward half-edge at an extremum and the cut right next to it that this crosses, on the side of its contour.

    The cut is beyond all vertices at the same place, unless mesh edges join the extremum to these alone, as where a
    rotation has rounded them together. The half-edge is `gate`, or another one where that ends before the cut.
    """
    faces, is_minimum = mesh.faces, mesh.faces[gate // 3, gate % 3] == v
    cut = v + int(is_minimum)
    while 0 < cut < len(mesh.points) and (mesh.points[cut if is_minimum else cut - 1] == mesh.points[v]).all():
        cut += 1 if is_minimum else -1
    if faces[gate // 3, gate % 3] < cut <= faces[gate // 3, (gate % 3 + 1) % 3]:
        return gate, cut
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    crossing = np.flatnonzero(((tails if is_minimum else heads) == v) & (tails < cut) & (cut <= heads))
    return (int(crossing[0]), cut) if len(crossing) else (gate, v + int(is_minimum))


@njit
def _link_areas(points, faces, wanted, n_wanted):
    """Areas, sums of the sizes of their terms, and upward half-edges at the vertices, each (k,).

    wanted : (n,) int32, the place of each vertex among those asked for, or -1. A neighbour at the vertex's own
    height is infinitely far away: the size is infinite.
    """
    nearest, gate = np.full(n_wanted, np.inf), np.empty(n_wanted, np.int64)
    for f in range(faces.shape[0]):
        for k in range(3):
            w = wanted[faces[f, k]]
            if w >= 0:
                nearest[w] = min(nearest[w], abs(points[faces[f, (k + 1) % 3], 2] - points[faces[f, k], 2]))
                gate[w] = 3 * f + max(k - 1, 0)  # from the lowest corner, or to one of the others
    area, size = np.zeros(n_wanted), np.zeros(n_wanted)
    for f in range(faces.shape[0]):
        for k in range(3):
            w = wanted[faces[f, k]]
            if w < 0:
                continue
            v, a, b = faces[f, k], faces[f, (k + 1) % 3], faces[f, (k + 2) % 3]
            if nearest[w] == 0:
                size[w] = np.inf
                continue
            sa = nearest[w] / abs(points[a, 2] - points[v, 2])
            sb = nearest[w] / abs(points[b, 2] - points[v, 2])
            ax, ay = sa * (points[a, 0] - points[v, 0]), sa * (points[a, 1] - points[v, 1])
            bx, by = sb * (points[b, 0] - points[v, 0]), sb * (points[b, 1] - points[v, 1])
            area[w] += 0.5 * (ax * by - ay * bx)
            size[w] += 0.5 * (abs(ax * by) + abs(ay * bx))
    return area, size, gate


def saddle_contours(mesh, saddles):
    """Measure the signed areas of the contours just below and just above simple saddles.

    A saddle has two contours below and one above (union) or one below and two above (separation).

    Parameters
    ----------
    mesh : HeightMesh
        Surface whose saddles are simple.
    saddles : (k,) int
        Ranks.

    Returns
    -------
    below, above : (k, 2) float64
        Negative for holes. Where there is one contour, and not two, the second area is NaN. An area that
        rounding could turn around, as contours inside flats have, is a tiny one of the right sign.
    """
    wanted = np.full(len(mesh.points), -1, np.int32)
    wanted[saddles] = np.arange(len(saddles), dtype=np.int32)
    area, length, gate = _saddle_contours(mesh, wanted, np.asarray(saddles, np.int32))
    rounding = 64 * np.finfo(float).eps * np.abs(mesh.points).max()
    doubtful = np.argwhere(np.abs(area) <= rounding * (length + rounding)).tolist()
    tilt = exact_tilt(mesh.points) if doubtful else None
    for side, s, k in doubtful:
        cut = int(saddles[s]) + side
        hole = turns_around_hole(mesh, gate[side, s, k], cut, tilt)
        area[side, s, k] = np.finfo(float).tiny * (-1 if hole else 1)
    return area[0], area[1]


@njit
def _saddle_contours(mesh, wanted, saddles):
    """Areas and lengths of the contours at saddles, (2, k, 2), and a half-edge of each: below, above.

    wanted : (n,) int32, the place of each vertex among the saddles, or -1
    """
    faces = mesh.faces
    # one mesh edge of each of the two lower and of the two upper link wedges
    gate = np.full((2, len(saddles), 2), -1, np.int64)
    for h in range(3 * faces.shape[0]):
        tail, head, third = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3], faces[h // 3, (h % 3 + 2) % 3]
        if wanted[tail] >= 0 and third < tail < head:
            gate[1, wanted[tail], 1 if gate[1, wanted[tail], 0] >= 0 else 0] = h
        if wanted[head] >= 0 and tail < head < third:
            gate[0, wanted[head], 1 if gate[0, wanted[head], 0] >= 0 else 0] = h
    area, length = np.full((2, len(saddles), 2), np.nan), np.zeros((2, len(saddles), 2))
    for s in range(len(saddles)):
        for side in range(2):
            first, second = gate[side, s]
            cut = saddles[s] + side
            area[side, s, 0], length[side, s, 0], met = walk_contour(mesh, first, second, saddles[s], cut)
            if not met:
                area[side, s, 1], length[side, s, 1], met = walk_contour(mesh, second, first, saddles[s], cut)
    return area, length, gate


def turns_around_hole(mesh, gate, cut, tilt):
    """Tell in exact numbers whether a contour bounds a hole.

    Parameters
    ----------
    mesh : HeightMesh
    gate : int
        An upward half-edge that the contour crosses.
    cut : int
        Ranks from `cut` on are above the level.
    tilt : Fraction
        What :func:`.exact_contours.exact_tilt` returns.

    Returns
    -------
    bool
    """
    low, high = walk_crossings(mesh.faces, mesh.twins, gate, cut)
    return turns_clockwise(locate_corners(mesh.points, low.tolist(), high.tolist(), cut, tilt))


@njit(inner=True)
def walk_contour(mesh, start, other, saddle, cut):
    """Measure the contour at the height of a vertex.

    Parameters
    ----------
    mesh : HeightMesh
    start, other : int
        Upward half-edges that the level crosses.
    saddle : int
        Rank of a vertex that the plane runs through.
    cut : int
        Ranks from `cut` on are above the level: `saddle` or the one after it.

    Returns
    -------
    area, length : float
        Of the contour through `start`, the area signed.
    met : bool
        Whether it runs through `other`.
    """
    points, faces, twins = mesh.points, mesh.faces, mesh.twins
    x0, y0, z0 = points[saddle]
    area, length, met, px, py, h = 0.0, 0.0, False, 0.0, 0.0, start
    while True:
        low, high = faces[h // 3, h % 3], faces[h // 3, (h % 3 + 1) % 3]
        x, y = cross_at(points[low], points[high], z0, x0, y0)
        area += 0.5 * (px * (y - y0) - py * (x - x0))
        length += np.hypot(x - x0 - px, y - y0 - py)  # from the saddle, so never too short
        px, py = x - x0, y - y0
        h = next_half_edge(faces, twins, h, cut)
        met |= h == other
        if h == start:
            return area, length, met
