"""Cut polygons into triangles: the same ones from any first corner, and of either winding.

A polygon is laid flat along its Newell normal, in an order of its corners that depends on their coordinates alone.
Convex ones are cut as a fan, quads along a diagonal; all others by mapbox-earcut, and where that leaves corners out
(repeated ones, spikes) or folds, by manifold3d, whose triangles always keep the whole outline. No vertex is added, so
what was closed stays closed.

References: https://github.com/mapbox/earcut, https://github.com/elalish/manifold.
"""

import numpy as np
import shapely

from ..errors import MeshFormatError
from ..kernels import njit
from ..mesh.faults import COUNTED_FROM_0, find_fault
from .flat_polygons import lay_flat
from .mesh_file import MeshFile
from .quads import FOLDED, STRAIGHT, cut_quad

BENT = 1e-3  # of a polygon's size: corners farther from its plane are told
FLAT = 1e-6  # of a polygon's size: corners no farther from its plane are in it, to rounding of its coordinates
EASY, HARD, CROSSED, SKEW = range(4)


def build_mesh(points, corners, sizes, names=COUNTED_FROM_0, notes=()):
    """Return the mesh of polygons, checked.

    Parameters
    ----------
    points : (n, 3) float64
    corners : (c,) int, ids of points, polygon after polygon.
    sizes : (k,) int, corners of each polygon; those of fewer than three are left out, and told.
    names : Names, how the file counts.
    notes : sentences that go before those on the polygons.

    Raises
    ------
    MeshFormatError
        Ids that do not exist, coordinates that are not finite or beyond what
        areas can be multiplied of, polygons that cross themselves, or no polygons.
    """
    sizes = np.asarray(sizes, np.int64)
    if fault := find_fault(points, corners, names, sizes):
        raise MeshFormatError(fault)
    corners, told = corners.astype(np.int32, copy=False), list(notes)
    short = np.flatnonzero(sizes < 3)
    if len(short):
        told.append(
            f"{len(short)} faces of fewer than three corners were left out, the first is {names.face(short[0])}."
        )
        corners, numbers = corners[np.repeat(sizes >= 3, sizes)], np.flatnonzero(sizes >= 3)
        sizes, whole = sizes[numbers], names
        names = names._replace(face=lambda k: whole.face(numbers[k]))
    if not len(sizes):
        raise MeshFormatError(f"The file holds no faces of three corners or more. {' '.join(told)}")
    faces, more = cut_polygons(points, corners, sizes, names)
    return MeshFile(points, faces, None, (*told, *more))


