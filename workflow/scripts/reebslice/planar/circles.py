"""Room inside regions: the distance to their outlines, and the largest circles in them."""

import numpy as np
from numba import njit

# Cells that the search for one circle may divide; only slivers need more, and get a smaller circle.
MOST_CELLS = 20_000
# Runs into which an outline is divided, about, and so many segments of one that all are looked at.
RUNS, FEW = 128, 4


def clearances(outlines, points):
    """Distance of a point to the outline of each region, negative outside, 0 where there is none: (R,) float64.

    outlines : :class:`outlines.Outlines` of R regions; points : (R, 2).
    """
    return _clearances(outlines.points, outlines.ring, outlines.start, np.ascontiguousarray(points, float))


def largest_circles(outlines, tolerance):
    """Centres (R, 2) and radii (R,) of the largest inscribed circles; NaN and 0 where there is no outline.

    No circle in a region is larger than its radius + tolerance; tolerance :
    (R,). The square around the region is divided into quarters for as long as
    the distance at a cell's centre, and how far its corners are, leave room
    for a larger circle (as the pole of inaccessibility is found, and GEOS
    finds it). Quarters inherit the few parts of the outline that can be nearest
    to any of their points.
    """
    return _largest_circles(outlines.points, outlines.ring, outlines.start, tolerance)


@njit(cache=True)
def nearest_point(points, ring, first, end, x, y):
    """Signed distance of (x, y) to the rings `first` to `end`, negative outside, and the nearest point on them."""
    least, foot_x, foot_y, inside = np.inf, x, y, False
    for q in range(first, end):
        for i in range(ring[q], ring[q + 1] - 1):
            squared, along = _square_distance(points, i, x, y)
            if squared < least:
                least = squared
                foot_x = points[i, 0] + along * (points[i + 1, 0] - points[i, 0])
                foot_y = points[i, 1] + along * (points[i + 1, 1] - points[i, 1])
            inside ^= _is_crossed(points, i, x, y)
    distance = np.hypot(x - foot_x, y - foot_y) if first < end else 0.0
    return distance if inside else -distance, foot_x, foot_y


