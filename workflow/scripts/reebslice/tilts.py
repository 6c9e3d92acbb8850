"""The tilt that makes the height a Morse function."""

import numpy as np

from .critical import vertex_indices
from .heightmesh import HeightMesh, height_order, tilt_points
from .pairing import critical_persistence

MODES = ("auto", "none", "direction")

# A critical point counts in the choice of a direction if its persistence is
# at least this share of the height range: noise has no say.
SIGNIFICANT_SHARE = 0.02
# What an angle costs, in critical points per degree.
ANGLE_COST = 0.2
# Faces that the candidates of one model may visit in all; a larger mesh gets
# fewer candidates, but never fewer than the least.
FACE_BUDGET = 4_000_000
LEAST_CANDIDATES = 8


def rotation_to_vertical(direction):
    """The smallest rotation (3, 3) that takes a unit vector to +z.

    Its last row is `direction` itself, so that p . direction and the third
    coordinate of the rotated p are one number.
    """
    x, y, z = direction
    if z < -1 + 1e-12:
        return np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [x, y, z]])
    return np.array([[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y], [x, y, z]])


def candidate_directions(count, cone, seed):
    """`count` unit vectors within `cone` degrees of +z, the first of them +z itself.

    The others are uniform in the cap, drawn with `seed`.
    """
    random = np.random.default_rng(seed)
    z = 1 - (1 - np.cos(np.radians(cone))) * random.random(count - 1)
    turn = 2 * np.pi * random.random(count - 1)
    flat = np.sqrt(1 - z * z)
    return np.vstack([[0.0, 0.0, 1.0], np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])])


def select_tilt(points, faces, mode="auto", direction=None, cone=15.0, candidates=32, seed=0):
    """The tilt of a surface, as the record written to `tilt.json`.

    points : (n, 3) model frame; faces : (m, 3). mode : "none" keeps the
    input's z; "direction" takes the given vector; "auto" searches in a cone
    of `cone` degrees about z for a direction that is Morse beyond rounding
    and has the fewest persistent critical points, at a small cost per degree.

    `margin` is the smallest height difference over all mesh edges; `morse` is
    "proven" if it exceeds what rounding can amount to, else "by_sos": the
    order of heights is then made unambiguous by an infinitesimal tilt.
    """
    if mode == "auto":
        affordable = max(LEAST_CANDIDATES, FACE_BUDGET // max(1, len(faces)))
        tried = candidate_directions(min(candidates, affordable), cone, seed)
    else:
        vector = np.array([0.0, 0.0, 1.0] if mode == "none" else direction, float)
        tried = (vector / np.linalg.norm(vector))[None]
    records = [assess_direction(points, faces, vector) for vector in tried]
    best = min(records, key=lambda record: (record["morse"] != "proven", record["cost"], record["angle"]))
    return {
        **best,
        "rotation": rotation_to_vertical(best["direction"]).tolist(),
        "mode": mode,
        "candidates": [{name: r[name] for name in ("direction", "angle", "margin", "morse", "cost")} for r in records],
    }


def assess_direction(points, faces, direction):
    """Margin, critical counts and cost of one direction, as a dict.

    `critical` counts minima, saddles (a multiple one by its multiplicity) and
    maxima; `persistent` those of them whose persistence is significant.
    """
    direction = np.asarray(direction, float)
    tilted = tilt_points(points, rotation_to_vertical(direction))
    margin = edge_margin(tilted[:, 2], faces)
    angle = float(np.degrees(np.arctan2(np.hypot(direction[0], direction[1]), direction[2])))
    mesh = _ranked(tilted, faces)
    index = vertex_indices(mesh)
    tops = np.zeros(len(points), bool)
    tops[mesh.faces.max(axis=1)] = True
    persistence = critical_persistence(mesh)
    height_range = float(mesh.points[-1, 2] - mesh.points[0, 2])
    persistent = int((persistence >= SIGNIFICANT_SHARE * height_range).sum())
    return {
        "direction": direction.tolist(),
        "angle": angle,
        "margin": margin,
        "rounding": height_rounding(points, direction),
        "morse": "proven" if margin > height_rounding(points, direction) else "by_sos",
        "critical": {
            "minima": int(((index == 1) & ~tops).sum()),
            "saddles": int(-index[index < 0].sum()),
            "maxima": int(((index == 1) & tops).sum()),
        },
        "persistent": persistent,
        "cost": persistent + ANGLE_COST * angle,
    }


def edge_margin(height, faces):
    """The smallest height difference over all mesh edges, mesh units."""
    return float(min(np.abs(height[faces[:, k]] - height[faces[:, k - 1]]).min() for k in range(3)))


def height_rounding(points, direction):
    """What rounding can change in the difference of two heights, mesh units.

    Three products and two sums round by at most 3 u of the sum of magnitudes
    each (Higham 2002, section 3.1); along a coordinate axis nothing rounds.
    """
    if np.count_nonzero(direction) == 1 and np.abs(direction).max() == 1:
        return 0.0
    return float(2 * 3 * 2.0**-53 * (1 + 1e-9) * (np.abs(points) @ np.abs(direction)).max())


def _ranked(tilted, faces):
    """A height mesh for counting critical points only, without twins."""
    order = height_order(tilted)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    return HeightMesh(tilted[order], rank[faces], np.zeros(0, np.int32), order)
