"""Checks of the slices: levels, contours and their curves, pieces.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np

from ..recount.cells import cross
from ..recount.curves import look, measure_curves, read_curves
from ..recount.cut_surface import count_below, recount
from ..recount.elders import essential_points
from ..recount.exact_levels import ExactLevels
from ..recount.ranges import list_members
from ..recount.shells import find_walls
from ..recount.surface import copies, find_mesh_edges
from ..recount.unfoldings import Witness, find_folded, list_copies, unfold

ELEMENTARY = {(1, 1): "cylinder", (0, 1): "birth", (1, 0): "death", (2, 1): "join", (1, 2): "split"}


def check_levels(facts, ledger):
    """Levels ascend, and their counts of vertices below are those of their cuts."""
    t = facts.columns.levels
    height, below, tie_x, tie_y = t["height"], t["vertices_below"].astype(np.int64), t["tie_x"], t["tie_y"]
    ledger.enter("levels_ascend", bool((np.diff(height) >= 0).all() and (np.diff(below) >= 0).all()), True)
    low, high = count_below(facts.surface, height, tie_x, tie_y)
    inside = (low <= below) & (below <= high) & (below < facts.surface.weight[-1])
    inside &= np.isnan(tie_x) == np.isnan(tie_y)
    ledger.rows("levels.vertices_below", inside, "vertices that are not above the level")
    rows = {name: getattr(facts.columns, name)["level"] for name in ("contours", "nodes")}
    counted = {name: np.bincount(level, minlength=len(height)) for name, level in rows.items()}
    ledger.compare(
        "levels", t,
        ("n_contours", counted["contours"], "rows of contours"),
        ("n_regions", counted["nodes"], "rows of nodes"),
    )  # fmt: skip
    _check_uniform(facts, ledger, height, np.isnan(tie_x))
    facts.levels = {"height": height, "below": below, "planes": np.stack([height, tie_x, tie_y], axis=1)}


def _check_uniform(facts, ledger, height, plain):
    """The levels that are called uniform, and no others, are equispaced over the heights of the surface."""
    uniform, z = np.flatnonzero(facts.columns.levels["why"] == "uniform"), facts.surface.points[:, 2]
    n = len(uniform)
    places = z[0] + (z[-1] - z[0]) * (np.arange(n) + 0.5) / max(n, 1)
    holds = plain[uniform] & (np.abs(height[uniform] - places) <= facts.noise)
    ledger.rows("levels.why", holds if n else [False], "equispaced, half a step inside both ends")


def check_contours(facts, ledger):
    """One contour per component of crossings, no more and no fewer."""
    t = facts.columns.contours
    facts.curves, drawn = facts.read_curves or read_curves(t["geometry"].chunks)
    drawn = drawn if len(drawn) == len(t["contour"]) else np.zeros(len(t["contour"]), bool)
    ledger.rows("contours.geometry", drawn, "a closed line string in the plane")
    if not drawn.all():
        return
    split, below = _unfold(facts, ledger)
    facts.split, facts.split_sides = split, facts.sides if split is facts.surface else find_mesh_edges(split)
    anchors = {end: t[end].astype(np.int64) for end in ("level", "lower_vertex", "upper_vertex")}
    facts.walls = find_walls(split, below, facts.void, facts.body)
    asked = np.array(sorted(facts.walls.values(), key=lambda wall: wall[1]), np.int64).reshape(-1, 2).T
    doubled = copies(split).astype(np.int64) - 1
    levels = facts.levels | {"below": below}
    facts.recount = found = recount(split, facts.split_sides, levels, anchors, doubled, asked)
    facts.exact = ExactLevels(split, facts.split_sides, below, t["level"], found.side)
    ledger.rows("contours.anchors", found.anchored, "one contour of the mesh per row")
    counted = np.bincount(t["level"], minlength=len(below))
    ledger.rows("contours_per_level", found.n_contours == counted, "components of crossings")
    ledger.compare(
        "contours", t,
        ("shell", found.shell, "shell of the faces it crosses"),
        ("n_points", found.n_points, "mesh edges crossed", found.loose),
    )  # fmt: skip


def _unfold(facts, ledger):
    """The surface with the saddles split between whose copies a level runs, and its vertices below each level."""
    t, surface, below = facts.columns.unfoldings, facts.surface, facts.levels["below"]
    folded = find_folded(surface, below)
    vertex, ranks = list_copies(surface, folded)
    witness = Witness(*(facts.rank[t[column]] for column in Witness._fields))
    for column, values in (("rank", ranks), ("vertex", surface.origin[vertex])):
        ledger.enter(f"unfoldings.{column}", np.array_equal(t[column], values), True)
    split, below, odd = unfold(surface, below, folded, witness)
    says = "Wedges of the vertex's link, each taken once, at which the surface does not cross itself."
    ledger.enter("saddles_that_no_unfolding_fits", len(odd), 0, says=says if odd else "")
    return split, below


def check_curves(facts, ledger):
    """Curves, areas and perimeters are those of the mesh at the level."""
    t, found = facts.columns.contours, facts.recount
    area, perimeter, facts.centres, facts.boxes = measure_curves(*facts.curves)
    facts.drawn_area, facts.drawn_perimeter = area, perimeter
    facts.slack = facts.noise * (found.perimeter + facts.noise)
    rooms = facts.slack + 1e-9 * np.abs(found.area), 1e-9 * found.perimeter + facts.noise * found.n_points
    ledger.compare(
        "contours", t,
        ("height", facts.levels["height"][t["level"]], "height of the level"),
        ("signed_area", found.area, "signed_area counted on the mesh", rooms[0]),
        ("perimeter", found.perimeter, "perimeter counted on the mesh", rooms[1]),
    )  # fmt: skip
    ledger.compare(
        "contours.geometry", {"signed_area": area, "perimeter": perimeter},
        ("signed_area", found.area, "signed_area of the curve", rooms[0]),
        ("perimeter", found.perimeter, "perimeter of the curve", rooms[1]),
    )  # fmt: skip
    low, high = facts.rank[t["lower_vertex"]], facts.rank[t["upper_vertex"]]
    spots = cross(facts.surface, low, high, facts.levels["planes"][t["level"]])
    _, near = look(*facts.curves, np.arange(len(spots)), spots, 2 * facts.noise)
    ledger.rows("contours.position", (low == high) | (near <= facts.noise), "the curve passes its anchor")
    if facts.distance is not None:
        z = facts.surface.points[[0, -1], 2]
        gap = np.diff(np.concatenate([z[:1], facts.levels["height"], z[1:]])).max()
        holds = gap <= facts.distance * (1 + 1e-9) + facts.noise
        ledger.enter("largest_gap_between_levels", gap, f"at most {facts.distance:.9g}", holds)


def check_pieces(facts, ledger):
    """One piece per component of cells, with the same contours, shape and measures."""
    t, found = facts.columns.pieces, facts.recount
    n = len(found.slab)
    ledger.enter("number_of_pieces", len(t["piece"]), n)
    row = _match_pieces(t, found)
    if not np.array_equal(np.sort(row), np.arange(n)):
        raise ValueError("the table of pieces does not name each piece of the mesh once")
    ends = list_members(found.above, n), list_members(found.below, n)
    same = [[below, above] == [end[k] for end in ends] for below, above, k in zip(t["below"], t["above"], row)]
    ledger.rows("pieces.contours", same, "contours below and above")
    to_row = np.argsort(row)
    facts.recount = found = found._replace(
        **{column: getattr(found, column)[row] for column in ("slab", "piece_shell", "euler", "piece_area", "flux")},
        **{column: to_row[getattr(found, column)] for column in ("above", "below", "piece_of_vertex", "piece_of_cell")},
    )
    ends = facts.piece_ends = tuple(np.bincount(of, minlength=n) for of in (found.above, found.below))
    facts.piece_genus = (2 - sum(ends) - found.euler) // 2
    facts.kinds = np.array([_kind(*shape) for shape in zip(*(v.tolist() for v in (*ends, facts.piece_genus)))], object)
    facts.elementary = (facts.kinds != "compound") & (facts.kinds != "unseen")
    facts.hidden = int(facts.piece_genus.sum())
    _check_measures(facts, ledger, t, found)
    _check_essential(facts, ledger, t, found)


def _match_pieces(t, found):
    """The recounted piece of each row of the table, -1 for none: by a contour, or by shell where it has none."""
    closed = np.setdiff1d(np.arange(len(found.slab)), np.concatenate([found.above, found.below]))
    of_shell = dict(zip(found.piece_shell[closed].tolist(), closed.tolist()))
    rows = zip(t["below"], t["above"], t["shell"].tolist())
    return np.array(
        [
            found.above[below[0]] if below else found.below[above[0]] if above else of_shell.get(shell, -1)
            for below, above, shell in rows
        ]
    )


def _kind(n_below, n_above, genus):
    """The kind of a piece by its contours below and above and its genus."""
    if n_below + n_above == 0:
        return "unseen"
    return ELEMENTARY.get((n_below, n_above), "compound") if genus == 0 else "compound"


def _check_measures(facts, ledger, t, found):
    """Columns of the pieces that are counted or measured."""
    n_below, n_above = facts.piece_ends
    counted = {
        "slab": found.slab, "shell": found.piece_shell, "n_below": n_below, "n_above": n_above,
        "euler_characteristic": found.euler, "genus": facts.piece_genus, "kind": facts.kinds,
    }  # fmt: skip
    rooms = facts.area_noise + 1e-7 * found.piece_area, facts.volume_noise + 1e-7 * np.abs(found.flux)
    ledger.compare(
        "pieces", t,
        *((name, values, f"{name} counted on the mesh") for name, values in counted.items()),
        ("area", found.piece_area, "area of its cells", rooms[0]),
        ("flux", found.flux, "flux of its cells", rooms[1]),
    )  # fmt: skip
    odd = ((n_below + n_above + found.euler) % 2).sum() + (facts.piece_genus < 0).sum()
    ledger.enter("genus_of_pieces_is_whole", int(odd), 0)


def _check_essential(facts, ledger, t, found):
    """The essential critical points of each piece, by the elder rule once more."""
    split = facts.split
    count, pairs = essential_points(split, facts.split_sides, found)
    facts.cancelled = np.abs(np.diff(split.points[pairs, 2]))  # what the graph does not show, in mesh units
    vertices = np.repeat(np.arange(len(count)), count)
    members = list_members(found.piece_of_vertex[vertices], len(found.slab), split.origin[vertices])
    ledger.compare("pieces", t, ("critical", members, "vertices that the elder rule leaves"))
    ledger.enter("sum_of_vertex_indices", int((1 - facts.surface.changes // 2).sum()), facts.euler)
    ranks, stated = (np.array([v for row in t[name] for v in row], np.int64) for name in ("critical_ranks", "critical"))
    same = [len(a) == len(b) for a, b in zip(t["critical"], t["critical_ranks"])]
    same = all(same) and np.array_equal(_surface_vertices(facts, ranks), stated) and len(np.unique(ranks)) == len(ranks)
    ledger.enter("pieces.critical_ranks", bool(same), True)


def _surface_vertices(facts, ranks):
    """The surface vertex of ranks that count every copy of a multiple saddle; -1 for none."""
    origin, weight = facts.surface.origin, facts.surface.weight
    place = np.searchsorted(weight, ranks.astype(weight.dtype), side="right") - 1
    known = (place >= 0) & (place < len(origin))
    return np.where(known, origin[np.clip(place, 0, len(origin) - 1)], -1)
