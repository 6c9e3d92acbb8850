"""Read STL, binary and ASCII, whatever the header says.

Reference: 3D Systems, StereoLithography Interface Specification, October 1989. Both forms, no version. Attributes of
two bytes, in which Magics and VisCAM keep colours, are passed over.
"""

from io import BytesIO
from itertools import islice, pairwise

import numpy as np

from ..errors import MeshFormatError, NumberFormatError
from ..kernels import njit
from ..mesh.faults import Names, find_fault
from .mesh_file import MeshFile
from .number_lines import decode, is_blank, is_number, read_numbers, read_text

HEADER, FACET = 84, 50  # bytes
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path):
    """Read the facets of an STL file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    MeshFile
        Three points of its own for each facet, in the order of the file; all solids of an ASCII file together. Normals
        are passed over: the winding says which side is outside.

    Raises
    ------
    MeshFormatError
        The file is cut off, holds no facets, or a facet is not of three vertices; facets are counted from 1.
    """
    size = path.stat().st_size
    with open(path, "rb") as file:
        head = file.read(2048)
    count = int.from_bytes(head[80:84], "little") if size >= HEADER else -1
    needed = HEADER + FACET * count
    notes, text = (), None
    if size != needed and b"\0" not in head:  # a binary file of up to 16 million facets has a zero in its header
        text = read_text(path)
        points = _parse_text(text)
    else:
        points = _map_facets(path, count, size, needed)
        if size > needed:
            notes = (f"Bytes after the last facet were left out: {size - needed}.",)
    faces = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
    if fault := find_fault(points, faces, _count_facets(text)):
        raise MeshFormatError(fault)
    return MeshFile(points, faces, None, notes)


def _map_facets(path, count, size, needed):
    if count < 0 or (count == 0 and size == HEADER):
        raise MeshFormatError("The STL file holds no faces, only a header; export the mesh again.")
    if size < needed or count == 0:
        raise MeshFormatError(
            f"The binary STL file declares {count} facets, which take {needed} bytes, but has {size} bytes,"
            f" {(size - HEADER) // FACET} facets; it is damaged, export the mesh again."
        )
    corners = np.memmap(path, RECORD, "r", HEADER, (count,))["corners"]  # the bytes themselves are never held
    return np.asarray(corners).astype(np.float64).reshape(-1, 3)


def _count_facets(text):
    """Name vertices after their facets, with the line where it is known."""

    def name(vertex):
        line = "" if text is None else f" (line {next(islice(_list_vertices(text), vertex, None))[0]})"
        return f"vertex {vertex % 3 + 1} of facet {vertex // 3 + 1}{line}"

    return Names(1, name, lambda face: f"facet {face + 1}")


# --------------------------------------------------------------------------
# ASCII

NEW_LINE, SPACE, HASH, SEMICOLON, SLASH, ZERO, NINE = b"\n #;/09"
SIGNS = b"+-."
CASE = 32  # sets a letter's case to lower
LETTERS = {word: np.frombuffer(word, np.uint8) for word in (b"solid", b"endsolid", b"facet", b"vertex")}
SOLID, ENDSOLID, FACET_WORD, VERTEX = LETTERS.values()
SOUND, WRONG_COUNT, WRONG_WIDTH = range(3)


def _parse_text(data):
    """Return the vertices (n, 3) of ASCII STL, three for each facet."""
    text, n_facets, fault, at = _scan(np.frombuffer(data, np.uint8))
    if fault == WRONG_COUNT:
        raise MeshFormatError(_describe_facet(data, n_facets, at))
    if not n_facets:
        raise MeshFormatError("The ASCII STL file holds no facets; export the mesh again.")
    try:
        values, widths = read_numbers(text.tobytes())
        sound = fault == SOUND and len(widths) == 3 * n_facets and bool((widths == 3).all())
    except NumberFormatError:
        sound = False
    if not sound:
        raise MeshFormatError(_describe_vertex(data))
    return values.reshape(-1, 3)


