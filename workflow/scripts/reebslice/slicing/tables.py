"""The tables of a sliced surface: levels, contours, pieces."""

import itertools

import numpy as np
import pyarrow as pa

from ..arrays.grouping import group_items, list_groups, split_into_blocks
from ..formats.wkb import pack_curves, unpack_curves
from ..planar.curves import pick_curves
from ..planar.outlines import Outlines, mend_outlines
from ..table_checks import build_table
from .levels import Levels

POINTS_AT_ONCE = 1 << 18  # of contours packed together: 4 MB of them, which stay in a cache


def levels_table(slices, refined):
    """Make the table `levels`, one row per level.

    Parameters
    ----------
    slices : Slices
        A surface cut at K levels.
    refined : (K,) bool
        False for equispaced levels.

    Returns
    -------
    pyarrow.Table
        As `schemas` declares it.
    """
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


def levels_of_table(table):
    """Take levels from their table.

    Parameters
    ----------
    table : pyarrow.Table
        `levels`.

    Returns
    -------
    Levels
        All rows.
    """
    height, tie_x, tie_y = (
        table[name].to_numpy(zero_copy_only=False).astype(float) for name in ("height", "tie_x", "tie_y")
    )
    return Levels(height, np.array(table["vertices_below"], np.int32), tie_x, tie_y)


def contours_table(mesh, slices, shell_of_vertex):
    """Make the table `contours`, one row per contour, its curve as a WKB closed line string.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    slices : Slices
        The surface, cut.
    shell_of_vertex : (n,) int32
        The shell of every rank.

    Returns
    -------
    pyarrow.Table
        As `schemas` declares it.
    """
    return pa.concat_tables(contours_blocks(mesh, slices, shell_of_vertex))


def contours_blocks(mesh, slices, shell_of_vertex):
    """Make the table `contours` in blocks of rows, so that few curves are packed at a time.

    Parameters
    ----------
    mesh, slices, shell_of_vertex
        As for :func:`contours_table`.

    Yields
    ------
    pyarrow.Table
        The next rows, whose contours come to POINTS_AT_ONCE points, or a single one.
    """
    for first, end in split_into_blocks(slices.contours.start, POINTS_AT_ONCE):
        yield _contour_rows(mesh, slices, shell_of_vertex, slice(first, end))


def _contour_rows(mesh, slices, shell_of_vertex, rows):
    """Rows of the table `contours`; rows : a slice of them."""
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
    """Make the table `pieces`, one row per piece.

    Parameters
    ----------
    mesh : HeightMesh
        Surface of n vertices.
    slices : Slices
        The surface, cut by :func:`.slices.cut_surface`.
    shell_of_vertex : (n,) int32
        The shell of every rank.

    Returns
    -------
    pyarrow.Table
        As `schemas` declares it.
    """
    pieces, surfaces, count = slices.pieces, slices.surfaces, len(slices.pieces.slab)
    shell = np.empty(count, np.int32)
    shell[pieces.piece_above] = shell[pieces.piece_below] = shell_of_vertex[slices.contours.lower]
    shell[surfaces.of_vertex] = shell_of_vertex
    return build_table(
        "pieces",
        {
            "slab": pieces.slab,
            "piece": np.arange(count),
            "shell": shell,
            "block": slices.block_of_piece,
            "n_below": pieces.n_below,
            "n_above": pieces.n_above,
            "below": list_groups(group_items(pieces.piece_above, count)),
            "above": list_groups(group_items(pieces.piece_below, count)),
            "euler_characteristic": pieces.euler_characteristic,
            "genus": pieces.genus,
            "kind": pieces.kinds(),
            "area": surfaces.area,
            "flux": surfaces.flux,
            "critical": list_groups(pieces.critical._replace(member=mesh.vertex[pieces.critical.member])),
            "critical_ranks": list_groups(pieces.critical),
        },
    )


def _or_null(values):
    """A list of the values, None for NaN."""
    return [None if np.isnan(value) else value for value in values.tolist()]


def block_regions(pieces, contours):
    """List the regions below and above every block.

    Parameters
    ----------
    pieces, contours : pyarrow.Table
        The tables.

    Returns
    -------
    below, above : list of B lists of int
        Ids of the regions, ascending.
    """
    region, block = contours["region"].to_numpy(), pieces["block"].to_numpy().astype(np.int64)
    count = max(count_regions(contours), 1)
    ends = []
    for side in ("below", "above"):
        bounding = pieces[side].combine_chunks()
        owner = np.repeat(block, np.diff(bounding.offsets.to_numpy()))
        pairs = np.unique(owner * count + region[bounding.flatten().to_numpy()])
        members, cuts = (pairs % count).tolist(), np.searchsorted(pairs, count * np.arange(block.max() + 2)).tolist()
        ends.append([members[a:b] for a, b in itertools.pairwise(cuts)])
    return ends


def count_regions(contours):
    """Count the regions of the table `contours`; there are none where all levels pass between the parts of a model."""
    return int(contours["region"].to_numpy().max(initial=-1)) + 1


def region_levels(contours):
    """Look up the level of every region of the table `contours`, (R,) int32."""
    region = contours["region"].to_numpy()
    level = np.empty(count_regions(contours), np.int32)
    level[region] = contours["level"].to_numpy()
    return level


def contour_curves(contours, geometry):
    """Read the curves of the contours.

    Parameters
    ----------
    contours : pyarrow.Table
        The table, which may lack the column `geometry`.
    geometry : iterable of pyarrow.Array
        That column, of which one array is held at a time.

    Returns
    -------
    Curves
        Closed curves in the tilted frame; of neighbouring points that coincide the file has one.
    """
    return unpack_curves(geometry, int(contours["n_points"].to_numpy().sum()) + contours.num_rows)


def region_outlines(contours, curves):
    """Gather the outlines of the regions.

    Parameters
    ----------
    contours : pyarrow.Table
        The table, of R regions.
    curves : Curves
        What :func:`contour_curves` returns.

    Returns
    -------
    Outlines
        Valid as polygons, tilted frame. Contours too small to span a triangle in floating point are left out;
        a region whose outer contour is one of them has no outline.
    """
    region, inner = contours["region"].to_numpy(), contours["inner"].to_numpy(zero_copy_only=False)
    usable, count = _spans_triangle(contours, curves), count_regions(contours)
    has_outer = np.zeros(count, bool)
    has_outer[region[usable & ~inner]] = True
    order = np.flatnonzero(usable & has_outer[region])
    order = order[np.lexsort((inner[order], region[order]))]  # the outer contour first
    start = np.concatenate([[0], np.cumsum(np.bincount(region[order], minlength=count))])
    return mend_outlines(Outlines(*pick_curves(curves, order), start, inner[order]))


def contour_outlines(contours, curves):
    """Gather the outlines of what every contour encloses, hole or not.

    Parameters
    ----------
    contours, curves
        As for :func:`region_outlines`.

    Returns
    -------
    Outlines
        Of C contours.
    """
    usable = _spans_triangle(contours, curves)
    rings = pick_curves(curves, np.flatnonzero(usable))
    return mend_outlines(Outlines(*rings, np.concatenate([[0], np.cumsum(usable)]), np.zeros(usable.sum(), bool)))


def _spans_triangle(contours, curves):
    """Whether each contour spans a triangle in floating point."""
    return (np.diff(curves.start) >= 4) & (contours["signed_area"].to_numpy() != 0)
