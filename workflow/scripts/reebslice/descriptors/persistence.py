"""Extended persistence and critical points of functions as lists of numbers of a fixed length."""

import numpy as np

from ..errors import ReebsliceError

KINDS = ("ordinary", "relative", "loop", "extended")
UPSIDE_DOWN = ("relative", "ordinary", "loop", "extended")
RANKS = 16
RESOLUTION = 16
BANDWIDTH = 0.08
SHARES = 10
QUANTILES = 8


def take_pairs(nodes):
    """Take the pairs of extended persistence, each once, from the nodes of a Reeb graph.

    Parameters
    ----------
    nodes : dict of str to array
        Columns of `function_nodes`.

    Returns
    -------
    low, high : (k,) float64
        The lesser and the greater of the two values.
    kind : (k,) int
        Row of KINDS. It tells whether birth is above death, as of relative pairs and of loops.
    """
    value, partner = np.asarray(nodes["value"]), np.asarray(nodes["partner"])
    once = np.flatnonzero(np.arange(len(value)) < partner)  # nodes are in order of values
    kind = np.array([KINDS.index(word) for word in np.asarray(nodes["pairing"])[once]], int)
    return value[once], value[partner[once]], kind


def turn_pairs(low, high, kind):
    """The pairs of the function with its sign turned: a closed surface has the same, minima and maxima swapped."""
    return -high, -low, np.array([KINDS.index(word) for word in UPSIDE_DOWN])[kind]


def rank_persistences(low, high, kind):
    """List the greatest persistences of each kind of pair.

    Parameters
    ----------
    low, high, kind
        Of :func:`take_pairs`.

    Returns
    -------
    (4, 16) float64
        high - low, of each of KINDS the 16 greatest, descending; 0 where there are no more.

    References
    ----------
    D. Cohen-Steiner, H. Edelsbrunner and J. Harer, Extending persistence using Poincare and Lefschetz duality,
    Foundations of Computational Mathematics 9 (2009), doi:10.1007/s10208-008-9027-z
    """
    ranks = np.zeros((len(KINDS), RANKS))
    for number, row in enumerate(ranks):
        found = np.sort((high - low)[kind == number])[::-1][:RANKS]
        row[: len(found)] = found
    return ranks


def pool_persistences(ranks):
    """Pool the persistences of heights over directions, so that no direction has a name.

    Parameters
    ----------
    ranks : (D, 4, 16) float64
        Of :func:`rank_persistences`, a height each.

    Returns
    -------
    (8 * 33,) float64
        Minimum, sevenths and maximum over directions of: the k-th greatest persistence of ordinary and relative pairs
        together, k up to 16; that of loops, k up to 16; and the greatest extended one, the width of the model. All
        are the same for a direction and its opposite.
    """
    branches = np.sort(ranks[:, :2].reshape(len(ranks), -1), axis=1)[:, ::-1][:, :RANKS]
    pooled = np.concatenate([branches, ranks[:, 2], ranks[:, 3, :1]], axis=1)
    return np.quantile(pooled, np.linspace(0, 1, QUANTILES), axis=0).ravel()


def persistence_images(low, high, kind):
    """Spread pairs of extended persistence over images, one for each kind of pair.

    Parameters
    ----------
    low, high, kind
        Of :func:`take_pairs`, scaled so that values go from 0 to 1.

    Returns
    -------
    (4 * 256,) float64
        Of each of KINDS an image of 16 x 16 pixels, `low` by persistence: around each pair a normal distribution of
        standard deviation 0.08, times the square root of the persistence.

    Raises
    ------
    ReebsliceError
        There is no package gudhi, or no scikit-learn.

    Notes
    -----
    gudhi leaves a pair with its birth above its death out of the image, or draws it with a negative weight. So the
    images are of (lesser, greater) values, and the kind, not the side of the diagonal, tells pairs apart.

    References
    ----------
    H. Adams et al., Persistence images: a stable vector representation of persistent homology, Journal of Machine
    Learning Research 18 (2017), https://jmlr.org/papers/v18/16-337.html
    """
    try:
        from gudhi.representations import PersistenceImage  # takes a second, and scikit-learn
    except ImportError:
        raise ReebsliceError(
            "persistence images take the packages gudhi and scikit-learn: pip install gudhi scikit-learn"
        ) from None
    images = np.zeros((len(KINDS), RESOLUTION**2))
    spread = PersistenceImage(bandwidth=BANDWIDTH, weight=_weight, resolution=[RESOLUTION] * 2, im_range=[0, 1, 0, 1])
    present = np.unique(kind)
    if len(present):
        images[present] = spread.fit_transform([np.column_stack([low, high])[kind == one] for one in present])
    return np.maximum(images, 0).ravel()


def _weight(pair):
    """The weight of a pair (birth, persistence); pairs on the diagonal have none."""
    return np.sqrt(max(pair[1], 0))


def count_events(nodes):
    """Count the critical points of each index along the values of a function.

    Parameters
    ----------
    nodes : dict of str to array
        Columns of `function_nodes`.

    Returns
    -------
    (3, 10) float64
        Minima, saddles, maxima in tenths of the range of values, as shares of all critical points.
    """
    value, index = np.asarray(nodes["value"]), np.asarray(nodes["index"])
    size = np.ptp(value)
    place = np.minimum((value - value.min()) / (size if size > 0 else 1) * SHARES, SHARES - 1).astype(int)
    return np.bincount(SHARES * index + place, minlength=3 * SHARES).reshape(3, SHARES) / len(value)
