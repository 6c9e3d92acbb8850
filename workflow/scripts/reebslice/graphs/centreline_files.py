"""Centrelines as tables, and for other programs: SWC and VTK's poly data."""

import numpy as np

from ..formats.swc import swc_text
from ..formats.vtp import vtp_text
from ..table_checks import build_table
from .branches import path_lengths
from .centrelines import branch_figures, cone_volumes
from .model_files import RADIUS
from .spanning_trees import span_forest


def centreline_tables(lines):
    """Make the tables of centrelines.

    Parameters
    ----------
    lines : Centrelines

    Returns
    -------
    centreline_points, branches : pyarrow.Table
    """
    x, y, z = lines.points.T
    points = {
        "point": np.arange(len(lines.points)),
        "x": x,
        "y": y,
        "z": z,
        "value": lines.value,
        "radius": lines.radius,
        "section": _without_nan(lines.section),
    }
    figures, paths = branch_figures(lines), _list_paths(lines)
    branches = figures | {
        "branch": np.arange(len(paths)),
        "tortuosity": _without_nan(figures["tortuosity"]),
        "points": paths,
        "distance": [path_lengths(lines.points[ids]) for ids in paths],
        "volumes": [cone_volumes(lines, ids) for ids in paths],
    }
    return build_table("centreline_points", points), build_table("branches", branches)


def _without_nan(values):
    return [None if value != value else value for value in np.asarray(values).tolist()]


def _list_paths(lines):
    """Points of each branch, arrays of ids."""
    return np.split(lines.branches.member, lines.branches.start[1:-1])


def count_centrelines(lines):
    """Count what centrelines are made of.

    Parameters
    ----------
    lines : Centrelines

    Returns
    -------
    dict
        `branches`, `length` of all, and by kind of point `ends` and `branch_points`; `parts` that are connected, and
        `loops`.
    """
    paths = _list_paths(lines)
    nodes, degree = np.unique([end for ids in paths for end in (ids[0], ids[-1])], return_counts=True)
    cuts = _span(lines)[1]
    parts = len(nodes) - len(paths) + len(cuts)
    return {
        "branches": len(paths),
        "length": float(sum(path_lengths(lines.points[ids])[-1] for ids in paths)),
        "ends": int((degree == 1).sum()),
        "branch_points": int((degree > 2).sum()),
        "parts": parts,
        "loops": len(cuts),
    }


def _span(lines):
    """The spanning forest of all points, and the steps that it leaves out, (loops, 2) ids of points."""
    steps = np.concatenate([np.column_stack([ids[:-1], ids[1:]]) for ids in _list_paths(lines)])
    forest = span_forest(len(lines.points), steps, lines.radius[steps].min(axis=1))
    return forest, steps[forest.cut]


def centreline_tree(lines, facts):
    """Write centrelines as a forest in SWC.

    Parameters
    ----------
    lines : Centrelines
    facts : dict of str to str

    Returns
    -------
    swc : str
        A tree for each part. Each loop is cut where the tube is narrowest.
    cuts : list of dict
        What was cut, one step per loop: ids of both `points` in the table, their `numbers` in the file.
    """
    forest, cut = _span(lines)
    number = np.argsort(forest.order) + 1
    told = [{"points": pair, "numbers": number[pair].tolist()} for pair in cut.tolist()]
    return swc_text(lines.points[forest.order], lines.radius[forest.order], forest.parent, facts), told


def centreline_paths(lines, facts):
    """Write centrelines as poly data, a line for each branch.

    Parameters
    ----------
    lines : Centrelines
    facts : dict of str to str

    Returns
    -------
    str
        Points carry the radius under the name that VMTK's tools know, `section` (NaN where unknown) and `value`; lines
        the figures of :func:`.centrelines.branch_figures`.
    """
    along = {RADIUS: lines.radius, "section": lines.section, "value": lines.value}
    figures = {name: column for name, column in branch_figures(lines).items() if column.dtype.kind == "f"}
    told = {"branch": np.arange(len(lines.branches.start) - 1, dtype=np.int32)} | figures
    return vtp_text(lines.points, lines.branches, told, along, facts)
