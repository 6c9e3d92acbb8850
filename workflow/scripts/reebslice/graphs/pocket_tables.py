"""Pockets and islands as tables, and what they come to together."""

import numpy as np

from ..arrays.grouping import Groups
from ..handles.at_vertices import find_handles
from ..schemas import SCHEMAS
from ..table_checks import build_table
from .pocket_measures import Pockets

# The handle operations, each with its side, between which a pocket of a kind lies, in the order of its beginning
# and its end. Seen downward, a separation of contours is what joins two bells, and their annihilation a beginning.
EVENTS_OF = {
    "basin": (("creation", "B"), ("union", "B")),
    "bell": (("annihilation", "A"), ("separation", "A")),
    "sealed": (("creation", "B"), ("annihilation", "A")),
    "island": (("creation", "A"), ("union", "A")),
}
# Columns of the tables that are fields of `Pockets` as they are.
PLAIN = ("begin", "end", "begin_height", "end_height", "volume", "section", "largest")


def pockets_table(name, pockets, handles, points, shell_of_vertex):
    """Make the table `pockets` or `islands`.

    Parameters
    ----------
    name : str
    pockets : Pockets
    handles : pyarrow.Table
        The table `handles` of the same surface.
    points : (n, 3) float64
        Its vertices, model frame.
    shell_of_vertex : (n,) int32

    Returns
    -------
    pyarrow.Table
    """
    columns = pockets._asdict() | {
        name[:-1]: np.arange(len(pockets.kind)),
        "depth": np.abs(pockets.end_height - pockets.begin_height),
        "into": [None if row < 0 else row for row in pockets.into.tolist()],
        "shells": [
            sorted(shell_of_vertex[pockets.shells.member[a:b]].tolist())
            for a, b in zip(pockets.shells.start[:-1], pockets.shells.start[1:])
        ],
    }
    for side, vertices in enumerate((pockets.begin, pockets.end)):
        columns |= dict(zip((("x", "y", "z"), ("end_x", "end_y", "end_z"))[side], points[vertices].T))
        columns[f"{('begin', 'end')[side]}_handle"] = _handles_of(pockets, handles, vertices.tolist(), side)
    for column in ("throat_height", "throat_section", "throat_radius"):
        columns[column] = [None if np.isnan(value) else value for value in columns[column].tolist()]
    return build_table(name, {field.name: columns[field.name] for field in SCHEMAS[name]})


def pockets_of_table(table):
    """Take pockets or islands from their table.

    Parameters
    ----------
    table : pyarrow.Table
        `pockets` or `islands`.

    Returns
    -------
    Pockets
        Without throats, and without shells.
    """
    count = table.num_rows
    kind = table["kind"].to_numpy() if "kind" in table.column_names else np.full(count, "island")
    columns = {name: table[name].to_numpy() for name in Pockets._fields if name in PLAIN}
    unknown = dict.fromkeys(("throat_height", "throat_section", "throat_radius"), np.full(count, np.nan))
    into = table["into"].fill_null(-1).to_numpy()
    return Pockets(**columns, **unknown, kind=kind, into=into, shells=Groups(np.zeros(count + 1, int), into[:0]))


def _handles_of(pockets, handles, vertices, side):
    """The handle at which each pocket begins (side 0) or ends (1), None where it is not resolved."""
    found = {kind: find_handles(handles, vertices, *events[side]) for kind, events in EVENTS_OF.items()}
    if side == 1:  # an island that never joins ends where a body does
        tops = find_handles(handles, vertices, "annihilation", "B")
        whole = np.isnan(pockets.throat_section)
        found["island"] = [top if alone else handle for top, alone, handle in zip(tops, whole, found["island"])]
    return [found[kind][row] for row, kind in enumerate(pockets.kind.tolist())]


def sum_pockets(pockets, islands):
    """Sum pockets and islands up: of each kind how many there are, and the volume.

    Parameters
    ----------
    pockets, islands : Pockets

    Returns
    -------
    dict
        `basins`, `bells`, `sealed` and `islands`, each a dict of `count` and `volume`. What opens into another one
        of its kind is counted, and its volume is that one's.
    """
    sums = {}
    for name, kind in (("basins", "basin"), ("bells", "bell"), ("sealed", "sealed"), ("islands", "island")):
        found = islands if kind == "island" else pockets
        chosen = found.kind == kind
        sums[name] = {"count": int(chosen.sum()), "volume": float(found.volume[chosen & (found.into < 0)].sum())}
    return sums
