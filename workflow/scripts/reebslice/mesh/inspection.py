"""Inspection of a mesh: whether it is the boundary of a solid, and of which.

Faces and corners as a file has them go in; one canonical surface comes out,
with a record of what was found and repaired, or the reason why there is none.
"""

from dataclasses import asdict
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import ArrayLike

from ..errors import UnionError
from ..kernels import njit
from ..table_checks import build_table
from . import unions
from .arguments import take_arrays
from .crossing_places import describe_crossings
from .orders import sort_faces
from .record import REPAIRS, Inspection
from .repairs import clean_surface

OVERLAPS = ("keep", "union")
# What the record says of the file, whatever is united afterwards.
OF_THE_FILE = (
    "status", "tolerance", "bounds", "degenerate_faces_removed", "duplicate_faces_removed", "pinch_vertices_split",
)  # fmt: skip
DEFAULTS = {"repair": REPAIRS, "merge_tolerance": 1e-6, "overlaps": "keep"}


def inspect_surface(
    points: Any, faces: ArrayLike | None = None, options: dict | None = None
) -> tuple[dict[str, pa.Table] | None, dict]:
    """Clean a mesh and tell whether it bounds a solid.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
        Unused and repeated points are fine: faces are joined where the
        positions of their corners are equal, whether they share points or not.
        Or, with `faces` left out, a `trimesh.Trimesh` or a `pyvista.PolyData`.
    faces : (m, 3) int
        Ids of points.
    options : dict, optional
        `repair`: which of `record.REPAIRS` are allowed (default: all);
        `merge_tolerance`: the largest distance, relative to the largest
        extent, over which corners may be merged to close the surface
        (default: 1e-6); `overlaps`: "keep" (default) leaves bodies that overlap
        each as it is, "union" unites them (`unions.unite_bodies`).

    Returns
    -------
    tables : dict of str to pyarrow.Table, or None
        `vertices`, `faces` and `shells`, see `schemas`; None if the mesh is
        rejected. The surface is closed, manifold at mesh edges and vertices,
        and oriented, and does not depend on the order of points, faces or
        corners in the input. Sheets that touch have vertices of their own; sheets that
        cross stay as they are, and the inspection tells where they do.
    inspection : dict
        Fit for JSON, the fields of `record.Inspection`. `status` is "accepted"
        (as it stands), "repaired" (`repairs` says how) or "rejected" (`reason`
        says why).

    Raises
    ------
    NotASolidError
        The arrays have other shapes or types; what they hold is told in the
        inspection instead.
    ValueError
        An option is out of its range.

    Examples
    --------
    >>> points = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]]
    >>> tables, inspection = inspect_surface(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> inspection["status"], inspection["euler_characteristic"], inspection["volume"]
    ('accepted', 2, 36.0)
    >>> inspect_surface(points, [[0, 2, 1]])[1]["closed"]
    False
    """
    options = check_options(options)
    points, faces = take_arrays(points, faces, least=0)
    surface, inspection = clean_surface(np.asarray(points, np.float64), faces, options)
    if surface is None:
        return None, asdict(inspection)
    tables = _tabulate(surface, inspection)
    if options["overlaps"] == "union":
        tables, inspection = _unite(tables, options, inspection)
    if tables is not None:
        inspection.status = "repaired" if inspection.repairs else "accepted"
        _note_crossings(tables, inspection)
    return tables, asdict(inspection)


def check_options(options):
    """Fill in the defaults of `inspect_surface`'s options.

    Parameters
    ----------
    options : dict or None
        Keys that are none of the options are left out.

    Returns
    -------
    dict

    Raises
    ------
    ValueError
        An option is out of its range; the message says what it may be.
    """
    given = {key: value for key, value in (options or {}).items() if key in DEFAULTS}
    options = {**DEFAULTS, **given}
    options["repair"] = tuple(options["repair"] or ())
    unknown = [name for name in options["repair"] if name not in REPAIRS]
    if unknown:
        raise ValueError(f"inspect.repair: {unknown} unknown; choose from {list(REPAIRS)}")
    if not 0 <= options["merge_tolerance"] <= 0.01:
        raise ValueError(
            f"inspect.merge_tolerance: {options['merge_tolerance']} is out of range; give a"
            " fraction of the largest extent between 0 (never merge) and 0.01"
        )
    if options["overlaps"] not in OVERLAPS:
        raise ValueError(f"inspect.overlaps: {options['overlaps']!r} unknown; choose from {list(OVERLAPS)}")
    return options


