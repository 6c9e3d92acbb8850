"""Read mesh files: points and triangles, or a sentence that says what is wrong.

STL, OFF and triangle strips in PLY are read here, because valid files of those
kinds defeat the common readers: binary STL that begins with "solid" or has a
trailing byte, ASCII STL with comments or with carriage returns only, OFF with
polygons. Plain OBJ and PLY are read here because that is faster than to import
trimesh. Everything else goes through trimesh.
"""

import re
from pathlib import Path

import numpy as np

from ..errors import MeshFormatError, NumberFormatError
from ..mesh.faults import find_fault
from .number_lines import read_numbers
from .polygons import parse_obj, read_strips, read_triangles, take_polygons

SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf", ".step", ".stp")


def read_mesh(path):
    """Return the points (n, 3) float64 and the triangles (m, 3) int32 of a file.

    Points are as the file has them: neither merged nor scaled. The parts of a
    scene are put in place and joined; polygons are cut into triangles. There is
    at least one face, all ids exist, all coordinates in use are finite.

    Raises
    ------
    MeshFormatError
        The ending is none of `SUFFIXES` (in any case), or the file is empty,
        damaged, or holds no faces.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshFormatError(
            f"Files ending in {path.suffix or 'nothing'} are not supported; convert the mesh to"
            f" one of {', '.join(SUFFIXES)}."
        )
    if path.stat().st_size == 0:
        raise MeshFormatError("The file is empty (0 bytes); export the mesh again.")
    try:
        points, faces = reader(path)
    except MeshFormatError:
        raise
    except Exception as error:  # a reader may stumble over damage in any way it likes
        told = f"{type(error).__name__}: {error}".splitlines()[0]
        raise MeshFormatError(
            f"The file is damaged or not really {path.suffix.lower()} ({told}); export the mesh again."
        ) from error
    points = np.asarray(points, np.float64).reshape(-1, 3)
    faces = np.asarray(faces).reshape(-1, 3)
    if fault := find_fault(points, faces):
        raise MeshFormatError(fault)
    return points, faces.astype(np.int32, copy=False)


# --------------------------------------------------------------------------
# STL


def read_stl(path):
    """Read binary or ASCII STL; the file's size tells which, not its first word."""
    size = path.stat().st_size
    with open(path, "rb") as file:
        data = file.read(2048)
    count = int.from_bytes(data[80:84], "little") if size >= 84 else -1
    needed = 84 + 50 * count
    head = data.lstrip().lower()
    textual = b"facet" in head and b"\0" not in head
    if size != needed and textual:
        return parse_ascii_stl(path.read_bytes())
    if count < 0 or (count == 0 and size == 84):
        raise MeshFormatError("The STL file holds no faces, only a header; export the mesh again.")
    if size < needed or count == 0:
        raise MeshFormatError(
            f"The binary STL file declares {count} faces, which take {needed} bytes, but has"
            f" {size} bytes; it is damaged, export the mesh again."
        )
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.memmap(path, record, "r", 84, (count,))["corners"]  # the bytes themselves are never held
    return np.asarray(corners).astype(np.float64), np.arange(3 * count, dtype=np.int32)


def parse_ascii_stl(data):
    """Return the corners of ASCII STL, as bytes, whatever its line ends and comments."""
    text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = re.sub(rb"(#|;|//).*", b"", text)
    rows = re.findall(rb"^[ \t]*vertex\b(.*)$", text, re.MULTILINE | re.IGNORECASE)
    facets = len(re.findall(rb"^[ \t]*facet\b", text, re.MULTILINE | re.IGNORECASE))
    if len(rows) != 3 * facets:
        raise MeshFormatError(
            f"The ASCII STL file has {facets} facets but {len(rows)} vertices instead of"
            f" {3 * facets}; it is damaged or cut off, export the mesh again."
        )
    try:
        values, widths = read_numbers(b"\n".join(rows))
        complete = len(widths) == len(rows) and bool((widths == 3).all())
    except NumberFormatError:
        complete = False
    if not complete:
        at = next((i for i, row in enumerate(rows) if not _is_point(row)), 0)
        shown = rows[at].decode("latin-1").strip()[:60]
        raise MeshFormatError(
            f"The ASCII STL file has a vertex that is not three numbers: '{shown}' (vertex"
            f" {at % 3} of facet {at // 3}); mend that line or export the mesh again."
        )
    return values, np.arange(len(rows), dtype=np.int32)


def _is_point(row):
    try:
        return len([float(word) for word in row.split()]) == 3
    except ValueError:
        return False


# --------------------------------------------------------------------------
# OFF


def read_off(path):
    """Read ASCII OFF with its variants of vertex (C, N, ST) and polygons of any size."""
    text = path.read_bytes().replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    text = re.sub(rb"#.*", b"", text).lstrip()
    first, _, rest = text.partition(b"\n")
    header = re.match(r"(ST)?C?N?(4)?(n)?OFF\b(.*)", first.decode("latin-1"))
    if not header or header[2] or header[3] or b"BINARY" in first:
        raise MeshFormatError(
            f"The file begins with '{first.decode('latin-1').strip()[:30]}', not with OFF, COFF, NOFF or STOFF as a"
            " three-dimensional ASCII OFF file does; export the mesh again."
        )
    rest = header[4].encode("latin-1") + b"\n" + rest
    n_points, n_faces = (int(word) for word in rest.split(maxsplit=2)[:2])
    numbers, widths = read_numbers(rest, 1 + n_points + n_faces)
    if len(widths) < 1 + n_points + n_faces:
        raise MeshFormatError(
            f"The OFF file declares {n_points} vertices and {n_faces} faces but ends after"
            f" {len(widths) - 1} lines; it is cut off, export the mesh again."
        )
    return take_polygons(numbers[widths[0] :], widths[1:], n_points, n_faces)


# --------------------------------------------------------------------------
# PLY


def read_ply(path):
    """Read PLY whose faces are triangles, or triangle strips, here, and any other through trimesh."""
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header")
    text = re.sub(r"(comment|obj_info)[^\n]*\n", "", head.decode("latin-1").replace("\r", ""))
    body = body[2:] if body.startswith(b"\r\n") else body[1:]
    if re.search(r"element\s+face\s+[1-9]", text) or "tristrips" not in text:
        return read_triangles(text, body) or read_scene(path)
    return read_strips(text, body)


# --------------------------------------------------------------------------
# OBJ


def read_obj(path):
    """Read OBJ of vertices and polygons here, whatever their materials and normals, and any other through trimesh."""
    return parse_obj(path.read_bytes()) or read_scene(path)


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
        raise MeshFormatError("The file holds no faces: it is empty or cut off; export the mesh again.")
    return np.concatenate(points), np.concatenate(faces)


READERS = dict.fromkeys(SUFFIXES, read_scene)
READERS |= {".stl": read_stl, ".off": read_off, ".ply": read_ply, ".obj": read_obj}
READERS |= {".step": read_step, ".stp": read_step}
