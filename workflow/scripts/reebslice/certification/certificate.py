"""The proof per model: every invariant, recomputed and held against the tables.

A check compares what the tables say (`found`) with what follows from the
mesh, the levels and the theory (`expected`). The certificate lists them all;
one that fails makes the model uncertified. Nothing here, in `checks` or in
`recount` uses the code that made the tables.
"""

import numpy as np
import pyarrow as pa
import shapely

from .checks import arcs, critical_points, form, handles, links, places, regions, slices, surface
from .checks import graphs as graph_checks
from .checks.graphs import doubts_void
from .facts import Facts
from .graphml import ReadGraph
from .ledger import Ledger

# What a table that contradicts itself can make numpy, shapely or a lookup say.
CONTRADICTIONS = (ValueError, KeyError, IndexError, TypeError, shapely.errors.ShapelyError)

# In this order, because each step builds on those before it.
STEPS = (
    form.check_form,
    surface.check_mesh,
    surface.check_tilt,
    slices.check_levels,
    slices.check_contours,
    slices.check_curves,
    slices.check_pieces,
    critical_points.check_critical,
    regions.check_holes,
    regions.check_blocks,
    handles.check_handles,
    handles.check_sides,
    links.check_nodes,
    links.check_edges,
    places.check_places,
    arcs.check_arcs,
    graph_checks.check_graphs,
    graph_checks.check_identities,
    critical_points.check_simplified,
)
# Without these there is nothing that the later steps could be about.
FOUNDATIONS = (form.check_form, surface.check_mesh, slices.check_levels, slices.check_contours)

APART = (
    "Bodies lie inside or across one another. Each body is taken as a solid of its own and the solid as their "
    "disjoint union: volumes add up, and material that two bodies share counts twice."
)
CROSSING = (
    "The surface crosses itself. The solid is taken sheet by sheet as the surface bounds it: a contour is outer or a "
    "hole by the sign of its whole area, and material where sheets overlap counts as often as they do."
)

TOLD = "So inspection.json states, which counts {} pairs of faces and tells where the first of them meet."

CROSSES = (
    "The surface crosses itself; take the parts that cross apart, or unite them, in the program that made the mesh."
)
UNRESOLVED = (
    "Between two levels lie critical points of {:.6g} or more, the feature size, whose order the graph does not show; "
    "take a smaller distance, or levels: {{refine: exact}}."
)
VOID_CROSSED = "The surface crosses itself, so contours may not tell what is void; take the parts that cross apart."
VOID_SHARED = (
    "Bodies share material or touch, so contours may not tell what is void; inspect: {overlaps: union} unites them."
)
NO_VOID = " The void has no graph here."
HEURISTIC = "Links by a heuristic are not certified; take edges: {method: exact}."
DIFFERENT = (
    "The results do not fit the mesh; delete the model's folder in results/models and start again, and if it fails "
    "again, report it."
)

BY_SOS = (
    "Neighbouring vertices have one height, or differ by no more than rounding. The graphs are those of the height "
    "tilted by an infinitesimal amount towards x of the tilted frame, and by an infinitesimal part of that towards y "
    "(simulation of simplicity): exact for it, and for every real tilt of that kind that is small enough."
)


