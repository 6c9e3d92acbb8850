"""Multiple saddles taken apart, in the half-edges around them; the rest of a mesh is only renumbered."""

import numpy as np

from ..arrays.sorting import order_floats
from ..kernels import njit
from ..table_checks import build_table
from .critical_points import vertex_indices
from .ordered_mesh import HeightMesh, cross_at


def split_saddles(mesh, saddles, n_copies):
    """The :class:`HeightMesh` with every one of `saddles`, ascending ranks, split into simple ones.

    n_copies : how many vertices that adds. Each goes right below its saddle,
    later ones above earlier ones. A split adds two faces. Beyond copies of the
    arrays, time grows as the faces around the saddles.
    """
    faces, twins = _extended(mesh.faces, 2 * n_copies, 3), _extended(mesh.twins.reshape(-1, 3), 2 * n_copies, 3).ravel()
    corner = _corners_at(mesh.faces, saddles, len(mesh.points))
    origin, changed = _split_all(mesh.points, faces, twins, saddles, corner, len(mesh.faces), n_copies)
    ranks = np.arange(len(mesh.points), dtype=np.int32)
    rank = np.concatenate([ranks + np.searchsorted(origin, ranks, side="right"), origin + np.arange(n_copies)])
    rank = rank.astype(np.int32)
    changed = np.unique(changed)
    changed = changed[np.lexsort(rank[faces[changed]].T[::-1])]
    faces, twins = _renumber(faces, twins, rank, changed, len(mesh.faces))
    kept = np.insert(ranks, origin, origin)
    return HeightMesh(mesh.points[kept], faces, twins, mesh.vertex[kept])


def _extended(rows, more, width):
    out = np.empty((len(rows) + more, width), np.int32)
    out[: len(rows)] = rows
    return out


@njit
def _corners_at(faces, vertices, n):
    """One corner, as the half-edge from it, at each vertex."""
    wanted, corner = np.full(n, np.int32(-1)), np.empty(len(vertices), np.int32)
    wanted[vertices] = np.arange(len(vertices)).astype(np.int32)
    for f in range(faces.shape[0]):
        middle = min(faces[f, 1], faces[f, 2])
        if wanted[middle] >= 0:
            corner[wanted[middle]] = 3 * f + (1 if faces[f, 1] == middle else 2)
    return corner


@njit
def _split_all(points, faces, twins, saddles, corner, m, n_copies):
    """Split saddles in place, faces from number m on being free; returns the saddle of each copy, and changed faces."""
    n, count = len(points), 0
    origin, changed = np.empty(n_copies, np.int32), [np.int64(0) for _ in range(0)]
    for s in range(len(saddles)):
        h = np.int64(corner[s])
        while True:
            link, spokes = _link(faces, twins, h)
            begin, end = _embeddable_wedge(points, origin, link, saddles[s])
            if begin < 0:
                break
            origin[count] = saddles[s]
            h = _split(faces, twins, link, spokes, (begin, end), n + count, m + 2 * count, changed)
            count += 1
    return origin, np.array(changed)


