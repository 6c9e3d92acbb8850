"""Room inside regions: the largest circles in them."""

from typing import NamedTuple

import numpy as np

from ..kernels import njit
from .distances import square_distance
from .outline_runs import Square, divide_outline, is_inside

# Cells that the search for one circle may divide; only slivers need more, and get a smaller circle.
MOST_CELLS = 20_000
# So many segments of a run, or fewer, are all looked at.
FEW = 4


class Circle(NamedTuple):
    """A circle; the radius is that of the largest one in the region at this centre, negative outside."""

    x: float
    y: float
    radius: float


class Stack(NamedTuple):
    """Cells that are still to be divided; both arrays are modified.

    Attributes
    ----------
    cell : (256, 4) float64
        Middle, x and y, signed distance to the outline there, half the width.
    runs : (256, 2) int64
        Where in the pool the list of the runs begins and ends that may be nearest to points of the cell.
    """

    cell: np.ndarray
    runs: np.ndarray


class Quarters(NamedTuple):
    """Room for the four quarters of a cell; all arrays are modified.

    Attributes
    ----------
    places : (2, 4) float64
        Their middles, x and y.
    distance : (4,) float64
        Signed distances to the outline there; their squares while they are sought.
    bound : (4,) float64
        What the distances do not exceed.
    close : (B,) int64
        Runs that may be nearest to one of the middles.
    """

    places: np.ndarray
    distance: np.ndarray
    bound: np.ndarray
    close: np.ndarray


def largest_circles(outlines, tolerance):
    """Find the largest circle in each region.

    The square around the region is divided into quarters for as long as the
    distance at a cell's centre, and how far its corners are, leave room for a
    larger circle (as the pole of inaccessibility is found, and GEOS finds it).
    Quarters inherit the few parts of the outline that can be nearest to any of
    their points.

    Parameters
    ----------
    outlines : Outlines
        R regions.
    tolerance : (R,) float64
        Lengths, of the outlines' unit.

    Returns
    -------
    centre : (R, 2) float64
        Centres; NaN where there is no outline.
    radius : (R,) float64
        Radii; 0 where there is no outline. No circle in a region is larger than its radius + tolerance, unless
        it takes more than MOST_CELLS cells to find it, as in slivers.
    """
    return _largest_circles(outlines, tolerance)


@njit
def _largest_circles(outlines, tolerance):
    """Kernel of `largest_circles`."""
    start = outlines.start
    centre, radius = np.full((len(tolerance), 2), np.nan), np.zeros(len(tolerance))
    pool = np.empty(1024, np.int64)
    for r in range(len(tolerance)):
        if start[r] < start[r + 1]:
            outline, square = divide_outline(outlines.points, outlines.ring, start[r], start[r + 1])
            circle, pool = _largest_circle(outline, square, tolerance[r], pool)
            centre[r, 0], centre[r, 1], radius[r] = circle.x, circle.y, circle.radius
    return centre, radius


@njit(inner=True)
def _least_squares(outline, chosen, quarters):
    """Fill in the squares of the distances of the four places to the nearest of the `chosen` runs.

    Of most runs that are long their boxes, and then the ends of their segments, tell
    that they are nearest to none.
    """
    points, runs, box, longest = outline.points, outline.runs, outline.box, outline.longest
    x, y, bound, out = quarters.places[0], quarters.places[1], quarters.bound, quarters.distance
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
                    out[q] = min(out[q], square_distance(points, i, x[q], y[q])[0])
        elif _comes_near(x, y, box[b, 0], box[b, 1], bound, box[b, 2]):
            for i in range(runs[b, 0], runs[b, 1]):
                if _comes_near(x, y, points[i, 0], points[i, 1], bound, longest[b]):
                    for q in range(4):
                        out[q] = min(out[q], square_distance(points, i, x[q], y[q])[0])
            for q in range(4):
                bound[q] = min(bound[q], np.sqrt(out[q]) * (1.0 + 1e-9))


@njit(inline="always")
def _comes_near(x, y, to_x, to_y, bound, reach):
    """Whether one of four places is no further from another one than its bound and what reaches around that."""
    near = False
    for q in range(4):
        dx, dy, far = x[q] - to_x, y[q] - to_y, bound[q] + reach
        near |= dx * dx + dy * dy <= far * far
    return near


