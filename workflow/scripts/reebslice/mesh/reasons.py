"""Sentences about surfaces: why one is no boundary of a solid, or what it took to make it one."""

import numpy as np

from ..errors import NotASolidError
from . import closing, copies, sheets, touching
from .faults import format_point


def check_closed(points, found, tolerance):
    """Raise `NotASolidError`, with what is wrong, where, and the cure, unless every mesh edge has two faces.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
    found : closing.Closing
    tolerance : float
        The largest merge tolerance, which the cure names.
    """
    if closing.is_closed(found.glued):
        return
    exact = found.exact
    if not len(exact.faces):
        raise NotASolidError(
            f"All {found.degenerate} faces have two equal corners: nothing remains of the"
            " surface; export the mesh with more digits."
        )
    faults = [*_find_holes(points, exact, tolerance), *_find_crowding(points, found), *_find_twist(points, exact)]
    told = "; ".join(fault for fault, _ in faults)
    raise NotASolidError(f"{told[0].upper()}{told[1:]}. In a mesh editor, {'; '.join(cure for _, cure in faults)}.")


def _find_holes(points, exact, tolerance):
    """Yield fault and cure of mesh edges with one face."""
    edges = closing.find_open(exact)
    if len(edges):
        yield (
            f"the surface is open: {len(edges)} mesh edges have only one face, the first {_span(points, exact, edges)}",
            "fill the holes, or, if the parts of the surface only just fail to meet, raise inspect.merge_tolerance"
            f" ({tolerance:g})",
        )


def _find_crowding(points, found):
    """Yield faults and cures of mesh edges with more than two faces."""
    exact, edges = found.exact, closing.find_crowded(found.exact)
    if not len(edges):
        return
    fault = (
        f"the surface is not a manifold: {len(edges)} mesh edges have three or more faces, the first"
        f" {_span(points, exact, edges)}"
    )
    single, dropped = copies.drop_opposites(exact.faces)
    crowded = len(closing.find_crowded(closing.glue(single, len(points))))
    if found.entangled:
        yield f"{fault}; they cannot be taken apart: {found.entangled}", found.cure
    elif crowded and not np.any(np.diff(exact.starts) % 2):
        alike = len(copies.drop_repeats(exact.faces)[1])
        yield (
            f"{fault}; {alike} faces lie on others there that are wound the same way,"
            " so that parts overlap or face inward",
            "unite the parts that overlap, or turn over those that face inward",
        )
        return
    elif crowded:
        yield fault, "delete the inner walls or stray faces that meet the surface there"
    else:
        yield fault, "delete the copies of faces there"
    if len(dropped):
        shared = _count_shared(exact.faces)
        yield (
            f"{shared} faces lie in {shared - len(dropped)} places, two or more in each with the same"
            f" corners, the first at {_place(points, dropped)}",
            "delete the copies",
        )


def _find_twist(points, exact):
    """Yield fault and cure of a surface that is one-sided wherever it is a manifold."""
    conflict = sheets.find_conflict(exact)
    if conflict >= 0:
        yield (
            "it is one-sided (like a Moebius strip), so that its faces cannot be wound consistently: the first conflict"
            f" is at {format_point(points[exact.faces.ravel()[conflict]])}",
            "rebuild that part, since a solid has no such boundary",
        )


def check_two_sided(points, faces, conflict):
    """Raise `NotASolidError` if a walk over a closed surface met the half-edge `conflict`, not -1."""
    if conflict >= 0:
        raise NotASolidError(
            "The surface is one-sided (like a Klein bottle): its faces cannot be wound consistently, the first conflict"
            f" is at {format_point(points[faces.ravel()[conflict]])}; a solid has no such boundary,"
            " rebuild that part."
        )


