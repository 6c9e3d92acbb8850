"""Lines of numbers, which ASCII meshes are made of, taken from the bytes of a file."""

import numpy as np
from numba import njit

from ..errors import NumberFormatError


def read_numbers(text, most=np.iinfo(np.int64).max):
    """Read the lines of a text, as bytes, that are not blank, and of those the first `most`.

    Returns the numbers (n,) float64, correctly rounded, and how many stand in
    each line (l,) int64. Raises `NumberFormatError` if a word is no number.
    """
    letters = np.frombuffer(text, np.uint8)
    widths, end = _count_words(letters, most)
    if not len(widths):
        return np.zeros(0), widths
    try:
        numbers = np.fromstring(text[:end] if end < len(text) else text, sep=" ")
    except ValueError:
        raise NumberFormatError("there is a word that is not a number") from None
    if len(numbers) != widths.sum():
        raise NumberFormatError(f"{text.split()[len(numbers)][:30]} is not a number")
    return numbers, widths


def split_obj(data):
    """Pick from OBJ, as bytes, what follows `v` and the numbers of vertices that follow `f`: two texts.

    Raises `NumberFormatError` if there is anything else that makes a surface, or a line
    that goes on in the next one.
    """
    vertices, faces, plain = _split_obj(np.frombuffer(data.replace(b"\r\n", b"\n").replace(b"\r", b"\n"), np.uint8))
    if not plain:
        raise NumberFormatError("the OBJ file has more than vertices and polygons")
    return vertices.tobytes(), faces.tobytes()


NEW_LINE, SPACE, HASH, SLASH, BACKSLASH = b"\n #/\\"
F, G, M, N, O, S, T, U, V = b"fgmnostuv"


@njit(cache=True, inline="always")
def _is_blank(letter):
    return letter == SPACE or 9 <= letter <= 13


@njit(cache=True)
def _count_words(letters, most):
    """How many words stand in each of the first `most` lines that are not blank; and where these end."""
    widths, lines, words, blank = np.empty(1024, np.int64), 0, 0, True
    for i in range(len(letters) + 1):
        if i == len(letters) or letters[i] == NEW_LINE:
            if words > 0:
                if lines == len(widths):
                    widths = np.append(widths, np.empty_like(widths))
                widths[lines] = words
                lines, words = lines + 1, 0
                if lines == most:
                    return widths[:lines].copy(), i
            blank = True
        elif _is_blank(letters[i]):
            blank = True
        else:
            words += blank
            blank = False
    return widths[:lines].copy(), len(letters)


@njit(cache=True)
def _split_obj(letters):
    """The text after `v` and that after `f` without what follows slashes; and whether there is nothing else."""
    n, i = len(letters), 0
    vertices, faces = np.empty(n + 1, np.uint8), np.empty(n + 1, np.uint8)
    n_vertices = n_faces = 0
    while i < n:
        while i < n and letters[i] != NEW_LINE and _is_blank(letters[i]):
            i += 1
        first, second = letters[i] if i < n else NEW_LINE, letters[i + 1] if i + 1 < n else NEW_LINE
        alone = _is_blank(second)
        vertex, face = first == V and alone, first == F and alone
        passed = first == NEW_LINE or first == HASH or (first == V and (second == T or second == N))
        passed |= (first == G or first == O or first == S) and alone
        passed |= (first == U and second == S) or (first == M and second == T)  # usemtl, mtllib
        if not (vertex or face or passed):
            return vertices[:0], faces[:0], False
        i += 1 if vertex or face else 0
        told, commented = True, False
        while i < n and letters[i] != NEW_LINE:
            letter = letters[i]
            commented |= letter == HASH
            if letter == BACKSLASH and not commented:
                return vertices[:0], faces[:0], False
            told = (told or _is_blank(letter)) and not (face and letter == SLASH)
            if told and not commented and vertex:
                vertices[n_vertices] = letter
                n_vertices += 1
            elif told and not commented and face:
                faces[n_faces] = letter
                n_faces += 1
            i += 1
        i += 1
        if vertex:
            vertices[n_vertices] = NEW_LINE
            n_vertices += 1
        elif face:
            faces[n_faces] = NEW_LINE
            n_faces += 1
    return vertices[:n_vertices].copy(), faces[:n_faces].copy(), True
