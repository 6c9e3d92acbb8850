"""A grid of grids over the faces of a surface, to find those that a level and a line may cross together.

A face takes up an interval of ranks and one of the offset from lines of one
direction: a rectangle. Grids of 1, 2, 4, ... rows and as many columns are laid
over all, each number of rows with each number of columns, and a face is listed
in the finest one in which it is in at most two rows and two columns. So there
are at most four entries for each face, however long and thin it is, and what
holds a point is in one cell of each grid. Rows have as many vertices as each
other, so that few faces share one wherever the surface is fine.
"""

from typing import NamedTuple

import numpy as np

from ..kernels import njit


class FaceGrid(NamedTuple):
    """Faces in the cells of all grids.

    Attributes
    ----------
    depth : int
        The finest grid has 2**depth rows, and as many columns.
    low, scale : float
        Column of the finest grid: the offset less `low`, times `scale`.
    start : (4**(depth + 1) + 1,) int32
        Cell c owns ``face[start[c]:start[c + 1]]``. Rows and columns of all grids are numbered as the nodes of a
        binary heap, and the cell is row * 2**(depth + 1) + column.
    face : (E,) int32
        Faces.
    used : (2 (depth + 1)**2,) int64
        Pairs of shifts, of rows and of columns: grids that list any faces, -1 behind the last.
    """

    depth: int
    low: float
    scale: float
    start: np.ndarray
    face: np.ndarray
    used: np.ndarray


@njit
def build_grid(faces, offset, margin):
    """Put faces into the cells of grids.

    Parameters
    ----------
    faces : (m, 3) int32
        Ranks, the lowest corner first.
    offset : (n,) float64
        Offset of every vertex from a line.
    margin : float
        Added to the interval of offsets of each face on both sides.

    Returns
    -------
    FaceGrid
        With one cell of the finest grid for two to eight faces.
    """
    n, depth = len(offset), 0
    while 2 * 4 ** (depth + 1) <= len(faces) and depth < 12:
        depth += 1
    low, high = offset.min(), offset.max()
    scale = (2**depth - 1) / (high - low) if high > low else 0.0
    start, used = np.zeros(4 ** (depth + 1) + 1, np.int32), np.zeros((depth + 1, depth + 1), np.bool_)
    grid = FaceGrid(depth, low, scale, start, np.empty(0, np.int32), np.empty(0, np.int64))
    for f in range(len(faces)):
        shifts, rows, columns = _cells_of_face(grid, faces[f], offset, margin, n)
        used[shifts] = True
        for row in range(rows[0], rows[1] + 1):
            for column in range(columns[0], columns[1] + 1):
                start[(row << depth + 1) + column] += 1
    total = 0
    for cell in range(len(start)):
        total += start[cell]
        start[cell] = total
    face = np.empty(total, np.int32)
    for f in range(len(faces) - 1, -1, -1):
        _, rows, columns = _cells_of_face(grid, faces[f], offset, margin, n)
        for row in range(rows[0], rows[1] + 1):
            for column in range(columns[0], columns[1] + 1):
                cell = (row << depth + 1) + column
                start[cell] -= 1
                face[start[cell]] = f
    pairs = np.full(2 * used.size, -1)
    place = 0
    for one in range(depth + 1):
        for other in range(depth + 1):
            if used[one, other]:
                pairs[place], pairs[place + 1] = one, other
                place += 2
    return FaceGrid(depth, low, scale, start, face, pairs)


@njit(inline="always")
def _cells_of_face(grid, corners, offset, margin, n):
    """Shifts of the face's grid, and its first and last rows and columns there, as nodes of heaps."""
    a, b, c = corners
    row, last_row = (a << grid.depth) // n, (max(b, c) << grid.depth) // n
    column = column_of(grid, min(offset[a], offset[b], offset[c]) - margin)
    last_column = column_of(grid, max(offset[a], offset[b], offset[c]) + margin)
    down, aside = 0, 0
    while last_row - row > 1:
        row, last_row, down = row >> 1, last_row >> 1, down + 1
    while last_column - column > 1:
        column, last_column, aside = column >> 1, last_column >> 1, aside + 1
    top, left = 1 << grid.depth - down, 1 << grid.depth - aside
    return (down, aside), (top + row, top + last_row), (left + column, left + last_column)


@njit(inline="always")
def column_of(grid, offset):
    """Find the column of an offset in the finest grid.

    Parameters
    ----------
    grid : FaceGrid
    offset : float

    Returns
    -------
    int
    """
    return int(min(max((offset - grid.low) * grid.scale, 0.0), 2.0**grid.depth - 1.0))


@njit
def find_candidates(grid, n, rank, offset, found):
    """List the faces whose rectangles may hold a point.

    Parameters
    ----------
    grid : FaceGrid
    n : int
        Number of vertices.
    rank : int
        Of the point.
    offset : float
        Of the point.
    found : (E,) int32
        Overwritten with the faces.

    Returns
    -------
    int
        How many were found, each once.
    """
    count, row, column = 0, (rank << grid.depth) // n, column_of(grid, offset)
    for place in range(0, len(grid.used), 2):
        down, aside = grid.used[place], grid.used[place + 1]
        if down < 0:
            break
        cell = (1 << grid.depth - down) + (row >> down) << grid.depth + 1
        cell += (1 << grid.depth - aside) + (column >> aside)
        for k in range(grid.start[cell], grid.start[cell + 1]):
            found[count] = grid.face[k]
            count += 1
    return count
