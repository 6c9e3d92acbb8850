"""Describe the models of the SHREC'07 watertight track and keep what is found in a folder."""

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "workflow" / "scripts"))

from reebslice.descriptors.surface import describe_surface
from reebslice.descriptors.surface_points import sample_surface
from reebslice.formats.meshes import read_mesh
from reebslice.functions.barycentre import barycentric_distance
from reebslice.functions.geodesic import geodesic_distance
from reebslice.functions.heights import directional_height, spread_axes
from reebslice.graphs.function_graphs import graph_function
from reebslice.mesh.inspection import inspect_surface
from reebslice.table_checks import build_table
from retrieval_scores import describe_plainly

NUMBER, PER_CLASS, DIRECTIONS = 400, 20, 32


def class_of(number):
    """Class of a model of the track, from its number."""
    return (number - 1) // PER_CLASS


def clean_surface(path, turn=None):
    """Points and faces of a mesh file, cleaned as the workflow does; turn : seed of a random rotation, or None."""
    mesh = read_mesh(path)
    points = mesh.points if turn is None else mesh.points @ random_rotation(turn).T
    tables, inspection = inspect_surface(points, mesh.faces)
    if tables is None:
        raise ValueError(f"{path}: {inspection['reason']}")
    vertices, faces = (tables[name].to_pydict() for name in ("vertices", "faces"))
    return np.column_stack([vertices[k] for k in "xyz"]), np.column_stack([faces[k] for k in "abc"])


def random_rotation(seed):
    """A rotation, every one as likely."""
    from scipy.spatial.transform import Rotation

    return Rotation.random(random_state=seed).as_matrix()


def graph_functions(points, faces, intrinsic=True, directions=DIRECTIONS):
    """Graphs of the functions that the descriptors are of, as `functions: [geodesic, barycentre, directions:N]`."""
    values = {}
    if intrinsic:
        values = {"geodesic": geodesic_distance(points, faces), "barycentre": barycentric_distance(points, faces)}
    if directions:
        values |= {f"height:{k}": directional_height(points, up) for k, up in enumerate(spread_axes(directions))}
    return {name: (value, *graph_function(name, value, points, faces)) for name, value in values.items()}


def describe_model(path, target, turn):
    """Write the descriptors of a mesh file, and the plain ones, as two tables, unless they are there."""
    files = target / f"{path.stem}.parquet", target / f"{path.stem}.plain.parquet"
    if all(file.exists() for file in files):
        return
    points, faces = clean_surface(path, turn)
    plain = describe_plainly(points, faces, sample_surface(points, faces)[0])
    rows = {
        "descriptor": list(plain),
        "function": [""] * len(plain),
        "values": [list(map(float, v)) for v in plain.values()],
    }
    for file, columns in zip(files, (describe_surface(points, faces, graph_functions(points, faces)), rows)):
        written = file.with_suffix(".part")
        pq.write_table(build_table("descriptors", columns), written)
        written.rename(file)


def describe_models(folder, target, numbers, turned=False, workers=1):
    """Describe the models NUMBER.off of a folder: their tables `descriptors`, and their plain descriptors by name.

    turned : whether each is first turned by a random rotation of its own.
    """
    target.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(describe_model, folder / f"{k}.off", target, k if turned else None) for k in numbers]
        for job in jobs:
            job.result()
    tables = [pq.read_table(target / f"{k}.parquet") for k in numbers]
    plain = [pq.read_table(target / f"{k}.plain.parquet") for k in numbers]
    return tables, [dict(zip(one["descriptor"].to_pylist(), one["values"].to_pylist())) for one in plain]
