"""Connected components of anything that is linked in pairs."""

import numpy as np
from numba import njit


@njit(cache=True)
def connected_items(low, high, n):
    """Component of each of n items of which low[i] and high[i] are linked: (n,) int64, numbered by lowest item."""
    root, name, count = np.arange(n), np.empty(n, np.int64), 0
    for i in range(len(low)):
        join(root, low[i], high[i])
    for item in range(n):
        lowest = find(root, item)  # is the item itself, or has its name by now
        name[item] = count if lowest == item else name[lowest]
        count += lowest == item
    return name


@njit(cache=True, inline="always")
def find(root, i):
    """The representative of i in a union-find forest, with path halving."""
    while root[i] != i:
        root[i] = root[root[i]]
        i = root[i]
    return i


@njit(cache=True, inline="always")
def join(root, i, j):
    """Unite the sets of i and j; the smaller representative remains."""
    i, j = find(root, i), find(root, j)
    if i < j:
        root[j] = i
    elif j < i:
        root[i] = j
