#!/bin/sh
# Open3D gives a part of a PLY mesh, as if it were the whole, when it cannot cut a concave polygon.
#
# The same solid, a prism over an eight-sided T, is written eight times as PLY; only the corner
# at which its two caps begin differs. From six corners on Open3D reads 28 triangles of area 18.
# From the two others its ear clipping fails: the reader stops at that face, warns on the console,
# and returns the triangles up to there. Nothing in the mesh that comes back says so, and no
# exception is raised. plyfile and VTK read eight equal files.
#
# Seen with open3d 0.20.0, vtk 9.7.2 (Python 3.11, Linux x86_64):
#   caps begin at corner 0: open3d 28 triangles, area 18.0; vtk area 18.0
#   caps begin at corner 1: open3d 10 triangles, area 7.5; vtk area 18.0
#   caps begin at corner 2: open3d 28 triangles, area 18.0; vtk area 18.0
#   ...
#   caps begin at corner 6: open3d 4 triangles, area 3.5; vtk area 18.0
#   caps begin at corner 7: open3d 28 triangles, area 18.0; vtk area 18.0
# Exit status 0 while that is so, 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet open3d==0.20.0 vtk==9.7.2 numpy libusb-package==1.0.30.0
cat > check.py <<'PYTHON'
import ctypes
import glob
import importlib.util
import sys
from pathlib import Path

import numpy as np
import vtk

for library in glob.glob(str(Path(importlib.util.find_spec("libusb_package").origin).parent / "*.so*")):
    ctypes.CDLL(library, ctypes.RTLD_GLOBAL)  # open3d links to libusb, which a bare machine lacks
import open3d

T = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 2), (-1, 2), (-1, 1), (0, 1)]


def write(name, outline):
    n = len(outline)
    points = [(x, y, z) for z in (0, 1) for x, y in outline]
    faces = [list(range(n))[::-1], list(range(n, 2 * n))]
    faces += [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    lines = ["ply", "format ascii 1.0", f"element vertex {2 * n}"]
    lines += [f"property double {axis}" for axis in "xyz"]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += ["%d %d %d" % p for p in points] + [" ".join(map(str, [len(f), *f])) for f in faces]
    Path(name).write_text("\n".join(lines) + "\n")


def polygon_area(name):
    reader = vtk.vtkPLYReader()
    reader.SetFileName(name)
    reader.Update()
    mesh, area = reader.GetOutput(), 0.0
    for cell in range(mesh.GetNumberOfPolys()):
        p = np.array([mesh.GetPoint(mesh.GetCell(cell).GetPointId(k)) for k in range(mesh.GetCell(cell).GetNumberOfPoints())])
        area += np.linalg.norm(np.cross(p, np.roll(p, -1, axis=0)).sum(0)) / 2
    return area


print("open3d", open3d.__version__, "vtk", vtk.vtkVersion.GetVTKVersion())
seen = []
for corner in range(8):
    write("t.ply", T[corner:] + T[:corner])
    mesh = open3d.io.read_triangle_mesh("t.ply")
    seen.append(len(mesh.triangles))
    print(f"caps begin at corner {corner}: open3d {seen[-1]} triangles, area {mesh.get_surface_area():.1f};"
          f" vtk area {polygon_area('t.ply'):.1f}")
    if abs(polygon_area("t.ply") - 18) > 1e-9:
        sys.exit("vtk changed")
sys.exit(0 if seen == [28, 10, 28, 28, 28, 28, 4, 28] else f"open3d changed: {seen}")
PYTHON
venv/bin/python check.py
