"""Points and triangles of the text or the bytes of files that hold polygons: OFF, PLY, OBJ."""

import re

import numpy as np

from ..errors import MeshFormatError, NumberFormatError
from .number_lines import read_numbers, split_obj


def take_polygons(numbers, widths, n_points, n_faces):
    """Points and triangles of lines of numbers: `n_points` positions, then `n_faces` polygons, sizes first."""
    begin = np.cumsum(widths) - widths
    if (widths[:n_points] < 3).any():
        raise MeshFormatError("A vertex has fewer than three coordinates; export the mesh again.")
    points = numbers[begin[:n_points, None] + np.arange(3)]
    widths, begin = widths[n_points : n_points + n_faces], begin[n_points : n_points + n_faces]
    sizes = numbers[begin].astype(np.int64)
    if (sizes >= widths).any():
        raise MeshFormatError("A face names fewer vertices than it declares; export the mesh again.")
    sizes = np.maximum(sizes, 0)
    corner = np.repeat(begin + 1 - np.cumsum(sizes) + sizes, sizes) + np.arange(sizes.sum())
    ids = numbers[corner].astype(np.int64)
    if (ids != numbers[corner]).any():
        raise MeshFormatError("A face names a vertex by something that is not a whole number; export the mesh again.")
    return points, fan_polygons(ids, sizes)


