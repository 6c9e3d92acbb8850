"""Counting sorts of integer keys."""

import numpy as np
from numba import njit


def sort_stably(*keys):
    """Argsort by whole numbers, the most significant last as `np.lexsort` has it; linear in time.

    keys : pairs of an array (m,) int64 and a bound that its numbers, none negative, stay below.
    """
    order = np.arange(len(keys[0][0]))
    for numbers, bound in keys:
        order = _sort_by(numbers, order, bound)
    return order


@njit(cache=True)
def _sort_by(numbers, order, bound):
    """Put `order` in order of numbers[order], by counting, equal ones left as they are."""
    fill = np.zeros(bound + 1, np.int64)
    for number in numbers:
        fill[number + 1] += 1
    for number in range(bound):
        fill[number + 1] += fill[number]
    out = np.empty_like(order)
    for i in order:
        out[fill[numbers[i]]] = i
        fill[numbers[i]] += 1
    return out
