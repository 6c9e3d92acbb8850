"""Looks at contours in rational numbers, where floats do not tell whether they are holes and what is around them.

The level is a plane that is really tilted, by so little that every vertex stays on its side, as in
:mod:`.exact_levels`.
"""

from fractions import Fraction

import numpy as np

from .hosts import DOUBTFUL, ODD, TRIES, no_hits, read_hits
from .links import smallest_tilt, whole_points
from .sweep import list_neighbours, note_look

MOST = 20_000  # looks, of some milliseconds each


def settle_doubts(surface, sides, body, arcs, doubts):
    """Look again at what is in doubt, and note it in the arcs.

    Parameters
    ----------
    surface, sides : Ranked, MeshEdges
    body : (m,) int
        Body of each face.
    arcs, doubts : Arcs, Doubts
        Of :func:`.sweep.sweep_surface`.

    Returns
    -------
    n_open : int
        Looks that leave a question open: where contours touch, or beyond `MOST` of them.
    odd : bool
        Whether anything that is seen contradicts itself.
    """
    open_looks, odd = np.arange(len(doubts.arc)), doubts.odd
    if not len(open_looks) or len(open_looks) > MOST:
        return len(open_looks), odd
    tilt = smallest_tilt(surface.points)
    for turn in range(TRIES):
        face = doubts.face[open_looks, turn]
        asked, left = np.flatnonzero(face >= 0), []
        groups = list_neighbours(surface, sides, body, doubts.cut[open_looks[asked]], face[asked])
        for k, (faces, labels) in zip(asked.tolist(), groups):
            look = open_looks[k]
            answer, kind, host = _look(surface, tilt, int(doubts.cut[look]), int(face[k]), faces, labels)
            if answer == DOUBTFUL:
                left.append(look)
            else:
                odd |= note_look(arcs, doubts.arc[look], doubts.cut[look], kind, host) or answer == ODD
        open_looks = np.array(left + open_looks[face < 0].tolist(), np.int64)
        if not left:
            break
    return len(open_looks), odd


def _look(surface, tilt, cut, face, faces, labels):
    """As :func:`.hosts.look_along`, through `face`; faces, labels : (k,) those that may meet the line."""
    ((_, y), (_, end)), own = _cross(surface, tilt, cut, face), int(labels[np.flatnonzero(faces == face)[0]])
    if y == end:
        return DOUBTFUL, 0, -1
    y, hits = (y + end) / 2, []
    reach = surface.points[:, 1][surface.corners[faces]]
    room = 1e-9 * np.abs(reach).max()
    near = (reach.min(axis=1) <= float(y) + room) & (reach.max(axis=1) >= float(y) - room)
    for other, label in zip(faces[near].tolist(), labels[near].tolist()):
        (px, py), (qx, qy) = _cross(surface, tilt, cut, other)
        if (py < y) != (qy < y):
            hits.append((px + (y - py) / (qy - py) * (qx - px), 1 if qy > py else -1, label))
    order = {x: k for k, x in enumerate(sorted({hit[0] for hit in hits}))}
    found = no_hits(len(hits), int(labels.max()) + 1)
    for k, (x, way, label) in enumerate(hits):
        found.x[k], found.room[k], found.way[k], found.label[k] = order[x], 0.0, way, label
    return read_hits(found, len(hits), own)


def _cross(surface, tilt, cut, face):
    """Where the segment of a face at the tilted plane right below rank `cut` begins and ends: two (x, y)."""
    a, b, c = surface.corners[face].tolist()
    short = (a, b) if b >= cut else (b, c)
    unit, ((_, _, floor), (_, _, roof), *ends) = whole_points(surface.points[[cut - 1, cut, a, c, *short]], tilt)
    plane, spots = floor + roof, []
    for (px, py, ph), (qx, qy, qh) in (ends[:2], ends[2:]):
        up, down = (plane - 2 * ph, 2 * qh - plane) if ph != qh else (1, 1)
        spots.append(tuple(Fraction(p * down + q * up, unit * (up + down)) for p, q in ((px, qx), (py, qy))))
    return spots if surface.even[face] else spots[::-1]
