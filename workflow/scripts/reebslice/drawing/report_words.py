"""What the report of a corpus says in words: verdicts, what needs a look, and how it was made."""

from collections import Counter
from html import escape

from .report_looks import MATTERS
from .templates import escape_name
from .verdicts import KINDS, VERDICTS

FIRST = 8  # models of one look that are named
MOST = 12  # looks of one matter that are told
KIND_WORDS = {
    "failed": "the run could not compute it, by no fault found in the mesh; the next run tries again",
    "rejected": "the mesh is no closed surface, or its file is damaged",
    "uncertified": "there are graphs, and nothing proves them right",
    "exact_at_feature_size": "Proven for every feature at least as high as the feature size; what is smaller may share "
    "a node. levels: {refine: exact} shows all of it.",
    "exact": VERDICTS["exact"],
}


def plain_kind(kind):
    """A verdict as words."""
    return kind.replace("_", " ")


def count_models(count):
    """A number of models, with the noun."""
    return f"{count:,} model{'' if count == 1 else 's'}"


def write_verdicts(kinds):
    """The number of models by verdict, what needs a look first, as HTML.

    Parameters
    ----------
    kinds : sequence of str
    """
    counts = Counter(kinds)
    order = [*(kind for kind in KINDS if kind in counts), *sorted(counts.keys() - set(KINDS))]
    return "".join(
        f'<li><span class="verdict {escape(kind)}">{counts[kind]:,} {escape(plain_kind(kind))}</span> '
        f"{escape(KIND_WORDS.get(kind, ''))}</li>"
        for kind in order
    )


def write_looks(looks, names, links):
    """What needs a look, as HTML.

    Parameters
    ----------
    looks : list of Look
    names : list of str
        Of the models.
    links : list of str or None
        Relative addresses of what shows most of each.
    """
    if not looks:
        return "<p>Nothing: every model is proven, and none has a note.</p>"
    told = []
    for matter, (heading, cure) in MATTERS.items():
        own = [(k, look) for k, look in enumerate(looks) if look.matter == matter]
        if own:
            models = {model for _, look in own for model in look.models}
            items = "".join(_write_look(k, look, names, links) for k, look in own[:MOST])
            more = len(own) - MOST
            rest = f"<p>And {more} other reasons: the table below tells them.</p>" if more > 0 else ""
            told.append(
                f'<section class="matter {matter}"><h3>{escape(heading)}: {count_models(len(models))}</h3>'
                f"<p>{escape(cure)}</p><ul>{items}</ul>{rest}</section>"
            )
    return "".join(told)


def _write_look(number, look, names, links):
    """One look: how many models, the reason, their names, and a button that shows them in the table."""
    told = ", ".join(_link(names[k], links[k]) for k in look.models[:FIRST])
    more = len(look.models) - FIRST
    told += f" and {more:,} more" if more > 0 else ""
    first = "" if look.alike else f" <small>(numbers and names: of {escape_name(names[look.models[0]])})</small>"
    shown = "it" if len(look.models) == 1 else "them"
    button = f'<button type="button" data-look="{number}">show {shown} in the table</button>'
    return (
        f'<li><p class="reason">{escape(look.reason) or "No reason was told."}{first}</p>'
        f'<p class="names">{count_models(len(look.models))}: {told} {button}</p></li>'
    )


def _link(name, address):
    """The name of a model, linked to what shows most of it."""
    return f'<a href="{escape(address)}">{escape_name(name)}</a>' if address else escape_name(name)


def write_versions(versions):
    """The versions, as rows of a table in HTML."""
    return "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(version)}</td></tr>' for name, version in versions.items()
    )