def certify(
    tables: dict[str, pa.Table],
    tilt: dict,
    graphs: dict[str, ReadGraph],
    feature_size: float,
    distance: float | None = None,
    curves: tuple | None = None,
    inspection: dict | None = None,
    model: str | None = None,
) -> dict:
    """Make the certificate of one model.

    Parameters
    ----------
    tables : dict of pyarrow.Table
        All of `schemas.MODEL_TABLES`, as `schemas` declares them.
    tilt : dict
        The content of tilt.json.
    graphs : dict of ReadGraph
        By the names in `schemas.GRAPHS`.
    feature_size : float
        In mesh units; what is smaller may stay unresolved in a model that is `exact_at_feature_size`.
    distance : float, optional
        In mesh units; the largest spacing of uniform levels.
    curves : tuple, optional
        What :func:`recount.curves.read_curves` tells of the contours; then their table is without `geometry`.
    inspection : dict, optional
        The content of inspection.json. Of it are taken, as stated, the numbers of pairs of faces that cross:
        `self_crossings`, of one body, and `body_crossings`, of two; and the `unit`, which the graphs repeat.
    model : str, optional
        Its id, which the graphs repeat.

    Returns
    -------
    dict
        That JSON can hold: `verdict`, `reason` (why it is uncertified and what
        to do, else empty), `void_verdict` and `void_reason`, the same of the
        void's graph, figures (None where unknown) and `checks`, each by name
        with its two sides.

    Notes
    -----
    Never raises on account of the tables: what contradicts itself so badly
    that a step cannot be made is a check that fails, and the steps that build
    on it are entered as not made.

    Examples
    --------
    What the stages of the workflow write is certified by `workflow/scripts/certify.py`. Nothing is not:

    >>> certificate = certify({}, {}, {}, feature_size=0.1)
    >>> certificate["verdict"]
    'uncertified'
    >>> [name for name, check in certificate["checks"].items() if not check["holds"]][0]
    'tables_in_form'
    """
    facts = Facts(tables, tilt, graphs, feature_size, distance, curves, inspection or {}, model)
    ledger = Ledger()
    stopped = ""
    for step in STEPS:
        name = step.__name__.removeprefix("check_")
        if stopped:
            ledger.enter(f"{name}: made", False, True, says=f"Not examined, because of {stopped}.")
            continue
        try:
            before = len(ledger.checks)
            step(facts, ledger)
            failed = [n for n in list(ledger.checks)[before:] if not ledger.checks[n]["holds"]]
            stopped = f"the check {failed[0]!r}" if failed and step in FOUNDATIONS else ""
        except CONTRADICTIONS as fault:
            says = (
                f"The tables contradict each other so that this could not be examined: {type(fault).__name__}: {fault}"
            )
            ledger.enter(f"{name}: made", False, True, says=says)
            stopped = f"the step {name!r}"
    facts.crossing = bool(facts.crossing or facts.inspection.get("self_crossings"))
    verdict = _verdict(facts, ledger, unresolved_groups(facts) if ledger.holds() else [])
    reason = _reason(facts, ledger) if verdict == "uncertified" else ""
    told = {"verdict": verdict, "reason": reason} | _tell_of_void(facts, ledger, verdict)
    return told | _figures(facts) | {"checks": ledger.checks}


def _verdict(facts, ledger, groups):
    """The verdict, from the checks and from what the graph does not show apart.

    That is, groups of critical points that share a piece or a block, and pairs that
    cancel inside a slab, where neither leaves a trace in the contours.
    """
    if not ledger.holds():
        return "uncertified"
    cancelled = facts.cancelled.max(initial=0.0)
    if not groups and cancelled <= facts.noise:
        return "exact"
    small = all(_small(facts, group) for group in groups) and cancelled < facts.size
    return "exact_at_feature_size" if small else "uncertified"


def _tell_of_void(facts, ledger, verdict):
    """What holds of the void's graph: `void_verdict`, and why it is uncertified, in a sentence.

    It takes more than the verdict on the graphs of surface and solid: bodies that are apart, a surface that does
    not cross itself, and no two events that change the void in one block of it.
    """
    if verdict == "uncertified":
        return {"void_verdict": verdict, "void_reason": "The graphs of surface and solid are uncertified."}
    if doubts_void(facts):
        reason = (VOID_CROSSED if facts.crossing else VOID_SHARED) + ("" if "void" in facts.parts else NO_VOID)
        return {"void_verdict": "uncertified", "void_reason": reason}
    verdict = _verdict(facts, ledger, unresolved_groups(facts) + crowded_void(facts))
    reason = UNRESOLVED.format(facts.size) if verdict == "uncertified" else ""
    return {"void_verdict": verdict, "void_reason": reason}


def crowded_void(facts):
    """List the handles of each block of the void in which several events change it: a list of lists."""
    return [held for held in facts.void_events or [] if len(held) > 1]