def cut_polygons(points, corners, sizes, names=COUNTED_FROM_0):
    """Cut polygons into triangles.

    Parameters
    ----------
    points : (n, 3) float64, finite.
    corners : (c,) int32, ids of points, polygon after polygon.
    sizes : (k,) int64, corners of each polygon, three at least. A hole may be given by a bridge, two mesh edges in
        one place, to the outline.
    names : Names, how the file counts.

    Returns
    -------
    faces : (c - 2 k, 3) int32
        Polygon after polygon, wound as it is. In the plane of the polygon no triangle is turned over. A convex quad is
        cut along its shorter diagonal, another one along the diagonal that does not fold.
    notes : list of str
        How many polygons are bent, that is have corners off their plane by more than `BENT`.

    Raises
    ------
    MeshFormatError
        The outline of a polygon crosses itself, so that its triangles would fold.

    Examples
    --------
    >>> points = np.array([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]])
    >>> cut_polygons(points, np.array([0, 1, 2, 3], np.int32), np.array([4]))[0].tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    if (sizes == 3).all():
        return corners.reshape(-1, 3), []
    states, bends, faces = _cut_all(points, corners, sizes)
    begin = np.cumsum(sizes) - sizes
    for k in np.flatnonzero((states == HARD) | (states == CROSSED)):
        triangles = _cut_hard(points, corners[begin[k] : begin[k] + sizes[k]]) if states[k] == HARD else None
        if triangles is None:
            raise MeshFormatError(
                f"The outline of {names.face(k)}, a polygon of {sizes[k]} corners, crosses itself, so that it has no"
                " inside; cut it into triangles in the program that wrote the file."
            )
        row = begin[k] - 2 * k
        faces[row : row + len(triangles)] = triangles
    bent = np.flatnonzero((bends > BENT) | (states == SKEW))
    if not len(bent):
        return faces, []
    worst = bent[np.argmax(bends[bent])]
    return faces, [
        f"{len(bent)} of {np.count_nonzero(sizes > 3)} polygons are bent, that is their corners leave a plane by more"
        f" than {BENT:.1%} of their size, or they fold whichever way they are cut; the first is"
        f" {names.face(bent[0])}; at most it is {bends[worst]:.2%}, in {names.face(worst)}. How they are cut into"
        " triangles decides the surface."
    ]


@njit
def _cut_all(points, corners, sizes):
    """Cut all polygons that need no search: what is left to do (k,) int8, the bends (k,), the triangles."""
    states, bends = np.zeros(len(sizes), np.int8), np.zeros(len(sizes))
    faces = np.empty((len(corners) - 2 * len(sizes), 3), np.int32)
    most = sizes.max()
    order, places = np.empty(most, np.int32), np.empty((most, 2))
    begin = row = 0
    for k in range(len(sizes)):
        n = sizes[k]
        if n == 3:
            for c in range(3):
                faces[row, c] = corners[begin + c]
        elif n == 4:
            crossed, bends[k] = cut_quad(points, corners[begin : begin + 4], faces[row : row + 2])
            states[k] = EASY if not crossed else SKEW if bends[k] > FLAT else CROSSED
        else:
            flat = lay_flat(points, corners[begin : begin + n], order, places)
            bends[k] = flat.bend
            states[k] = _cut_one(order[:n], places, flat, faces[row : row + n - 2])
        begin, row = begin + n, row + n - 2
    return states, bends, faces


@njit(inner=True)
def _cut_one(order, places, flat, triangles):
    """Cut a polygon that is convex or has no area as a fan."""
    n = len(order)
    if flat.area == 0.0:
        if flat.spread > FOLDED * flat.reach:
            return CROSSED
    elif not _is_convex(places, n):
        return HARD
    for t in range(n - 2):
        b, c = (t + 2, t + 1) if flat.turned else (t + 1, t + 2)
        triangles[t, 0], triangles[t, 1], triangles[t, 2] = order[0], order[b], order[c]
    return EASY


@njit(inner=True)
def _is_convex(places, n):
    """Tell whether every corner turns left, and all of them once around."""
    rounds = 0
    for i in range(n):
        j, k = (i + 1) % n, (i + 2) % n
        turn = _turn(places, i, j, k)
        if turn <= 0 or turn * turn <= STRAIGHT**2 * _span(places, i, j) * _span(places, j, k):
            return False
        rounds += not _goes_up(places, i, j) and _goes_up(places, j, k)
    return rounds == 1


@njit
def _turn(places, a, b, c):
    """Twice the signed area of a triangle."""
    return (places[b, 0] - places[a, 0]) * (places[c, 1] - places[a, 1]) - (places[b, 1] - places[a, 1]) * (
        places[c, 0] - places[a, 0]
    )


@njit
def _span(places, a, b):
    return (places[b, 0] - places[a, 0]) ** 2 + (places[b, 1] - places[a, 1]) ** 2


@njit(inner=True)
def _goes_up(places, a, b):
    rise = places[b, 1] - places[a, 1]
    return rise > 0 or (rise == 0 and places[b, 0] > places[a, 0])


def _cut_hard(points, ids):
    """Cut one polygon by a library; None if the triangles of none fit its outline."""
    order, places = np.empty(len(ids), np.int32), np.empty((len(ids), 2))
    flat = lay_flat(points, ids, order, places)
    for clip in (_clip_ears, _clip_surely):
        triangles = clip(places)
        if _fit(places, triangles, flat):
            return order[triangles[:, ::-1] if flat.turned else triangles]
    return None


def _clip_ears(places):
    import mapbox_earcut  # few files come here

    return mapbox_earcut.triangulate_float64(places, np.array([len(places)], np.uint32)).reshape(-1, 3).astype(np.int64)


def _clip_surely(places):
    import manifold3d

    return manifold3d.triangulate([places], -1, False).astype(np.int64)


def _fit(places, triangles, flat):
    """Tell whether triangles have all mesh edges of the outline, and neither fold nor cover one another."""
    n = len(places)
    if len(triangles) != n - 2:
        return False
    edges = triangles * n + np.roll(triangles, -1, axis=1)
    if not np.isin(np.arange(n) * n + np.roll(np.arange(n), -1), edges).all():
        return False
    a, b, c = (places[corner] for corner in triangles.T)
    areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    if np.abs(areas).sum() - flat.area > FOLDED * flat.reach:
        return False
    if shapely.is_valid(shapely.polygons(places)):
        return True
    covered = 2 * shapely.area(shapely.union_all(shapely.polygons(places[triangles])))  # an outline may touch itself
    return flat.area - covered <= FOLDED * flat.reach