@njit
def _link(faces, twins, start):
    """The link of the vertex that half-edge `start` leaves, counter-clockwise from outside, smallest id first.

    Returns its vertices (d,) and the half-edges (d,) to them.
    """
    link, spokes, h = [np.int64(0) for _ in range(0)], [np.int64(0) for _ in range(0)], np.int64(start)
    while True:
        link.append(np.int64(faces[h // 3, (h % 3 + 1) % 3]))
        spokes.append(h)
        h = np.int64(twins[h // 3 * 3 + (h % 3 + 2) % 3])
        if h == start:
            break
    first = np.argmin(np.array(link))
    return np.roll(np.array(link), -first), np.roll(np.array(spokes), -first)


@njit(inner=True)
def _embeddable_wedge(points, origin, link, vertex):
    """Places in the link of the last vertex below an upper wedge and of the first one behind it.

    (-1, -1) where the saddle is simple. Among the wedges with neighbouring
    zero directions the first in the link is taken; if rounding leaves none,
    the one with the smallest opening.
    """
    n, degree = len(points), len(link)
    known = np.array([w if w < n else origin[w - n] for w in link])
    upper = known > vertex  # a copy of `vertex` is below it
    wedges = [(i, _last_of(upper, i)) for i in range(degree) if not upper[i] and upper[(i + 1) % degree]]
    if len(wedges) < 3:
        return -1, -1
    angles = np.empty(2 * len(wedges))
    for w in range(len(wedges)):
        i, j = wedges[w]
        angles[2 * w] = _zero_angle(points, vertex, known[i], known[(i + 1) % degree])
        angles[2 * w + 1] = _zero_angle(points, vertex, known[(j + 1) % degree], known[j])
    order, place = order_floats(angles), np.empty(len(angles), np.int64)
    for rank in range(len(order)):
        place[order[rank]] = rank
    gaps = np.abs(place[0::2] - place[1::2])
    i, j = wedges[np.argmin(np.minimum(gaps, len(angles) - gaps))]
    return i, (j + 1) % degree


@njit(inner=True)
def _last_of(upper, i):
    """The last place of the run of upper vertices behind place i."""
    while upper[(i + 1) % len(upper)]:
        i += 1
    return i % len(upper)


@njit(inner=True)
def _zero_angle(points, vertex, low, high):
    x0, y0, z0 = points[vertex]
    x, y = cross_at(points[low], points[high], z0, x0, y0)
    return np.arctan2(y - y0, x - x0)


@njit
def _split(faces, twins, link, spokes, wedge, copy, new, changed):
    """Give the fan of a vertex from the first to the last place of its link in `wedge` to `copy`, a vertex just below.

    The two faces between them become the faces `new` and `new` + 1. Returns a
    half-edge that still leaves the vertex.
    """
    begin, end = wedge
    vertex, degree = faces[spokes[end] // 3, spokes[end] % 3], len(link)
    place = begin
    while place != end:
        h = spokes[place]
        faces[h // 3, h % 3] = copy
        changed.append(h // 3)
        place = (place + 1) % degree
    last = spokes[(end - 1) % degree]
    from_last, into_first = last // 3 * 3 + (last % 3 + 2) % 3, twins[spokes[begin]]
    faces[new, 0], faces[new, 1], faces[new, 2] = link[end], vertex, copy
    faces[new + 1, 0], faces[new + 1, 1], faces[new + 1, 2] = link[begin], copy, vertex
    across = np.array([spokes[end], 3 * new + 4, from_last, spokes[begin], 3 * new + 1, into_first])
    for k in range(6):
        twins[3 * new + k], twins[across[k]] = across[k], 3 * new + k
    changed.append(new)
    changed.append(new + 1)
    return spokes[end]


@njit
def _renumber(faces, twins, rank, changed, m):
    """Faces in terms of ranks, in lexicographic order again, and their twins.

    Ranks keep the order of what was there before, and of the corners of every
    face, so the first m faces are in order but for those that are `changed`
    (in their new order), and these are merged into the rest.
    """
    is_changed, number = np.zeros(len(faces), np.bool_), np.empty(len(faces), np.int32)
    is_changed[changed] = True
    out, out_twins = np.empty(faces.shape, np.int32), np.empty(len(twins), np.int32)
    f, c = 0, 0
    for place in range(len(faces)):
        while f < m and is_changed[f]:
            f += 1
        take = c < len(changed)
        if take and f < m:
            g = changed[c]
            a, b = rank[faces[f, 0]], rank[faces[g, 0]]
            take = b < a or (b == a and rank[faces[g, 1]] < rank[faces[f, 1]])
        if take:
            number[changed[c]], c = place, c + 1
        else:
            number[f], f = place, f + 1
    for f in range(len(faces)):
        for k in range(3):
            h, g = 3 * number[f] + k, twins[3 * f + k]
            out[number[f], k], out_twins[h] = rank[faces[f, k]], 3 * number[g // 3] + g % 3
    return out, out_twins


def unfold_saddles(mesh):
    """Split every multiple saddle into simple ones at the same position.

    A saddle whose link changes sign 2 m times becomes m - 1 vertices with
    consecutive ranks. Each split takes off an upper wedge of the link whose
    two zero directions are neighbours in the horizontal plane, so that the
    unfolded surface is still embedded (an arbitrary wedge may not be). Euler
    characteristic and all other vertices are unchanged.
    """
    index = vertex_indices(mesh)
    multiple = np.flatnonzero(index < -1).astype(np.int32)
    return split_saddles(mesh, multiple, int((-1 - index[multiple]).sum())) if len(multiple) else mesh


def unfoldings_table(mesh, below):
    """Tell how the multiple saddles came apart between whose copies a level runs.

    Parameters
    ----------
    mesh : HeightMesh
        Of :func:`unfold_saddles`.
    below : (K,) int
        Vertices below each level.

    Returns
    -------
    pyarrow.Table
        `unfoldings`, in order of rank; empty for most models.
    """
    same = np.append(mesh.vertex[1:] == mesh.vertex[:-1], False)  # as the following one
    cuts = np.asarray(below, np.int64)
    cuts = cuts[(cuts > 0) & (cuts < len(same))]
    folded = mesh.vertex[cuts[same[cuts - 1]]]
    copies = np.flatnonzero(same & np.isin(mesh.vertex, folded)) if len(folded) else np.empty(0, np.int64)
    wedge = copies, copies
    if len(copies):
        corner = _corners_at(mesh.faces, copies, len(mesh.points))
        wedge = _wedges_of(mesh.faces, mesh.twins, mesh.vertex, copies, corner)
    columns = {name: mesh.vertex[ranks] for name, ranks in zip(("vertex", "first", "last"), (copies, *wedge))}
    return build_table("unfoldings", columns | {"unfolding": np.arange(len(copies)), "rank": copies})


@njit
def _wedges_of(faces, twins, vertex, copies, corner):
    """First and last vertex of the wedge of each copy, counter-clockwise: of its upper neighbours other than copies."""
    first, last = np.empty(len(copies), np.int64), np.empty(len(copies), np.int64)
    for k in range(len(copies)):
        link, _ = _link(faces, twins, np.int64(corner[k]))
        for i in range(len(link)):
            before, now, after = link[i - 1], link[i], link[(i + 1) % len(link)]
            if now > copies[k] and vertex[now] != vertex[copies[k]]:
                if before < copies[k]:
                    first[k] = now
                if after < copies[k]:
                    last[k] = now
    return first, last
