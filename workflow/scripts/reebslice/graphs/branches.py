"""Branches of a graph in space: short leaves cut off, what does not branch joined, loops kept."""

import numpy as np


class Branches:
    """An undirected multigraph whose edges are chains of points; all but loops may be pruned.

    Attributes
    ----------
    chains : dict of int to list of int
        Points of each branch, from node to node.
    arcs : dict of int to set of int
        The arcs of the Reeb graph that each branch was made of, and those of leaves that were cut off there.
    at : dict of int to list of int
        Branches at each node, one that begins and ends there twice.
    """

    def __init__(self, chains):
        """Take the arcs as branches: lists of points, the first and the last one of each being nodes."""
        self.chains = dict(enumerate(chains))
        self.arcs = {arc: {arc} for arc in self.chains}
        self.at = {}
        for arc, chain in self.chains.items():
            for node in (chain[0], chain[-1]):
                self.at.setdefault(node, []).append(arc)

    def prune(self, span, is_short):
        """Cut off short leaves, those with the smallest span first, and join what does not branch any more.

        Parameters
        ----------
        span : list of float
            Of every arc.
        is_short : callable
            Whether a leaf is short, from its points, the node that it hangs from first.
        """
        while True:
            leaves = sorted((max(span[arc] for arc in self.arcs[b]), b) for b in self.chains if self._is_leaf(b))
            short = next((b for _, b in leaves if is_short(self._from_node(b))), None)
            if short is None:
                break
            node = self._from_node(short)[0]
            self._remove(short)
            self.arcs[min(self.at[node])] |= self.arcs.pop(short)
            self.join(node)

    def ends_at(self, branch, node):
        """The ends, 0 and -1, that a branch has at a node."""
        return [end for end in (0, -1) if self.chains[branch][end] == node]

    def way(self, branch, end):
        """The points of a branch from one end, 0 or -1, on."""
        return self.chains[branch] if end == 0 else self.chains[branch][::-1]

    def set_way(self, branch, end, way):
        """Replace the points of a branch by others, told from one end on; nodes are left to the caller."""
        self.chains[branch] = way if end == 0 else way[::-1]

    def _is_leaf(self, branch):
        """Whether one end is free and the other one has branches besides."""
        degrees = sorted(len(self.at[self.chains[branch][end]]) for end in (0, -1))
        return degrees[0] == 1 and degrees[1] > 1

    def _from_node(self, branch):
        chain = self.chains[branch]
        return chain if len(self.at[chain[0]]) > 1 else chain[::-1]

    def _remove(self, branch):
        chain = self.chains.pop(branch)
        for node in (chain[0], chain[-1]):
            self.at[node].remove(branch)
            if not self.at[node]:
                del self.at[node]

    def join(self, node):
        """Join the two branches of a node that has two and is not the end of a closed one alone."""
        if len(self.at[node]) != 2 or len(set(self.at[node])) == 1:
            return
        first, second = sorted(self.at[node])
        one, other = self.chains[first], self.chains[second]
        one = one if one[-1] == node else one[::-1]
        other = other if other[0] == node else other[::-1]
        arcs = self.arcs.pop(second)
        self._remove(second)
        self._remove(first)
        self.chains[first] = chain = one + other[1:]
        self.arcs[first] |= arcs
        for end in (chain[0], chain[-1]):
            self.at.setdefault(end, []).append(first)


def count_loops(branches):
    """Count the independent loops of a :class:`Branches`."""
    parent = {node: node for node in branches.at}
    loops = 0
    for chain in branches.chains.values():
        roots = []
        for node in (chain[0], chain[-1]):
            while parent[node] != node:
                node = parent[node]
            roots.append(node)
        loops += roots[0] == roots[1]
        parent[roots[1]] = roots[0]
    return loops


def path_lengths(points):
    """Length of a path up to each of its points, (n,) float64."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
