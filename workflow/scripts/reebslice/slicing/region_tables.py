"""The regions of a model as a table of polygons."""

import numpy as np
import shapely

from ..planar.outlines import outline_areas, outline_polygons
from ..table_checks import build_table
from .tables import region_levels, region_outlines


def regions_table(contours, curves):
    """Make the table `regions`, one row per region, its polygon with holes.

    Parameters
    ----------
    contours : pyarrow.Table
        The table, which may lack the column `geometry`.
    curves : Curves
        Its curves, tilted frame (:func:`.tables.contour_curves`).

    Returns
    -------
    pyarrow.Table
    """
    outlines = region_outlines(contours, curves)
    region, inner = contours["region"].to_numpy(), contours["inner"].to_numpy(zero_copy_only=False)
    count = len(outlines.start) - 1
    height = np.empty(count)
    height[region] = contours["height"].to_numpy()
    return build_table(
        "regions",
        {
            "region": np.arange(count, dtype=np.int32),
            "level": region_levels(contours),
            "height": height,
            "n_holes": np.bincount(region[inner], minlength=count).astype(np.int32),
            "area": outline_areas(outlines),
            "geometry": shapely.to_wkb(outline_polygons(outlines), byte_order=1),
        },
    )
