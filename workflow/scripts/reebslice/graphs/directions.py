"""Directions of height compared: what each would catch, hold, and leave in the air."""

import math
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ReebsliceError
from ..mesh.arguments import LEAST, take_bodies, take_mesh, take_number
from ..mesh.faults import find_used
from ..table_checks import build_table
from ..tilt.choice import rotation_to_vertical
from .pockets import find_islands, find_pockets

AXES = np.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]], float)
NUMBER = 26
# Of the diagonal of the box around all: the default distance between layers, and depth of what is passed over.
DISTANCE, DEPTH = 1e-3, 1e-3
MOST_LAYERS = 2**30  # along the diagonal; a count of layers is held in 32 bits


class Directions(NamedTuple):
    """D directions of height, the best first.

    Attributes
    ----------
    direction : (D, 3) float64
        Unit vectors that point upward, model frame.
    islands, basins, bells, sealed : (D,) int32
        Numbers, as of :func:`.pockets.find_islands` and :func:`.pockets.find_pockets`.
    island_volume, basin_volume, bell_volume, sealed_volume : (D,) float64
        All together, what one of them contains of others counted once, mesh units cubed.
    overhang_area : (D,) float64
        Of faces that look down and are steeper over than the angle, those on the plate left out, mesh units squared.
    height : (D,) float64
        From the lowest to the highest point, mesh units.
    layers : (D,) int32
        So many layers of the distance make this height.
    support_free_height : (D,) float64
        From the lowest point, the plate, to where the first island begins; the whole height if none does.
    """

    direction: np.ndarray
    islands: np.ndarray
    island_volume: np.ndarray
    basins: np.ndarray
    basin_volume: np.ndarray
    bells: np.ndarray
    bell_volume: np.ndarray
    sealed: np.ndarray
    sealed_volume: np.ndarray
    overhang_area: np.ndarray
    height: np.ndarray
    layers: np.ndarray
    support_free_height: np.ndarray


def compare_directions(
    points: Any,
    faces: ArrayLike | None = None,
    directions: ArrayLike | int = NUMBER,
    distance: float | None = None,
    least_depth: float | None = None,
    overhang: float = 45.0,
    body_of_vertex: ArrayLike | None = None,
) -> Directions:
    """Compare directions of building or hanging: pockets, islands, overhangs and layers of each, the best first.

    Parameters
    ----------
    points, faces, body_of_vertex
        As for :func:`exact_graphs`.
    directions : int or (D, 3) float
        What is to be up, vectors of any length; or a number of directions spread over the sphere, which the six axes
        go before.
    distance : float, optional
        Height of a layer, mesh units; by default a thousandth of the diagonal of the box around all.
    least_depth : float, optional
        Pockets and islands less deep are left out, mesh units; by default a thousandth of the diagonal.
    overhang : float
        Degrees between a face and the vertical from which it counts as overhanging, 0 to 90.

    Returns
    -------
    Directions
        Sorted by the number of islands, then of basins and bells together, then by the overhanging area, then by
        layers, least first; what is equal in all stays in the order given. Numbers and volumes are exact, as those of
        the functions that give them are; a direction and its opposite swap basins and bells.

    Raises
    ------
    NotASolidError, TooManyCrossingsError
        As of :func:`exact_graphs`.
    ReebsliceError
        A direction has no length, or a number is out of range.

    Examples
    --------
    >>> import trimesh
    >>> legs = [trimesh.creation.box(bounds=[[x, 0, 0], [x + 1, 1, 3]]) for x in (0, 2)]
    >>> table = trimesh.boolean.union([*legs, trimesh.creation.box(bounds=[[0, 0, 3], [3, 1, 4]])])
    >>> found = compare_directions(table, directions=[[0, 0, 1], [0, 0, -1], [1, 0, 0]])
    >>> found.direction.tolist()  # upside down; on its feet; on its side
    [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]
    >>> found.islands.tolist(), found.overhang_area.tolist()
    ([0, 0, 0], [0.0, 1.0, 3.0])
    """
    points, faces = take_mesh(points, faces)
    body = take_bodies(body_of_vertex, len(points))
    diagonal = float(np.linalg.norm(np.ptp(points[find_used(len(points), faces)], axis=0)))
    distance = (
        DISTANCE * diagonal
        if distance is None
        else take_number(distance, "distance", max(diagonal / MOST_LAYERS, LEAST))
    )
    depth = DEPTH * diagonal if least_depth is None else take_number(least_depth, "least_depth", 0)
    angle = take_number(overhang, "overhang", 0, 90)
    rows = [(up, *_rate(points, faces, body, up, (distance, depth, angle))) for up in _take_directions(directions)]
    columns = Directions(*map(np.array, zip(*rows, strict=True)))
    columns = columns._replace(**{
        name: getattr(columns, name).astype(np.int32) for name in ("islands", "basins", "bells", "sealed", "layers")
    })  # fmt: skip
    pockets = columns.basins + columns.bells
    order = np.lexsort((columns.layers, columns.overhang_area, pockets, columns.islands))
    return Directions(*(column[order] for column in columns))


