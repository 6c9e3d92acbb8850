"""The distributions on the report of a corpus: bars that choose the models they count."""

from html import escape

import numpy as np

WIDTH, HEIGHT, BASE = 180, 76, 58  # of a chart, and the row of its axis
GLYPH = 5.6  # width of a digit, pixels
MOST = 18  # bars over a wide range
FEW = 12  # different whole numbers that each have a bar
WIDE = 20.0  # times the smallest, beyond which steps grow with the figures


def draw_chart(figure, values):
    """Draw how a figure is distributed.

    Parameters
    ----------
    figure : Figure
    values : sequence of float, int or None

    Returns
    -------
    str
        HTML: a bar tells, as `data-low` and `data-high`, the least and the largest value that it counts; '' where
        all values are one.
    """
    known = np.sort(np.array([value for value in values if value is not None], float))
    if not len(known) or known[0] == known[-1]:
        return ""
    bins = [own for own in split_values(known) if len(own)]
    most = max(map(len, bins))
    step = WIDTH / len(bins)
    told = _choose_labels([_shorten(own[0]) for own in bins], step)
    bars = "".join(
        _draw_bar(figure, own, (k * step, step, (BASE - 14) * len(own) / most), label)
        for k, (own, label) in enumerate(zip(bins, told))
    )
    return (
        f'<figure class="chart" data-figure="{figure.name}"><figcaption>{escape(figure.label)}'
        f"<small>{escape(figure.words)}</small></figcaption>"
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="group" aria-label="{escape(figure.label)}">'
        f'<path class="axis" d="M0 {BASE}.5H{WIDTH}"/>{bars}</svg></figure>'
    )


def split_values(values):
    """Split sorted values into those of one bar each.

    Few different whole numbers have a bar each; else bars go by equal steps, or, over a wide range, by 1, 2, 5, 10, ...

    Parameters
    ----------
    values : (n,) float64
        Sorted, at least one.

    Returns
    -------
    list of (k,) float64
        In order, all values once; some may be empty.
    """
    different = np.unique(values)
    if len(different) <= FEW and (different == np.round(different)).all():
        return np.split(values, np.searchsorted(values, different[1:]))
    low, high = values[0], values[-1]
    positive = values[values > 0]
    if low >= 0 and len(positive) and high > WIDE * positive[0]:
        powers = np.arange(np.floor(np.log10(positive[0])), np.floor(np.log10(high)) + 1)
        edges = np.outer(10.0**powers, [1, 2, 5] if len(powers) * 3 <= MOST else [1]).ravel()
        edges = edges[:: -(-len(edges) // MOST)]
    else:
        edges = np.linspace(low, high, FEW + 1)[1:-1]
    return np.split(values, np.searchsorted(values, edges))


def _choose_labels(labels, step):
    """Of labels at equal steps those that have room beside the one before and differ from it, '' for the others."""
    chosen, end, last = [], -np.inf, ""
    for k, label in enumerate(labels):
        middle, half = (k + 0.5) * step, GLYPH * len(label) / 2
        fits = middle - half > end and label != last
        chosen.append(label if fits else "")
        if fits:
            end, last = middle + half + GLYPH, label
    return chosen


def _draw_bar(figure, own, place, label):
    """A bar with its number above, and below the label, the least value that it counts; `place`: left, step, tall."""
    left, step, tall = place
    low, high = (f"{bound:.15g}" for bound in own[[0, -1]])  # figures as they are in the page
    told = low if low == high else f"{low} to {high}"
    models = f"{len(own):,} model{'s' if len(own) != 1 else ''}"
    middle, number = left + step / 2, _shorten(len(own))
    above = number if GLYPH * len(number) < step else ""
    below = f'<text x="{middle:.1f}" y="{HEIGHT - 5}">{label}</text>' if label else ""
    return (
        f'<g role="button" tabindex="0" aria-pressed="false" data-figure="{figure.name}" data-low="{low}" '
        f'data-high="{high}" aria-label="{escape(figure.label)} {told}: {models}">'
        f"<title>{told}: {models}</title>"
        f'<rect class="back" x="{left:.1f}" y="0" width="{step:.1f}" height="{HEIGHT}"/>'
        f'<rect class="bar" x="{left + 1:.1f}" y="{BASE - max(tall, 1.5):.1f}" width="{max(step - 2, 1):.1f}" '
        f'height="{max(tall, 1.5):.1f}"/>'
        f'<text x="{middle:.1f}" y="{BASE - max(tall, 1.5) - 3:.1f}">{above}</text>'
        f"{below}</g>"
    )


def _shorten(value):
    """A number in two digits, thousands and millions as k and M."""
    size, letter = next(((size, letter) for size, letter in ((1e6, "M"), (1e3, "k")) if abs(value) >= size), (1, ""))
    return f"{value / size:.{3 if value / size >= 100 else 2}g}{letter}".replace("-", "\u2212")
