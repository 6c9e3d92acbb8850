"""Certified Reeb graphs of closed meshes from their level sets.

From arrays to graphs: :func:`exact_graphs`, or :func:`height_mesh` and the
functions that take one. From a file to arrays: :func:`read_mesh`, then
:func:`inspect_surface`, which repairs what it can and says what it cannot.

Names are imported when they are first used, so that importing the package
costs next to nothing and a stage depends on no more than it calls.
"""

from importlib import import_module

__version__ = "0.1.0"

# Exported name: the module that has it. `__init__.pyi` says the same to type checkers.
_HOMES = {
    "ArcBodies": "graphs.decomposition",
    "Centrelines": "graphs.centrelines",
    "Contours": "slicing.contours",
    "Directions": "graphs.directions",
    "ExactGraph": "graphs.exact",
    "HeightMesh": "morse.height_mesh",
    "Loops": "graphs.loops",
    "MeshFile": "formats.mesh_file",
    "Pockets": "graphs.pocket_measures",
    "ReebGraph": "morse.reeb_graph",
    "Regions": "slicing.regions",
    "SCHEMAS": "schemas",
    "Slices": "slicing.slices",
    "ValueMesh": "morse.value_mesh",
    "barycentric_distance": "functions.barycentre",
    "certify": "certification.certificate",
    "compare_descriptors": "descriptors.comparison",
    "compare_diagrams": "descriptors.graph_distances",
    "compare_directions": "graphs.directions",
    "compare_graphs": "descriptors.graph_distances",
    "decompose": "graphs.decomposition",
    "describe_surface": "descriptors.surface",
    "exact_graphs": "graphs.exact",
    "find_centrelines": "graphs.centrelines",
    "find_islands": "graphs.pockets",
    "find_loops": "graphs.loops",
    "find_pockets": "graphs.pockets",
    "geodesic_distance": "functions.geodesic",
    "graph_function": "graphs.function_graphs",
    "height_mesh": "morse.height_mesh",
    "inspect_surface": "mesh.inspection",
    "label_faces": "morse.face_arcs",
    "nested_blocks": "slicing.slices",
    "nested_contours": "slicing.slices",
    "pocket_bodies": "graphs.bodies",
    "read_mesh": "formats.meshes",
    "select_tilt": "tilt.choice",
    "slice_surface": "slicing.refinement",
    "surface_reeb_graph": "morse.reeb_graph",
    "uniform_heights": "slicing.levels",
    "value_mesh": "morse.value_mesh",
    "void_reeb_graph": "graphs.voids",
}

__all__ = ["__version__", "errors", *_HOMES]  # noqa: PLE0604, they are strings


def __getattr__(name):
    """Import an exported name from its module."""
    if name == "errors":
        return import_module(".errors", __name__)
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}; it exports {', '.join(sorted(__all__))}")
    value = globals()[name] = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    return value


def __dir__():
    """Names that the package exports."""
    return sorted(__all__)
