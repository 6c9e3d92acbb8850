"""The direction of height: z, or the least tilt from it at which the height is a Morse function beyond rounding.

The height is a Morse function of a triangulated surface if no mesh edge is
horizontal: the index of every vertex is then that of the height itself.
Flats of machine parts and the bottoms of printed ones are horizontal, so z
often is none, while nearly every tilt of it is one. That is all that a tilt is
for, and a small one leaves to z what it means: building direction, anatomy, one
frame for a corpus.

References
----------
T. F. Banchoff, Critical points and curvature for embedded polyhedral surfaces,
American Mathematical Monthly 77 (1970)
"""

import numpy as np
from numpy.typing import ArrayLike

from ..errors import ReebsliceError
from ..kernels import njit
from ..mesh.arguments import take_mesh
from ..morse.critical_points import count_critical_points
from ..morse.ordered_mesh import tilt_points

MODES = ("auto", "none", "direction")
# The axes of a frame whose third points that way, in coordinates of the file: y up is turned about x.
FRAMES = {
    "x": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "z": np.eye(3),
    "-x": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]),
    "-y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "-z": np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]),
}

# The first tilted direction that `auto` tries is so far from z, in degrees: a part as wide as it is high then changes
# its heights by less than 0.02 %. Each of the next is twice as far.
LEAST_ANGLE = 0.01
N_TILTED = 11  # the last at 10.24 degrees
# So far the azimuth turns from each to the next. No angle is farther from all simple parts of a turn, in which the
# edges of machine parts lie.
GOLDEN_ANGLE = np.pi * (3 - 5**0.5)
# A height is Morse beyond rounding if every mesh edge rises by so many times what rounding can change in a rise.
MARGIN = 1000.0
UNIT_ROUNDOFF = 2.0**-53


def select_tilt(
    points: ArrayLike,
    faces: ArrayLike,
    mode: str = "auto",
    direction: ArrayLike | None = None,
    up: str = "z",
) -> dict:
    """Choose the direction of height of a surface.

    Parameters
    ----------
    points : (n, 3) float
        Vertices, model frame.
    faces : (m, 3) int
        Vertex ids of a closed surface.
    mode : {"auto", "none", "direction"}
        "none" takes the axis `up`, and "direction" the one given. "auto" takes
        the first of :func:`candidate_directions`, of which that axis is the
        first, whose `certainty` is at least `MARGIN`; if there is none, the
        "proven" one of the largest certainty; if there is none of these
        either, the axis.
    direction : (3,) float, optional
        With mode "direction", a vector that points up, of any length but 0.
    up : {"z", "y", "x", "-z", "-y", "-x"}
        With the other modes, the axis of the file that points up.

    Returns
    -------
    dict
        The record that `tilt.json` holds: the figures of
        :func:`assess_direction` for the chosen direction; `critical`, as
        :func:`critical_points.count_critical_points` counts there; `rotation`,
        of :func:`rotation_to_vertical`; `mode`, `up`; and `candidates`, the figures
        of all directions that were tried, in this order. It does not depend on
        the order of vertices and faces unless neighbours coincide.

    Raises
    ------
    NotASolidError
        The arrays cannot be used, or the faces point inward.
    ReebsliceError
        The mode or the axis is none of these, or the direction is none.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> tilt = select_tilt(points, faces)
    >>> tilt["direction"], tilt["morse"], round(tilt["margin"], 6)
    ([0.0, 0.0, 1.0], 'proven', 0.1)
    """
    points, faces = take_mesh(points, faces)
    if mode not in MODES:
        raise ReebsliceError(f"mode is {mode!r}: give one of {', '.join(map(repr, MODES))}.")
    if up not in FRAMES:
        raise ReebsliceError(f"up is {up!r}: give one of {', '.join(map(repr, FRAMES))}.")
    if mode == "auto":
        tried = _try_candidates(points, faces, up)
    else:
        tried = [assess_direction(points, faces, _take_direction(FRAMES[up][2] if mode == "none" else direction))]
    best = max(tried, key=lambda figures: figures["certainty"] if figures["morse"] == "proven" else 0.0)
    rotation = rotation_to_vertical(best["direction"])
    return {
        **best,
        "critical": count_critical_points(tilt_points(points, rotation), faces),
        "rotation": rotation.tolist(),
        "mode": mode,
        "up": up,
        "candidates": tried,
    }


def _take_direction(direction):
    """The unit vector of a direction of any length but 0."""
    try:
        vector = np.array(direction, float)
    except (TypeError, ValueError):
        vector = np.full(1, np.nan)
    if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
        raise ReebsliceError(f"direction is {direction!r}: give three finite numbers, of which one is not 0.")
    vector = vector / np.abs(vector).max()  # so that squares neither vanish nor overflow
    return vector / np.linalg.norm(vector)


