"""The definition of the two Reeb graphs, carried out literally and slowly.

Independent of the library: plain dictionaries, exact rational numbers and
networkx. `points` are in the tilted frame, so the height is the z coordinate;
meshes are small, closed, oriented and embedded.

The order of heights is (z, x, y, id). It is the order of the true heights over
a plane tilted by an infinitesimal amount, so wherever geometry is needed here,
the mesh is cut by a plane that really is tilted, by a rational amount so small
that it changes the order of no two vertices. Flats are then no special case.
"""

import itertools
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key

import networkx as nx
import numpy as np

from reebslice.schemas import EVENTS


class Ambiguous(ValueError):
    """The surface meets itself, or two vertices coincide, where an answer depends on it."""


# --------------------------------------------------------------------------
# Contours at one level


def order_vertices(points):
    """Vertex ids from the lowest to the highest by (z, x, y, id)."""
    return sorted(range(len(points)), key=lambda v: (points[v][2], points[v][0], points[v][1], v))


def walk_contours(faces, above):
    """Contours as tuples of mesh edges (lower vertex, upper vertex), material on the left.

    `above` is the set of vertices above the level. In each face that the level
    crosses, its contour comes in through the side that runs down and leaves
    through the side that runs up; the next face has the latter running down.
    """
    step = {}
    for face in faces:
        sides = [(face[k], face[(k + 1) % 3]) for k in range(3)]
        up = [(p, q) for p, q in sides if p not in above and q in above]
        down = [(p, q) for p, q in sides if p in above and q not in above]
        if up:
            step[down[0][::-1]] = up[0]
    contours = []
    while step:
        contour = [next(iter(step))]
        while contour[-1] in step:
            contour.append(step.pop(contour[-1]))
        contours.append(tuple(contour[1:]))
    return contours


def locate_contour(contour, heights, level, points):
    """Exact corners (x, y) of a contour: where its mesh edges reach the level."""
    corners = []
    for low, high in contour:
        share = (level - heights[low]) / (heights[high] - heights[low])
        corners.append(tuple(points[low][k] + share * (points[high][k] - points[low][k]) for k in (0, 1)))
    return corners


def measure_area(corners):
    """Signed area of a polygon, positive when counter-clockwise."""
    return sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(corners, corners[1:] + corners[:1])) / 2


def encloses(corners, point):
    """Whether the closed curve runs around the point (even-odd rule); the point is not on it."""
    x, y = point
    inside = False
    for (px, py), (qx, qy) in zip(corners, corners[1:] + corners[:1]):
        if (py > y) != (qy > y) and (x - px) * (qy - py) * (1 if qy > py else -1) < (qx - px) * (y - py) * (
            1 if qy > py else -1
        ):
            inside = not inside
    return inside


def nest_contours(curves):
    """The regions, as {outer contour: set of it and its holes}; `curves` maps contours to corners.

    A hole belongs to the smallest outer contour around it.
    """
    areas = {contour: measure_area(corners) for contour, corners in curves.items()}
    regions = {contour: {contour} for contour, area in areas.items() if area > 0}
    for hole in curves.keys() - regions.keys():
        around = [outer for outer in regions if encloses(curves[outer], curves[hole][0])]
        if not around or areas[hole] == 0:
            raise Ambiguous("a hole that no outer contour surrounds")
        regions[min(around, key=areas.get)].add(hole)
    return regions


def find_regions(points, faces, above, level):
    """Regions at an ordinary level (no vertex at exactly this height) as a set of sets of contours."""
    exact = [tuple(map(Fraction, point)) for point in points]
    heights = [point[2] for point in exact]
    curves = {c: locate_contour(c, heights, Fraction(level), exact) for c in walk_contours(faces, above)}
    return {frozenset(map(frozenset, region)) for region in nest_contours(curves).values()}


# --------------------------------------------------------------------------
# Contours between the parts of a multiple saddle, which touch in its point


def locate_touching(contour, origin, saddle, heights, exact):
    """Corners of a contour at the height of a saddle; `origin` of each part is the vertex that it is part of."""
    corners = []
    for low, high in contour:
        p, q = origin[low], origin[high]
        if p == q:
            corners.append(exact[saddle][:2])
        else:
            corners += locate_contour([(p, q)], heights, heights[saddle], exact)
    return [corner for k, corner in enumerate(corners) if corner != corners[k - 1]]


