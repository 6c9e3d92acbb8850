"""The tables of a sliced surface: levels, contours, pieces."""

import numpy as np
import shapely

from .schemas import build_table
from .slicing import measure_contours


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
    contours, regions = slices.contours, slices.regions
    area, perimeter = measure_contours(contours)
    lower, upper = mesh.vertex[contours.lower], mesh.vertex[contours.upper]
    return build_table(
        "contours",
        {
            "level": contours.level,
            "contour": np.arange(len(area)),
            "height": slices.levels.height[contours.level],
            "shell": shell_of_vertex[contours.lower],
            "region": regions.of_contour,
            "inner": regions.inner,
            "parent": [None if p < 0 else p for p in regions.parent.tolist()],
            "signed_area": area,
            "perimeter": perimeter,
            "n_points": np.diff(contours.start),
            "lower_vertex": lower,
            "upper_vertex": upper,
            "geometry": shapely.to_wkb(closed_curves(contours.points, contours.start)),
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


def closed_curves(points, start):
    """Closed shapely line strings (C,), coinciding neighbours dropped.

    points : (X, 2); start : (C + 1,). A curve of which only one point remains
    is closed onto itself.
    """
    count = len(start) - 1
    curve = np.repeat(np.arange(count), np.diff(start))
    before = np.arange(len(points)) - 1
    before[start[:-1]] = start[1:] - 1
    keep = (points != points[before]).any(axis=1)
    keep[start[:-1]] |= ~np.logical_or.reduceat(keep, start[:-1]) if count else False
    kept, curve = points[keep], curve[keep]
    first = np.searchsorted(curve, np.arange(count))
    order = np.argsort(np.concatenate([curve, np.arange(count)]), kind="stable")
    return shapely.linestrings(
        np.concatenate([kept, kept[first]])[order], indices=np.concatenate([curve, np.arange(count)])[order]
    )


def _lists(group, count):
    """The members of every group: `count` lists of the positions in `group`."""
    order = np.argsort(group, kind="stable")
    return [part.tolist() for part in np.split(order, np.searchsorted(group[order], np.arange(1, count)))]


def _or_null(values):
    return [None if np.isnan(value) else value for value in values.tolist()]
