"""Numbers in attributes of long runs of XML elements, which meshes in XML are made of, taken from bytes.

An XML parser spends a microsecond or more on each element, minutes on large
meshes. Nearly all writers use one plain form, `<vertex x="0" y="1" z="2"/>`
and nothing in between; that form is read here, and only that form.
"""

import re

import numpy as np

from ..errors import NumberFormatError
from ..kernels import njit
from .number_lines import read_numbers

MARK = b"reebslice-run"


def cut_runs(data, runs):
    """Take runs of plain elements out of XML and leave marked, empty elements in their place.

    Parameters
    ----------
    data : bytes
        XML in an encoding that is ASCII where it is ASCII.
    runs : dict
        For each element that holds a run (b"vertices"), the name of the run's
        elements and of their three attributes: (b"vertex", b"x", b"y", b"z").

    Returns
    -------
    xml : bytes
        The XML in which each run that was taken is an attribute `MARK` of the
        element that held it: the run's place in `tables`. The first run that is
        not plain (comments, entities, prefixes, other elements, words that are
        not numbers), and all that follows it, is as it was.
    tables : list of (n, 3) float64
        The numbers of each run that was taken, correctly rounded.
    """
    if MARK in data:
        return data, []
    pieces, tables, at = [], [], 0
    for opening in re.finditer(rb"<([\w.-]+:)?(%s)\s*>" % b"|".join(runs), data):
        prefix, holder = opening[1] or b"", opening[2]
        end = data.find(b"</" + prefix + holder, opening.end())
        table = _read_run(data, opening.end(), end, prefix, runs[holder]) if end > 0 else None
        if table is None:
            break
        pieces += [data[at : opening.start()], b'<%s %s="%d">' % (prefix + holder, MARK, len(tables))]
        tables.append(table)
        at = end
    return b"".join([*pieces, data[at:]]), tables


def _read_run(data, begin, end, prefix, names):
    """The (n, 3) numbers of the run between two places, or None if it is not plain."""
    element, *attributes = names
    joined = np.frombuffer(b"".join(attributes), np.uint8)
    ends = np.cumsum([0, *map(len, attributes)])
    letters = np.frombuffer(data, np.uint8)[begin:end]
    text, plain = _pick_values(letters, np.frombuffer(prefix + element, np.uint8), joined, ends)
    return read_rows(text.tobytes()) if plain else None


def read_rows(text):
    """Read lines of three decimal numbers each.

    Parameters
    ----------
    text : bytes

    Returns
    -------
    (n, 3) float64 or None
        None if there is anything else.
    """
    if text.translate(None, b"0123456789+-.eE\n "):
        return None  # neither `nan` nor `0x10`
    try:
        numbers, widths = read_numbers(text)
    except NumberFormatError:
        return None
    return numbers.reshape(-1, 3) if len(widths) == text.count(b"\n") and (widths == 3).all() else None


SPACE, QUOTE, APOSTROPHE, SLASH, LESS, EQUAL, GREATER, AMPERSAND, NEW_LINE = b" \"'/<=>&\n"


@njit(inner=True)
def _skip_blanks(letters, at):
    """The first place from `at` on that is no blank of XML."""
    while at < len(letters) and (letters[at] == SPACE or letters[at] == 9 or letters[at] == 10 or letters[at] == 13):
        at += 1
    return at


@njit(inner=True)
def _skip_word(letters, at, word):
    """The place behind a word that stands at a place, or -1 if it does not."""
    if at + len(word) > len(letters):
        return -1
    for k in range(len(word)):
        if letters[at + k] != word[k]:
            return -1
    return at + len(word)


@njit(inner=True)
def _find_value(letters, at):
    """Where an attribute's name, its value and the attribute end, and where its value begins; -1 if it is not plain."""
    n, name_end = len(letters), at
    while name_end < n and letters[name_end] > SPACE and letters[name_end] != EQUAL and letters[name_end] != LESS:
        name_end += 1
    begin = _skip_blanks(letters, name_end)
    if name_end == at or begin >= n or letters[begin] != EQUAL:
        return -1, -1, -1
    begin = _skip_blanks(letters, begin + 1)
    if begin >= n or (letters[begin] != QUOTE and letters[begin] != APOSTROPHE):
        return -1, -1, -1
    end = begin + 1
    while end < n and letters[end] != letters[begin]:
        if letters[end] == LESS or letters[end] == AMPERSAND:
            return -1, -1, -1
        end += 1
    return (name_end, begin + 1, end) if end < n else (-1, -1, -1)


@njit
def _find_values(letters, at, attributes, ends, values):
    """Put where the wanted values begin and end into (3, 2); return where the attributes end, or -1 if not plain."""
    values[:] = -1
    while True:
        begin = _skip_blanks(letters, at)
        if begin >= len(letters):
            return -1
        if letters[begin] == SLASH or letters[begin] == GREATER:
            return begin if values.min() >= 0 else -1
        name_end, low, high = _find_value(letters, begin)
        if begin == at or name_end < 0:
            return -1
        at = high + 1
        for k in range(3):
            if _skip_word(letters, begin, attributes[ends[k] : ends[k + 1]]) == name_end:
                if values[k, 0] >= 0 or low == high:
                    return -1  # twice, or empty
                values[k, 0], values[k, 1] = low, high


@njit(inner=True)
def _skip_end(letters, at, element):
    """The place behind `/>`, or behind `></element>`, at a place, or -1."""
    if letters[at] == SLASH:
        return at + 2 if at + 1 < len(letters) and letters[at + 1] == GREATER else -1
    at = _skip_blanks(letters, at + 1)
    if at + 2 > len(letters) or letters[at] != LESS or letters[at + 1] != SLASH:
        return -1
    at = _skip_word(letters, at + 2, element)
    at = _skip_blanks(letters, at) if at >= 0 else len(letters)
    return at + 1 if at < len(letters) and letters[at] == GREATER else -1


@njit
def _pick_values(letters, element, attributes, ends):
    """The values of three attributes of all elements, a line for each; and whether there is nothing else."""
    text, size, values = np.empty(len(letters), np.uint8), 0, np.empty((3, 2), np.int64)
    at = _skip_blanks(letters, 0)
    while at < len(letters):
        at = _skip_word(letters, at + 1, element) if letters[at] == LESS else -1
        at = _find_values(letters, at, attributes, ends, values) if at >= 0 else -1
        at = _skip_end(letters, at, element) if at >= 0 else -1
        if at < 0:
            return text[:0].copy(), False
        for k in range(3):
            for place in range(values[k, 0], values[k, 1]):
                if letters[place] <= SPACE:
                    return text[:0].copy(), False
                text[size] = letters[place]
                size += 1
            text[size] = NEW_LINE if k == 2 else SPACE
            size += 1
        at = _skip_blanks(letters, at)
    return text[:size].copy(), True
