"""Templates of pages beside this module, and the policy by which a page runs and loads only what it brings."""

import base64
import hashlib
from functools import cache
from importlib.resources import files


@cache
def read_template(name):
    """Return the text of a file beside this module."""
    return (files(__package__) / name).read_text(encoding="utf-8")


def fill_template(template, fields):
    """Return the template with every @@name@@ replaced by the field of that name; what fields hold is not looked at."""
    parts = template.split("@@")  # text and names of fields in turn
    return "".join(fields[part] if k % 2 else part for k, part in enumerate(parts))


def write_policy(style, *scripts, images="data:"):
    """Return a content security policy that lets these be run and applied, and images be shown; nothing else."""

    def digest(text):
        return "'sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() + "'"

    return (
        f"default-src 'none'; script-src {' '.join(map(digest, scripts))}; style-src {digest(style)}; img-src {images}"
    )
