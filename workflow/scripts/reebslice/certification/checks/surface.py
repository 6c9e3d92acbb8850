"""Checks of the ground that all else stands on: the mesh, its shells, the tilt.

Each takes the case (what is known of the model so far) and a ledger to enter
its findings in; what it recomputes it leaves in the case for later checks.
"""

import numpy as np

from ..recount.components import find_components
from ..recount.measures import label_vertices, largest_terms, least_rise, measure_shells
from ..recount.shells import find_around, find_body, find_parent
from ..recount.surface import copies, count_links, find_mesh_edges, rank_surface


def check_mesh(case, ledger):
    """The surface is closed and oriented, and its shells are as the table says."""
    t = case.columns
    case.points, case.faces = [t.vertices[axis] for axis in "xyz"], [t.faces[corner] for corner in "abc"]
    case.rotation = np.asarray(case.tilt["rotation"], float)
    case.surface, case.rank = rank_surface(case.points, case.rotation, case.faces, t.faces["shell"])
    case.sides = find_mesh_edges(case.surface)
    ledger.enter("surface_is_closed_and_oriented", case.sides is not None, True)
    if case.sides is None:
        return
    # offsets and areas of this size are lost in the rounding of coordinates
    case.reach = float(max(case.surface.points.max(), -case.surface.points.min()))
    case.noise = 64 * np.finfo(float).eps * case.reach
    _check_links(case, ledger)
    _check_shells(case, ledger)


def _check_links(case, ledger):
    """Every vertex has one link cycle: corners around it are joined across mesh edges."""
    n, sides = len(case.rank), case.sides
    links = count_links(case.surface.corners, sides.of_face, sides.faces, n)
    ledger.enter("vertices_with_one_link", int((links == 1).sum()), n)


def _check_shells(case, ledger):
    t, n = case.columns, len(case.rank)
    count = len(t.shells["shell"])
    n_parts, _ = find_components(case.sides.lower, case.sides.upper, n)
    shell = t.faces["shell"]  # in the order of `faces`
    case.n_shells = count
    label, agree = label_vertices(case.surface.corners, case.surface.shell, n)
    case.shell_of_vertex = label[case.rank]
    same = bool(agree) and n_parts == count == np.count_nonzero(np.bincount(label))
    ledger.enter("shells_are_components", same, True)
    n_vertices = np.bincount(case.shell_of_vertex, minlength=count)
    n_faces = np.bincount(shell, minlength=count)
    euler = n_vertices - n_faces // 2  # 3 F = 2 E
    case.shell_euler, case.shell_genus = euler, (2 - euler) // 2
    columns = (
        ("n_vertices", n_vertices),
        ("n_faces", n_faces),
        ("euler_characteristic", euler),
        ("genus", case.shell_genus),
    )
    for name, values in columns:
        ledger.rows(f"shells.{name}", t.shells[name] == values, f"{name} counted on the mesh")
    _check_shell_measures(case, ledger, shell, count)
    case.euler, case.genus = int(euler.sum()), int(case.shell_genus.sum())
    case.voids = int(case.void.sum())
    case.b0 = count - case.voids
    case.betti = [case.b0, case.genus, case.voids]


def _check_shell_measures(case, ledger, shell, count):
    """Areas, volumes, voids and bodies of the shells."""
    t = case.columns
    areas, volumes = measure_shells(case.points, case.faces, shell, count)
    case.area, case.volume = float(areas.sum()), float(volumes.sum())
    extent = float(np.linalg.norm([np.ptp(column) for column in case.points]))
    case.area_noise = 1e-11 * case.area
    case.volume_noise = 1e-11 * case.area * extent + case.noise * case.area
    ledger.rows("shells.area", np.abs(t.shells["area"] - areas) <= case.area_noise, "area summed over the faces")
    ledger.rows("shells.volume", np.abs(t.shells["volume"] - volumes) <= case.volume_noise, "volume by divergence")
    sure = np.abs(volumes) > case.volume_noise
    case.void = np.asarray(t.shells["void"], bool)
    ledger.rows("shells.void", ~sure | (case.void == (volumes < 0)), "a void is a shell of negative volume")
    _check_nesting(case, ledger, shell, np.abs(volumes))


def _check_nesting(case, ledger, shell, size):
    """Bodies and parents of the shells, by which shells are around each; size : absolute volumes."""
    t = case.columns.shells
    around, unsure = find_around(case.points, case.faces, shell, case.n_shells)
    parent, is_open = find_parent(around, unsure, size)
    stated = np.array([-1 if p is None else p for p in t["parent"]], np.int64)
    ledger.rows("shells.parent", is_open | (stated == parent), "the smallest shell around it")
    case.open["shells of unsure parent"] = (is_open & (stated != parent)).sum()
    body = case.body = t["body"].astype(np.int64)
    holds = (body == np.arange(case.n_shells)) | case.void
    for void in np.flatnonzero(case.void).tolist():
        found = find_body(around, case.void, size, void)
        unknown = any(not case.void[other] for other in unsure[void])
        holds[void] = not case.void[body[void]] and (unknown or body[void] == found)
    says = "a body is a shell of positive volume; a void has the smallest one around it that is solid there"
    ledger.rows("shells.body", holds, says)


def check_tilt(case, ledger):
    """Direction and rotation are what they say, and the height is as Morse as claimed."""
    rotation, direction = case.rotation, np.asarray(case.tilt["direction"], float)
    ledger.close("tilt.direction_is_unit", np.linalg.norm(direction), 1.0, 1e-12)
    ledger.enter("tilt.rotation_ends_in_direction", rotation[2].tolist(), direction.tolist())
    ledger.close("tilt.rotation_is_orthonormal", np.abs(rotation @ rotation.T - np.eye(3)).max(), 0.0, 1e-12)
    ledger.close("tilt.rotation_is_proper", np.linalg.det(rotation), 1.0, 1e-12)
    angle = np.degrees(np.arctan2(np.hypot(*direction[:2]), direction[2]))
    ledger.close("tilt.angle", float(case.tilt.get("angle", np.nan)), angle, 1e-6)
    case.least_rise = float(least_rise(case.surface.points, case.sides.lower, case.sides.upper))
    _check_morse(case, ledger, direction)


def _check_morse(case, ledger, direction):
    """Morse beyond rounding only if no mesh edge is horizontal to within rounding."""
    unit = np.finfo(float).eps / 2
    # each height is three products and two sums; along an axis nothing rounds
    exact = np.count_nonzero(direction) == 1
    rounding = 0.0 if exact else 6 * unit * float(largest_terms(*case.points, direction))
    word = "proven" if case.least_rise > rounding else "by_sos"
    ledger.enter("tilt.morse", case.tilt.get("morse"), word)
    margin = case.tilt.get("margin")
    holds = isinstance(margin, (int, float)) and abs(margin - case.least_rise) <= rounding
    ledger.enter(
        "tilt.margin", margin, case.least_rise, holds, "" if holds else "It is not the smallest rise over a mesh edge."
    )
    index = case.surface.index
    counts = {
        "minima": int((index == 0).sum()),
        "saddles": int(copies(case.surface)[index == 1].sum()),
        "maxima": int((index == 2).sum()),
    }
    ledger.enter("tilt.critical", case.tilt.get("critical"), counts)
    ledger.enter(
        "critical points on the mesh: #0 - #1 + #2", counts["minima"] - counts["saddles"] + counts["maxima"], case.euler
    )
