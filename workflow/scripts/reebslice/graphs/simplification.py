"""Reeb graphs without the features below a size: pairs of extended persistence, cancelled one by one.

A graph is given by its arcs between nodes 0, 1, ... in order of height; its
nodes may have any degree, as a node that stands for several events has.
"""

import heapq

import numpy as np

from ..morse.persistence import extended_pairs


def simplify_graph(height, arcs, measure, size, kept=()):
    """Cancel all pairs of extended persistence below `size`, the smallest first.

    height : (K,) of the nodes, ascending; arcs : (A, 2) ints, lower end
    first; measure : (A,) of the arcs, such as volumes; kept : nodes that
    stay where they do not branch. Returns arcs (B, 2) and measure (B,), whose
    sum is as before; a node without arcs is gone.

    To cancel a pair is to identify, height by height, the two strands that
    hang from it, down to the minimum (up to the maximum) or until the loop is
    closed. All other pairs stay as they are, except where a strand of a loop
    is not monotone: then others may change by less than the loop's height.
    """
    graph = _Strands(height, arcs, measure)
    unbranched = set(kept)
    while pairs := graph.small_pairs(size):
        for low, high, side in pairs:
            if not graph.cancel(low, high, side):
                break  # the rest of the pairs may have changed
        graph.dissolve(unbranched)
    graph.dissolve(unbranched)
    left = sorted((*graph.ends[arc], arc) for arc in graph.ends)
    return (
        np.array([arc[:2] for arc in left], np.int64).reshape(-1, 2),
        np.array([graph.measure[arc[2]] for arc in left], float),
    )


class _Strands:
    """A graph whose arcs can be glued: ends {arc: [low, high]}, arms[node][side] (0: down, 1: up).

    extreme[side][node] : the farthest node on monotone ways from it downward (upward).
    """

    def __init__(self, height, arcs, measure):
        self.height = np.asarray(height, float).tolist()
        self.measure = dict(enumerate(np.asarray(measure, float).tolist()))
        self.ends = {arc: [int(low), int(high)] for arc, (low, high) in enumerate(arcs)}
        self.arms = [(set(), set()) for _ in self.height]
        for arc, (low, high) in self.ends.items():
            self.arms[low][1].add(arc)
            self.arms[high][0].add(arc)
        self.extreme = [list(range(len(self.height))) for _ in range(2)]
        for low, high in sorted(self.ends.values(), key=lambda ends: ends[1]):
            self.extreme[0][high] = min(self.extreme[0][high], self.extreme[0][low])
        for low, high in sorted(self.ends.values(), key=lambda ends: -ends[0]):
            self.extreme[1][low] = max(self.extreme[1][low], self.extreme[1][high])

    def small_pairs(self, size):
        """(low, high, side to glue on) of all pairs below `size`, the smallest first; loops have side 2."""
        kinds = extended_pairs(len(self.height), list(self.ends.values()))
        kinds = (kinds.ordinary, kinds.relative, kinds.loops)
        pairs = [(*pair, side) for side, pairs in enumerate(kinds) for pair in pairs.tolist()]
        span = {pair: self.height[pair[1]] - self.height[pair[0]] for pair in pairs}
        return sorted((p for p in pairs if span[p] < size), key=lambda p: (span[p], p[1] - p[0], p))

    def cancel(self, low, high, side):
        """Glue the strands of one pair; False if others may have changed, by it or before."""
        if len(self.arms[low if side == 1 else high][side % 2]) < 2:
            return False
        if side == 2:
            return self._glue(high, 0, low) == low
        self._glue(*((high, 0, low) if side == 0 else (low, 1, high)))
        return True

    def _glue(self, node, side, target):
        """Identify two arms of `node` downward (side 0) or upward (1); return where that ends."""
        leads = self._nodes_toward(target, 1 - side, node)
        e, f = self._choose_arms(node, side, leads)
        while True:
            near, far = self.ends[e][side], self.ends[f][side]
            if near == far:
                self._merge(e, f, 1.0)
                return near
            if (near < far) == (side == 0):
                e, f, near, far = f, e, far, near
            # f goes on behind the end of e
            whole = abs(self.height[far] - self.height[node])
            self._merge(e, f, abs(self.height[near] - self.height[node]) / whole if whole else 0.0)
            following = list(self.arms[near][side])
            self._attach(f, 1 - side, near)
            if not following or (near <= target if side == 0 else near >= target):
                return near
            reaching = [arm for arm in following if self.ends[arm][side] in leads]
            node, e = near, min(reaching or following)

    def _choose_arms(self, node, side, leads):
        """Two arms to glue: of several, those that lead to the target first, then those that lead farthest."""
        arms, sign = self.arms[node][side], 1 if side == 0 else -1

        def order(arm):
            end = self.ends[arm][side]
            return end not in leads, sign * self.extreme[side][end], arm

        return heapq.nsmallest(2, arms, order) if len(arms) > 2 else sorted(arms)

    def _nodes_toward(self, target, side, limit):
        """Nodes on monotone ways from the target, downward (side 0) or upward, not beyond `limit`.

        Gluing on the other side of a node changes nothing here.
        """
        seen, stack = {target}, [target]
        while stack:
            for arm in self.arms[stack.pop()][side]:
                end = self.ends[arm][side]
                if end not in seen and (end >= limit if side == 0 else end <= limit):
                    seen.add(end)
                    stack.append(end)
        return seen

    def _merge(self, e, f, share):
        """Give e this share of f's measure; all of it: f is gone."""
        self.measure[e] += self.measure[f] * share
        self.measure[f] *= 1.0 - share
        if share == 1.0 and self.ends[e] == self.ends[f]:
            self._remove(f)

    def _remove(self, arc):
        for side in (0, 1):
            self.arms[self.ends[arc][side]][1 - side].discard(arc)
        del self.ends[arc]

    def _attach(self, arc, side, node):
        self.arms[self.ends[arc][side]][1 - side].discard(arc)
        self.ends[arc][side] = node
        self.arms[node][1 - side].add(arc)
        low, high = self.ends[arc]
        self._extend(high, 0, self.extreme[0][low])
        self._extend(low, 1, self.extreme[1][high])

    def _extend(self, node, side, reached):
        """Note that monotone ways from `node`, downward (side 0) or upward, lead to `reached`."""
        extreme, stack = self.extreme[side], [node]
        while stack:
            node = stack.pop()
            if reached < extreme[node] if side == 0 else reached > extreme[node]:
                extreme[node] = reached
                stack += [self.ends[arm][1 - side] for arm in self.arms[node][1 - side]]

    def dissolve(self, kept):
        """Join the two arcs of every node that does not branch, except `kept`."""
        for node, (down, up) in enumerate(self.arms):
            if len(down) == len(up) == 1 and node not in kept:
                (low,), (high,) = down, up
                self._merge(low, high, 1.0)
                top = self.ends[high][1]
                self._remove(high)
                self._attach(low, 1, top)
