"""Connected components by union-find (Tarjan 1975, doi:10.1145/321879.321884)."""

import numpy as np

from ..kernels import njit


def connected_items(low, high, n):
    """Find the connected components of items that are linked in pairs.

    Parameters
    ----------
    low, high : (E,) int
        The two items of every link.
    n : int
        Number of items.

    Returns
    -------
    (n,) int64
        Component of every item. Components are numbered by their lowest item.
    """
    kind = np.result_type(low, high, np.int32)  # one kernel for each of two types, not for each pair and stride
    return _label_items(np.ascontiguousarray(low, kind), np.ascontiguousarray(high, kind), int(n))


@njit
def _label_items(low, high, n):
    """Kernel of `connected_items`."""
    root, name, count = np.arange(n), np.empty(n, np.int64), 0
    for i in range(len(low)):
        join(root, low[i], high[i])
    for item in range(n):
        lowest = find(root, item)  # is the item itself, or has its name by now
        name[item] = count if lowest == item else name[lowest]
        count += lowest == item
    return name


@njit(inline="always")
def find(root, i):
    """Find the representative of an item's set, halving the path to it.

    Parameters
    ----------
    root : (n,) int
        Union-find forest: the parent of every item, an item itself where it represents its set. Modified.
    i : int
        The item.

    Returns
    -------
    int
        The representative; the smallest item of the set if all unions were made by :func:`join`.
    """
    while root[i] != i:
        root[i] = root[root[i]]
        i = root[i]
    return i


@njit(inline="always")
def join(root, i, j):
    """Unite the sets of two items; the smaller representative remains.

    Parameters
    ----------
    root : (n,) int
        Union-find forest, as of :func:`find`. Modified.
    i, j : int
        Any members of the two sets.
    """
    i, j = find(root, i), find(root, j)
    if i < j:
        root[j] = i
    elif j < i:
        root[i] = j