def check_volumes(points, faces, component, volumes):
    """Raise `NotASolidError` if a closed part encloses nothing: it is flat, or one-sided and written from both sides.

    Parameters
    ----------
    points, faces, component : (n, 3), (m, 3) and (m,)
    volumes : (s,) float64
        Signed, exact where they are zero.
    """
    flat = np.flatnonzero(volumes == 0)
    if not len(flat):
        return
    part = faces[component == flat[0]]
    first = format_point(points[part[0, 0]])
    if np.all(np.bincount(copies.find_runs(part)) == 2) and not touching.lie_in_plane(points[np.unique(part)]):
        raise NotASolidError(
            f"{len(flat)} of {len(volumes)} closed parts are one-sided surfaces (like a Klein bottle) of which every"
            f" face is written from both sides, the first is at {first}; a solid has no such boundary, rebuild that"
            " part."
        )
    raise NotASolidError(
        f"{len(flat)} of {len(volumes)} closed parts enclose no volume, the first is at {first}; delete such flat"
        " parts in a mesh editor."
    )


def list_repairs(points, found, seams):
    """List what it took to close a surface.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
    found : closing.Closing
        Closed.
    seams : closing.Gluing or None
        Its faces by position, if more than two of them share some mesh edges.

    Returns
    -------
    list of pairs of str
        The kind of repair out of `record.REPAIRS`, and the sentence.
    """
    told = []
    if found.tolerance:
        told.append(("merge", _describe_merge(points, found)))
    if len(found.repeats):
        told.append(("duplicates", _describe_repeats(points, found)))
    if found.flaps:
        flaps = f"dropped {found.flaps} flaps, that is pairs of coinciding faces that enclose nothing"
        told.append(("duplicates", flaps))
    if len(found.backs):
        backs = (
            f"dropped {len(found.backs)} faces on the back of sheets that are written from both sides, the first at"
            f" {_place(points, found.backs)}"
        )
        told.append(("duplicates", backs))
    if seams is not None and not found.own_numbering:
        told.append(("split", _describe_apart(points, found, seams)))
    return told


def describe_numbering(points, seams):
    """Say where the file's own numbering told touching sheets apart; `seams` as in `list_repairs`."""
    edges = closing.find_crowded(seams)
    return (
        f"kept apart parts that touch along {len(edges)} mesh edges, the first {_span(points, seams, edges)},"
        " as the file numbers its vertices"
    )


def describe_pinches(points, copied):
    """Say which vertices were split; `copied` (n,) is how many vertices each point becomes."""
    pinched = np.flatnonzero(copied > 1)
    return (
        f"split {len(pinched)} pinch vertices, where sheets touch in a point, into"
        f" {copied[pinched].sum()}, the first at {format_point(points[pinched[0]])}"
    )


def _describe_merge(points, found):
    extent = np.ptp(points, axis=0).max()
    told = (
        f"merged {found.moved} corners within {found.tolerance:g} of the largest extent"
        f" ({found.tolerance * extent:.3g}) to close {len(closing.find_open(found.exact))} open mesh edges"
    )
    return told + (f", by which {found.collapsed} sliver faces vanished" if found.collapsed else "")


def _describe_repeats(points, found):
    return (
        f"dropped {len(found.repeats)} copies of faces whose corners another face has too, the first at"
        f" {_place(points, found.repeats)}"
    )


def _describe_apart(points, found, seams):
    edges = closing.find_crowded(seams)
    loose = f"; at {found.loose} of them faces coincide within the merge tolerance only" if found.loose else ""
    return (
        f"took apart {len(edges)} mesh edges around which bodies touch, the first {_span(points, seams, edges)}{loose}"
    )


def _count_shared(faces):
    return int(np.sum((count := np.bincount(copies.find_runs(faces)))[count > 1]))


def _place(points, faces):
    """The corners of the first of the faces, as text."""
    return ", ".join(format_point(point) for point in points[faces[0]])


def _span(points, glued, edges):
    ends = closing.list_ends(glued, edges)
    first = ends[np.lexsort(ends.T[::-1])[0]]
    return f"from {format_point(points[first[0]])} to {format_point(points[first[1]])}"
