"""Colours for arcs."""

import colorsys

import numpy as np

# The golden angle as a share of a turn: hues of consecutive numbers lie far apart.
GOLDEN = 0.38196601125010515
NOTHING = (160, 160, 160)


def arc_colours(arcs):
    """Give arcs colours.

    Parameters
    ----------
    arcs : (k,) int
        -1 for none.

    Returns
    -------
    (k, 3) uint8
        Red, green, blue: one colour for each number, whatever the others are; grey for -1.
    """
    arcs = np.asarray(arcs)
    numbers, which = np.unique(arcs, return_inverse=True)
    palette = [_colour(number) if number >= 0 else NOTHING for number in numbers.tolist()]
    return np.array(palette, np.uint8).reshape(-1, 3)[which.ravel()]


def _colour(number):
    """The colour of a number: hues by the golden angle, in turn lighter and darker."""
    shade = (0.95, 0.75, 0.85)[number % 3]
    return tuple(round(255 * part) for part in colorsys.hsv_to_rgb(number * GOLDEN % 1, 0.55, shade))
