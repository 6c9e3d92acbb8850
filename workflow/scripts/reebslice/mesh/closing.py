"""Turn the loose faces of a file into a closed surface, with as little change as will do."""

from typing import NamedTuple

import numpy as np
from numba import njit

from ..errors import TouchingSheetsError
from . import half_edges, orders, touching
from .faults import format_point


class Gluing(NamedTuple):
    """Faces in canonical order (see `orders.order_corners`), and their mesh edges in the first way that does."""

    faces: np.ndarray  # (m, 3) int32
    opposite: np.ndarray | None  # (3m,) int32 the other half-edge of each mesh edge, if all have two
    order: np.ndarray | None = None  # (3m,) half-edges, by mesh edge
    starts: np.ndarray | None = None  # (e + 1,) where each mesh edge begins in `order`


class Closing(NamedTuple):
    """What `close_surface` found: the gluing, and what it took."""

    glued: Gluing
    exact: Gluing  # before duplicates were dropped and corners merged
    degenerate: int  # faces dropped because two of their corners are equal
    duplicates: int  # faces dropped because another one has the same corners
    tolerance: float  # relative to the largest extent; 0.0 if corners merged exactly
    collapsed: int  # faces dropped by the merge with that tolerance
    moved: int  # corners moved by it
    own_numbering: bool  # touching parts are told apart by the file's vertex numbers
    flaps: int = 0  # pairs of coinciding faces dropped because they enclose nothing
    apart: int = 0  # mesh edges taken apart, around which parts touch
    loose: int = 0  # of those, where faces coincide only within the tolerance
    entangled: str = ""  # why mesh edges with more than two faces could not be taken apart


def close_surface(points, faces, numbering, largest):
    """Look for the smallest change that makes the faces a closed surface.

    points, faces : of `merging.merge_exactly`. numbering : (m, 3) the faces as the
    file numbers them. largest : the largest relative tolerance to try.

    In this order, until every mesh edge has exactly two faces: equal corners
    merged; the file's own numbering, which may keep apart parts that touch;
    the steps of `separate_sheets`; corners on open mesh edges merged within a
    tolerance that grows from 1e-12 of the largest extent by powers of ten,
    and the steps of `separate_sheets` again.
    Returns a `Closing`; its gluing is as found if nothing closes it.
    """
    distinct = find_distinct(faces)
    proper = faces if distinct.all() else faces[distinct]
    exact = glue(proper, len(points))
    best = Closing(exact, exact, len(faces) - len(proper), 0, 0.0, 0, 0, False)
    if is_closed(exact):
        return best
    own = glue(proper, len(points), numbering[distinct])
    if is_closed(own):
        return best._replace(glued=own, own_numbering=True)
    untied = separate_sheets(points, best, largest * np.ptp(points, axis=0).max())
    if is_closed(untied.glued):
        return untied
    return _close_within_tolerance(points, best, largest) or best._replace(entangled=untied.entangled)


