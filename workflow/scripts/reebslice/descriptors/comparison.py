"""Distances between the models of a corpus by their descriptors, and by their neighbours in the corpus."""

from collections.abc import Sequence
from typing import Any

import numpy as np

# Those by which models are told apart; benchmarks/score_retrieval.py tells what each is worth.
COMPARED = ("normals", "pairs", "persistences", "thickness")
NEIGHBOURS = 8
REACH = 0.95


def compare_descriptors(tables: Sequence[Any]) -> np.ndarray:
    """Measure how unlike the models of a corpus are.

    Parameters
    ----------
    tables : list of pyarrow.Table, or of dict of str to list
        Table `descriptors` of each of M models, or its columns.

    Returns
    -------
    (M, M) float64
        Symmetric, 0 on the diagonal, without a unit. Of every list of numbers v, w of the descriptors COMPARED, one for
        each function, the distance is the Euclidean one of their square roots, sqrt(sum (sqrt(v) - sqrt(w))^2), which
        of histograms is Hellinger's but for a factor; divided by its median over all pairs of models in which it is
        not 0. What is given is the mean over the lists that both models have. A list in which no models differ does
        not count.

    Notes
    -----
    Medians are of this corpus, so a distance means something beside others of the same matrix only. Nothing but the
    shapes is used, and no size, place or rotation of them.

    Examples
    --------
    >>> import reebslice
    >>> import trimesh
    >>> shapes = trimesh.creation.box(), trimesh.creation.box((2, 2, 2)), trimesh.creation.icosphere()
    >>> found = compare_descriptors([reebslice.describe_surface(mesh.vertices, mesh.faces, {}) for mesh in shapes])
    >>> bool(found[0, 1] < 1e-9 < found[0, 2])
    True
    """
    rows = [_rows(table) for table in tables]
    total, count = np.zeros((len(rows), len(rows))), np.zeros((len(rows), len(rows)))
    for key in sorted({key for row in rows for key in row}):
        place = np.array([number for number, row in enumerate(rows) if key in row])
        roots = np.sqrt(np.maximum([rows[number][key] for number in place], 0))
        distance = np.array([np.linalg.norm(roots - one, axis=1) for one in roots])
        unlike = distance[np.triu_indices(len(place), 1)]
        if (unlike > 0).any():
            total[np.ix_(place, place)] += distance / np.median(unlike[unlike > 0])
            count[np.ix_(place, place)] += 1
    return total / np.maximum(count, 1)


def _rows(table):
    """{(descriptor, function): values} of those compared."""
    columns = table if isinstance(table, dict) else table.to_pydict()
    keys = zip(columns["descriptor"], columns["function"])
    return {key: values for key, values in zip(keys, columns["values"]) if key[0] in COMPARED}


def rank_by_neighbourhood(distances, neighbours=NEIGHBOURS):
    """Measure anew how unlike the models of a corpus are, by the ways between them over their neighbours.

    Parameters
    ----------
    distances : (M, M) float64
        Symmetric, 0 on the diagonal.
    neighbours : int
        Models are joined where one is among so many nearest ones of the other.

    Returns
    -------
    (M, M) float64
        Symmetric, from 0, on the diagonal, to 1, where no way leads from one to the other.

    Notes
    -----
    What the models are is not used, only where they crowd: models that a chain of neighbours joins come nearer. With
    the affinities W = exp(-2 d^2 / (r s)) of neighbours at a distance d, whose own k-th neighbours are at r and s, and
    S = W scaled to row and column sums D^(-1/2) W D^(-1/2), F = (1 - a S)^(-1) adds up ways of all lengths with
    a = 0.95; given is 1 - F_ij / sqrt(F_ii F_jj).

    References
    ----------
    D. Zhou, J. Weston, A. Gretton, O. Bousquet and B. Schoelkopf, Ranking on data manifolds, NIPS 2003

    L. Zelnik-Manor and P. Perona, Self-tuning spectral clustering, NIPS 2004, for r and s.
    """
    distances = np.asarray(distances, float)
    reach = min(neighbours, len(distances) - 1)
    if reach < 1:
        return np.zeros_like(distances)
    order = np.argsort(distances, axis=1, kind="stable")
    near = np.zeros(distances.shape, bool)
    np.put_along_axis(near, order[:, : reach + 1], True, axis=1)
    width = np.take_along_axis(distances, order[:, reach : reach + 1], axis=1)
    scale = np.where(width * width.T > 0, width * width.T, 1)
    weight = np.where(near | near.T, np.exp(-2 * distances**2 / scale), 0)
    np.fill_diagonal(weight, 0)
    root = 1 / np.sqrt(np.maximum(weight.sum(axis=1), np.finfo(float).tiny))
    ways = np.linalg.inv(np.eye(len(distances)) - REACH * root[:, None] * weight * root)
    size = np.sqrt(np.diag(ways))
    found = np.clip(1 - (ways + ways.T) / (2 * size[:, None] * size), 0, 1)
    np.fill_diagonal(found, 0)
    return found
