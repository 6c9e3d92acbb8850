"""One vertex for all corners at one position, or within a tolerance of each other."""

import numpy as np

from ..kernels import njit
from .orders import height_order


def merge_exactly(points, faces):
    """Merge corners at equal positions, and drop the points that no face uses.

    Parameters
    ----------
    points : (p, 3) float64
        Finite where faces use them.
    faces : (m, 3) int
        Ids of points.

    Returns
    -------
    positions : (n, 3) float64
        All different, in lexicographic order, without -0.0.
    faces : (m, 3) int32
        The same faces over `positions`.
    """
    points, faces = np.ascontiguousarray(points, np.float64), np.ascontiguousarray(faces, np.int32)
    size = 64  # of the hash table, which holds fewer positions than faces unless the surface is in tatters
    while size < 2 * min(len(points), len(faces)):
        size *= 2
    while (found := _find_positions(points.view(np.uint64), faces, size))[0] == size // 2:
        size *= 2
    count, bits, number = found
    positions = bits[:count].view(np.float64)
    order = height_order(positions[:, [1, 2, 0]])  # it compares the last column first
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return np.take(positions, order, axis=0), np.take(rank, number, out=number, mode="clip")


@njit
def _find_positions(points, faces, size):
    """The positions that faces use, without -0.0, and the number of each corner's (m, 3), by a hash table.

    Positions are given and returned as the bits of their floats. Returns how
    many there are, at most half the `size` of the table: with so many it stops.
    """
    table, positions, count = np.full(size, np.int32(-1)), np.empty((size // 2, 3), np.uint64), 0
    shared = len(points) < faces.size  # else there is no point in keeping the number of each point
    number, of_point = np.empty(faces.shape, np.int32), np.full(len(points) if shared else 0, np.int32(-1))
    for f in range(len(faces)):
        for k in range(3):
            v = faces[f, k]
            if shared and of_point[v] >= 0:
                number[f, k] = of_point[v]
            else:
                x, y, z = _unsigned(points[v, 0]), _unsigned(points[v, 1]), _unsigned(points[v, 2])
                h = x * np.uint64(0x9E3779B97F4A7C15) ^ y * np.uint64(0xC2B2AE3D27D4EB4F)
                h ^= z * np.uint64(0x165667B19E3779F9)
                h = (h ^ (h >> np.uint64(29))) * np.uint64(0xBF58476D1CE4E5B9)
                slot = (h ^ (h >> np.uint64(32))) & np.uint64(size - 1)
                while table[slot] >= 0:
                    i = table[slot]
                    if positions[i, 0] == x and positions[i, 1] == y and positions[i, 2] == z:
                        break
                    slot = (slot + np.uint64(1)) & np.uint64(size - 1)
                if table[slot] < 0:
                    table[slot] = count
                    positions[count, 0], positions[count, 1], positions[count, 2] = x, y, z
                    count += 1
                    if count == len(positions):
                        return count, positions, number
                number[f, k] = table[slot]
                if shared:
                    of_point[v] = table[slot]
    return count, positions, number


@njit(inline="always")
def _unsigned(bits):
    return np.uint64(0) if bits == np.uint64(1 << 63) else bits


def list_tolerances(largest):
    """Return the relative tolerances to try in turn: powers of ten, then `largest`.

    Examples
    --------
    >>> list_tolerances(3e-11)
    [1e-12, 1e-11, 3e-11]
    """
    powers = [float(f"1e{k}") for k in range(-12, 0)]
    return [power for power in powers if power < largest] + ([largest] if largest > 0 else [])


def merge_nearby(points, candidates, tolerance):
    """Merge the points among `candidates` that lie within `tolerance` of each other.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
    candidates : (c,) int
        Ids of points, ascending.
    tolerance : float, mesh units

    Returns
    -------
    (n,) int64 or None
        The point that stands for each point: the first of its cluster. Clusters
        are the connected components of the graph of near pairs, so the order
        of the points decides nothing. None if a cluster grows beyond four
        tolerances, where merging would tear rather than mend.
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
    """Tell whether a part vanishes with the faces that are not `kept`.

    A sliver that filled a crack leaves its corners to its neighbours; a part
    that was smaller than the tolerance leaves a point that no face uses.

    Parameters
    ----------
    merged : (m, 3) int
    kept : (m,) bool

    Returns
    -------
    bool
    """
    used = np.zeros(merged.max() + 1, bool)
    used[merged[kept]] = True
    return not used[merged[~kept]].all()
