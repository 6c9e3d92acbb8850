"""Connected components of anything that is linked in pairs."""

import numpy as np
from numba import njit

from .pairing import find, join


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
