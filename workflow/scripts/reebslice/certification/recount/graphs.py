"""Blocks, arcs and the graphs, built again from recounted facts.

The chains of plain parts are found as connected components rather
than by walking upward, and each graph is compared as a multigraph, node by
node and edge by edge, with ids and ends.
"""

import itertools
from typing import NamedTuple

import numpy as np

from .components import find_components
from .ranges import list_members


class GraphParts(NamedTuple):
    """What lies between consecutive levels: blocks of the solid or of the void, or pieces of the surface.

    above, below : (I,) the part on either side of each item (region, contour)
    joints : handle ids that are nodes in each part, ascending
    measure : (P,) volume or area
    """

    above: np.ndarray
    below: np.ndarray
    joints: list
    measure: np.ndarray


class VoidRegions(NamedTuple):
    """Regions of the void at K levels: first the insides of H holes, then the outside, below all, at each level, above.

    hole : (H,) the contours of the holes
    of_contour : (C,) the region on the void's side of each contour
    level : (H + K + 2,) that of each region; -1 and K of the outside below and above all
    """

    hole: np.ndarray
    of_contour: np.ndarray
    level: np.ndarray


def find_void_regions(inner, parent, region, level, n_levels):
    """Find the regions of the void: what is in a hole and in no contour in it, and what is in no contour.

    Parameters
    ----------
    inner, parent, region, level : (C,)
        Whether each contour bounds a hole, the smallest contour around it or -1, its region of the solid, its level.
    n_levels : int

    Returns
    -------
    VoidRegions or None
        None unless each hole is directly inside the outer contour of its region, and each outer contour directly
        inside a hole or none.
    """
    hole, outermost = np.flatnonzero(inner), parent < 0
    if (inner & outermost).any() or (inner[parent] == inner)[~outermost].any():
        return None
    if (region[parent[hole]] != region[hole]).any():
        return None
    number = np.cumsum(inner) - 1  # of holes among holes
    of_contour = np.where(inner, number, np.where(outermost, len(hole) + 1 + level, number[parent]))
    return VoidRegions(hole, of_contour, np.concatenate([level[hole], np.arange(-1, n_levels + 1)]))


def find_blocks(piece_above, piece_below, region, n_pieces, n_regions, links=()):
    """Find the blocks of solid or void: components of the bipartite graph of pieces and the two sides of regions.

    Parameters
    ----------
    piece_above, piece_below : (C,) int
        The piece on either side of each contour.
    region : (C,) int
        The region of each contour.
    n_pieces, n_regions : int
    links : list of (int, int)
        What hangs together besides; pieces count from 0, then upper sides of regions, then lower ones.

    Returns
    -------
    of_piece : (P,) int
    above, below : (R,) int
        The block on either side of each region.
    count : int
    """
    extra = np.array(links, np.int64).reshape(-1, 2)
    ends = np.concatenate([n_pieces + region, n_pieces + n_regions + region, extra[:, 0]])
    pieces = np.concatenate([piece_above, piece_below, extra[:, 1]])
    size = n_pieces + 2 * n_regions
    n, part = find_components(ends, pieces, size)
    return part[:n_pieces], part[n_pieces : n_pieces + n_regions], part[n_pieces + n_regions :], n


def list_items(parts):
    """List the items below and above each of some :class:`GraphParts`: two lists of lists."""
    return list_members(parts.above, len(parts.joints)), list_members(parts.below, len(parts.joints))


def find_chains(above, below, plain):
    """Find the chains of items that plain parts hold together, one on top of the other.

    Parameters
    ----------
    above, below : (I,) int
        The part on either side of each item.
    plain : (P,) bool
        The parts with one item below and one above that are passed.

    Returns
    -------
    count : int
    chain : (I,) int
        Of each item.
    """
    low, high = np.full(len(plain), -1), np.full(len(plain), -1)
    low[above] = high[below] = np.arange(len(above))
    return find_components(low[plain], high[plain], len(above))