def count_crossings(curves, centre):
    """How many pairs of strands through the point `centre` cross there, of all the closed curves."""
    strands = []
    for corners in curves:
        for k, corner in enumerate(corners):
            if corner == centre:
                strands.append((corners[k - 1], corners[(k + 1) % len(corners)]))
    around = sorted((end for strand in strands for end in strand), key=cmp_to_key(lambda p, q: _turn(centre, p, q)))
    chords = [sorted(map(around.index, strand)) for strand in strands]
    return sum(a < c < b < d for a, b in chords for c, d in chords)


def _turn(centre, p, q):
    """Negative if p comes before q on the way around the centre, counter-clockwise from the +x axis."""
    (px, py), (qx, qy) = ((x - centre[0], y - centre[1]) for x, y in (p, q))
    halves = [(y < 0) or (y == 0 and x < 0) for x, y in ((px, py), (qx, qy))]
    if halves[0] != halves[1]:
        return halves[0] - halves[1]
    return py * qx - px * qy


def start_away(corners, centre):
    """The same closed curve, from a new corner amid a segment that does not end in the point `centre`."""
    k = next(k for k in range(len(corners)) if centre not in (corners[k - 1], corners[k]))
    middle = tuple((a + b) / 2 for a, b in zip(corners[k - 1], corners[k]))
    return [middle, *corners[k:], *corners[:k]]


# --------------------------------------------------------------------------
# Pieces between levels


@dataclass
class Piece:
    """A component of the surface in a slab; contours are sets of mesh edges."""

    slab: int
    vertices: set
    below: list
    above: list
    euler_characteristic: int

    @property
    def genus(self):
        return (2 - self.euler_characteristic - len(self.below) - len(self.above)) // 2

    @property
    def kind(self):
        ends = (len(self.below), len(self.above))
        elementary = {(1, 1): "cylinder", (0, 1): "birth", (1, 0): "death", (2, 1): "join", (1, 2): "split"}
        return "unseen" if ends == (0, 0) else elementary.get(ends, "compound") if self.genus == 0 else "compound"


def find_pieces(faces, aboves):
    """Pieces of the surface between levels; `aboves` holds the set of vertices above each level.

    A cell is a (face, slab) that meet; cells of one slab that share a mesh edge
    inside the slab are joined. Euler characteristic of a piece: its vertices, less the
    mesh edges, plus the faces that meet the slab; the corners and sides that lie on
    the levels themselves cancel, as they form cycles.
    """
    count = {v: sum(v in above for above in aboves) for face in faces for v in face}

    def slabs(cell):
        return range(min(count[v] for v in cell) - 1, max(count[v] for v in cell))

    cells = nx.Graph()
    for f, face in enumerate(faces):
        for slab in slabs(face):
            cells.add_edge(("face", f, slab), ("face", f, slab))
            for k in range(3):
                edge = tuple(sorted((face[k], face[(k + 1) % 3])))
                if slab in slabs(edge):
                    cells.add_edge(("face", f, slab), ("edge", edge, slab))
        for v in face:
            cells.add_edge(("vertex", v, count[v] - 1), ("face", f, count[v] - 1))
    ends = [[frozenset(contour) for contour in walk_contours(faces, above)] for above in aboves]
    pieces = []
    for part in nx.connected_components(cells):
        sorts = Counter(sort for sort, _, _ in part)
        slab = next(iter(part))[2]
        edges = {name for sort, name, _ in part if sort == "edge"}

        def touching(level, edges=edges):
            found = ends[level] if 0 <= level < len(ends) else []
            return [c for c in found if tuple(sorted(next(iter(c)))) in edges]

        chi = sorts["vertex"] - sorts["edge"] + sorts["face"]
        vertices = {name for sort, name, _ in part if sort == "vertex"}
        pieces.append(Piece(slab, vertices, touching(slab), touching(slab + 1), chi))
    return pieces


# --------------------------------------------------------------------------
# The Reeb graphs


def count_sign_changes(vertex, faces, rank):
    """Number of times that the link of a vertex crosses the vertex's own level."""
    follow = {}
    for face in faces:
        if vertex in face:
            k = face.index(vertex)
            follow[face[(k + 1) % 3]] = face[(k + 2) % 3]
    link = [next(iter(follow))]
    while follow[link[-1]] != link[0]:
        link.append(follow[link[-1]])
    if len(link) != len(follow):
        raise Ambiguous(f"vertex {vertex} is a pinch: its link is no single cycle")
    signs = [rank[v] > rank[vertex] for v in link]
    return sum(a != b for a, b in zip(signs, signs[1:] + signs[:1]))


