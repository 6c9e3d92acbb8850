"""PLY files of triangles, with numbers and colours at vertices and faces."""

import numpy as np

# numpy's kinds of columns by the names that PLY has for them
TYPES = {"u1": "uchar", "i4": "int", "f4": "float", "f8": "double"}


def ply_bytes(points, triangles, of_points, of_triangles, comments=()):
    """Write a triangle mesh as a binary PLY file.

    Parameters
    ----------
    points : (n, 3) float64
    triangles : (m, 3) int
    of_points, of_triangles : dict of str to (n,) or (m,) uint8, int32, float32 or float64
        Further properties, in order. Programs take `red`, `green`, `blue` as a colour.
    comments : sequence of str
        Lines of the header.

    Returns
    -------
    bytes
        The whole file, coordinates in double precision; the same for the same input.
    """
    triangles = np.asarray(triangles)
    corners = np.empty(len(triangles), [("size", "u1"), ("corners", "<i4", 3)])
    corners["size"], corners["corners"] = 3, triangles
    vertex = {name: np.asarray(points, float)[:, k] for k, name in enumerate("xyz")} | of_points
    elements = [("vertex", len(points), vertex, None), ("face", len(triangles), of_triangles, corners)]
    lines = ["ply", "format binary_little_endian 1.0", *(f"comment {line}" for line in comments)]
    rows = []
    for name, count, columns, first in elements:
        kinds = [(column, values.dtype.newbyteorder("<")) for column, values in columns.items()]
        lines.append(f"element {name} {count}")
        lines += ["property list uchar int vertex_indices"] if first is not None else []
        lines += [f"property {TYPES[kind.str[1:]]} {column}" for column, kind in kinds]
        table = np.empty(count, ([("", first.dtype)] if first is not None else []) + kinds)
        for column, values in columns.items():
            table[column] = values
        if first is not None:
            table["f0"] = first
        rows.append(table.tobytes())
    return "\n".join([*lines, "end_header", ""]).encode("ascii") + b"".join(rows)
