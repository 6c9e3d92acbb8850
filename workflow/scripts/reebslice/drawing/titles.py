"""The words at the top of a picture of a model."""

from typing import NamedTuple

from .canvas import Words
from .marks import INK, SOFT

VERDICT_INKS = {"exact": "#00724F", "exact_at_feature_size": "#005A8C", "uncertified": "#B3470A"}


class Title(NamedTuple):
    """Words of a picture.

    Attributes
    ----------
    name : str
        Of the model.
    facts : list of str
        Short statements in a line below it.
    verdict : str
        The certificate's.
    graph : str
        What is drawn on the right.
    unit : str or None
        Of length; None where the mesh does not tell it.
    """

    name: str
    facts: list
    verdict: str
    graph: str = ""
    unit: str | None = None


def write_title(title, width, height):
    """Write the words at the top.

    Parameters
    ----------
    title : Title
    width, height : int
        Of the picture, in pixels.

    Returns
    -------
    list of Words
    """
    ink = VERDICT_INKS.get(title.verdict, SOFT)
    return [
        Words(title.name, (0.018 * width, 0.045 * height), 15, INK, bold=True),
        Words(" \u00b7 ".join(title.facts), (0.018 * width, 0.087 * height), 9.5, SOFT),
        Words(title.verdict.replace("_", " "), (0.982 * width, 0.045 * height), 12, ink, "rm", bold=True),
    ]
