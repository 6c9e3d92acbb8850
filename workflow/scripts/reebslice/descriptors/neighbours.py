"""A matrix of distances as tables: with a map of the models, and of each model those most alike."""

import numpy as np
import pyarrow as pa

from ..errors import ReebsliceError
from ..table_checks import build_table


def map_models(distances):
    """Place models in the plane, so that those that are alike are near each other.

    Parameters
    ----------
    distances : (M, M) float64
        Symmetric, 0 on the diagonal.

    Returns
    -------
    (M, 2) float64
        By classical multidimensional scaling: of all maps the one that keeps most of what the distances tell.

    Raises
    ------
    ReebsliceError
        scikit-learn is not installed.

    References
    ----------
    W. S. Torgerson, Multidimensional scaling: I. Theory and method, Psychometrika 17 (1952), doi:10.1007/BF02288916
    """
    try:
        from sklearn.manifold import ClassicalMDS
    except ImportError:
        raise ReebsliceError("A map takes the package scikit-learn: pip install scikit-learn.") from None
    if len(distances) < 3:
        return np.column_stack([np.linspace(0, distances.max(initial=0), len(distances)), np.zeros(len(distances))])
    return ClassicalMDS(metric="precomputed").fit_transform(distances)


def distance_table(models, distances):
    """Make the table `distances`.

    Parameters
    ----------
    models : list of str
    distances : (M, M) float64

    Returns
    -------
    pyarrow.Table
    """
    x, y = map_models(distances).T
    lists = pa.FixedSizeListArray.from_arrays(distances.ravel(), max(len(models), 1)).cast(pa.list_(pa.float64()))
    return build_table("distances", {"model": models, "x": x, "y": y, "distances": lists})


def neighbour_table(models, distances, number):
    """Make the table `neighbours`.

    Parameters
    ----------
    models : list of str
    distances : (M, M) float64
    number : int
        How many neighbours each model has, if there are so many others.

    Returns
    -------
    pyarrow.Table
        Of equal distances the first model comes first.
    """
    apart = distances.copy()
    np.fill_diagonal(apart, np.inf)
    nearest = np.argsort(apart, axis=1, kind="stable")[:, : min(number, len(models) - 1)]
    names, count = np.array(models, object), nearest.shape[1]
    columns = {
        "model": np.repeat(names, count),
        "place": np.tile(np.arange(count), len(models)),
        "neighbour": names[nearest.ravel()],
        "distance": np.take_along_axis(apart, nearest, axis=1).ravel(),
    }
    return build_table("neighbours", columns)
