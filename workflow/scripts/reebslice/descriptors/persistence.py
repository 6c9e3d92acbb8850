"""Extended persistence of a function as images, and its critical points and their kinds as histograms."""

import numpy as np

from ..errors import ReebsliceError

PAIRINGS = ("ordinary", "relative", "loop", "extended")
RESOLUTION = 16
BANDWIDTH = 0.06


def describe_events(heights, index):
    """Count the critical points of each index along the values of a function.

    Parameters
    ----------
    heights : (k,) float64
        Values of the critical points, in shares from 0, the lowest, to 1, the highest.
    index : (k,) int
        Minimum 0, saddle 1, maximum 2.

    Returns
    -------
    (30,) float64
        Ten equal shares of the values for each index, in its order; the whole adds up to 1.
    """
    place = np.minimum((np.asarray(heights) * 10).astype(int), 9)
    return np.bincount(10 * np.asarray(index) + place, minlength=30) / max(len(place), 1)


def persistence_images(low, high, pairing, span):
    """Spread the pairs of extended persistence over images, one for each kind of pair.

    Parameters
    ----------
    low, high : (k,) float64
        The lesser and the greater value of each pair, each pair once.
    pairing : (k,) array of str
        Its kind, of PAIRINGS.
    span : (float, float)
        The values that the images span.

    Returns
    -------
    (4 * 256,) float64
        Of each kind an image of 16 x 16 pixels, low by persistence: a normal distribution of a bandwidth of 0.06 of the
        span around each pair, times its persistence over the span. A pair is told by its kind whether birth is
        above death, as of `relative` ones and loops; the images know low and high only, so that none falls below the
        diagonal, where the library drops it.

    References
    ----------
    H. Adams et al., Persistence images: a stable vector representation of persistent homology, JMLR 18 (2017)

    D. Cohen-Steiner, H. Edelsbrunner and J. Harer, Extending persistence using Poincare and Lefschetz duality,
    Foundations of Computational Mathematics 9 (2009), doi:10.1007/s10208-008-9027-z
    """
    try:
        from gudhi.representations import PersistenceImage  # takes a second, and scikit-learn
    except ImportError:
        raise ReebsliceError("persistence images take the packages gudhi and scikit-learn: pip install them") from None
    start, size = span[0], span[1] - span[0]
    spread = PersistenceImage(
        bandwidth=BANDWIDTH, weight=lambda pair: pair[1], resolution=[RESOLUTION] * 2, im_range=[0, 1, 0, 1]
    )
    pairs = [np.column_stack([low, high])[np.asarray(pairing) == kind] for kind in PAIRINGS]
    shown = [(part - start) / size for part in pairs]
    images = np.zeros((len(PAIRINGS), RESOLUTION**2))
    for place, part in enumerate(shown):
        if len(part):
            images[place] = spread.fit_transform([part])[0] / RESOLUTION**2
    return images.ravel()
