"""Read OBJ: the polygons of Wavefront's object files.

Reference: Wavefront Technologies, Advanced Visualizer Manual, Appendix B1, Object Files (.obj), version 3.0.
"""

import re
from collections import Counter
from io import BytesIO

import numpy as np

from ..errors import MeshFormatError, NumberFormatError
from ..kernels import njit
from ..mesh.faults import Names
from .number_lines import decode, is_blank, is_number, read_numbers, read_text
from .polygons import build_mesh

FREE_FORM = (b"surf", b"curv", b"curv2", b"bsp", b"bzp", b"cdc", b"cdp")
LEFT_OUT = {b"l": "lines", b"p": "points"}


def read_obj(path):
    """Read the polygons of an OBJ file.

    Parameters
    ----------
    path : Path

    Returns
    -------
    MeshFile
        Points and polygons in the order of the file; its notes tell which
        curves, surfaces, lines and weights were left out. Texture, normals,
        colours, materials and groups are passed over.

    Raises
    ------
    MeshFormatError
        A statement that is not as the specification says, with its line; no polygons.
    """
    data = read_text(path)
    text, ids, sizes, n_points, sound, others = _scan(np.frombuffer(data, np.uint8))
    notes = _describe_others(data, len(sizes), n_points) if others else []
    try:
        numbers, widths = read_numbers(text.tobytes())
    except NumberFormatError:
        sound = False
    if not sound or len(widths) != n_points or widths.min(initial=3) < 3:
        raise MeshFormatError(_describe_statement(data))
    if not len(ids):
        raise MeshFormatError(
            f"The OBJ file holds {n_points} vertices and no faces"
            + (
                ": it is a point cloud; reconstruct a surface from it first."
                if n_points
                else "; export the mesh again."
            )
        )
    if ids.min() < 0 or ids.max() >= n_points:
        raise MeshFormatError(_describe_stray(data, n_points, np.count_nonzero((ids < 0) | (ids >= n_points))))
    begin = np.cumsum(widths) - widths
    weights = np.count_nonzero(numbers[begin[widths == 4] + 3] != 1)
    if weights:
        notes.append(f"{weights} vertices have a weight (w) other than 1, which polygons do not use.")
    points = numbers.reshape(-1, 3) if (widths == 3).all() else numbers[begin[:, None] + np.arange(3)]
    names = Names(1, lambda v: _name(data, "vertex", b"v", v), lambda f: _name(data, "face", b"f", f))
    return build_mesh(points, ids, sizes, names, notes)


# --------------------------------------------------------------------------
# The scan

HASH, SLASH, BACKSLASH, MINUS, PLUS, ZERO, NINE, POINT = b"#/\\-+09."  # 1.#IND is no comment
NEW_LINE, SPACE = b"\n "
F, G, M, N, O, S, T, U, V = b"fgmnostuv"  # noqa: E741, the letter
NOTHING, VERTEX, FACE, OTHER = range(4)
MOST = 2**31 - 1
MOST_DIGITS = 4000  # Python reads no whole number of many more


