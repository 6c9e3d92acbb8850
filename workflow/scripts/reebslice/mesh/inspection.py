"""Is this mesh the boundary of a solid, and which surface does it describe?

Faces and corners as a file has them go in; one canonical surface comes out,
with a record of what was found and repaired, or the reason why there is none.
"""

import numpy as np
from numba import njit

from ..errors import NotASolidError, UnionError
from ..table_checks import build_table
from . import unions
from .orders import sort_faces
from .repairs import REPAIRS, clean_surface

OVERLAPS = ("keep", "union")
# What the record says of the file, whatever is united afterwards.
OF_THE_FILE = (
    "status", "tolerance", "bounds", "degenerate_faces_removed", "duplicate_faces_removed", "pinch_vertices_split",
)  # fmt: skip
DEFAULTS = {"repair": REPAIRS, "merge_tolerance": 1e-6, "overlaps": "keep"}


def inspect_surface(points, faces, options=None):
    """Clean a mesh and tell whether it bounds a solid.

    Parameters
    ----------
    points : (n, 3) float64, mesh units. Unused and repeated points are fine.
    faces : (m, 3) ids of points.
    options : dict, optional
        `repair`: which of `REPAIRS` are allowed (default: all);
        `merge_tolerance`: the largest distance, relative to the largest
        extent, over which corners may be merged to close the surface;
        `overlaps`: "keep" leaves bodies that overlap each as it is, "union"
        unites them (`unions.unite_bodies`).

    Returns
    -------
    tables : dict of the tables `vertices`, `faces`, `shells`; None if rejected.
        The surface is closed, edge- and vertex-manifold and oriented, and does
        not depend on the order of points, faces or corners in the input.
        Sheets that touch are told apart; whether they cross is not looked at.
    inspection : dict fit for JSON. `status` is "accepted" (as it stands),
        "repaired" (`repairs` says how) or "rejected" (`reason` says why).
    """
    options = check_options(options)
    record = blank_record()
    try:
        surface = clean_surface(np.asarray(points, np.float64), np.asarray(faces), options, record)
        tables = _tabulate(*surface, record)
        if options["overlaps"] == "union":
            tables = _unite(tables, options, record)
    except NotASolidError as error:
        record.update(status="rejected", reason=str(error))
        return None, record
    record["status"] = "repaired" if record["repairs"] else "accepted"
    return tables, record


def check_options(options):
    """Return the options with defaults filled in, or raise ValueError with the cure."""
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


def blank_record(reason=None):
    """Return an inspection in which nothing is known yet but, with `reason`, that it failed."""
    record = dict.fromkeys(
        "status reason repairs n_vertices n_faces closed manifold oriented components genus"
        " euler_characteristic voids tolerance area volume bounds collinear_faces"
        " degenerate_faces_removed duplicate_faces_removed pinch_vertices_split".split()
    )
    record.update(repairs=[], status="rejected" if reason else None, reason=reason)
    return record


def _unite(tables, options, record):
    """Unite the bodies that overlap, and inspect the result as if it came from a file."""
    points = np.column_stack([tables["vertices"][axis] for axis in "xyz"])
    faces = np.column_stack([tables["faces"][corner] for corner in "abc"]).astype(np.int64)
    body = tables["shells"]["body"].to_numpy()[tables["faces"]["shell"].to_numpy()]
    try:
        united = unions.unite_bodies(points, faces, body)
    except UnionError as refusal:
        raise NotASolidError(
            f"The bodies cannot be united: {refusal}; mend the mesh in an editor, or set inspect.overlaps to keep,"
            " which takes each body as it is."
        )
    if united is None:
        return tables
    after = blank_record()
    tables = _tabulate(*clean_surface(*united, options, after), after)
    told = (
        f"united overlapping bodies: {_count_bodies(record)} became {_count_bodies(after)},"
        f" their volume {record['volume']:.6g} became {after['volume']:.6g}"
    )
    repairs = [*record["repairs"], told, *after["repairs"]]
    record.update({key: value for key, value in after.items() if key not in OF_THE_FILE}, repairs=repairs)
    return tables


def _count_bodies(record):
    return record["components"] - record["voids"]


def _tabulate(points, faces, component, sides, record):
    n_shells, shell_of_vertex = len(sides["areas"]), _label_vertices(faces, component, len(points))
    n_faces = np.bincount(component, minlength=n_shells)
    n_vertices = np.bincount(shell_of_vertex, minlength=n_shells)
    faces = sort_faces(faces, len(points))
    euler = n_vertices - n_faces // 2  # three mesh edges for every two faces
    columns = dict(
        shell=np.arange(n_shells),
        body=sides["body"],
        parent=[None if one < 0 else int(one) for one in sides["parent"]],
        void=sides["volumes"] < 0,
        n_vertices=n_vertices,
        n_faces=n_faces,
        euler_characteristic=euler,
        genus=(2 - euler) // 2,
        area=sides["areas"],
        volume=sides["volumes"],
    )
    record.update(
        n_vertices=len(points),
        n_faces=len(faces),
        oriented=True,
        components=n_shells,
        genus=int(columns["genus"].sum()),
        euler_characteristic=int(euler.sum()),
        voids=int(columns["void"].sum()),
        area=float(sides["areas"].sum()),
        volume=float(sides["volumes"].sum()),
    )
    return {
        "vertices": build_table("vertices", dict(zip("xyz", points.T))),
        "faces": build_table("faces", dict(zip("abc", faces.T), shell=shell_of_vertex[faces[:, 0]])),
        "shells": build_table("shells", columns),
    }


@njit(cache=True)
def _label_vertices(faces, label, n):
    """The label (m,) of the faces around each of n vertices, (n,) int32."""
    of_vertex = np.empty(n, np.int32)
    for f in range(len(faces)):
        of_vertex[faces[f, 0]] = of_vertex[faces[f, 1]] = of_vertex[faces[f, 2]] = label[f]
    return of_vertex
