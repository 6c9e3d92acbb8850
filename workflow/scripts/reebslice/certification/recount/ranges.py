"""Members by group, and ranges of numbers, as arrays."""

from itertools import pairwise

import numpy as np


def expand_ranges(begin, end):
    """Number the members of ranges, one range after the other.

    Parameters
    ----------
    begin, end : (k,) int

    Returns
    -------
    owner, member : (n,) int
        The range that each member is of, and the member: from `begin` up to but not `end`.
    """
    counts = end - begin
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) + (end - np.cumsum(counts))[owner]


def list_members(group, n, values=None):
    """List the members of each of n groups.

    Parameters
    ----------
    group : (k,) int
        Of each member.
    n : int
    values : (k,) int, optional
        What to list of the members; if not given, their numbers.

    Returns
    -------
    list of n lists of int
    """
    order = np.argsort(group, kind="stable")
    members = (order if values is None else values[order]).tolist()
    bounds = np.searchsorted(group[order], np.arange(n + 1)).tolist()
    return [members[begin:end] for begin, end in pairwise(bounds)]
