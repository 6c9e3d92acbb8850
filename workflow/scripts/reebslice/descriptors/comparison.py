"""Distances between models by their descriptors."""

import numpy as np


def compare_descriptors(tables):
    """Measure how unlike the models of a corpus are.

    Parameters
    ----------
    tables : list of pyarrow.Table or dict
        `descriptors` of M models.

    Returns
    -------
    (M, M) float64
        Symmetric, 0 on the diagonal; without a unit. Of each descriptor that all models have, the mean absolute difference
        of values, over its median over the pairs of models; then the mean over descriptors. A descriptor in which
        models do not differ counts for nothing.
    """
    rows = [_rows(table) for table in tables]
    common = [key for key in (rows[0] if rows else {}) if all(key in row for row in rows)]
    total = np.zeros((len(rows), len(rows)))
    for key in common:
        values = np.array([row[key] for row in rows])
        distance = np.array([np.abs(values - one).sum(axis=1) for one in values])
        unit = np.median(distance[np.triu_indices(len(rows), 1)]) if len(rows) > 1 else 0
        total += distance / unit if unit > 0 else 0
    return total / max(len(common), 1)


def _rows(table):
    """{(descriptor, function): values} of a table or its columns."""
    columns = table if isinstance(table, dict) else table.to_pydict()
    return dict(zip(zip(columns["descriptor"], columns["function"]), columns["values"]))


def rank_by_neighbourhood(distances, neighbours=8):
    """Measure anew how unlike models are, by how far their neighbours in the corpus are the same.

    Parameters
    ----------
    distances : (M, M) float64
        Symmetric, 0 on the diagonal.
    neighbours : int
        So many nearest models of each are its neighbours.

    Returns
    -------
    (M, M) float64
        Symmetric, 0 on the diagonal; no label of a model is used.
    """
    distances = np.asarray(distances, float)
    count = min(neighbours, len(distances) - 1)
    if count < 1:
        return distances.copy()
    order = np.argsort(distances, axis=1, kind="stable")[:, : count + 1]
    width = np.take_along_axis(distances, order[:, -1:], axis=1)
    near = np.zeros_like(distances)
    np.put_along_axis(near, order, 1.0, axis=1)
    weight = near * np.exp(-distances / np.where(width > 0, width, 1))
    weight /= weight.sum(axis=1, keepdims=True)
    spread = weight @ weight
    found = np.array([np.abs(spread - one).sum(axis=1) for one in spread])
    return found + 0.1 * distances / np.median(width)