def tilt_slightly(points):
    """Exact heights z + e x + e^2 y that order the vertices as (z, x, y) does."""
    exact = [tuple(map(Fraction, point)) for point in points]
    ordered = sorted(set(exact), key=lambda p: (p[2], p[0], p[1]))
    tilt = Fraction(1, 2**10)
    while True:
        heights = [z + tilt * x + tilt**2 * y for x, y, z in ordered]
        if all(low < high for low, high in itertools.pairwise(heights)):
            return [z + tilt * x + tilt**2 * y for x, y, z in exact], exact
        tilt /= 2**10


def sweep(points, faces, check_every_level=False, states=None):
    """Exact Reeb graphs (surface, solid) as MultiGraphs whose nodes are critical vertices.

    Node attributes: vertex, rank, index (1 for any saddle), changes (sign changes of the link),
    side, operation, change (as in EVENTS; None at a multiple saddle), outer, inner,
    regions (by how much their numbers alter), hidden (loops inside a multiple saddle,
    on the surface). Edges run from `lower` to `upper` critical vertex and, on the
    surface, tell whether their contours are `outer`.
    The dict `states`, if given, is filled with the regions that a level with so
    many vertices below it shows: {number: set of frozensets of contours}.
    With `check_every_level` the regions are found anew after every vertex, not
    only after events, and must be what was there before.
    Raises Ambiguous when what the cuts show contradicts what can happen to an embedded surface.
    """
    faces = [tuple(map(int, face)) for face in faces]
    order = order_vertices(points)
    rank = {v: r for r, v in enumerate(order)}
    heights, exact = tilt_slightly(points)
    star = {v: [] for v in order}
    for face in faces:
        for v in face:
            star[v].append(face)
    surface, solid = nx.MultiGraph(), nx.MultiGraph()
    above = set(order)
    contours, regions = {}, set()  # {contour: is it outer}, {frozenset of contours}
    tails, region_tails = {}, {}  # the critical vertex at which the arc through it began
    for r, vertex in enumerate(order):
        if states is not None:
            states[r] = set(regions)
        above.remove(vertex)
        walked = {frozenset(c): c for c in walk_contours(faces, above)}
        old, new = contours.keys() - walked.keys(), walked.keys() - contours.keys()
        changes = count_sign_changes(vertex, star[vertex], rank)
        if changes == 2:
            rename = _match_continuation(vertex, old, new)
            contours = {rename.get(c, c): outer for c, outer in contours.items()}
            tails = {rename.get(c, c): tail for c, tail in tails.items()}
            moved = {region: frozenset(rename.get(c, c) for c in region) for region in regions}
            regions = set(moved.values())
            region_tails = {moved[region]: tail for region, tail in region_tails.items()}
            if check_every_level and _cut_regions(walked, heights, order, r, exact) != (regions, contours):
                raise Ambiguous(f"regions change at vertex {vertex}, where nothing happens")
            continue

        after, outer_after = _cut_regions(walked, heights, order, r, exact)
        if any(outer_after[c] != contours[c] for c in outer_after.keys() & contours.keys()):
            raise Ambiguous(f"a contour away from vertex {vertex} turns inside out")
        label = _label_event(vertex, changes, old, new, contours, outer_after, len(after) - len(regions))
        gone, come = _link_regions(vertex, regions, after, old, new)
        for graph in (surface, solid):
            graph.add_node(vertex, rank=r, **label)
        for contour in old:
            end = tails.pop(contour)
            surface.add_edge(end, vertex, lower=end, upper=vertex, outer=contours[contour])
        for region in gone:
            end = region_tails.pop(region)
            solid.add_edge(end, vertex, lower=end, upper=vertex)
        tails.update((c, vertex) for c in new)
        kept = {_find_successor(region, after): tail for region, tail in region_tails.items()}
        region_tails = {**kept, **dict.fromkeys(come, vertex)}
        contours, regions = outer_after, after
    return surface, solid


def _match_continuation(vertex, old, new):
    if (len(old), len(new)) != (1, 1):
        raise Ambiguous(f"regular vertex {vertex} turns {len(old)} contours into {len(new)}")
    return dict(zip(old, new))


def _cut_regions(walked, heights, order, r, exact):
    """Regions just above the r-th vertex: a set of sets of contours, and {contour: is it outer}."""
    if not walked:
        return set(), {}
    if heights[order[r]] == heights[order[r + 1]]:
        raise Ambiguous(f"vertices {order[r]} and {order[r + 1]} coincide")
    level = (heights[order[r]] + heights[order[r + 1]]) / 2
    curves = {name: locate_contour(contour, heights, level, exact) for name, contour in walked.items()}
    regions = nest_contours(curves)
    return {frozenset(region) for region in regions.values()}, {name: name in regions for name in walked}


