"""Blocks and regions as later stages see them: from the tables of the slices."""

import numpy as np

from .curves import pick_curves, unpack_curves
from .outlines import Outlines, mend_outlines


def block_regions(pieces, contours):
    """Regions below and above every block: two lists of ascending id lists."""
    region, block = contours["region"].to_numpy(), pieces["block"].to_numpy().astype(np.int64)
    count = max(count_regions(contours), 1)
    ends = []
    for side in ("below", "above"):
        bounding = pieces[side].combine_chunks()
        owner = np.repeat(block, np.diff(bounding.offsets.to_numpy()))
        pairs = np.unique(owner * count + region[bounding.flatten().to_numpy()])
        members, cuts = (pairs % count).tolist(), np.searchsorted(pairs, count * np.arange(block.max() + 2)).tolist()
        ends.append([members[a:b] for a, b in zip(cuts[:-1], cuts[1:])])
    return ends


def count_regions(contours):
    """The number of regions; none where all levels pass between the parts of a model."""
    return int(contours["region"].to_numpy().max(initial=-1)) + 1


def region_levels(contours):
    """The level of every region, (R,) int32."""
    region = contours["region"].to_numpy()
    level = np.empty(count_regions(contours), np.int32)
    level[region] = contours["level"].to_numpy()
    return level


def contour_curves(contours, geometry):
    """The contours as closed :class:`curves.Curves`, tilted frame.

    geometry : that column of the table, an iterable of Arrow arrays, of which one is held at a time.
    """
    return unpack_curves(geometry, int(contours["n_points"].to_numpy().sum()) + contours.num_rows)


def region_outlines(contours, curves):
    """The valid :class:`outlines.Outlines` of the regions, (R,), tilted frame.

    Contours too small to span a triangle in floating point are left out; a
    region whose outer contour is one of them has no outline.
    """
    region, inner = contours["region"].to_numpy(), contours["inner"].to_numpy(zero_copy_only=False)
    usable, count = _spans_triangle(contours, curves), count_regions(contours)
    has_outer = np.zeros(count, bool)
    has_outer[region[usable & ~inner]] = True
    order = np.flatnonzero(usable & has_outer[region])
    order = order[np.lexsort((inner[order], region[order]))]  # the outer contour first
    start = np.concatenate([[0], np.cumsum(np.bincount(region[order], minlength=count))])
    return mend_outlines(Outlines(*pick_curves(curves, order), start, inner[order]))


def contour_outlines(contours, curves):
    """The same of what every contour encloses, (C,), hole or not."""
    usable = _spans_triangle(contours, curves)
    rings = pick_curves(curves, np.flatnonzero(usable))
    return mend_outlines(Outlines(*rings, np.concatenate([[0], np.cumsum(usable)]), np.zeros(usable.sum(), bool)))


def _spans_triangle(contours, curves):
    return (np.diff(curves.start) >= 4) & (contours["signed_area"].to_numpy() != 0)
