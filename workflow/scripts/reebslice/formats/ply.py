"""Read PLY, ASCII and binary of either byte order: faces and triangle strips, among any elements and properties.

Reference: G. Turk, The PLY Polygon File Format, version 1.0, Stanford University 1994; and for triangle strips, which
it does not have, the files of the Stanford 3D Scanning Repository. Numbers of ASCII files are taken as they are
written, whatever type the header names.
"""

from typing import NamedTuple

import numpy as np

from ..errors import MeshFormatError, NumberFormatError
from ..mesh.faults import COUNTED_FROM_0
from .number_lines import decode, describe_word, read_numbers
from .ply_elements import Element, Property, read_ascii, read_binary
from .polygons import build_mesh

TYPES = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "double": "f8",
}
TYPES.update(int8="i1", uint8="u1", int16="i2", uint16="u2", int32="i4", uint32="u4", float32="f4", float64="f8")
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LISTS = ("vertex_indices", "vertex_index")
WANTED = {"vertex": ("x", "y", "z"), "face": LISTS, "tristrips": LISTS}


class Header(NamedTuple):
    """What a PLY header says.

    Attributes
    ----------
    order : byte order as numpy writes it, "" for ASCII.
    elements : list of Element
    body : place of the first byte behind the header.
    line : number of the first line behind the header.
    """

    order: str
    elements: list
    body: int
    line: int


def read_ply(path):
    """Read the faces and triangle strips of a PLY file; all other elements and properties are passed over.

    Parameters
    ----------
    path : Path

    Returns
    -------
    MeshFile
        Points and polygons in the order of the file, strips behind faces. Triangles of strips that name a vertex twice,
        which only join strips, are left out.

    Raises
    ------
    MeshFormatError
        The header is not as the specification says, the file is cut off or holds no faces; vertices, faces and rows
        are counted from 0.
    """
    data = path.read_bytes()
    header = parse_header(data)
    _check_elements(header)
    found = _read_elements(data, header)
    if "vertex" not in found:
        raise MeshFormatError("The PLY file has no element vertex; export the mesh again.")
    points = np.stack([values for values, _ in found["vertex"]], axis=1, dtype=np.float64)
    corners, sizes = _take_list(found, "face")
    strips, lengths = _take_list(found, "tristrips")
    if len(strips):
        triangles = cut_strips(strips, lengths)
        corners = np.concatenate([corners.astype(np.int64), triangles.ravel()])
        sizes = np.concatenate([sizes, np.full(len(triangles), 3)])
    if not len(corners):
        raise MeshFormatError(_describe_cloud(header, len(points)))
    names = COUNTED_FROM_0 if header.order else _name_lines(header)
    return build_mesh(points, corners, sizes, names)


def read_ply_property(path, name):
    """Read a property of the vertices of a PLY file.

    Parameters
    ----------
    path : Path
    name : str

    Returns
    -------
    (n,) float64
        In the order of the file.

    Raises
    ------
    MeshFormatError
        As of :func:`read_ply`; or the vertices have no such property that is one number.
    """
    data = path.read_bytes()
    header = parse_header(data)
    _check_elements(header)
    properties = next((element.properties for element in header.elements if element.name == "vertex"), ())
    if [one.name for one in properties if not one.length].count(name) != 1:
        held = ", ".join(one.name for one in properties)
        raise MeshFormatError(f"The vertices of the PLY file have no property {name} that is one number, but {held}.")
    return _read_elements(data, header, (name,))["vertex"][3][0].astype(np.float64)


# --------------------------------------------------------------------------
# The header


def parse_header(data):
    """Return the `Header` of a PLY file; its lines may end in any way, its comments hold anything."""
    first = next((k for k in range(min(len(data), 200)) if data[k] in b"\r\n"), 0)
    end = b"\r" if data[first : first + 1] == b"\r" and data[first + 1 : first + 2] != b"\n" else b"\n"
    if data[:first].strip() != b"ply":
        raise MeshFormatError(f"The file begins with '{decode(data[:60])}', not with ply; export the mesh again.")
    order, elements, at, number = None, [], first + 1 + (data[first : first + 2] == b"\r\n"), 1
    while True:
        stop = data.find(end, at)
        line = data[at : stop if stop >= 0 else len(data)].decode("latin-1").strip()
        number, at = number + 1, stop + 1
        words = line.split()
        if words == ["end_header"]:
            break
        if stop < 0:
            raise MeshFormatError(
                "The PLY file ends within its header: a line end_header is missing; it is cut off,"
                " export the mesh again."
            )
        if words and words[0] == "format":
            order = _parse_format(words, line)
        elif words and words[0] not in ("comment", "obj_info"):
            _parse_line(words, number, elements)
    if order is None:
        raise MeshFormatError("The header of the PLY file has no line format; export the mesh again.")
    return Header(order, elements, at if stop >= 0 else len(data), number + 1)


def _parse_format(words, line):
    if len(words) != 3 or words[1] not in ORDERS or words[2] != "1.0":
        raise MeshFormatError(
            f"The PLY file says '{line}', which is none of {', '.join(ORDERS)} 1.0; export it as one."
        )
    return ORDERS[words[1]]


