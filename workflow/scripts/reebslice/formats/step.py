"""Read STEP (ISO 10303-21) through OpenCascade, in millimetres, with the rounding of its output held in bounds.

The reader is cascadio, a small build of OpenCascade, which computes in float64
and hands its triangles on in float32: a vertex is rounded to 6e-8 of its
distance from the origin of its part, so a 10 mm cube a kilometre off has a
volume of 1002. Where rounding could matter, the file is tessellated again with
all its points moved, so that the body lies about the origin of its part, and
is moved back in float64.

All points of three coordinates are moved by one vector, so each part's shape
moves by that vector in the part's own frame; the places of parts are those of
the first pass. Whether a file keeps to that is not taken for granted (it may
scale shapes, or mix units): the boxes that the reader states in float64 have to
have moved by the vector, and each vertex within its rounding.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..errors import MeshFormatError
from .mesh_file import MeshFile
from .step_tessellation import tessellate

# Bounds on the change of a body's volume by rounding, relative to the volume: what is told, and what is refused.
FINE, LARGEST = 1e-4, 1e-2
MOST_PASSES = 8  # over bodies that lie far apart from one another
HALF_STEP = 2.0**-24  # half the distance between neighbours in float32, relative


class Bodies(NamedTuple):
    """Connected bodies of a tessellation."""

    of_point: np.ndarray  # (n,) body of each point
    centre: np.ndarray  # (b, 3) of each body's box, in the frame of its part
    rounding: np.ndarray  # (b,) bound on the change of its volume by rounding, relative to it
    shift: np.ndarray  # (b,) bound on the change of its place by rounding, relative to its length


def read_step(path):
    """Return the faces of a STEP file as triangles, in millimetres.

    Curved faces are approximated to `opencascade.TOLERANCES`, relative to
    the length of their edges, so that the size and the unit of the model do not
    matter.

    Parameters
    ----------
    path : path of the file

    Returns
    -------
    MeshFile
        `unit` is 'millimetre', whatever the unit of the file. Neighbouring
        faces have points of their own, in the same places. Where rounding may
        change a body's volume, or its place, by more than `FINE` of the volume
        or of its length, `notes` says so.

    Raises
    ------
    MeshFormatError
        OpenCascade cannot read the file or finds no faces in it; or rounding
        may change the volume of a body by more than `LARGEST` of it.
    """
    data = Path(path).read_bytes()
    mesh = tessellate(data)
    bodies = find_bodies(mesh)
    points, faces = mesh.world(), mesh.faces
    if bodies.rounding.max() > FINE:
        points, faces, bodies = _tessellate_closer(data, mesh, bodies)
    notes = describe_rounding(points, bodies)
    if bodies.rounding.max() > LARGEST:
        raise MeshFormatError(
            f"{notes[0]} Move the model to the origin in the program that made it, and export it again."
        )
    return MeshFile(points, faces, "millimetre", notes)


def describe_rounding(points, bodies):
    """Return sentences on the bodies whose volume and whose place are rounded most, if that is beyond `FINE`.

    Parameters
    ----------
    points : (n, 3) float64, in place
    bodies : Bodies

    Returns
    -------
    tuple of str
    """
    notes = []
    for bound, what in (bodies.rounding, "volume by {:.1g} of it"), (bodies.shift, "place by {:.1g} of its length"):
        worst = int(np.argmax(bound))
        if bound[worst] > FINE:
            place = ", ".join(f"{x:.15g}" for x in points[bodies.of_point == worst].mean(axis=0))
            told = what.format(bound[worst])
            notes.append(f"The STEP reader rounds to float32, which may change the body about ({place}): its {told}.")
    return tuple(notes)


def find_bodies(mesh):
    """Return the bodies of a tessellation, joined by faces and by points in one place.

    Parameters
    ----------
    mesh : step_tessellation.Tessellation

    Returns
    -------
    Bodies
    """
    places = np.column_stack([mesh.part, mesh.points])
    point = np.unique(places, axis=0, return_inverse=True)[1].reshape(-1)
    joins = np.concatenate([mesh.faces[:, :2], mesh.faces[:, 1:]])
    graph = coo_array((np.ones(len(joins), bool), point[joins].T), shape=(point.max() + 1,) * 2)
    return measure_bodies(mesh, connected_components(graph, directed=False)[1][point])


def measure_bodies(mesh, of_point):
    """Return bodies with bounds on their rounding.

    The volume of a body changes, to first order, by at most the sum over the
    three axes of the largest change of a coordinate times the area that faces
    along that axis. That is held against the body's volume, or, for a sheet or
    a body thinner than 1e-4 of its length, against a volume of that thickness;
    and the change of a coordinate is held against the body's length.

    Parameters
    ----------
    mesh : step_tessellation.Tessellation
    of_point : (n,) int
        The body of each point; every body has points.

    Returns
    -------
    Bodies
    """
    order, count = np.argsort(of_point, kind="stable"), of_point.max() + 1
    starts = np.searchsorted(of_point[order], np.arange(count))
    low, high = (extreme.reduceat(mesh.points[order], starts) for extreme in (np.minimum, np.maximum))
    centre, length, reach = (low + high) / 2, (high - low).max(axis=1), np.maximum(-low, high)
    of_face = of_point[mesh.faces[:, 0]]
    a, b, c = ((mesh.points - centre[of_point])[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a) / 2
    areas = np.column_stack([np.bincount(of_face, np.abs(normals[:, axis]), count) for axis in range(3)])
    volume = np.abs(np.bincount(of_face, np.einsum("ij,ij->i", a, normals) / 3, count))
    volume = np.maximum(volume, 1e-4 * length * areas.sum(axis=1) / 2)
    change = HALF_STEP * (reach * areas).sum(axis=1)
    matrices = np.abs(mesh.matrices[mesh.part[order[starts]], :3])
    matrices[np.isin(matrices, (0, 1))] = 0  # exact in float32
    shift = HALF_STEP * (np.einsum("bij,bj->bi", matrices[:, :, :3], reach) + matrices[:, :, 3]).max(axis=1)
    volume, length = (np.maximum(size, np.finfo(float).tiny) for size in (volume, length))
    # A body that rounding has shrunk to a line or a point has no area that could tell.
    rounding = np.maximum(change / volume, HALF_STEP * reach.max(axis=1) / length)
    return Bodies(of_point, centre, rounding, shift / length)


def _tessellate_closer(data, base, bodies):
    """Points in place, faces and bodies, each body as the pass has it in which it is rounded least."""
    rounding, source = bodies.rounding.copy(), np.zeros(len(bodies.rounding), np.int64)
    passes, factor, tried = [(base.points, base.faces)], 1.0, np.zeros(len(source), bool)
    while len(passes) < MOST_PASSES and (waiting := (rounding > FINE) & ~tried).any():
        body = np.flatnonzero(waiting)[0]
        tried[body] = True
        vector = -np.round(bodies.centre[body])
        moved = tessellate(move_points(data, vector / factor))
        if len(passes) == 1:  # how far the points moved tells the unit that they are in
            factor = _find_factor(base, moved, vector)
            moved = moved if factor == 1 else tessellate(move_points(data, vector / factor))
        if not _has_moved(base, moved, vector):
            break
        found = measure_bodies(moved, bodies.of_point).rounding
        closer = found < rounding
        source[closer], rounding[closer] = len(passes), found[closer]
        passes.append((moved.points - vector, moved.faces))
    chosen = source[bodies.of_point]
    points = np.choose(chosen[:, None], [points for points, _ in passes])
    faces = np.concatenate([faces[chosen[faces[:, 0]] == number] for number, (_, faces) in enumerate(passes)])
    return base._replace(points=points).world(), faces, bodies._replace(rounding=rounding)


_REAL = rb"\s*[-+]?\d+\.\d*(?:[Ee][-+]?\d+)?\s*"
_POINT = re.compile(rb"(\bCARTESIAN_POINT\s*\(\s*(?:'(?:[^']++|'')*+'\s*,\s*)?\()(%s),(%s),(%s)(\))" % ((_REAL,) * 3))


def move_points(data, vector):
    """Return a STEP file with a vector added to each of its points of three coordinates.

    Parameters
    ----------
    data : bytes
    vector : (3,) float
        In the unit of the file.

    Returns
    -------
    bytes

    Examples
    --------
    >>> move_points(b"#1=CARTESIAN_POINT('',(1.5,2.E1,0.));", (1, 0, 0)).decode()
    "#1=CARTESIAN_POINT('',(2.5000000000000000E+00,2.0000000000000000E+01,0.0000000000000000E+00));"
    """

    def move(found):
        numbers = (b"%.16E" % (float(found[k + 2]) + vector[k]) for k in range(3))
        return found[1] + b",".join(numbers) + found[5]

    return _POINT.sub(move, data)


def _find_factor(base, moved, vector):
    """How many millimetres the model moved for each unit of a vector; 1 if that cannot be told."""
    axis = int(np.argmax(np.abs(vector)))
    factor = (moved.low - base.low)[0, axis] / vector[axis]
    return 1.0 if abs(factor - 1) < 1e-9 or not 1e-9 < factor < 1e9 else factor


def _has_moved(base, moved, vector):
    """Whether a tessellation is another one, moved by a vector: boxes in float64, points within their rounding."""
    if len(base.points) != len(moved.points) or not np.array_equal(base.part, moved.part):
        return False
    boxes, there = np.stack([base.low, base.high]), np.stack([moved.low, moved.high])
    rounding = 1e-12 * (np.abs(boxes).max() + np.abs(vector).max())
    step = 4 * HALF_STEP * (np.abs(base.points) + np.abs(moved.points)).max(axis=1, keepdims=True)
    return bool((np.abs(boxes + vector - there) <= rounding).all()) and bool(
        (np.abs(base.points + vector - moved.points) <= step).all()
    )
