"""Sweeps over a sliced solid that measure components of its sublevel sets while they grow."""

from typing import NamedTuple

import numpy as np

from ..arrays.components import connected_items, find
from ..arrays.grouping import Groups
from ..kernels import njit

BITS = 63  # shells that one mark tells apart


class Swept(NamedTuple):
    """What is known of P components when they end.

    Attributes
    ----------
    volume : (P,) float64
        Up to the level at which each ends.
    section : (P,) float64
        Its area at the last level up to there that is not inside a flat.
    into : (P,) int64
        The first critical point of what each then is part of.
    largest : (P,) float64
        Its largest section: the area, at a level that is not inside a flat, of what hangs together with its
        beginning up to there.
    throat : (P,) float64
        The smallest section at a level from that one on; of equal ones the last.
    throat_region : (P,) int64
        The largest region of that; -1 if no level meets it.
    shells : (P, W) int64
        Marks of the shells that it touches.
    """

    volume: np.ndarray
    section: np.ndarray
    into: np.ndarray
    largest: np.ndarray
    throat: np.ndarray
    throat_region: np.ndarray
    shells: np.ndarray

    @classmethod
    def empty(cls, count, words):
        """Make room for `count` components with `words` marks of shells each."""
        whole = np.zeros((2, count), np.int64)
        return cls(*np.zeros((2, count)), whole[0], *np.zeros((2, count)), whole[1] - 1, np.zeros((count, words), int))


class _Blocks(NamedTuple):
    """A solid cut at K levels into B blocks and R regions, seen along the direction in which it is swept."""

    volume: np.ndarray  # (B,)
    first: np.ndarray  # (B,) place of the first critical point, in order of the sweep
    marks: np.ndarray  # (B, W) of the shells around it
    level: np.ndarray  # (R,) of regions
    area: np.ndarray  # (R,)
    before: np.ndarray  # (R,) block
    behind: np.ndarray  # (R,) block
    by_level: np.ndarray  # (R,) regions in order of their levels


