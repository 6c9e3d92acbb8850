"""Checks of the exact Reeb graph of the surface, and of the simplified graphs.

Each takes the :class:`facts.Facts` known so far and a ledger to enter its findings in;
what it recomputes it leaves in the facts for later checks.
"""

import numpy as np

from ..recount.elders import essential_points
from ..recount.graph_pairs import graph_pairs
from ..recount.graphs import count_loops, find_parts, neighbours
from ..recount.ranges import expand_ranges
from ..recount.surface import copies

PAIRINGS = {(0, 1): "ordinary", (1, 2): "relative", (1, 1): "loop", (0, 2): "extended"}


def check_critical(facts, ledger):
    """Every critical point, its partner, and arcs that fit the contours of every level."""
    t, arcs, surface = facts.columns.critical_points, facts.columns.critical_arcs, facts.surface
    count = np.where(surface.index >= 0, copies(surface), 0)
    point, ranks = expand_ranges(surface.weight[:-1], surface.weight[:-1] + count)
    ledger.enter("critical_points.rank", np.array_equal(t["rank"], ranks), True)
    if not np.array_equal(t["rank"], ranks):
        raise ValueError("table critical_points does not list the critical points of the surface")
    ledger.compare(
        "critical_points", t,
        ("vertex", surface.origin[point], "the vertex of that rank"),
        ("height", surface.points[point, 2], "height of the vertex"),
        ("index", surface.index[point], "sign changes around it"),
    )  # fmt: skip
    ends = np.stack([arcs["source"], arcs["target"]], axis=1).astype(np.int64)
    low, high = t["height"][ends].T
    ledger.compare("critical_arcs", arcs, ("lower", low, "height of its end"), ("upper", high, "height of its end"))
    _check_pairs(facts, ledger, t, ends, point)
    _check_arcs(facts, ledger, t, ends)


def _check_pairs(facts, ledger, t, ends, point):
    """Partners by the elder rule on the whole surface, and of loops on the graph."""
    n, partner, index = len(t["rank"]), t["partner"], t["index"]
    named = [PAIRINGS.get(tuple(sorted(pair))) for pair in zip(index.tolist(), index[partner].tolist())]
    ledger.rows("critical_points.partner", partner[partner] == np.arange(n), "each the partner of its partner")
    ledger.compare(
        "critical_points", t,
        ("persistence", np.abs(t["height"] - t["height"][partner]), "height to the partner"),
        ("pairing", np.array(named, object), "by the two indices"),
    )  # fmt: skip
    pairs = {word: [] for word in PAIRINGS.values()}
    for k, (other, word) in enumerate(zip(partner.tolist(), named)):
        if k < other and word:
            pairs[word].append((k, other))
    stated = point[np.array(pairs["ordinary"] + pairs["relative"], np.int64).reshape(-1, 2)]
    _, expected = essential_points(facts.surface, facts.sides)
    same = sorted(stated.tolist()) == sorted(np.sort(expected, axis=1).tolist())
    ledger.enter("critical_points.pairs of components", same, True)
    minima, maxima, loops = graph_pairs(n, ends)
    same = (pairs["ordinary"], pairs["relative"]) == (minima, maxima)
    ledger.enter("critical_arcs: pairs of components", same, True)
    ledger.enter("critical_points.pairs of loops", pairs["loop"] == loops, True)
    shell = facts.shell_of_vertex[t["vertex"]]
    lowest, highest = np.unique(shell, return_index=True)[1], np.unique(shell[::-1], return_index=True)[1]
    same = partner[lowest] == n - 1 - highest
    ledger.rows("critical_points.pairs of shells", same, "lowest and highest point of the shell")


def _check_arcs(facts, ledger, t, ends):
    """Degrees, loops, and as many arcs at every level as the level has contours of each shell."""
    n, index, shell, (low, high) = len(t["rank"]), t["index"], facts.shell_of_vertex[t["vertex"]], ends.T
    ledger.rows("critical_arcs.ends", (low < high) & (shell[low] == shell[high]), "upward")
    up, down = np.bincount(low, minlength=n), np.bincount(high, minlength=n)
    union = (t["pairing"] == "ordinary") | ((t["pairing"] == "loop") & (t["partner"] < np.arange(n)))
    wanted = np.select([index == 0, index == 2, union], [10, 1, 12], 21)
    ledger.rows("critical_arcs.degrees", 10 * up + down == wanted, "arcs above and below its critical points")
    n_arcs, n_points = (np.bincount(of, minlength=facts.n_shells) for of in (shell[low], shell))
    ledger.rows("critical_arcs.loops", n_arcs - n_points + 1 == facts.shell_genus, "genus of the shell")
    ledger.enter("critical_arcs.components", len(np.unique(count_loops(n, ends)[1])), facts.n_shells)
    below, contours = facts.columns.levels["vertices_below"], facts.columns.contours
    passing = np.zeros((facts.n_shells, len(below) + 1), np.int64)
    for end, step in ((low, 1), (high, -1)):
        np.add.at(passing, (shell[low], np.searchsorted(below, t["rank"][end], side="right")), step)
    passing = np.cumsum(passing, axis=1)
    np.subtract.at(passing, (contours["shell"], contours["level"]), 1)
    ledger.rows("critical_arcs.at_levels", ~passing[:, :-1].any(axis=0), "as many arcs of each shell as contours")


