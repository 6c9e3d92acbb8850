"""Volumes and sections of pockets and islands, from slices through their ends."""

from typing import NamedTuple

import numpy as np

from ..arrays.grouping import Groups
from ..slicing.levels import Levels, cut_between, uniform_heights
from ..slicing.slices import cut_surface
from .loop_measures import measure_insides
from .pocket_sweeps import Swept, list_shells, mark_shells, sweep_pockets

# So far before a rim its section is taken, since at the rim itself contours touch: of the pocket's depth,
# so that the volume is right to the square of it, but beyond rounding, of the height of all.
GAP, ROUNDING = 1e-6, 1e-12
# Of the height of what is measured: the default distance between the levels.
SHARE = 1 / 200


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
    largest : (P,) float64
        The largest of its sections at the levels.
    throat_height, throat_section, throat_radius : (P,) float64
        On the way from there to where it ends the narrowest section at a level, and the radius of the largest
        circle in it: the way in or out. NaN of what has none: it is sealed, or never joins.
    into : (P,) int32
        The pocket of the same kind into which it opens; -1 for none: it opens to
        the outside, or, an island, joins what is not one, or ends at its top.
    shells : Groups
        Of each the shells of the surface that it touches, each as the vertex of its lowest point, the lowest first.
    """

    kind: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    begin_height: np.ndarray
    end_height: np.ndarray
    volume: np.ndarray
    section: np.ndarray
    largest: np.ndarray
    throat_height: np.ndarray
    throat_section: np.ndarray
    throat_radius: np.ndarray
    into: np.ndarray
    shells: Groups


def measure_pockets(mesh, graph, body_of_vertex, found, distance):
    """Measure pockets by slices through their ends, and at levels between.

    Parameters
    ----------
    mesh : HeightMesh
        Whose solid they are components of, below or above a height; n vertices.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32
    found : sequence of (kind, pairs, whole)
        Pockets by kind: ranks (p, 2) where each begins and ends, and whether a component of the solid ends there.
    distance : float or None
        Upper bound of the spacing of the levels, mesh units; None for 1/200 of the height between the first
        beginning or end and the last one.

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
    levels, level = _levels_at(mesh, begin, end, distance)
    slices = cut_surface(mesh, levels, body_of_vertex, graph)
    marks, lowest = mark_shells(mesh, graph, slices)
    swept = Swept.empty(len(kind), marks.shape[1])
    for upward in (True, False):
        chosen = np.flatnonzero((end > begin) == upward)
        at = np.where(whole, len(levels.height), level if upward else len(levels.height) - 1 - level)[chosen]
        place = np.searchsorted(graph.nodes, np.column_stack([begin, end])[chosen])
        found_there = sweep_pockets(slices, graph, marks, upward, place, at)
        number = dict(zip(place[:, 0].tolist(), chosen.tolist()))
        into = [number.get(place, -1) for place in found_there.into.tolist()]
        for column, values in zip(swept, found_there._replace(into=np.array(into, np.int64))):
            column[chosen] = values
    gap = np.abs(mesh.points[end, 2] - levels.height[level])
    section = np.where(whole, 0.0, _spread(swept, mesh.points[end, 2]))
    radius = _inscribe(slices, swept.throat_region)
    open_there = ~whole & (swept.throat_region >= 0)
    throat = (
        np.where(open_there, levels.height[slices.regions.level[swept.throat_region]], np.nan) if len(kind) else gap
    )
    return Pockets(
        kind, mesh.vertex[begin], mesh.vertex[end], mesh.points[begin, 2], mesh.points[end, 2],
        np.where(whole, swept.volume, swept.volume + section * gap), section, np.maximum(swept.largest, section),
        throat, *(np.where(open_there, column, np.nan) for column in (swept.throat, radius)),
        np.where(whole, -1, swept.into).astype(np.int32), list_shells(swept.shells, lowest),
    )  # fmt: skip


def _spread(swept, end_height):
    """The sections at the ends, with those of what opens into each at the very height at which it ends itself."""
    section = swept.section.copy()
    for row in np.argsort(swept.volume, kind="stable").tolist():  # what opens into another is smaller than that then
        other = swept.into[row]
        if other >= 0 and end_height[row] == end_height[other]:
            section[other] += section[row]
    return section


def _inscribe(slices, chosen):
    """The radius of the largest circle in each region of `chosen`, which may be named twice; 0 of none, -1."""
    rows, place = np.unique(chosen[chosen >= 0], return_inverse=True)
    radius = np.zeros(len(chosen))
    if len(rows):
        radius[chosen >= 0] = measure_insides(slices.contours, slices.regions, slices.regions.outer[rows])[1][place]
    return radius


def _levels_at(mesh, begin, end, distance):
    """Levels no further apart than `distance`, those of :func:`_cut_before`, and which are its second ones."""
    cuts = [_cut_before(mesh, first, last) for first, last in zip(begin.tolist(), end.tolist())]
    rows = {row for pair in cuts for row in pair} | set(_levels_between(mesh, begin, end, distance))
    ordered = sorted(rows, key=lambda row: row[:2])
    number = {row: k for k, row in enumerate(ordered)}
    below, z, tie_x, tie_y = np.array(ordered, float).reshape(-1, 4).T.copy()
    levels = Levels(z, below.astype(np.int32), tie_x, tie_y)
    return levels, np.array([number[row] for _, row in cuts], np.int64)


def _cut_before(mesh, first, last):
    """Where a pocket that begins at rank `first` is cut before it ends at `last`, as rows of what a level is.

    The first is right before all that has the height of the end. The second is right before the end itself: the
    same, but for an end inside a flat. (Of what is swept downward, before is above.)
    """
    height, up = mesh.points[:, 2], last > first
    edge = int(np.searchsorted(height, height[last], "left" if up else "right"))
    step = max(GAP * abs(height[last] - height[first]), ROUNDING * (height[-1] - height[0]))
    step = min(step, (height[edge] - height[edge - 1]) / 2)
    clear = edge, height[last] + (-step if up else step), np.nan, np.nan
    if edge == (last if up else last + 1):
        return clear, clear
    z, below, *tie = cut_between(mesh, *((last - 1, last) if up else (last, last + 1)))
    return clear, (below, z, *tie)


def _levels_between(mesh, begin, end, distance):
    """Equispaced levels where there are pockets, but for those within flats, as rows of what a level is."""
    heights = mesh.points[np.concatenate([begin, end]), 2]
    low, high = (heights.min(), heights.max()) if len(heights) else (0.0, 0.0)
    if low == high:
        return []
    z = uniform_heights(low, high, distance or (high - low) * SHARE)
    below = np.searchsorted(mesh.points[:, 2], z)
    clear = mesh.points[np.minimum(below, len(mesh.points) - 1), 2] > z
    return [(rank, height, np.nan, np.nan) for rank, height in zip(below[clear].tolist(), z[clear].tolist())]
