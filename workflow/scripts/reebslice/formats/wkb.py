"""Closed curves as WKB, the geometry column of GeoParquet."""

import numpy as np
import pyarrow as pa

from ..errors import ReebsliceError
from ..kernels import njit
from ..planar.curves import Curves

HEADER = 9  # bytes: the byte order (1: little-endian), the geometry's type (2: line string), the number of points
POINT = 16


def pack_curves(points, start):
    """Pack closed curves as WKB line strings.

    Parameters
    ----------
    points : (X, 2) float64
        Points of the curves, the first of each not repeated at its end.
    start : (C + 1,) int
        Curve c owns ``points[start[c]:start[c + 1]]``, at least one point.

    Returns
    -------
    pyarrow.Array
        C binaries, 2 GB together at most. Of neighbours that coincide one is dropped; a curve of which only
        one point remains is closed onto itself.

    References
    ----------
    OGC 06-103r4, Simple feature access, part 1, section 8 (well-known binary representation).
    """
    points = np.ascontiguousarray(points, "<f8")
    ends, data = _pack(points, points.view(np.uint8), start)
    return pa.Array.from_buffers(pa.binary(), len(start) - 1, [None, pa.py_buffer(ends), pa.py_buffer(data)])


@njit
def _pack(points, raw, start):
    """Where the curves begin and end, (C + 1,) int32, and all their bytes; raw : (X, 16) bytes of the points."""
    count = len(start) - 1
    most = POINT * len(points) + (HEADER + POINT + POINT) * count
    data, ends = np.empty(most, np.uint8), np.zeros(count + 1, np.int32)
    place = np.uint64(0)  # unsigned, so that bytes are copied many at a time
    for c in range(count):
        head, before = place, start[c + 1] - 1
        place += np.uint64(HEADER)
        for i in range(start[c], start[c + 1]):
            if points[i, 0] != points[before, 0] or points[i, 1] != points[before, 1]:
                place = _append(data, place, raw, np.uint64(i))
            before = i
        if place == head + np.uint64(HEADER):
            place = _append(data, place, raw, np.uint64(start[c]))
        for k in range(np.uint64(POINT)):
            data[place + k] = data[head + np.uint64(HEADER) + k]
        place += np.uint64(POINT)
        size = (place - head) // np.uint64(POINT)
        data[head], data[head + np.uint64(1)] = 1, 2
        for k in range(np.uint64(3)):
            data[head + np.uint64(2) + k] = 0
        for k in range(np.uint64(4)):
            data[head + np.uint64(5) + k] = (size >> (np.uint64(8) * k)) & np.uint64(255)
        ends[c + 1] = place
    return ends, data[:place]


@njit(inline="always")
def _append(data, place, raw, i):
    """Append the bytes of point i; the place behind them."""
    for k in range(np.uint64(POINT)):
        data[place + k] = raw[i, k]
    return place + np.uint64(POINT)


def unpack_curves(blocks, most):
    """Unpack the curves that :func:`pack_curves` packed.

    Parameters
    ----------
    blocks : iterable of pyarrow.Array
        Binaries, of which one array is held at a time.
    most : int
        Their points come to no more than this.

    Returns
    -------
    Curves
        Closed curves, one block after the other.

    Raises
    ------
    ReebsliceError
        A binary has not the length of a line string, or all have more points than that.
    """
    points, starts, place = np.empty((most, 2)), [np.zeros(1, np.int64)], 0
    for block in blocks:
        _, ends, data = (np.frombuffer(buffer or b"", np.uint8) for buffer in block.buffers())
        ends = ends.view("<i4")[block.offset : block.offset + len(block) + 1]
        count, rest = np.divmod(np.diff(ends) - HEADER, POINT)
        stops = place + np.cumsum(count, dtype=np.int64)
        if rest.any() or (count < 1).any() or stops.max(initial=place) > most:
            raise ReebsliceError("the curves of contours are not the line strings that their rows tell of")
        _unpack(data, ends, stops, points.view(np.uint8))
        starts.append(stops)
        place = stops[-1] if len(stops) else place
    return Curves(points[:place], np.concatenate(starts))


@njit
def _unpack(data, ends, stop, raw):
    """Copy the points of the curves to `raw` (N, 16), each up to `stop`."""
    for c in range(len(stop)):
        place, first = np.uint64(ends[c] + HEADER), np.uint64(ends[c + 1])
        i = np.uint64(stop[c]) - (first - place) // np.uint64(POINT)
        while place < first:
            for k in range(np.uint64(POINT)):
                raw[i, k] = data[place + k]
            place, i = place + np.uint64(POINT), i + np.uint64(1)
