"""Pairs of critical points at one height taken out of a graph of the solid.

The order of ranks makes them inside flats: a part that begins and joins another
at the same height, or parts and ends there. They are no features of the height.
"""

import numpy as np


def find_flat_pairs(height, graph):
    """List the pairs that the height does not show.

    Parameters
    ----------
    height : (K,) float64
        Of the nodes of the graph.
    graph : ReebGraph
        A surface's.

    Returns
    -------
    (P, 2) int64
        Places in `graph.nodes`, the lower one first: an extremum and the saddle that it cancels with, at one height.
        Nested pairs come before those around them.
    """
    is_extremum = np.bincount(graph.arcs.ravel(), minlength=len(height)) == 1
    low, high = np.arange(len(height)), graph.partner
    flat = (low < high) & (height == height[high]) & (is_extremum != is_extremum[high])
    pairs = np.column_stack([low, high])[flat].astype(np.int64)
    return pairs[np.lexsort((pairs[:, 0], pairs[:, 1] - pairs[:, 0]))]


def cancel_pairs(arcs, count, pairs):
    """Take pairs of nodes out of a graph of a solid.

    Parameters
    ----------
    arcs : (A, 2) int
        Nodes that each arc joins, the lower end first. Every node ends at most two arcs and begins at most two.
    count : int
        Number of nodes; they are 0, 1, ... upward.
    pairs : (P, 2) int
        Of :func:`find_flat_pairs`.

    Returns
    -------
    (B, 2) int64
        Arcs between the nodes that are left, in any order. Two events of holes go from the arcs that they part. A part
        that begins and joins another, or parts and ends, goes with its arc; events of holes on that arc go
        over to the other part. A pair stays where more than these happens in between.
    """
    links = [[[] for _ in range(count)], [[] for _ in range(count)]]  # from every node down, and up
    for low, high in arcs.tolist():
        links[1][low].append(high)
        links[0][high].append(low)
    for low, high in pairs.tolist():
        shape = tuple(len(side[node]) for node in (low, high) for side in links)
        if shape == (1, 1, 1, 1):
            _smooth(links, low)
            _smooth(links, high)
        elif shape == (0, 1, 2, 1):
            _fold(links, low, high, 1)
        elif shape == (1, 2, 1, 0):
            _fold(links, high, low, 0)
    return np.array([(low, high) for low in range(count) for high in links[1][low]], np.int64).reshape(-1, 2)


def _smooth(links, node):
    """Join the two arcs at a node to one."""
    (low,), (high,) = links[0][node], links[1][node]
    links[1][low][links[1][low].index(node)] = high
    links[0][high][links[0][high].index(node)] = low
    links[0][node], links[1][node] = [], []


def _fold(links, leaf, fork, way):
    """Take out the branch from a leaf to a fork; way : 1 if the fork is above the leaf.

    What the branch hosts goes to the other one that meets it in the fork.
    """
    ahead, back = links[way], links[1 - way]
    chain = [leaf]
    while ahead[chain[-1]] != [fork]:
        chain.append(ahead[chain[-1]][0])
        if len(ahead[chain[-1]]) != 1 or len(back[chain[-1]]) != 1:
            return
    moved = chain[1:]
    rest = list(back[fork])
    rest.remove(chain[-1])
    slots = _find_slots(links, rest[0], fork, moved[::-1], way)
    if slots is None:
        return
    back[fork].remove(chain[-1])
    for node in chain:
        ahead[node], back[node] = [], []
    for node, (near, far) in zip(moved[::-1], slots):
        back[far][back[far].index(near)] = node
        ahead[near][ahead[near].index(far)] = node
        ahead[node], back[node] = [far], [near]
    _smooth(links, fork)


def _find_slots(links, near, far, moved, way):
    """Ends of the arc that each moved node parts, from the fork on; None where the way back forks before.

    near, far : ends of the arc right behind the fork.
    """
    slots = []
    for node in moved:
        while (near > node) if way else (near < node):
            if len(links[1 - way][near]) != 1:
                return None
            near, far = links[1 - way][near][0], near
        slots.append((near, far))
        far = node
    return slots
