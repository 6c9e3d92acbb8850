"""How well distances between models find those of the same class; and plain descriptors to hold others against."""

import numpy as np

MEASURES = ("NN", "FT", "ST", "DCG")
BINS, FARTHEST = 64, 3.0


def score_queries(distances, classes):
    """Score every model as a query against all others, in percent: (M, 4), columns as MEASURES.

    With C - 1 others in the class of the query: whether the nearest is one of them (nearest neighbour); the share
    of them among the C - 1 nearest (first tier) and the 2 (C - 1) nearest (second tier); and discounted cumulative
    gain, the sum of 1 / log2(rank) over their ranks, rank 1 counting 1, over that of a perfect list. The query itself
    is left out. Of equal distances the model with the lower row is first.

    P. Shilane, P. Min, M. Kazhdan and T. Funkhouser, The Princeton shape benchmark, SMI 2004,
    doi:10.1109/SMI.2004.1314504
    """
    distances, classes = np.array(distances, float), np.asarray(classes)
    np.fill_diagonal(distances, np.inf)
    order = np.argsort(distances, axis=1, kind="stable")[:, :-1]
    found = classes[order] == classes[:, None]
    others = found.sum(axis=1)
    rank = np.arange(1, len(classes))
    gain = 1 / np.log2(np.maximum(rank, 2))
    perfect = np.cumsum(gain)[others - 1]
    tiers = [(found & (rank <= k * others[:, None])).sum(axis=1) / others for k in (1, 2)]
    return 100 * np.column_stack([found[:, 0], *tiers, found @ gain / perfect])


def describe_plainly(points, faces, places):
    """Distances of random pairs of points (D2), compactness and eccentricities of a surface, by their names.

    places : (p, 3), points spread evenly over the surface. Compactness is area^3 / (36 pi volume^2), its logarithm;
    eccentricities are the square roots of the variances along the principal axes of the points, as shares of all.
    """
    a, b, c = (points[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    area, volume = np.linalg.norm(cross, axis=1).sum() / 2, np.einsum("ij,ij->", a - points.mean(axis=0), cross) / 6
    first, second = np.random.default_rng(0).integers(0, len(places), (2, 2**16))
    distance = np.linalg.norm(places[first] - places[second], axis=1)
    shares = np.minimum(distance / distance.mean(), np.nextafter(FARTHEST, 0))
    spread = np.linalg.eigvalsh(np.cov(places.T))
    return {
        "d2": np.histogram(shares, BINS, (0, FARTHEST))[0] / len(shares),
        "compactness": [np.log(area**3 / (36 * np.pi * volume**2))],
        "eccentricities": np.sqrt(np.maximum(spread, 0) / spread.sum()),
    }


def compare_plainly(descriptors, names):
    """Sum of absolute differences of values, each descriptor over its median over pairs of models: (M, M)."""
    total = np.zeros((len(descriptors),) * 2)
    for name in names:
        values = np.array([one[name] for one in descriptors])
        distance = np.abs(values[:, None] - values).sum(axis=2)
        total += distance / np.median(distance[np.triu_indices(len(values), 1)])
    return total
