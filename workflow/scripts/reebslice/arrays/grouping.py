"""Runs of consecutive items that fit in memory."""

import numpy as np


def split_into_blocks(total, most):
    """Consecutive items, (first, end) of each block, that come to at most `most` together, or are one.

    total : (N + 1,) ascending, what the first so many items come to. At least one block.
    """
    first = 0
    while first == 0 or first < len(total) - 1:
        end = int(np.searchsorted(total, total[first] + most, side="right")) - 1
        end = min(max(first + 1, end), len(total) - 1)
        yield first, end
        first = max(end, 1)
