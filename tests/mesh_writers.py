"""Write meshes of polygons in every text and binary form that a test needs, with nothing of the library."""

import struct

import numpy as np

ORDERS = {"ply": "", "little.ply": "<", "big.ply": ">"}
FORMATS = ("obj", "off", *ORDERS, "stl", "ascii.stl")  # what `write_mesh` writes, by the end of the file's name


def write_mesh(path, points, polygons):
    """Write a mesh in the form that the end of the file's name says, one of `FORMATS`.

    points : (n, 3); polygons : list of lists of ids, triangles only in STL.
    """
    end = path.name.partition(".")[2]
    if end in ORDERS:
        path.write_bytes(ply_bytes(points, polygons, ORDERS[end]))
    elif end == "stl":
        path.write_bytes(stl_bytes(points, polygons))
    else:
        text = {"obj": obj_text, "off": off_text, "ascii.stl": stl_text}[end](points, polygons)
        path.write_text(text)
    return path


def obj_text(points, polygons):
    """Return OBJ."""
    return "".join([_rows(points, "v "), *("f " + " ".join(str(v + 1) for v in one) + "\n" for one in polygons)])


def off_text(points, polygons):
    """Return ASCII OFF."""
    return f"OFF\n{len(points)} {len(polygons)} 0\n" + _rows(points) + _lists(polygons)


def ply_bytes(points, polygons, order="", kind="double"):
    """Return PLY: ASCII, or binary in the byte order "<" or ">"."""
    name = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = f"ply\nformat {name} 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property {kind} {axis}\n" for axis in "xyz")
    head += f"element face {len(polygons)}\nproperty list int int vertex_indices\nend_header\n"
    if not order:
        return (head + _rows(points) + _lists(polygons)).encode()
    faces = b"".join(struct.pack(f"{order}{len(one) + 1}i", len(one), *one) for one in polygons)
    return head.encode() + np.asarray(points, order + ("f8" if kind == "double" else "f4")).tobytes() + faces


def stl_text(points, triangles):
    """Return ASCII STL."""
    facets = []
    for one in triangles:
        rows = _rows([points[v] for v in one], "vertex ")
        facets.append(f"facet normal 0 0 0\nouter loop\n{rows}endloop\nendfacet\n")
    return "solid test\n" + "".join(facets) + "endsolid test\n"


def stl_bytes(points, triangles):
    """Return binary STL."""
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel([points[v] for v in one]), 0) for one in triangles)
    return b"binary".ljust(80) + struct.pack("<I", len(triangles)) + body


def _rows(points, before=""):
    return "".join("{}{!r} {!r} {!r}\n".format(before, *map(float, point)) for point in points)


def _lists(polygons):
    return "".join(" ".join(map(str, [len(one), *one])) + "\n" for one in polygons)
