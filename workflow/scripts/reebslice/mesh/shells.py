"""Shells: which is inside which, and on which side of each the material is.

A shell is a connected component of the surface. Its sign is +1 where its
faces are counter-clockwise seen from outside it (it encloses a volume), -1
where they are clockwise (it encloses a void).
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit

SAMPLES = 33  # faces of a shell that vote on what it is inside
CLEAR = 1e-6  # of the shell's extent, how far from its faces it votes


def find_enclosing(points, faces, shell, n_shells):
    """List, for each shell, the shells that enclose it.

    A shell encloses another if its box does and if most of `SAMPLES` faces of
    the other are inside it. A face votes by the two points a little off its
    centre on both of its sides, each by the parity of an upward ray, and only
    if they agree: where walls touch they do not, so that of two coinciding
    shells none encloses the other, and a plate is not around the pin in its bore.
    Where no face votes so, the centres themselves do, and all must be inside:
    walls that coincide within rounding may run through one another.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
    shell : (m,) int
        The shell of each face, below `n_shells`; every shell is closed.
    n_shells : int

    Returns
    -------
    list of n_shells lists of int, each ascending
    """
    enclosing = [[] for _ in range(n_shells)]
    if n_shells == 1:
        return enclosing
    order = np.argsort(shell, kind="stable")
    members = np.split(order, np.cumsum(np.bincount(shell, minlength=n_shells))[:-1])
    low, high = _find_boxes(points, faces, np.ascontiguousarray(shell, np.int32), int(n_shells))
    centres = [_sample_centres(points, faces, member) for member in members]
    for outer in range(n_shells):
        boxed = np.all((low >= low[outer]) & (high <= high[outer]), axis=1)
        boxed[outer] = False
        inner = np.flatnonzero(boxed)
        if len(inner):
            votes = np.subtract(*_count_votes(points, faces[members[outer]], [centres[s][:, :2] for s in inner]))
            left = np.flatnonzero(votes == 0)
            if len(left):
                within, out = _count_votes(points, faces[members[outer]], [centres[s][:, 2:] for s in inner[left]])
                votes[left] = np.where(out == 0, within, 0)
            for one in inner[votes > 0]:
                enclosing[one].append(outer)
    return enclosing


@njit
def _find_boxes(points, faces, shell, n_shells):
    """The lowest and the highest coordinates of each shell, two (s, 3)."""
    low, high = np.full((n_shells, 3), np.inf), np.full((n_shells, 3), -np.inf)
    for f in range(len(faces)):
        for v in faces[f]:
            for axis in range(3):
                low[shell[f], axis] = min(low[shell[f], axis], points[v, axis])
                high[shell[f], axis] = max(high[shell[f], axis], points[v, axis])
    return low, high


def _sample_centres(points, faces, member):
    """Of some of the faces `member` a point a little off its centre on either side, and the centre: (k, 3, 3)."""
    chosen = member[np.unique(np.linspace(0, len(member) - 1, SAMPLES).astype(np.int64))]
    a, b, c = (points[faces[chosen, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal *= (
        CLEAR
        * np.ptp(points[faces[member]], axis=(0, 1)).max()
        / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    )
    centre = a + ((b - a) + (c - a)) / 3
    return np.stack([centre - normal, centre + normal, centre], axis=1)


def _count_votes(points, faces, groups):
    """Return, for each group of points (k, w, 3), how many rows of w are all inside, and how many all outside."""
    queries = np.concatenate(groups)
    group = np.repeat(np.arange(len(groups)), [len(one) for one in groups])
    rows, queries = queries.shape[:2], queries.reshape(-1, 3)
    order = np.argsort(queries[:, 0], kind="stable")
    margin = 1e-14 * (np.abs(points[faces]).max() + np.ptp(points[faces], axis=(0, 1)).max())
    inside, on = cast_rays(points, faces, queries[order], margin)
    vote = np.empty(len(order), np.int64)
    vote[order] = np.where(on, 0, np.where(inside, 1, -1))
    vote = vote.reshape(rows)
    return tuple(np.bincount(group, (sign * vote > 0).all(axis=1), len(groups)).astype(np.int64) for sign in (1, -1))


@njit(inner=True)
def _edge_crosses(points, i, j, px, py):
    # Ends in the order of their ids: both faces of a mesh edge then compute
    # the same number, and the ray passes it on the same side for both.
    if i > j:
        i, j = j, i
    xa, xb = points[i, 0], points[j, 0]
    if (xa <= px) == (xb <= px):
        return False
    ya, yb = points[i, 1], points[j, 1]
    return ya + (yb - ya) * ((px - xa) / (xb - xa)) > py


@njit(inner=True)
def _height_on_face(points, face, px, py):
    ax, ay, az = points[face[0]]
    bx, by, bz = points[face[1]]
    cx, cy, cz = points[face[2]]
    ux, uy, uz = bx - ax, by - ay, bz - az
    vx, vy, vz = cx - ax, cy - ay, cz - az
    normal = ux * vy - uy * vx
    low, high = min(az, bz, cz), max(az, bz, cz)
    if normal == 0.0:
        return low, high
    s = ((px - ax) * vy - (py - ay) * vx) / normal
    t = (ux * (py - ay) - uy * (px - ax)) / normal
    z = min(max(az + s * uz + t * vz, low), high)
    return z, z


@njit
def cast_rays(points, faces, queries, margin):
    """Tell which points are inside a closed surface, by the parity of the faces above them.

    A ray that meets a mesh edge or a vertex meets one face of those around it,
    or a number that leaves the parity right: mesh edges are tested once and for
    all, over half-open intervals of x.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
    queries : (q, 3) float64
        Sorted by x.
    margin : float, mesh units

    Returns
    -------
    inside : (q,) bool
    on : (q,) bool
        On the surface within `margin`, where `inside` says nothing.
    """
    n_queries = len(queries)
    inside = np.zeros(n_queries, np.bool_)
    on = np.zeros(n_queries, np.bool_)
    xs = queries[:, 0].copy()
    for f in range(len(faces)):
        i, j, k = faces[f]
        low = min(points[i, 0], points[j, 0], points[k, 0])
        high = max(points[i, 0], points[j, 0], points[k, 0])
        q = np.searchsorted(xs, low)
        while q < n_queries and xs[q] <= high:
            px, py, pz = queries[q]
            hit = (
                _edge_crosses(points, i, j, px, py)
                ^ _edge_crosses(points, j, k, px, py)
                ^ _edge_crosses(points, k, i, px, py)
            )
            if hit:
                below, above = _height_on_face(points, faces[f], px, py)
                if below - margin <= pz <= above + margin:
                    on[q] = True
                elif below > pz:
                    inside[q] = not inside[q]
            q += 1
    return inside, on


class Shells(NamedTuple):
    """The shells of a closed surface, and on which side of each the material is.

    Attributes
    ----------
    flip : (m,) bool
        The faces to turn over so that all are counter-clockwise seen from outside the material.
    areas : (s,) float64
    volumes : (s,) float64
        Negative for voids.
    body, parent : (s,) int
        See `nest_shells`.
    free : (s,) bool
        Its winding was inconsistent.
    inward : (s,) bool
        Its winding was consistent, but it is turned over as a whole.
    """

    flip: np.ndarray
    areas: np.ndarray
    volumes: np.ndarray
    body: np.ndarray
    parent: np.ndarray
    free: np.ndarray
    inward: np.ndarray


def orient_shells(points, faces, shell, turned, areas, volumes):
    """Find on which side of every shell the material is.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
    shell : (m,) int
        The shell of each face.
    turned : (m,) bool
        The faces wound against the first one of their shell.
    areas, volumes : (s,) float64
        Of the shells, each wound as its first face.

    Returns
    -------
    Shells
    """
    n_shells = len(volumes)
    free = np.bincount(shell[turned], minlength=n_shells) > 0
    enclosing = find_enclosing(points, faces, shell, n_shells)
    before = np.sign(volumes).astype(np.int64)
    signs, body, parent = nest_shells(enclosing, before, np.abs(volumes), free)
    mirrored = signs * before < 0  # not those without volume, which have no inside
    flip = turned ^ mirrored[shell]
    return Shells(flip, areas, signs * np.abs(volumes), body, parent, free, mirrored & ~free)


def nest_shells(enclosing, signs, volumes, free):
    """Decide the sign, the body and the parent of every shell.

    From the outside inward, W is the sum of the signs of the shells around
    one. A positive shell is a body, inside another one too: overlapping bodies
    stay apart. A negative one is a void where W >= 1, and else is turned over.
    A free one is a void where W is odd. A nest that is, shell by shell, the
    mirror image of bodies and voids in turn is turned over as a whole.

    Parameters
    ----------
    enclosing : list of lists
        The shells around each shell.
    signs : (s,) int
        +1 or -1 as the file has them.
    volumes : (s,) float64
        Absolute volumes.
    free : (s,) bool
        Shells whose own sign means nothing, because their winding was inconsistent.

    Returns
    -------
    signs : (s,) int
    body : (s,) int
        The shell itself, or for a void the smallest body around it that is solid there.
    parent : (s,) int
        The smallest shell around it, or -1.
    """
    depth = np.array([len(around) for around in enclosing])
    signs = _mirror_nests(enclosing, depth, np.array(signs), free)
    body = np.arange(len(signs))
    parent = np.full(len(signs), -1)
    for one in np.lexsort((np.arange(len(signs)), -volumes, depth)):
        around = enclosing[one]
        winding = signs[around].sum() if len(around) else 0
        if free[one]:
            signs[one] = -1 if winding % 2 else 1
        elif winding <= 0:
            signs[one] = 1
        if len(around):
            parent[one] = min(around, key=lambda other: (volumes[other], other))
        if signs[one] < 0:
            body[one] = _find_body(around, signs, body, volumes, parent[one])
    return signs, body, parent


def _mirror_nests(enclosing, depth, signs, free):
    """Turn over each nest whose signs run -, +, -, .. from the outside inward."""
    root = np.array(
        [next((o for o in around if depth[o] == 0), s) for s, around in enumerate(enclosing)],
        dtype=np.int64,
    )
    mirrored = free | (signs == np.where(depth % 2, 1, -1))
    whole = np.ones(len(signs), bool)
    np.logical_and.at(whole, root, mirrored)
    return np.where(whole[root], -signs, signs)


def _find_body(around, signs, body, volumes, otherwise):
    solid = [
        other for other in around if signs[other] > 0 and not any(signs[v] < 0 and body[v] == other for v in around)
    ]
    solid = solid or [other for other in around if signs[other] > 0] or [otherwise]
    return min(solid, key=lambda other: (volumes[other], other))
