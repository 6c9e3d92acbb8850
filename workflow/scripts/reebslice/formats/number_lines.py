"""Lines of numbers, which ASCII meshes are made of, taken from the bytes of a file."""

from io import BytesIO

import numpy as np

from ..errors import NumberFormatError
from ..kernels import njit

NEW_LINE, SPACE = b"\n "
UTF_16 = (b"\xff\xfe", b"\xfe\xff")  # marks of the order of bytes
MARK = b"\xef\xbb\xbf"  # what some editors put before UTF-8 text


def read_text(path):
    """Return a text file as bytes of UTF-8, its lines ended by line feeds whatever ends them in the file."""
    data = path.read_bytes()
    if data.startswith(UTF_16):
        data = data.decode("utf-16", "replace").encode()
    data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return data[len(MARK) :] if data.startswith(MARK) else data


def read_numbers(text, most=2**63 - 1):
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


def describe_word(text, first_line):
    """Return which line of a text, as bytes, holds the first word that is no number, counted from `first_line`."""
    for number, line in enumerate(BytesIO(text), first_line):
        for word in line.split():
            if not is_number(word):
                return f"Line {number} holds '{decode(word)}' where a number is due"
    return "A word is not a number"


def is_number(word):
    """Tell whether a word, as bytes, is a number (nan and inf among them)."""
    try:
        float(word)
    except ValueError:
        return False
    return b"_" not in word


def decode(words):
    """Return bytes as the text of a message, at most 60 letters of it."""
    text = words.decode("utf-8", "replace").strip()
    text = "".join(letter if letter.isprintable() else " " for letter in text)
    return text if len(text) <= 60 else text[:57] + "..."


@njit(inline="always")
def is_blank(letter):
    """Tell whether a byte is white space."""
    return letter == SPACE or 9 <= letter <= 13


@njit
def _count_words(letters, most):
    """How many words stand in each of the first `most` lines that are not blank; and where these end."""
    widths, lines, words, blank = np.empty(1024, np.int64), 0, 0, True
    for i in range(len(letters) + 1):
        if i == len(letters) or letters[i] == NEW_LINE:
            if words > 0:
                if lines == len(widths):
                    longer = np.empty(2 * lines, np.int64)
                    for k in range(lines):
                        longer[k] = widths[k]
                    widths = longer
                widths[lines] = words
                lines, words = lines + 1, 0
                if lines == most:
                    return widths[:lines].copy(), i
            blank = True
        elif is_blank(letters[i]):
            blank = True
        else:
            words += blank
            blank = False
    return widths[:lines].copy(), len(letters)
