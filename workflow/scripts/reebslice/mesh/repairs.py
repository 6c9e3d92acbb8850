"""The repairs that make a closed surface of the faces of a file, each allowed and noted, or the reason against."""

from typing import NamedTuple

import numpy as np

from ..errors import NotASolidError
from . import closing, copies, half_edges, measures, merging, reasons, sheets, shells, touching
from .faults import find_fault, format_point
from .record import Inspection


class CleanSurface(NamedTuple):
    """A closed and oriented surface, manifold at mesh edges and vertices.

    Attributes
    ----------
    points : (n, 3) float64, mesh units
        In lexicographic order; equal where sheets touch.
    faces : (m, 3) int32
        Counter-clockwise seen from outside the material.
    component : (m,) int32
        The shell of each face.
    shells : shells.Shells
    """

    points: np.ndarray
    faces: np.ndarray
    component: np.ndarray
    shells: shells.Shells


class Walk(NamedTuple):
    """A closed surface, walked over from face to face.

    Attributes
    ----------
    opposite : (3 m,) int32
        The other half-edge of each mesh edge.
    component, turned, conflict
        Of `sheets.label_components`.
    """

    opposite: np.ndarray
    component: np.ndarray
    turned: np.ndarray
    conflict: int


def clean_surface(points, faces, options):
    """Find the closed, manifold and oriented surface that the faces describe.

    Parameters
    ----------
    points, faces : (p, 3) float64, mesh units, and (q, 3) int
    options : dict
        Complete, see `inspection.inspect_surface`.

    Returns
    -------
    surface : CleanSurface or None
        None if there is no such surface within the repairs allowed.
    inspection : record.Inspection
        What was found and repaired on the way, with the reason if there is no surface.
    """
    if fault := find_fault(points, faces):
        return None, Inspection(status="rejected", reason=fault)
    points, merged = merging.merge_exactly(points, faces)
    refused = None
    for found in closing.list_closings(points, merged, faces, options["merge_tolerance"]):
        inspection = _describe_closing(points, found)
        try:
            return _finish(points, found, options, inspection), inspection
        except NotASolidError as reason:
            inspection.reject(reason)
            refused = refused or inspection
    return None, refused


def _finish(points, found, options, inspection):
    """Orient a closing and give each sheet vertices of its own; raises `NotASolidError` if it is no solid's."""
    allowed = options["repair"]
    reasons.check_closed(points, found, options["merge_tolerance"])
    found = _drop_backs(points, found)
    seams = _find_seams(points, found)
    inspection.duplicate_faces_removed = len(found.repeats) + 2 * found.flaps + len(found.backs)
    for repair, told in reasons.list_repairs(points, found, seams):
        inspection.note_repair(repair, told, allowed)
    if found.own_numbering:
        inspection.repairs.append(reasons.describe_numbering(points, seams))
    elif seams is not None:
        found = _face_outward(points, found, options, inspection)
    found, walk, sizes = _drop_flat(points, found, allowed, inspection)
    faces = found.glued.faces
    inspection.oriented = walk.conflict < 0 and not walk.turned.any()
    reasons.check_two_sided(points, faces, walk.conflict)
    reasons.check_volumes(points, faces, walk.component, sizes[1])
    sides = shells.orient_shells(points, faces, walk.component, walk.turned, *sizes)
    _note_turns(sides, walk.component, allowed, inspection)
    if seams is not None and not found.own_numbering:
        _check_apart(points, faces, sides.flip)
    return _separate_vertices(points, found, walk, sides, allowed, inspection)


def _walk(glued):
    return Walk(glued.opposite, *sheets.label_components(glued.faces, glued.opposite))


def _measure(points, faces, walk):
    """Area and volume of every shell, see `measures.measure_shells`."""
    n_shells = walk.component.max() + 1
    return measures.measure_shells(points, measures.orient_faces(faces, walk.turned), walk.component, n_shells)


def _describe_closing(points, found):
    inspection = Inspection(
        n_vertices=len(points),
        n_faces=len(found.glued.faces),
        closed=len(found.glued.faces) > 0 and not len(closing.find_open(found.glued)),
        manifold=not len(closing.find_crowded(found.glued)),
        tolerance=found.tolerance,
        bounds=[[float(end(axis)) for axis in points.T] for end in (np.min, np.max)],
        degenerate_faces_removed=found.degenerate + found.collapsed,
        duplicate_faces_removed=len(found.repeats) + 2 * found.flaps,
        collinear_faces=measures.count_collinear(points, found.glued.faces),
    )
    if found.degenerate:
        inspection.repairs.append(f"dropped {found.degenerate} faces with two equal corners")
    return inspection


