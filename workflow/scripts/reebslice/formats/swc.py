"""Trees with radii as SWC, the format of neuron morphologies, which tools of skeletons read.

Reference: R. C. Cannon and others, An on-line archive of reconstructed hippocampal neurons, Journal of Neuroscience
Methods 84 (1998), which gives the columns.
"""

import numpy as np


def swc_text(points, radius, parent, notes):
    """Write a forest as SWC.

    Parameters
    ----------
    points : (n, 3) float64
    radius : (n,) float64
    parent : (n,) int
        An earlier point, or -1 of a root.
    notes : dict of str to str
        Comments at the head, by word.

    Returns
    -------
    str
        A line for each point: number from 1, type 0 (undefined: it is no part of a neuron), x, y, z, radius, and the
        number of its parent or -1. Numbers read back as they were.

    Raises
    ------
    ValueError
        A parent does not come before its child.
    """
    parent = np.asarray(parent)
    if (parent >= np.arange(len(parent))).any():
        raise ValueError("a parent must come before its children")
    lines = [f"# {word}: {' '.join(str(note).split())}" for word, note in notes.items()]
    rows = zip(np.asarray(points, float).tolist(), np.asarray(radius, float).tolist(), parent.tolist())
    for number, ((x, y, z), r, above) in enumerate(rows, 1):
        lines.append(f"{number} 0 {x!r} {y!r} {z!r} {r!r} {above + 1 if above >= 0 else -1}")
    return "\n".join([*lines, ""])
