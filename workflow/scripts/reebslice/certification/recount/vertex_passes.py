"""A level that passes a vertex: what becomes of the contours, which are cyclic sequences of mesh edges."""

import numpy as np

from ...kernels import njit
from .rings import begin_ring, cut_after, insert_after, join, label_of, remove, replace


@njit(inner=True)
def walk_around(mesh, v, face):
    """Walk around a vertex, counter-clockwise seen from outside.

    Parameters
    ----------
    mesh : strips.Mesh
    v, face : int
        The vertex, and a face of it.

    Returns
    -------
    edges : (k,) int32
        Its mesh edges.
    mixed : (k,) int32
        Where one leads up and the next down, or the other way around, the mesh edge across from the vertex, else -1.
    """
    corners, of_face, start = mesh.corners, mesh.of_face, face
    edges, mixed = [np.int32(0) for _ in range(0)], [np.int32(0) for _ in range(0)]
    while True:
        ab, bc, ac = of_face[face]
        a, b, _ = corners[face]
        one, two = (ab, ac) if v == a else (bc, ab) if v == b else (ac, bc)
        if not mesh.even[face]:
            one, two = two, one
        edges.append(one)
        mixed.append(ac if v == b else np.int32(-1))
        face = mesh.faces[two, 0] if mesh.faces[two, 0] != face else mesh.faces[two, 1]
        if face == start:
            return np.array(edges), np.array(mixed)


@njit(inner=True)
def pass_vertex(rings, upper, v, edges, mixed):
    """Raise a level above a vertex.

    Parameters
    ----------
    rings : Rings
        The contours right below it; afterwards those right above.
    upper : (E,) int
        Upper end of each mesh edge.
    v : int
        The vertex.
    edges, mixed : (k,) int32
        Of :func:`walk_around`.
    """
    count = len(edges)
    ends = [k for k in range(count) if mixed[k] >= 0 and upper[edges[k]] == v]  # of the runs that lead down
    if len(ends) == 0:
        if upper[edges[0]] != v:
            begin_ring(rings, edges[count - 1])
            for k in range(count - 1, 0, -1):
                insert_after(rings, edges[k], edges[k - 1])
        return
    starts = [k - 1 for k in range(count) if upper[edges[k]] == v and mixed[k - 1] >= 0]  # before each such run
    if len(ends) == 1:
        _replace_run(rings, edges, starts[0] % count, ends[0])
    else:
        _cut_runs(rings, upper, v, edges, mixed)


@njit(inner=True)
def _replace_run(rings, edges, before, end):
    """Replace the run of edges from after `before` to `end` by the others, those from `before` backward."""
    count = len(edges)
    n_down = (end - before) % count
    n_up, place = count - n_down, np.int32(-1)
    for k in range(max(n_down, n_up)):
        down, up = edges[(before + 1 + k) % count], edges[(before - k) % count]
        if k < n_down and k < n_up:
            replace(rings, down, up)
        elif k < n_down:
            remove(rings, down)
        else:
            insert_after(rings, place, up)
        place = up


@njit(inner=True)
def _cut_runs(rings, upper, v, edges, mixed):
    """Cut contours open at a saddle, and join what is left the other way around."""
    count, cut = len(edges), [np.int64(-1)]
    befores, labels = [np.int32(0) for _ in range(0)], [np.int64(0) for _ in range(0)]
    for k in range(count):
        if upper[edges[k]] == v and mixed[k - 1] >= 0:
            befores.append(mixed[k - 1])
            labels.append(np.int64(label_of(rings, edges[k])))
    for edge in edges:
        if upper[edge] == v:
            remove(rings, edge)
    for k in range(len(befores)):
        cut_after(rings, befores[k], labels[k] not in cut)
        cut.append(labels[k])
    for k in range(count):
        if upper[edges[k]] != v and mixed[k] >= 0:  # the last of a run that leads up
            place, j = mixed[k], k
            while upper[edges[j]] != v:
                insert_after(rings, place, edges[j])
                place, j = edges[j], j - 1
            join(rings, place, mixed[j])
