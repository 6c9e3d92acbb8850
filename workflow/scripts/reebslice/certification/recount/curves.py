"""The curves of the contours as one array of points, and what is measured along them."""

from typing import NamedTuple

import numpy as np
import shapely

from ...kernels import njit
from .ranges import expand_ranges

# Of a plain line string as well-known binary: little-endian, its type, the number of points, then the points.
HEAD = np.frombuffer(b"\x01\x02\x00\x00\x00", np.uint8)
START, POINT = 9, 16


class Curves(NamedTuple):
    """C closed curves: points (N, 2), and where each begins, first (C + 1,); each ends where it began."""

    points: np.ndarray
    first: np.ndarray

    def pick(self, rows):
        """Pick the points of some curves.

        Parameters
        ----------
        rows : (k,) int
            The curves.

        Returns
        -------
        points : (N, 2) float64
        index : (N,) int
            Of each point the place of its curve in `rows`.
        """
        index, place = expand_ranges(self.first[rows], self.first[rows + 1])
        return self.points[place], index

    def lines(self, rows):
        """Make line strings of some of the curves.

        Parameters
        ----------
        rows : sequence of int

        Returns
        -------
        (k,) shapely.LineString
        """
        points, index = self.pick(np.asarray(rows, np.int64))
        return shapely.linestrings(points, indices=index)


def read_curves(blocks, room=0):
    """Read curves from well-known binary.

    Parameters
    ----------
    blocks : iterable of pyarrow.Array
        One after the other.
    room : int
        How many points there may be, so that their array need not grow.

    Returns
    -------
    curves : Curves
    drawn : (C,) bool
        Which are line strings in the plane, little-endian, of at least two
        points, finite and closed. The others have no points.
    """
    points, end, counts, drawn = np.empty(2 * room), 0, [np.empty(0, np.int64)], [np.empty(0, bool)]
    for block in blocks:
        # where each value begins and the last one ends
        offsets = np.frombuffer(block.buffers()[1], np.int32)[block.offset : block.offset + len(block) + 1]
        sizes = np.diff(offsets)
        counts.append(np.where((sizes >= START + 2 * POINT) & (sizes % POINT == START), (sizes - START) // POINT, 0))
        drawn.append(counts[-1] > 0)
        begin, end = end, end + 2 * counts[-1].sum()
        if end > len(points):
            points.resize(end, refcheck=False)  # in place, as far as the system can
        data = np.frombuffer(block.buffers()[2] or b"", np.uint8)
        _copy_points(data, offsets, counts[-1], points[begin:end].view(np.uint8), drawn[-1])
    first = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    points = points[:end].reshape(-1, 2)
    return Curves(points, first), np.concatenate(drawn) & _are_closed(points, first)


@njit
def _copy_points(data, offsets, counts, out, drawn):
    """Bytes of the points to `out`; not drawn is what has another head or another number of points."""
    end = 0
    for row in range(len(counts)):
        begin, count = offsets[row], counts[row]
        if count == 0:
            continue
        stated = 0
        for k in range(4):
            stated += np.int64(data[begin + len(HEAD) + k]) << (8 * k)
        drawn[row] = stated == count
        for k in range(len(HEAD)):
            drawn[row] &= data[begin + k] == HEAD[k]
        for place in range(begin + START, offsets[row + 1]):
            out[end] = data[place]
            end += 1


def _are_closed(points, first):
    """Whether each curve ends where it began and has only finite coordinates, (C,)."""
    closed = np.diff(first) > 1
    closed[closed] = (points[first[:-1][closed]] == points[first[1:][closed] - 1]).all(axis=1)
    odd = np.flatnonzero(~np.isfinite(points.ravel())) // 2
    closed[np.searchsorted(first, odd, side="right") - 1] = False
    return closed


@njit
def measure_curves(points, first):
    """Measure closed curves.

    Parameters
    ----------
    points, first
        Of :class:`Curves`.

    Returns
    -------
    area, perimeter : (C,) float64
        The area is negative for curves drawn clockwise.
    centre : (C, 2) float64
        The centre of gravity of the curve.
    boxes : (C, 4) float64
        Lower x and y, upper x and y.
    """
    n = len(first) - 1
    area, perimeter, centre, boxes = np.zeros(n), np.zeros(n), np.zeros((n, 2)), np.zeros((n, 4))
    for c in range(n):
        x, y = points[first[c], 0], points[first[c], 1]  # seen from here, nothing cancels far from the origin
        low_x, low_y, high_x, high_y, total, length, mx, my = x, y, x, y, 0.0, 0.0, 0.0, 0.0
        for k in range(first[c], first[c + 1] - 1):
            low_x, high_x = min(low_x, points[k, 0]), max(high_x, points[k, 0])
            low_y, high_y = min(low_y, points[k, 1]), max(high_y, points[k, 1])
            px, py, qx, qy = points[k, 0] - x, points[k, 1] - y, points[k + 1, 0] - x, points[k + 1, 1] - y
            step = np.sqrt((qx - px) * (qx - px) + (qy - py) * (qy - py))
            total += 0.5 * (px * qy - py * qx)
            length += step
            mx += step * (px + qx) / 2
            my += step * (py + qy) / 2
        whole = length if length > 0 else 1.0
        area[c], perimeter[c] = total, length
        centre[c, 0], centre[c, 1] = x + mx / whole, y + my / whole
        boxes[c, 0], boxes[c, 1], boxes[c, 2], boxes[c, 3] = low_x, low_y, high_x, high_y
    return area, perimeter, centre, boxes


@njit
def look(points, first, curve, spots, reach):
    """Look at a closed curve from each of some spots.

    Parameters
    ----------
    points, first
        Of :class:`Curves`.
    curve : (q,) int
        The curve that each spot looks at.
    spots : (q, 2) float64
    reach : float
        How far to look: what is further away is told to be this far.

    Returns
    -------
    inside : (q,) bool
    near : (q,) float64
        The distance to the curve.
    """
    inside, nearest = np.zeros(len(spots), np.bool_), np.full(len(spots), reach)
    for i in range(len(spots)):
        x, y, near = spots[i, 0], spots[i, 1], reach
        for k in range(first[curve[i]], first[curve[i] + 1] - 1):
            py, qy = points[k, 1] - y, points[k + 1, 1] - y
            if min(py, qy) > near or max(py, qy) < -near:
                continue  # neither near nor across the ray along +x
            px, qx = points[k, 0] - x, points[k + 1, 0] - x
            dx, dy = qx - px, qy - py
            if (py > 0) != (qy > 0) and px - py * dx / dy > 0:
                inside[i] = not inside[i]
            if min(px, qx) < near and max(px, qx) > -near:
                length = dx * dx + dy * dy
                share = min(max(-(px * dx + py * dy) / length, 0.0), 1.0) if length > 0 else 0.0
                near = min(near, np.hypot(px + share * dx, py + share * dy))
        nearest[i] = near
    return inside, nearest
