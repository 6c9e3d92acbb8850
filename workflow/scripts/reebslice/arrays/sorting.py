"""Counting sorts of integer keys."""

import numpy as np

from ..kernels import njit


def sort_stably(*keys):
    """Argsort by whole numbers, the most significant last as `np.lexsort` has it; linear in time.

    Parameters
    ----------
    *keys : pairs of an array (m,) int and an int
        Numbers, none negative, and a bound that they stay below.

    Returns
    -------
    (m,) int64
        Of equal rows, the ones that come first in the arrays come first.

    Examples
    --------
    >>> sort_stably(([1, 0, 1], 2)).tolist()
    [1, 0, 2]
    """
    order = np.arange(len(keys[0][0]))
    for numbers, bound in keys:
        order = sort_by_counting(np.asarray(numbers), order, bound)[0]
    return order


@njit
def sort_by_counting(numbers, order, bound):
    """Put `order` in ascending order of numbers[order], equal ones left as they are.

    Parameters
    ----------
    numbers : (m,) int
        None negative, all below `bound`.
    order : (m,) int
        A permutation.
    bound : int

    Returns
    -------
    order : (m,), of the same type
    ends : (bound + 1,) int32
        Number k takes the places from ends[k - 1], or 0, up to ends[k].
    """
    ends = find_starts(numbers, bound)
    out = np.empty_like(order)
    for i in order:
        out[ends[numbers[i]]] = i
        ends[numbers[i]] += 1
    return out, ends


@njit
def find_starts(numbers, bound):
    """Find where each number begins once they are sorted.

    Parameters
    ----------
    numbers : (m,) int
        None negative, all below `bound`.
    bound : int

    Returns
    -------
    (bound + 1,) int32
        How many are less than each number up to `bound`.
    """
    starts = np.zeros(bound + 1, np.int32)
    for number in numbers:
        starts[number + 1] += 1
    for number in range(bound):
        starts[number + 1] += starts[number]
    return starts
