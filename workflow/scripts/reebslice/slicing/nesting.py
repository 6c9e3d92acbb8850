"""Which contours of a level lie inside which."""

import numpy as np

from ..arrays.sorting import order_floats, sort_floats
from ..kernels import njit

FEW = 16  # contours at a level that are all held against each other


def nest_contours(contours, size, perimeter, inner, body, rounding):
    """Find the contours around each contour.

    Contours are disjoint, so a contour is tested by a point inside it, and
    what is around it is larger. Only contours whose boxes hold the point are
    looked at, and to find these a level of many contours is cut into vertical
    strips.

    Parameters
    ----------
    contours : Contours
        C contours.
    size, perimeter : (C,) float64
        Area without its sign, and length.
    inner : (C,) bool
        Whether each bounds a hole.
    body : (C,) int
        The body of each.
    rounding : float
        No point is further from its place.

    Returns
    -------
    parent : (C,) int32
        The smallest contour around each, -1 for none.
    outer : (C,) int32
        The smallest outer contour of the same body around each, -1 for none.
    unsure : (C,) bool
        Whether floats do not suffice: the point is no further than `rounding` from the other contour, or the
        sizes differ by no more. Its `parent` and `outer` are then not to be used.
    """
    return _nest(contours.level, contours.start, contours.points, size, perimeter, inner, body, rounding)


@njit
def _nest(level, start, points, size, perimeter, inner, body, rounding):
    """Kernel of `nest_contours`."""
    n = len(level)
    box, probe, probed = _boxes(points, start), np.empty((n, 2)), np.zeros(n, np.bool_)
    parent, outer, unsure = np.full(n, -1, np.int32), np.full(n, -1, np.int32), np.zeros(n, np.bool_)
    first = 0
    while first < n:
        end = first
        while end < n and level[end] == level[first]:
            end += 1
        around = order_floats(size[first:end])
        for i in range(len(around)):
            around[i] += first
        left, scale, strips, members = _cut_into_strips(box, around, rounding)
        for c in range(first, end):
            strip = 0
            if len(strips) > 2:
                _find_probe(points, start, box, c, probe, probed)
                strip = _strip_of(probe[c, 0], left, scale, len(strips) - 1)
            for e in members[strips[strip] : strips[strip + 1]]:
                slack = rounding * (perimeter[c] + perimeter[e] + rounding)
                if e == c or size[e] < size[c] - slack or not _may_enclose(box[e], box[c], rounding):
                    continue
                _find_probe(points, start, box, c, probe, probed)
                x, y = probe[c]
                if not _may_enclose(box[e], (x, y, x, y), rounding):
                    continue
                same_body = body[e] == body[c] and not inner[e]
                if parent[c] >= 0 and not same_body:
                    continue
                encloses, near = _encloses(points[start[e] : start[e + 1]], x, y, rounding)
                if near or (encloses and size[e] <= size[c] + slack):
                    unsure[c] = True
                    break
                if encloses:
                    if parent[c] < 0:
                        parent[c] = e
                    if same_body:
                        outer[c] = e
                        break
        first = end
    return parent, outer, unsure


@njit(inner=True)
def _cut_into_strips(box, chosen, rounding):
    """Vertical strips of equal width; members[strips[s]:strips[s + 1]] are the chosen contours in strip s, in order.

    Returns left, scale : what `_strip_of` needs; strips, members. As many strips
    as contours, or fewer, so that a contour is in some twenty at most on average.
    """
    left, right, width, count, scale = np.inf, -np.inf, 0.0, 1, 0.0
    for e in chosen:
        left, right = min(left, box[e, 0] - rounding), max(right, box[e, 2] + rounding)
        width += box[e, 2] - box[e, 0]
    if len(chosen) > FEW and right - left > rounding:
        share = max(width / (right - left) / len(chosen), 1e-9)  # of the strips, that a contour is in on average
        count = max(1, int(min(float(len(chosen)), 20.0 / share)))
        scale = count / (right - left)
    strips = np.zeros(count + 1, np.int64)
    for e in chosen:
        for s in range(*_range_of_strips(box[e], rounding, left, scale, count)):
            strips[s + 1] += 1
    for s in range(count):
        strips[s + 1] += strips[s]
    fill, members = strips[:-1].copy(), np.empty(strips[-1], np.int64)
    for e in chosen:
        for s in range(*_range_of_strips(box[e], rounding, left, scale, count)):
            members[fill[s]] = e
            fill[s] += 1
    return left, scale, strips, members


