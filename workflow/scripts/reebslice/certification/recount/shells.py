"""Which shell lies within which, counted once more: rays along +x from points of each shell.

A ray counts the faces of every other shell that it meets; odd means inside.
Shells that cross or touch leave the question open.
"""

import numpy as np

from .rays import meet_faces

SPREAD = 6  # vertices and faces of each shell that rays start at, besides its six extreme vertices
NEAR = 1e-5  # of the shell's extent, how near to a surface counts as on it
OFF = np.array([0.0, 6.18e-3, -4.14e-3])  # of that, how far beside a start its rays run


def find_around(points, faces, shell, n_shells, crossing=False):
    """Find for each shell the shells around it and those that may be.

    From each start go two rays, to either side of it. It says something of a
    shell if both rays agree and that is not on it. A shell is around another if
    its box is and all starts that say something say so; it may be around it if
    they differ or no middle of a face says anything: of a corner that touches
    it, both rays may miss it.

    Parameters
    ----------
    points, faces : columns x, y, z (n,) and a, b, c (m,)
    shell : (m,) int
        The shell of each face.
    n_shells : int
    crossing : bool, optional
        Whether bodies are known to cross: then a shell that touches another may have it around it.

    Returns
    -------
    around, unsure : list of set
        Of each shell.
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
    starts, source, near, middle = _choose_starts(points, faces, owner, shell, np.unique(pairs[:, 1]))
    outer = np.isin(shell, pairs[:, 0])
    aside = near[:, None] * OFF
    ray, face, ahead = meet_faces(points[faces[outer]], np.concatenate([starts - aside, starts + aside]))
    turn, start = np.divmod(ray, len(starts))
    key, place = np.unique(start * n_shells + shell[outer][face], return_inverse=True)
    odd = [np.bincount(place, (ahead > 0) & (turn == side), len(key)) % 2 == 1 for side in (0, 1)]
    touched = np.bincount(place, np.abs(ahead) <= near[start], len(key)) > 0
    start, other = np.divmod(key, n_shells)
    pair, place = np.unique(other * n_shells + source[start], return_inverse=True)
    silent = touched | (odd[0] != odd[1])
    boxed = np.isin(pair, pairs @ [n_shells, 1])
    yes, mute, mute_middles = (
        np.bincount(place, says, len(pair)).astype(int)[boxed]
        for says in (~silent & odd[0], silent, silent & middle[start])
    )
    votes, middles = (np.bincount(source, says, n_shells).astype(int) for says in (np.ones(len(source)), middle))
    for key, *told in zip(pair[boxed].tolist(), yes.tolist(), mute.tolist(), mute_middles.tolist()):
        outside, one = divmod(key, n_shells)
        if told[0] and told[0] == votes[one] - told[1] and not (crossing and told[1]):
            around[one].add(outside)
        elif told[0] or middles[one] == told[2] or (crossing and told[1]):
            unsure[one].add(outside)
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


def _choose_starts(points, faces, owner, shell, shells):
    """Starts of rays (q, 3), the shell of each, what counts as on a surface, and which are middles of faces.

    The others are vertices of each of `shells`, its extreme ones among them.
    """
    starts, source, near, middle = [], [], [], []
    vertices, corners = _list_by(owner, shells), _list_by(shell, shells)
    for number, mine, faced in zip(shells.tolist(), vertices, corners):
        own = points[mine]
        chosen = np.concatenate([own.argmin(axis=0), own.argmax(axis=0), _spread(own)])
        middles = points[faces[faced[_spread(faced)]]].mean(axis=1)
        chosen = np.unique(chosen)
        starts.append(np.concatenate([own[chosen], middles]))
        middle.append(np.repeat([False, True], [len(chosen), len(middles)]))
        source.append(np.full(len(starts[-1]), number))
        near.append(np.full(len(starts[-1]), NEAR * np.ptp(own, axis=0).max()))
    return tuple(map(np.concatenate, (starts, source, near, middle)))


def _spread(rows):
    """Places of some rows, evenly spread."""
    return np.linspace(0, len(rows) - 1, SPREAD).astype(int)


def _list_by(group, wanted):
    """The members of each wanted group: list of arrays."""
    order = np.argsort(group, kind="stable")
    runs = np.searchsorted(group[order], np.stack([wanted, wanted + 1], axis=1)).tolist()
    return [order[first:end] for first, end in runs]


def find_parent(around, unsure, size):
    """Find the smallest shell around each one.

    Parameters
    ----------
    around, unsure : list of set
        Of :func:`find_around`.
    size : (s,) float64
        Absolute volumes.

    Returns
    -------
    parent : (s,) int
        -1 for none.
    is_open : (s,) bool
        Where a shell that is unsure may be it.
    """
    parent = [min(others, key=lambda other: (size[other], other), default=-1) for others in around]
    smaller = [
        any(size[other] >= size[one] and (up < 0 or size[other] <= size[up]) for other in unsure[one])
        for one, up in enumerate(parent)
    ]
    return np.array(parent, np.int64), np.array(smaller, bool)


def find_body(around, void, size, one):
    """Find the smallest body around a void that no void around it closes.

    From the outside inward, a body opens material and a void closes that of
    the body opened last.

    Parameters
    ----------
    around : list of set
        Of :func:`find_around`.
    void : (s,) bool
    size : (s,) float64
        Absolute volumes.
    one : int
        The void.

    Returns
    -------
    int
        -1 for none.
    """
    opened = []
    for other in sorted(around[one], key=lambda other: (-size[other], other)):
        if not void[other]:
            opened.append(other)
        elif opened:
            opened.pop()
    return opened[-1] if opened else -1


def find_walls(surface, below, void, body):
    """Find what is around each void that lies between two consecutive levels, by a ray along +x.

    Parameters
    ----------
    surface : Ranked
        Unfolded.
    below : (K,) int
        Its vertices below each level.
    void, body : (s,) bool and int
        Of each shell.

    Returns
    -------
    dict
        {void: (face of its body that the ray meets first, slab)}; a void that no such face is around is not in it.
    """
    walls, shell = {}, surface.shell
    for one in np.flatnonzero(void).tolist():
        corners = np.unique(surface.corners[shell == one])
        slab, last = np.searchsorted(below, corners[[0, -1]], side="right").tolist()
        if slab < last:
            continue
        own = surface.points[corners]
        start, span = own[np.argmax(own[:, 0])], np.ptp(own, axis=0)
        # a little off, so that the ray runs along no mesh edge, and toward the middle of the shell
        start = start + 1e-7 * span * [0.0, 0.414, 0.618 if start[2] < own[:, 2].mean() else -0.618]
        low, high = (surface.points[surface.corners[:, end], 2] for end in (0, 2))
        others = np.flatnonzero((shell != one) & (body[shell] == body[one]) & (low <= start[2]) & (start[2] <= high))
        _, face, ahead = meet_faces(surface.points[surface.corners[others]], start[None])
        if (ahead > 0).any():
            walls[one] = int(others[face[np.argmin(np.where(ahead > 0, ahead, np.inf))]]), slab
    return walls
