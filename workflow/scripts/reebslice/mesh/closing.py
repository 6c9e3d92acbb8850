"""Turn the loose faces of a file into a closed surface, with as little change as will do."""

from typing import NamedTuple

import numpy as np

from ..errors import TouchingSheetsError
from ..kernels import njit
from . import copies, half_edges, merging, orders, touching
from .faults import format_point


class Gluing(NamedTuple):
    """Faces, and the half-edges of each mesh edge.

    Attributes
    ----------
    faces : (m, 3) int32
        In canonical order, see `orders.order_corners`.
    opposite : (3 m,) int32 or None
        The other half-edge of each mesh edge, if every one is given exactly two faces.
    order, starts : (3 m,) and (e + 1,) int64, or None
        Of `half_edges.group_half_edges`, if not every mesh edge has exactly two faces.
    """

    faces: np.ndarray
    opposite: np.ndarray | None
    order: np.ndarray | None = None
    starts: np.ndarray | None = None


class Closing(NamedTuple):
    """A gluing of the faces of a file, and what it took.

    Attributes
    ----------
    glued : Gluing
    exact : Gluing
        Of all proper faces, with corners merged at equal positions only.
    degenerate : int
        Faces dropped because two of their corners are equal.
    repeats : (d, 3) int32
        Faces dropped because another face has the same three corners.
    flaps : int
        Pairs of coinciding faces dropped because they enclose nothing.
    tolerance : float
        Relative to the largest extent; 0.0 if corners merged at equal positions only.
    collapsed, moved : int
        Faces dropped and corners moved by a merge within that tolerance.
    own_numbering : bool
        Mesh edges are told apart by the file's vertex numbers.
    apart : bool
        Sheets that touch along mesh edges were taken apart.
    loose : int
        Mesh edges taken apart at which faces coincide only within the tolerance.
    backs : (d, 3) int32 or ()
        Faces dropped as the backs of others, see `copies.find_backs`.
    entangled, cure : str
        Why mesh edges with more than two faces could not be taken apart, and what the user can do.
    """

    glued: Gluing
    exact: Gluing
    degenerate: int
    repeats: np.ndarray
    flaps: int = 0
    tolerance: float = 0.0
    collapsed: int = 0
    moved: int = 0
    own_numbering: bool = False
    apart: bool = False
    loose: int = 0
    backs: np.ndarray | tuple = ()
    entangled: str = ""
    cure: str = ""


def list_closings(points, faces, numbering, largest):
    """List ways to make the faces a closed surface, the smallest change first.

    The positions of the corners decide, whether faces share vertices in the
    file or not, so that a surface is the same in every format. The numbers of
    the file are used only where positions do not tell which sheets belong
    together, as where bodies overlap along a mesh edge.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int32
        Of `merging.merge_exactly`.
    numbering : (m, 3) int
        The faces as the file numbers them.
    largest : float
        The largest tolerance to try, relative to the largest extent.

    Yields
    ------
    Closing
        Equal corners merged, if that closes the surface. Else: the steps of
        `separate_sheets`, if they do; the file's own numbering, if it does; and
        if the first did not, corners on open mesh edges merged within a
        tolerance that grows from 1e-12 by powers of ten, or, as the last one,
        a closing that is not closed.
    """
    distinct = find_distinct(faces)
    proper = faces if distinct.all() else faces[distinct]
    exact = glue(proper, len(points))
    start = Closing(exact, exact, len(faces) - len(proper), proper[:0])
    if is_closed(exact):
        yield start
        return
    separate = separate_sheets(points, start, largest * np.ptp(points, axis=0).max())
    if is_closed(separate.glued):
        yield separate
    own = glue(proper, len(points), numbering[distinct])
    if is_closed(own):
        yield start._replace(glued=own, own_numbering=True)
    if not is_closed(separate.glued):
        yield _close_within_tolerance(points, start, largest) or start._replace(
            entangled=separate.entangled, cure=separate.cure
        )


def separate_sheets(points, found, slack):
    """Rid a surface of mesh edges with more than two faces.

    In this order, until every mesh edge has two faces: flaps are dropped; of
    faces with the same corners and the same winding, all but one; in clusters
    in which the number of faces is odd at some mesh edge, of those with
    opposite windings too; and sheets that touch along mesh edges are taken
    apart (`touching.pair_around`).

    Parameters
    ----------
    points : (n, 3) float64, mesh units
    found : Closing
        Its gluing is not closed.
    slack : float, mesh units
        The distance within which faces count as coinciding.

    Returns
    -------
    Closing
        If this fails, its gluing is not closed, and `entangled` may say why.
    """
    faces, n = found.glued.faces, len(points)
    bare = copies.drop_flaps(faces, n)
    single, repeats = copies.drop_repeats(bare)
    kept = copies.drop_flaps(single, n) if len(repeats) else single
    flaps = (len(faces) - len(bare) + len(single) - len(kept)) // 2
    if not len(kept):
        return found
    glued = glue(kept, n) if len(kept) < len(faces) else found.glued
    if not is_closed(glued):
        kept, more = copies.drop_opposites(glued.faces, copies.find_odd_clusters(glued))
        glued, repeats = (glue(kept, n), np.concatenate([repeats, more])) if len(more) else (glued, repeats)
        if not is_closed(glued) and np.any(np.diff(glued.starts) % 2):
            return found
    found = found._replace(glued=glued, repeats=np.concatenate([found.repeats, repeats]), flaps=found.flaps + flaps)
    return found if is_closed(glued) else _take_apart(points, found, slack)


