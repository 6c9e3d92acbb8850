"""All descriptors of one surface."""

import numpy as np

from .persistence import describe_events, persistence_images
from .shape import betti_numbers, distance_histogram, sizes


def describe_surface(points, faces, graphs):
    """Describe a closed surface by lists of numbers.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
        The cleaned surface.
    graphs : dict of str to (values, nodes, arcs)
        Of each function its values (n,), and what :func:`..graphs.function_graphs.graph_function` says of it.

    Returns
    -------
    dict of str to list
        Columns of the table `descriptors`.
    """
    area, volume = sizes(points, faces)
    rows = [
        ("betti_numbers", "", betti_numbers(points, faces)),
        ("area", "", [area]),
        ("volume", "", [volume]),
        ("distances", "", distance_histogram(points, faces)),
    ]
    for name, (values, nodes, _arcs) in graphs.items():
        rows += _describe_function(name, np.asarray(values), nodes, np.sqrt(area))
    return {
        "descriptor": [row[0] for row in rows],
        "function": [row[1] for row in rows],
        "values": [np.asarray(row[2], float).tolist() for row in rows],
    }


def _describe_function(name, values, nodes, unit):
    """Rows of one function."""
    value, partner = np.asarray(nodes["value"]), np.asarray(nodes["partner"])
    low, size = value.min(), max(np.ptp(value), np.finfo(float).tiny)
    chosen = np.flatnonzero(value < value[partner])
    pairs = (value[chosen] - low) / unit, (value[partner[chosen]] - low) / unit
    kinds = np.asarray(nodes["pairing"])[chosen]
    return [
        ("events", name, describe_events((value - low) / size, nodes["index"])),
        ("persistence", name, persistence_images(*pairs, kinds, (0, 3))),
    ]
