"""Read mesh files: points and triangles, or a sentence that says what is wrong.

Ordinary files go through trimesh. STL, OFF and triangle strips in PLY are read
here, because valid files of those kinds defeat the common readers: binary STL
that begins with "solid" or has a trailing byte, ASCII STL with comments or with
carriage returns only, OFF with polygons.
"""

import re
from pathlib import Path

import numpy as np

from reebslice.faults import find_fault

SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".step", ".stp")


class UnreadableMesh(ValueError):
    """The file holds no usable mesh; the message says why, and the cure."""


def read_mesh(path):
    """Return the points (n, 3) float64 and the triangles (m, 3) int64 of a file.

    Points are as the file has them: neither merged nor scaled. The parts of a
    scene are put in place and joined; polygons are cut into triangles. There is
    at least one face, all ids exist, all coordinates in use are finite.

    Raises
    ------
    UnreadableMesh
        The ending is none of `SUFFIXES` (in any case), or the file is empty,
        damaged, or holds no faces.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise UnreadableMesh(
            f"Files ending in {path.suffix or 'nothing'} are not supported; convert the mesh to"
            f" one of {', '.join(SUFFIXES)}."
        )
    if path.stat().st_size == 0:
        raise UnreadableMesh("The file is empty (0 bytes); export the mesh again.")
    try:
        points, faces = reader(path)
    except UnreadableMesh:
        raise
    except Exception as error:  # a reader may stumble over damage in any way it likes
        told = f"{type(error).__name__}: {error}".splitlines()[0]
        raise UnreadableMesh(
            f"The file is damaged or not really {path.suffix.lower()} ({told}); export the mesh again."
        ) from error
    points = np.asarray(points, np.float64).reshape(-1, 3)
    faces = np.asarray(faces, np.int64).reshape(-1, 3)
    if fault := find_fault(points, faces):
        raise UnreadableMesh(fault)
    return points, faces


# --------------------------------------------------------------------------
# STL


def read_stl(path):
    """Read binary or ASCII STL; the file's size tells which, not its first word."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    needed = 84 + 50 * count
    head = data[:2048].lstrip().lower()
    textual = b"facet" in head and b"\0" not in head
    if len(data) != needed and textual:
        return parse_ascii_stl(data)
    if count < 0 or (count == 0 and len(data) == 84):
        raise UnreadableMesh("The STL file holds no faces, only a header; export the mesh again.")
    if len(data) < needed or count == 0:
        raise UnreadableMesh(
            f"The binary STL file declares {count} faces, which take {needed} bytes, but has"
            f" {len(data)} bytes; it is damaged, export the mesh again."
        )
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data, record, count, 84)["corners"].reshape(-1, 3)
    return corners, np.arange(3 * count)


def parse_ascii_stl(data):
    """Return the corners of ASCII STL, as bytes, whatever its line ends and comments."""
    text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = re.sub(rb"(#|;|//).*", b"", text)
    rows = re.findall(rb"^[ \t]*vertex\b(.*)$", text, re.MULTILINE | re.IGNORECASE)
    facets = len(re.findall(rb"^[ \t]*facet\b", text, re.MULTILINE | re.IGNORECASE))
    if len(rows) != 3 * facets:
        raise UnreadableMesh(
            f"The ASCII STL file has {facets} facets but {len(rows)} vertices instead of"
            f" {3 * facets}; it is damaged or cut off, export the mesh again."
        )
    try:
        values = np.array(b" ".join(rows).split(), dtype="S").astype(np.float64)
        complete = len(values) == 3 * len(rows)
    except ValueError:
        complete = False
    if not complete:
        at = next(i for i, row in enumerate(rows) if not _is_point(row))
        shown = rows[at].decode("latin-1").strip()[:60]
        raise UnreadableMesh(
            f"The ASCII STL file has a vertex that is not three numbers: '{shown}' (vertex"
            f" {at % 3} of facet {at // 3}); mend that line or export the mesh again."
        )
    return values, np.arange(len(rows))


def _is_point(row):
    try:
        return len([float(word) for word in row.split()]) == 3
    except ValueError:
        return False


# --------------------------------------------------------------------------
# OFF


def read_off(path):
    """Read ASCII OFF with its variants of vertex (C, N, ST) and polygons of any size."""
    text = path.read_bytes().decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")
    lines = (line.split("#", 1)[0].strip() for line in text.split("\n"))
    lines = [line for line in lines if line]
    header = re.match(r"(ST)?C?N?(4)?(n)?OFF\b(.*)", lines[0])
    if not header or header[2] or header[3] or "BINARY" in lines[0]:
        raise UnreadableMesh(
            f"The file begins with '{lines[0][:30]}', not with OFF, COFF, NOFF or STOFF as a"
            " three-dimensional ASCII OFF file does; export the mesh again."
        )
    lines[0] = header[4].strip()
    lines = lines if lines[0] else lines[1:]
    n_points, n_faces = (int(word) for word in lines[0].split()[:2])
    if len(lines) < 1 + n_points + n_faces:
        raise UnreadableMesh(
            f"The OFF file declares {n_points} vertices and {n_faces} faces but ends after"
            f" {len(lines) - 1} lines; it is cut off, export the mesh again."
        )
    points = [line.split()[:3] for line in lines[1 : 1 + n_points]]
    polygons = [line.split() for line in lines[1 + n_points : 1 + n_points + n_faces]]
    sizes = np.array([int(words[0]) for words in polygons])
    corners = [int(word) for words, n in zip(polygons, sizes) for word in words[1 : 1 + n]]
    return np.array(points, dtype=np.float64), fan_polygons(np.array(corners), sizes)