def _take_apart(points, found, slack):
    glued = found.glued
    try:
        order, loose = touching.pair_around(points, glued, slack)
    except TouchingSheetsError as fault:
        return found._replace(entangled=_describe_entangled(points, glued, fault), cure=fault.cure)
    return found._replace(glued=Gluing(glued.faces, half_edges.pair_half_edges(order)), apart=True, loose=loose)


def _describe_entangled(points, glued, fault):
    low, high = list_ends(glued, np.array([fault.edge]))[0]
    return f"at the one from {format_point(points[low])} to {format_point(points[high])} {fault}"


def _close_within_tolerance(points, start, largest):
    extent = np.ptp(points, axis=0).max()
    faces, proper = copies.drop_opposites(start.glued.faces)[0], start.glued.faces
    single = glue(faces, len(points))
    loose = np.unique(list_ends(single, find_open(single)))
    for tolerance in merging.list_tolerances(largest):
        stand_in = merging.merge_nearby(points, loose, tolerance * extent)
        if stand_in is None:
            return None
        merged = stand_in[proper]
        kept = find_distinct(merged)
        moved = int(np.sum(stand_in != np.arange(len(points))))
        if not moved or merging.loses_part(merged, kept):
            continue
        glued = glue(merged[kept], len(points))
        found = start._replace(glued=glued, tolerance=tolerance, moved=moved, collapsed=int(np.sum(~kept)))
        found = found if is_closed(glued) else separate_sheets(points, found, largest * extent)
        if is_closed(found.glued):
            return found
    return None


def find_distinct(faces):
    """Tell which faces have three different corners.

    Parameters
    ----------
    faces : (m, 3) int

    Returns
    -------
    (m,) bool
    """
    return _find_distinct(np.ascontiguousarray(faces, np.int32))


@njit
def _find_distinct(faces):
    distinct = np.empty(len(faces), np.bool_)
    for f in range(len(faces)):
        a, b, c = faces[f]
        distinct[f] = a != b and b != c and c != a
    return distinct


def glue(faces, n_vertices, numbering=None):
    """Put faces in canonical order and group their half-edges by mesh edge.

    Parameters
    ----------
    faces : (m, 3) int32
        Each with three different corners.
    n_vertices : int
    numbering : (m, 3) int, optional
        If given, mesh edges are told apart by these numbers.

    Returns
    -------
    Gluing
    """
    corners = orders.order_corners(faces, n_vertices)
    faces = np.take(faces, corners, mode="clip")  # several times as fast as with a check of the places
    numbers = faces if numbering is None else numbering.ravel()[corners]
    bound = numbers.max(initial=0) + 1
    opposite = half_edges.match_half_edges(numbers, bound) if len(faces) else None
    ways = [None, *half_edges.group_half_edges(numbers, bound)] if opposite is None else [opposite]
    return Gluing(faces, *ways)


def keep_faces(glued, kept):
    """Keep some components of a closed surface.

    Parameters
    ----------
    glued : Gluing
        Closed.
    kept : (m,) bool
        The faces of those components.

    Returns
    -------
    Gluing
    """
    opposite = glued.opposite.reshape(-1, 3)[kept].ravel()
    number = (np.cumsum(kept) - 1).astype(np.int32)
    return Gluing(glued.faces[kept], 3 * number[opposite // 3] + opposite % 3)


def is_closed(glued):
    """Tell whether a `Gluing` has mesh edges, each with exactly two faces."""
    return glued.opposite is not None


def find_open(glued):
    """List the mesh edges of a `Gluing` that have one face, (e,) int64: places in its `starts`."""
    return np.flatnonzero([] if is_closed(glued) else np.diff(glued.starts) == 1)


def find_crowded(glued):
    """List the mesh edges of a `Gluing` that have more than two faces, (e,) int64: places in its `starts`."""
    return np.flatnonzero([] if is_closed(glued) else np.diff(glued.starts) > 2)


def list_ends(glued, edges):
    """List the vertices of mesh edges.

    Parameters
    ----------
    glued : Gluing
        Not closed.
    edges : (e,) int
        Places in its `starts`.

    Returns
    -------
    (e, 2) int
        The two vertices of each, in order of id.
    """
    half_edges = glued.order[glued.starts[edges]]
    begin = glued.faces.ravel()[half_edges]
    end = np.roll(glued.faces, -1, axis=1).ravel()[half_edges]
    return np.sort(np.column_stack([begin, end]), axis=1)
