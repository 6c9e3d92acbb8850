"""All descriptors of one surface."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..errors import NotASolidError
from ..mesh.arguments import take_mesh
from ..mesh.measures import measure_shells
from .arcs import describe_arcs
from .persistence import (
    count_events,
    persistence_images,
    pool_persistences,
    rank_persistences,
    take_pairs,
    turn_pairs,
)
from .surface_points import betti_numbers, normal_powers, relate_pairs, sample_surface
from .thickness import describe_thickness

HEIGHT = "height:"
# Values that a persistence image spans, in square roots of the area; of another function, its own range.
SPANS = {"geodesic": (0, 5), "barycentre": (0, 1.6), "height": (-1.5, 1.5)}


def describe_surface(points: Any, faces: Any, graphs: Mapping[str, Any]) -> dict[str, list]:
    """Describe a closed surface by lists of numbers.

    Parameters
    ----------
    points, faces : (n, 3) float64 and (m, 3) int
        The cleaned surface.
    graphs : dict of str to (values, nodes, arcs)
        Of each function by its name the values (n,), and what :func:`..graphs.function_graphs.graph_function` says.
        Heights are called `height:0`, `height:1` and so on; they are described together, as `height`.

    Returns
    -------
    dict of str to list
        Columns of the table `descriptors`: see docs/descriptors.md for each. The same whatever the place of the
        model; where of no function, of `geodesic` and of `barycentre`, the same but for rounding however it is turned,
        unless parts of it are equally far from the centre: which are sampled first then hangs on the order of rows.

    Raises
    ------
    NotASolidError
        The arrays are none of a mesh, or the surface has no area. Whether it is closed is not looked at.
    ReebsliceError
        There is no package gudhi, or no scikit-learn.

    Examples
    --------
    >>> import reebslice
    >>> import trimesh
    >>> mesh = trimesh.creation.torus(3.0, 1.0)
    >>> values = reebslice.barycentric_distance(mesh)
    >>> graph = reebslice.graph_function("barycentre", values, mesh.vertices, mesh.faces)
    >>> found = describe_surface(mesh.vertices, mesh.faces, {"barycentre": (values, *graph)})
    >>> found["descriptor"][0], found["values"][0]
    ('betti_numbers', [1.0, 2.0, 1.0])
    """
    points, faces = take_mesh(points, faces)
    (area,), (volume,) = measure_shells(points, faces, np.zeros(len(faces), np.int32), 1)
    if not 0 < area < np.inf:
        raise NotASolidError("The surface has no area, or one too large to be held: give the surface of a solid.")
    surface = points, faces, np.sqrt(area)
    places, normals = sample_surface(points, faces)
    rows = [
        ("betti_numbers", "", betti_numbers(points, faces)),
        ("area", "", [area]),
        ("volume", "", [volume]),
        ("normals", "", normal_powers(points, faces)),
        ("pairs", "", relate_pairs(places, normals)),
        ("thickness", "", describe_thickness(places, normals, area)),
    ]
    heights = {name: graph for name, graph in graphs.items() if name.startswith(HEIGHT)}
    for name, graph in graphs.items():
        if name not in heights:
            rows += [(word, name, numbers) for word, numbers in _describe_function(name, graph, surface).items()]
    if heights:
        rows += [
            (word, "height", numbers)
            for word, numbers in _describe_heights(heights, surface, places.mean(axis=0)).items()
        ]
    return {
        "descriptor": [row[0] for row in rows],
        "function": [row[1] for row in rows],
        "values": [np.asarray(row[2], float).ravel().tolist() for row in rows],
    }


def _describe_function(name, graph, surface):
    """The descriptors of a function by their names."""
    values, nodes, arcs = graph
    low, high, kind = take_pairs(nodes)
    if name in SPANS:
        start, end = (bound * surface[2] for bound in SPANS[name])
        unit = surface[2]
    else:
        start, end = low.min(), high.max()
        unit = end - start if end > start else 1.0
    shown = (low - start) / max(end - start, unit), (high - start) / max(end - start, unit)
    return {
        "events": count_events(nodes),
        "persistences": rank_persistences(low / unit, high / unit, kind),
        "persistence_images": persistence_images(*shown, kind),
        **_name_arcs(describe_arcs(values, arcs, *surface[:2])),
    }


def _describe_heights(heights, surface, centre):
    """The descriptors of all heights together by their names; a direction and its opposite count alike."""
    points, faces, unit = surface
    ranks, images, events, arcs = [], [], [], []
    start, end = SPANS["height"]
    for values, nodes, arcs_of_height in heights.values():
        low, high, kind = take_pairs(nodes)
        middle = _interpolate(points, values, centre)
        low, high = (low - middle) / unit, (high - middle) / unit
        ranks.append(rank_persistences(low, high, kind))
        for down, up, of in ((low, high, kind), turn_pairs(low, high, kind)):
            images.append(persistence_images((down - start) / (end - start), (up - start) / (end - start), of))
        counted = count_events(nodes)
        events += [counted, counted[::-1, ::-1]]
        arcs.append(describe_arcs(values, arcs_of_height, points, faces))
    return {
        "events": np.mean(events, axis=0),
        "persistences": pool_persistences(np.array(ranks)),
        "persistence_images": np.mean(images, axis=0),
        **_name_arcs(np.mean(arcs, axis=0)),
    }


def _interpolate(points, values, place):
    """The value of a linear function of space, known at points, at a place."""
    middle = points.mean(axis=0)
    slope = np.linalg.lstsq(points - middle, values - values.mean(), rcond=None)[0]
    return values.mean() + slope @ (place - middle)


def _name_arcs(distributions):
    """Histograms of arcs by their names."""
    return dict(zip(("arc_lengths", "arc_radii", "arc_volumes"), distributions))