def _reason(facts, ledger):
    """Why the model is uncertified and what to do, in a sentence or two."""
    failed = [name for name, check in ledger.checks.items() if not check["holds"]]
    if not failed:
        return UNRESOLVED.format(facts.size)
    first = ledger.checks[failed[0]]
    more = "" if len(failed) == 1 else f" ({len(failed) - 1} more after it)"
    told = f"The check {failed[0]!r} fails{more}: {first['says'] or _sides(first)}"
    if facts.crossing:
        return f"{CROSSES} {told}"
    return f"{told} {HEURISTIC if failed[0] == 'edges.method' else DIFFERENT}"


def _sides(check):
    """The two sides of a check, in words."""
    return f"found {check['found']}, expected {check['expected']}."


def unresolved_groups(facts):
    """List the handles whose order the graph does not show.

    Parameters
    ----------
    facts : Facts

    Returns
    -------
    list of list of int
        Of each piece that is not elementary, and of each block whose order is open.
    """
    t = facts.columns
    groups = []
    for piece in np.flatnonzero(~facts.elementary).tolist():
        groups.append(np.flatnonzero(t.handles["piece"] == piece).tolist())
    for block in np.flatnonzero(~facts.block_resolved).tolist():
        groups.append(np.flatnonzero(t.handles["block"] == block).tolist())
    return groups


def _small(facts, group):
    """Whether at most one of the handles has at least the feature size."""
    persistence = facts.columns.handles["persistence"]
    return sum(persistence[h] >= facts.size for h in group) < 2


def _figures(facts):
    """Everything in the certificate besides verdict and checks; None where unknown."""
    kinds, handles = facts.kinds, getattr(facts.columns, "handles", None)
    index = None if handles is None else np.asarray(handles["index"])
    cancelled, why = facts.cancelled, getattr(facts.columns, "levels", {}).get("why")
    tilt = facts.tilt if isinstance(facts.tilt, dict) else {}
    return {
        "euler_characteristic": facts.euler,
        "genus": facts.genus,
        "voids": facts.voids,
        "betti_solid": facts.betti,
        "shells": facts.n_shells,
        "handles": None if index is None else {str(i): int((index == i).sum()) for i in range(3)},
        "loops_surface": facts.loops_surface,
        "loops_solid": facts.loops_solid,
        "loops_void": facts.loops_void,
        "hidden_genus": facts.hidden,
        "suppressed_loops": facts.suppressed,
        "simplified": facts.simplified,
        "compound": None if kinds is None else int((kinds == "compound").sum()),
        "unseen": None if kinds is None else int((kinds == "unseen").sum()),
        "unresolved_blocks": None if facts.block_resolved is None else int((~facts.block_resolved).sum()),
        "unresolved_void_blocks": None if facts.void_events is None else len(crowded_void(facts)),
        "cancelled_pairs": None if cancelled is None else int((cancelled > facts.noise).sum()),
        "cancelled_persistence": None if cancelled is None else float(cancelled.max(initial=0.0)),
        "levels": None if why is None else len(why),
        "refined_levels": None if why is None else int((np.asarray(why) == "refined").sum()),
        "margin": tilt.get("margin"),
        "angle": tilt.get("angle"),
        "morse": tilt.get("morse"),
        "height_interpretation": BY_SOS if tilt.get("morse") == "by_sos" else "",
        "feature_size": float(facts.size),
        "similarity": _similarity_figures(facts.similarity),
        "open_questions": {name: int(value) for name, value in facts.open.items()},
        "solid_interpretation": " ".join(_interpretations(facts)),
        "volume": facts.volume,
        "area": facts.area,
    }


def _interpretations(facts):
    """What the solid is where bodies share material or a surface crosses itself, and who says that they do."""
    for text, holds, count in ((APART, facts.entangled, "body"), (CROSSING, facts.crossing, "self")):
        if holds:
            stated = facts.inspection.get(f"{count}_crossings")
            yield f"{text} {TOLD.format(stated)}" if stated else text


def _similarity_figures(values):
    """Statistics of the edges' similarities; None without edges."""
    if values is None or not len(values):
        return None
    extremes = {"min": float(values.min()), "median": float(np.median(values)), "max": float(values.max())}
    return extremes | {"share_below_half": float((values < 0.5).mean())}
