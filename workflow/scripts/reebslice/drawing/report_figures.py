"""The figures of the table of models that the report of a corpus shows."""

import math
from typing import NamedTuple

import pyarrow.compute as pc


class Figure(NamedTuple):
    """A figure of every model.

    Attributes
    ----------
    name : str
        Its column in the table of models.
    label, words : str
        What it is called at the head of a column, and what it means.
    power : int
        1 of a length, 2 of an area, 3 of a volume, in the unit of the mesh; 0 of what has no unit.
    shown : bool
        Whether it is among those that are shown at first.
    """

    name: str
    label: str
    words: str
    power: int = 0
    shown: bool = False


SECONDS, MEMORY = "seconds", "peak_memory_mb"
FIGURES = (
    Figure("genus", "genus", "Loops of the surface, by topology", shown=True),
    Figure("loops_solid", "loops of solid", "Loops of the graph of the solid", shown=True),
    Figure("loops_surface", "loops of surface", "Loops of the graph of the surface"),
    Figure("betti_solid_0", "bodies", "Connected pieces of material", shown=True),
    Figure("voids", "voids", "Hollows that the outside does not reach", shown=True),
    Figure("loops_handle", "handles", "Loops that are bars: cut there, they are open"),
    Figure("loops_tunnel", "tunnels", "Loops that are holes: plugged there, they are closed"),
    Figure("hidden_genus", "hidden genus", "Loops between two levels, which the graphs do not show"),
    Figure("suppressed_loops", "loops left out", "Loops smaller than the feature size, not in the simplified graphs"),
    Figure("unresolved_blocks", "shared nodes", "Places where events smaller than the feature size share a node"),
    Figure("basins_count", "basins", "Pockets that hold liquid"),
    Figure("basins_volume", "volume of basins", "What they hold", 3),
    Figure("bells_count", "bells", "Pockets that catch air"),
    Figure("sealed_count", "sealed", "Pockets that are closed all around"),
    Figure("islands_count", "islands", "Material that begins in the air"),
    Figure("n_faces", "faces", "Triangles of the cleaned surface", shown=True),
    Figure("levels", "levels", "Planes at which the model was cut", shown=True),
    Figure("refined_levels", "levels added", "Those of them that were added where events were too close to tell apart"),
    Figure("fewest_levels", "fewest levels", "Levels that would show every event of the surface apart"),
    Figure("feature_size", "feature size", "Least height of what is told apart", 1),
    Figure("angle", "tilt", "Degrees between the axis that points up and the direction of height"),
    Figure("self_crossings", "crossings", "Pairs of faces at which a surface crosses itself"),
    Figure("body_crossings", "body crossings", "Pairs of faces at which two bodies cross"),
    Figure("similarity_median", "similarity", "Median shape similarity of linked regions, 0 to 1"),
    Figure("area", "area", "Of the surface", 2),
    Figure("volume", "volume", "Of the solid", 3),
    Figure(SECONDS, "seconds", "Of all stages; of a first run with compiling", shown=True),
    Figure(MEMORY, "memory, MB", "The most that any stage took"),
)


def list_figures(table):
    """List the figures that the table of models has, with their values.

    Parameters
    ----------
    table : pyarrow.Table

    Returns
    -------
    dict of Figure to list of float, int or None
        Numbers of six digits at most where they are no whole ones, None where there is no finite one; figures that no
        model has are left out.
    """
    listed = {}
    for figure in FIGURES:
        values = [_round(value) for value in _find_values(table, figure.name)]
        if any(value is not None for value in values):
            listed[figure] = values
    return listed


def _round(value):
    """The number in six digits; a whole one as it is."""
    if not isinstance(value, float):
        return value
    return float(f"{value:.6g}") if math.isfinite(value) else None


def _find_values(table, name):
    """The values of a figure; of seconds the sum over the stages, of memory the largest."""
    if name not in (SECONDS, MEMORY):
        return table[name].to_pylist() if name in table.column_names and _is_number(table.schema.field(name)) else []
    columns = [table[column] for column in table.column_names if column.startswith(f"{name}_")]
    if not columns:
        return []
    if name == MEMORY:
        return pc.max_element_wise(*columns, skip_nulls=True).to_pylist()
    return [sum(filter(None, row)) if any(row) else None for row in zip(*(column.to_pylist() for column in columns))]


def _is_number(field):
    return str(field.type) in ("double", "int64")