@njit
def _scan(letters):
    """Scan words: what follows `vertex`, line by line; the number of facets; what is wrong, and where it begins."""
    n = len(letters)
    text = np.empty(n + 1, np.uint8)
    i = at = n_facets = n_vertices = start = 0
    fault = SOUND
    while i < n:
        letter = letters[i]
        if is_blank(letter):
            i += 1
        elif _is_comment(letters, i) or _is_word(letters, i, SOLID) or _is_word(letters, i, ENDSOLID):
            i = _skip_line(letters, i)
        elif _is_word(letters, i, FACET_WORD):
            if n_vertices != 3 * n_facets:
                return text[:at], n_facets, WRONG_COUNT, start
            n_facets, start = n_facets + 1, i
            i += len(FACET_WORD)
        elif _is_word(letters, i, VERTEX):
            i, at, more = _copy_vertex(letters, i + len(VERTEX), text, at)
            fault = WRONG_WIDTH if more else fault
            n_vertices += 1
        else:
            i = _skip_word(letters, i)
    return text[:at], n_facets, fault if n_vertices == 3 * n_facets else WRONG_COUNT, start


@njit(inner=True)
def _copy_vertex(letters, i, text, at):
    """Copy three words and end the line; return where both end, and whether another number follows in the line."""
    n = len(letters)
    for _ in range(3):
        while i < n and is_blank(letters[i]):
            i += 1
        while i < n and not is_blank(letters[i]) and not _is_comment(letters, i):
            text[at] = letters[i]
            i, at = i + 1, at + 1
        text[at] = SPACE
        at += 1
    text[at - 1] = NEW_LINE
    while i < n and is_blank(letters[i]) and letters[i] != NEW_LINE:
        i += 1
    more = i < n and (ZERO <= letters[i] <= NINE or letters[i] == SIGNS[0] or letters[i] in (SIGNS[1], SIGNS[2]))
    return i, at, more


@njit(inner=True)
def _is_word(letters, i, word):
    """Tell whether `word`, in any case, stands at i by itself."""
    end = i + len(word)
    if end > len(letters):
        return False
    for k in range(len(word)):
        if letters[i + k] | CASE != word[k]:
            return False
    return end == len(letters) or is_blank(letters[end])


@njit(inline="always")
def _is_comment(letters, i):
    """Tell whether a comment begins at i, as programs write them, though the specification has none."""
    letter = letters[i]
    return letter in (HASH, SEMICOLON) or (letter == SLASH and i + 1 < len(letters) and letters[i + 1] == SLASH)


@njit(inner=True)
def _skip_line(letters, i):
    while i < len(letters) and letters[i] != NEW_LINE:
        i += 1
    return i


@njit(inner=True)
def _skip_word(letters, i):
    while i < len(letters) and not is_blank(letters[i]):
        i += 1
    return i


# --------------------------------------------------------------------------
# What is told


def _describe_facet(data, number, start):
    """Describe the facet that begins at `start` and has not three vertices."""
    line = data.count(b"\n", 0, start) + 1
    after = BytesIO(data)
    after.seek(start + len(FACET_WORD))
    vertices, ended = 0, False
    for word in (word for row in after for word in row.lower().split()):
        if word in (b"facet", b"endfacet", b"endsolid", b"solid"):
            ended = True
            break
        vertices += word == b"vertex"
    if not number:
        return "The ASCII STL file has a vertex before its first facet; export the mesh again."
    where = f"facet {number} (line {line})"
    if not ended:
        return f"The ASCII STL file ends within {where}: it is cut off, export the mesh again."
    return (
        f"The ASCII STL file has {vertices} vertices instead of 3 in {where}; cut it into triangles, or mend that line."
    )


def _describe_vertex(data):
    """Describe the first vertex that is not three numbers."""
    for vertex, (line, words) in enumerate(_list_vertices(data)):
        if len(words) != 3 or not all(map(is_number, words)):
            return (
                f"Line {line} of the ASCII STL file has a vertex that is not three numbers:"
                f" '{decode(b' '.join(words))}' (facet {vertex // 3 + 1}); mend that line or export the mesh again."
            )
    return "The ASCII STL file has a vertex that is not three numbers; export the mesh again."


def _list_vertices(data):
    """Yield the number of the line, and the words there, that follow each `vertex`."""
    for number, line in enumerate(BytesIO(data), 1):
        words = line.split(b"#")[0].split(b";")[0].split(b"//")[0].split()
        if words and words[0].lower() in (b"solid", b"endsolid"):
            continue
        marks = [k for k, word in enumerate(words) if word.lower() in (b"vertex", b"endloop")]
        for k, end in pairwise([*marks, len(words)]):
            if words[k].lower() == b"vertex":
                yield number, words[k + 1 : end]
