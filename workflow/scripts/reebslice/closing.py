"""Turn the loose faces of a file into a closed surface, with as little change as will do."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from . import gluing
from .faults import find_used


class Gluing(NamedTuple):
    """Faces in canonical order (see `gluing.order_corners`) and their mesh edges."""

    faces: np.ndarray  # (m, 3)
    order: np.ndarray  # (3m,) half-edges, by mesh edge
    starts: np.ndarray  # (e + 1,) where each mesh edge begins in `order`


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


def merge_exactly(points, faces):
    """Merge corners at equal positions, and drop the points that no face uses.

    Returns positions (n, 3), in lexicographic order and without -0.0, and
    faces (m, 3) over them.
    """
    used = find_used(len(points), faces)
    points = points[used] + 0.0  # -0.0 + 0.0 is 0.0
    order = np.lexsort(points.T[::-1])
    ordered = points[order]
    new = np.concatenate([[True], np.any(ordered[1:] != ordered[:-1], axis=1)])
    place = np.empty(used[-1] + 1, np.int64)
    place[used[order]] = np.cumsum(new) - 1
    return ordered[new], place[faces]


def close_surface(points, faces, numbering, largest):
    """Look for the smallest change that makes the faces a closed surface.

    points, faces : of `merge_exactly`. numbering : (m, 3) the faces as the
    file numbers them. largest : the largest relative tolerance to try.

    In this order, until every mesh edge has exactly two faces: equal corners
    merged; the file's own numbering, which may keep apart parts that touch;
    duplicate faces dropped; corners on open mesh edges merged within a
    tolerance that grows from 1e-12 of the largest extent by powers of ten.
    Returns a `Closing`; its gluing is as found if nothing closes it.
    """
    distinct = find_distinct(faces)
    exact = glue(faces[distinct], len(points))
    best = Closing(exact, exact, int(np.sum(~distinct)), 0, 0.0, 0, 0, False)
    if is_closed(exact):
        return best
    own = glue(faces[distinct], len(points), numbering[distinct])
    if is_closed(own):
        return best._replace(glued=own, own_numbering=True)
    kept = drop_duplicates(exact.faces)
    start = best._replace(duplicates=len(exact.faces) - len(kept))
    if start.duplicates:
        start = start._replace(glued=glue(kept, len(points)))
        if is_closed(start.glued):
            return start
    return _close_within_tolerance(points, start, largest) or best


def _close_within_tolerance(points, start, largest):
    extent = np.ptp(points, axis=0).max()
    loose = np.unique(list_ends(start.glued, find_open(start.glued)))
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
        glued = glue(faces, len(points))
        if is_closed(glued):
            return found._replace(glued=glued)
        single = drop_duplicates(glued.faces)
        if len(single) < len(faces) and is_closed(again := glue(single, len(points))):
            dropped = start.duplicates + len(faces) - len(single)
            return found._replace(glued=again, duplicates=dropped)
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
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def drop_duplicates(faces):
    """Return the first of each run of faces with the same three corners.

    faces : in canonical order, so that such faces are neighbours.
    """
    ordered = np.sort(faces, axis=1)
    first = np.ones(len(faces), bool)
    first[1:] = np.any(ordered[1:] != ordered[:-1], axis=1)
    return faces[first]


def glue(faces, n_vertices, numbering=None):
    """Put faces in canonical order and group their half-edges by mesh edge.

    With `numbering` (m, 3), mesh edges are told apart by those numbers.
    """
    corners = gluing.order_corners(faces, n_vertices)
    faces = faces.ravel()[corners]
    numbers = faces if numbering is None else numbering.ravel()[corners]
    return Gluing(faces, *gluing.group_half_edges(numbers, numbers.max(initial=0) + 1))


def is_closed(glued):
    """Tell whether there are mesh edges, and each has exactly two faces."""
    return len(glued.faces) > 0 and bool(np.all(np.diff(glued.starts) == 2))


def find_open(glued):
    """Return the mesh edges that have one face."""
    return np.flatnonzero(np.diff(glued.starts) == 1)


def find_crowded(glued):
    """Return the mesh edges that have more than two faces."""
    return np.flatnonzero(np.diff(glued.starts) > 2)


def list_ends(glued, edges):
    """Return (e, 2) the two vertices, in order of id, of the given mesh edges."""
    half_edges = glued.order[glued.starts[edges]]
    begin = glued.faces.ravel()[half_edges]
    end = np.roll(glued.faces, -1, axis=1).ravel()[half_edges]
    return np.sort(np.column_stack([begin, end]), axis=1)
