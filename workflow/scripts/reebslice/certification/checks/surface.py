"""Checks of the ground that all else stands on: the mesh, its shells, the tilt.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np

from ..recount.components import find_components
from ..recount.measures import find_least_rise, measure_shells
from ..recount.shells import find_around, find_body, find_parent
from ..recount.surface import copies, count_links, find_mesh_edges, rank_surface


def check_mesh(facts, ledger):
    """The surface is closed and oriented, and its shells are as the table says."""
    t = facts.columns
    facts.points, facts.faces = tuple(t.vertices[axis] for axis in "xyz"), tuple(t.faces[corner] for corner in "abc")
    facts.rotation = np.asarray(facts.tilt["rotation"], float)
    facts.surface, facts.rank = rank_surface(facts.points, facts.rotation, facts.faces, t.faces["shell"])
    facts.sides = find_mesh_edges(facts.surface)
    ledger.enter("surface_is_closed_and_oriented", facts.sides is not None, True)
    if facts.sides is None:
        return
    # offsets and areas of this size are lost in the rounding of coordinates
    reach = float(max(facts.surface.points.max(), -facts.surface.points.min()))
    facts.noise = 64 * np.finfo(float).eps * reach
    links = count_links(facts.surface, facts.sides)
    ledger.enter("vertices_with_one_link", int((links == 1).sum()), len(links))
    _check_shells(facts, ledger)


def _check_shells(facts, ledger):
    """Shells are the components of the surface, with their counts, measures and nesting."""
    t, n, shell = facts.columns.shells, len(facts.rank), facts.columns.faces["shell"]
    facts.n_shells = count = len(t["shell"])
    n_parts, part = find_components(facts.sides.lower, facts.sides.upper, n)
    of_face, shell_of_part = part[facts.surface.corners[:, 0]], np.zeros(n_parts, np.int64)
    shell_of_part[of_face] = facts.surface.shell
    same = n_parts == count == len(np.unique(shell_of_part))
    same = same and np.array_equal(shell_of_part[of_face], facts.surface.shell)
    ledger.enter("shells_are_components", same, True)
    facts.shell_of_vertex = shell_of_part[part][facts.rank]
    n_vertices, n_faces = (np.bincount(of, minlength=count) for of in (facts.shell_of_vertex, shell))
    facts.shell_euler = n_vertices - n_faces // 2  # 3 F = 2 E
    facts.shell_genus = (2 - facts.shell_euler) // 2
    areas, volumes = measure_shells(facts.points, facts.faces, shell, count)
    facts.area, facts.volume = float(areas.sum()), float(volumes.sum())
    extent = float(np.linalg.norm([np.ptp(column) for column in facts.points]))
    facts.area_noise = 1e-11 * facts.area + facts.noise * extent
    facts.volume_noise = 1e-11 * facts.area * extent + facts.noise * facts.area
    facts.void = t["void"]
    sure = np.abs(volumes) > facts.volume_noise
    ledger.compare(
        "shells", t,
        ("n_vertices", n_vertices, "n_vertices counted on the mesh"),
        ("n_faces", n_faces, "n_faces counted on the mesh"),
        ("euler_characteristic", facts.shell_euler, "euler_characteristic counted on the mesh"),
        ("genus", facts.shell_genus, "genus counted on the mesh"),
        ("area", areas, "area summed over the faces", facts.area_noise),
        ("volume", volumes, "volume by divergence", facts.volume_noise),
        ("void", np.where(sure, volumes < 0, facts.void), "a void is a shell of negative volume"),
    )  # fmt: skip
    _check_nesting(facts, ledger, shell, np.abs(volumes))
    facts.euler, facts.genus = int(facts.shell_euler.sum()), int(facts.shell_genus.sum())
    facts.voids = int(facts.void.sum())
    facts.betti = [count - facts.voids, facts.genus, facts.voids]


def _check_nesting(facts, ledger, shell, size):
    """Bodies and parents of the shells, by which shells are around each; size : absolute volumes."""
    t = facts.columns.shells
    crossing = bool(facts.inspection.get("body_crossings"))
    around, unsure = find_around(facts.points, facts.faces, shell, facts.n_shells, crossing)
    parent, is_open = find_parent(around, unsure, size)
    ledger.rows("shells.parent", is_open | (t["parent"] == parent), "the smallest shell around it")
    facts.open["shells of unsure parent"] = (is_open & (t["parent"] != parent)).sum()
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
    _check_morse(facts, ledger, direction)


def _check_morse(facts, ledger, direction):
    """Morse beyond rounding only if no mesh edge is horizontal to within rounding."""
    least = find_least_rise(facts.surface.points, facts.sides.lower, facts.sides.upper)
    terms = sum(np.abs(part * column) for part, column in zip(direction, facts.points))
    # each height is three products and two sums; along an axis nothing rounds
    rounding = 0.0 if np.count_nonzero(direction) == 1 else 3 * np.finfo(float).eps * float(terms.max())
    ledger.enter("tilt.morse", facts.tilt.get("morse"), "proven" if least > rounding else "by_sos")
    margin = facts.tilt.get("margin")
    holds = isinstance(margin, (int, float)) and abs(margin - least) <= rounding
    ledger.enter("tilt.margin", margin, least, holds, "" if holds else "It is not the smallest rise over a mesh edge.")
    index = facts.surface.index
    minima, maxima = (int((index == extreme).sum()) for extreme in (0, 2))
    saddles = int(copies(facts.surface)[index == 1].sum())
    counts = {"minima": minima, "saddles": saddles, "maxima": maxima}
    ledger.enter("tilt.critical", facts.tilt.get("critical"), counts)
    ledger.enter("critical points on the mesh: #0 - #1 + #2", minima - saddles + maxima, facts.euler)
