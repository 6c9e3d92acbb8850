"""Read what `inspect_mesh` and `select_tilt` left of a model."""

import numpy as np

from .storage import read_json, read_table


def read_points(folder):
    """The surface vertices of the model in `folder`, (n, 3) model frame."""
    return _stack(read_table(folder / "vertices.parquet", "vertices"), np.float64)


def read_faces(folder):
    """The faces of the model in `folder`, (m, 3) int32 vertex ids."""
    return _stack(read_table(folder / "faces.parquet", "faces", without=("shell",)), np.int32)


def _stack(table, kind):
    """The columns of a table side by side, each copied once."""
    rows = np.empty((len(table), table.num_columns), kind)
    for place, column in enumerate(table.itercolumns()):
        rows[:, place] = column.to_numpy()
    return rows


def read_rotation(folder):
    """The rotation of the model in `folder` to the tilted frame, (3, 3)."""
    return np.array(read_json(folder / "tilt.json")["rotation"])


def read_shells(folder, count):
    """Shell and body of each of the `count` vertices of the model in `folder`, two (count,) int32 arrays."""
    body_of_shell = read_table(folder / "shells.parquet", "shells")["body"].to_numpy()
    shell = np.zeros(count, np.int32)
    if len(body_of_shell) > 1:
        faces = read_table(folder / "faces.parquet", "faces")
        for corner in "abc":
            shell[faces[corner].to_numpy()] = faces["shell"].to_numpy()
    return shell, body_of_shell[shell]


def read_arc_tables(folder):
    """What tells of the model in `folder` where its arcs are: the tables levels, contours, handles, arcs."""
    apart = {"contours": ("geometry",)}
    return [
        read_table(folder / f"{name}.parquet", name, apart.get(name, ()))
        for name in ("levels", "contours", "handles", "arcs")
    ]
