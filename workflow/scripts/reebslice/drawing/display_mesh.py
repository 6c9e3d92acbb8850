"""A surface as it is shown on a page: with few enough faces, and in order of the arcs on which they lie."""

import numpy as np
from scipy.spatial import cKDTree

TURN = 4.0  # edge lengths that a face of the opposite direction counts as farther away


def reduce_faces(points, faces, labels, most):
    """Decimate a surface by quadric error metrics, for display only.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
    labels : (m,) int
        Of the faces.
    most : int
        About so many faces are left.

    Returns
    -------
    points, faces, labels : arrays
        What was given where that is no more than `most`. Else each face has the label of the nearest one,
        by its middle and its direction.

    References
    ----------
    M. Garland and P. Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997,
    doi:10.1145/258734.258849
    """
    if len(faces) <= most:
        return points, faces, labels
    import fast_simplification  # which few models need

    origin = points.min(axis=0)  # the package computes in the precision of these numbers
    low, less = fast_simplification.simplify(points - origin, faces.astype(np.int64), target_count=most)[:2]
    low = np.asarray(low, float) + origin
    less = np.asarray(less)
    places, step = _place_faces(low, less, None)
    tree = cKDTree(_place_faces(points, faces, step)[0])
    return low, less, labels[tree.query(places)[1]]


def _place_faces(points, faces, step):
    """The middle of each face and its direction times TURN / 2 steps, (m, 6), and the step: by default, a mean edge."""
    corners = points[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    if step is None:
        step = float(np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1).mean())
    return np.hstack([corners.mean(axis=1), normal * (TURN / 2 * step)]), step


def split_by_label(points, faces, labels):
    """Put faces in order of their labels, and give each label vertices of its own.

    Parameters
    ----------
    points, faces, labels
        As of :func:`reduce_faces`.

    Returns
    -------
    points : (k, 3) float64
    faces : (m, 3) int64
    label_of_point : (k,) int64
        All corners of a face have its label.
    order : (m,) int64
        Which of the faces given each one is.
    """
    order = np.argsort(labels, kind="stable")
    pairs = np.column_stack([np.repeat(labels[order], 3), faces[order].ravel()]).astype(np.int64)
    found, place = np.unique(pairs, axis=0, return_inverse=True)
    return points[found[:, 1]], place.reshape(-1, 3), found[:, 0], order