def candidate_directions(up="z"):
    """List the directions that `auto` tries: the same for all models, so that most of a corpus shares one.

    Parameters
    ----------
    up : str
        An axis of `FRAMES`.

    Returns
    -------
    (1 + N_TILTED, 3) float64
        Unit vectors. The first is that axis, the second `LEAST_ANGLE` from it,
        each of the others twice as far as the one before, all with other azimuths.
    """
    turns = np.arange(1, N_TILTED + 1)
    angle, azimuth = np.radians(LEAST_ANGLE * 2.0 ** (turns - 1)), GOLDEN_ANGLE * turns
    flat = np.sin(angle)
    tilted = np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.cos(angle)])
    return np.vstack([[0.0, 0.0, 1.0], tilted]) @ FRAMES[up] + 0.0  # no -0.0


def _try_candidates(points, faces, up):
    """The figures of candidates up to the first that is Morse beyond rounding; it is then the most certain one."""
    tried = []
    for direction in candidate_directions(up):
        tried.append(assess_direction(points, faces, direction))
        if tried[-1]["certainty"] >= MARGIN:
            break
    return tried


def assess_direction(points, faces, direction):
    """Tell how surely the height along a direction is a Morse function.

    Parameters
    ----------
    points : (n, 3) float64
        Vertices.
    faces : (m, 3) int32
        Vertex ids of a closed surface.
    direction : (3,) float
        Unit vector.

    Returns
    -------
    dict
        direction : as given, a list.
        angle : between it and z, degrees.
        margin : smallest difference of height over a mesh edge, mesh units.
        rounding : the most by which rounding can change such a difference:
        :func:`height_rounding`, but 0 along an axis, where nothing is rounded.
        certainty : the margin divided by :func:`height_rounding`, along an axis
        as well, since coordinates in a file were rounded when it was written.
        morse : "proven" if margin > rounding. No mesh edge is then horizontal,
        and which vertices are critical, and of which index, is settled by the
        heights. It does not say that critical points that are no neighbours
        have different heights, nor that saddles are simple: these are told
        apart by ranks, and multiple saddles unfolded, whatever the direction.
        Otherwise "by_sos": the order of neighbours, too, is that of the height
        with an infinitesimal tilt (simulation of simplicity).
    """
    margin, noise = float(_least_rise(points, faces, *direction)), height_rounding(points, direction)
    rounding = 0.0 if np.count_nonzero(direction) == 1 else noise
    return {
        "direction": [float(x) for x in direction],
        "angle": float(np.degrees(np.arctan2(np.hypot(direction[0], direction[1]), direction[2]))),
        "margin": margin,
        "rounding": rounding,
        "certainty": margin / noise,
        "morse": "proven" if margin > rounding else "by_sos",
    }


def height_rounding(points, direction):
    """Bound what rounding changes in the difference of two heights.

    Parameters
    ----------
    points : (n, 3) float64
        Vertices, not all at the origin.
    direction : (3,) float
        Unit vector.

    Returns
    -------
    float
        Three products and two sums, as a height is made, round by at most 3 u
        of the sum of magnitudes, twice; mesh units, more than 0.

    References
    ----------
    N. J. Higham, Accuracy and Stability of Numerical Algorithms (2002),
    section 3.1, doi:10.1137/1.9780898718027
    """
    largest = _largest_sum(points, *(abs(float(x)) for x in direction))
    return max(2 * 3 * UNIT_ROUNDOFF * (1 + 1e-9) * largest, np.finfo(float).tiny)


def rotation_to_vertical(direction):
    """Find the smallest rotation that takes a direction to +z.

    Parameters
    ----------
    direction : (3,) float
        Unit vector.

    Returns
    -------
    (3, 3) float64
        From the model frame to the tilted frame. Its last row is `direction`
        itself, so that p . direction and the third coordinate of the rotated p
        are one number. Straight down is turned about x.
    """
    x, y, z = direction
    if z < -1 + 1e-12:
        return np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [x, y, z]])
    return np.array(
        [[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y], [x, y, z]]
    )


@njit
def _least_rise(points, faces, x, y, z):
    """The smallest difference of height along (x, y, z) over a side of a face; heights as `tilt_points` sums them."""
    least = np.inf
    for f in range(len(faces)):
        a, b, c = points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]]
        one, other = x * a[0] + y * a[1] + z * a[2], x * b[0] + y * b[1] + z * b[2]
        third = x * c[0] + y * c[1] + z * c[2]
        least = min(least, abs(one - other), abs(other - third), abs(third - one))
    return least


@njit
def _largest_sum(points, x, y, z):
    """The largest sum of magnitudes of the terms of a height along (x, y, z), none negative."""
    largest = 0.0
    for i in range(len(points)):
        largest = max(largest, x * abs(points[i, 0]) + y * abs(points[i, 1]) + z * abs(points[i, 2]))
    return largest
