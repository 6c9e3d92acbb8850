"""Connected components by joining sets, compiled: the part that every recount shares."""

import numpy as np

from ...kernels import njit


@njit
def find_root(parent, i):
    """Find the root of `i`; ways up are halved as they are walked.

    Parameters
    ----------
    parent : (n,) int
        Trees by the parent of each member, a root its own; changed in place.
    i : int

    Returns
    -------
    int
    """
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit
def first_parents(n):
    """Trees of one member each: (n,) int32."""
    parent = np.empty(n, np.int32)
    for i in range(n):
        parent[i] = i
    return parent


@njit
def join(parent, a, b):
    """Join two sets; the smaller root becomes that of both, so no root is above its members.

    Parameters
    ----------
    parent : (n,) int
        Changed in place.
    a, b : int
        Members of the sets.
    """
    if parent[a] != parent[b]:  # most often they have been joined before
        a, b = find_root(parent, np.int64(a)), find_root(parent, np.int64(b))
        parent[max(a, b)] = min(a, b)


@njit(inner=True)
def number_sets(parent):
    """Turn `parent`, in place, into the number of each one's set, by first members; return how many there are."""
    count = 0
    for i in range(len(parent)):
        if parent[i] == i:
            parent[i] = count
            count += 1
        else:
            parent[i] = parent[parent[i]]
    return count


@njit
def _components(one, two, n):
    """As :func:`find_components`, of int32."""
    parent = first_parents(n)
    for k in range(len(one)):
        join(parent, np.int64(one[k]), np.int64(two[k]))
    return number_sets(parent), parent


def find_components(one, two, n):
    """Find the components of a graph on 0..n-1.

    Parameters
    ----------
    one, two : (k,) int
        The ends of its links.
    n : int

    Returns
    -------
    count : int
    component : (n,) int32
        Of each node; components are numbered by their first nodes.

    Raises
    ------
    ValueError
        For a link to a node that is none.
    """
    for ends in (one, two):
        if len(ends) and not (np.min(ends) >= 0 and np.max(ends) < n):
            raise ValueError("a link to what is not there")
    return _components(np.ascontiguousarray(one, np.int32), np.ascontiguousarray(two, np.int32), n)
