"""Blocks of the void: components of what is not material between two consecutive levels.

The contours of a level cut its plane into faces, material and void by turns. A
face of the void is named after the contour of the hole that it fills, and one
is the outside, around all. Each piece of the surface separates its slab, and
what is next to it on the side of the void is connected; so the pieces and the
faces that they share tell the components. The outside is one block everywhere.
"""

from typing import NamedTuple

import numpy as np

from ..arrays.components import connected_items


class VoidBlocks(NamedTuple):
    """B blocks of the void between K levels, and its I regions at them.

    Attributes
    ----------
    hole : (H,) int
        The contours of holes: regions 0 to H - 1 are what is inside them and outside of the material in them. The
        others are the outside, which has a region at every level and, as the first and the last, one below all
        levels and one above.
    region : (C,) int
        The region that each contour bounds.
    above, below : (I,) int
        The block on the upper and on the lower side of every region.
    of_piece : (P,) int
        The block that each piece bounds.
    count : int
        Number of blocks. Those below the first and above the last region of the outside have no other region.
    """

    hole: np.ndarray
    region: np.ndarray
    above: np.ndarray
    below: np.ndarray
    of_piece: np.ndarray
    count: int  # type: ignore[assignment]  # a method of tuples is called so


def find_void_blocks(inner, parent, solid, level, piece_above, piece_below, slab, floating):
    """Find the connected components of the void in each slab.

    Parameters
    ----------
    inner, parent, solid, level : (C,)
        Of each contour whether it bounds a hole, the smallest contour around it (-1: none), the region of the solid
        that it bounds, and its level.
    piece_above, piece_below : (C,) int
        The piece on either side of every contour.
    slab : (P,) int
        The slab of every piece.
    floating : (k,) int
        Pieces that are bodies wholly inside a slab. Contours do not show what they float in; they count as in
        the outside, which they change nothing about.

    Returns
    -------
    VoidBlocks or None
        None where faces do not take turns, because the surface crosses itself or bodies share material: what is
        void is then not for contours to say.
    """
    around = np.maximum(parent, 0)
    turns = np.where(parent < 0, ~inner, (inner != inner[around]) & (~inner | (solid == solid[around])))
    if not turns.all():
        return None
    hole, n_levels = np.flatnonzero(inner), int(slab.max()) + 1
    name = np.full(len(inner), -1)
    name[hole] = np.arange(len(hole))
    outside = len(hole) + 1 + np.arange(-1, n_levels + 1)
    region = np.where(inner, name, np.where(parent < 0, outside[level + 1], name[around]))
    # pieces come first, then the upper sides of the regions, then the lower ones
    up, n_regions = len(slab), len(hole) + len(outside)
    down = up + n_regions
    ends = np.concatenate([up + region, down + region, up + outside[:-1], up + outside[slab[floating] + 1]])
    others = np.concatenate([piece_above, piece_below, down + outside[1:], floating])
    block = connected_items(ends, others, down + n_regions)
    return VoidBlocks(hole, region, block[up:down], block[down:], block[:up], int(block.max()) + 1)
