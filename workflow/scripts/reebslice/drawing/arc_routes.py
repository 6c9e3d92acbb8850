"""Where the arcs of a simplified graph run in the full one, so that they can be drawn in the body."""

import heapq

import numpy as np

from ..arrays.grouping import list_groups, list_incidence
from ..graphs.shown_arcs import spread_over_arcs

AGAIN = 1e9  # costs of an arc that a route before has taken, against one that none has


def route_arcs(ends, weights, pairs):
    """Find for each arc of a simplified graph a way through the full graph.

    Parameters
    ----------
    ends : (A, 2) int
        Nodes of the arcs of the full graph, the lower first.
    weights : (A,) float64
        Positive: what it costs to go along each.
    pairs : (B, 2) int
        Of each arc of the simplified graph the nodes, the lower first, by their numbers in the full one.

    Returns
    -------
    routes : list of list of int
        Arcs of the full graph from the lower node to the upper one: the cheapest that only rises, and shares
        arcs with routes before it only where it must; or, where none rises, the cheapest; or none.
    owner : (A,) int64
        The simplified arc with which each arc of the full graph counts: that which runs along it, or the nearest.
        -1 on a component of which nothing is left.
    """
    count = int(max(np.max(ends, initial=-1), np.max(pairs, initial=-1))) + 1
    incident = list_groups(list_incidence(np.ascontiguousarray(ends, np.int64).reshape(-1, 2), count))
    owner, routes = np.full(len(ends), -1, np.int32), []
    ends = np.asarray(ends).tolist()
    for number, (low, high) in enumerate(np.asarray(pairs).tolist()):
        costs = np.where(owner >= 0, AGAIN * weights, weights).tolist()
        route = _cheapest_way(ends, incident, costs, low, high, True)
        if route is None:
            route = _cheapest_way(ends, incident, costs, low, high, False) or []
        fresh = [arc for arc in route if owner[arc] < 0]
        owner[fresh] = number
        routes.append(route)
    return routes, spread_over_arcs(ends, owner)


def _cheapest_way(ends, incident, costs, start, goal, rising):
    """Arcs of the cheapest way, that only rises or not, or None; by Dijkstra's algorithm."""
    best, last, queue = {start: 0.0}, {}, [(0.0, start)]
    while queue:
        cost, node = heapq.heappop(queue)
        if node == goal:
            route = []
            while node != start:
                route.append(last[node])
                node = sum(ends[last[node]]) - node  # the other end
            return route[::-1]
        if cost > best[node]:
            continue
        for arc in incident[node]:
            low, high = ends[arc]
            other = high if node == low else low
            if (other == high or not rising) and cost + costs[arc] < best.get(other, np.inf):
                best[other], last[other] = cost + costs[arc], arc
                heapq.heappush(queue, (best[other], other))
    return None
