"""What the verdicts mean, and sentences and units as people read them."""

import re

# How a model may end, what needs a look first.
KINDS = ("failed", "rejected", "uncertified", "exact_at_feature_size", "exact")
SOUND = ("exact", "exact_at_feature_size")
VERDICTS = {
    "exact": "Proven: the graphs are the Reeb graphs of this surface and its solid, with every event in them.",
    "exact_at_feature_size": "Proven for every feature at least {size} high; what is smaller may share a node.",
    "uncertified": "Not proven: {reason}",
}
SYMBOLS = {"micron": "\u00b5m", "millimetre": "mm", "centimetre": "cm", "metre": "m", "inch": "in", "foot": "ft"}
LONG = re.compile(r"(?<![\w.+-])-?\d+\.\d+(?:e[-+]?\d+)?(?![\w.]*\w)", re.IGNORECASE)


def tell_kind(status, verdict):
    """Return how a model ended: failed, or its verdict, or, where it has none, its status."""
    return "failed" if status == "failed" else verdict or status


def shorten_numbers(text):
    """Round the decimal numbers in a sentence to six digits, where they have more.

    >>> shorten_numbers("the first from (0.0023589066695421934, 0.817, -256.45599365234375) in part_1.50000000.stl")
    'the first from (0.00235891, 0.817, -256.456) in part_1.50000000.stl'
    """
    return LONG.sub(lambda found: min(found[0], f"{float(found[0]):.6g}", key=len), text)
