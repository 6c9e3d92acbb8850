"""Regions of material at each level."""

from typing import NamedTuple

import numpy as np

from ..arrays.components import connected_items
from .contours import measure_contours
from .exact_contours import ExactContours
from .nesting import nest_contours

# Of the largest coordinate: no crossing is computed further from its place. Interpolation
# takes a handful of operations, each of which errs by half of 2^-52.
ROUNDING = 64 * np.finfo(float).eps


class Regions(NamedTuple):
    """R regions, ordered by level and then by their outer contour, and what it takes to find them.

    Attributes
    ----------
    level, outer : (R,) int32
        The level and the outer contour of each region.
    of_contour : (C,) int32
        The region that each contour bounds.
    inner : (C,) bool
        Whether a contour bounds a hole.
    parent : (C,) int32
        The smallest contour around each one, -1 for none.
    area, perimeter : (C,) float64
        Of the contours; areas of holes are negative but for rounding.
    """

    level: np.ndarray
    outer: np.ndarray
    of_contour: np.ndarray
    inner: np.ndarray
    parent: np.ndarray
    area: np.ndarray
    perimeter: np.ndarray


def find_regions(mesh, levels, contours, body, pieces=None):
    """Find the regions of material at each level.

    Parameters
    ----------
    mesh : HeightMesh
        The surface.
    levels : Levels
        The cuts.
    contours : Contours
        Their C contours.
    body : (C,) int
        The body of each contour's shell. A hole belongs to the smallest outer contour around it of the same
        body, so bodies that overlap stay apart.
    pieces : Pieces, optional
        Where the surface crosses itself, contours alone leave open what a hole belongs to, and the pieces settle
        it; elsewhere they make no difference.

    Returns
    -------
    Regions
        What is closer than rounding is decided in rational numbers.
    """
    area, perimeter = measure_contours(contours)
    rounding = ROUNDING * max(mesh.points.max(), -mesh.points.min())
    exact = ExactContours(mesh, levels, contours)
    chain = np.arange(len(area)) if pieces is None else _cylinder_chains(pieces, len(area))
    inner = _inner_contours(exact, chain, area, perimeter, rounding)
    parent, outer, unsure = nest_contours(contours, np.abs(area), perimeter, inner, body, rounding)
    _nest_exactly(exact, np.flatnonzero(unsure), contours.level, inner, body, parent, outer)
    size = np.abs(area)
    for hole in np.flatnonzero(inner & (outer < 0)):
        outer[hole] = _nearest_outer(hole, contours.level, pieces, size, inner, body)
    head = np.where(inner & (outer >= 0), outer, np.arange(len(inner)))
    outers = np.flatnonzero(head == np.arange(len(head))).astype(np.int32)
    name = np.full(len(head), -1, np.int32)
    name[outers] = np.arange(len(outers), dtype=np.int32)
    return Regions(contours.level[outers], outers, name[head], inner, parent, area, perimeter)


def _inner_contours(exact, chain, area, perimeter, rounding):
    """Whether each contour is a hole: (C,) bool.

    Along a chain of cylinders an outer contour stays outer and a hole stays a
    hole, so the chain is decided at once, by its contour whose area is
    largest for its perimeter: rounding never turns a tiny contour around. A
    chain whose contours all enclose no more than rounding, as those inside
    flats do, is decided by its shortest contour in exact numbers.
    """
    certain = np.abs(area) > rounding * (perimeter + rounding)
    roundness = np.divide(area, perimeter**2, out=np.zeros_like(area), where=certain)
    order = np.lexsort((-np.diff(exact.contours.start), np.abs(roundness), chain))
    surest = order[np.flatnonzero(np.diff(chain[order], append=-1))]
    inner = np.zeros(len(area), bool)
    inner[chain[surest]] = area[surest] < 0
    for contour in surest[~certain[surest]].tolist():
        inner[chain[contour]] = exact.is_hole(contour)
    return inner[chain]


def _nest_exactly(exact, unsure, level, inner, body, parent, outer):
    """Fill in `parent` and `outer` of the contours for which floats do not suffice."""
    for contour in unsure.tolist():
        first, end = _beside(level, contour)
        around = np.array(exact.around(contour, range(first, end), inner), np.int64)
        hosts = around[~inner[around] & (body[around] == body[contour])]
        parent[contour] = around[0] if len(around) else -1
        outer[contour] = hosts[0] if len(hosts) else -1


def _beside(level, contour):
    """First and end of the contours at the level of one."""
    return np.searchsorted(level, np.array([level[contour], level[contour] + 1], level.dtype))


def _nearest_outer(hole, level, pieces, size, inner, body):
    """The outer contour for a hole that lies in none: (-1: there is none at its level).

    Only a surface that crosses itself has such holes. Taken is an outer
    contour that bounds the same piece, if known, else the largest of the body.
    """
    first, end = _beside(level, hole)
    others = first + np.flatnonzero(~inner[first:end] & (body[first:end] == body[hole]))
    if len(others) == 0:
        return -1
    if pieces is None:
        return int(others[np.argmax(size[others])])
    joined = (pieces.piece_above[others] == pieces.piece_above[hole]) | (
        pieces.piece_below[others] == pieces.piece_below[hole]
    )
    return int(others[np.lexsort((size[others], joined))[-1]])


def _cylinder_chains(pieces, n_contours):
    """The chain of each contour, (C,): contours that cylinders, one on top of the other, hold together."""
    cylinder = (pieces.n_below == 1) & (pieces.n_above == 1) & (pieces.genus == 0)
    low = np.full(len(cylinder), -1, np.int64)
    low[pieces.piece_above] = np.arange(n_contours)
    high = np.full(len(cylinder), -1, np.int64)
    high[pieces.piece_below] = np.arange(n_contours)
    low, high = low[cylinder], high[cylinder]
    return connected_items(low, high, n_contours)