def _label_event(vertex, changes, old, new, before, after, regions):
    def show(contours, outer):
        return ",".join(sorted("o" if outer[c] else "i" for c in contours))

    outer = sum(after[c] for c in new) - sum(before[c] for c in old)
    inner = len(new) - len(old) - outer
    index = 1 if changes else (0 if new else 2)
    label = {"vertex": vertex, "index": index, "changes": changes, "outer": outer, "inner": inner}
    label |= {"regions": regions, "side": None, "operation": None, "change": None}
    # The piece around the vertex: chi = 2 - 2 genus - contours, less its other (regular) vertices.
    label["hidden"] = (2 - (1 - changes // 2) - len(old) - len(new)) // 2
    if changes <= 4:
        change = f"{show(old, before)}->{show(new, after)}"
        if change not in EVENTS or EVENTS[change][1:5] != (index, outer, inner, regions):
            raise Ambiguous(f"impossible event {change} at vertex {vertex}, regions {regions:+d}")
        label |= {"side": EVENTS[change][0], "operation": EVENTS[change][5], "change": change}
    return label


def _link_regions(vertex, before, after, old, new):
    """The regions just below and just above an event that it takes part in.

    Regions are linked when a contour goes from one to the other, and those of
    the event's own contours through the event. Elsewhere nothing may happen.
    """
    links = nx.Graph()
    links.add_nodes_from(("below", region) for region in before)
    links.add_nodes_from(("above", region) for region in after)
    links.add_node("event")
    for low in before:
        if low & old:
            links.add_edge(("below", low), "event")
        links.add_edges_from((("below", low), ("above", high)) for high in after if low & high)
    links.add_edges_from((("above", high), "event") for high in after if high & new)
    for block in nx.connected_components(links):
        ends = sorted(node[0] for node in block if node != "event")
        if "event" not in block and ends != ["above", "below"]:
            raise Ambiguous(f"regions away from vertex {vertex} meet or part")
    block = nx.node_connected_component(links, "event") - {"event"}
    return [g for side, g in block if side == "below"], [g for side, g in block if side == "above"]


def _find_successor(region, after):
    return next(high for high in after if high & region)


# --------------------------------------------------------------------------
# What a set of levels shows of the Reeb graphs


@dataclass
class Group:
    """What happens in one piece of the surface, or one block of the solid, between two levels.

    vertices: its critical vertices; below, above: the arcs that leave it; loops:
    of arcs wholly inside it (on the surface: its genus).
    """

    vertices: frozenset
    below: list
    above: list
    loops: int

    @property
    def change(self):
        """Of a group of the surface graph: the contours below and those above."""
        ends = [sorted("o" if arc["outer"] else "i" for arc in arcs) for arcs in (self.below, self.above)]
        return "->".join(",".join(end) for end in ends)


def group_by_levels(graph, cuts):
    """Groups of critical vertices that no level parts; `cuts`: numbers of vertices below the levels.

    Two ends of an arc are together unless a level crosses it.
    """
    slab = {v: sum(cut <= rank for cut in cuts) for v, rank in graph.nodes(data="rank")}
    near = nx.MultiGraph()
    near.add_nodes_from(graph)
    near.add_edges_from((a, b) for a, b in graph.edges() if slab[a] == slab[b])
    groups = []
    for members in map(frozenset, nx.connected_components(near)):
        arcs = [data for _, _, data in graph.edges(members, data=True)]
        below = [arc for arc in arcs if arc["lower"] not in members]
        above = [arc for arc in arcs if arc["upper"] not in members]
        loops = near.subgraph(members).number_of_edges() - len(members) + 1
        loops += sum(graph.nodes[v]["hidden"] for v in members)
        groups.append(Group(members, below, above, loops))
    return groups


def find_essential(surface, groups):
    """The critical vertices that do not cancel inside their groups, {vertex: multiplicity}.

    Elder rule: swept upward (and downward), of the parts of a group that meet at a
    saddle the younger end there, each with the minimum (maximum) it began at. What
    came in through a level is older than everything and never ends.
    """
    left = Counter({v: max(1, changes // 2 - 1) for v, changes in surface.nodes(data="changes")})
    for group in groups:
        for near, far, way in (("lower", "upper", 1), ("upper", "lower", -1)):
            birth, part = {}, {}  # of a part, -infinity or a vertex; of a vertex met
            for vertex in sorted(group.vertices, key=lambda v: way * surface.nodes[v]["rank"]):
                arcs = [data for _, _, data in surface.edges(vertex, data=True) if data[far] == vertex]
                met = {part.get(arc[near], ("outside", near, arc[near], k)) for k, arc in enumerate(arcs)}
                for newcomer in met - birth.keys():
                    birth[newcomer] = None
                age = {p: -np.inf if birth[p] is None else way * surface.nodes[birth[p]]["rank"] for p in met}
                eldest_first = sorted(met, key=age.get)
                for younger in eldest_first[1:]:
                    if birth[younger] is not None:
                        left[birth[younger]] -= 1
                        left[vertex] -= 1
                name = eldest_first[0] if met else vertex
                birth.setdefault(name, vertex)
                part = {v: name if p in met else p for v, p in part.items()} | {vertex: name}
    return +left


def contract_groups(graph, groups, dull):
    """Arcs between groups, those through groups in `dull` (indices) joined: Counter of pairs of indices.

    A dull group has one arc below and one above. Graph nodes need only the attribute `vertex`.
    """
    of_vertex = {v: k for k, group in enumerate(groups) for v in group.vertices}
    contracted = nx.MultiGraph()
    ends = [(of_vertex[graph.nodes[a]["vertex"]], of_vertex[graph.nodes[b]["vertex"]]) for a, b in graph.edges()]
    contracted.add_edges_from((a, b) for a, b in ends if a != b)
    for group in dull & set(contracted):
        (_, one), (_, two) = contracted.edges(group)
        contracted.remove_node(group)
        contracted.add_edge(one, two)
    return Counter(frozenset(pair) for pair in contracted.edges())


# --------------------------------------------------------------------------
# Comparing labelled multigraphs


def summarize_graph(graph, surface):
    """What two graphs of one mesh must agree on, whatever way multiple saddles were unfolded.

    All nodes at one critical vertex count as one: the sums of their changes in
    outer and inner contours, their labels (only if the vertex is no multiple
    saddle), and the arcs between different vertices with their multiplicity. On the
    surface the loops at a vertex count too: arcs inside it, less what joins its nodes.
    """
    groups = {}
    for node, data in graph.nodes(data=True):
        groups.setdefault(data["vertex"], []).append(node)
    nodes = {}
    for vertex, members in groups.items():
        events = [graph.nodes[node] for node in members]
        multiple = len(events) > 1 or events[0]["change"] is None
        labels = None if multiple else tuple(events[0][key] for key in ("index", "side", "operation", "change"))
        balance = tuple(sum(event[key] for event in events) for key in ("outer", "inner"))
        loops = sum(event.get("hidden", 0) for event in events)
        loops += graph.subgraph(members).number_of_edges() - len(members) + 1 if len(members) > 1 else 0
        nodes[vertex] = (labels, balance, loops if surface else None)
    where = {node: vertex for vertex, members in groups.items() for node in members}
    arcs = Counter(frozenset({where[a], where[b]}) for a, b in graph.edges() if where[a] != where[b])
    return nodes, arcs


def compare_graphs(found, expected, surface):
    """Sentences that tell where two graphs differ; none when they are equal."""
    (nodes, arcs), (true_nodes, true_arcs) = (summarize_graph(g, surface) for g in (found, expected))
    sentences = []
    for vertex in sorted(nodes.keys() | true_nodes.keys()):
        if nodes.get(vertex) != true_nodes.get(vertex):
            sentences.append(f"vertex {vertex}: found {nodes.get(vertex)}, expected {true_nodes.get(vertex)}")
    for ends in sorted(arcs.keys() | true_arcs.keys(), key=sorted):
        if arcs[ends] != true_arcs[ends]:
            sentences.append(f"arcs between {sorted(ends)}: found {arcs[ends]}, expected {true_arcs[ends]}")
    return sentences


def reverse_summary(summary, rename=lambda vertex: vertex):
    """The summary of the graph of the same solid upside down (mirrored at a point)."""
    mirror = {}
    for change, (_, index, _, _, _, _) in EVENTS.items():
        below, above = change.split("->")
        back = f"{above}->{below}"
        side, _, _, _, _, operation = EVENTS[back]
        mirror[change] = (2 - index, side, operation, back)
    nodes, arcs = summary
    turned = {
        rename(v): (labels and mirror[labels[3]], tuple(-n for n in balance), loops)
        for v, (labels, balance, loops) in nodes.items()
    }
    return turned, Counter({frozenset(map(rename, ends)): n for ends, n in arcs.items()})


def count_loops(graph):
    """First Betti number of a multigraph."""
    return graph.number_of_edges() - graph.number_of_nodes() + nx.number_connected_components(graph)


def count_hidden(graph):
    """Loops inside the multiple saddles of a surface graph."""
    return sum(hidden for _, hidden in graph.nodes(data="hidden"))


def as_points(array):
    """Rows as tuples of Python floats, which make exact fractions."""
    return [tuple(map(float, row)) for row in np.asarray(array)]
