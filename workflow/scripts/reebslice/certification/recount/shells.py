"""Which shell lies within which, counted once more: rays along +x from points of each shell.

A ray counts the faces of every other shell that it meets; odd means inside.
Shells that cross or touch leave the question open.
"""

import numpy as np

from .rays import meet_faces

RAYS = 10  # per shell, besides those from its six extreme vertices


def find_around(points, faces, shell, n_shells):
    """For each shell the shells around it and those that may be: two lists of sets.

    A shell is around another if its box is and all rays from that one say so,
    and may be around it if they differ or start on it. points, faces : columns x, y, z and a, b, c
    """
    around, unsure = ([set() for _ in range(n_shells)] for _ in range(2))
    if n_shells == 1:
        return around, unsure
    points, faces = np.stack(points, axis=1), np.stack(faces, axis=1)
    owner = np.empty(len(points), np.int64)
    owner[faces] = shell[:, None]
    pairs = _find_boxed(points, owner, n_shells)
    if not len(pairs):
        return around, unsure
    faces, shell = (rows[np.isin(shell, pairs[:, 0])] for rows in (faces, shell))
    starts, source, near = _choose_starts(points, owner, np.unique(pairs[:, 1]))
    ray, face, ahead = meet_faces(points[faces], starts)
    key, place = np.unique(ray * n_shells + shell[face], return_inverse=True)
    crossed = np.bincount(place, ahead > 0, len(key)).astype(int)
    touched = np.bincount(place, np.abs(ahead) <= near[ray], len(key)) > 0
    ray, other = np.divmod(key, n_shells)
    pair, place = np.unique(other * n_shells + source[ray], return_inverse=True)
    inside = np.bincount(place, ~touched & (crossed % 2 == 1), len(pair)).astype(int)
    void = np.bincount(place, touched, len(pair)).astype(int)
    rays, boxed = np.bincount(source, minlength=n_shells), np.isin(pair, pairs @ [n_shells, 1])
    columns = (values[boxed].tolist() for values in (*np.divmod(pair, n_shells), inside, void))
    for outer, one, yes, none in zip(*columns):
        if yes and yes + none == rays[one]:
            around[one].add(outer)
        elif yes + none:
            unsure[one].add(outer)
    return around, unsure


def _find_boxed(points, owner, n_shells):
    """Pairs of shells, (k, 2): the box of the first holds that of the second."""
    order = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[order], np.arange(n_shells))
    low, high = (extreme.reduceat(points[order], first) for extreme in (np.minimum, np.maximum))
    pairs = [np.empty((0, 2), np.int64)]
    for outer in range(n_shells):
        within = ((low >= low[outer]) & (high <= high[outer])).all(axis=1)
        within[outer] = False
        inner = np.flatnonzero(within)
        pairs.append(np.stack([np.full(len(inner), outer), inner], axis=1))
    return np.concatenate(pairs)


def _choose_starts(points, owner, shells):
    """Starts of rays (q, 3), the shell of each, and what counts as on a surface.

    Vertices of each of `shells`, its extreme ones among them, moved a little
    off, so that no ray runs along a mesh edge.
    """
    order = np.argsort(owner, kind="stable")
    runs = np.searchsorted(owner[order], np.stack([shells, shells + 1], axis=1)).tolist()
    starts, source, near = [], [], []
    for number, (first, end) in zip(shells.tolist(), runs):
        own = points[order[first:end]]
        spread = np.linspace(0, len(own) - 1, RAYS).astype(int)
        chosen = np.unique(np.concatenate([own.argmin(axis=0), own.argmax(axis=0), spread]))
        span = np.ptp(own, axis=0)
        starts.append(own[chosen] + 1e-7 * span * [0.0, 0.618, -0.414])
        source.append(np.full(len(chosen), number))
        near.append(np.full(len(chosen), 1e-5 * span.max()))
    return np.concatenate(starts), np.concatenate(source), np.concatenate(near)


def find_parent(around, unsure, size):
    """The smallest shell around each one, (s,) int or -1, and where that is open (s,) bool.

    size : (s,) absolute volumes.
    """
    parent = [min(others, key=lambda other: (size[other], other), default=-1) for others in around]
    smaller = [
        any(size[other] >= size[one] and (up < 0 or size[other] <= size[up]) for other in unsure[one])
        for one, up in enumerate(parent)
    ]
    return np.array(parent, np.int64), np.array(smaller, bool)


def find_body(around, void, size, one):
    """The smallest body around the void `one` that no void around it closes, or -1.

    From the outside inward, a body opens material and a void closes that of
    the body opened last.
    """
    opened = []
    for other in sorted(around[one], key=lambda other: (-size[other], other)):
        if not void[other]:
            opened.append(other)
        elif opened:
            opened.pop()
    return opened[-1] if opened else -1