def mark_shells(mesh, graph, slices):
    """Mark the blocks of a sliced solid by the shells around them.

    Parameters
    ----------
    mesh : HeightMesh
    graph : ReebGraph
        The mesh's.
    slices : Slices

    Returns
    -------
    marks : (B, W) int64
        Bit s % 63 of word s // 63 is set of a block that shell s touches.
    lowest : (S,) int32
        The lowest vertex of each shell, by which shells are numbered.
    """
    pieces = slices.pieces
    part = connected_items(pieces.piece_below, pieces.piece_above, len(pieces.slab))
    first, of_piece = np.unique(part[pieces.of_node], return_index=True)[1], np.empty(len(part), np.int64)
    first.sort()  # nodes are in order of height, and every shell has one
    of_piece[part[pieces.of_node[first]]] = np.arange(len(first))
    of_piece = of_piece[part]
    marks = np.zeros((slices.n_blocks, len(first) // BITS + 1), np.int64)
    np.bitwise_or.at(marks, (slices.block_of_piece, of_piece // BITS), 1 << (of_piece % BITS))
    return marks, mesh.vertex[graph.nodes[first]]


def list_shells(marks, lowest):
    """List the shells that are marked.

    Parameters
    ----------
    marks : (P, W) int64
    lowest : (S,) int32
        As of :func:`mark_shells`.

    Returns
    -------
    Groups
        Of each row, in the order of `lowest`.
    """
    bits = (marks[:, :, None] >> np.arange(BITS)) & 1
    row, shell = np.nonzero(bits.reshape(len(marks), marks.shape[1] * BITS))
    start = np.concatenate([[0], np.cumsum(np.bincount(row, minlength=len(marks)))])
    return Groups(start, lowest[shell])


def sweep_pockets(slices, graph, marks, upward, ends, at):
    """Measure components of the sublevel sets of a sliced solid, or of its superlevel sets.

    Parameters
    ----------
    slices : Slices
        Measured, as :func:`..slicing.slices.cut_surface` gives them.
    graph : ReebGraph
        The surface's.
    marks : (B, W) int64
        As of :func:`mark_shells`.
    upward : bool
        The direction of the sweep.
    ends : (P, 2) int64
        The critical points at which each begins and ends, as places among the nodes of the graph.
    at : (P,) int64
        The level before which each ends, counted along the sweep; the number of levels if it ends behind all.

    Returns
    -------
    Swept
    """
    blocks, block = _see(slices, graph, marks, upward)
    found = Swept.empty(len(at), marks.shape[1])
    first = np.full(slices.n_blocks, len(slices.levels.height))  # level that meets each block
    np.minimum.at(first, blocks.before, blocks.level)
    begins, until = first[block[ends]].T.copy()
    by_start = np.argsort(begins, kind="stable")
    clear = np.isnan(slices.levels.tie_x) if upward else np.isnan(slices.levels.tie_x)[::-1].copy()
    _sweep(blocks, block[ends[:, 0]], (begins, at, until), by_start, clear, found)
    return found._replace(into=np.abs(found.into))


def _see(slices, graph, marks, upward):
    """The :class:`_Blocks` of a sliced solid in one direction, and the block of each critical point."""
    block, count, regions = slices.block_of_piece[slices.pieces.of_node], slices.n_blocks, slices.regions
    volume = np.bincount(slices.block_of_piece, weights=slices.surfaces.flux, minlength=count)
    area = np.bincount(regions.of_contour, weights=regions.area, minlength=len(regions.level))
    places, level, ends = np.arange(len(block)), regions.level, (slices.block_below, slices.block_above)
    if not upward:
        places, level, ends = -places, len(slices.levels.height) - 1 - level, ends[::-1]
    first = np.full(count, len(block))
    np.minimum.at(first, block, places)
    by_level = np.argsort(level, kind="stable")
    area = np.asarray(area, np.float64)  # of no regions it may be of another type
    return _Blocks(*map(np.ascontiguousarray, (volume, first, marks, level, area, *ends, by_level))), block


@njit
def _sweep(blocks, block, times, by_start, clear, found):
    """Kernel of `sweep_pockets`; fills `found`. What a component is part of then, the slab that holds its end tells."""
    begins, at, until = times
    n, n_levels, crossed, started, n_active = len(blocks.volume), len(clear), 0, 0, 0
    root, volume, first, marks = np.arange(n), blocks.volume.copy(), blocks.first.copy(), blocks.marks.copy()
    area, widest = np.zeros(n), np.full(n, -1)  # at the level: of each root, and its largest region
    active = np.empty(len(at), np.int64)
    for level in range(n_levels + 1):
        here = crossed
        while here < len(blocks.by_level) and blocks.level[blocks.by_level[here]] == level:
            region = blocks.by_level[here]
            part = find(root, np.int64(blocks.before[region]))
            area[part] += blocks.area[region]
            if widest[part] < 0 or blocks.area[region] > blocks.area[widest[part]]:
                widest[part] = region
            here += 1
        while started < len(at) and begins[by_start[started]] <= level:
            active[n_active] = by_start[started]
            started, n_active = started + 1, n_active + 1
        for k in range(n_active):
            part = find(root, np.int64(block[active[k]]))
            if level < n_levels and clear[level] and level <= at[active[k]]:
                _measure(found, active[k], area, widest, part)
            if at[active[k]] == level:
                found.volume[active[k]] = volume[part]
                for word in range(marks.shape[1]):
                    found.shells[active[k], word] = marks[part, word]
            if until[active[k]] == level:
                found.into[active[k]] = first[part]
        for place in range(crossed, here):
            part = find(root, np.int64(blocks.before[blocks.by_level[place]]))
            area[part], widest[part] = 0.0, -1
        for place in range(crossed, here):
            _join(blocks, blocks.by_level[place], root, volume, first, marks)
        left = 0
        for k in range(n_active):
            if until[active[k]] > level:
                active[left] = active[k]
                left += 1
        crossed, n_active = here, left


@njit
def _measure(found, q, area, widest, part):
    """Take the section of a component at a level."""
    if widest[part] < 0:
        return
    found.section[q] = area[part]
    if found.throat_region[q] < 0 or area[part] > found.largest[q]:
        found.largest[q] = found.throat[q] = area[part]
        found.throat_region[q] = widest[part]
    elif area[part] <= found.throat[q]:
        found.throat[q], found.throat_region[q] = area[part], widest[part]


@njit
def _join(blocks, region, root, volume, first, marks):
    """Join what a region holds together."""
    one, two = find(root, np.int64(blocks.before[region])), find(root, np.int64(blocks.behind[region]))
    if one != two:
        root[two] = one
        volume[one] += volume[two]
        first[one] = min(first[one], first[two])
        for word in range(marks.shape[1]):
            marks[one, word] |= marks[two, word]
