"""Templates of pages beside this module, and the frame in which a page runs and loads only what it brings."""

import base64
import hashlib
import re
from functools import cache
from html import escape
from importlib.resources import files


@cache
def read_template(name):
    """Return the text of a file beside this module."""
    return (files(__package__) / name).read_text(encoding="utf-8")


def escape_name(name):
    """Return a name as HTML that may go on in the next line after _, -, / and the like, rather than within a word."""
    return re.sub(r"([_./-])(?=\w)", r"\1<wbr>", escape(name))


def fill_template(template, fields):
    """Return the template with every @@name@@ replaced by the field of that name; what fields hold is not looked at."""
    parts = template.split("@@")  # text and names of fields in turn
    return "".join(fields[part] if k % 2 else part for k, part in enumerate(parts))


def write_page(body, style, title, fields, scripts, images="data:"):
    """Write a page.

    Parameters
    ----------
    body, style : str
        Names of the template of its body, and of the style sheet that goes with shared.css.
    title : str
        HTML.
    fields : dict of str to str
        HTML for the places of the body.
    scripts : list of str
        What is run at the end.
    images : str
        Where images may be from, as a content security policy says it.

    Returns
    -------
    str
        HTML that runs and applies what it brings, shows these images, and loads nothing else.
    """
    styles = read_template("shared.css") + read_template(style)
    policy = f"script-src {' '.join(map(_digest, scripts))}; style-src {_digest(styles)}; img-src {images}"
    frame = {
        "policy": f"default-src 'none'; {policy}",
        "title": title,
        "style": styles,
        "body": fill_template(read_template(body), fields),
        "scripts": "\n".join(f"<script>{script}</script>" for script in scripts),
    }
    return fill_template(read_template("frame.html"), frame)


def _digest(text):
    """The digest of a text by which a content security policy knows it."""
    return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"