def check_simplified(facts, ledger):
    """Graphs without pairs below the feature size, and everything above it still there."""
    loops, left_out = {}, {}
    for graph, measure, letter in (("solid", "volume", "s"), ("surface", "area", "c")):
        full, simple, name = facts.graphs[graph], facts.graphs[f"{graph}_simplified"], f"{graph}_simplified"
        same = [full.nodes.get(node) == data for node, data in simple.nodes.items()]
        ledger.rows(f"{name}.nodes", same, f"nodes of the graph {graph}, with their attributes")
        if not all(same):
            return
        height, parts = {node: data["height"] for node, data in full.nodes.items()}, find_parts(full)
        large = [part for part in parts if _height_of(facts, part, height) >= facts.size]
        left_out[graph] = len(parts) - len(large)
        shown = [not part.isdisjoint(simple.nodes) for part in large]
        ledger.rows(f"{name}.components", shown, "shown if large")
        large = set().union(*large)
        ledger.rows(f"{name}.component", [node in large for node in simple.nodes], "in a component that is shown")
        total = [sum(d.get(measure, 0.0) for a, _, _, d in g.edges if a in large) for g in (full, simple)]
        ledger.close(f"{name}.{measure}", total[1], total[0], 1e-9 * sum(abs(t) for t in total))
        edges = [
            d.get("id") == key == f"{letter}{d.get('arc')}"
            and [d.get("lower"), d.get("upper")] == sorted((height[a], height[b]))
            for a, b, key, d in simple.edges
        ]
        ledger.rows(f"{name}.edges", edges, "id, and heights of its ends")
        loops[graph] = _check_shown_pairs(facts, ledger, name, height, left_out[graph])
    _count_suppressed(facts, ledger, loops, left_out)


def _height_of(facts, part, height):
    """How high a component is; a node alone stands for what lies between two levels, as high as its persistence."""
    if len(part) == 1:
        return facts.columns.handles["persistence"][int(next(iter(part))[1:])]
    heights = [height[node] for node in part]
    return max(heights) - min(heights)


def _check_shown_pairs(facts, ledger, name, height, left_out):
    """No pair is below the feature size, and those above it are kept; the number of loops shown."""
    full, simple = facts.graphs[name.removesuffix("_simplified")], facts.graphs[name]
    before, after = _graph_pairs(full, height), _graph_pairs(simple, height)
    large, kept = (
        [[(a, b) for a, b in kind if height[b] - height[a] >= facts.size] for kind in pairs]
        for pairs in (before, after)
    )
    ledger.enter(f"{name}: pairs below the feature size", sum(map(len, after)) - sum(map(len, kept)), 0)
    if len(large[2]) == len(before[2]):  # gluing a loop may move other pairs
        ledger.enter(f"{name}: pairs of the feature size", after == large, True)
    around = neighbours(full)
    if large == before and not left_out:  # nothing to cancel
        ledger.enter(f"{name}: arcs", _ends(neighbours(simple)) == _ends(_pass_over(around, simple)), True)
    else:
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
    """All pairs of neighbours, each told from both."""
    return sorted((node, other) for node, others in around.items() for other in others)


def _pass_over(around, simple):
    """Neighbours without the nodes that a graph lacks and that do not branch; changes `around`."""
    for node in around.keys() - simple.nodes.keys():
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


def _graph_pairs(graph, height):
    """Extended persistence of a graph, its nodes by name: three sorted lists of (lower, upper)."""
    order = sorted(graph.nodes, key=lambda node: (height[node], int(node[1:])))
    place = {node: k for k, node in enumerate(order)}
    ends = [sorted((place[a], place[b])) for a, b, *_ in graph.edges]
    return [sorted((order[low], order[high]) for low, high in kind) for kind in graph_pairs(len(order), ends)]
