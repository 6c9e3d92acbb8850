"""The tilt that makes the height a Morse function, and its Reeb graph one that few levels show."""

import math

import numpy as np
from numba import njit

from ..mesh.orders import height_order
from ..morse.ordered_mesh import tilt_points
from .cone import gather_neighbours, survey_surface
from .scan import find_critical_points, heights_along, scan_directions
from .score import blank_buffers, fewest_levels, find_significant

MODES = ("auto", "none", "direction")

# A critical point counts in the choice of a direction if its persistence is
# at least this share of the height range: noise has no say.
SIGNIFICANT_SHARE = 0.02
# What an angle costs, in levels per degree.
ANGLE_COST = 0.1
# Where more levels than these are needed, noise rules, and they are not counted.
MOST_LEVELS = 1000
# What is recorded of the candidates that are not chosen.
CANDIDATE_FIGURES = (
    "direction",
    "angle",
    "margin",
    "morse",
    "persistent",
    "fewest_levels",
    "fewest_levels_exact",
    "cost",
)


def rotation_to_vertical(direction):
    """The smallest rotation (3, 3) that takes a unit vector to +z.

    Its last row is `direction` itself, so that p . direction and the third
    coordinate of the rotated p are one number.
    """
    x, y, z = direction
    if z < -1 + 1e-12:
        return np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [x, y, z]])
    return np.array(
        [[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y], [x, y, z]]
    )


def candidate_directions(count, cone, seed):
    """`count` unit vectors within `cone` degrees of +z, the first of them +z itself.

    The others are uniform in the cap, drawn with `seed`: the same ones, and more, for a larger count.
    """
    random = np.random.default_rng(seed)
    up, around = random.random((count - 1, 2)).T
    z = 1 - (1 - np.cos(np.radians(cone))) * up
    turn = 2 * np.pi * around
    flat = np.sqrt(1 - z * z)
    return np.vstack([[0.0, 0.0, 1.0], np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])])


def select_tilt(points, faces, mode="auto", direction=None, cone=15.0, candidates=64, seed=0):
    """The tilt of a surface, as the record written to `tilt.json`.

    points : (n, 3) model frame; faces : (m, 3). mode : "none" keeps the
    input's z; "direction" takes the given vector; "auto" tries z and others in
    a cone of `cone` degrees about it, drawn with `seed`, for a direction that
    is Morse beyond rounding and costs least (:func:`assess_directions`). The
    result does not depend on the order of vertices and faces.

    `margin` is the smallest height difference over all mesh edges; `morse` is
    "proven" if it exceeds what rounding can amount to, else "by_sos": the
    order of heights is then made unambiguous by an infinitesimal tilt.
    """
    if mode == "auto":
        tried, drawn = candidate_directions(candidates, cone, seed), {"cone": float(cone), "seed": int(seed)}
    else:
        vector = np.array([0.0, 0.0, 1.0] if mode == "none" else direction, float)
        tried, drawn = (vector / np.linalg.norm(vector))[None], {}
    records = assess_directions(points, faces, tried)
    best = min(records, key=lambda record: (record["morse"] != "proven", record["cost"], record["angle"]))
    return {
        **best,
        "rotation": rotation_to_vertical(best["direction"]).tolist(),
        "mode": mode,
        **drawn,
        "candidates": [{name: record[name] for name in CANDIDATE_FIGURES} for record in records],
    }


def assess_directions(points, faces, directions):
    """Margin, critical counts, fewest levels and cost of each direction (k, 3): a list of k dicts.

    `critical` counts minima, saddles (a k-fold one k times) and maxima;
    `persistent` those of them whose persistence is significant, loops always.
    `fewest_levels` tell the significant ones apart, `fewest_levels_exact` all,
    noise as well (:func:`score.fewest_levels`; of both, at most
    `MOST_LEVELS` are counted). The cost is the geometric
    mean of the two, so that either matters in proportion, and a little for the
    angle to z.
    """
    points, faces = gather_neighbours(np.ascontiguousarray(points, float), np.ascontiguousarray(faces, np.int32))
    directions = np.array(directions, float)
    rounding = height_rounding(points, directions)
    surface = survey_surface(points, faces, directions, rounding.max())
    scans = zip(*scan_directions(surface, points, directions))
    points = np.asfortranarray(points)
    room = np.empty(len(points)), blank_buffers(surface)
    return [_assess(points, surface, *case, *room) for case in zip(directions, rounding.tolist(), scans)]


def _assess(points, surface, direction, rounding, scan, height, trails):
    """scan : of :func:`scan_directions`. height, trails : room for the heights (n,) and for what walks leave behind."""
    key = heights_along(points, direction, height)
    found = find_critical_points(surface, key, scan)
    margin = float(found.margin)
    if len(found.vertices) == 0:  # heights tie
        key = sos_ranks(points, direction)
        found = find_critical_points(surface, key)
    size = SIGNIFICANT_SHARE * float(height[found.vertices[-1]] - height[found.vertices[0]])
    significant, persistent = find_significant(surface, key, height, found, size, trails)
    levels = fewest_levels(surface, key, found, significant, MOST_LEVELS, trails)
    every = np.ones(len(significant), bool)
    exact = levels if significant.all() else fewest_levels(surface, key, found, every, MOST_LEVELS, trails)
    angle = float(np.degrees(np.arctan2(np.hypot(direction[0], direction[1]), direction[2])))
    index, lowest = found.index, found.lowest
    return {
        "direction": direction.tolist(),
        "angle": angle,
        "margin": margin,
        "rounding": rounding,
        "morse": "proven" if margin > rounding else "by_sos",
        "critical": {
            "minima": int(((index == 1) & lowest).sum()),
            "saddles": int(-index[index < 0].sum()),
            "maxima": int(((index == 1) & ~lowest).sum()),
        },
        "persistent": persistent,
        "fewest_levels": levels,
        "fewest_levels_exact": exact,
        "cost": math.sqrt(levels * exact) + ANGLE_COST * angle,
    }


def sos_ranks(points, direction):
    """Place of every vertex in the order of heights, ties broken as everywhere, (n,) float64."""
    rank = np.empty(len(points))
    rank[height_order(tilt_points(points, rotation_to_vertical(direction)))] = np.arange(len(points))
    return rank


def height_rounding(points, directions):
    """What rounding can change in the difference of two heights along each of (k, 3) directions, (k,) mesh units.

    Three products and two sums round by at most 3 u of the sum of magnitudes
    each (Higham 2002, section 3.1); along a coordinate axis nothing rounds.
    """
    sizes = np.abs(np.asarray(directions, float))
    along_axis = (np.count_nonzero(sizes, axis=1) == 1) & (sizes.max(axis=1) == 1)
    rounding = 2 * 3 * 2.0**-53 * (1 + 1e-9) * _largest_sums(np.ascontiguousarray(points, float), sizes)
    return np.where(along_axis, 0.0, rounding)


@njit(cache=True)
def _largest_sums(points, sizes):
    largest = np.zeros(len(sizes))
    for i in range(len(points)):
        x, y, z = abs(points[i, 0]), abs(points[i, 1]), abs(points[i, 2])
        for k in range(len(sizes)):
            largest[k] = max(largest[k], sizes[k, 0] * x + sizes[k, 1] * y + sizes[k, 2] * z)
    return largest
