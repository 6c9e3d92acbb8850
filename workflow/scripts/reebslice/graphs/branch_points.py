"""Where the branches of centrelines meet and end.

The contour at which a tube parts in two touches the wall between them, and its centre lies there; the tube parts
earlier, at the last centre that still reaches the wall.
"""

import numpy as np


def move_branch_points(found, points, reach):
    """Move each node at which branches meet into the tube, in place.

    Parameters
    ----------
    found : Branches
    points, reach : (P, 3) and (P,) float64
        Of all points of its chains; what lies within its reach is not told apart from a point.

    Notes
    -----
    Of the centres along the branches, not beyond their middle, within whose reach all of the path up to the
    node is, it becomes the one that reaches farthest. What the other branches have within reach goes, so that they
    begin there.
    """
    for node in sorted(node for node, branches in found.at.items() if len(branches) > 2):
        ways = [(branch, end) for branch in sorted(set(found.at[node])) for end in found.ends_at(branch, node)]
        best = None
        for branch, end in ways:
            way = found.way(branch, end)
            half = (len(way) + 1) // 2
            held = _list_held(points[way], reach[way], half)
            if held and (best is None or reach[way[held[-1]]] > reach[best[2]]):
                best = branch, end, way[held[-1]]
        if best is not None and reach[best[2]] > reach[node]:
            _move(found, node, ways, best, points, reach)


def _list_held(path, reach, end):
    """Places from 1 up to `end` of a path within whose reach all of it before is, ascending."""
    likely = np.flatnonzero(np.linalg.norm(path[:end] - path[0], axis=1) <= reach[:end])
    return [k for k in likely.tolist() if k and _are_within(path[:k], path[k], reach[k])]


def _are_within(points, centre, reach):
    return bool((np.linalg.norm(points - centre, axis=1) <= reach).all())


def _move(found, node, ways, best, points, reach):
    """Let all `ways` from a node begin at the point of `best` instead."""
    branch_of_it, end_of_it, centre = best
    for branch, end in ways:
        way = found.way(branch, end)
        half = (len(way) + 1) // 2
        if (branch, end) == (branch_of_it, end_of_it):
            rest = way[way.index(centre) + 1 :]
        else:
            outside = (
                k for k in range(1, half) if not _are_within(points[way[k]][None], points[centre], reach[centre])
            )
            rest = way[next(outside, half) :]
        found.set_way(branch, end, [centre, *rest])
    found.at[centre] = found.at.pop(node)


def trim_end(chain, is_free, points, reach):
    """Cut the free ends off a branch, each at the last centre that reaches all of the path behind it.

    Parameters
    ----------
    chain : list of int
        Points.
    is_free : (bool, bool)
        Of its first and of its last point.
    points, reach : (P, 3) and (P,) float64

    Returns
    -------
    list of int
        The rest; the whole where that would be a point or nothing.
    """
    cuts = [0, 0]
    for side, way in ((0, chain), (1, chain[::-1])):
        if is_free[side]:
            held = _list_held(points[way], reach[way], len(way) - 1)
            cuts[side] = held[-1] if held else 0
    rest = chain[cuts[0] : len(chain) - cuts[1]]
    return rest if len(rest) > 1 else chain
