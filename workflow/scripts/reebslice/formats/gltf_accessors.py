"""Buffers of glTF 2.0, and accessors as arrays.

References: "glTF 2.0 Specification", section Binary Data Storage; the extension
KHR_mesh_quantization for integers.
"""

import base64
import os
from typing import NamedTuple
from urllib.parse import unquote_to_bytes

import numpy as np

from ..errors import MeshFormatError
from .gltf_asset import DAMAGED, UNPACK, decode_name, is_data, take_entry, take_kind, take_whole
from .gltf_shares import take_share, weigh

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
BLANKS = b" \t\n\r\x0b\f"
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# A sparse accessor without a bufferView may declare any number of zeros in a few bytes: those of any file, and one for
# each byte of a larger one, so that it may have a zero for each vertex that does not move.
MOST_ZEROS = 2**16


def _read_buffer(asset, index, where):
    """Return the bytes of a buffer; no more is held than is there."""
    if index not in asset.buffers:
        buffer = take_entry(asset.document, "buffers", index, where)
        name = f"Buffer {index}"
        length, uri = take_whole(buffer, "byteLength", name), buffer.get("uri")
        if uri is None:
            data, source = asset.chunk if index == 0 else None, "the BIN chunk"
        elif not isinstance(uri, str):
            raise MeshFormatError(f"{name} has uri = {uri!r:.40} where a text is due; {DAMAGED}.")
        else:
            data, source = _decode_data(uri, name) if is_data(uri) else _read_file(asset, uri, length, name)
        if data is None:
            raise MeshFormatError(f"{name} has neither a uri nor, as the first one, a BIN chunk; {DAMAGED}.")
        if len(data) < length:
            raise MeshFormatError(f"{name} declares {length} bytes, but {source} has {len(data)}; {DAMAGED}.")
        asset.buffers[index] = data[:length]
    return asset.buffers[index]


def _decode_data(uri, name):
    """Return the bytes of a data: URI (RFC 2397) and what to call them."""
    head, comma, body = uri.partition(",")
    try:
        body = unquote_to_bytes(body)
        if head.lower().endswith(";base64"):
            body = body.translate(None, BLANKS)
            body = base64.b64decode(body + b"=" * (-len(body) % 4), validate=True)
    except ValueError as error:
        raise MeshFormatError(f"The data: URI of {name} is not base64 ({error}); {DAMAGED}.") from error
    if not comma:
        raise MeshFormatError(f"The data: URI of {name} has no comma before its data; {DAMAGED}.")
    return np.frombuffer(body, np.uint8), "its data: URI"


def _read_file(asset, uri, length, name):
    """Return the first `length` bytes of the file that a URI names and what to call them."""
    relative = decode_name(uri, name)
    file = asset.path.parent / relative
    if not os.path.isfile(file):
        raise MeshFormatError(
            f"{name} is the file {relative!r:.200} beside {asset.path.name}, which is not there; copy it along, or save"
            " as .glb."
        )
    if relative not in asset.files:
        asset.files[relative] = np.memmap(file, np.uint8, "r") if file.stat().st_size else np.zeros(0, np.uint8)
    data = asset.files[relative][:length]
    if data[:24].tobytes() == b"version https://git-lfs.":
        raise MeshFormatError(f"{name}, the file {relative!r}, is a Git LFS pointer; fetch it with `git lfs pull`.")
    return data, f"the file {relative!r}"


# --------------------------------------------------------------------------
# Accessors


class Accessor(NamedTuple):
    """The elements of an accessor, in place in their buffer, all of which are there."""

    name: str
    count: int  # type: ignore[assignment]  # a method of tuples is called so
    stored: np.ndarray | None
    """(count, width); None where the file holds no elements but zeros."""
    sparse: tuple | None
    """Places (k,) int64, rising, and elements (k, width) that replace those stored there."""
    normalized: bool
    dtype: np.dtype
    width: int


def open_accessor(asset, index, shape, kinds, where):
    """Find the elements of an accessor, and hold all declared lengths against what is there.

    Parameters
    ----------
    asset : Asset
    index : int
    shape : str
        The `type` that is allowed, a key of `WIDTHS`.
    kinds : collection of int
        The component types that are allowed, of `COMPONENTS`.
    where : str
        What refers to the accessor, for the sentence.

    Returns
    -------
    Accessor
        Nothing was copied, and no memory taken for elements.

    Raises
    ------
    MeshFormatError
        There is no such accessor; it has another type; its elements do not fit
        the bufferView, or that the buffer; sparse indices do not rise, or
        leave the accessor.
    """
    entry, name = take_entry(asset.document, "accessors", index, where), f"Accessor {index} ({where})"
    found, kind, count = entry.get("type"), take_whole(entry, "componentType", name), take_whole(entry, "count", name)
    normalized = entry.get("normalized") is True and kind != 5126
    if found != shape or kind not in kinds or (normalized and kind == 5125):
        raise MeshFormatError(
            f"{name} is {found!r:.20} of componentType {kind}{', normalized' * normalized}; allowed are {shape} of"
            f" {', '.join(map(str, sorted(kinds)))}: {DAMAGED}."
        )
    elements = count, np.dtype(COMPONENTS[kind]), WIDTHS[shape]
    # Indices are tightly packed; only what belongs to vertices or instances may be spaced.
    stored = _view_elements(asset, entry, *elements, name, shape != "SCALAR") if "bufferView" in entry else None
    if stored is None and count > (most := max(MOST_ZEROS, weigh(asset))):
        raise MeshFormatError(
            f"{name} declares {count} elements without a bufferView; more than {most} are not read: store the elements"
            " in a buffer."
        )
    take_share(asset, "elements", count)
    sparse = _view_sparse(asset, entry, *elements, name) if "sparse" in entry else None
    return Accessor(name, count, stored, sparse, normalized, *elements[1:])


