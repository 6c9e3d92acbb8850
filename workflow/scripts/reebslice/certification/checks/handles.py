"""Checks of the events: handles, their changes, their sides.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np
import shapely

from ...schemas import EVENTS
from ..recount.sides import local_sides

INDEX_OF_KIND = {"birth": 0, "death": 2, "join": 1, "split": 1}


def check_handles(facts, ledger):
    """One handle per essential critical point, at its vertex, of the event that the contours show."""
    t, pieces = facts.columns.handles, facts.columns.pieces
    vertex, piece = t["vertex"], t["piece"]
    expected = sorted(rank for ranks in pieces["critical_ranks"] for rank in ranks)
    ledger.enter("handles.rank", t["rank"].tolist() == expected, True)
    owner = {
        rank: (p, v)
        for p, both in enumerate(zip(pieces["critical_ranks"], pieces["critical"]))
        for rank, v in zip(*both)
    }
    placed = [owner.get(r) == (p, v) for r, p, v in zip(t["rank"].tolist(), piece.tolist(), vertex.tolist())]
    ledger.rows("handles.vertex", placed, "the critical point of its piece")
    ledger.rows(
        "handles.position",
        np.all([column[vertex] == t[axis] for column, axis in zip(facts.points, "xyz")], axis=0),
        "position of the vertex",
    )
    ledger.rows("handles.height", t["height"] == facts.surface.points[facts.rank[vertex], 2], "height of the vertex")
    for name, values in (("slab", facts.slab), ("block", facts.block)):
        ledger.rows(f"handles.{name}", t[name] == values[piece], f"{name} of the piece")
    ledger.rows(
        "handles.index", t["index"] == facts.surface.index[facts.rank[vertex]], "sign changes around the vertex"
    )
    held = np.bincount(piece, minlength=len(facts.kinds))
    wanted = np.array(
        [_essentials(*ends) for ends in zip(*(e.tolist() for e in facts.piece_ends), facts.piece_genus.tolist())]
    )
    wanted = np.stack([np.bincount(piece[t["index"] == i], minlength=len(held)) for i in range(3)], axis=1) == wanted
    ledger.rows("pieces.handles", wanted.all(axis=1), "critical points by index that its shape needs")
    _check_events(facts, ledger, t, piece)
    _check_persistence(facts, ledger, t)
    chains = np.array([_is_chain(facts, b) for b in range(facts.n_blocks)], bool)
    facts.chains = chains
    facts.block_resolved = np.array([len(h) <= 1 for h in facts.handles_of_block], bool) | chains
    for end, regions in (("below", facts.block_above), ("above", facts.block_below)):
        members = [[] for _ in range(facts.n_blocks)]
        for region, b in enumerate(regions.tolist()):
            members[b].append(region)
        same = [a == members[b] for a, b in zip(t[f"regions_{end}"], t["block"].tolist())]
        ledger.rows(f"handles.regions_{end}", same, f"regions {end} the block")


def _essentials(n_below, n_above, genus):
    """Critical points of index 0, 1, 2 that a piece cannot do without."""
    saddles = max(n_below, 1) + max(n_above, 1) - 2 + 2 * genus
    return (n_below == 0, saddles, n_above == 0) if (n_below, n_above, genus) != (1, 1, 0) else (0, 0, 0)


def _check_events(facts, ledger, t, piece):
    """Changes, sides, operations, counts of contours of the elementary pieces."""
    inner = np.asarray(facts.columns.contours["inner"], bool)
    pieces = facts.columns.pieces
    changes = [_change(inner, a, b) for a, b in zip(pieces["below"], pieces["above"])]
    resolved = facts.elementary & np.array([c in EVENTS for c in changes], bool)
    eventful = facts.elementary & (facts.kinds != "cylinder")
    ledger.rows("pieces.change", ~eventful | resolved, "one of the twelve events")
    facts.change = changes
    expected = [changes[p] if resolved[p] else None for p in piece.tolist()]
    ledger.rows("handles.change", [a == b for a, b in zip(t["change"], expected)], "signs of the contours of its piece")
    ledger.rows("handles.resolved", t["resolved"] == resolved[piece], "its piece is elementary")
    for end in ("below", "above"):
        same = [sorted(a) == sorted(pieces[end][p]) for a, p in zip(t[f"contours_{end}"], piece.tolist())]
        ledger.rows(f"handles.contours_{end}", same, f"contours {end} its piece")
    events = [EVENTS.get(change) for change in t["change"]]
    for name, place in (("side", 0), ("index", 1), ("operation", 5)):
        same = [e is None or e[place] == v for e, v in zip(events, t[name])]
        ledger.rows(f"handles.{name}_of_change", same, f"{name} of the event")
    ledger.rows(
        "handles.branches",
        [b == (e is None or e[4] != 0) for b, e in zip(t["branches"], events)],
        "the number of regions changes",
    )
    wanted = [INDEX_OF_KIND.get(facts.kinds[p]) for p in piece.tolist()]
    fits = [w is None or w == i for w, i in zip(wanted, t["index"].tolist())]
    ledger.rows("handles.index_of_kind", fits, "index by the contours below and above")


def _change(inner, below, above):
    """The word of a change, such as o->i,o, from the contours below and above."""
    sides = (sorted("i" if inner[c] else "o" for c in end) for end in (below, above))
    return "->".join(",".join(end) for end in sides)


def _check_persistence(facts, ledger, t):
    """Persistence and partner, against the exact graph, which was checked before."""
    points = facts.columns.critical_points
    place = np.searchsorted(points["rank"], t["rank"])
    ledger.rows("handles.persistence", t["persistence"] == points["persistence"][place], "that of the critical point")
    handle = dict(zip(t["rank"].tolist(), t["handle"].tolist()))
    partner = points["rank"][points["partner"][place]].tolist()
    ledger.rows("handles.pair", [p == handle.get(r) for p, r in zip(t["pair"], partner)], "the handle of the partner")
    stated = [handle.get(rank) for rank in points["rank"].tolist()]
    ledger.rows("critical_points.handle", [a == b for a, b in zip(points["handle"], stated)], "the handle of that rank")


def _is_chain(facts, block):
    """Whether a block holds one region throughout and only events that leave it whole."""
    handles = facts.handles_of_block[block]
    changes = [facts.columns.handles["change"][h] for h in handles]
    whole = all(c in EVENTS and EVENTS[c][4] == 0 for c in changes)
    return bool(whole and (facts.block_above == block).sum() == 1 == (facts.block_below == block).sum())


def check_sides(facts, ledger):
    """Sides from the geometry around each critical point, against those of the events.

    Where a contour next to the critical point crosses itself, material has no
    side that both could agree on; such handles are counted, and the
    interpretation of the solid tells.
    """
    t = facts.columns.handles
    places, place = np.unique(facts.rank[t["vertex"]].astype(np.int64), return_inverse=True)
    local = local_sides(facts.surface, places)[place]
    agree = local == t["side"]
    tangled = np.zeros(len(local), bool)
    for handle in np.flatnonzero((local != "") & ~agree).tolist():
        bounding = t["contours_below"][handle] + t["contours_above"][handle]
        tangled[handle] = not shapely.is_simple(facts.curves.lines(bounding)).all()
    decided = (local != "") & ~tangled
    differ = np.flatnonzero(decided & ~agree)
    says = f"Handle {differ[0]} is the first that differs." if len(differ) else ""
    ledger.enter("sides_by_local_geometry", [int(agree.sum()), len(differ)], [int(decided.sum()), 0], says=says)
    facts.open["sides that the geometry leaves open"] = (~decided).sum()
    facts.crossing |= bool(tangled.any())
