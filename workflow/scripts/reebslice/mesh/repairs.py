"""The repairs that make a closed surface of the faces of a file, each allowed and noted, or the reason against."""

from typing import NamedTuple

import numpy as np

from ..errors import NotASolidError
from . import closing, half_edges, measures, merging, sheets, shells, touching
from .faults import find_fault, format_point

REPAIRS = ("merge", "duplicates", "split", "orient")


def clean_surface(points, faces, options, record):
    """Return the closed, manifold and oriented surface that the faces describe.

    points (n, 3) float64, mesh units; faces (m, 3); options complete, see
    `inspection.inspect_surface`; record: what is found goes into it.

    Returns points (n', 3), in lexicographic order; faces (m', 3); the shell
    (m',) of each; and the sides of the shells, see `shells.orient_shells`.
    Raises `NotASolidError` if there is no such surface within the repairs allowed.
    """
    if fault := find_fault(points, faces):
        raise NotASolidError(fault)
    points, merged = merging.merge_exactly(points, faces)
    found = closing.close_surface(points, merged, faces, options["merge_tolerance"])
    _note_closing(points, found, record)
    _check_closed(points, found, options)
    if found.tolerance:
        _allow("merge", options, record, _describe_merge(points, found))
    if found.duplicates:
        dropped = f"dropped {found.duplicates} faces whose corners another face has too"
        _allow("duplicates", options, record, dropped)
    if found.flaps:
        dropped = f"dropped {found.flaps} flaps, that is pairs of coinciding faces that enclose nothing"
        _allow("duplicates", options, record, dropped)
    if found.apart:
        _allow("split", options, record, _describe_apart(points, found))
    if found.apart:
        found = _face_outward(points, found, options, record)
    found, walk, sizes = _drop_flat(points, found, options, record)
    faces, (opposite, component, turned, _) = found.glued.faces, walk
    _check_wound(points, faces, walk, record)
    sides = shells.orient_shells(points, faces, component, turned, *sizes)
    _note_sides(points, faces, component, sides, options, record)
    if found.apart:
        _check_apart(points, faces, sides["flip"])
    faces, origin = sheets.split_pinches(faces, opposite, component, len(points))
    _note_pinches(points, origin, found, options, record)
    points, flip = points[origin], sides["flip"]
    if found.apart or found.own_numbering:  # else two vertices have one mesh edge at most
        points, faces, old = sheets.split_double_edges(points, faces, opposite)
        component, flip = component[old], flip[old]
    return points, measures.orient_faces(faces, flip), component, sides


class Walk(NamedTuple):
    """What a walk over the faces of a closed surface finds, see `sheets.label_components`."""

    opposite: np.ndarray  # (3m,) the other half-edge of each mesh edge
    component: np.ndarray  # (m,)
    turned: np.ndarray  # (m,) bool
    conflict: int


def _walk(glued):
    return Walk(glued.opposite, *sheets.label_components(glued.faces, glued.opposite))


def _measure(points, faces, walk):
    """Area and volume of every shell, see `measures.measure_shells`."""
    n_shells = walk.component.max() + 1
    return measures.measure_shells(points, measures.orient_faces(faces, walk.turned), walk.component, n_shells)


def _note_closing(points, found, record):
    record.update(
        n_vertices=len(points),
        n_faces=len(found.glued.faces),
        closed=len(found.glued.faces) > 0 and not len(closing.find_open(found.glued)),
        manifold=not len(closing.find_crowded(found.glued)),
        tolerance=found.tolerance,
        bounds=[[float(end(axis)) for axis in points.T] for end in (np.min, np.max)],
        degenerate_faces_removed=found.degenerate + found.collapsed,
        duplicate_faces_removed=found.duplicates + 2 * found.flaps,
        collinear_faces=measures.count_collinear(points, found.glued.faces),
    )
    if found.degenerate:
        record["repairs"].append(f"dropped {found.degenerate} faces with two equal corners")
    if found.own_numbering:
        record["repairs"].append("kept apart parts that touch along mesh edges, as the file numbers its vertices")