def _parse_line(words, number, elements):
    """Add an element, or a property of the last one, to `elements`."""
    try:
        match words:
            case ["element", name, count]:
                elements.append(Element(name, int(count), []))
                sound = elements[-1].count >= 0
            case ["property", "list", length, kind, name]:
                elements[-1].properties.append(Property(name, TYPES[kind], TYPES[length]))
                sound = TYPES[length][0] != "f"
            case ["property", kind, name]:
                elements[-1].properties.append(Property(name, TYPES[kind], None))
                sound = True
            case _:
                sound = False
    except (KeyError, ValueError, IndexError):
        sound = False
    if not sound:
        raise MeshFormatError(
            f"Line {number} of the PLY header is '{decode(' '.join(words).encode())}', which is no element or property"
            f" of the types {', '.join(TYPES)}; export the mesh again."
        )


def _check_elements(header):
    """Refuse vertices without coordinates, faces without vertices, and elements told twice."""
    names = [element.name for element in header.elements]
    for name in WANTED:
        if names.count(name) > 1:
            raise MeshFormatError(f"The PLY header declares element {name} twice; export the mesh again.")
    for element in header.elements:
        if element.name == "vertex":
            lacking = [
                axis for axis in "xyz" if [one.name for one in element.properties if not one.length].count(axis) != 1
            ]
            if lacking:
                raise MeshFormatError(
                    f"The vertices of the PLY file have no property {lacking[0]}; export the mesh again."
                )
        elif element.name in WANTED and element.count and _find_list(element) is None:
            held = ", ".join(one.name for one in element.properties) or "no properties"
            raise MeshFormatError(
                f"Element {element.name} of the PLY file has no list {' or '.join(LISTS)}, but {held}; export the mesh"
                " again."
            )


def _find_list(element):
    return next((one.name for one in element.properties if one.length and one.name in LISTS), None)


# --------------------------------------------------------------------------
# The body


def _read_elements(data, header, also=()):
    """Return what is wanted of the elements: {name: [(values, lengths), ...]}; also : more properties of vertices."""
    if header.order:
        body, read, at = data, read_binary, header.body
    else:
        text = data[header.body :].replace(b"\r", b"\n")
        try:
            body, read, at = read_numbers(text)[0], read_ascii, 0
        except NumberFormatError:
            told = describe_word(data[header.body :].replace(b"\r\n", b"\n").replace(b"\r", b"\n"), header.line)
            raise MeshFormatError(f"{told}; mend that line or export the mesh again.") from None
    found = {}
    last = max((k for k, one in enumerate(header.elements) if one.name in WANTED and one.count), default=-1)
    for element in header.elements[: last + 1]:
        names = (
            (*"xyz", *also) if element.name == "vertex" else (_find_list(element),) if element.name in WANTED else ()
        )
        found[element.name], at = read(body, at, element, names if element.count else (), header.order)
    found.setdefault("vertex", [(np.zeros(0), None)] * 3)
    return found


def _take_list(found, name):
    """Return the ids and lengths of an element's lists."""
    if not found.get(name):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    values, lengths = found[name][0]
    if values.dtype.kind == "f":
        ids = values.astype(np.int64)
        if (ids != values).any():
            row = np.searchsorted(np.cumsum(lengths), np.flatnonzero(ids != values)[0], "right")
            raise MeshFormatError(
                f"Row {row} of element {name} names a vertex by something that is not a whole number; export again."
            )
        values = ids
    return values, lengths


def cut_strips(ids, lengths):
    """Cut lists of ids, in which -1 ends a strip, into triangles of one winding.

    >>> cut_strips(np.array([0, 1, 2, 3, -1, 9]), np.array([6])).tolist()
    [[0, 1, 2], [2, 1, 3]]
    """
    ids = np.insert(ids.astype(np.int64), np.cumsum(lengths), -1)
    breaks = np.flatnonzero(ids == -1)
    begin = np.concatenate([[0], breaks + 1])[np.searchsorted(breaks, np.arange(len(ids)))]
    odd = (np.arange(len(ids)) - begin) % 2 == 1
    triangles = np.column_stack([ids[:-2], ids[1:-1], ids[2:]])
    triangles[odd[:-2]] = triangles[odd[:-2]][:, [1, 0, 2]]
    a, b, c = triangles.T
    return triangles[(triangles != -1).all(axis=1) & (a != b) & (b != c) & (c != a)]


# --------------------------------------------------------------------------
# What is told


def _describe_cloud(header, n_points):
    others = ", ".join(f"{one.count} {one.name}" for one in header.elements if one.name != "vertex" and one.count)
    if not n_points:
        return "The PLY file holds no vertices and no faces; export the mesh again."
    return (
        f"The PLY file holds {n_points} points and no faces{f' (beside {others})' if others else ''}: it is a point"
        " cloud; reconstruct a surface from it first."
    )


def _name_lines(header):
    """Name vertices and faces with their lines, if every row has one, as the specification asks."""
    lines, first = {}, header.line
    for element in header.elements:
        lines[element.name] = range(first, first + element.count)
        first += element.count

    def name(noun, number):
        rows = lines.get(noun, ())
        return f"{noun} {number}" + (f" (line {rows[number]})" if number < len(rows) else "")

    return COUNTED_FROM_0._replace(vertex=lambda v: name("vertex", v), face=lambda f: name("face", f))
