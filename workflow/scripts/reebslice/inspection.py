"""Is this mesh the boundary of a solid, and which surface does it describe?

Faces and corners as a file has them go in; one canonical surface comes out,
with a record of what was found and repaired, or the reason why there is none.
"""

import numpy as np

from . import closing, gluing, shells
from .faults import find_fault, tell_place
from .schemas import build_table

REPAIRS = ("merge", "duplicates", "split", "orient")
DEFAULTS = {"repair": REPAIRS, "merge_tolerance": 1e-6}


class Unfit(ValueError):
    """The faces do not bound a solid; the message says why, and the cure."""


def inspect_surface(points, faces, options=None):
    """Clean a mesh and tell whether it bounds a solid.

    Parameters
    ----------
    points : (n, 3) float64, mesh units. Unused and repeated points are fine.
    faces : (m, 3) ids of points.
    options : dict, optional
        `repair`: which of `REPAIRS` are allowed (default: all);
        `merge_tolerance`: the largest distance, relative to the largest
        extent, over which corners may be merged to close the surface.

    Returns
    -------
    tables : dict of the tables `vertices`, `faces`, `shells`; None if rejected.
        The surface is closed, edge- and vertex-manifold and oriented, and does
        not depend on the order of points, faces or corners in the input.
        Whether it meets itself is not looked at.
    inspection : dict fit for JSON. `status` is "accepted" (as it stands),
        "repaired" (`repairs` says how) or "rejected" (`reason` says why).
    """
    options = check_options(options)
    record = blank_record()
    try:
        tables = _clean(np.asarray(points, np.float64), np.asarray(faces), options, record)
    except Unfit as error:
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


def count_collinear(points, faces):
    """Count the faces whose three distinct corners are in line, to rounding.

    They carry no area, but without them the surface would be open.
    """
    a, b, c = (points[faces[:, k]] for k in range(3))
    doubled = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    sides = np.linalg.norm(b - a, axis=1) * np.linalg.norm(c - a, axis=1)
    return int(np.sum(doubled <= 1e-15 * sides))


def _clean(points, faces, options, record):
    if fault := find_fault(points, faces):
        raise Unfit(fault)
    points, merged = closing.merge_exactly(points, faces)
    found = closing.close_surface(points, merged, faces, options["merge_tolerance"])
    _note_closing(points, found, record)
    _check_closed(points, found, options)
    if found.tolerance:
        _allow("merge", options, record, _tell_merge(points, found))
    if found.duplicates:
        dropped = f"dropped {found.duplicates} faces whose corners another face has too"
        _allow("duplicates", options, record, dropped)
    glued = found.glued
    opposite = gluing.pair_half_edges(glued.order, glued.starts)
    component, turned = _wind(points, glued.faces, opposite, record)
    table = _orient(points, glued.faces, component, turned, options, record)
    new_faces, origin = gluing.split_pinches(glued.faces, opposite, len(points))
    new_faces = np.where(table["flip"][:, None], new_faces[:, [0, 2, 1]], new_faces)
    _note_pinches(points, origin, found, options, record)
    return _tabulate(points[origin], new_faces, component, table, record)


def _note_closing(points, found, record):
    record.update(
        n_vertices=len(points),
        n_faces=len(found.glued.faces),
        closed=len(found.glued.faces) > 0 and not len(closing.find_open(found.glued)),
        manifold=not len(closing.find_crowded(found.glued)),
        tolerance=found.tolerance,
        bounds=[points.min(axis=0).tolist(), points.max(axis=0).tolist()],
        degenerate_faces_removed=found.degenerate + found.collapsed,
        duplicate_faces_removed=found.duplicates,
        collinear_faces=count_collinear(points, found.glued.faces),
    )
    if found.degenerate:
        record["repairs"].append(f"dropped {found.degenerate} faces with two equal corners")
    if found.own_numbering:
        record["repairs"].append(
            "kept apart parts that touch along mesh edges, as the file numbers its vertices"
        )


def _check_closed(points, found, options):
    """Raise `Unfit` naming the open or crowded mesh edges of the exact gluing."""
    if closing.is_closed(found.glued):
        return
    if not len(found.exact.faces):
        raise Unfit(
            f"All {found.degenerate} faces have two equal corners: nothing remains of the"
            " surface; export the mesh with more digits."
        )
    faults = []
    edges_open = closing.find_open(found.exact)
    if len(edges_open):
        faults.append(
            f"the surface is open: {len(edges_open)} mesh edges have only one face, the first"
            f" {_span(points, found.exact, edges_open)}"
        )
    crowded = closing.find_crowded(found.exact)
    if len(crowded):
        faults.append(
            f"the surface is not a manifold: {len(crowded)} mesh edges have three or more faces,"
            f" the first {_span(points, found.exact, crowded)}"
        )
    exact = found.exact.faces
    doubled = len(exact) - len(closing.drop_duplicates(exact))
    if doubled:
        faults.append(f"faces that occur more than once: {doubled}")
    cure = "fill the holes" if len(edges_open) else "separate the parts or unite their volumes"
    tolerance = options["merge_tolerance"]
    also = f", or, if its parts only just fail to meet, raise inspect.merge_tolerance ({tolerance:g})"
    told = "; ".join(faults)
    told = f"{told[0].upper()}{told[1:]}; {cure} in a mesh editor"
    raise Unfit(f"{told}{also if len(edges_open) else ''}.")


