"""Levels that pierce all loops of a surface's Reeb graph, their regions, and where plumb lines come to them.

Between two such levels neither the surface nor the solid has a loop
(:mod:`.solid_by_trees`). They are the fewest that pierce the intervals between
the two ends of each loop, so what is fine and near each other shares one level.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.sorting import sort_stably
from ..kernels import njit
from ..mesh.exact_signs import LARGEST
from ..morse.loop_cuts import Cuts, code_of_node, no_cuts
from ..morse.ordered_mesh import next_half_edge
from ..slicing.contours import Contours
from ..slicing.exact_contours import exact_tilt
from ..slicing.graph_slices import trace_arcs_at_levels
from ..slicing.levels import Levels, cut_between, pierce
from ..slicing.regions import Regions, find_regions
from .exact_lines import AT_FACE, FORWARD, exact_end
from .plumb_lines import LineHits

# Of the largest coordinate: offsets and distances in a level, with what a crossing is off its place, err by less.
ROUNDING = 128 * np.finfo(float).eps
TURN = tuple(map(float, FORWARD))
UNSURE = 2


class LoopCut(NamedTuple):
    """A surface cut where levels pierce its loops; `cuts` has a cut for each of the regions."""

    levels: Levels
    contours: Contours | None
    regions: Regions | None
    cuts: Cuts


def cut_at_loops(mesh, graph, body_of_vertex):
    """Cut a surface, and the solid, at the fewest levels that pierce all loops of the surface's Reeb graph.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    graph : ReebGraph
        The mesh's.
    body_of_vertex : (n,) int32

    Returns
    -------
    LoopCut
        Without contours and regions where there is no loop.
    """
    is_saddle = np.bincount(graph.arcs.ravel(), minlength=len(graph.nodes)) == 3
    loop = is_saddle & is_saddle[graph.partner] & (np.arange(len(graph.nodes)) < graph.partner)
    pairs = np.column_stack([graph.nodes[loop], graph.nodes[graph.partner[loop]]])
    cuts = [cut_between(mesh, *pair) for pair in pierce(map(tuple, pairs.tolist()))]
    columns = zip(*cuts) if cuts else ([],) * 4
    levels = Levels(*(np.array(column, kind) for column, kind in zip(columns, (float, np.int32, float, float))))
    if not cuts:
        return LoopCut(levels, None, None, no_cuts())
    contours = trace_arcs_at_levels(mesh, graph, levels)[0]
    regions = find_regions(mesh, levels, contours, body_of_vertex[contours.lower])
    vertex = levels.below[regions.level]
    top = np.searchsorted(graph.nodes, vertex) + 2 * np.arange(len(vertex))
    half_edge = _walk_contours(mesh, vertex[regions.of_contour], contours.first, contours.start)
    cut = np.repeat(regions.of_contour, np.diff(contours.start)).astype(np.int32)
    order = sort_stably((cut, len(vertex)), (half_edge, 3 * len(mesh.faces)))
    first = contours.first[regions.outer]
    return LoopCut(levels, contours, regions, Cuts(vertex, top.astype(np.int32), first, half_edge[order], cut[order]))


@njit
def _walk_contours(mesh, cut, first, start):
    """The half-edges that contours cross, one contour after the other, (X,) int32."""
    out = np.empty(start[-1], np.int32)
    for c in range(len(first)):
        h = first[c]
        for place in range(start[c], start[c + 1]):
            out[place] = h
            h = next_half_edge(mesh.faces, mesh.twins, h, cut[c])
    return out


def end_lines(mesh, cut, body_of_vertex, lines, hits):
    """Find what each plumb line ties its vertex to: a corner of the face that it meets, or a region of a level.

    Parameters
    ----------
    mesh : HeightMesh
        Of n vertices.
    cut : LoopCut
    body_of_vertex : (n,) int32
    lines : (Q,) int64 and (Q,) bool
        Where the lines begin, and which run up.
    hits : LineHits
        Of these lines, none doubtful.

    Returns
    -------
    (Q,) int32 or None
        The lowest corner of the face where a line runs down, the highest where it runs up, if it comes to that before
        it comes to a level; else the code of the region's node on this side of the level. None where a line comes to
        a level outside of all regions.
    """
    (vertices, upward), below = lines, cut.levels.below
    corners = mesh.faces[hits.face]
    low, high = corners[:, 0], corners[:, 1:].max(axis=1, initial=0)
    behind = np.where(upward, high, low)
    level = np.searchsorted(below, vertices, side="right") - ~upward
    chosen = np.flatnonzero((level >= 0) & (level < len(below)))
    cutting = below[level[chosen]]
    come = np.where(upward[chosen], high[chosen] >= cutting, low[chosen] < cutting)
    chosen, cutting = chosen[come], cutting[come]
    if len(chosen):
        crosses = (low[chosen] < cutting) & (high[chosen] >= cutting)
        region = _find_regions(mesh, cut, body_of_vertex, (vertices[chosen], upward[chosen]), level[chosen],
                               (LineHits(*(column[chosen] for column in hits)), crosses))  # fmt: skip
        if (region < 0).any():
            return None
        behind[chosen] = code_of_node(cut.cuts.top[region] + ~upward[chosen])
    return behind


def _find_regions(mesh, cut, body_of_vertex, lines, level, hits):
    """The region of a level that each line comes to, or to which a face before it comes: (q,), -1 for none.

    level : (q,) next on the way; hits : the first faces, and whether they cross the level.
    """
    (vertices, upward), (hits, crosses) = lines, hits
    first, open_ = (crosses & which for which in _compare_with_level(mesh, cut.levels, vertices, level, hits))
    region, beyond = np.full(len(level), -1), np.flatnonzero(~first & ~open_)
    region[first] = _regions_of_faces(mesh, cut, hits.face[first], level[first])
    region[beyond], doubtful = _locate(mesh, cut, body_of_vertex, vertices[beyond], level[beyond])
    open_[beyond[doubtful]] = True
    tilt = exact_tilt(mesh.points) if open_.any() else None
    for k in np.flatnonzero(open_).tolist():
        line, ends = (int(vertices[k]), bool(upward[k])), (int(hits.face[k]), int(level[k]))
        found = exact_end(mesh, cut, body_of_vertex, line, ends, tilt)
        region[k] = _regions_of_faces(mesh, cut, hits.face[[k]], level[[k]])[0] if found == AT_FACE else found
    return region


def _compare_with_level(mesh, levels, vertices, level, hits):
    """Whether lines meet faces before they come to levels, and whether rounding leaves that open: two (q,) bool."""
    way = np.abs(mesh.points[vertices, 2] - levels.height[level])
    way = np.ldexp(way, LARGEST - int(np.frexp(np.abs(mesh.points).max())[1]))  # in the unit of `scale_points`
    off = np.finfo(float).eps * way
    first, beyond = hits.far < way - off, hits.near > way + off
    return first, ~first & ~beyond


def _regions_of_faces(mesh, cut, faces, level):
    """The region whose contour crosses each face at a level that the face meets, (q,)."""
    corners, cutting = mesh.faces[faces] >= cut.levels.below[level][:, None], cut.cuts
    rising = 3 * faces + np.argmax(~corners & np.roll(corners, -1, axis=1), axis=1)
    place = np.searchsorted(cutting.half_edge, rising)
    # crossings of one half-edge are of consecutive levels
    return cutting.cut[place + level - cut.regions.level[cutting.cut[place]]]


def _locate(mesh, cut, body_of_vertex, vertices, level):
    """The region of a level above or below each vertex, and places of those where rounding leaves it open: (q,), (d,).

    -1 where the region is open or there is none.
    """
    contours, regions = cut.contours, cut.regions
    aside = TURN[0] * mesh.points[vertices, 1] - TURN[1] * mesh.points[vertices, 0]
    order = np.lexsort((aside, level))
    start = np.searchsorted(level[order], np.arange(len(cut.levels.below) + 1))
    rounding = ROUNDING * np.abs(mesh.points).max()
    points, body = mesh.points[vertices[order], :2], body_of_vertex[vertices[order]]
    found, open_ = _look_along(
        contours, regions.of_contour, body_of_vertex[contours.lower], points, body, aside[order], start, rounding
    )
    region = np.empty(len(order), np.int64)
    region[order] = found
    return region, order[open_]


@njit
def _look_along(contours, region_of, body_of, points, body, aside, start, rounding):
    """The region on the left of the first contour that a ray from each point crosses, and whether it is open.

    points : (q, 2), body, aside : (q,) of the points, in order of level, then of `aside`; start : (K + 1,) of the
    points of each level.
    """
    found, open_ = np.full(len(points), -1), np.zeros(len(points), np.bool_)
    near, far = np.full(len(points), np.inf), np.full(len(points), np.inf)
    for c in range(len(contours.level)):
        first, end = start[contours.level[c]], start[contours.level[c] + 1]
        if first == end:
            continue
        last = contours.start[c + 1] - 1
        px, py = contours.points[last]
        for place in range(contours.start[c], contours.start[c + 1]):
            qx, qy = contours.points[place]
            ps, qs = TURN[0] * py - TURN[1] * px, TURN[0] * qy - TURN[1] * qx
            k = first + np.searchsorted(aside[first:end], min(ps, qs) - 4 * rounding)
            while k < end and aside[k] <= max(ps, qs) + 4 * rounding:
                if body[k] == body_of[c]:
                    x, y = points[k]
                    sign, distance, error = cross_ray(px - x, py - y, qx - x, qy - y, rounding)
                    if sign == UNSURE:
                        open_[k] = True
                    elif sign != 0:
                        _note_crossing(found, open_, near, far, k, region_of[c] if sign > 0 else -1, distance, error)
                k += 1
            px, py = qx, qy
    return found, open_


@njit(inline="always")
def _note_crossing(found, open_, near, far, k, region, distance, error):
    """Note a crossing of ray k, if it may be the first."""
    if distance + error < near[k]:
        found[k], near[k], far[k] = region, distance - error, distance + error
    elif distance - error <= far[k]:
        open_[k] |= region != found[k]
        near[k], far[k] = min(near[k], distance - error), min(far[k], distance + error)


@njit
def cross_ray(px, py, qx, qy, rounding):
    """Tell how a segment crosses a ray along `TURN` that starts at the origin.

    Parameters
    ----------
    px, py, qx, qy : float
        Ends of the segment.
    rounding : float
        No end is further from its place, nor its offset from the ray's line.

    Returns
    -------
    sign : int
        1 if it runs to the left, -1 if to the right, 0 if it does not cross the ray, UNSURE where rounding hides it.
    distance, error : float
        Along the ray, and the most that this errs by.
    """
    pt, qt = TURN[0] * px + TURN[1] * py, TURN[0] * qx + TURN[1] * qy  # forward along the ray
    ps, qs = TURN[0] * py - TURN[1] * px, TURN[0] * qy - TURN[1] * qx  # aside from it, to the left
    if max(pt, qt) < -rounding:
        return 0, 0.0, 0.0
    if abs(ps) <= rounding or abs(qs) <= rounding:
        return UNSURE, 0.0, 0.0
    if (ps > 0) == (qs > 0):
        return 0, 0.0, 0.0
    turn = pt * qs - ps * qt
    if abs(turn) <= 2 * rounding * (abs(pt) + abs(ps) + abs(qt) + abs(qs)):
        return UNSURE, 0.0, 0.0
    if (turn > 0) != (qs > 0):
        return 0, 0.0, 0.0  # behind the start
    return (1 if qs > 0 else -1), turn / (qs - ps), 4 * rounding * (1 + abs(qt - pt) / abs(qs - ps))
