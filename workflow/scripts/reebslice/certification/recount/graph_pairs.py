"""Extended persistence of a graph, counted again.

Components by minimum spanning trees. Of a loop the top is the upper end of an
arc whose ends hang together below it already; its bottom is the lowest node
that cannot be avoided between them: that of the way whose lowest node is
highest, which a search that always goes on from the highest node finds.
"""

from heapq import heappop, heappush

import numpy as np

from .components import find_root, first_parents, join
from .elders import elder_pairs


def graph_pairs(n_nodes, ends):
    """Pair the nodes of a graph by extended persistence.

    Parameters
    ----------
    n_nodes : int
        Nodes are numbered in order of height.
    ends : (A, 2) int
        The two nodes of each arc, the lower one first.

    Returns
    -------
    minima, maxima, loops : list of (lower, upper)
        Components of sublevel sets, of superlevel sets, and loops; sorted.
    """
    low, high = np.asarray(ends, np.int64).reshape(-1, 2).T
    last = n_nodes - 1
    minima = elder_pairs(low, high, n_nodes, 0)
    maxima = last - elder_pairs(last - high, last - low, n_nodes, 0)[:, ::-1]
    trees, around, loops = first_parents(n_nodes), [[] for _ in range(n_nodes)], []
    order = np.argsort(high, kind="stable")
    for a, b in zip(low[order].tolist(), high[order].tolist()):
        if find_root(trees, a) == find_root(trees, b):
            loops.append((_find_bottom(around, a, b), b))
        join(trees, a, b)
        around[a].append(b)
        around[b].append(a)
    return sorted(map(tuple, minima.tolist())), sorted(map(tuple, maxima.tolist())), sorted(loops)


def _find_bottom(around, start, end):
    """Of the ways between two nodes of a graph, the lowest node of the one where that is highest."""
    seen, reached, bottom = {start}, [-start], start
    while (node := -heappop(reached)) != end:
        bottom = min(bottom, node)
        for other in around[node]:
            if other not in seen:
                seen.add(other)
                heappush(reached, -other)
    return bottom
