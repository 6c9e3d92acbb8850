"""Labels beside marks that cover neither marks nor each other."""

import numpy as np

from .canvas import Words, measure_text

# Where a label is tried around its mark, one after the other: across and down, in halves of its width and height.
PLACES = ((1, -1), (1, 1), (-1, -1), (-1, 1), (0, -1), (0, 1), (1, 0), (-1, 0))
REACHES = (1.0, 2.2)  # how far from the mark, in its radii


def spread_labels(canvas, texts, spots, size, colour, radius=4.0):
    """Put a label beside each of some marks.

    Parameters
    ----------
    canvas : Canvas
        That they are for; nothing is drawn.
    texts : list of str
    spots : (n, 2) array_like of float
        Column and row of the marks.
    size, radius : float
        Of the letters, and of the marks, in points.
    colour : str

    Returns
    -------
    list of Words
        Labels in the order of the texts. None covers a mark or another label or leaves the picture; one that finds
        no such place is left out.
    """
    spots = np.asarray(spots, float).reshape(-1, 2)
    radius, half_high = radius * canvas.unit, 0.6 * size * canvas.unit
    limit = np.array(canvas.image.shape[1::-1], float)
    taken = np.hstack([spots - 0.8 * radius, spots + 0.8 * radius])
    words = []
    for text, spot in zip(texts, spots):
        half = np.array([measure_text(canvas, text, size) / 2 + 0.5 * canvas.unit, half_high])
        for middle in (spot + (half + reach * radius) * place for reach in REACHES for place in PLACES):
            low, high = middle - half, middle + half
            meets = (taken[:, :2] < high).all(axis=1) & (taken[:, 2:] > low).all(axis=1)
            if not meets.any() and (low >= 0).all() and (high <= limit).all():
                words.append(Words(text, tuple(middle.tolist()), size, colour, "mm", halo=0.8))
                taken = np.vstack([taken, [*low, *high]])
                break
    return words


def scale_bar(view, most=0.25):
    """Choose a round length for a scale bar.

    Parameters
    ----------
    view : View
    most : float
        The largest part of the view's width that it takes.

    Returns
    -------
    float
        1, 2 or 5 times a power of ten, in mesh units.
    """
    longest = most * view.width / view.scale
    power = 10.0 ** np.floor(np.log10(longest))
    return float(max(step * power for step in (1, 2, 5) if step * power <= longest * (1 + 1e-9)))
