"""The lengths that a certificate is about, in mesh units, from the configuration and the mesh alone.

The rule is computed once more here than the levels were made by, so that a
certificate shows where those do not follow it.
"""

import numpy as np


def mesh_lengths(vertices, tilt, options):
    """Find the feature size and the distance between levels.

    Parameters
    ----------
    vertices : pyarrow.Table
    tilt : dict
        The content of tilt.json.
    options : dict
        The section `levels` of the configuration. Of `feature_size` and
        `distance` either may be null: the distance is half the feature size.
        Relative ones are parts of the height range.

    Returns
    -------
    feature_size, distance : float
        In mesh units.
    """
    distance, size = options.get("distance"), options.get("feature_size")
    distance = size / 2 if distance is None else distance
    size = 2 * distance if size is None else size
    scale = 1.0
    if options.get("units", "relative") == "relative":
        points = np.stack([np.from_dlpack(vertices[axis].combine_chunks()) for axis in "xyz"], axis=1)
        scale = float(np.ptp(points @ np.asarray(tilt["direction"], float)))
    return size * scale, distance * scale
