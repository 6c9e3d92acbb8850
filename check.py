"""Check Reeb graphs against the meshes that they are said to be of: `python check.py [results]`.

It makes both graphs anew from mesh and events, in steps (1) to (6); docs/theorem.md states what a yes proves.
"""

import json
import signal
import sys
from collections import Counter
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pyarrow.parquet as pq

NODE = "handle x y z height index side operation change branches".split()
COLUMNS = {
    "vertices": ["x", "y", "z"], "faces": ["a", "b", "c", "shell"], "shells": ["body"], "levels": ["vertices_below"],
    "handles": ["vertex", "rank", *NODE], "arcs": ["graph", "source", "target"],
}  # fmt: skip
# What may become of outer (o) and inner (i) contours; A: material appears as the height rises, B: void does.
SIDES = dict(zip("->o ->i o-> i-> o,o->o i,o->i o->i,o i->i,i o->o,o i->i,o i,o->o i,i->i".split(), "ABBAAAAABBBB"))
OPERATIONS = {(0, 1): "creation", (1, 0): "annihilation", (2, 1): "union", (1, 2): "separation"}
TYPES = {"long": int, "double": float, "string": str}


def need(holds, says):
    """Refuse the model unless this holds."""
    if not holds:
        raise ValueError(says)


def read_graph(path):
    """Nodes {name: attributes} and edges [(source, target, attributes)] of a GraphML file."""
    root = ElementTree.parse(path).getroot()  # noqa: S314, the model's own results
    keys = {k.get("id"): (k.get("attr.name"), TYPES[k.get("attr.type")]) for k in root.findall(".//{*}key")}

    def attributes(element):
        read = {keys[data.get("key")][0]: keys[data.get("key")][1](data.text or "") for data in element}
        need(len(read) == len(element), f"{path.name} tells an attribute twice")
        return read

    need([g.get("edgedefault") for g in root.findall(".//{*}graph")] == ["undirected"], f"{path.name} is no graph")
    nodes = [(node.get("id"), attributes(node)) for node in root.findall(".//{*}node")]
    need(len(dict(nodes)) == len(nodes), f"{path.name} has a node twice")
    return dict(nodes), [(e.get("source"), e.get("target"), attributes(e)) for e in root.findall(".//{*}edge")]


def components(a, b, n):
    """Name each of n items after the smallest one that the pairs a - b connect it with."""
    root = np.arange(n)
    while len(a):
        np.minimum.at(root, np.maximum(root[a], root[b]), np.minimum(root[a], root[b]))
        while (root[root] != root).any():
            root = root[root]
        a, b = np.stack([a, b])[:, root[a] != root[b]]
    return root


def spread(first, stop):
    """Numbers from `first` up to `stop` of each item: the item of each, the number, and where those of items begin."""
    start = np.concatenate([[0], np.cumsum(stop - first)])
    item = np.repeat(np.arange(len(first)), stop - first)
    return item, first[item] + np.arange(start[-1]) - start[item], start[:-1]


def rank_surface(vertices, faces, rotation):
    """(1) Points in order of (height, tilted x and y, maxima before minima, row), their rows, and faces in ranks."""
    tilted = np.stack([a * vertices["x"] + b * vertices["y"] + c * vertices["z"] for a, b, c in rotation], axis=1)
    faces = np.stack([faces[corner] for corner in "abc"], axis=1)
    need(np.array_equal(np.unique(faces), np.arange(len(tilted))), "faces name vertices not there, or not all")
    place = np.argsort(np.lexsort(tilted[:, [1, 0, 2]].T))[faces]
    rises, falls = (np.isin(np.arange(len(tilted)), faces[place != end(place, 1)[:, None]]) for end in (np.max, np.min))
    row = np.lexsort((1 * rises - falls, *tilted[:, [1, 0, 2]].T))
    return tilted[row], row, np.argsort(row)[faces]


