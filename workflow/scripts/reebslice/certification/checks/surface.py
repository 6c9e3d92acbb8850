"""Checks of the ground that all else stands on: the mesh, its shells, the tilt.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np

from ..recount.components import find_components
from ..recount.measures import label_vertices, largest_terms, least_rise, measure_shells
from ..recount.shells import find_around, find_body, find_parent
from ..recount.surface import copies, count_links, find_mesh_edges, rank_surface


def check_mesh(facts, ledger):
    """The surface is closed and oriented, and its shells are as the table says."""
    t = facts.columns
    facts.points, facts.faces = [t.vertices[axis] for axis in "xyz"], [t.faces[corner] for corner in "abc"]
    facts.rotation = np.asarray(facts.tilt["rotation"], float)
    facts.surface, facts.rank = rank_surface(facts.points, facts.rotation, facts.faces, t.faces["shell"])
    facts.sides = find_mesh_edges(facts.surface)
    ledger.enter("surface_is_closed_and_oriented", facts.sides is not None, True)
    if facts.sides is None:
        return
    # offsets and areas of this size are lost in the rounding of coordinates
    reach = float(max(facts.surface.points.max(), -facts.surface.points.min()))
    facts.noise = 64 * np.finfo(float).eps * reach
    _check_links(facts, ledger)
    _check_shells(facts, ledger)


def _check_links(facts, ledger):
    """Every vertex has one link cycle: corners around it are joined across mesh edges."""
    n, sides = len(facts.rank), facts.sides
    links = count_links(facts.surface.corners, sides.of_face, sides.faces, n)
    ledger.enter("vertices_with_one_link", int((links == 1).sum()), n)


def _check_shells(facts, ledger):
    """Shells are the components of the surface, with their counts, measures and nesting."""
    t, n = facts.columns, len(facts.rank)
    count = len(t.shells["shell"])
    n_parts, _ = find_components(facts.sides.lower, facts.sides.upper, n)
    shell = t.faces["shell"]  # in the order of `faces`
    facts.n_shells = count
    label, agree = label_vertices(facts.surface.corners, facts.surface.shell, n)
    facts.shell_of_vertex = label[facts.rank]
    same = bool(agree) and n_parts == count == np.count_nonzero(np.bincount(label))
    ledger.enter("shells_are_components", same, True)
    n_vertices = np.bincount(facts.shell_of_vertex, minlength=count)
    n_faces = np.bincount(shell, minlength=count)
    euler = n_vertices - n_faces // 2  # 3 F = 2 E
    facts.shell_euler, facts.shell_genus = euler, (2 - euler) // 2
    columns = (
        ("n_vertices", n_vertices),
        ("n_faces", n_faces),
        ("euler_characteristic", euler),
        ("genus", facts.shell_genus),
    )
    for name, values in columns:
        ledger.rows(f"shells.{name}", t.shells[name] == values, f"{name} counted on the mesh")
    _check_shell_measures(facts, ledger, shell, count)
    facts.euler, facts.genus = int(euler.sum()), int(facts.shell_genus.sum())
    facts.voids = int(facts.void.sum())
    facts.betti = [count - facts.voids, facts.genus, facts.voids]


def _check_shell_measures(facts, ledger, shell, count):
    """Areas, volumes, voids and bodies of the shells."""
    t = facts.columns
    areas, volumes = measure_shells(facts.points, facts.faces, shell, count)
    facts.area, facts.volume = float(areas.sum()), float(volumes.sum())
    extent = float(np.linalg.norm([np.ptp(column) for column in facts.points]))
    facts.area_noise = 1e-11 * facts.area + facts.noise * extent
    facts.volume_noise = 1e-11 * facts.area * extent + facts.noise * facts.area
    ledger.rows("shells.area", np.abs(t.shells["area"] - areas) <= facts.area_noise, "area summed over the faces")
    ledger.rows("shells.volume", np.abs(t.shells["volume"] - volumes) <= facts.volume_noise, "volume by divergence")
    sure = np.abs(volumes) > facts.volume_noise
    facts.void = np.asarray(t.shells["void"], bool)
    ledger.rows("shells.void", ~sure | (facts.void == (volumes < 0)), "a void is a shell of negative volume")
    _check_nesting(facts, ledger, shell, np.abs(volumes))


def _check_nesting(facts, ledger, shell, size):
    """Bodies and parents of the shells, by which shells are around each; size : absolute volumes."""
    t = facts.columns.shells
    crossing = bool(facts.inspection.get("body_crossings"))
    around, unsure = find_around(facts.points, facts.faces, shell, facts.n_shells, crossing)
    parent, is_open = find_parent(around, unsure, size)
    stated = np.array([-1 if p is None else p for p in t["parent"]], np.int64)
    ledger.rows("shells.parent", is_open | (stated == parent), "the smallest shell around it")
    facts.open["shells of unsure parent"] = (is_open & (stated != parent)).sum()
    body = facts.body = t["body"].astype(np.int64)
    holds = (body == np.arange(facts.n_shells)) | facts.void
    for void in np.flatnonzero(facts.void).tolist():
        found = find_body(around, facts.void, size, void)
        unknown = any(not facts.void[other] for other in unsure[void])
        holds[void] = not facts.void[body[void]] and (unknown or body[void] == found)
    says = "a body is a shell of positive volume; a void has the smallest one around it that is solid there"
    ledger.rows("shells.body", holds, says)


def check_tilt(facts, ledger):
    """Direction and rotation are what they say, and the height is as Morse as claimed."""
    rotation, direction = facts.rotation, np.asarray(facts.tilt["direction"], float)
    ledger.close("tilt.direction_is_unit", np.linalg.norm(direction), 1.0, 1e-12)
    ledger.enter("tilt.rotation_ends_in_direction", rotation[2].tolist(), direction.tolist())
    ledger.close("tilt.rotation_is_orthonormal", np.abs(rotation @ rotation.T - np.eye(3)).max(), 0.0, 1e-12)
    ledger.close("tilt.rotation_is_proper", np.linalg.det(rotation), 1.0, 1e-12)
    angle = np.degrees(np.arctan2(np.hypot(*direction[:2]), direction[2]))
    ledger.close("tilt.angle", float(facts.tilt.get("angle", np.nan)), angle, 1e-6)
    facts.least_rise = float(least_rise(facts.surface.points, facts.sides.lower, facts.sides.upper))
    _check_morse(facts, ledger, direction)


def _check_morse(facts, ledger, direction):
    """Morse beyond rounding only if no mesh edge is horizontal to within rounding."""
    unit = np.finfo(float).eps / 2
    # each height is three products and two sums; along an axis nothing rounds
    exact = np.count_nonzero(direction) == 1
    rounding = 0.0 if exact else 6 * unit * float(largest_terms(*facts.points, direction))
    word = "proven" if facts.least_rise > rounding else "by_sos"
    ledger.enter("tilt.morse", facts.tilt.get("morse"), word)
    margin = facts.tilt.get("margin")
    holds = isinstance(margin, (int, float)) and abs(margin - facts.least_rise) <= rounding
    ledger.enter(
        "tilt.margin", margin, facts.least_rise, holds, "" if holds else "It is not the smallest rise over a mesh edge."
    )
    index = facts.surface.index
    counts = {
        "minima": int((index == 0).sum()),
        "saddles": int(copies(facts.surface)[index == 1].sum()),
        "maxima": int((index == 2).sum()),
    }
    ledger.enter("tilt.critical", facts.tilt.get("critical"), counts)
    ledger.enter(
        "critical points on the mesh: #0 - #1 + #2",
        counts["minima"] - counts["saddles"] + counts["maxima"],
        facts.euler,
    )