def spread_directions(number):
    """Spread directions over the sphere, the six axes before.

    Parameters
    ----------
    number : int
        How many beside the axes.

    Returns
    -------
    (6 + number, 3) float64
        Unit vectors: +z, -z, +x, -x, +y, -y, then a Fibonacci lattice from top to bottom.

    References
    ----------
    A. Gonzalez, Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices, Mathematical
    Geosciences 42 (2010), doi:10.1007/s11004-009-9257-x
    """
    k = np.arange(number)
    z = 1 - (2 * k + 1) / max(number, 1)
    turn = k * math.pi * (3 - math.sqrt(5))
    across = np.sqrt(1 - z**2)
    return np.concatenate([AXES, np.column_stack([across * np.cos(turn), across * np.sin(turn), z])])


def directions_table(model, found):
    """Make the table `directions` of one model.

    Parameters
    ----------
    model : str
    found : Directions

    Returns
    -------
    pyarrow.Table
    """
    fields = found._asdict()
    x, y, z = fields.pop("direction").T
    count = len(x)
    return build_table(
        "directions", {"model": [model] * count, "place": np.arange(count), "x": x, "y": y, "z": z, **fields}
    )


def _take_directions(directions):
    """Unit vectors (D, 3) of what was given."""
    if isinstance(directions, Integral):
        if directions < 0:
            raise ReebsliceError(f"directions is {directions}: a number of them must be 0 or more.")
        return spread_directions(int(directions))
    vectors = np.atleast_2d(np.asarray(directions, float))
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    if (
        vectors.ndim != 2
        or vectors.shape[1:] != (3,)
        or not len(vectors)
        or not ((length > 0) & (length < np.inf)).all()
    ):
        raise ReebsliceError("directions must be vectors of three finite numbers, not all 0, or how many there are.")
    return vectors / length


def _rate(points, faces, body, up, measures):
    """What :class:`Directions` says of one direction; measures : distance, least depth, and angle of overhangs."""
    distance, depth, angle = measures
    rotation, heights = rotation_to_vertical(up), points @ up
    low, high = (float(extreme(heights[find_used(len(points), faces)])) for extreme in (np.min, np.max))
    coarse = max(high - low, distance)  # no throats and largest sections are asked for, which take levels
    pockets = find_pockets(points, faces, rotation, depth, coarse)
    islands = find_islands(points, faces, rotation, body, depth, coarse)
    free = float(islands.begin_height.min(initial=high)) - low
    return (
        *_total(islands, "island"), *(part for kind in ("basin", "bell", "sealed") for part in _total(pockets, kind)),
        _overhanging(points, faces, up, low + depth, angle), high - low,
        max(1, math.ceil((high - low) / distance * (1 - 1e-12))), free,
    )  # fmt: skip


def _total(found, kind):
    """How many there are of a kind, and their volume, of what one contains of others counted once."""
    chosen = found.kind == kind
    return chosen.sum(), found.volume[chosen & (found.into < 0)].sum()


def _overhanging(points, faces, up, plate, angle):
    """Area of the faces that look down, at an angle or more from the vertical, and are not wholly below the plate."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area, fall = np.linalg.norm(normal, axis=1) / 2, -(normal @ up) / 2
    over = (fall > 0) & (fall > area * math.sin(math.radians(angle)) * (1 + 1e-9))
    return float(area[over & ((points @ up)[faces] > plate).any(axis=1)].sum())