@njit
def _scan(letters):
    """Scan all statements.

    Returns what follows `v`, line by line; ids of the corners of faces, counted from 0, and sizes of the faces; the
    number of vertices; whether faces are made of such numbers only; whether there are other statements of a surface.
    """
    n = len(letters)
    text, ids, sizes = np.empty(n + 1, np.uint8), np.empty(n // 2 + 1, np.int32), np.empty(n // 2 + 1, np.int32)
    i = n_text = n_ids = n_faces = n_points = 0
    all_sound, others = True, False
    while i < n:
        if is_blank(letters[i]):
            i += 1
            continue
        kind = _tell_statement(letters, i)
        if kind == VERTEX:
            i, n_text = _copy_line(letters, i + 1, text, n_text)
            n_points += 1
        elif kind == FACE:
            i, after, sound = _read_face(letters, i + 1, ids, n_ids, n_points)
            sizes[n_faces] = after - n_ids
            all_sound &= sound
            n_faces, n_ids = n_faces + 1, after
        else:
            others |= kind == OTHER
            i = _skip_line(letters, i, kind != NOTHING)
    return text[:n_text], ids[:n_ids].copy(), sizes[:n_faces].copy(), n_points, all_sound, others


@njit(inner=True)
def _tell_statement(letters, i):
    """Tell the statement that begins at i."""
    first = letters[i]
    second = letters[i + 1] if i + 1 < len(letters) else NEW_LINE
    alone = is_blank(second)
    if first == HASH:
        return NOTHING
    if first == V:
        return VERTEX if alone else OTHER - (second in (T, N)) * OTHER
    if first == F and (alone or (second == O and (i + 2 >= len(letters) or is_blank(letters[i + 2])))):
        return FACE
    passed = (first in (G, O, S)) and alone
    passed |= (first == U and second == S) or (first == M and second == T)  # usemtl, mtllib
    return NOTHING if passed else OTHER


@njit(inline="always")
def _goes_on(letters, i):
    """Tell whether the line ends at i in a backslash, that is goes on in the next one."""
    return letters[i] == BACKSLASH and i + 1 < len(letters) and letters[i + 1] == NEW_LINE


@njit(inner=True)
def _skip_line(letters, i, joined):
    """Return where the statement at i ends; that of a comment ends with its line."""
    joined |= letters[i] != HASH
    while i < len(letters) and letters[i] != NEW_LINE:
        if letters[i] == HASH:
            joined = False
        i += 2 if joined and _goes_on(letters, i) else 1
    return i


@njit(inner=True)
def _copy_line(letters, i, text, at):
    """Copy the numbers of a statement; return where it ends, and where the copy does."""
    n = len(letters)
    while i < n and letters[i] != NEW_LINE:
        letter = letters[i]
        if letter == HASH and letters[i - 1] != POINT:
            i = _skip_line(letters, i, False)
            break
        if letter == BACKSLASH and _goes_on(letters, i):
            text[at] = SPACE
            i += 1
        else:
            text[at] = letter
        at, i = at + 1, i + 1
    text[at] = NEW_LINE
    return i, at + 1


@njit(inner=True)
def _read_face(letters, i, ids, at, n_points):
    """Read the vertex numbers of a face to `ids` from `at` on; return where both end, and whether all are numbers."""
    n, sound = len(letters), True
    i += i < n and letters[i] == O
    while i < n and letters[i] != NEW_LINE:
        letter = letters[i]
        if letter == HASH:
            i = _skip_line(letters, i, False)
        elif is_blank(letter):
            i += 1
        elif _goes_on(letters, i):
            i += 2
        else:
            negative, value, begin = letter == MINUS, 0, i + (letter in (MINUS, PLUS))
            i = begin
            while i < n and ZERO <= letters[i] <= NINE:
                value = min(10 * value + letters[i] - ZERO, MOST)
                i += 1
            ended = i == n or is_blank(letters[i]) or letters[i] == SLASH or _goes_on(letters, i)
            sound &= i > begin and ended
            ids[at] = n_points - value if negative else value - 1
            at += 1
            while i < n and not is_blank(letters[i]) and not _goes_on(letters, i):
                i += 1
    return i, at, sound


# --------------------------------------------------------------------------
# What is told


def _list_statements(data):
    """Yield the line and the words of every statement."""
    start, joined = 1, b""
    for number, line in enumerate(BytesIO(data), 1):
        line, *comment = re.split(rb"(?<!\.)#", line.removesuffix(b"\n"), maxsplit=1)
        goes_on = not comment and line.endswith(b"\\")
        joined += line[:-1] + b" " if goes_on else line
        if not goes_on:
            if words := joined.split():
                yield start, words
            start, joined = number + 1, b""
    if words := joined.split():
        yield start, words


def _describe_statement(data):
    """Describe the first vertex or face that is not as the specification says."""
    for line, words in _list_statements(data):
        shown = decode(b" ".join(words))
        if words[0] == b"v":
            bad = [word for word in words[1:] if not is_number(word)]
            if bad:
                return f"Line {line} ('{shown}') holds '{decode(bad[0])}' where a coordinate is due; mend that line."
            if len(words) < 4:
                return f"Line {line} ('{shown}') gives a vertex fewer than three coordinates; mend that line."
        elif words[0] in (b"f", b"fo"):
            bad = [word for word in words[1:] if not re.fullmatch(rb"[+-]?\d+(/.*)?", word)]
            if bad:
                return f"Line {line} ('{shown}') holds '{decode(bad[0])}' where a vertex number is due; mend that line."
    return "A vertex or a face of the OBJ file is not made of numbers; export the mesh again."


def _describe_stray(data, n_points, count):
    """Describe the first face that names a vertex which does not exist."""
    before = face = 0
    for line, words in _list_statements(data):
        before += words[0] == b"v"
        if words[0] not in (b"f", b"fo"):
            continue
        face += 1
        for word in words[1:]:
            id = int(word.partition(b"/")[0][:MOST_DIGITS])
            if id < -before or id == 0 or id > n_points:
                there = "counted from 1"
                if id < 0:
                    there = f"{before} of them before that line, which negative numbers count back from"
                return (
                    f"Face {face} (line {line}, '{decode(b' '.join(words))}') names vertex {id}, but the OBJ file has"
                    f" {n_points} vertices, {there}; {count} face corners name a vertex that does not exist: export the"
                    " mesh again."
                )
    return f"{count} face corners name a vertex that does not exist; export the mesh again."


def _name(data, noun, keyword, wanted):
    """Name a vertex or face by its number from 1 on, and its line."""
    count = -1
    for line, words in _list_statements(data):
        count += words[0] == keyword or (keyword == b"f" and words[0] == b"fo")
        if count == wanted:
            return f"{noun} {wanted + 1} (line {line})"
    return f"{noun} {wanted + 1}"


def _describe_others(data, n_faces, n_points):
    """Tell what else makes a surface; refuse it where nothing else does."""
    words = Counter(re.findall(rb"^[ \t]*([A-Za-z_]\w*)", data, re.MULTILINE))
    if words[b"call"]:
        raise MeshFormatError("The OBJ file calls other files (call), which is not read; put all into one file.")
    free = ", ".join(f"{words[word]} {word.decode()}" for word in FREE_FORM if words[word])
    if free and not n_faces:
        raise MeshFormatError(
            f"The OBJ file holds {n_points} vertices and no faces, only free-form curves and surfaces ({free});"
            " export it as polygons."
        )
    notes = [f"Free-form curves and surfaces were left out: {free}."] if free else []
    for word, noun in LEFT_OUT.items():
        if words[word]:
            notes.append(f"{words[word]} statements of {noun} ({word.decode()}) were left out.")
    return notes
