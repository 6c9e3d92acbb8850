"""Loops as a table, as figures, and as curves for other programs."""

from collections import Counter

import numpy as np

from ..arrays.grouping import Groups
from ..formats.vtp import vtp_text
from ..handles.at_vertices import find_handles
from ..table_checks import build_table
from .loop_kinds import KINDS
from .loops import Loops


def loops_table(loops, handles):
    """Make the table `loops`.

    Parameters
    ----------
    loops : Loops
        Centres and circles in the model frame.
    handles : pyarrow.Table
        The table `handles` of the same surface.

    Returns
    -------
    pyarrow.Table
    """
    fields = loops._asdict()
    circles, paths = fields.pop("circles"), fields.pop("paths")
    x, y, z = fields.pop("centre").T
    return build_table(
        "loops",
        fields
        | {
            "loop": np.arange(len(loops.kind)),
            "bottom_handle": find_handles(handles, loops.bottom.tolist(), "separation"),
            "top_handle": find_handles(handles, loops.top.tolist(), "union"),
            "x": x,
            "y": y,
            "z": z,
            "circle": [circle.ravel() for circle in circles],
            "path": [paths.member[a:b] for a, b in zip(paths.start[:-1], paths.start[1:])],
        },
    )


def loops_of_table(table):
    """Take loops from their table.

    Parameters
    ----------
    table : pyarrow.Table
        `loops`.

    Returns
    -------
    Loops
        Centres and circles in the model frame.
    """
    fields = {name: table[name].to_numpy() for name in Loops._fields if name in table.column_names}
    start = np.concatenate([[0], np.cumsum([len(path) for path in table["path"].to_pylist()])]).astype(np.int64)
    return Loops(
        **fields,
        centre=np.column_stack([table[axis].to_numpy() for axis in "xyz"]),
        circles=[np.reshape(circle, (-1, 3)) for circle in table["circle"].to_pylist()],
        paths=Groups(start, table["path"].combine_chunks().flatten().to_numpy()),
    )


def count_loops(loops):
    """Count loops by kind: a dict that holds the dict `loops`."""
    found = Counter(loops.kind.tolist())
    return {"loops": {kind: found[kind] for kind in KINDS}}


def loops_text(points, loops):
    """Write the circle around and the path along every loop as lines for ParaView.

    Parameters
    ----------
    points : (n, 3) float64
        Vertices of the surface, model frame.
    loops : Loops
        Centres and circles in the same frame.

    Returns
    -------
    str
        A file of poly data. Lines carry `loop`, `kind` (place in :data:`.loop_kinds.KINDS`), `path` (0: circle
        around, 1: closed path) and `inscribed_radius`.
    """
    count = len(loops.kind)
    circles = loops.circles
    along = [points[loops.paths.member[a:b]] for a, b in zip(loops.paths.start[:-1], loops.paths.start[1:])]
    curves = [np.concatenate([curve, curve[:1]]) for curve in (*circles, *along)]  # closed by their first point
    start = np.concatenate([[0], np.cumsum([len(curve) for curve in curves])]).astype(np.int64)
    return vtp_text(
        np.concatenate(curves) if curves else np.empty((0, 3)),
        Groups(start, np.arange(start[-1])),
        {
            "loop": np.tile(np.arange(count, dtype=np.int32), 2),
            "kind": np.tile([KINDS.index(kind) for kind in loops.kind.tolist()], 2).astype(np.int32),
            "path": np.repeat(np.array([0, 1], np.int32), count),
            "inscribed_radius": np.tile(loops.inscribed_radius, 2),
        },
    )
