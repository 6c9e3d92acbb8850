"""Closed curves in the plane, as they are stored: WKB line strings, one after another."""

import struct

import numpy as np
from numba import njit

# Byte order (1: little-endian), geometry type (2: line string), number of points.
_HEADER = struct.Struct("<BII")


def pack_curves(points, start):
    """Curves as WKB line strings: a list of C bytes. points : (N, 2); start : (C + 1,)."""
    data, place = np.ascontiguousarray(points, "<f8").tobytes(), start.tolist()
    return [_HEADER.pack(1, 2, b - a) + data[16 * a : 16 * b] for a, b in zip(place[:-1], place[1:])]


def unpack_curves(packed):
    """The points (N, 2) and start (C + 1,) of curves packed by :func:`pack_curves`; packed : (C,) bytes."""
    start = np.zeros(len(packed) + 1, np.int64)
    np.cumsum([(len(curve) - _HEADER.size) // 16 for curve in packed], out=start[1:])
    return np.frombuffer(b"".join([curve[_HEADER.size :] for curve in packed]), "<f8").reshape(-1, 2), start


@njit(cache=True)
def close_curves(points, start):
    """The curves closed, coinciding neighbours dropped: points (N, 2), start (C + 1,).

    points : (X, 2); start : (C + 1,), each curve has a point. A curve of which
    only one point remains is closed onto itself.
    """
    count = len(start) - 1
    kept, closed = np.empty((len(points) + count, 2)), np.zeros(count + 1, np.int64)
    n = 0
    for c in range(count):
        before = start[c + 1] - 1
        for i in range(start[c], start[c + 1]):
            if points[i, 0] != points[before, 0] or points[i, 1] != points[before, 1]:
                kept[n] = points[i]
                n += 1
            before = i
        if n == closed[c]:
            kept[n] = points[start[c]]
            n += 1
        kept[n] = kept[closed[c]]
        n += 1
        closed[c + 1] = n
    return kept[:n], closed


@njit(cache=True)
def curve_centres(points, start):
    """Centroids of the curves as lines, (C, 2); points : (N, 2) of closed curves; start : (C + 1,)."""
    centre = np.empty((len(start) - 1, 2))
    for c in range(len(centre)):
        length, x, y = 0.0, 0.0, 0.0
        for i in range(start[c], start[c + 1] - 1):
            dx, dy = points[i, 0] - points[i + 1, 0], points[i, 1] - points[i + 1, 1]
            step = np.sqrt(dx * dx + dy * dy)
            if step == 0.0:
                continue
            length += step
            x += step * ((points[i, 0] + points[i + 1, 0]) / 2)
            y += step * ((points[i, 1] + points[i + 1, 1]) / 2)
        centre[c] = points[start[c]]
        if length > 0.0:
            centre[c, 0], centre[c, 1] = x / length, y / length
    return centre
