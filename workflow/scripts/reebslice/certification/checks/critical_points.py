"""Checks of the exact Reeb graph of the surface, and of the simplified graphs.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

from collections import Counter

import numpy as np

from ..recount.elders import essential_points
from ..recount.graph_pairs import graph_pairs
from ..recount.graphs import count_loops, find_parts, neighbours
from ..recount.surface import copies


def check_critical(facts, ledger):
    """Every critical point, its partner, and arcs that fit the contours of every level."""
    t, arcs = facts.columns.critical_points, facts.columns.critical_arcs
    surface = facts.surface
    point = np.flatnonzero(surface.index >= 0)
    repeats = copies(surface)[point]
    point = np.repeat(point, repeats)
    ranks = surface.weight[point] + np.arange(len(point)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    ledger.enter("critical_points.rank", np.array_equal(t["rank"], ranks), True)
    if not np.array_equal(t["rank"], ranks):
        raise ValueError("table critical_points does not list the critical points of the surface")
    vertex = surface.origin[point]
    ledger.rows("critical_points.vertex", t["vertex"] == vertex, "the vertex of that rank")
    ledger.rows("critical_points.height", t["height"] == surface.points[point, 2], "height of the vertex")
    ledger.rows("critical_points.index", t["index"] == surface.index[point], "sign changes around it")
    ends = np.stack([arcs["source"], arcs["target"]], axis=1).astype(np.int64)
    for name, end in zip(("lower", "upper"), ends.T):
        ledger.rows(f"critical_arcs.{name}", arcs[name] == t["height"][end], "height of its end")
    _check_pairs(facts, ledger, t, ends, point)
    _check_arcs(facts, ledger, t, ends)


def _check_pairs(facts, ledger, t, ends, point):
    """Partners by the elder rule on the whole surface, and of loops on the graph."""
    n, partner, index = len(t["rank"]), t["partner"], t["index"]
    ledger.rows("critical_points.partner", partner[partner] == np.arange(n), "each the partner of its partner")
    span = np.abs(t["height"] - t["height"][partner])
    ledger.rows("critical_points.persistence", t["persistence"] == span, "height to the partner")
    words = {(0, 1): "ordinary", (1, 2): "relative", (1, 1): "loop", (0, 2): "extended"}
    named = [words.get(tuple(sorted(pair))) for pair in zip(index.tolist(), index[partner].tolist())]
    ledger.rows("critical_points.pairing", [a == b for a, b in zip(t["pairing"], named)], "by the two indices")
    of_pairing = {
        word: np.array([(min(k, p), max(k, p)) for k, p in enumerate(partner.tolist()) if named[k] == word and k < p])
        for word in words.values()
    }
    stated = np.concatenate([of_pairing[word].reshape(-1, 2) for word in ("ordinary", "relative")]).astype(int)
    _, pairs = essential_points(facts.surface, facts.sides)
    stated, pairs = (sorted(map(tuple, np.sort(ends, axis=1).tolist())) for ends in (point[stated], pairs))
    ledger.enter("critical_points.pairs of components", stated == pairs, True)
    minima, maxima, loops = graph_pairs(n, ends)
    found = [sorted(map(tuple, of_pairing[word].tolist())) for word in ("ordinary", "relative", "loop")]
    ledger.enter("critical_arcs: pairs of components", found[:2] == [minima, maxima], True)
    ledger.enter("critical_points.pairs of loops", found[2] == loops, True)
    shell = facts.shell_of_vertex[t["vertex"]]
    lowest = np.unique(shell, return_index=True)[1]
    highest = n - 1 - np.unique(shell[::-1], return_index=True)[1]
    ledger.rows("critical_points.pairs of shells", partner[lowest] == highest, "lowest and highest point of the shell")


def _check_arcs(facts, ledger, t, ends):
    """Degrees, loops, and as many arcs at every level as the level has contours of each shell."""
    n, index, shell = len(t["rank"]), t["index"], facts.shell_of_vertex[t["vertex"]]
    ledger.rows("critical_arcs.ends", (ends[:, 0] < ends[:, 1]) & (shell[ends[:, 0]] == shell[ends[:, 1]]), "upward")
    up, down = np.bincount(ends[:, 0], minlength=n), np.bincount(ends[:, 1], minlength=n)
    union = np.isin(t["pairing"], ("ordinary",)) | ((t["pairing"] == "loop") & (t["partner"] < np.arange(n)))
    wanted = np.select([index == 0, index == 2, union], [10, 1, 12], 21)
    ledger.rows("critical_arcs.degrees", 10 * up + down == wanted, "arcs above and below its critical points")
    genus = np.bincount(shell[ends[:, 0]], minlength=facts.n_shells) - np.bincount(shell, minlength=facts.n_shells) + 1
    ledger.rows("critical_arcs.loops", genus == facts.shell_genus, "genus of the shell")
    ledger.enter("critical_arcs.components", len(np.unique(count_loops(n, ends)[1])), facts.n_shells)
    below = facts.columns.levels["vertices_below"]
    first, last = (np.searchsorted(below, t["rank"][end], side="right") for end in ends.T)
    of_arc, levels = shell[ends[:, 0]], len(below)
    change = np.zeros((facts.n_shells, levels + 1), np.int64)
    np.add.at(change, (of_arc, first), 1)
    np.add.at(change, (of_arc, last), -1)
    contours = np.zeros((facts.n_shells, levels), np.int64)
    np.add.at(contours, (facts.columns.contours["shell"], facts.columns.contours["level"]), 1)
    same = (np.cumsum(change, axis=1)[:, :levels] == contours).all(axis=0)
    ledger.rows("critical_arcs.at_levels", same, "as many arcs of each shell as contours")


def check_simplified(facts, ledger):
    """Graphs without pairs below the feature size, and everything above it still there."""
    shown, left_out = {}, {}
    for graph, measure in (("solid", "volume"), ("surface", "area")):
        full, simple, name = facts.graphs[graph], facts.graphs[f"{graph}_simplified"], f"{graph}_simplified"
        same = [full.nodes.get(node) == data for node, data in simple.nodes.items()]
        ledger.rows(f"{name}.nodes", same, f"nodes of the graph {graph}, with their attributes")
        if not all(same):
            continue
        parts = _large_components(facts, full)
        left_out[graph] = len(find_parts(full)) - len(parts)
        height = {node: data["height"] for node, data in full.nodes.items()}
        _check_shown(ledger, name, measure, full, simple, parts)
        letter = "s" if graph == "solid" else "c"
        edges = [
            d.get("id") == key == f"{letter}{d.get('arc')}"
            and [d.get("lower"), d.get("upper")] == sorted((height[a], height[b]))
            for a, b, key, d in simple.edges
        ]
        ledger.rows(f"{name}.edges", edges, "id, and heights of its ends")
        shown[graph] = _check_pairs_shown(facts, ledger, name, full, simple, height, left_out[graph])
    if len(shown) == 2:
        _count_suppressed(facts, ledger, shown, left_out)


def _check_shown(ledger, name, measure, full, simple, parts):
    """Of the large components something is shown, of the others nothing, and areas or volumes are kept."""
    ledger.rows(f"{name}.components", [not part.isdisjoint(simple.nodes) for part in parts], "shown if large")
    large = set().union(*parts)
    ledger.rows(f"{name}.component", [node in large for node in simple.nodes], "in a component that is shown")
    total = [sum(d.get(measure, 0.0) for a, _, _, d in g.edges if a in large) for g in (full, simple)]
    ledger.close(f"{name}.{measure}", total[1], total[0], 1e-9 * sum(abs(t) for t in total))


def _check_pairs_shown(facts, ledger, name, full, simple, height, left_out):
    """No pair is below the feature size, and those above it are kept; the number of loops shown."""
    before, after = _graph_pairs(full, height), _graph_pairs(simple, height)
    large, kept = (
        [[(a, b) for a, b in kind if height[b] - height[a] >= facts.size] for kind in pairs]
        for pairs in (before, after)
    )
    ledger.enter(f"{name}: pairs below the feature size", sum(map(len, after)) - sum(map(len, kept)), 0)
    if len(large[2]) == len(before[2]):  # gluing a loop may move other pairs
        ledger.enter(f"{name}: pairs of the feature size", after == large, True)
    if large == before and not left_out:  # nothing to cancel
        ledger.enter(f"{name}: arcs", _ends(neighbours(simple)) == _ends(_without_passed(full, simple)), True)
    else:
        around = neighbours(full)
        joined = [_joined(around, height, a, b, facts.size) for a, b, *_ in simple.edges]
        ledger.rows(f"{name}.ends", joined, "joined in the full graph, by a way not far beyond their heights")
    return len(after[2])


def _count_suppressed(facts, ledger, shown, left_out):
    """Loops and components that the simplified graphs leave out, so that the genus is still told in full."""
    suppressed = facts.loops_surface - shown["surface"]
    facts.simplified = {
        "loops_surface": shown["surface"],
        "loops_solid": shown["solid"],
        "suppressed_loops": suppressed,
        "suppressed_shells": left_out["surface"],
        "suppressed_parts": left_out["solid"],
        "nodes_surface": len(facts.graphs["surface_simplified"].nodes),
        "nodes_solid": len(facts.graphs["solid_simplified"].nodes),
    }
    loops = shown["surface"] + suppressed + facts.hidden
    holds = loops == facts.genus and suppressed >= 0
    ledger.enter("genus = simplified loops + suppressed + hidden", loops, facts.genus, holds)


def _ends(around):
    """How often two nodes are neighbours, counted from both: {set of them: times}."""
    return Counter(frozenset((node, other)) for node, others in around.items() for other in others)


def _without_passed(full, simple):
    """Neighbours in the full graph without those of its nodes that the simple one lacks and that do not branch."""
    around = neighbours(full)
    for node in full.nodes.keys() - simple.nodes.keys():
        if len(around[node]) == 2:
            a, b = around.pop(node)
            for end, other in ((a, b), (b, a)):
                around[end].remove(node)
                around[end].append(other)
    return around


def _joined(around, height, a, b, slack):
    """Whether a way leads from a to b that stays within their heights, widened by `slack`."""
    low, high = min(height[a], height[b]) - slack, max(height[a], height[b]) + slack
    seen, stack = {a}, [a]
    while stack:
        for node in around[stack.pop()]:
            if node not in seen and low <= height[node] <= high:
                seen.add(node)
                stack.append(node)
    return b in seen


def _large_components(facts, graph):
    """Sets of nodes of those components that are at least as high as the feature size.

    A node without edges stands for what lies between two levels; its height
    is its persistence.
    """
    handles, large, around = facts.columns.handles, [], neighbours(graph)
    for part in find_parts(graph):
        heights = [graph.nodes[node]["height"] for node in part]
        lone = len(part) == 1 and not around[next(iter(part))]
        height = handles["persistence"][int(next(iter(part))[1:])] if lone else max(heights) - min(heights)
        if height >= facts.size:
            large.append(part)
    return large


def _graph_pairs(graph, height):
    """Extended persistence of a graph, its nodes by name: three sorted lists of (lower, upper)."""
    order = sorted(graph.nodes, key=lambda node: (height[node], int(node[1:])))
    place = {node: k for k, node in enumerate(order)}
    ends = [sorted((place[a], place[b])) for a, b, *_ in graph.edges]
    kinds = graph_pairs(len(order), ends)
    return [sorted((order[low], order[high]) for low, high in kind) for kind in kinds]