def fan_polygons(corners, sizes):
    """Cut polygons into triangles that share the first corner.

    corners : ids, polygon after polygon; sizes : corners of each polygon.
    Polygons of fewer than three corners give none.

    >>> fan_polygons(np.array([4, 5, 6, 7]), np.array([4])).tolist()
    [[4, 5, 6], [4, 6, 7]]
    """
    sizes = np.asarray(sizes, np.int64)
    if sizes.sum() != len(corners):
        raise MeshFormatError("A face names fewer vertices than it declares; export the mesh again.")
    start = np.cumsum(sizes) - sizes
    triangles = np.maximum(sizes - 2, 0)
    polygon = np.repeat(np.arange(len(sizes)), triangles)
    step = np.arange(len(polygon)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = start[polygon]
    return np.asarray(corners)[np.column_stack([first, first + step + 1, first + step + 2])]


def read_triangles(head, body):
    """Read PLY of scalar vertex properties followed by faces that are all triangles; None if it is not."""
    layout = re.search(_PLY_LAYOUT.format("face", "vertex_(?:index|indices)") + _PLY_REST, head)
    if not layout or "element" in head[: layout.start()]:
        return None
    n_points, n_faces = int(layout[1]), int(layout[3])
    properties, more = (re.findall(r"property (\w+) (\w+)", layout[k]) for k in (2, 6))
    names = [name for _, name in properties]
    kinds = {layout[4], layout[5], *(kind for kind, _ in properties + more)}
    if not {"x", "y", "z"} <= set(names) or len(set(names)) < len(names) or not kinds <= set(_PLY_TYPES):
        return None
    if "format ascii" in head:
        try:
            numbers, widths = read_numbers(body, n_points + n_faces)
        except NumberFormatError:
            return None
        if len(widths) < n_points + n_faces or (widths[:n_points] != len(names)).any():
            return None
        table = numbers[: n_points * len(names)].reshape(-1, len(names)).T
        kinds = [_PLY_TYPES[kind] for kind, _ in properties]  # a float is one, however many digits it is told in
        points = np.column_stack([table[k].astype(kinds[k]) for k in (names.index(axis) for axis in "xyz")])
        return points, take_polygons(numbers[n_points * len(names) :], widths[n_points:], 0, n_faces)[1]
    order = ">" if "big_endian" in head else "<"
    vertex = np.dtype([(name, order + _PLY_TYPES[kind]) for kind, name in properties])
    face = [("size", order + _PLY_TYPES[layout[4]]), ("corners", order + _PLY_TYPES[layout[5]], 3)]
    face = np.dtype(face + [(f"_{name}", order + _PLY_TYPES[kind]) for kind, name in more])
    if len(body) < n_points * vertex.itemsize + n_faces * face.itemsize:
        return None
    faces = np.frombuffer(body, face, n_faces, n_points * vertex.itemsize)
    if (faces["size"] != 3).any():
        return None
    table = np.frombuffer(body, vertex, n_points)
    return np.column_stack([table[name] for name in "xyz"]), faces["corners"]


_PLY_LAYOUT = r"element vertex (\d+)\s+((?:property \w+ \w+\s+)+)element {} (\d+)\s+property list (\w+) (\w+) {}\s*"
_PLY_REST = r"((?:property \w+ \w+\s+)*)(?:element|$)"


def read_strips(head, body):
    """Read PLY of scalar vertex properties followed by one list of triangle strips."""
    layout = re.search(_PLY_LAYOUT.format("tristrips", r"\w+") + r"(?:element edge 0\b|$)", head)
    if not layout:
        raise MeshFormatError(
            "The PLY file stores triangle strips among other elements, which is not supported;"
            " export the mesh with ordinary faces."
        )
    n_points, n_strips = int(layout[1]), int(layout[3])
    properties = re.findall(r"property (\w+) (\w+)", layout[2])
    columns = [name for _, name in properties].index("x") + np.arange(3)
    if "format ascii" in head:
        words = np.array(body.split(), dtype=np.float64)
        points = words[: n_points * len(properties)].reshape(n_points, -1)[:, columns]
        return points, cut_strips(words[n_points * len(properties) :].astype(np.int64), n_strips)
    order = ">" if "big_endian" in head else "<"
    vertex = np.dtype([(name, order + _PLY_TYPES[kind]) for kind, name in properties])
    table = np.frombuffer(body, vertex, n_points)
    if _PLY_TYPES[layout[4]][1:] != "4" or _PLY_TYPES[layout[5]][1:] != "4":
        raise MeshFormatError("Triangle strips of this width are not supported; export ordinary faces.")
    strips = np.frombuffer(body[n_points * vertex.itemsize :], order + "i4").astype(np.int64)
    return np.column_stack([table[name] for name in "xyz"]), cut_strips(strips, n_strips)


_PLY_TYPES = dict(char="i1", uchar="u1", short="i2", ushort="u2", int="i4", uint="u4")
_PLY_TYPES.update(float="f4", double="f8", float32="f4", float64="f8")
_PLY_TYPES.update(int8="i1", uint8="u1", int16="i2", uint16="u2", int32="i4", uint32="u4")


def cut_strips(words, n_strips):
    """Cut `n_strips` lists (length, ids; -1 ends a strip) into triangles of one winding.

    >>> cut_strips(np.array([6, 0, 1, 2, 3, -1, 9]), 1).tolist()
    [[0, 1, 2], [2, 1, 3]]
    """
    at, lists = 0, []
    for _ in range(n_strips):
        length = words[at]
        lists += [words[at + 1 : at + 1 + length], [-1]]
        at += 1 + length
    ids = np.concatenate(lists)
    breaks = np.flatnonzero(ids == -1)
    begin = np.concatenate([[0], breaks + 1])[np.searchsorted(breaks, np.arange(len(ids)))]
    odd = (np.arange(len(ids)) - begin) % 2 == 1
    triangles = np.column_stack([ids[:-2], ids[1:-1], ids[2:]])
    triangles[odd[:-2]] = triangles[odd[:-2]][:, [1, 0, 2]]
    return triangles[(triangles >= 0).all(axis=1)]


def parse_obj(data):
    """Return points and triangles of OBJ, as bytes; None unless it is plain and sound."""
    try:
        vertices, faces = split_obj(data)
        (numbers, widths), (ids, sizes) = read_numbers(vertices), read_numbers(faces)
    except NumberFormatError:
        return None
    if len(widths) != vertices.count(b"\n") or len(sizes) != faces.count(b"\n"):
        return None
    if widths.min(initial=3) < 3 or sizes.min(initial=3) < 3 or not len(sizes) or not np.isfinite(numbers).all():
        return None
    if ids.min() < 1 or ids.max() > len(widths) or (ids != np.floor(ids)).any():
        return None
    points = numbers[(np.cumsum(widths) - widths)[:, None] + np.arange(3)]
    return points, fan_polygons(ids.astype(np.int64) - 1, sizes)
