"""Checks of the events: handles, their changes, their sides.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np
import shapely

from ...schemas import EVENTS
from ..recount.ranges import list_members
from ..recount.sides import local_sides

INDEX_OF_KIND = {"birth": 0, "death": 2, "join": 1, "split": 1}


def check_handles(facts, ledger):
    """One handle per essential critical point, at its vertex, of the event that the contours show."""
    t, pieces = facts.columns.handles, facts.columns.pieces
    vertex, piece, place = t["vertex"], t["piece"], facts.rank[t["vertex"]]
    owner = {
        rank: (p, v)
        for p, both in enumerate(zip(pieces["critical_ranks"], pieces["critical"]))
        for rank, v in zip(*both)
    }
    ledger.enter("handles.rank", t["rank"].tolist() == sorted(owner), True)
    placed = [owner.get(r) == (p, v) for r, p, v in zip(t["rank"].tolist(), piece.tolist(), vertex.tolist())]
    ledger.rows("handles.vertex", placed, "the critical point of its piece")
    here = np.all([column[vertex] == t[axis] for column, axis in zip(facts.points, "xyz")], axis=0)
    ledger.rows("handles.position", here, "position of the vertex")
    regions = [list_members(block, facts.n_blocks) for block in (facts.block_above, facts.block_below)]
    ledger.compare(
        "handles", t,
        ("height", facts.surface.points[place, 2], "height of the vertex"),
        ("slab", facts.recount.slab[piece], "slab of the piece"),
        ("block", facts.block[piece], "block of the piece"),
        ("index", facts.surface.index[place], "sign changes around the vertex"),
        ("contours_below", [pieces["below"][p] for p in piece.tolist()], "contours below its piece"),
        ("contours_above", [pieces["above"][p] for p in piece.tolist()], "contours above its piece"),
        ("regions_below", [regions[0][b] for b in t["block"].tolist()], "regions below the block"),
        ("regions_above", [regions[1][b] for b in t["block"].tolist()], "regions above the block"),
    )  # fmt: skip
    below, above = facts.piece_ends
    needed = below == 0, np.maximum(below, 1) + np.maximum(above, 1) - 2 + 2 * facts.piece_genus, above == 0
    held = [np.bincount(piece[t["index"] == i], minlength=len(below)) for i in range(3)]
    ledger.rows("pieces.handles", np.all(np.equal(held, needed), axis=0), "critical points by index its shape needs")
    _check_events(facts, ledger, t, piece)
    _check_persistence(ledger, t, facts.columns.critical_points)
    _find_chains(facts, t)


def _check_events(facts, ledger, t, piece):
    """Change, operation and side of the handles, from the contours of the elementary pieces."""
    pieces, letter = facts.columns.pieces, np.where(facts.columns.contours["inner"], "i", "o").tolist()
    facts.change = [
        "->".join(",".join(sorted(letter[c] for c in end)) for end in ends)
        for ends in zip(pieces["below"], pieces["above"])
    ]
    resolved = facts.elementary & np.array([change in EVENTS for change in facts.change], bool)
    ledger.rows("pieces.change", resolved | ~facts.elementary | (facts.kinds == "cylinder"), "one of the twelve events")
    events = [EVENTS.get(change) for change in t["change"]]
    ledger.compare(
        "handles", t,
        ("change", np.where(resolved, facts.change, None)[piece], "signs of the contours of its piece"),
        ("resolved", resolved[piece], "its piece is elementary"),
        ("branches", [e is None or e[4] != 0 for e in events], "the number of regions changes"),
    )  # fmt: skip
    for name, k in (("side", 0), ("index", 1), ("operation", 5)):
        same = [e is None or e[k] == value for e, value in zip(events, t[name])]
        ledger.rows(f"handles.{name}_of_change", same, f"{name} of the event")
    fits = [INDEX_OF_KIND.get(kind, index) == index for kind, index in zip(facts.kinds[piece], t["index"])]
    ledger.rows("handles.index_of_kind", fits, "index by the contours below and above")


def _check_persistence(ledger, t, points):
    """Persistence and partner, against the exact graph, which was checked before."""
    place, handle = np.searchsorted(points["rank"], t["rank"]), np.full(len(points["rank"]), -1)
    handle[place] = t["handle"]
    ledger.compare(
        "handles", t,
        ("persistence", points["persistence"][place], "that of the critical point"),
        ("pair", handle[points["partner"][place]], "the handle of the partner"),
    )  # fmt: skip
    ledger.compare("critical_points", points, ("handle", handle, "the handle of that rank"))


def _find_chains(facts, t):
    """Find the blocks that hold one region throughout and only events that leave it whole, and those in order."""
    breaks = [change not in EVENTS or EVENTS[change][4] != 0 for change in t["change"]]
    ends = (t["block"][np.array(breaks, bool)], facts.block_above, facts.block_below, t["block"])
    broken, below, above, held = (np.bincount(block, minlength=facts.n_blocks) for block in ends)
    facts.chains = (broken == 0) & (below == 1) & (above == 1)
    facts.block_resolved = facts.chains | (held <= 1)


def check_sides(facts, ledger):
    """Sides from the geometry around each critical point, against those of the events.

    Where a contour next to the critical point crosses itself, material has no
    side that both could agree on; such handles are counted, and the
    interpretation of the solid tells.
    """
    t = facts.columns.handles
    places, place = np.unique(facts.rank[t["vertex"]], return_inverse=True)
    local = np.array(local_sides(facts.surface, places.tolist()), object)[place]
    agree, tangled = local == t["side"], np.zeros(len(local), bool)
    for handle in np.flatnonzero((local != "") & ~agree).tolist():
        bounding = t["contours_below"][handle] + t["contours_above"][handle]
        tangled[handle] = not shapely.is_simple(facts.curves.lines(bounding)).all()
    decided = (local != "") & ~tangled
    differ = np.flatnonzero(decided & ~agree)
    says = f"Handle {differ[0]} is the first that differs." if len(differ) else ""
    ledger.enter("sides_by_local_geometry", [int(agree.sum()), len(differ)], [int(decided.sum()), 0], says=says)
    facts.open["sides that the geometry leaves open"] = (~decided).sum()
    facts.crossing |= bool(tangled.any())
