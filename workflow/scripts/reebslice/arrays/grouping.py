"""Groups of items, and runs of consecutive items that fit in memory."""

import itertools
from typing import NamedTuple

import numpy as np

from ..kernels import njit


class Groups(NamedTuple):
    """Members of G groups, one group after the other (compressed sparse rows).

    Attributes
    ----------
    start : (G + 1,) int64
        Group g owns ``member[start[g]:start[g + 1]]``.
    member : (M,) int
        Ids of the members.
    """

    start: np.ndarray
    member: np.ndarray


@njit
def group_items(group, count):
    """Sort items by their group, with one counting sort.

    Parameters
    ----------
    group : (M,) int
        The group of every item, from 0 to `count` - 1.
    count : int
        Number of groups; groups may be empty.

    Returns
    -------
    Groups
        The members are the places of the items in `group`, ascending within each group.
    """
    start = np.zeros(count + 1, np.int64)
    for g in group:
        start[g + 1] += 1
    for g in range(count):
        start[g + 1] += start[g]
    fill, member = start[:-1].copy(), np.empty(len(group), np.int64)
    for i in range(len(group)):
        member[fill[group[i]]] = i
        fill[group[i]] += 1
    return Groups(start, member)


@njit
def list_incidence(ends, n):
    """List the edges at every node of a graph.

    Parameters
    ----------
    ends : (E, 2) int
        The two nodes of every edge.
    n : int
        Number of nodes.

    Returns
    -------
    Groups
        The edges of each node, ascending; an edge from a node to itself is listed twice.
    """
    sides = group_items(ends.ravel(), n)
    return Groups(sides.start, sides.member // 2)


def group_of_members(groups):
    """Tell the group of every member of :class:`Groups`, (M,) int64."""
    return np.repeat(np.arange(len(groups.start) - 1), np.diff(groups.start))


def list_groups(groups):
    """Convert :class:`Groups` to a list of G lists of ids."""
    member, start = groups.member.tolist(), groups.start.tolist()
    return [member[a:b] for a, b in itertools.pairwise(start)]


def split_into_blocks(total, most):
    """Split consecutive items into blocks of bounded size.

    Parameters
    ----------
    total : (N + 1,) array, ascending
        Cumulative sizes: ``total[i]`` is the size of the first i items together.
    most : number
        Bound on the size of a block.

    Yields
    ------
    first, end : int
        A block of the items from `first` up to `end`. Its size is at most `most`, or it is one item.
        There is at least one block, which is empty if there are no items.
    """
    first = 0
    while first == 0 or first < len(total) - 1:
        end = int(np.searchsorted(total, total[first] + most, side="right")) - 1
        end = min(max(first + 1, end), len(total) - 1)
        yield first, end
        first = max(end, 1)
