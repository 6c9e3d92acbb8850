"""What a type checker knows of the public door; `make lint` checks it, nothing runs it."""

from typing import assert_type

import numpy as np

import reebslice

points, faces = np.zeros((4, 3)), np.zeros((4, 3), np.int32)
mesh = assert_type(reebslice.height_mesh(points, faces), reebslice.HeightMesh)
surface = assert_type(reebslice.surface_reeb_graph(mesh), reebslice.ReebGraph)
graphs = assert_type(reebslice.exact_graphs(points, faces), tuple[reebslice.ExactGraph, reebslice.ExactGraph])
contours, regions = reebslice.nested_contours(mesh, reebslice.uniform_heights(0.0, 1.0, 0.1))
assert_type(contours, reebslice.Contours)
assert_type(regions, reebslice.Regions)
slices, refined = reebslice.slice_surface(mesh, np.zeros(4, np.int32), 0.1)
assert_type(slices, reebslice.Slices)
file = assert_type(reebslice.read_mesh("part.stl"), reebslice.MeshFile)
assert_type(file.unit, str | None)
error: type[ValueError] = reebslice.errors.MeshFormatError
