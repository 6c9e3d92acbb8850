"""What of a corpus needs a look first: models by what is the matter with them, and what cures it."""

import re
from typing import NamedTuple

from .verdicts import KINDS, SOUND, shorten_numbers, tell_kind

# What is the matter, in the order of a look: its heading and what to do.
MATTERS = {
    "failed": (
        "Failed, by no fault found in the mesh",
        "Start the same command again: it tries these models once more, and no other. Where memory or time ran out, "
        "use fewer cores, or set limits: {memory, minutes} in the configuration. Tracebacks are in results/logs/.",
    ),
    "rejected": (
        "Rejected: no closed surface, or a damaged file",
        "There is no graph of these. Do what the reason says, to the mesh or to the configuration, and start the same "
        "command again: it computes these models, and no other.",
    ),
    "uncertified": (
        "Not proven",
        "There are graphs of these, and a check of them failed, or their links were guessed from shapes. Do what the "
        "reason says before you rely on them; the checks are in certificate.json.",
    ),
    "skipped": ("Not computed", "A stage before did not leave what it takes. Start the same command again."),
    "crossing": (
        "Surfaces that cross",
        "The graph of the surface is proven; what is material where the surface crosses itself, or bodies overlap, is "
        "a choice. inspect: {overlaps: union} unites bodies that overlap; mend what crosses itself, or take it so.",
    ),
    "hidden": (
        "Loops that the graphs do not show",
        "They lie between two levels. A smaller levels.distance, or levels: {refine: exact}, shows them.",
    ),
    "void": (
        "Pockets that are not proven",
        "Volumes and throats of basins, bells and sealed voids of these are not certified. The graphs of surface and "
        "solid are as their verdicts say.",
    ),
    "function": (
        "Functions without a proven graph",
        "functions.json says why. Graphs of the height are as their verdicts say; descriptors and comparisons go "
        "without these.",
    ),
    "note": ("With a note", "The graphs are as their verdicts say; what was left out beside them, and why:"),
}
FUNCTION = "function_verdicts_"  # columns of the table of models, before the name of the function
NUMBER, QUOTED = re.compile(r"[-+]?\d[\d.,]*(e[-+]?\d+)?"), re.compile(r"'[^']*'")


class Look(NamedTuple):
    """Models with which the same is the matter.

    Attributes
    ----------
    matter : str
        Key of :data:`MATTERS`.
    reason : str
        Of the first model; those of the others differ in numbers and names alone.
    alike : bool
        Whether they do not differ even in these.
    models : list of int
        Rows of the table, ascending.
    """

    matter: str
    reason: str
    alike: bool
    models: list


def find_looks(rows):
    """Group the models that need a look by what is the matter with them.

    Parameters
    ----------
    rows : list of dict
        Of the table of models: model, path, status, verdict, reason, and of `solid_interpretation`,
        `self_crossings`, `body_crossings`, `hidden_genus`, `void_verdict`, `void_reason` and
        `function_verdicts_NAME` those that it has.

    Returns
    -------
    list of Look
        By matter, and of one matter the largest first. A model may be in several.
    """
    looks = {}
    for k, row in enumerate(rows):
        for matter, reason in _list_matters(row):
            looks.setdefault((matter, _find_skeleton(row, reason)), []).append((k, reason))
    found = []
    for (matter, _), told in looks.items():
        models, reasons = zip(*told)
        found.append(Look(matter, reasons[0], len(set(reasons)) == 1, list(models)))
    order = {matter: place for place, matter in enumerate(MATTERS)}
    return sorted(found, key=lambda look: (order[look.matter], -len(look.models), look.models))


def _list_matters(row):
    """What is the matter with a model, with its reasons."""
    kind, reason = tell_kind(row["status"], row["verdict"]), shorten_numbers(row["reason"] or "")
    if kind not in SOUND:
        return [(kind if kind in KINDS else "skipped", reason)]
    found = [("note", reason)] if reason else []
    if row.get("self_crossings") or row.get("body_crossings"):
        told = row.get("solid_interpretation") or "Pairs of faces cross."
        found.append(("crossing", shorten_numbers(told)))
    if row.get("hidden_genus"):
        found.append(("hidden", f"{row['hidden_genus']} of {row.get('genus')} loops lie between two levels."))
    if row.get("void_verdict") == "uncertified":
        found.append(("void", shorten_numbers(row.get("void_reason") or "")))
    verdicts = {name.removeprefix(FUNCTION): verdict for name, verdict in row.items() if name.startswith(FUNCTION)}
    unsure = [f"{name}: {verdict}" for name, verdict in verdicts.items() if verdict not in (None, "exact")]
    if unsure:
        found.append(("function", ", ".join(unsure)))
    return found


def _find_skeleton(row, reason):
    """The reason without what is this model's own: names, paths and numbers."""
    for own in (row["path"], row["model"]):
        reason = re.sub(rf"(?<!\w){re.escape(own)}(?!\w)", "\0", reason) if own else reason
    return NUMBER.sub("0", QUOTED.sub("''", reason))
