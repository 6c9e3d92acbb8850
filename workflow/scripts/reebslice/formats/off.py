"""Read OFF, ASCII and binary, of points in space.

Reference: Geomview 1.9, Object File Format (geomview.org/docs/html/OFF.html). The header is [ST][C][N]OFF, with BINARY
or not; 4OFF and nOFF hold points of other dimensions and are refused.
"""

import re
from io import BytesIO

import numpy as np

from ..errors import MeshFormatError, NumberFormatError
from ..kernels import njit
from ..mesh.faults import Names
from .number_lines import decode, describe_word, read_numbers, read_text
from .polygons import build_mesh


def read_off(path):
    """Read the polygons of an OFF file; normals, colours and texture are passed over.

    Parameters
    ----------
    path : Path

    Returns
    -------
    MeshFile
        Points and polygons in the order of the file.

    Raises
    ------
    MeshFormatError
        The header is none of those above, the file is cut off, or a line is not made of numbers; vertices and faces
        are counted from 0.
    """
    with open(path, "rb") as file:
        first = file.readline(200)
    if b"BINARY" in first.partition(b"#")[0]:
        extra = _check_header(first)[0]
        return _read_binary(path.read_bytes()[len(first) :], 3 + extra)
    data = read_text(path)
    text = re.sub(rb"#.*", b"", data) if b"#" in data else data
    blank = len(text) - len(text.lstrip())
    extra, rest = _check_header(text[blank:].partition(b"\n")[0])
    text = text[blank:][len(text[blank:].partition(b"\n")[0]) - len(rest) :]
    line = data.count(b"\n", 0, blank) + 1
    counts = text.split(maxsplit=2)[:2]
    if len(counts) < 2 or not all(word.isdigit() and len(word) < 19 for word in counts):  # of 64 bits
        raise MeshFormatError(
            f"The OFF file has '{decode(b' '.join(counts))}' where its numbers of vertices and faces are due;"
            " export the mesh again."
        )
    n_points, n_faces = map(int, counts)
    try:
        numbers, widths = read_numbers(text)
    except NumberFormatError:
        raise MeshFormatError(f"{describe_word(text, line)}; mend that line or export the mesh again.") from None
    ends = np.cumsum(widths)
    points, at = _take_points(numbers, widths, ends, n_points, n_faces, 3 + extra)
    return _build(points, *_walk(numbers, ends, at, n_faces), numbers, n_faces, lambda: _find_lines(text, line))


def _check_header(line):
    """Return how many numbers follow the coordinates of a vertex, without colours, and what follows the keyword."""
    header = re.match(rb"(ST)?(C)?(N)?(4)?(n)?OFF\b(.*)", line, re.DOTALL)
    if not header:
        raise MeshFormatError(
            f"The file begins with '{decode(line)}', not with OFF, COFF, NOFF or STOFF as a three-dimensional OFF file"
            " does; export the mesh again."
        )
    if header[4] or header[5]:
        raise MeshFormatError(
            f"The file is {decode(line.split()[0])}: its points are not of three dimensions; export the mesh as OFF."
        )
    return 3 * bool(header[3]) + 2 * bool(header[1]), header[6]


def _take_points(numbers, widths, ends, n_points, n_faces, width):
    """Return the points, and the place behind them: one a line, or as many numbers as the header says."""
    rows = widths[1 : 1 + n_points]
    if len(widths) > n_points + n_faces and rows.min(initial=3) >= 3:
        at = (ends - widths)[1 : 1 + n_points]
        return numbers[at[:, None] + np.arange(3)], ends[n_points]
    end = ends[0] + n_points * width
    if end > len(numbers):
        raise MeshFormatError(
            f"The OFF file declares {n_points} vertices and {n_faces} faces but ends after {len(widths) - 1} lines,"
            f" within its vertices; it is cut off, export the mesh again."
        )
    return numbers[ends[0] : end].reshape(-1, width)[:, :3], end


@njit
def _walk(numbers, ends, at, n_faces):
    """Walk over faces from `at` on, each ended by its line.

    Returns begin and size of each, and the face, if any, that is not whole: the first that its line does not hold.
    """
    most = min(n_faces, len(numbers))
    begin, sizes, line, doubtful = np.empty(most, np.int64), np.empty(most, np.int64), 0, n_faces
    for k in range(n_faces):
        if at >= len(numbers) or not 0 <= numbers[at] <= len(numbers) - at - 1 or numbers[at] != np.floor(numbers[at]):
            return begin, sizes, min(k, doubtful)
        begin[k], sizes[k] = at + 1, np.int64(numbers[at])
        at += 1 + sizes[k]
        while ends[line] < begin[k]:
            line += 1
        if ends[line] < at and doubtful == n_faces:
            doubtful = k
        while ends[line] < at:
            line += 1
        at = ends[line]
    return begin, sizes, n_faces


def _read_binary(data, width):
    """Read what follows the header OFF BINARY: words of four bytes, the first byte first."""
    words = np.frombuffer(data[: len(data) // 4 * 4], ">i4")
    if len(words) < 3 or words[:2].min() < 0:
        raise MeshFormatError("The binary OFF file declares no numbers of vertices and faces; export the mesh again.")
    n_points, n_faces = int(words[0]), int(words[1])
    end = 3 + width * n_points
    if end > len(words):
        raise MeshFormatError(
            f"The binary OFF file declares {n_points} vertices of {4 * width} bytes but has {len(data)} bytes; it is"
            " cut off, export the mesh again."
        )
    points = words[3:end].view(">f4").reshape(-1, width)[:, :3].astype(np.float64)
    faces = words.astype(np.int64)
    return _build(points, *_walk_binary(faces, end, n_faces), faces, n_faces, None)


@njit
def _walk_binary(words, at, n_faces):
    """Walk over faces: size, ids, number of colours, colours."""
    most = min(n_faces, len(words))
    begin, sizes = np.empty(most, np.int64), np.empty(most, np.int64)
    for k in range(n_faces):
        if at >= len(words) or words[at] < 0 or at + 1 + words[at] >= len(words) or words[at + 1 + words[at]] < 0:
            return begin, sizes, k
        begin[k], sizes[k] = at + 1, words[at]
        at += 1 + words[at]
        at += 1 + words[at]
    return begin, sizes, n_faces


def _build(points, begin, sizes, whole, numbers, n_faces, find_lines):
    """Build the mesh of faces, of which `whole` were found."""
    if whole < n_faces:
        raise MeshFormatError(
            f"The OFF file declares {len(points)} vertices and {n_faces} faces, but face {whole} is missing or names"
            " fewer vertices than it declares; the file is cut off, export the mesh again."
        )
    last = np.cumsum(sizes)
    found = numbers[np.repeat(begin - last + sizes, sizes) + np.arange(last[-1] if n_faces else 0)]
    corners = found.astype(np.int64)
    if (corners != found).any():
        first = np.searchsorted(last, np.flatnonzero(corners != found)[0], "right")
        raise MeshFormatError(f"Face {first} names a vertex by something that is not a whole number; mend that line.")

    def name(noun, number, before):
        lines = find_lines() if find_lines else []
        by_rows = len(lines) > len(points) + n_faces  # as the specification has them
        return f"{noun} {number}" + (f" (line {lines[1 + before + number]})" if by_rows else "")

    names = Names(0, lambda v: name("vertex", v, 0), lambda f: name("face", f, len(points)))
    return build_mesh(points, corners, sizes, names)


def _find_lines(text, first):
    """Return the numbers of the lines that are not blank."""
    return [number for number, line in enumerate(BytesIO(text), first) if line.strip()]
