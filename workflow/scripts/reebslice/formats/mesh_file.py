"""What a reader of mesh files returns, whatever the format."""

from typing import NamedTuple

import numpy as np


class MeshFile(NamedTuple):
    """The mesh of a file, in the file's own unit, with what a reader of results should be told of it.

    Attributes
    ----------
    points : (n, 3) float64
        Coordinates in the file's own unit: put in place by the transforms that
        the file states, never scaled to another unit, never merged.
    faces : (m, 3) int
        Triangles by their corners' rows in `points`, in the order of the file,
        counter-clockwise seen from outside as the file has them; a transform
        that mirrors turns them over, so that outside stays outside.
    unit : str or None
        Name of the length unit of `points`, in the singular, such as
        'millimetre', 'inch' or 'metre'; None where the format has no unit
        (STL, OBJ, PLY, OFF).
    notes : tuple of str
        Sentences on what the file holds beyond this mesh: parts left out,
        extensions ignored, roles that a slicer gives to bodies, rounding. Empty
        for most files.
    """

    points: np.ndarray
    faces: np.ndarray
    unit: str | None
    notes: tuple[str, ...]