def _check_closed(points, found, options):
    """Raise `NotASolidError` naming the open or crowded mesh edges of the exact gluing."""
    if closing.is_closed(found.glued):
        return
    if not len(found.exact.faces):
        raise NotASolidError(
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
    if found.entangled:
        faults.append(f"they cannot be taken apart: {found.entangled}")
    exact = found.exact.faces
    doubled = len(exact) - len(closing.drop_duplicates(exact))
    if doubled:
        faults.append(f"faces that occur more than once: {doubled}")
    cure = "fill the holes" if len(edges_open) else "separate the parts or unite their volumes"
    tolerance = options["merge_tolerance"]
    also = f", or, if its parts only just fail to meet, raise inspect.merge_tolerance ({tolerance:g})"
    told = "; ".join(faults)
    told = f"{told[0].upper()}{told[1:]}; {cure} in a mesh editor"
    raise NotASolidError(f"{told}{also if len(edges_open) else ''}.")


def _check_wound(points, faces, walk, record):
    """Raise `NotASolidError` if a part is one-sided."""
    record["oriented"] = walk.conflict < 0 and not walk.turned.any()
    if walk.conflict >= 0:
        place = format_point(points[faces.ravel()[walk.conflict]])
        raise NotASolidError(
            "The surface is one-sided (like a Klein bottle): at least 1 part cannot be wound"
            f" consistently, the first conflict is at {place}; a solid has no such boundary,"
            " rebuild that part."
        )


def _face_outward(points, found, options, record):
    """Turn over parts that face inward and take apart once more: it depends on where the material is."""
    walk = _walk(found.glued)
    sizes = _measure(points, found.glued.faces, walk)
    flip = shells.orient_shells(points, found.glued.faces, walk.component, walk.turned, *sizes)["flip"]
    if not _find_crowded_corners(found.glued.faces, len(points), flip).size:
        return found
    faces = np.where(flip[:, None], found.glued.faces[:, ::-1], found.glued.faces)
    start = found._replace(glued=closing.glue(faces, len(points)), apart=0)
    again = closing.separate_sheets(points, start, options["merge_tolerance"] * np.ptp(points, axis=0).max())
    _check_closed(points, again, options)
    _allow("orient", options, record, f"turned over {flip.sum()} faces of touching parts that faced inward")
    return again


def _drop_flat(points, found, options, record):
    """Drop the closed parts that lie in a plane, unless nothing else is there; returns walk and sizes of the rest."""
    faces, walk = found.glued.faces, _walk(found.glued)
    component = walk.component
    areas, volumes = _measure(points, faces, walk)
    empty = np.flatnonzero(volumes == 0)
    flat = [one for one in empty if touching.lie_in_plane(points[np.unique(faces[component == one])])]
    if not 0 < len(flat) < len(volumes):
        return found, walk, (areas, volumes)
    told = f"dropped {len(flat)} closed parts that lie in a plane and enclose nothing"
    _allow("duplicates", options, record, told)
    glued, kept = closing.keep_faces(found.glued, ~np.isin(component, flat)), np.delete(np.arange(len(volumes)), flat)
    return found._replace(glued=glued), _walk(glued), (areas[kept], volumes[kept])


def _find_crowded_corners(faces, n_vertices, chosen):
    """Return the corners of the `chosen` (m,) bool faces from which crowded mesh edges go out."""
    order, starts = half_edges.group_half_edges(faces, n_vertices)
    crowded = order[np.repeat(np.diff(starts) > 2, np.diff(starts))]
    return crowded[chosen[crowded // 3]]


def _check_apart(points, faces, flip):
    """Raise `NotASolidError` if parts were taken apart by a winding that turned out to be wrong."""
    wrong = _find_crowded_corners(faces, len(points), flip)
    if len(wrong):
        raise NotASolidError(
            "Parts that touch along mesh edges face inward, so that it is not sure how they come apart, the"
            f" first at {format_point(points[faces.ravel()[wrong[0]]])}; turn them over in a mesh editor."
        )


def _note_sides(points, faces, component, sides, options, record):
    n_shells = len(sides["areas"])
    flat = np.flatnonzero(sides["volumes"] == 0)
    if len(flat):
        first = points[faces[np.argmax(component == flat[0]), 0]]
        raise NotASolidError(
            f"{len(flat)} of {n_shells} closed parts enclose no volume, the first is at"
            f" {format_point(first)}; delete such flat parts in a mesh editor."
        )
    free, inward = sides["free"], sides["inward"]
    if free.any():
        told = f"made the winding of {free.sum()} of {n_shells} shells consistent"
        _allow("orient", options, record, f"{told} ({_count_minor(sides['flip'], component, free)} faces)")
    if inward.any():
        told = f"turned over {inward.sum()} of {n_shells} shells that faced inward"
        _allow("orient", options, record, told)


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
            f" {copies[pinched].sum()}, the first at {format_point(points[pinched[0]])}"
        )
        _allow("split", options, record, told)


def _allow(repair, options, record, told):
    if repair not in options["repair"]:
        raise NotASolidError(
            f"It would take a repair that the configuration does not allow ({told});"
            f" add {repair} to inspect.repair, or mend the mesh in an editor."
        )
    record["repairs"].append(told)


def _describe_merge(points, found):
    extent = np.ptp(points, axis=0).max()
    told = (
        f"merged {found.moved} corners within {found.tolerance:g} of the largest extent"
        f" ({found.tolerance * extent:.3g}) to close {len(closing.find_open(found.exact))} open mesh edges"
    )
    return told + (f", by which {found.collapsed} sliver faces vanished" if found.collapsed else "")


def _describe_apart(points, found):
    crowded = closing.find_crowded(found.exact)
    where = f", the first {_span(points, found.exact, crowded)}" if len(crowded) else ""
    loose = f"; at {found.loose} of them faces coincide within the merge tolerance only" if found.loose else ""
    return f"took apart {found.apart} mesh edges around which bodies touch{where}{loose}"


def _span(points, glued, edges):
    ends = closing.list_ends(glued, edges)
    first = ends[np.lexsort(ends.T[::-1])[0]]
    return f"from {format_point(points[first[0]])} to {format_point(points[first[1]])}"
