#!/bin/sh
# Open3D reads a cube of six quadrilaterals from PLY, and an empty mesh from the same cube in OBJ.
#
# open3d.io.read_triangle_mesh skips every OBJ face that is not a triangle. There is no exception;
# the log has a line of level INFO ("Skipping non-triangle primitive geometry of type: 8") and none
# of level WARNING. A file of triangles and quadrilaterals is read in part: a cube whose lid alone
# is cut into triangles comes back as the lid. The same faces in PLY are cut and read whole.
#
# Seen with open3d 0.20.0 (Python 3.11, Linux x86_64):
#   cube of quadrilaterals, ply: 12 triangles, area 6.0
#   cube of quadrilaterals, obj: 0 triangles, area 0.0
#   cube with a lid of triangles, ply: 12 triangles, area 6.0
#   cube with a lid of triangles, obj: 2 triangles, area 1.0
# Exit status 0 while that is so, 1 if the behaviour changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet open3d==0.20.0 numpy libusb-package==1.0.30.0
cat > check.py <<'PYTHON'
import ctypes
import glob
import importlib.util
import sys
from pathlib import Path

for library in glob.glob(str(Path(importlib.util.find_spec("libusb_package").origin).parent / "*.so*")):
    ctypes.CDLL(library, ctypes.RTLD_GLOBAL)  # open3d links to libusb, which a bare machine lacks
import open3d

POINTS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
SIDES = [[0, 2, 3, 1], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]
CUBES = {"cube of quadrilaterals": [*SIDES, [4, 5, 7, 6]], "cube with a lid of triangles": [*SIDES, [4, 5, 7], [4, 7, 6]]}


def write(faces):
    lines = ["v %d %d %d" % p for p in POINTS] + ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    Path("cube.obj").write_text("\n".join(lines) + "\n")
    lines = ["ply", "format ascii 1.0", "element vertex 8"] + [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += ["%d %d %d" % p for p in POINTS] + [" ".join(map(str, [len(f), *f])) for f in faces]
    Path("cube.ply").write_text("\n".join(lines) + "\n")


print("open3d", open3d.__version__)
seen = []
for title, faces in CUBES.items():
    write(faces)
    for ending in ("ply", "obj"):
        mesh = open3d.io.read_triangle_mesh(f"cube.{ending}")
        seen.append((len(mesh.triangles), round(mesh.get_surface_area(), 6)))
        print(f"{title}, {ending}: {seen[-1][0]} triangles, area {seen[-1][1]}")
sys.exit(0 if seen == [(12, 6.0), (0, 0.0), (12, 6.0), (2, 1.0)] else f"open3d changed: {seen}")
PYTHON
venv/bin/python check.py
