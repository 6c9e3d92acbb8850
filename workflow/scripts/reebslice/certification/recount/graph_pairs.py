"""Extended persistence of a graph, counted again.

Components by minimum spanning trees. Loops by a maximum spanning forest that
grows with the height, each arc weighted by its lower end: an arc that closes
a loop takes the place of the lowest arc in it, whose lower end is the bottom.
"""

import numpy as np

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
    order = np.argsort(high, kind="stable")
    forest = _Forest(n_nodes)
    loops = [(forest.add(a, b), b) for a, b in zip(low[order].tolist(), high[order].tolist())]
    loops = [pair for pair in loops if pair[0] is not None]
    return sorted(map(tuple, minima.tolist())), sorted(map(tuple, maxima.tolist())), sorted(loops)


class _Forest:
    """Trees by the parent of every node, -1 at a root; weight : of the arc to the parent."""

    def __init__(self, n_nodes):
        self.parent, self.weight = [-1] * n_nodes, [-1] * n_nodes
        self.group, self.members = list(range(n_nodes)), [[node] for node in range(n_nodes)]

    def add(self, low, high):
        """Add an arc; the bottom of the loop that it closes, None if it joins two trees."""
        if self.group[low] == self.group[high]:
            child, bottom = self._lowest_arc(low, high)
            start = low if child in self._way_up(low) else high
            self._hang(start, low + high - start, low, child)
            return bottom
        small, large = sorted((low, high), key=lambda node: len(self.members[self.group[node]]))
        moved, kept = self.group[small], self.group[large]
        for node in self.members[moved]:
            self.group[node] = kept
        self.members[kept] += self.members[moved]
        self.members[moved] = []
        self._hang(small, large, low, None)
        return None

    def _way_up(self, node):
        """The nodes from one up to its root."""
        way = [node]
        while (node := self.parent[node]) >= 0:
            way.append(node)
        return way

    def _lowest_arc(self, a, b):
        """The arc of least weight between two nodes of a tree: (its child, weight)."""
        ways = [self._way_up(a), self._way_up(b)]
        while ways[0] and ways[1] and ways[0][-1] == ways[1][-1]:
            ways[0].pop(), ways[1].pop()
        child = min((*ways[0], *ways[1]), key=self.weight.__getitem__)
        return child, self.weight[child]

    def _hang(self, node, parent, weight, last):
        """Turn the way up from `node` round, as far as `last` (None: the root), and hang it from `parent`."""
        while node >= 0:
            following, ahead = self.parent[node], self.weight[node]
            self.parent[node], self.weight[node] = parent, weight
            if node == last:
                return
            node, parent, weight = following, node, ahead