@njit(cache=True, inline="always")
def _square_distance(points, i, x, y):
    """Of (x, y) and the segment from point i to i + 1, and at which share of that it is nearest."""
    dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
    px, py = x - points[i, 0], y - points[i, 1]
    squared = dx * dx + dy * dy
    along = min(max((px * dx + py * dy) / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    px, py = px - along * dx, py - along * dy
    return px * px + py * py, along


@njit(cache=True, inline="always")
def _is_crossed(points, i, x, y):
    """Whether the ray from (x, y) to the right crosses the segment from point i to i + 1."""
    y0, y1 = points[i, 1], points[i + 1, 1]
    if (y0 > y) == (y1 > y):
        return False
    return x < points[i, 0] + (y - y0) / (y1 - y0) * (points[i + 1, 0] - points[i, 0])


@njit(cache=True)
def _clearances(points, ring, start, places):
    out = np.zeros(len(places))
    for r in range(len(places)):
        out[r] = nearest_point(points, ring, start[r], start[r + 1], places[r, 0], places[r, 1])[0]
    return out


@njit(cache=True)
def _largest_circles(points, ring, start, tolerance):
    centre, radius = np.full((len(tolerance), 2), np.nan), np.zeros(len(tolerance))
    pool = np.empty(1024, np.int64)
    for r in range(len(tolerance)):
        if start[r] < start[r + 1]:
            runs, box, longest, square = _divide_outline(points, ring, start[r], start[r + 1])
            x, y, d, pool = _largest_circle(points, runs, box, longest, square, tolerance[r], pool)
            centre[r, 0], centre[r, 1], radius[r] = x, y, d
    return centre, radius


@njit(cache=True)
def _divide_outline(points, ring, first, end):
    """Runs of consecutive segments, (B, 2), their boxes, (B, 4), longest segments, (B,), and the square around all.

    A run goes from one point to another, the larger the outline the longer.
    A box is given by its middle, its half diagonal, and its half height; the
    square by its middle and half its width.
    """
    size = 1 + (ring[end] - ring[first]) // RUNS
    runs, box, n = np.empty((RUNS + end - first + 1, 2), np.int64), np.empty((RUNS + end - first + 1, 4)), 0
    longest = np.empty(len(box))
    left, right, bottom, top = np.inf, -np.inf, np.inf, -np.inf
    for q in range(first, end):
        for i in range(ring[q], ring[q + 1] - 1, size):
            stop = min(i + size, ring[q + 1] - 1)
            low_x, low_y, high_x, high_y = points[i, 0], points[i, 1], points[i, 0], points[i, 1]
            longest[n] = 0.0
            for k in range(i + 1, stop + 1):
                dx, dy = points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1]
                longest[n] = max(longest[n], dx * dx + dy * dy)
                low_x, high_x = min(low_x, points[k, 0]), max(high_x, points[k, 0])
                low_y, high_y = min(low_y, points[k, 1]), max(high_y, points[k, 1])
            left, right, bottom, top = min(left, low_x), max(right, high_x), min(bottom, low_y), max(top, high_y)
            runs[n, 0], runs[n, 1] = i, stop
            box[n, 0], box[n, 1] = 0.5 * (low_x + high_x), 0.5 * (low_y + high_y)
            box[n, 2], box[n, 3] = 0.5 * np.hypot(high_x - low_x, high_y - low_y), 0.5 * (high_y - low_y)
            n += 1
    box[:n, 2:] *= 1.0 + 1e-9  # of rounding nothing may fall out
    square = 0.5 * (left + right), 0.5 * (bottom + top), 0.5 * max(right - left, top - bottom)
    return runs[:n], box[:n], np.sqrt(longest[:n]) * (1.0 + 1e-9), square


@njit(cache=True)
def _least_squares(points, runs, box, longest, chosen, x, y, bound, out):
    """Fill in the squares of the distances of four places (x, y) to the nearest of the `chosen` runs.

    Of most runs that are long their boxes, and then the ends of their segments, tell
    that they are nearest to none. bound : room for four numbers.
    """
    bound[:], out[:] = np.inf, np.inf
    prune = runs[0, 1] - runs[0, 0] > FEW
    for k in range(len(chosen) if prune else 0):
        b = chosen[k]
        for q in range(4):
            dx, dy = x[q] - box[b, 0], y[q] - box[b, 1]
            bound[q] = min(bound[q], np.sqrt(dx * dx + dy * dy) + box[b, 2])
    for k in range(len(chosen)):
        b = chosen[k]
        if not prune:
            for i in range(runs[b, 0], runs[b, 1]):
                for q in range(4):
                    out[q] = min(out[q], _square_distance(points, i, x[q], y[q])[0])
        elif _comes_near(x, y, box[b, 0], box[b, 1], bound, box[b, 2]):
            for i in range(runs[b, 0], runs[b, 1]):
                if _comes_near(x, y, points[i, 0], points[i, 1], bound, longest[b]):
                    for q in range(4):
                        out[q] = min(out[q], _square_distance(points, i, x[q], y[q])[0])
            for q in range(4):
                bound[q] = min(bound[q], np.sqrt(out[q]) * (1.0 + 1e-9))


@njit(cache=True, inline="always")
def _comes_near(x, y, to_x, to_y, bound, reach):
    """Whether one of four places is no further from another one than its bound and what reaches around that."""
    near = False
    for q in range(4):
        dx, dy, far = x[q] - to_x, y[q] - to_y, bound[q] + reach
        near |= dx * dx + dy * dy <= far * far
    return near


@njit(cache=True)
def _is_inside(points, runs, box, x, y):
    """Whether (x, y) is inside: as many segments to its right pass its height upward as downward, but for one."""
    inside = False
    for b in range(len(runs)):
        if abs(y - box[b, 1]) > box[b, 2] or x > box[b, 0] + box[b, 2]:
            continue
        if x < box[b, 0] - box[b, 2]:  # all is to the right: only its ends count
            inside ^= (points[runs[b, 0], 1] > y) != (points[runs[b, 1], 1] > y)
        else:
            for i in range(runs[b, 0], runs[b, 1]):
                inside ^= _is_crossed(points, i, x, y)
    return inside


@njit(cache=True)
def _largest_circle(points, runs, box, longest, square, tolerance, pool):
    """Centre and radius of one circle, and the pool, which holds lists of runs and may have grown."""
    x, y, half = square
    if len(runs) > len(pool):
        pool = np.empty(len(runs), np.int64)
    pool[: len(runs)] = np.arange(len(runs))
    close = np.empty(len(runs), np.int64)
    places, squares, bound = np.empty((2, 4)), np.empty(4), np.empty(4)
    places[0], places[1] = x, y
    _least_squares(points, runs, box, longest, pool[: len(runs)], places[0], places[1], bound, squares)
    best_x, best_y, best = x, y, np.sqrt(squares[0])
    if not _is_inside(points, runs, box, x, y):
        best = -best
    # cells to divide: middle, signed distance there, half the width; the list of runs
    cells, lists, height = np.empty((256, 4)), np.empty((256, 2), np.int64), 1
    cells[0, 0], cells[0, 1], cells[0, 2], cells[0, 3], lists[0, 0], lists[0, 1] = x, y, best, half, 0, len(runs)
    for _ in range(MOST_CELLS):
        if height == 0:
            break
        height -= 1
        x, y, d, half = cells[height, 0], cells[height, 1], cells[height, 2], 0.5 * cells[height, 3]
        begin, stop = lists[height, 0], lists[height, 1]
        step = np.sqrt(2.0) * half  # to the middle of a quarter; its corners are as far again
        if d + 2.0 * step <= best + tolerance:
            continue
        while 2 * stop - begin > len(pool):
            pool = np.concatenate((pool, np.empty(len(pool), np.int64)))
        # what is farther is nearest to none of the quarters' middles, and to no point of the cell
        near, reach, kept, m = (abs(d) + 2.0 * step) * (1.0 + 1e-9), (abs(d) + 4.0 * step) * (1.0 + 1e-9), stop, 0
        for k in range(begin, stop):
            b = pool[k]
            square = (x - box[b, 0]) * (x - box[b, 0]) + (y - box[b, 1]) * (y - box[b, 1])
            if square <= (reach + box[b, 2]) * (reach + box[b, 2]):
                pool[kept] = b
                kept += 1
            if square <= (near + box[b, 2]) * (near + box[b, 2]):
                close[m] = b
                m += 1
        for quarter in range(4):
            places[0, quarter] = x + (half if quarter & 1 else -half)
            places[1, quarter] = y + (half if quarter & 2 else -half)
        _least_squares(points, runs, box, longest, close[:m], places[0], places[1], bound, squares)
        base = height
        for quarter in range(4):
            cx, cy = places[0, quarter], places[1, quarter]
            distance = np.sqrt(squares[quarter])
            # farther from the outline than from each other, both middles are on the same side of it
            if not (d > 0.0 if abs(d) > 1.01 * step else _is_inside(points, runs, box, cx, cy)):
                distance = -distance
            if distance > best:
                best_x, best_y, best = cx, cy, distance
            if distance + step > best + tolerance:
                cells[height, 0], cells[height, 1], cells[height, 2], cells[height, 3] = cx, cy, distance, half
                lists[height, 0], lists[height, 1] = stop, kept
                height += 1
        for place in range(base, height - 1):  # the most promising one comes next
            if cells[place, 2] > cells[height - 1, 2]:
                for k in range(4):
                    cells[place, k], cells[height - 1, k] = cells[height - 1, k], cells[place, k]
    return best_x, best_y, best, pool
