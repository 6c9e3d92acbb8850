"""Closed meshes of pockets and islands, cut out of the void or the solid by manifold3d."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays.components import connected_items
from ..errors import ReebsliceError
from ..mesh.arguments import take_mesh, take_rotation
from ..mesh.faults import find_used
from ..mesh.measures import measure_shells
from ..mesh.shells import find_enclosing
from ..morse.ordered_mesh import tilt_points
from .pocket_measures import Pockets
from .voids import box_in

# Of the height range: so far before a rim a pocket is cut, since at the rim itself it touches what it opens to.
NEAR = 1e-9


def pocket_bodies(
    points: Any, faces: ArrayLike | None, pockets: Pockets, rotation: ArrayLike | None = None
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Cut pockets or islands out as closed meshes.

    Parameters
    ----------
    points, faces, rotation
        As they were given to :func:`.pockets.find_pockets` or :func:`.pockets.find_islands`.
    pockets : Pockets
        All that it returned.

    Returns
    -------
    list of (points, faces)
        Of each pocket (k, 3) float64 in the frame of `points` and (l, 3) int32, counter-clockwise seen from outside
        the pocket. Where it ends, it is cut flat,
        a billionth of the model's height before. Its volume is that of the table to about as much.

    Raises
    ------
    NotASolidError, ReebsliceError
        As of :func:`.height_mesh.height_mesh`; or what is cut out has not the volume of the pocket, as it may be
        where bodies touch or the surface crosses itself.

    Notes
    -----
    Needs manifold3d, which the extra `formats` brings.

    Examples
    --------
    >>> import trimesh
    >>> from reebslice import find_pockets
    >>> cup = trimesh.boolean.difference([trimesh.creation.box([3, 3, 3]),
    ...     trimesh.creation.box([1, 1, 2], trimesh.transformations.translation_matrix([0, 0, 1]))])
    >>> [(points, faces)] = pocket_bodies(cup, None, find_pockets(cup))
    >>> print(trimesh.Trimesh(points, faces).volume.round(6))
    1.5
    """
    from manifold3d import Manifold, Mesh64  # not among the packages that the library itself needs

    points, faces = take_mesh(points, faces)
    matrix = take_rotation(rotation)
    tilted, used = tilt_points(points, matrix), find_used(len(points), faces)
    gap, faces = NEAR * np.ptp(tilted[used, 2]), np.searchsorted(used, faces)
    middle = tilted[used].mean(axis=0)  # far from the origin manifold3d tells no two heights apart that are so near
    tilted = tilted - middle
    wholes: dict = {}
    parts: dict = {}
    bodies = []
    ends = pockets.begin_height - middle[2], pockets.end_height - middle[2]
    for row, (kind, low, high) in enumerate(zip(pockets.kind.tolist(), *ends)):
        solid = kind == "island"
        if solid not in wholes:
            corners, triangles = (tilted[used], faces) if solid else box_in(tilted[used], faces)
            wholes[solid] = Manifold(Mesh64(np.ascontiguousarray(corners), np.ascontiguousarray(triangles, np.uint64)))
        if (solid, low < high, high) not in parts:
            up = 1.0 if low < high else -1.0
            plane = high - up * gap if kind != "sealed" else high + gap
            parts[solid, low < high, high] = _find_parts(wholes[solid].trim_by_plane((0.0, 0.0, -up), -up * plane))
        begins = pockets.begin[_meeting_there(pockets, row)]
        spots, corners = _take_bodies(parts[solid, low < high, high], tilted[begins], pockets.volume[row])
        _check_volume(spots, corners, pockets.volume[row], kind, row)
        bodies.append(((spots + middle) @ matrix, corners))
    return bodies


class _Parts(NamedTuple):
    """A closed mesh, the shell of each of its faces, volumes of the shells, and which are around each."""

    points: np.ndarray
    faces: np.ndarray
    shell: np.ndarray
    volumes: np.ndarray
    enclosing: list


def _find_parts(body):
    """Take a manifold apart into its shells."""
    mesh = body.to_mesh64()
    points, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts).astype(np.int32)
    part = connected_items(faces[:, :2].ravel(), faces[:, 1:].ravel(), len(points))
    shell = np.unique(part[faces[:, 0]], return_inverse=True)[1]
    count = int(shell.max(initial=-1)) + 1
    _, volumes = measure_shells(points, faces, shell, count)
    return _Parts(points, faces, shell, volumes, find_enclosing(points, faces, shell, count))


def _meeting_there(pockets, row):
    """The row and those that open into it where it ends itself, at a multiple saddle or in a flat."""
    rows = [row]
    for one in rows:
        into = np.flatnonzero((pockets.into == one) & (pockets.end_height == pockets.end_height[row]))
        rows += into.tolist()
    return rows


def _take_bodies(parts, spots, volume):
    """The components with a corner at one of the `spots` on their outer shell: points and faces.

    Where several bodies touch there, that of the volume nearest to the one given.
    """
    outer, volumes = set(), parts.volumes
    for spot in spots:
        away = np.abs(parts.points[parts.faces] - spot).max(axis=2).min(axis=1)
        away[volumes[parts.shell] < 0] = np.inf
        there = np.unique(parts.shell[away == away.min()])
        outer.add(int(there[np.argmin(np.abs(volumes[there] - volume))]))
    holes = [s for s in np.flatnonzero(volumes < 0).tolist() if _smallest(parts.enclosing[s], volumes) in outer]
    used, corners = np.unique(parts.faces[np.isin(parts.shell, [*outer, *holes])], return_inverse=True)
    return parts.points[used], corners.reshape(-1, 3).astype(np.int32)


def _check_volume(points, faces, volume, kind, row):
    """Raise ReebsliceError if a body has not the volume that its pocket has, but for what is cut off at its rim."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    found, size = float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6), float(np.ptp(points, axis=0).prod())
    if not abs(found - volume) <= 1e-4 * max(size, volume):
        raise ReebsliceError(
            f"{kind} {row} has the volume {volume:g}, but {found:g} was cut out for it: bodies touch there, or the "
            "surface crosses itself."
        )


def _smallest(around, volumes):
    """The smallest of some shells that bounds a volume; -1 for none."""
    return min((s for s in around if volumes[s] > 0), key=lambda s: volumes[s], default=-1)