@njit(inner=True)
def _largest_circle(outline, square, tolerance, pool):
    """The largest circle in one region, and the pool, which holds lists of runs and may have grown."""
    n = len(outline.runs)
    if n > len(pool):
        pool = np.empty(n, np.int64)
    for k in range(n):
        pool[k] = k
    stack, quarters = _make_stack(), _make_quarters(n)
    best = _circle_at(outline, square, quarters)
    stack.cell[0, 0], stack.cell[0, 1], stack.cell[0, 2], stack.cell[0, 3] = best.x, best.y, best.radius, square.half
    stack.runs[0, 0], stack.runs[0, 1], height = 0, n, 1
    for _ in range(MOST_CELLS):
        if height == 0:
            break
        height -= 1
        distance, begin, stop = stack.cell[height, 2], stack.runs[height, 0], stack.runs[height, 1]
        # the middle of the cell, and half the width of its quarters
        cell = Square(stack.cell[height, 0], stack.cell[height, 1], 0.5 * stack.cell[height, 3])
        if distance + 2.0 * (np.sqrt(2.0) * cell.half) <= best.radius + tolerance:
            continue
        while 2 * stop - begin > len(pool):
            pool = np.concatenate((pool, np.empty(len(pool), np.int64)))
        kept, n_close = _gather_runs(outline, pool, begin, stop, cell, distance, quarters.close)
        _measure_quarters(outline, cell, distance, quarters.close[:n_close], quarters)
        base = height
        best, height = _push_quarters(cell, quarters, stack, height, best, tolerance)
        stack.runs[base:height, 0], stack.runs[base:height, 1] = stop, kept
    return best, pool


@njit(inner=True)
def _make_stack():
    """An empty :class:`Stack`; more cells than it holds would be smaller than a float can tell."""
    return Stack(np.empty((256, 4)), np.empty((256, 2), np.int64))


@njit(inner=True)
def _make_quarters(n_runs):
    """Room for :class:`Quarters`."""
    return Quarters(np.empty((2, 4)), np.empty(4), np.empty(4), np.arange(n_runs))


@njit(inner=True)
def _circle_at(outline, square, quarters):
    """The circle around the middle of the square."""
    quarters.places[0], quarters.places[1] = square.x, square.y
    _least_squares(outline, quarters.close, quarters)
    radius = np.sqrt(quarters.distance[0])
    return Circle(square.x, square.y, radius if is_inside(outline, square.x, square.y) else -radius)


@njit(inner=True)
def _gather_runs(outline, pool, begin, stop, cell, distance, close):
    """Gather the runs that may be nearest to something, of those in the list pool[begin:stop].

    Those that may be nearest to a point of the cell go to pool[stop:kept], and those that may be nearest to
    the middle of a quarter to the first places of `close`. Returns kept, and how many places.
    """
    box, step, kept, n_close = outline.box, np.sqrt(2.0) * cell.half, stop, 0
    # a quarter's middle is `step` away from the cell's, and its corners are as far again
    near, reach = (abs(distance) + 2.0 * step) * (1.0 + 1e-9), (abs(distance) + 4.0 * step) * (1.0 + 1e-9)
    for k in range(begin, stop):
        b = pool[k]
        square = (cell.x - box[b, 0]) * (cell.x - box[b, 0]) + (cell.y - box[b, 1]) * (cell.y - box[b, 1])
        if square <= (reach + box[b, 2]) * (reach + box[b, 2]):
            pool[kept] = b
            kept += 1
        if square <= (near + box[b, 2]) * (near + box[b, 2]):
            close[n_close] = b
            n_close += 1
    return kept, n_close


@njit(inner=True)
def _measure_quarters(outline, cell, distance, close, quarters):
    """Fill in the middles of the quarters of a cell, and their signed distances to the `close` runs."""
    for q in range(4):
        quarters.places[0, q] = cell.x + (cell.half if q & 1 else -cell.half)
        quarters.places[1, q] = cell.y + (cell.half if q & 2 else -cell.half)
    _least_squares(outline, close, quarters)
    # farther from the outline than from each other, both middles are on the same side of it
    same_side, found = abs(distance) > 1.01 * (np.sqrt(2.0) * cell.half), quarters.distance
    for q in range(4):
        found[q] = np.sqrt(found[q])
        if not (distance > 0.0 if same_side else is_inside(outline, quarters.places[0, q], quarters.places[1, q])):
            found[q] = -found[q]


@njit(inner=True)
def _push_quarters(cell, quarters, stack, height, best, tolerance):
    """Push the quarters that leave room for a larger circle, the most promising last: the best circle, the height."""
    base, places, cells = height, quarters.places, stack.cell
    for q in range(4):
        distance = quarters.distance[q]
        if distance > best.radius:
            best = Circle(places[0, q], places[1, q], distance)
        if distance + np.sqrt(2.0) * cell.half > best.radius + tolerance:
            cells[height, 0], cells[height, 1], cells[height, 2] = places[0, q], places[1, q], distance
            cells[height, 3] = cell.half
            height += 1
    for place in range(base, height - 1):
        if cells[place, 2] > cells[height - 1, 2]:
            for k in range(4):
                cells[place, k], cells[height - 1, k] = cells[height - 1, k], cells[place, k]
    return best, height
