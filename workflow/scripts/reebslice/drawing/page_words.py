"""What the page of a model says in words: title, key and tables."""

from html import escape

import numpy as np

from .flat_svg import draw_mark
from .loops import WORDS as LOOP_WORDS
from .marks import MARKS
from .pockets import WORDS as POCKET_WORDS
from .verdicts import VERDICTS, shorten_numbers

ROWS = 300  # of a table
# What happens in each event of `schemas.EVENTS` as the height rises.
HAPPENINGS = {
    "->o": "material begins",
    "->i": "a pocket or void opens",
    "o->": "material ends",
    "i->": "a void or blind hole closes",
    "o,o->o": "two parts merge",
    "i,o->i": "an island joins what is around it",
    "o->i,o": "a region closes into a ring",
    "i->i,i": "a web crosses a hole",
    "o->o,o": "a part splits",
    "i->i,o": "an island is cut off",
    "i,o->o": "a ring opens",
    "i,i->i": "two holes merge",
}
OPERATION_WORDS = {
    "creation": "a contour begins",
    "union": "contours merge",
    "separation": "contours part",
    "annihilation": "a contour ends",
}
SIDE_WORDS = {"A": "material appears as the height rises", "B": "void appears as the height rises"}


def describe_verdict(certificate, unit):
    """Say what a verdict means.

    Parameters
    ----------
    certificate : dict
        The content of certificate.json.
    unit : str or None
        Of length.

    Returns
    -------
    str
    """
    words = VERDICTS.get(certificate["verdict"], "")
    size = certificate.get("feature_size")
    return words.format(
        size=format_figure(size, unit) if size else "the feature size",
        reason=shorten_numbers(certificate.get("reason") or ""),
    )


def describe_model(told, model, unit):
    """Say what a model is made of: bodies, voids, genus and where it comes from, sizes; and what is not certain of it.

    Parameters
    ----------
    told : Told
    model : Model
    unit : str or None

    Returns
    -------
    list of str
    """
    certificate = told.certificate
    bodies, voids = (certificate.get("betti_solid") or [None])[0], certificate.get("voids")
    words = [_count(bodies, "body", "bodies"), _count(voids, "closed void", "closed voids")]
    words.append(describe_genus(certificate))
    heights = (model.points @ model.rotation[2])[[0, -1]] if not len(model.points) else model.points @ model.rotation[2]
    low, high = (format_figure(float(bound), unit) for bound in (heights.min(), heights.max()))
    words.append(f"height {low} to {high}" + ("" if unit else ", in the units of the mesh"))
    words.append(f"{len(model.heights):,} levels")
    words.append(f"{len(model.faces):,} faces")
    if certificate.get("void_verdict") == "uncertified":
        words.append(f"pockets are not certified: {shorten_numbers(certificate.get('void_reason') or '')}")
    return [text for text in words if text]


def _count(number, one, many):
    """A number with its noun; nothing where it is not known."""
    return "" if number is None else f"{number or 'no'} {one if number == 1 else many}"


def describe_genus(certificate):
    """Say the genus as a sum of the loops that are seen where, and of those that are not.

    Parameters
    ----------
    certificate : dict
        The content of certificate.json.

    Returns
    -------
    str
        Empty where the genus is not known.
    """
    genus, solid, surface = (certificate.get(name) for name in ("genus", "loops_solid", "loops_surface"))
    if not genus or solid is None or surface is None:
        return "" if genus is None else f"genus {genus}" + ("" if genus else ": no loops")
    terms = [_count(solid, "loop", "loops").replace("no ", "0 ") + " of the solid"]
    terms.append(f"{surface - solid} that only the surface has")
    terms += [f"{certificate['hidden_genus']} hidden between levels"] if certificate.get("hidden_genus") else []
    rest = genus - surface - (certificate.get("hidden_genus") or 0)
    terms += [f"{rest} smaller than the feature size"] if rest > 0 else []
    return f"genus {genus} = {' + '.join(terms)}"


def write_key():
    """Write the key: what marks, sides and colours mean, as HTML."""
    marks = "".join(
        f"<li>{_mark(operation, 'A')}{_mark(operation, 'B')} <b>{operation}</b>: {words}</li>"
        for operation, words in OPERATION_WORDS.items()
    )
    sides = (
        f"<li>{_mark('union', 'A')} filled, <b>side A</b>: {SIDE_WORDS['A']}</li>"
        f"<li>{_mark('union', 'B')} hollow, <b>side B</b>: {SIDE_WORDS['B']}</li>"
        '<li><svg class="sign" viewBox="-11 -11 22 22" aria-hidden="true"><circle class="ring" r="9"/></svg> '
        "ring: several events, which the levels do not tell apart</li>"
    )
    lines = (
        '<li><span class="line outer"></span> contour around material at the level shown</li>'
        '<li><span class="line inner"></span> contour around a hole</li>'
        '<li><span class="line lit"></span> what is under the pointer, and the faces around it</li>'
    )
    loops = "".join(
        f'<li><span class="line {kind}"></span> loop, <b>{kind}</b>: {words}</li>' for kind, words in LOOP_WORDS.items()
    )
    pockets = "".join(
        f'<li><span class="patch {kind}"></span> <b>{kind}</b>: {words}</li>' for kind, words in POCKET_WORDS.items()
    )
    return f"<ul>{marks}</ul><ul>{sides}{lines}</ul><ul>{loops}{pockets}</ul>"