def find_arcs(parts, level):
    """Find the arcs between the joints of parts, as maximal chains.

    Parameters
    ----------
    parts : GraphParts
    level : (I,) int
        Of the items.

    Returns
    -------
    arcs : dict
        {(source, target, items): measure}.
    odd : (k,) int
        The parts that are neither a joint nor a plain continuation; no arc can pass those.
    """
    has = np.array([bool(joints) for joints in parts.joints], bool)
    n_below, n_above = (np.bincount(of, minlength=len(has)) for of in (parts.above, parts.below))
    odd = ~has & ((n_below != 1) | (n_above != 1))
    n, chain = find_chains(parts.above, parts.below, ~has & ~odd)
    order = np.lexsort((level, chain))
    runs = np.split(order, np.searchsorted(chain[order], np.arange(1, n))) if n else []
    ends = [(int(parts.below[run[0]]), int(parts.above[run[-1]])) for run in runs]
    inner = [(part, part) for part, joints in enumerate(parts.joints) for _ in joints[1:]]
    meeting = np.bincount(np.array(ends + inner, np.int64).ravel(), minlength=len(has))
    arcs = {}
    for run, (part, following) in zip(runs, ends):
        if odd[part] or odd[following]:
            continue
        measure = parts.measure[parts.above[run[:-1]]].sum()
        measure += sum(parts.measure[end] / meeting[end] for end in (part, following))
        key = parts.joints[part][-1], parts.joints[following][0], tuple(run.tolist())
        arcs[key] = arcs.get(key, 0.0) + float(measure)
    for part, joints in enumerate(parts.joints):
        for source, target in itertools.pairwise(joints):
            arcs[source, target, ()] = 2 * float(parts.measure[part]) / meeting[part]
    return arcs, np.flatnonzero(odd)


def find_augmented_edges(parts, operations):
    """List the edges of the augmented graph.

    Parameters
    ----------
    parts : GraphParts
    operations : sequence of str
        Of the handles.

    Returns
    -------
    list of (str, str, str)
        Two nodes and the operation; sorted.
    """
    edges = []
    for lower, upper, joints in zip(*list_items(parts), parts.joints):
        if not joints:
            edges += [(f"n{a}", f"n{b}", "continuation") for a in lower for b in upper]
            continue
        edges += [(f"n{a}", f"h{joints[0]}", operations[joints[0]]) for a in lower]
        edges += [(f"h{a}", f"h{b}", operations[b]) for a, b in itertools.pairwise(joints)]
        edges += [(f"h{joints[-1]}", f"n{b}", operations[joints[-1]]) for b in upper]
    return sorted((*sorted(edge[:2]), edge[2]) for edge in edges)


def count_loops(n_nodes, pairs):
    """Count the independent loops of a multigraph.

    Parameters
    ----------
    n_nodes : int
    pairs : list of (int, int)
        Its edges.

    Returns
    -------
    loops : int
        First Betti number.
    component : (n_nodes,) int
    """
    n, part = find_components(*np.asarray(pairs, np.int64).reshape(-1, 2).T, n_nodes)
    return len(pairs) - n_nodes + n, part


def neighbours(graph):
    """The nodes at the other ends of each node's edges, once per edge: {name: list}."""
    around = {node: [] for node in graph.nodes}
    for a, b, *_ in graph.edges:
        around[a].append(b)
        around[b].append(a)
    return around


def find_parts(graph):
    """The connected components of a :class:`graphml.ReadGraph`: sets of names."""
    place = {node: k for k, node in enumerate(graph.nodes)}
    _, part = count_loops(len(place), [(place[a], place[b]) for a, b, *_ in graph.edges])
    parts = [set() for _ in range(part.max(initial=-1) + 1)]
    for node, k in zip(place, part.tolist()):
        parts[k].add(node)
    return parts