@njit(inline="always")
def _range_of_strips(box, rounding, left, scale, count):
    """The first strip that a box is in, and the end."""
    return _strip_of(box[0] - rounding, left, scale, count), _strip_of(box[2] + rounding, left, scale, count) + 1


@njit(inline="always")
def _strip_of(x, left, scale, count):
    """The strip that x is in, ascending with x."""
    return int(min(max((x - left) * scale, 0.0), count - 1.0))


@njit(inline="always")
def _find_probe(points, start, box, c, probe, probed):
    """Fill in the point inside contour c, once."""
    if not probed[c]:
        x, y = _point_inside(points[start[c] : start[c + 1]], 0.5 * (box[c, 1] + box[c, 3]))
        probe[c, 0], probe[c, 1] = x, y
        probed[c] = True


@njit
def _boxes(points, start):
    """Smallest x, y and largest x, y of every contour, (C, 4)."""
    box = np.empty((len(start) - 1, 4))
    for c in range(len(box)):
        left, low = points[start[c]]
        right, high = left, low
        for i in range(start[c], start[c + 1]):
            x, y = points[i]
            left, low, right, high = min(left, x), min(low, y), max(right, x), max(high, y)
        box[c, 0], box[c, 1], box[c, 2], box[c, 3] = left, low, right, high
    return box


@njit(inline="always")
def _may_enclose(box, other, rounding):
    """Whether two boxes meet, but for rounding."""
    return (
        other[2] >= box[0] - rounding and other[0] <= box[2] + rounding
        and other[3] >= box[1] - rounding and other[1] <= box[3] + rounding
    )  # fmt: skip


@njit(inner=True)
def _point_inside(ring, middle):
    """The middle of the widest stretch inside a ring on a line halfway up.

    The line runs near y = `middle`, between two of its points' y, so it meets none of them. A
    ring that is all in one line gives the middle of its longest segment.
    """
    low, high = -np.inf, np.inf
    for i in range(len(ring)):
        if ring[i, 1] <= middle:
            low = max(low, ring[i, 1])
        else:
            high = min(high, ring[i, 1])
    y = 0.5 * (low + high)
    hits = np.empty(len(ring))
    count = 0
    longest, x_longest, y_longest = -1.0, 0.0, 0.0
    for i in range(len(ring)):
        (px, py), (qx, qy) = ring[i - 1], ring[i]
        if (py > y) != (qy > y):
            hits[count] = px + (y - py) / (qy - py) * (qx - px)
            count += 1
        length = (qx - px) ** 2 + (qy - py) ** 2
        if length > longest:
            longest, x_longest, y_longest = length, 0.5 * (px + qx), 0.5 * (py + qy)
    stretches = hits[:count]
    sort_floats(stretches)
    widest, x = 0.0, x_longest
    for i in range(0, count - 1, 2):
        if stretches[i + 1] - stretches[i] > widest:
            widest, x = stretches[i + 1] - stretches[i], 0.5 * (stretches[i] + stretches[i + 1])
    return x, (y if widest > 0.0 else y_longest)


@njit(inline="always")
def _encloses(ring, x, y, rounding):
    """Whether a ring runs around (x, y), and whether it passes it within `rounding`."""
    inside = False
    px, py = ring[-1]
    for i in range(len(ring)):
        qx, qy = ring[i]
        if min(py, qy) <= y + rounding and max(py, qy) >= y - rounding and max(px, qx) >= x - rounding:
            ux, uy, vx, vy = qx - px, qy - py, x - px, y - py
            length = ux * ux + uy * uy
            along = min(max((ux * vx + uy * vy) / length, 0.0), 1.0) if length > 0.0 else 0.0
            if abs(along * ux - vx) <= rounding and abs(along * uy - vy) <= rounding:
                return inside, True
            if (py > y) != (qy > y) and (ux * vy > vx * uy) == (qy > py):
                inside = not inside
        px, py = qx, qy
    return inside, False