def _mark(operation, side):
    """A mark as a picture of its own."""
    return f'<svg class="sign" viewBox="-8 -8 16 16" aria-hidden="true">{draw_mark(operation, side)}</svg>'


def write_tables(model, unit):
    """Write what the page shows as tables, for those who do not see it.

    Parameters
    ----------
    model : Model
    unit : str or None

    Returns
    -------
    str
        HTML.
    """
    tables = []
    for name, graph in model.graphs.items():
        measure = "volume" if name.startswith("solid") else "area"
        power = 3 if measure == "volume" else 2
        rows = [
            (
                _describe_end(graph.nodes[low]),
                _describe_end(graph.nodes[high]),
                format_figure(facts["lower"], unit),
                format_figure(facts["upper"], unit),
                format_figure(facts.get("length"), unit),
                format_figure(facts.get(measure), unit, power),
            )
            for (low, high), facts in zip(graph.ends.tolist(), graph.arcs)
        ]
        titles = ("lower end", "upper end", "from height", "to height", "length", measure)
        caption = f"Arcs of the {name.replace('_', ', ')} graph"
        tables.append(_table(caption, titles, rows, f' class="arcs" data-graph="{name}"', "arc"))
    return "".join([*tables, *_tables_of_places(model, unit)])


def _tables_of_places(model, unit):
    """Tables of loops, pockets and islands."""
    tables = [] if model.loops is None else [_table_of_loops(model.loops, unit)]
    for name, (found, _bodies) in model.pockets.items():
        rows = [
            (
                kind if kind in POCKET_WORDS[kind] else f"{kind}: {POCKET_WORDS[kind]}",
                format_figure(found.begin_height[k].item(), unit),
                format_figure(found.end_height[k].item(), unit),
                format_figure(found.volume[k].item(), unit, 3),
            )
            for k, kind in enumerate(found.kind.tolist())
        ]
        tables.append(
            _table(name.capitalize(), (name, "from height", "to height", "volume"), rows, f' class="{name}"', name)
        )
    return tables


def _table_of_loops(loops, unit):
    """The table of loops."""
    figures = (
        (loops.height, 1),
        (loops.inscribed_radius * 2, 1),
        (loops.perimeter, 1),
        (loops.section, 2),
        (loops.length, 1),
    )
    rows = [
        (f"{kind}: {LOOP_WORDS[kind]}", *(format_figure(column[k].item(), unit, power) for column, power in figures))
        for k, kind in enumerate(loops.kind.tolist())
    ]
    titles = ("loop", "at height", "widest round bar or pin", "perimeter", "section", "length of the path")
    return _table("Loops, each where it is thinnest", titles, rows, ' class="loops"', "loop")


def _table(caption, titles, rows, attributes, kind):
    """A table whose rows can be reached by keyboard; nothing where it has no rows."""
    if not rows:
        return ""
    if len(rows) > ROWS:
        caption += f" (the first {ROWS} of {len(rows):,}; all are in the Parquet files)"
    head = "".join(f'<th scope="col">{escape(title)}</th>' for title in ("no.", *titles))
    body = "".join(
        f'<tr tabindex="0" data-{kind}="{k}"><th scope="row">{k}</th>{"".join(f"<td>{cell}</td>" for cell in row)}</tr>'
        for k, row in enumerate(rows[:ROWS])
    )
    return (
        f"<div{attributes}><table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead>"
        f"<tbody>{body}</tbody></table></div>"
    )


def _describe_end(node):
    """The event at an end of an arc, in words, as HTML."""
    happening = HAPPENINGS.get(
        node.get("change") or "", OPERATION_WORDS.get(node.get("operation") or "", "several events")
    )
    operation, side = node.get("operation") or "", node.get("side")
    mark = _mark(operation if operation in MARKS else "", side)
    return f"{mark} {escape(happening)} <small>{escape(str(node.get('handle', '')))}</small>"


def format_figure(value, unit=None, power=1):
    """Write a figure with its unit: five digits, no exponent where that is short.

    Parameters
    ----------
    value : float or None
    unit : str or None
        Of length.
    power : {1, 2, 3}
        1 of a length, 2 of an area, 3 of a volume.

    Returns
    -------
    str
        A dash for None.
    """
    if value is None or not np.isfinite(value):
        return "\u2013"
    text = f"{value:.5g}".replace("-", "\u2212")
    return text + (f"\u00a0{unit}{['', '', chr(178), chr(179)][power]}" if unit else "")