def separate_sheets(points, found, slack):
    """Look for what rids a surface of mesh edges with more than two faces; returns the new `Closing`.

    It is the first of these that leaves two faces to every mesh edge: duplicate
    faces dropped; flaps dropped; parts that touch along mesh edges taken apart,
    where faces coincide that lie within `slack`, in mesh units.
    """
    faces, n = found.glued.faces, len(points)
    kept = drop_duplicates(faces)
    if len(kept) < len(faces) and is_closed(single := glue(kept, n)):
        return found._replace(glued=single, duplicates=found.duplicates + len(faces) - len(kept))
    if np.any(np.diff(found.glued.starts) % 2):
        return found
    kept = drop_flaps(faces, n)
    found = found._replace(glued=glue(kept, n), flaps=(len(faces) - len(kept)) // 2)
    if not len(kept) or is_closed(found.glued):
        return found
    try:
        glued = found.glued
        order, loose = touching.pair_around(points, glued.faces, glued.order, glued.starts, slack)
    except TouchingSheetsError as fault:
        return found._replace(entangled=_describe_entangled(points, found.glued, fault))
    apart = len(find_crowded(glued))
    return found._replace(glued=Gluing(glued.faces, half_edges.pair_half_edges(order)), apart=apart, loose=loose)


def _describe_entangled(points, glued, fault):
    if fault.edge is None:
        return str(fault)
    low, high = list_ends(glued, np.array([fault.edge]))[0]
    return f"at the one from {format_point(points[low])} to {format_point(points[high])} {fault}"


def _close_within_tolerance(points, start, largest):
    extent = np.ptp(points, axis=0).max()
    single = glue(drop_duplicates(start.glued.faces), len(points))
    loose = np.unique(list_ends(single, find_open(single)))
    for tolerance in list_tolerances(largest):
        stand_in = merge_nearby(points, loose, tolerance * extent)
        if stand_in is None:
            return None
        merged = stand_in[start.glued.faces]
        kept = find_distinct(merged)
        faces = merged[kept]
        found = start._replace(
            tolerance=tolerance,
            moved=int(np.sum(stand_in != np.arange(len(points)))),
            collapsed=len(merged) - len(faces),
        )
        if not found.moved or loses_part(merged, kept):
            continue
        found = found._replace(glued=glue(faces, len(points)))
        if is_closed(found.glued):
            return found
        if is_closed((untied := separate_sheets(points, found, largest * extent)).glued):
            return untied
    return None


def list_tolerances(largest):
    """Return the relative tolerances to try in turn: powers of ten, then `largest`.

    >>> list_tolerances(3e-11)
    [1e-12, 1e-11, 3e-11]
    """
    powers = [float(f"1e{k}") for k in range(-12, 0)]
    return [power for power in powers if power < largest] + ([largest] if largest > 0 else [])


def merge_nearby(points, candidates, tolerance):
    """Merge the points among `candidates` that lie within `tolerance` of each other.

    Returns (n,) the point that stands for each point: the first of its
    cluster. Clusters are the connected components of the graph of near pairs,
    so the order of the points decides nothing. Returns None if a cluster grows
    beyond four tolerances, where merging would tear rather than mend.
    """
    from scipy.sparse import coo_array  # takes half a second, and few meshes come here
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    stand_in = np.arange(len(points))
    if not len(candidates):
        return stand_in
    pairs = cKDTree(points[candidates]).query_pairs(tolerance, output_type="ndarray")
    size = len(candidates)
    graph = coo_array((np.ones(len(pairs), bool), pairs.T), shape=(size, size))
    _, cluster = connected_components(graph, directed=False)
    first = np.full(size, len(points))
    np.minimum.at(first, cluster, candidates)
    stand_in[candidates] = first[cluster]
    if np.abs(points - points[stand_in]).max() > 4 * tolerance:
        return None
    return stand_in


def loses_part(merged, kept):
    """Tell whether dropping the faces not `kept` (m,) bool makes a part vanish.

    A sliver that filled a crack leaves its corners to its neighbours; a part
    that was smaller than the tolerance leaves a point that no face uses.
    """
    used = np.zeros(merged.max() + 1, bool)
    used[merged[kept]] = True
    return not used[merged[~kept]].all()


def find_distinct(faces):
    """Return (m,) bool: the faces with three different corners."""
    return _find_distinct(np.ascontiguousarray(faces, np.int32))


@njit(cache=True)
def _find_distinct(faces):
    distinct = np.empty(len(faces), np.bool_)
    for f in range(len(faces)):
        a, b, c = faces[f]
        distinct[f] = a != b and b != c and c != a
    return distinct


def drop_duplicates(faces):
    """Return the first of each run of faces with the same three corners.

    faces : in canonical order, so that such faces are neighbours.
    """
    ordered = np.sort(faces, axis=1)
    first = np.ones(len(faces), bool)
    first[1:] = np.any(ordered[1:] != ordered[:-1], axis=1)
    return faces[first]


def drop_flaps(faces, n_vertices):
    """Return the faces without flaps: pairs of coinciding faces that are glued to each other.

    Such a pair, which has a mesh edge to itself, encloses nothing. Where it
    goes, its neighbour may become a flap. faces : in canonical order.
    """
    while True:
        order, starts = half_edges.group_half_edges(faces, n_vertices)
        pair = np.flatnonzero(np.all(np.sort(faces[1:], axis=1) == np.sort(faces[:-1], axis=1), axis=1))
        width = np.empty(len(order), np.int64)
        width[order] = np.repeat(np.diff(starts), np.diff(starts))
        pair = pair[(width.reshape(-1, 3)[pair] == 2).any(axis=1)]
        if not len(pair):
            return faces
        faces = np.delete(faces, np.concatenate([pair, pair + 1]), axis=0)


def glue(faces, n_vertices, numbering=None):
    """Put faces in canonical order and group their half-edges by mesh edge.

    With `numbering` (m, 3), mesh edges are told apart by those numbers.
    """
    corners = orders.order_corners(faces, n_vertices)
    faces = np.take(faces, corners, mode="clip")  # which is several times as fast as to have places looked over
    numbers = faces if numbering is None else numbering.ravel()[corners]
    bound = numbers.max(initial=0) + 1
    opposite = half_edges.match_half_edges(numbers, bound) if len(faces) else None
    ways = [None, *half_edges.group_half_edges(numbers, bound)] if opposite is None else [opposite]
    return Gluing(faces, *ways)


def keep_faces(glued, kept):
    """Return the gluing of the faces `kept` (m,) bool, which are whole components of a closed surface."""
    opposite = glued.opposite.reshape(-1, 3)[kept].ravel()
    number = (np.cumsum(kept) - 1).astype(np.int32)
    return Gluing(glued.faces[kept], 3 * number[opposite // 3] + opposite % 3)


def is_closed(glued):
    """Tell whether there are mesh edges, and each has exactly two faces."""
    return glued.opposite is not None


def find_open(glued):
    """Return the mesh edges that have one face."""
    return np.flatnonzero([] if is_closed(glued) else np.diff(glued.starts) == 1)


def find_crowded(glued):
    """Return the mesh edges that have more than two faces."""
    return np.flatnonzero([] if is_closed(glued) else np.diff(glued.starts) > 2)


def list_ends(glued, edges):
    """Return (e, 2) the two vertices, in order of id, of the given mesh edges."""
    half_edges = glued.order[glued.starts[edges]]
    begin = glued.faces.ravel()[half_edges]
    end = np.roll(glued.faces, -1, axis=1).ravel()[half_edges]
    return np.sort(np.column_stack([begin, end]), axis=1)