def blank_record(reason):
    """Make the record of a file that holds no usable mesh.

    Parameters
    ----------
    reason : str

    Returns
    -------
    dict
        As `inspect_surface` returns it.
    """
    return asdict(Inspection(status="rejected", reason=reason))


def _unite(tables, options, inspection):
    """Unite the bodies that overlap, and inspect the result as if it came from a file; returns tables and record."""
    points, faces, body = _surface_of(tables)
    try:
        united = unions.unite_bodies(points, faces.astype(np.int64), body)
    except UnionError as refusal:
        inspection.reject(
            f"The bodies cannot be united: {refusal}; mend the mesh in an editor, or set inspect.overlaps to keep,"
            " which takes each body as it is."
        )
        return None, inspection
    if united is None:
        return tables, inspection
    surface, after = clean_surface(*united, options)
    if surface is None:
        inspection.reject(after.reason)
        return None, inspection
    tables = _tabulate(surface, after)
    told = (
        f"united overlapping bodies: {_count_bodies(inspection)} became {_count_bodies(after)}, their volume"
        f" {inspection.volume:.6g} became {after.volume:.6g}, their vertices {inspection.n_vertices} became"
        f" {after.n_vertices} and their faces {inspection.n_faces} became {after.n_faces}; bodies that meet in mere"
        " mesh edges or vertices stay apart"
    )
    for name in OF_THE_FILE:
        setattr(after, name, getattr(inspection, name))
    after.repairs = [*inspection.repairs, told, *after.repairs]
    return tables, after


def _note_crossings(tables, inspection):
    """Note which faces of the surface cross."""
    for name, figure in describe_crossings(*_surface_of(tables)).items():
        setattr(inspection, name, figure)


def _surface_of(tables):
    """Points, faces and the body of each face, from the tables."""
    points = np.column_stack([tables["vertices"][axis] for axis in "xyz"])
    faces = np.column_stack([tables["faces"][corner] for corner in "abc"])
    return points, faces, tables["shells"]["body"].to_numpy()[tables["faces"]["shell"].to_numpy()]


def _count_bodies(inspection):
    return inspection.components - inspection.voids


def _tabulate(surface, inspection):
    """Return the tables of a surface, and note its figures."""
    points, faces, component, sides = surface
    n_shells, shell_of_vertex = len(sides.areas), _label_vertices(faces, component, len(points))
    n_faces = np.bincount(component, minlength=n_shells)
    n_vertices = np.bincount(shell_of_vertex, minlength=n_shells)
    faces = sort_faces(faces, len(points))
    euler = n_vertices - n_faces // 2  # three mesh edges for every two faces
    columns = {
        "shell": np.arange(n_shells),
        "body": sides.body,
        "parent": [None if one < 0 else int(one) for one in sides.parent],
        "void": sides.volumes < 0,
        "n_vertices": n_vertices,
        "n_faces": n_faces,
        "euler_characteristic": euler,
        "genus": (2 - euler) // 2,
        "area": sides.areas,
        "volume": sides.volumes,
    }
    figures = {
        "n_vertices": len(points),
        "n_faces": len(faces),
        "oriented": True,
        "components": n_shells,
        "genus": int(columns["genus"].sum()),
        "euler_characteristic": int(euler.sum()),
        "voids": int(columns["void"].sum()),
        "area": float(sides.areas.sum()),
        "volume": float(sides.volumes.sum()),
    }
    for name, figure in figures.items():
        setattr(inspection, name, figure)
    return {
        "vertices": build_table("vertices", dict(zip("xyz", points.T))),
        "faces": build_table("faces", dict(zip("abc", faces.T), shell=shell_of_vertex[faces[:, 0]])),
        "shells": build_table("shells", columns),
    }


@njit
def _label_vertices(faces, label, n):
    """The label (m,) of the faces around each of n vertices, (n,) int32."""
    of_vertex = np.empty(n, np.int32)
    for f in range(len(faces)):
        of_vertex[faces[f, 0]] = of_vertex[faces[f, 1]] = of_vertex[faces[f, 2]] = label[f]
    return of_vertex
