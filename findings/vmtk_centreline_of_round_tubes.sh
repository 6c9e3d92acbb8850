#!/usr/bin/env bash
# The centreline that VMTK makes of a capsule is one point, the centre of its cap, and no exception tells so.
#
# VMTK goes down a distance on the Voronoi diagram of the vertices. Vertices of an exactly round tube have rings on
# one sphere each, so their Delaunay tetrahedra, and the Voronoi balls, are degenerate: the way down stops where it
# begins ("Target not reached", a warning of VTK). The same vertices moved at random by a thousandth of the radius have
# the line that one expects. Tubes that programs draw (CAD, phantoms, tests) are round; scanned vessels are not.
#
# Seen with vmtk 1.5.2, vtk 9.6.2, Python 3.12:
#   capsule of radius 1, z from -4.0 to 4.0: centreline of 1 place, z from 3.0 to 3.0
#   the same, vertices moved by 0.001: centreline of 32 places, z from -3.2 to 3.4
#
# Exits 0 while the behaviour is as told, and 1 when it has changed.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3.12 -m venv venv # there are wheels of vmtk for no other
venv/bin/pip install --quiet --disable-pip-version-check vmtk==1.5.2 vtk==9.6.2 numpy==2.4.6 trimesh==5.0.0 2>/dev/null
venv/bin/python - <<'PYTHON' 2>/dev/null
import numpy as np
import trimesh
from vmtk import vmtkscripts
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData


def trace(points, faces):
    """Places of the centreline from the lower end to the upper one, rounded."""
    places, cells, program = vtkPoints(), vtkCellArray(), vmtkscripts.vmtkCenterlines()
    places.SetData(numpy_to_vtk(points, deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(faces.astype(np.int64).ravel(), deep=True))
    program.Surface = vtkPolyData()
    program.Surface.SetPoints(places)
    program.Surface.SetPolys(cells)
    program.SeedSelectorName = "pointlist"
    program.SourcePoints, program.TargetPoints = [0.0, 0.0, points[:, 2].min()], [0.0, 0.0, points[:, 2].max()]
    program.InputInfo = program.PrintLog = lambda *_: None
    program.Execute()
    return np.unique(vtk_to_numpy(program.Centerlines.GetPoints().GetData()).round(6), axis=0)


capsule = trimesh.creation.capsule(height=6, radius=1, count=[32, 32])
points, faces = np.array(capsule.vertices), np.array(capsule.faces)
shaken = points + np.random.default_rng(0).normal(scale=1e-3, size=points.shape)
found = []
head = f"capsule of radius 1, z from {points[:, 2].min()} to {points[:, 2].max()}"
for name, these in ((head, points), ("the same, vertices moved by 0.001", shaken)):
    line = trace(np.ascontiguousarray(these), faces)
    found.append(np.ptp(line[:, 2]))
    ends = f"z from {line[:, 2].min():.1f} to {line[:, 2].max():.1f}"
    print(f"{name}: centreline of {len(line)} place{'s' * (len(line) > 1)}, {ends}")
raise SystemExit(not (found[0] < 1e-3 and found[1] > 5))
PYTHON