def fan_polygons(corners, sizes):
    """Cut polygons into triangles that share the first corner.

    corners : ids, polygon after polygon; sizes : corners of each polygon.
    Polygons of fewer than three corners give none.

    >>> fan_polygons(np.array([4, 5, 6, 7]), np.array([4])).tolist()
    [[4, 5, 6], [4, 6, 7]]
    """
    sizes = np.asarray(sizes, np.int64)
    if sizes.sum() != len(corners):
        raise UnreadableMesh("A face names fewer vertices than it declares; export the mesh again.")
    start = np.cumsum(sizes) - sizes
    triangles = np.maximum(sizes - 2, 0)
    polygon = np.repeat(np.arange(len(sizes)), triangles)
    step = np.arange(len(polygon)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    first = start[polygon]
    return np.asarray(corners)[np.column_stack([first, first + step + 1, first + step + 2])]


# --------------------------------------------------------------------------
# PLY


def read_ply(path):
    """Read PLY through trimesh, or, if its faces are triangle strips, here."""
    with open(path, "rb") as file:
        head = file.read(1 << 16).split(b"end_header", 1)[0]
    if re.search(rb"element\s+face\s+[1-9]", head) or b"tristrips" not in head:
        return read_scene(path)
    return read_strips(path)


def read_strips(path):
    """Read PLY of scalar vertex properties followed by one list of triangle strips."""
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header")
    body = body[2:] if body.startswith(b"\r\n") else body[1:]
    text = head.decode("latin-1")
    layout = re.search(
        r"element vertex (\d+)\s+((?:property \w+ \w+\s+)+)element tristrips (\d+)\s+"
        r"property list (\w+) (\w+) \w+\s*(?:element edge 0\b|$)",
        re.sub(r"(comment|obj_info)[^\n]*\n", "", text.replace("\r", "")),
    )
    if not layout:
        raise UnreadableMesh(
            "The PLY file stores triangle strips among other elements, which is not supported;"
            " export the mesh with ordinary faces."
        )
    n_points, n_strips = int(layout[1]), int(layout[3])
    properties = re.findall(r"property (\w+) (\w+)", layout[2])
    columns = [name for _, name in properties].index("x") + np.arange(3)
    if "format ascii" in text:
        words = np.array(body.split(), dtype=np.float64)
        points = words[: n_points * len(properties)].reshape(n_points, -1)[:, columns]
        return points, cut_strips(words[n_points * len(properties) :].astype(np.int64), n_strips)
    order = ">" if "big_endian" in text else "<"
    vertex = np.dtype([(name, order + _PLY_TYPES[kind]) for kind, name in properties])
    table = np.frombuffer(body, vertex, n_points)
    if _PLY_TYPES[layout[4]][1:] != "4" or _PLY_TYPES[layout[5]][1:] != "4":
        raise UnreadableMesh("Triangle strips of this width are not supported; export ordinary faces.")
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


# --------------------------------------------------------------------------
# Everything else


def read_step(path):
    """Read the solids of a STEP file, in millimetres, as triangles.

    Curved faces are approximated to `STEP_TOLERANCES`, relative to the length
    of their edges, so that the size and the unit of the model do not matter.
    """
    points, faces = read_scene(path, **STEP_TOLERANCES)
    return 1000 * points, faces  # the reader gives metres


STEP_TOLERANCES = dict(tol_linear=0.001, tol_angular=0.25, tol_relative=True)


def read_scene(path, **options):
    """Read a file through trimesh, each part moved to its place in the scene."""
    import trimesh

    scene = trimesh.load_scene(path, process=False, **options)
    points, faces, count = [], [], 0
    for node in sorted(scene.graph.nodes_geometry):
        transform, name = scene.graph[node]
        part = scene.geometry[name]
        if not isinstance(part, trimesh.Trimesh) or not len(part.faces):
            continue
        corners = np.asarray(part.vertices, np.float64)
        if not np.array_equal(transform, np.eye(4)):
            with np.errstate(invalid="ignore"):  # infinite coordinates are told later
                corners = corners @ transform[:3, :3].T + transform[:3, 3]
        mirrored = np.linalg.det(transform[:3, :3]) < 0
        triangles = np.asarray(part.faces, np.int64)
        faces.append((triangles[:, ::-1] if mirrored else triangles) + count)
        points.append(corners)
        count += len(corners)
    if not faces:
        raise UnreadableMesh("The file holds no faces: it is empty or cut off; export the mesh again.")
    return np.concatenate(points), np.concatenate(faces)


READERS = dict.fromkeys(SUFFIXES, read_scene)
READERS |= {".stl": read_stl, ".off": read_off, ".ply": read_ply, ".step": read_step, ".stp": read_step}
