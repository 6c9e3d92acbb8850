"""Take properties from the rows of PLY elements, binary or ASCII, whose lists may be of any length."""

from typing import NamedTuple

import numpy as np

from ..errors import MeshFormatError
from ..kernels import njit


class Property(NamedTuple):
    """A property: its name, and numpy's codes of its type and, if it is a list, of the type of its length."""

    name: str
    kind: str
    length: str | None


class Element(NamedTuple):
    """An element: its name, the number of its rows, and its properties in the order of the file."""

    name: str
    count: int  # type: ignore[assignment]  # a method of tuples is called so
    properties: list


def read_binary(data, at, element, names, order):
    """Take properties of a binary element.

    Parameters
    ----------
    data : bytes
    at : place of the first row.
    element : Element
    names : properties that are wanted.
    order : "<" or ">", the byte order.

    Returns
    -------
    found : list of (values, lengths), one for each name
        `values` of all rows together; `lengths` (rows,) int64 of lists, None for scalars.
    end : place behind the last row.
    """
    if not element.count or not element.properties:
        return [], at
    uniform = _guess_row(data, at, element, order)
    if uniform is not None:
        table = np.frombuffer(data, uniform, element.count, at)
        lists = [k for k, one in enumerate(element.properties) if one.length]
        counts = {k: uniform[f"v{k}"].shape[0] if uniform[f"v{k}"].shape else 0 for k in lists}
        if all((table[f"n{k}"] == counts[k]).all() for k in lists):
            found = [_take_column(table, k, counts, element.count) for k in _find_columns(element, names)]
            return found, at + element.count * uniform.itemsize
    raw = np.frombuffer(data, np.uint8)
    if element.count > len(raw) - at:
        _check_whole(element, 0)
    lengths = np.array([np.dtype(one.length).itemsize if one.length else 0 for one in element.properties])
    signed = np.array([one.length is not None and one.length[0] == "i" for one in element.properties])
    items = np.array([np.dtype(one.kind).itemsize for one in element.properties])
    found, end = [], at
    for k in _find_columns(element, names) or [0]:
        begin, counts, rows, end = _locate_bytes(raw, at, element.count, lengths, signed, items, k, order == ">")
        _check_whole(element, rows)
        values = _gather(raw, begin, counts, items[k]).view(order + element.properties[k].kind)
        found.append((values, counts if lengths[k] else None))
    return found if names else [], end


def read_ascii(numbers, at, element, names, order=""):
    """Take properties of an ASCII element from all `numbers` (n,) of the file, as `read_binary` does."""
    if not element.count or not element.properties:
        return [], at
    if element.count > len(numbers) - at:
        _check_whole(element, 0)
    columns = _find_columns(element, names)
    is_list = np.array([one.length is not None for one in element.properties])
    if not is_list.any():
        end = at + element.count * len(is_list)
        _check_whole(element, (min(end, len(numbers)) - at) // max(len(is_list), 1))
        table = numbers[at:end].reshape(element.count, -1)
        return [(table[:, k], None) for k in columns], end
    found, end = [], at
    for k in columns or [0]:
        begin, counts, rows, end = _locate_numbers(numbers, at, element.count, is_list, k)
        _check_whole(element, rows)
        last = np.cumsum(counts)
        values = numbers[np.repeat(begin - last + counts, counts) + np.arange(last[-1])]
        found.append((values, counts if is_list[k] else None))
    return found if names else [], end


def _find_columns(element, names):
    places = [one.name for one in element.properties]
    return [places.index(name) for name in names]


def _check_whole(element, rows):
    if rows < element.count:
        raise MeshFormatError(
            f"The PLY file declares {element.count} rows of element {element.name} but ends within row {rows}, or a"
            " list there has a negative length; it is cut off, export the mesh again."
        )


def _guess_row(data, at, element, order):
    """Return the type of the rows if all lists are as long as those of the first row; None if the file is too short."""
    fields, place = [], at
    for k, one in enumerate(element.properties):
        count = ()
        if one.length:
            length = np.dtype(order + one.length)
            if place + length.itemsize > len(data):
                return None
            count = (int(np.frombuffer(data, length, 1, place)[0]),)
            if not 0 < count[0] <= len(data):
                return None
            fields.append((f"n{k}", length))
            place += length.itemsize
        fields.append((f"v{k}", order + one.kind, count))
        place += np.dtype(one.kind).itemsize * (count[0] if count else 1)
    row = np.dtype(fields)
    return row if row.itemsize and at + element.count * row.itemsize <= len(data) else None


def _take_column(table, k, counts, n_rows):
    if k not in counts:
        return table[f"v{k}"], None
    return table[f"v{k}"].reshape(-1), np.full(n_rows, counts[k], np.int64)


@njit
def _locate_bytes(raw, at, n_rows, lengths, signed, items, wanted, big):
    """Locate one property in every row: where its items begin, how many they are, the whole rows, and the end."""
    begin, counts = np.empty(n_rows, np.int64), np.empty(n_rows, np.int64)
    for row in range(n_rows):
        for k in range(len(lengths)):
            count, width = 1, lengths[k]
            if at + width > len(raw):
                return begin, counts, row, at
            if width:
                count = 0
                for byte in range(width):
                    count |= np.int64(raw[at + byte]) << (8 * (width - 1 - byte if big else byte))
                if signed[k] and count >> (8 * width - 1):
                    return begin, counts, row, at
                at += width
            if k == wanted:
                begin[row], counts[row] = at, count
            at += count * items[k]
        if at > len(raw):
            return begin, counts, row, at
    return begin, counts, n_rows, at


@njit
def _locate_numbers(numbers, at, n_rows, is_list, wanted):
    """Locate one property in every row of an ASCII element, as `_locate_bytes` does."""
    begin, counts = np.empty(n_rows, np.int64), np.empty(n_rows, np.int64)
    for row in range(n_rows):
        for k in range(len(is_list)):
            count = 1
            if is_list[k]:
                if at >= len(numbers) or not 0 <= numbers[at] <= len(numbers) or numbers[at] != np.floor(numbers[at]):
                    return begin, counts, row, at
                count, at = np.int64(numbers[at]), at + 1
            if k == wanted:
                begin[row], counts[row] = at, count
            at += count
        if at > len(numbers):
            return begin, counts, row, at
    return begin, counts, n_rows, at


@njit
def _gather(raw, begin, counts, width):
    """Copy `counts` items of `width` bytes from each of `begin`."""
    found, place = np.empty(counts.sum() * width, np.uint8), 0
    for row in range(len(begin)):
        for k in range(counts[row] * width):
            found[place] = raw[begin[row] + k]
            place += 1
    return found
