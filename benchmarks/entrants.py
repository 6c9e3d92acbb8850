"""What is measured: programs that slice, or make Reeb graphs or skeletons, from the same arrays.

An entrant has `prepare(points, faces)`, which builds what the program keeps of
a mesh, and `run(prepared, heights)`, which answers. Raw seconds are those of
both, warm seconds those of a second run on what is prepared. `check(answer)`
states the answer in figures, outside the measurement. Modules are imported by
the functions, for the sake of those that are not installed.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

import peers
from answer_figures import graph_figures, region_figures, ring_figures, unsigned_figures
from clocks import processor_seconds


class Entrant(NamedTuple):
    """program : as readers know it; task : what it is asked; package : on PyPI; remark : what its answer lacks."""

    program: str
    task: str
    package: str
    prepare: Callable
    run: Callable
    check: Callable
    remark: str = ""


# --------------------------------------------------------------------------
# reebslice


def order_mesh(points, faces):
    from reebslice.morse.ordered_mesh import order_by_height

    return order_by_height(points, faces, np.eye(3))


def order_simple(points, faces):
    from reebslice.morse.height_mesh import height_mesh

    return height_mesh(points, faces)


def trace(mesh, heights):
    from reebslice.slicing.contours import trace_contours
    from reebslice.slicing.levels import make_levels

    return trace_contours(mesh, make_levels(mesh, heights))


def nest(mesh, heights):
    from reebslice.slicing.slices import nested_contours

    return nested_contours(mesh, heights)


def check_contours(contours):
    """The figures, and the seconds that a copy of the points takes: no program can be faster."""
    from reebslice.slicing.contours import measure_contours

    area, copies, start = measure_contours(contours)[0], 0, processor_seconds()
    while (seconds := processor_seconds() - start) < 0.2:
        contours.points.copy()
        copies += 1
    return {
        "contours": len(area), "points": len(contours.points), "copy": seconds / copies,
        "area": float(area.sum()), "absolute_area": float(np.abs(area).sum()),
    }  # fmt: skip


def check_regions(nested):
    contours, regions = nested
    return check_contours(contours) | {"regions": len(regions.level)}


def sweep(mesh, _):
    from reebslice.morse.reeb_graph import surface_reeb_graph

    return surface_reeb_graph(mesh)


def check_graph(graph):
    return graph_figures(len(graph.nodes), len(graph.arcs))


def solve(mesh, _):
    """Both exact graphs, as `exact_graphs` makes them once the mesh is in order of height."""
    from reebslice.graphs.exact import solid_reeb_graph
    from reebslice.morse.reeb_graph import surface_reeb_graph

    surface = surface_reeb_graph(mesh)
    return surface, solid_reeb_graph(mesh, surface, np.zeros(len(mesh.points), np.int32))


def check_solid(graphs):
    nodes, arcs = graphs[1]
    return graph_figures(len(nodes), len(arcs))


# --------------------------------------------------------------------------
# Who is asked for what

UNJOINED = "segments, not joined to curves"
UNORIENTED = "curves run either way round"
FLOAT32 = "in single precision, material on the right"

ENTRANTS = [
    Entrant("reebslice", "contours", "", order_mesh, trace, check_contours),
    Entrant("manifold3d", "contours", "manifold3d", peers.build_manifold, peers.slice_manifold, ring_figures),
    Entrant("VTK", "contours", "vtk", peers.build_vtk_contours, peers.slice_vtk, unsigned_figures, UNORIENTED),
    Entrant("meshlib", "contours", "meshlib", peers.build_meshlib, peers.slice_meshlib, ring_figures, FLOAT32),
    Entrant("trimesh", "contours", "trimesh", peers.build_trimesh, peers.slice_trimesh, unsigned_figures, UNORIENTED),
    Entrant("open3d", "contours", "open3d", peers.build_open3d, peers.slice_open3d, peers.check_segments, UNJOINED),
    Entrant("reebslice", "regions", "", order_mesh, nest, check_regions),
    Entrant("manifold3d", "regions", "manifold3d", peers.build_manifold, peers.nest_manifold, region_figures),
    Entrant("trimesh", "regions", "trimesh", peers.build_trimesh, peers.nest_trimesh, region_figures),
    Entrant("reebslice", "surface graph", "", order_simple, sweep, check_graph),
    Entrant("VTK", "surface graph", "vtk", peers.build_vtk, peers.sweep_vtk, peers.check_vtk_graph),
    Entrant(
        "ceREEBerus",
        "surface graph",
        "cereeberus",
        peers.build_cereeberus,
        peers.sweep_cereeberus,
        peers.check_multigraph,
    ),
    Entrant("reebslice", "solid graph", "", order_simple, solve, check_solid),
    *(
        Entrant(
            f"skeletor, {way}",
            "skeleton",
            "skeletor",
            peers.build_trimesh,
            partial(peers.find_skeleton, way),
            peers.check_skeleton,
        )
        for way in ("by_wavefront", "by_wavefront_exact", "by_mean_curvature")
    ),
]
