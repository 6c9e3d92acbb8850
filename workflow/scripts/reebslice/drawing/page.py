"""The page of a model: one HTML file that loads nothing, made of a scene in binary glTF."""

import base64
import zlib
from html import escape
from typing import NamedTuple

import numpy as np

from ..formats.glb import write_glb
from .flat_svg import define_marks, draw_svg
from .page_words import HAPPENINGS, describe_model, describe_verdict, write_key, write_tables
from .rasters import widest_azimuth
from .scene import list_parts
from .templates import escape_name, read_template, write_page
from .verdicts import SYMBOLS
from .views import fit_view, project_points

ELEVATION = 20.0  # degrees: from where the model is seen first
READABLE = 120  # nodes, beyond which the simplified graph is shown first


class Told(NamedTuple):
    """What the results say of a model: its name, and the contents of inspection.json and certificate.json."""

    name: str
    inspection: dict
    certificate: dict


def make_page(told, model, most, notes=()):
    """Make the scene of a model and the page that shows it.

    Parameters
    ----------
    told : Told
    model : Model
    most : int
        Faces of the surface that are shown; one with more is decimated, for display only.
    notes : iterable of str
        Sentences on what is not shown, written at the end of the page.

    Returns
    -------
    glb : bytes
        The scene, as binary glTF.
    html : str
        The page, with the scene in it. The same for the same input.
    """
    parts, more = list_parts(model, most)
    tilted = model.points @ model.rotation.T
    azimuth = widest_azimuth(tilted, model.faces, ELEVATION)
    notes = [*more, *notes]
    origin = (model.points.min(axis=0) + model.points.max(axis=0)) / 2
    extras = {
        "model": told.name,
        "verdict": told.certificate["verdict"],
        "unit": _symbol(told),
        "origin": origin.tolist(),
        "rotation": np.asarray(model.rotation).tolist(),
        "low": float(tilted[:, 2].min()),
        "high": float(tilted[:, 2].max()),
        "azimuth": float(azimuth),
        "elevation": ELEVATION,
        "notes": notes,
        "happenings": HAPPENINGS,
    }
    glb = write_glb(parts, model.rotation, origin, extras)
    return glb, _write_html(told, model, glb, _draw_graphs(model, azimuth), notes)


def _symbol(told):
    """The symbol of the unit of length, or None."""
    unit = told.inspection.get("unit")
    return SYMBOLS.get(unit, unit)


def _draw_graphs(model, azimuth):
    """The flat drawing of every graph, in one string."""
    view = fit_view(model.points @ model.rotation.T, azimuth, ELEVATION, 1000, 1000)
    drawn = []
    for name, graph in model.graphs.items():
        drawn.append(draw_svg(name, graph, project_points(graph.spots @ model.rotation.T, view)[:, 0]))
    return "".join(drawn)


def _write_html(told, model, glb, drawn, notes):
    """Fill the template."""
    code = "\n".join(map(read_template, ("page.js", "page_view.js", "page_shapes.js", "page_pointer.js")))
    unit = _symbol(told)
    first = choose_graph(model.graphs)
    fields = {
        "heading": escape_name(told.name),
        "verdict": escape(told.certificate["verdict"].replace("_", " ")),
        "verdict_class": escape(told.certificate["verdict"]),
        "verdict_words": escape(describe_verdict(told.certificate, unit)),
        "words": "".join(f"<li>{escape(text)}</li>" for text in describe_model(told, model, unit)),
        "marks": define_marks(),
        "graphs": drawn,
        "choices": _write_choices(model.graphs, first),
        "key": write_key(),
        "tables": write_tables(model, unit),
        "notes": "".join(f"<li>{escape(text)}</li>" for text in notes),
        "glb": base64.b64encode(zlib.compress(glb, 6)).decode(),
    }
    title = f"{escape(told.name)}: {fields['verdict']}"
    return write_page("page.html", "page.css", title, fields, [read_template("three.min.js"), code])


def choose_graph(graphs):
    """Choose the graph that is shown first: the solid's, or, where that is too large to be read, a smaller one.

    Parameters
    ----------
    graphs : dict of str to EmbeddedGraph

    Returns
    -------
    str or None
    """
    readable = [name for name, graph in graphs.items() if len(graph.nodes) <= READABLE]
    return next(iter(readable or sorted(graphs, key=lambda name: len(graphs[name].nodes))), None)


def _write_choices(graphs, first):
    """The options of the choice of a graph."""
    words = {
        "solid": ("solid", "One line per part of the material."),
        "solid_simplified": ("solid, simplified", "One line per part of the material, without small features."),
        "surface": ("surface", "One line per tube of the surface."),
        "surface_simplified": ("surface, simplified", "One line per tube of the surface, without small features."),
    }
    return "".join(
        f'<option value="{name}" data-words="{words[name][1]}"{" selected" if name == first else ""}>{words[name][0]} '
        f"({len(graph.nodes)} nodes, {len(graph.arcs)} arcs)</option>"
        for name, graph in graphs.items()
    )
