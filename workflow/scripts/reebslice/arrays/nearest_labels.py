"""Labels spread to the neighbours of what has them."""

import numpy as np

from ..kernels import njit
from .grouping import list_incidence


def spread_labels(label, low, high):
    """Give items without a label that of their nearest neighbour with one.

    Parameters
    ----------
    label : (N,) int
        -1 for none.
    low, high : (E,) int
        Items that are neighbours.

    Returns
    -------
    (N,) int64
        Labels; of neighbours that are equally many steps away the lowest. -1 where no labelled item is to be reached.
    """
    label, pairs = np.array(label, np.int64), np.column_stack([low, high]).astype(np.int64)
    order = np.argsort(label, kind="stable")
    return _spread(label, pairs, list_incidence(pairs, len(label)), order[np.sum(label < 0) :])


@njit
def _spread(label, pairs, incident, known):
    """Do as :func:`spread_labels`, breadth first from what is `known`, the lowest label first; changes `label`."""
    queue, count, place = np.empty(len(label), np.int64), len(known), 0
    for i in range(count):
        queue[i] = known[i]
    while place < count:
        item = queue[place]
        for pair in incident.member[incident.start[item] : incident.start[item + 1]]:
            other = pairs[pair, 0] + pairs[pair, 1] - item
            if label[other] < 0:
                label[other] = label[item]
                queue[count] = other
                count += 1
        place += 1
    return label
