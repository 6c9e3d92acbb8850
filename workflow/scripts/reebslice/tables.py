"""The tables of a sliced surface: levels, contours, pieces."""

import numpy as np
import pyarrow as pa

from .curves import pack_curves
from .schemas import build_table
from .slicing import share_out

POINTS_AT_ONCE = 1 << 18  # of contours packed together: 4 MB of them, which stay in a cache


def levels_table(slices, refined):
    """One row per level. refined : (K,) bool, False for equispaced levels."""
    levels, count = slices.levels, len(slices.levels.height)
    return build_table(
        "levels",
        {
            "level": np.arange(count),
            "height": levels.height,
            "vertices_below": levels.below,
            "tie_x": _or_null(levels.tie_x),
            "tie_y": _or_null(levels.tie_y),
            "n_contours": np.bincount(slices.contours.level, minlength=count),
            "n_regions": np.bincount(slices.regions.level, minlength=count),
            "why": np.where(refined, "refined", "uniform").tolist(),
        },
    )


def contours_table(mesh, slices, shell_of_vertex):
    """One row per contour, its curve as a WKB closed line string.

    shell_of_vertex : (n,) of the mesh's ranks.
    """
    return pa.concat_tables(contours_blocks(mesh, slices, shell_of_vertex))


def contours_blocks(mesh, slices, shell_of_vertex):
    """The same, one block of rows after the other, so that the curves of one block are packed at a time."""
    for first, end in share_out(slices.contours.start, POINTS_AT_ONCE):
        yield _contour_rows(mesh, slices, shell_of_vertex, slice(first, end))


def _contour_rows(mesh, slices, shell_of_vertex, rows):
    contours, regions = slices.contours, slices.regions
    level, lower, start = contours.level[rows], contours.lower[rows], contours.start[rows.start : rows.stop + 1]
    return build_table(
        "contours",
        {
            "level": level,
            "contour": np.arange(rows.start, rows.stop),
            "height": slices.levels.height[level],
            "shell": shell_of_vertex[lower],
            "region": regions.of_contour[rows],
            "inner": regions.inner[rows],
            "parent": [None if p < 0 else p for p in regions.parent[rows].tolist()],
            "signed_area": regions.area[rows],
            "perimeter": regions.perimeter[rows],
            "n_points": np.diff(start),
            "lower_vertex": mesh.vertex[lower],
            "upper_vertex": mesh.vertex[contours.upper[rows]],
            "geometry": pack_curves(contours.points[start[0] : start[-1]], start - start[0]),
        },
    )


def pieces_table(mesh, slices, shell_of_vertex):
    """One row per piece. shell_of_vertex : (n,) of the mesh's ranks."""
    pieces, count = slices.pieces, len(slices.pieces.slab)
    shell = np.empty(count, np.int32)
    shell[pieces.above] = shell[pieces.below] = shell_of_vertex[slices.contours.lower]
    shell[pieces.of_vertex] = shell_of_vertex
    return build_table(
        "pieces",
        {
            "slab": pieces.slab,
            "piece": np.arange(count),
            "shell": shell,
            "block": slices.block_of_piece,
            "n_below": pieces.n_below,
            "n_above": pieces.n_above,
            "below": _lists(pieces.above, count),
            "above": _lists(pieces.below, count),
            "euler_characteristic": pieces.euler_characteristic,
            "genus": pieces.genus,
            "kind": pieces.kinds(),
            "area": pieces.area,
            "flux": pieces.flux,
            "critical": [mesh.vertex[critical].tolist() for critical in pieces.critical],
            "critical_ranks": [critical.tolist() for critical in pieces.critical],
        },
    )


def _lists(group, count):
    """The members of every group: `count` lists of the positions in `group`."""
    order = np.argsort(group, kind="stable")
    members, cuts = order.tolist(), np.cumsum(np.bincount(group, minlength=count)).tolist()
    return [members[a:b] for a, b in zip([0, *cuts], cuts)]


def _or_null(values):
    return [None if np.isnan(value) else value for value in values.tolist()]
