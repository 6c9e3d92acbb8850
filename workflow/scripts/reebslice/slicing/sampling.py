"""How densely levels must lie for a graph to be exact."""

import numpy as np

from ..arrays.components import connected_items
from .levels import MOST_LEVELS, pierce

AT_ONCE = 20_000  # numbers of levels that are tried together


def sampling_figures(critical_arcs):
    """Tell how many levels it takes to see every event of the surface apart from the others.

    Parameters
    ----------
    critical_arcs : pyarrow.Table
        The table.

    Returns
    -------
    dict
        `fewest_levels`: the least number of levels that cut every arc. `shortest_arc`: the least height of an
        arc, mesh units; uniform levels no farther apart suffice, wherever they start. `uniform_levels`: the
        least number of uniform levels (as :func:`.levels.uniform_heights` puts them) that cut every arc, None if
        more than MOST_LEVELS are needed. `exact_distance`: its inverse, the relative distance at which the graph
        first becomes exact.
    """
    spans = event_spans(*(critical_arcs[name].to_numpy() for name in ("source", "target", "lower", "upper")))
    count = fewest_uniform_levels(spans)
    return {
        "fewest_levels": len(pierce(spans.tolist())),
        "shortest_arc": float(np.ptp(spans, axis=1).min()),
        "uniform_levels": count,
        "exact_distance": None if count is None else 1.0 / count,
    }


def event_spans(source, target, lower, upper):
    """Find the heights between events.

    Critical points that arcs without height join, inside a flat, are one
    event, and no event at all if one arc is below it and one above.

    Parameters
    ----------
    source, target : (A,) int
        Nodes at the lower and the upper end of the arcs of a Reeb graph.
    lower, upper : (A,) float64
        Their heights.

    Returns
    -------
    (B, 2) float64
        Heights [low, high) of the arcs between events.
    """
    flat, n = lower == upper, max(source.max(), target.max()) + 1
    event = connected_items(source[flat], target[flat], n)
    n_events = event.max() + 1
    below, above = event[source[~flat]], event[target[~flat]]
    passed = (np.bincount(above, minlength=n_events) == 1) & (np.bincount(below, minlength=n_events) == 1)
    # an arc goes on through events that are none
    into, out = np.full(n_events, -1), np.full(n_events, -1)
    into[above], out[below] = np.arange(len(above)), np.arange(len(below))
    arc = connected_items(into[passed], out[passed], len(below))
    n_arcs = arc.max() + 1
    spans = np.stack([np.full(n_arcs, np.inf), np.full(n_arcs, -np.inf)], axis=1)
    np.minimum.at(spans[:, 0], arc, lower[~flat])
    np.maximum.at(spans[:, 1], arc, upper[~flat])
    return spans


def fewest_uniform_levels(spans):
    """Find the least number of uniform levels of which every span holds one.

    Parameters
    ----------
    spans : (B, 2) float64
        Heights [low, high); the lowest and the highest of all bound the levels.

    Returns
    -------
    int or None
        None if more than MOST_LEVELS are needed.
    """
    low, high = spans[:, 0].min(), spans[:, 1].max()
    spans = (spans[np.argsort(np.ptp(spans, axis=1))] - low) / (high - low)
    spans = spans.tolist()
    fewest = len(pierce(spans))
    for first in range(fewest, MOST_LEVELS + 1, AT_ONCE):
        counts = np.arange(first, min(first + AT_ONCE, MOST_LEVELS + 1))
        for a, b in spans:  # the shortest first, which most counts fail
            counts = counts[np.ceil(b * counts - 0.5) > np.ceil(a * counts - 0.5)]
            if len(counts) == 0:
                break
        if len(counts):
            return int(counts[0])
    return None
