"""The report of a corpus: a page with all models, what needs a look first, and how the figures are distributed."""

import json
from html import escape
from typing import NamedTuple
from urllib.parse import quote

from .report_charts import draw_chart
from .report_figures import list_figures
from .report_looks import FUNCTION, find_looks
from .report_words import count_models, plain_kind, write_looks, write_verdicts, write_versions
from .templates import read_template, write_page
from .verdicts import KINDS, SYMBOLS, shorten_numbers, tell_kind

FOLDER = "../models/"  # of the models, from the page
# Files of a model that are linked, what shows most of it first, and what they are called.
LINKED = {
    "view.html": "page",
    "picture.png": "picture",
    "loops.png": "loops",
    "pockets.png": "pockets",
    "certificate.json": "certificate",
    "exact_graphs.json": "certificate of exact graphs",
    "inspection.json": "inspection",
}


ALIKE = 5  # models that are told to be most like one
MAP = """<section id="likeness" aria-labelledby="likeness-title">
<h2 id="likeness-title">Which are alike</h2>
<div class="sides"><div id="map"><div id="spots"></div></div><div id="alike" aria-live="polite"></div></div>
<p><small>{}Models that are alike are near each other, as far as a plane can show it. All distances:
<a href="distances.parquet">distances.parquet</a>, <a href="neighbours.parquet">neighbours.parquet</a>.</small></p>
</section>
"""


class Run(NamedTuple):
    """How the models were made.

    Attributes
    ----------
    meshes : str
        Their folder.
    only : object
        What picked some of them, as the configuration has it; None for all.
    config : str
        The configuration as text.
    own : int
        Number of models with a configuration of their own.
    versions : dict of str to str
        Of the programs, by name.
    """

    meshes: str
    only: object
    config: str
    own: int
    versions: dict


def make_report(table, files, thumbnails, run, likeness=None):
    """Make the page.

    Parameters
    ----------
    table : pyarrow.Table
        Of models, sorted by them.
    files : list of set of str
        Of each model those of :data:`LINKED` and `thumbnail.png` that are there.
    thumbnails : list of str or None
        Thumbnails in base64, or None where the page is to load them from the folder of the model.
    run : Run
    likeness : (pyarrow.Table, pyarrow.Table), optional
        `distances` and `neighbours` of these models, or of some of them.

    Returns
    -------
    str
        HTML, the same for the same input. It loads nothing but thumbnails, by relative addresses.
    """
    looks_at = ("model", "path", "status", "verdict", "reason", "solid_interpretation", "self_crossings")
    looks_at += ("body_crossings", "hidden_genus", "genus", "void_verdict", "void_reason")
    told = [name for name in table.column_names if name in looks_at or name.startswith(FUNCTION)]
    rows = table.select(told).to_pylist()
    kinds, figures, looks = (
        [tell_kind(row["status"], row["verdict"]) for row in rows],
        list_figures(table),
        find_looks(rows),
    )
    names = [row["model"] for row in rows]
    likeness = likeness if likeness and likeness[0].num_rows else None
    data = _gather_data(table, rows, kinds, figures, looks, files, thumbnails)
    if likeness:
        data["map"] = _gather_map(names, *likeness)
    picked = "" if run.only is None else f" that <code>only={escape(str(run.only))}</code> picks"
    own = f"<p>{count_models(run.own)} of the sheet have some keys of their own.</p>" if run.own else ""
    fields = {
        "title": f"Report of {count_models(len(rows))}",
        "meshes": f"<code>{escape(run.meshes)}</code>{picked}",
        "verdicts": write_verdicts(kinds),
        "looks": write_looks(looks, names, [_find_link(*pair) for pair in zip(names, files)]),
        "map": MAP.format(_count_compared(len(data["map"]["rows"]), len(rows))) if likeness else "",
        "charts": "".join(draw_chart(figure, values) for figure, values in figures.items() if figure.shown),
        "own": own,
        "config": escape(run.config),
        "versions": write_versions(run.versions),
        "data": json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
    }
    scripts = [read_template(name) for name in ("report.js", *(["report_map.js"] if likeness else []))]
    return write_page("report.html", "report.css", fields["title"], fields, scripts, "data: file: 'self'")


def _count_compared(shown, count):
    """Say how many models are on the map, where some are not."""
    return "" if shown == count else f"{shown} of {count_models(count)} could be compared. "


def _gather_map(names, distances, neighbours):
    """What the map is made of: rows of the models on it, their places, and of each those most like it, as places."""
    row = {name: k for k, name in enumerate(names)}
    models = [name for name in distances["model"].to_pylist() if name in row]
    place = {name: k for k, name in enumerate(models)}
    near = [[] for _ in models]
    for model, rank, other in zip(*(neighbours[name].to_pylist() for name in ("model", "place", "neighbour"))):
        if rank < ALIKE and model in place and other in place:
            near[place[model]].append(place[other])
    x, y = ([round(value, 4) for value in distances[name].to_pylist()] for name in "xy")
    return {"rows": [row[name] for name in models], "x": x, "y": y, "near": near}


def _find_link(name, there):
    """The relative address of what shows most of a model, or None."""
    file = next((file for file in LINKED if file in there), None)
    return file and f"{FOLDER}{quote(name)}/{file}"


def _gather_data(table, rows, kinds, figures, looks, files, thumbnails):
    """What the table on the page is made of: columns of equal length, texts that occur often by number."""
    order = [*KINDS, *sorted(set(kinds) - set(KINDS))]
    reasons = {}
    units = table["unit"].to_pylist() if "unit" in table.column_names else [None] * len(rows)
    return {
        "folder": FOLDER,
        "models": [row["model"] for row in rows],
        "paths": [row["path"] for row in rows],
        "kinds": [[kind, plain_kind(kind)] for kind in order],
        "kind": [order.index(kind) for kind in kinds],
        "reason": [reasons.setdefault(shorten_numbers(row["reason"] or ""), len(reasons)) for row in rows],
        "reasons": list(reasons),
        "units": [SYMBOLS.get(unit, unit) for unit in units] if any(units) else [],
        "linked": list(LINKED.items()),
        "files": [sum(1 << k for k, name in enumerate(LINKED) if name in there) for there in files],
        "thumbnails": thumbnails if thumbnails is not None else [int("thumbnail.png" in there) for there in files],
        "looks": [look.models for look in looks],
        "figures": [
            {"label": figure.label, "name": figure.name, "words": figure.words, "power": figure.power,
             "shown": figure.shown, "values": values}
            for figure, values in figures.items()
        ],
    }  # fmt: skip