def mesh_edges(faces, n):
    """(1) Lower and upper end of each mesh edge, and the two faces there; refuses what is no oriented surface."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()  # of half-edge 3 f + k, from corner k of face f
    code = 2 * (np.minimum(start, end) * n + np.maximum(start, end)) + (start > end)
    order = np.argsort(code, kind="stable")
    up, down = order[::2], order[1::2]
    closed = len(up) == len(down) and (code[up] % 2 == 0).all() and (code[up] + 1 == code[down]).all()
    need(closed and (np.diff(code[up]) > 0).all(), "the surface is not closed and oriented")
    ahead = [half // 3 * 3 + (half + 1) % 3 for half in (up, down)]
    fans = components(np.concatenate([up, ahead[0]]), np.concatenate([ahead[1], down]), 3 * len(faces))
    need(len(np.unique(fans)) == n, "sheets of the surface meet in a vertex")
    return start[up], end[up], up // 3, down // 3


class Slices:
    """(2) A surface cut just below the ranks `cuts` into pieces by contours; slab k + 1 is above level k.

    Pieces are components of cells (face, slab), contours of segments (face, level). Per segment `face`, `level`,
    `contour`; per vertex its piece, `home`; per contour the pieces `under` and `over` it; per piece the numbers of
    contours below and above it, `ends`, and whether it is other than a cylinder, `marked`.
    """

    def __init__(self, points, faces, cuts):
        n, self.points, self.cuts = len(points), points, cuts
        lower, upper, one, two = mesh_edges(faces, n)
        low, middle, high = self.corners = np.sort(faces, axis=1).T
        self.even = faces[np.arange(len(faces)), (np.argmin(faces, axis=1) + 1) % 3] == middle
        slab = np.searchsorted(cuts, np.arange(n), side="right")
        cells, _, begin = spread(slab[low], slab[high] + 1)
        cell = begin - slab[low]  # of face f in slab s: cell[f] + s
        edge, at, _ = spread(slab[lower], slab[upper] + 1)
        piece = np.unique(components(cell[one[edge]] + at, cell[two[edge]] + at, len(cells)), return_inverse=True)[1]
        self.face, self.level, begin = spread(slab[low], slab[high])
        edge, at, _ = spread(slab[lower], slab[upper])
        segment = begin - slab[low]
        contour = components(segment[one[edge]] + at, segment[two[edge]] + at, len(self.face))
        _, first, self.contour = np.unique(contour, return_index=True, return_inverse=True)
        self.under, self.over = (piece[cell[self.face] + self.level + k][first] for k in (0, 1))
        self.home = np.empty(n, int)
        self.home[self.corners] = piece[cell + slab[self.corners]]
        self.ends = np.stack([np.bincount(side, minlength=piece.max() + 1) for side in (self.over, self.under)])
        self.euler = np.bincount(self.home, 1 - np.bincount(middle, minlength=n) // 2, piece.max() + 1)
        self.genus = (2 - self.ends.sum(axis=0) - self.euler) / 2
        self.marked = (self.genus != 0) | (self.ends != 1).any(axis=0)


def view_contours(s, body):
    """(3) Make a function of a contour: whether it is inner, and which contours a line y = const. meets behind it.

    In rational numbers, by sections with planes z + e x + e^2 y = const., where e is so small that ranks stay.
    """
    step, reach = min(np.diff(np.unique(s.points[:, k])).min(initial=1.0) for k in (0, 2)), np.abs(s.points).max()
    e, y_of = Fraction(step) / (8 + 8 * Fraction(reach)), s.points[:, 1][s.corners][:, s.face]
    least, most = y_of.min(axis=0) - np.spacing(reach), y_of.max(axis=0) + np.spacing(reach)
    order = [np.split(np.argsort(of, kind="stable"), np.cumsum(np.bincount(of))[:-1]) for of in (s.level, s.contour)]

    @cache
    def place(v):
        x, y, z = map(Fraction, s.points[v].tolist())
        return x, y, z + e * (x + e * y)

    def ends(i):  # of segment i, the material on its left
        a, b, c = s.corners[:, s.face[i]].tolist()
        cut, spots = s.cuts[s.level[i]], []
        for (px, py, p), (qx, qy, q) in (map(place, (a, c)), map(place, (a, b) if b >= cut else (b, c))):
            share = ((place(cut - 1)[2] + place(cut)[2]) / 2 - p) / (q - p)
            spots.append((px + share * (qx - px), py + share * (qy - py)))
        return spots if s.even[s.face[i]] else spots[::-1]

    @cache
    def look(contour):
        own, hits = order[1][contour], []
        y = next((p[1] + q[1]) / 2 for p, q in map(ends, own.tolist()) if p[1] != q[1])
        rows = order[0][s.level[own[0]]]
        rows = rows[(least[rows] <= float(y)) & (most[rows] >= float(y)) & (body[s.face[rows]] == body[s.face[own[0]]])]
        for i in rows.tolist():
            (px, py), (qx, qy) = ends(i)
            if (py > y) != (qy > y):  # by x where it meets the line, then by x just above the line
                slope = (qx - px) / (qy - py)
                hits.append((px + (y - py) * slope, slope, int(s.contour[i]), qy > py))
        hits.sort()
        end = max(k for k, hit in enumerate(hits) if hit[2] == contour)
        return not hits[end][3], [hit[2] for hit in hits[end + 1 :]]

    return look


def trace_arcs(under, over, items, marked):
    """(4) Of each arc from marked part to marked part these two and its first item; of each item a name of its arc."""
    high, low = (items[~marked[side[items]]] for side in (under, over))
    above = np.full(len(marked), -1)  # other parts lead from one item to one
    above[under[high]] = high
    need(len(np.unique(over[low])) == len(low) == len(high) and (above[over[low]] >= 0).all(), "a plain part branches")
    arc = components(low, above[over[low]], len(under))
    first, last = (ends[np.argsort(arc[ends])] for ends in (items[marked[side[items]]] for side in (under, over)))
    return under[first], over[last], first, arc


def find_graphs(s, body):
    """(4) Edges (lower part, upper part, whether inner) of surface and solid, which contours are inner, and blocks."""
    look, inner, pairs = view_contours(s, body), np.zeros(len(s.under), bool), []
    *_, first, arc = surface = trace_arcs(s.under, s.over, np.arange(len(s.under)), s.marked)
    inner[arc[first]] = [look(contour)[0] for contour in first.tolist()]
    inner = inner[arc]
    for hole in np.flatnonzero(inner & (s.marked[s.under] | s.marked[s.over])).tolist():
        right = look(hole)[1]
        while right and look(right[0])[0]:  # skip each hole on the line, from where it begins to where it ends
            right = right[[*right, right[0]].index(right[0], 1) + 1 :]
        need(right, "a hole is in no contour: the surface crosses itself")
        pairs += [(side[hole], side[right[0]]) for side in (s.under, s.over)]
    block = components(*np.array(pairs, int).reshape(-1, 2).T, len(s.marked))
    marked = np.isin(np.arange(len(block)), block[s.marked])
    solid = trace_arcs(block[s.under], block[s.over], np.flatnonzero(~inner), marked)
    return [list(zip(a.tolist(), b.tolist(), inner[f].tolist())) for a, b, f, _ in (surface, solid)], inner, block


def prune(edges, kept, height, noise):
    """(5) Take off leaves that are not kept, none higher than noise, and join the edges at nodes that are not kept."""
    while loose := Counter(v for edge in edges for v in edge[:2] if v not in kept):
        v, degree = min(loose.items(), key=lambda pair: pair[::-1])
        at = sorted((edge for edge in edges if v in edge[:2]), key=lambda edge: edge[0] == v)
        leaf = degree == 1 and height[at[0][1]] - height[at[0][0]] <= noise
        need(leaf or (degree == 2 and at[0][1] == v == at[-1][0]), "an event of the surface is not among the handles")
        edges = [edge for edge in edges if v not in edge[:2]] + [(at[0][0], at[-1][1], at[0][2])] * (degree == 2)
    return edges


def check_handles(s, tables, row, rank, index, inner, exact):
    """(6) Refuse unless handles are at their vertices, with the words that contours tell."""
    t, told = tables["handles"], []
    counts = [np.bincount(p, k, len(s.genus)).astype(int) for p in (s.over, s.under) for k in (inner, ~inner)]
    for h, piece in enumerate(s.home[rank].tolist()):
        i, o, i_above, o_above = (int(count[piece]) for count in counts)
        word = ",".join("i" * i + "o" * o) + "->" + ",".join("i" * i_above + "o" * o_above)
        if s.genus[piece] or (i + o, i_above + o_above) not in OPERATIONS:
            word = t["change"][h] if exact else ""
        need(word in ("", *SIDES), f"no event is {word}: the surface crosses itself")
        below, above = (end.split(",") if end else [] for end in (word or "->").split("->"))
        words = SIDES.get(word, t["side"][h]), OPERATIONS.get((len(below), len(above)), t["operation"][h])
        told.append((word, *words, not word or below.count("o") != above.count("o")))
    expected = dict(zip(("change", "side", "operation", "branches"), (np.array(c, object) for c in zip(*told))))
    expected |= {"handle": np.arange(len(rank)), "vertex": row[rank], "index": index[rank]}
    expected |= {k: tables["vertices"][k][row[rank]] for k in "xyz"} | {"height": s.points[rank, 2]}
    signs = np.bincount(s.home[rank], np.where(index[rank] == 1, -1, 1), len(s.euler))
    need(signs.sum() == s.euler.sum() if exact else np.array_equal(signs, s.euler), "handles are missing or too many")
    for name, values in expected.items():
        need(np.array_equal(t[name], values), f"handles.{name} is not that of the mesh")


def check_graph(path, handles, arcs, part, edges, exact):
    """(6) Refuse unless a graph, edges inside parts contracted, has these edges; return its size in words."""
    (nodes, found), held, inside, ends, across = read_graph(path), Counter(part), {}, [], Counter()
    for name, data in nodes.items():
        row = {f"vertex_{k}" if f"vertex_{k}" in data else k: handles[k][int(name[1:])] for k in NODE}
        need(name == f"h{row['handle']}" and data | row == data, f"{path.name}: node {name} is not as its handle")
        held[part[data["handle"]]] -= data["n_handles"]
        inside.setdefault(part[data["handle"]], []).append(data["handle"])
    need(not any(held.values()), f"{path.name} lacks a node or shows one too many")
    for one, two, data in found:
        ends.append(sorted((nodes[one]["handle"], nodes[two]["handle"])))
        low, high = (part[h] for h in ends[-1])
        across[low, high, path.name == "surface.graphml" and data["inner"]] += low != high
        need([data["lower"], data["upper"]] == handles["height"][ends[-1]].tolist(), f"{path.name}: heights of an edge")
    need(+across == Counter(edges), f"the edges of {path.name} are not the arcs of the mesh")
    need(sorted(ends) == arcs, f"the edges of {path.name} are not those of the table arcs")
    degree = np.where(handles["branches"] | (path.name == "surface.graphml"), np.where(handles["index"] == 1, 3, 1), 2)
    chains = sorted(list(pair) for chain in inside.values() for pair in pairwise(sorted(chain)))
    same = sorted(pair for pair in ends if part[pair[0]] == part[pair[1]]) == chains
    same = np.array_equal(np.bincount(np.ravel(ends).astype(int), minlength=len(part)), degree) if exact else same
    need(same, f"the edges of {path.name} at one vertex, or in one part, are not those of its events")
    return f"{len(nodes)} nodes, {len(found)} edges"


def check_model(folder):
    """Check one model; return what is so, in words."""
    certificate = json.loads((folder / "certificate.json").read_text())
    exact, loose = certificate["verdict"] == "exact", ("compound", "unseen", "unresolved_blocks", "cancelled_pairs")
    if certificate["verdict"] not in ("exact", "exact_at_feature_size"):
        return f"-    {certificate['verdict']}: it makes no claim"
    need(exact != any(certificate[name] for name in loose), "the certificate contradicts itself")
    tables = {name: pq.read_table(folder / f"{name}.parquet", columns=columns) for name, columns in COLUMNS.items()}
    tables = {name: {c: table[c].to_numpy() for c in table.column_names} for name, table in tables.items()}
    rotation, handles = json.loads((folder / "tilt.json").read_text())["rotation"], tables["handles"]
    handles["change"] = np.array([word or "" for word in handles["change"]], object)
    points, row, faces = rank_surface(tables["vertices"], tables["faces"], rotation)
    turns = np.bincount(np.sort(faces, axis=1)[:, 1], minlength=len(row))
    index = np.where(turns > 2, 1, np.where(turns > 0, -1, np.where(np.isin(np.arange(len(row)), faces.min(1)), 0, 2)))
    critical, weight = np.flatnonzero(index >= 0), np.cumsum(np.maximum(turns // 2 - 1, 1))
    # between each two consecutive critical vertices; or as the file has it, if not between copies of one vertex
    cuts = critical[1:] if exact else np.flatnonzero(np.isin(weight, tables["levels"]["vertices_below"])) + 1
    s = Slices(points, faces, cuts)
    apart = tables["shells"]["body"][tables["faces"]["shell"]] * bool(certificate["solid_interpretation"])
    (surface, solid), inner, block = find_graphs(s, apart)
    rank, sizes = np.searchsorted(weight, handles["rank"], side="right"), []
    need((handles["rank"] >= 0).all() and (np.diff(handles["rank"]) > 0).all(), "handles.rank does not ascend")
    check_handles(s, tables, row, rank, index, inner, exact)
    need([certificate["handles"][k] for k in "012"] == np.bincount(handles["index"]).tolist(), "numbers of handles")
    for name, of_piece, edges in (("surface", np.arange(len(block)), surface), ("solid", block, solid)):
        part, height = of_piece[s.home[rank]].tolist(), dict(zip(of_piece[s.home[critical]], points[critical, 2]))
        edges = prune(edges, set(part), height, 2**-46 * np.abs(points).max() if exact else -1)
        arcs = sorted([low, high] for graph, low, high in zip(*tables["arcs"].values()) if graph == name)
        sizes.append(check_graph(folder / f"{name}.graphml", handles, arcs, part, edges, exact))
    return f"yes  {certificate['verdict']}; surface: {sizes[0]}; solid: {sizes[1]}"


def main(results="results"):
    """Check every model of a folder of results; return the exit code."""
    refused, none = 0, "-    no certificate.json: it makes no claim"
    for path in sorted(Path(results).glob("models/*/tilt.json")):
        try:
            said = check_model(path.parent) if (path.parent / "certificate.json").exists() else none
        except Exception as fault:  # whatever a file holds, it ends in a no
            refused, said = 1, f"NO   {fault if type(fault) is ValueError else repr(fault)}"
        print(f"{path.parent.name:40} {said}")
    return refused


if __name__ == "__main__":
    signal.signal(getattr(signal, "SIGPIPE", signal.SIGINT), signal.SIG_DFL)  # end quietly where `| head` has enough
    sys.exit(main(*sys.argv[1:]))
