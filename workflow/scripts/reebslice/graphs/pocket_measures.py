"""Volumes and sections of pockets and islands, from slices through their ends."""

from typing import NamedTuple

import numpy as np

from ..arrays.components import find
from ..kernels import njit
from ..slicing.levels import Levels, cut_between
from ..slicing.slices import cut_surface

# So far before a rim its section is taken, since at the rim itself contours touch: of the pocket's depth,
# so that the volume is right to the square of it, but beyond rounding, of the height of all.
GAP, ROUNDING = 1e-6, 1e-12


class Pockets(NamedTuple):
    """Components of the void, or of the solid, below or above a height; P of them.

    Attributes
    ----------
    kind : (P,) str
        ``basin``: holds liquid, from its bottom up to where it spills. ``bell``:
        catches air, from its top down to where it is vented. ``sealed``: a
        void that the outside never reaches, from its bottom to its top.
        ``island``: material that begins in the air, from its lowest point up
        to where it joins what began lower; or to its top, if it never does.
    begin, end : (P,) int32
        The vertices where each begins and ends.
    begin_height, end_height : (P,) float64
        Mesh units; of a bell the first is the larger.
    volume : (P,) float64
        Between these heights, what is in it of smaller pockets of its kind
        included, mesh units cubed.
    section : (P,) float64
        Area in the plane where it ends: of a basin the surface of the liquid
        that it holds at most. 0 of what ends in a point.
    into : (P,) int32
        The pocket of the same kind into which it opens; -1 for none: it opens to
        the outside, or, an island, joins what is not one, or ends at its top.
    """

    kind: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    begin_height: np.ndarray
    end_height: np.ndarray
    volume: np.ndarray
    section: np.ndarray
    into: np.ndarray


class _Sweep(NamedTuple):
    """A solid cut at K levels into B blocks and R regions, seen along the direction in which it is swept."""

    volume: np.ndarray  # (B,)
    first: np.ndarray  # (B,) place of the first critical point, in order of the sweep
    level: np.ndarray  # (R,) of regions
    area: np.ndarray  # (R,)
    before: np.ndarray  # (R,) block
    behind: np.ndarray  # (R,) block


def measure_pockets(mesh, graph, body_of_vertex, found):
    """Measure pockets by slices through their ends.

    Parameters
    ----------
    mesh : HeightMesh
        Whose solid they are components of, below or above a height; n vertices.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32
    found : sequence of (kind, pairs, whole)
        Pockets by kind: ranks (p, 2) where each begins and ends, and whether a component of the solid ends there.

    Returns
    -------
    Pockets
        In the order of `found`.

    Raises
    ------
    TooManyCrossingsError
        The contours would not fit into memory.
    """
    kind = np.repeat([name for name, *_ in found], [len(pairs) for _, pairs, _ in found])
    whole = np.concatenate([np.full(len(pairs), whole) for _, pairs, whole in found])
    begin, end = np.concatenate([pairs for _, pairs, _ in found]).astype(np.int64).T
    levels, level = _levels_at(mesh, begin, end)
    slices = cut_surface(mesh, levels, body_of_vertex, graph)
    volume, section, into = np.zeros(len(kind)), np.zeros(len(kind)), np.full(len(kind), -1, np.int32)
    for upward in (True, False):
        chosen = np.flatnonzero((end > begin) == upward)
        sweep, block = _seen(slices, graph, upward)
        at = np.where(whole, len(levels.height), level if upward else len(levels.height) - 1 - level)[chosen]
        place = np.searchsorted(graph.nodes, begin[chosen])
        volume[chosen], section[chosen], oldest = _sweep(sweep, block[place], at)
        number = dict(zip(place.tolist(), chosen.tolist()))
        into[chosen] = [number.get(place, -1) for place in oldest.tolist()]
    gap = np.abs(mesh.points[end, 2] - levels.height[level])
    volume, into = np.where(whole, volume, volume + section * gap), np.where(whole, -1, into).astype(np.int32)
    return Pockets(
        kind, mesh.vertex[begin], mesh.vertex[end], mesh.points[begin, 2], mesh.points[end, 2], volume, section, into
    )