def _wind(points, faces, opposite, record):
    component, turned, conflict = gluing.label_components(faces, opposite)
    record["oriented"] = conflict < 0 and not turned.any()
    if conflict >= 0:
        place = tell_place(points[faces.ravel()[conflict]])
        raise Unfit(
            "The surface is one-sided (like a Klein bottle): at least 1 part cannot be wound"
            f" consistently, the first conflict is at {place}; a solid has no such boundary,"
            " rebuild that part."
        )
    return component, turned


def _orient(points, faces, component, turned, options, record):
    """Find the sides of all shells; returns their table and the faces to turn over."""
    n_shells = component.max() + 1
    wound = np.where(turned[:, None], faces[:, [0, 2, 1]], faces)
    areas, volumes = shells.measure_shells(points, wound, component, n_shells)
    flat = np.flatnonzero(volumes == 0)
    if len(flat):
        first = points[faces[np.argmax(component == flat[0]), 0]]
        raise Unfit(
            f"{len(flat)} of {n_shells} closed parts enclose no volume, the first is at"
            f" {tell_place(first)}; delete such flat parts in a mesh editor."
        )
    free = np.bincount(component, turned, n_shells) > 0
    enclosing = shells.find_enclosing(points, faces, component, n_shells)
    before = np.sign(volumes).astype(np.int64)
    signs, body, parent = shells.nest_shells(enclosing, before, np.abs(volumes), free)
    flip = turned ^ (signs != before)[component]
    inward = (signs != before) & ~free
    if free.any():
        told = f"made the winding of {free.sum()} of {n_shells} shells consistent"
        _allow("orient", options, record, f"{told} ({_count_minor(flip, component, free)} faces)")
    if inward.any():
        told = f"turned over {inward.sum()} of {n_shells} shells that faced inward"
        _allow("orient", options, record, told)
    return dict(flip=flip, areas=areas, volumes=signs * np.abs(volumes), body=body, parent=parent)


def _count_minor(flip, component, free):
    turned = np.bincount(component, flip, len(free))
    return int(np.minimum(turned, np.bincount(component) - turned)[free].sum())


def _note_pinches(points, origin, found, options, record):
    copies = np.bincount(origin)
    pinched = np.flatnonzero(copies > 1)
    record["pinch_vertices_split"] = len(pinched)
    if len(pinched) and not found.own_numbering:
        told = (
            f"split {len(pinched)} pinch vertices, where sheets touch in a point, into"
            f" {copies[pinched].sum()}, the first at {tell_place(points[pinched[0]])}"
        )
        _allow("split", options, record, told)


def _tabulate(points, faces, component, table, record):
    order = gluing.order_rows(faces, len(points))
    faces, component = faces[order], component[order]
    n_shells = len(table["areas"])
    shell_of_vertex = np.empty(len(points), np.int64)
    shell_of_vertex[faces.ravel()] = np.repeat(component, 3)
    n_faces = np.bincount(component, minlength=n_shells)
    n_vertices = np.bincount(shell_of_vertex, minlength=n_shells)
    euler = n_vertices - n_faces // 2  # three mesh edges for every two faces
    columns = dict(
        shell=np.arange(n_shells),
        body=table["body"],
        parent=[None if one < 0 else int(one) for one in table["parent"]],
        void=table["volumes"] < 0,
        n_vertices=n_vertices,
        n_faces=n_faces,
        euler_characteristic=euler,
        genus=(2 - euler) // 2,
        area=table["areas"],
        volume=table["volumes"],
    )
    record.update(
        n_vertices=len(points),
        n_faces=len(faces),
        oriented=True,
        components=n_shells,
        genus=int(columns["genus"].sum()),
        euler_characteristic=int(euler.sum()),
        voids=int(columns["void"].sum()),
        area=float(table["areas"].sum()),
        volume=float(table["volumes"].sum()),
    )
    return {
        "vertices": build_table("vertices", dict(zip("xyz", points.T))),
        "faces": build_table("faces", dict(zip("abc", faces.T), shell=component)),
        "shells": build_table("shells", columns),
    }


def _allow(repair, options, record, told):
    if repair not in options["repair"]:
        raise Unfit(
            f"It would take a repair that the configuration does not allow ({told});"
            f" add {repair} to inspect.repair, or mend the mesh in an editor."
        )
    record["repairs"].append(told)


def _tell_merge(points, found):
    extent = np.ptp(points, axis=0).max()
    told = (
        f"merged {found.moved} corners within {found.tolerance:g} of the largest extent"
        f" ({found.tolerance * extent:.3g}) to close {len(closing.find_open(found.exact))} open mesh edges"
    )
    return told + (f", by which {found.collapsed} sliver faces vanished" if found.collapsed else "")


def _span(points, glued, edges):
    ends = closing.list_ends(glued, edges)
    first = ends[np.lexsort(ends.T[::-1])[0]]
    return f"from {tell_place(points[first[0]])} to {tell_place(points[first[1]])}"
