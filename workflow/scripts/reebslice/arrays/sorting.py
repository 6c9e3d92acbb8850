"""Sorts: of integer keys by counting, and of floats.

Those of floats stand for numpy's inside kernels, which numba compiles for
seconds in every kernel that is the first of its process to call them.
"""

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
        order = sort_by_counting(np.ascontiguousarray(numbers), order, int(bound))[0]
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


@njit(inner=True)
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


@njit
def sort_floats(numbers):
    """Sort floats in place, by Shell's method.

    Parameters
    ----------
    numbers : (n,) float64
        Without NaN; best no more than some thousands.
    """
    gap = len(numbers)
    while gap > 1:
        gap = max(gap * 5 // 11, 1)
        for i in range(gap, len(numbers)):
            number, place = numbers[i], i
            while place >= gap and numbers[place - gap] > number:
                numbers[place] = numbers[place - gap]
                place -= gap
            numbers[place] = number


@njit
def order_floats(numbers):
    """Argsort floats stably, by merging.

    Parameters
    ----------
    numbers : (n,) float64
        Without NaN.

    Returns
    -------
    (n,) int64
        Of equal numbers, the ones that come first come first.
    """
    n, width = len(numbers), 1
    order, merged = np.arange(n), np.empty(n, np.int64)
    while width < n:
        for begin in range(0, n, 2 * width):
            middle, end = min(begin + width, n), min(begin + 2 * width, n)
            i, j = begin, middle
            for place in range(begin, end):
                if j == end or (i < middle and numbers[order[i]] <= numbers[order[j]]):
                    merged[place], i = order[i], i + 1
                else:
                    merged[place], j = order[j], j + 1
        order, merged, width = merged, order, 2 * width
    return order