def _drop_backs(points, found):
    """Drop the components that are the backs or the copies of others, see `copies.find_backs`."""
    if not found.apart and not found.own_numbering:
        return found
    faces, walk = found.glued.faces, _walk(found.glued)
    n_shells = walk.component.max() + 1
    covered, again, mirrored = copies.find_covered(faces, walk.component, n_shells)
    if not covered.any() or walk.conflict >= 0:
        return found
    if found.own_numbering:  # bodies that overlap may hide each other's faces without being the back of anything
        covered = mirrored | again
    signs = np.sign(_measure(points, faces, walk)[1])
    if not (again.any() or np.any(covered & (signs < 0))):  # no sheet is there from both sides
        return found
    enclosing = shells.find_enclosing(points, faces, walk.component, n_shells)
    enclosing = [[one for one in around if not again[one]] for around in enclosing]
    back = copies.find_backs(enclosing, signs, covered & ~again)
    if not (back | again).any():
        return found
    kept = ~(back | again)[walk.component]
    repeats = np.concatenate([found.repeats, faces[again[walk.component]]])
    glued = closing.keep_faces(found.glued, kept)
    return found._replace(glued=glued, backs=faces[back[walk.component]], repeats=repeats)


def _find_seams(points, found):
    """The gluing of the faces by position if sheets touch along mesh edges, else None."""
    if not found.apart and not found.own_numbering:
        return None
    glued = closing.glue(found.glued.faces, len(points))
    return None if closing.is_closed(glued) else glued


def _face_outward(points, found, options, inspection):
    """Turn over parts that face inward and take apart once more: it depends on where the material is."""
    walk = _walk(found.glued)
    sizes = _measure(points, found.glued.faces, walk)
    flip = shells.orient_shells(points, found.glued.faces, walk.component, walk.turned, *sizes).flip
    if not _find_crowded_corners(found.glued.faces, len(points), flip).size:
        return found
    faces = np.where(flip[:, None], found.glued.faces[:, ::-1], found.glued.faces)
    start = found._replace(glued=closing.glue(faces, len(points)), apart=False)
    again = closing.separate_sheets(points, start, options["merge_tolerance"] * np.ptp(points, axis=0).max())
    reasons.check_closed(points, again, options["merge_tolerance"])
    told = f"turned over {flip.sum()} faces of touching parts that faced inward"
    inspection.note_repair("orient", told, options["repair"])
    return again


def _drop_flat(points, found, allowed, inspection):
    """Drop the closed parts that lie in a plane, unless nothing else is there; returns walk and sizes of the rest."""
    faces, walk = found.glued.faces, _walk(found.glued)
    component = walk.component
    areas, volumes = _measure(points, faces, walk)
    empty = np.flatnonzero(volumes == 0)
    flat = [one for one in empty if touching.lie_in_plane(points[np.unique(faces[component == one])])]
    if not 0 < len(flat) < len(volumes):
        return found, walk, (areas, volumes)
    told = f"dropped {len(flat)} closed parts that lie in a plane and enclose nothing"
    inspection.note_repair("duplicates", told, allowed)
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


def _note_turns(sides, component, allowed, inspection):
    """Note the shells whose winding was inconsistent, and those that faced inward."""
    free, n_shells = sides.free, len(sides.areas)
    if free.any():
        turned = np.bincount(component, sides.flip, n_shells)
        fewer = int(np.minimum(turned, np.bincount(component) - turned)[free].sum())
        told = f"made the winding of {free.sum()} of {n_shells} shells consistent ({fewer} faces)"
        inspection.note_repair("orient", told, allowed)
    if sides.inward.any():
        told = f"turned over {sides.inward.sum()} of {n_shells} shells that faced inward"
        inspection.note_repair("orient", told, allowed)


def _separate_vertices(points, found, walk, sides, allowed, inspection):
    """Give each sheet vertices of its own, at mesh edges and vertices where it touches another one."""
    opposite, component = walk.opposite, walk.component
    faces, origin = sheets.split_pinches(found.glued.faces, opposite, component, len(points))
    copied = np.bincount(origin)
    inspection.pinch_vertices_split = int(np.sum(copied > 1))
    if inspection.pinch_vertices_split and not found.own_numbering:
        inspection.note_repair("split", reasons.describe_pinches(points, copied), allowed)
    points, flip = points[origin], sides.flip
    if found.apart or found.own_numbering:  # else two vertices have one mesh edge at most
        points, faces, old = sheets.split_double_edges(points, faces, opposite)
        component, flip = component[old], flip[old]
    return CleanSurface(points, measures.orient_faces(faces, flip), component, sides)