def _levels_at(mesh, begin, end):
    """A level just before each end, and the number of it; of a pocket that is swept downward, that is just above."""
    height, cuts = mesh.points[:, 2], []
    least = ROUNDING * (height[-1] - height[0])
    for first, last in zip(begin.tolist(), end.tolist()):
        low, high = (last - 1, last) if last > first else (last, last + 1)
        z, below, *tie = cut_between(mesh, low, high)
        if height[low] < height[high]:
            step = max(GAP * abs(height[last] - height[first]), least)
            step = min(step, (height[high] - height[low]) / 2)
            z, below, tie = (height[last] - step if last > first else height[last] + step), high, [np.nan, np.nan]
        cuts.append((below, z, *tie))
    ordered = sorted(set(cuts), key=lambda cut: cut[:2])
    number = {cut: k for k, cut in enumerate(ordered)}
    below, z, tie_x, tie_y = np.array(ordered, float).reshape(-1, 4).T
    return Levels(z, below.astype(np.int32), tie_x, tie_y), np.array([number[cut] for cut in cuts], np.int64)


def _seen(slices, graph, upward):
    """The :class:`_Sweep` of a sliced solid in one direction, and the block (K,) of each node of the graph."""
    block, count, regions = slices.block_of_piece[slices.pieces.of_node], slices.n_blocks, slices.regions
    volume = np.bincount(slices.block_of_piece, weights=slices.surfaces.flux, minlength=count)
    area = np.bincount(regions.of_contour, weights=regions.area, minlength=len(regions.level))
    first = np.full(count, len(graph.nodes))
    np.minimum.at(first, block, np.arange(len(block)))
    if upward:
        return _Sweep(volume, first, regions.level, area, slices.block_below, slices.block_above), block
    last, n = np.full(count, -1), len(slices.levels.height)
    np.maximum.at(last, block, np.arange(len(block)))
    ends = slices.block_above, slices.block_below
    return _Sweep(volume, -last, n - 1 - regions.level, area, *ends), block


def _sweep(sweep, block, at):
    """Measure components that end at levels: volume, section there, and the first node of what each then is part of."""
    order = np.argsort(at, kind="stable")
    by_level = np.argsort(sweep.level, kind="stable")
    columns = np.empty((3, len(at)))
    columns[:, order] = _sweep_levels(_Sweep(*map(np.ascontiguousarray, sweep)), by_level, block[order], at[order])
    return columns[0], columns[1], np.abs(columns[2]).astype(np.int64)


@njit
def _sweep_levels(sweep, by_level, block, at):
    """Kernel of `_sweep`, of pockets in order of their levels: a row of three numbers for each."""
    found = np.zeros((3, len(at)))
    root, volume, first = np.arange(len(sweep.volume)), sweep.volume.copy(), sweep.first.copy()
    crossed, p = 0, 0
    while p < len(at):
        level, end = at[p], p
        while end < len(at) and at[end] == level:
            end += 1
        crossed = _cross_levels(sweep, by_level, crossed, level, root, volume, first)
        for q in range(p, end):
            found[0, q] = volume[find(root, np.int64(block[q]))]
        here = crossed
        while here < len(by_level) and sweep.level[by_level[here]] == level:
            region = by_level[here]
            for q in range(p, end):
                if find(root, np.int64(block[q])) == find(root, np.int64(sweep.before[region])):
                    found[1, q] += sweep.area[region]
            here += 1
        crossed = _cross_levels(sweep, by_level, crossed, level + 1, root, volume, first)
        for q in range(p, end):
            found[2, q] = first[find(root, np.int64(block[q]))]
        p = end
    return found


@njit
def _cross_levels(sweep, by_level, crossed, end, root, volume, first):
    """Join what regions below level `end` hold together, with volumes and first nodes; return the regions crossed."""
    while crossed < len(by_level) and sweep.level[by_level[crossed]] < end:
        region = by_level[crossed]
        one, two = find(root, np.int64(sweep.before[region])), find(root, np.int64(sweep.behind[region]))
        if one != two:
            root[two] = one
            volume[one] += volume[two]
            first[one] = min(first[one], first[two])
        crossed += 1
    return crossed