def read_elements(accessor, rows=None):
    """Return elements of an accessor, sparse ones put in.

    Parameters
    ----------
    accessor : Accessor
    rows : (int, int), optional
        The first element and the one after the last (default: all).

    Returns
    -------
    (n, width) array
        Normalized integers and floats as float64, by the equations of
        KHR_mesh_quantization; other integers as they are.
    """
    first, last = rows or (0, accessor.count)
    if accessor.stored is None:
        values = np.zeros((last - first, accessor.width), accessor.dtype)
    else:
        values = accessor.stored[first:last]
    if accessor.sparse:
        places, elements = accessor.sparse
        here = (places >= first) & (places < last)
        values = values.copy()
        values[places[here] - first] = elements[here]
    if accessor.normalized:
        return np.maximum(values / np.float64(np.iinfo(accessor.dtype).max), -1.0)
    return values.astype(np.float64) if accessor.dtype.kind == "f" else values


def check_count(accessor, count):
    """Refuse an accessor that does not give one element for each position of its primitive.

    Parameters
    ----------
    accessor : Accessor
    count : int

    Raises
    ------
    MeshFormatError
    """
    if accessor.count != count:
        raise MeshFormatError(f"{accessor.name} has {accessor.count} elements, the positions have {count}; {DAMAGED}.")


def _view_elements(asset, owner, count, dtype, width, name, spaced=False):
    """Return (count, width) elements in place."""
    index = take_whole(owner, "bufferView", name)
    view, view_name = take_entry(asset.document, "bufferViews", index, name), f"BufferView {index}"
    size = dtype.itemsize * width
    stride = take_whole(view, "byteStride", view_name, size)
    if stride < size or (stride != size and not spaced):
        raise MeshFormatError(
            f"{name} has elements of {size} bytes{'' if spaced else ', tightly packed'}, but {view_name} has byteStride"
            f" {stride}; {DAMAGED}."
        )
    inside, start = take_whole(owner, "byteOffset", name, 0), take_whole(view, "byteOffset", view_name, 0)
    length = take_whole(view, "byteLength", view_name)
    end = inside + stride * (count - 1) + size if count else 0
    if end > length:
        raise MeshFormatError(
            f"{name} declares {count} elements, which end at byte {end} of {view_name}, but that has {length} bytes;"
            f" {DAMAGED}."
        )
    data = _read_view_buffer(asset, view, view_name)
    if start + length > len(data):
        raise MeshFormatError(
            f"{view_name} ends at byte {start + length} of buffer {view['buffer']}, which has {len(data)}; {DAMAGED}."
        )
    if not count:
        return np.zeros((0, width), dtype)
    return np.ndarray((count, width), dtype, data, start + inside, (stride, dtype.itemsize))


def _read_view_buffer(asset, view, view_name):
    """Return the buffer of a view, or name the compression of which it would be the outcome."""
    index = take_whole(view, "buffer", view_name)
    buffer = take_entry(asset.document, "buffers", index, view_name)
    used = sorted(take_kind(view, "extensions", dict, view_name))
    if used and "uri" not in buffer and (index or asset.chunk is None):
        raise MeshFormatError(f"{view_name} is stored by {' and '.join(used)} only, {UNPACK}.")
    return _read_buffer(asset, index, view_name)


def _view_sparse(asset, entry, count, dtype, width, name):
    """Return the places (k,) and the elements (k, width) that replace others."""
    sparse = take_kind(entry, "sparse", dict, name)
    replaced = take_whole(sparse, "count", f"{name}: sparse")
    indices, elements = (take_kind(sparse, key, dict, f"{name}: sparse") for key in ("indices", "values"))
    kind = take_whole(indices, "componentType", f"{name}: sparse indices")
    if kind not in (5121, 5123, 5125):
        raise MeshFormatError(f"{name} has sparse indices of componentType {kind}, not 5121, 5123 or 5125; {DAMAGED}.")
    places = _view_elements(asset, indices, replaced, np.dtype(COMPONENTS[kind]), 1, f"{name}: sparse indices")
    places = places[:, 0].astype(np.int64)
    if replaced and (places[-1] >= count or (np.diff(places) <= 0).any()):
        raise MeshFormatError(
            f"{name} has sparse indices that do not rise from one to the next, or end at {places[-1]} beyond its"
            f" {count} elements; {DAMAGED}."
        )
    return places, _view_elements(asset, elements, replaced, dtype, width, f"{name}: sparse values")
