"""Checks of the slices: levels, contours and their curves, pieces.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np

from ..recount.crossings import cross
from ..recount.curves import measure_curves, pass_spots, read_curves
from ..recount.cut_surface import count_below, recount
from ..recount.elders import essential_points
from ..recount.exact_levels import ExactLevels
from ..recount.surface import copies, find_mesh_edges
from ..recount.unfoldings import Witness, find_folded, list_copies, unfold

ELEMENTARY = {(1, 1): "cylinder", (0, 1): "birth", (1, 0): "death", (2, 1): "join", (1, 2): "split"}


def check_levels(facts, ledger):
    """Levels ascend, and their counts of vertices below are those of their cuts."""
    t = facts.columns.levels
    height, below = t["height"], t["vertices_below"].astype(np.int64)
    tie_x = np.array([np.nan if v is None else v for v in t["tie_x"]], float)
    tie_y = np.array([np.nan if v is None else v for v in t["tie_y"]], float)
    total = int(facts.surface.weight[-1])
    ascending = bool((np.diff(height) >= 0).all() and (np.diff(below) >= 0).all())
    ledger.enter("levels_ascend", ascending, True)
    low, high = count_below(facts.surface, height, tie_x, tie_y)
    inside = (low <= below) & (below <= high) & (below < total) & (np.isnan(tie_x) == np.isnan(tie_y))
    ledger.rows("levels.vertices_below", inside, "vertices that are not above the level")
    counted = np.bincount(facts.columns.contours["level"], minlength=len(height))
    ledger.rows("levels.n_contours", t["n_contours"] == counted, "rows of contours")
    regions = np.bincount(facts.columns.nodes["level"], minlength=len(height))
    ledger.rows("levels.n_regions", t["n_regions"] == regions, "rows of nodes")
    _check_uniform(facts, ledger, height, np.isnan(tie_x))
    facts.levels = {"height": height, "below": below, "tie_x": tie_x, "tie_y": tie_y}


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
    anchors = {"level": t["level"].astype(np.int64)}
    anchors |= {end: t[f"{end}_vertex"].astype(np.int64) for end in ("lower", "upper")}
    doubled = copies(split).astype(np.int64) - 1
    facts.recount = found = recount(split, facts.split_sides, facts.levels | {"below": below}, anchors, doubled)
    facts.exact = ExactLevels(split, facts.split_sides, below, t["level"], found.side)
    ledger.rows("contours.anchors", found.anchored, "one contour of the mesh per row")
    counted = np.bincount(t["level"], minlength=len(below))
    ledger.rows("contours_per_level", found.n_contours == counted, "components of crossings")
    ledger.rows("contours.shell", t["shell"] == found.shell, "shell of the faces it crosses")
    ledger.rows("contours.n_points", np.abs(t["n_points"] - found.n_points) <= found.loose, "mesh edges crossed")


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
    ledger.rows("contours.height", t["height"] == facts.levels["height"][t["level"]], "height of the level")
    area, perimeter, facts.centres, facts.boxes = measure_curves(*facts.curves)
    facts.drawn_area, facts.drawn_perimeter = area, perimeter
    slack = facts.noise * (found.perimeter + facts.noise)
    for name, values, mesh in (("signed_area", area, found.area), ("perimeter", perimeter, found.perimeter)):
        room = slack + 1e-9 * np.abs(mesh) if name == "signed_area" else 1e-9 * mesh + facts.noise * found.n_points
        ledger.rows(f"contours.{name}", np.abs(t[name] - mesh) <= room, f"{name} counted on the mesh")
        ledger.rows(f"contours.geometry.{name}", np.abs(values - mesh) <= room, f"{name} of the curve")
    _check_positions(facts, ledger, t)
    _check_gaps(facts, ledger)


def _check_gaps(facts, ledger):
    """Levels lie at most the wanted distance apart."""
    if facts.distance is None:
        return
    z = facts.surface.points[:, 2]
    gaps = np.diff(np.concatenate([[z[0]], facts.levels["height"], [z[-1]]]))
    holds = gaps.max() <= facts.distance * (1 + 1e-9) + facts.noise
    ledger.enter("largest_gap_between_levels", gaps.max(), f"at most {facts.distance:.9g}", holds)


def _check_positions(facts, ledger, t):
    """Every curve passes through the crossing at its anchor."""
    low, high, level = facts.rank[t["lower_vertex"]], facts.rank[t["upper_vertex"]], t["level"]
    spots = cross(facts.surface, low, high, *(facts.levels[k][level] for k in ("height", "tie_x", "tie_y")))
    single = low != high
    passes = pass_spots(*facts.curves, spots, facts.noise)
    ledger.rows("contours.position", ~single | passes, "the curve passes its anchor")


def check_pieces(facts, ledger):
    """One piece per component of cells, with the same contours, shape and measures."""
    t, found = facts.columns.pieces, facts.recount
    n, n_contours = len(t["piece"]), len(found.anchored)
    ledger.enter("number_of_pieces", n, len(found.slab))
    below, above = _bounded_by(t["above"], n_contours), _bounded_by(t["below"], n_contours)
    ledger.enter("contours_bound_one_piece_each_way", below is not None and above is not None, True)
    if below is None or above is None:
        raise ValueError("some contour bounds no piece, or several, on one of its sides")
    name = _match_pieces(t, found, below, above)
    met = np.bincount(name[name >= 0], minlength=n) == 1
    ledger.rows("pieces.contours", met & _ends_agree(name, found, below, above, n), "contours below and above")
    if not met.all():
        raise ValueError(f"piece {np.flatnonzero(~met)[0]} of the table is no piece of the mesh")
    facts.piece, facts.below, facts.above = name, below, above
    _measure_pieces(facts, np.argsort(name))
    _check_measures(facts, ledger, t)
    _check_essential(facts, ledger, t)


def _measure_pieces(facts, row):
    """What is counted of each piece, in the order of the table; row : (P,) the recounted piece of each of its rows."""
    found = facts.recount
    ends = facts.piece_ends = tuple(np.bincount(c, minlength=len(row))[row] for c in (found.above, found.below))
    facts.slab, facts.piece_shell, facts.piece_euler = found.slab[row], found.piece_shell[row], found.euler[row]
    facts.piece_area, facts.piece_flux = found.piece_area[row], found.flux[row]
    facts.piece_genus = (2 - sum(ends) - facts.piece_euler) // 2
    facts.kinds = np.array([_kind(*shape) for shape in zip(*(v.tolist() for v in (*ends, facts.piece_genus)))], object)
    facts.elementary = (facts.kinds != "compound") & (facts.kinds != "unseen")
    facts.hidden = int(facts.piece_genus.sum())


def _check_measures(facts, ledger, t):
    """Columns of the pieces that are counted or measured."""
    n_below, n_above = facts.piece_ends
    for column, values in (
        ("slab", facts.slab), ("shell", facts.piece_shell), ("n_below", n_below), ("n_above", n_above),
        ("euler_characteristic", facts.piece_euler), ("genus", facts.piece_genus), ("kind", facts.kinds),
    ):  # fmt: skip
        ledger.rows(f"pieces.{column}", t[column] == values, f"{column} counted on the mesh")
    odd = ((n_below + n_above + facts.piece_euler) % 2).sum() + (facts.piece_genus < 0).sum()
    ledger.enter("genus_of_pieces_is_whole", int(odd), 0)
    for column, values, noise in (
        ("area", facts.piece_area, facts.area_noise),
        ("flux", facts.piece_flux, facts.volume_noise),
    ):
        room = noise + 1e-7 * np.abs(values)
        ledger.rows(f"pieces.{column}", np.abs(t[column] - values) <= room, f"{column} of its cells")


def _bounded_by(lists, n_contours):
    """The row whose list each contour is in, or None unless it is in exactly one."""
    flat = np.array([c for members in lists for c in members], np.int64)
    rows = np.repeat(np.arange(len(lists)), [len(members) for members in lists])
    if not np.array_equal(np.bincount(flat, minlength=n_contours), np.ones(n_contours, int)):
        return None
    out = np.empty(n_contours, np.int64)
    out[flat] = rows
    return out


def _match_pieces(t, found, below, above):
    """The row of each recounted piece: by a contour, or by shell where it has none."""
    name = np.full(len(found.slab), -1)
    name[found.below], name[found.above] = below, above
    closed = {
        int(t["shell"][row]): row for row in range(len(t["piece"])) if not t["below"][row] and not t["above"][row]
    }
    for piece in np.flatnonzero(name < 0).tolist():
        name[piece] = closed.get(int(found.piece_shell[piece]), -1)
    return name


def _ends_agree(name, found, below, above, n):
    """Rows whose every contour bounds the piece that the mesh says."""
    holds = np.ones(n, bool)
    for ends, rows in ((found.below, below), (found.above, above)):
        wrong = name[ends] != rows
        holds[rows[wrong]] = False
        holds[name[ends[wrong]]] = False
    return holds


def _kind(n_below, n_above, genus):
    """The kind of a piece by its contours below and above and its genus."""
    if n_below + n_above == 0:
        return "unseen"
    return ELEMENTARY.get((n_below, n_above), "compound") if genus == 0 else "compound"


def _check_essential(facts, ledger, t):
    """The essential critical points of each piece, by the elder rule once more."""
    count, pairs = essential_points(facts.split, facts.split_sides, facts.recount)
    z = facts.split.points[:, 2]
    facts.cancelled = np.abs(z[pairs[:, 0]] - z[pairs[:, 1]])  # what the graph does not show, in mesh units
    vertices = np.repeat(np.arange(len(count)), count)
    members = [[] for _ in t["piece"]]
    for vertex, piece in zip(vertices.tolist(), facts.piece[facts.recount.piece_of_vertex[vertices]].tolist()):
        members[piece].append(int(facts.split.origin[vertex]))
    ledger.rows(
        "pieces.critical", [a == b for a, b in zip(t["critical"], members)], "vertices that the elder rule leaves"
    )
    ledger.enter("sum_of_vertex_indices", int((1 - facts.surface.changes // 2).sum()), facts.euler)
    ranks = [rank for ranks in t["critical_ranks"] for rank in ranks]
    decoded = _surface_vertices(facts, np.array(ranks, np.int64))
    flat = [vertex for vertices in t["critical"] for vertex in vertices]
    lengths = [len(a) == len(b) for a, b in zip(t["critical"], t["critical_ranks"])]
    same = all(lengths) and decoded.tolist() == flat and len(set(ranks)) == len(ranks)
    ledger.enter("pieces.critical_ranks", bool(same), True)


def _surface_vertices(facts, ranks):
    """The surface vertex of ranks that count every copy of a multiple saddle; -1 for none."""
    origin, weight = facts.surface.origin, facts.surface.weight
    place = np.searchsorted(weight, ranks.astype(weight.dtype), side="right") - 1
    known = (place >= 0) & (place < len(origin))
    return np.where(known, origin[np.clip(place, 0, len(origin) - 1)], -1)
