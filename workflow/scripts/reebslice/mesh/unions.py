"""Bodies that overlap, united into one.

The Boolean union is manifold3d's (https://github.com/elalish/manifold), which
returns a closed, oriented surface of rounded coordinates. Where bodies merely
touch, rounding would decide whether they unite, so such a union is refused.
"""

import manifold3d
import numpy as np

from ..errors import UnionError
from .faults import format_point

SHIFT = 1e-9  # of the largest extent: the union must not change if bodies move by so much
TRIALS = 2


def unite_bodies(points, faces, body):
    """Unite the bodies that overlap, or that lie in one another's material.

    Bodies that meet in mere mesh edges or vertices stay apart; if they meet in
    faces, rounding would decide, and the union is refused. Bodies whose boxes
    meet no other's stay as they are.

    Parameters
    ----------
    points : (n, 3) float64, mesh units
    faces : (m, 3) int
        Of a closed and oriented surface, each vertex with one fan of faces.
    body : (m,) int
        The body that each face bounds, voids included.

    Returns
    -------
    points, faces : (n', 3) float64 and (m', 3) int64, or None
        The union, vertices of different sheets apart; None if all bodies are
        clear of each other.

    Raises
    ------
    UnionError
        manifold3d does not take a body, a body that meets others crosses
        itself, or the shells of the union, or their genera, change when the
        bodies move by `SHIFT`.
    """
    numbers, body = np.unique(body, return_inverse=True)
    cluster = _cluster_boxes(points, faces, body, len(numbers))
    parts, changed = [], False
    for one in range(cluster.max() + 1):
        members = np.flatnonzero(cluster == one)
        united = _unite([_build(points, faces[body == member]) for member in members]) if len(members) > 1 else None
        changed |= united is not None
        parts.append(united or (points, faces[np.isin(body, members)]))
    return _put_together(parts) if changed else None


def _cluster_boxes(points, faces, body, n_bodies):
    from scipy.sparse import coo_array  # takes half a second, and few runs come here
    from scipy.sparse.csgraph import connected_components

    corners = points[faces]
    low, high = np.full((n_bodies, 3), np.inf), np.full((n_bodies, 3), -np.inf)
    np.minimum.at(low, body, corners.min(axis=1))
    np.maximum.at(high, body, corners.max(axis=1))
    meets = [np.flatnonzero(np.all((low <= high[one]) & (high >= low[one]), axis=1)) for one in range(n_bodies)]
    ends = np.repeat(np.arange(n_bodies), [len(others) for others in meets]), np.concatenate(meets)
    graph = coo_array((np.ones(len(ends[0]), bool), ends), shape=(n_bodies, n_bodies))
    return connected_components(graph, directed=False)[1]


def _build(points, faces):
    used, local = np.unique(faces, return_inverse=True)
    mesh = manifold3d.Mesh64(np.ascontiguousarray(points[used]), local.reshape(-1, 3).astype(np.uint64))
    body = _check(manifold3d.Manifold(mesh))
    _check_simple(body)
    return body


def _check_simple(body):
    """Raise `UnionError` if a body crosses itself.

    With the winding number w of a body, which is 0 or 1 unless it crosses
    itself, manifold3d's union with a twin has the winding number 2 w - w^2,
    so that the volume tells: it changes by no more than the twin's shift.
    """
    low, high = np.array(body.bounding_box()).reshape(2, 3)
    step = SHIFT * (high - low).max()
    both = _add([body, body.translate((0.6 * step, 0.64 * step, 0.48 * step))])
    if abs(both.volume() - body.volume()) > 4 * step * body.surface_area():
        raise UnionError(f"the body between {format_point(low)} and {format_point(high)} crosses itself")


def _unite(bodies):
    """Return points and faces of the union, or None if no body meets another."""
    union = _add(bodies)
    if any(_find_shells(_add(moved)) != _find_shells(union) for moved in _move_bodies(bodies)):
        low, high = np.array(union.bounding_box()).reshape(2, 3)
        raise UnionError(
            f"some of the bodies between {format_point(low)} and {format_point(high)} touch without overlapping, so"
            " rounding would decide whether they unite"
        )
    if (union.num_vert(), union.num_tri()) == tuple(map(sum, zip(*((m.num_vert(), m.num_tri()) for m in bodies)))):
        return None
    mesh = union.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3].copy(), np.asarray(mesh.tri_verts).astype(np.int64)


def _move_bodies(bodies):
    """Yield the bodies, each moved a little in a direction of its own, and then in the opposite one."""
    boxes = np.array([body.bounding_box() for body in bodies])
    reach = SHIFT * (boxes[:, 3:].max(axis=0) - boxes[:, :3].min(axis=0)).max()
    random = np.random.default_rng(0)
    for _ in range(TRIALS):
        steps = random.normal(size=(len(bodies), 3))
        steps *= reach / np.linalg.norm(steps, axis=1)[:, None]
        for sign in (1, -1):
            yield [body.translate(tuple(sign * step)) for body, step in zip(bodies, steps)]


def _find_shells(union):
    """Return genus and side of each shell, sorted."""
    return sorted((shell.genus(), shell.volume() > 0) for shell in union.decompose())


def _add(bodies):
    return _check(manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add))


def _check(manifold):
    if manifold.status() != manifold3d.Error.NoError or manifold.is_empty():
        raise UnionError(f"manifold3d does not take the surface of a body (status {manifold.status().name})")
    return manifold


def _put_together(parts):
    shifts = np.cumsum([0] + [len(points) for points, _ in parts])
    faces = [faces + shift for (_, faces), shift in zip(parts, shifts)]
    return np.concatenate([points for points, _ in parts]), np.concatenate(faces)
